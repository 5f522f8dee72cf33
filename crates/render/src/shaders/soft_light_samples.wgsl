// soft_light.wgsl, sample by sample.

@group(3) @binding(0) var visibility: texture_multisampled_2d<f32>;

@fragment
fn fs_soft_light(fragment: Fragment, @builtin(sample_index) sample: u32) -> @location(0) vec4f {
    let seen = dot(textureLoad(visibility, vec2u(fragment.clip.xy), sample), vec4f(0.25));
    return softly_lit(fragment, seen);
}

fn softly_lit(fragment: Fragment, seen: f32) -> vec4f {
    let color = color_of(fragment).rgb;
    if is_cut_out(fragment) || !gives_light(fragment) {
        discard;
    }
    return vec4f(color * irradiance(light, fragment) * (seen * view.exposure * presence(fragment)), 0.0);
}
