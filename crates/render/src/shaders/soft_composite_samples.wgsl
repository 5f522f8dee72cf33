// soft_composite.wgsl, sample by sample.

@group(0) @binding(0) var covered: texture_multisampled_2d<f32>;

@vertex
fn vs_everywhere(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fs_composite(@builtin(position) at: vec4f, @builtin(sample_index) sample: u32) -> @location(0) vec4f {
    return 1.0 - clamp(textureLoad(covered, vec2u(at.xy), sample), vec4f(0.0), vec4f(1.0));
}

@fragment
fn fs_nothing() -> @location(0) vec4f {
    return vec4f(0.0);
}
