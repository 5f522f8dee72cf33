// What soft_coverage.wgsl is drawn over, sample by sample.

@group(2) @binding(1) var depth: texture_multisampled_2d<f32>;

fn seen_size() -> vec2f {
    return vec2f(textureDimensions(depth));
}

@fragment
fn fs_coverage(
    covering: Covering,
    @builtin(front_facing) is_front: bool,
    @builtin(sample_index) sample: u32,
) -> @location(0) vec4f {
    return coverage(covering, is_front, textureLoad(depth, vec2u(covering.clip.xy), sample).r);
}

@fragment
fn fs_cap(cap: Cap, @builtin(front_facing) is_front: bool, @builtin(sample_index) sample: u32) -> @location(0) vec4f {
    return cap_coverage(cap, is_front, textureLoad(depth, vec2u(cap.clip.xy), sample).r);
}
