// At which samples a sum is not 0, for the stencil alone. The mask of samples does what shading each of them would, on devices too that can't.

@group(0) @binding(0) var sums: texture_multisampled_2d<f32>;

@vertex
fn vs_everywhere(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fs_fold(@builtin(position) at: vec4f) -> @builtin(sample_mask) u32 {
    var mask = 0u;
    for (var sample = 0u; sample < textureNumSamples(sums); sample++) {
        if textureLoad(sums, vec2u(at.xy), sample).r != 0.0 {
            mask |= 1u << sample;
        }
    }
    return mask;
}
