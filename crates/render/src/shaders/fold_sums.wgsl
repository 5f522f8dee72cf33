// Where a sum is not 0, for the stencil alone.

@group(0) @binding(0) var sums: texture_2d<f32>;

@vertex
fn vs_everywhere(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fs_fold(@builtin(position) at: vec4f) {
    if textureLoad(sums, vec2u(at.xy), 0).r == 0.0 {
        discard;
    }
}
