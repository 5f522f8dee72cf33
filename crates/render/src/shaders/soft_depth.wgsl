// What soft_coverage.wgsl is drawn over, with one sample a pixel.

@group(2) @binding(1) var depth: texture_2d<f32>;

fn seen_size() -> vec2f {
    return vec2f(textureDimensions(depth));
}

@fragment
fn fs_coverage(covering: Covering, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    return coverage(covering, is_front, textureLoad(depth, vec2u(covering.clip.xy), 0).r);
}

@fragment
fn fs_cap(cap: Cap, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    return cap_coverage(cap, is_front, textureLoad(depth, vec2u(cap.clip.xy), 0).r);
}
