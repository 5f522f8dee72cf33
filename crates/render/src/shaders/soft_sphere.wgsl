// A light with a size on spheres, as much of it as is seen from there. Needs view.wgsl, light.wgsl, surface.wgsl and sphere.wgsl.

@group(3) @binding(0) var visibility: texture_2d<f32>;

@fragment
fn fs_soft_sphere(ray: Ray) -> Shaded {
    let seen = dot(textureLoad(visibility, vec2u(ray.clip.xy), 0), vec4f(0.25));
    return softly_shaded(ray, seen);
}

// A little nearer than it is, because another shader may find its last bit otherwise.
fn softly_shaded(ray: Ray, seen: f32) -> Shaded {
    let lit = shaded(ray);
    return Shaded(lit.depth * 1.000001, lit.color * seen);
}
