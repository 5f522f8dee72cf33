// soft_sphere.wgsl, sample by sample.

@group(3) @binding(0) var visibility: texture_multisampled_2d<f32>;

@fragment
fn fs_soft_sphere(ray: Ray, @builtin(sample_index) sample: u32) -> Shaded {
    let seen = dot(textureLoad(visibility, vec2u(ray.clip.xy), sample), vec4f(0.25));
    return softly_shaded(ray, seen);
}

// A little nearer than it is, because another shader may find its last bit otherwise.
fn softly_shaded(ray: Ray, seen: f32) -> Shaded {
    let lit = shaded(ray);
    return Shaded(lit.depth * 1.000001, lit.color * seen);
}
