// A light with a size on surfaces, as much of it as is seen from there. Needs view.wgsl, light.wgsl and surface.wgsl.

@group(3) @binding(0) var visibility: texture_2d<f32>;

@fragment
fn fs_soft_light(fragment: Fragment) -> @location(0) vec4f {
    let seen = dot(textureLoad(visibility, vec2u(fragment.clip.xy), 0), vec4f(0.25));
    return softly_lit(fragment, seen);
}

fn softly_lit(fragment: Fragment, seen: f32) -> vec4f {
    let color = color_of(fragment).rgb;
    if is_cut_out(fragment) || !gives_light(fragment) {
        discard;
    }
    return vec4f(color * irradiance(light, fragment) * (seen * view.exposure * presence(fragment)), 0.0);
}
