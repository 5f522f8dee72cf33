// What is seen through, over everything else and under all lights at once. Needs view.wgsl, light.wgsl and surface.wgsl.

struct Lights {
    count: u32,
    // 1 with the first lights of a scene: then ambient light is added, and what is behind is covered.
    is_first: u32,
    unused_a: u32,
    unused_b: u32,
    lights: array<Light, 255>,
}

@group(1) @binding(0) var<uniform> some_lights: Lights;

// Colour that is already multiplied by the coverage, and the coverage.
@fragment
fn fs_glass(fragment: Fragment) -> @location(0) vec4f {
    let color = color_of(fragment);
    if is_cut_out(fragment) {
        discard;
    }
    var white = vec3f(0.0);
    if some_lights.is_first == 1u {
        white = ambient(fragment);
    }
    for (var i = 0u; i < some_lights.count; i++) {
        if reaches_seen_side(some_lights.lights[i], fragment) {
            white += irradiance(some_lights.lights[i], fragment) * view.exposure;
        }
    }
    let coverage = max(color.a * finish.alpha, finish.least_coverage) * presence(fragment);
    return vec4f(color.rgb * white * coverage, coverage * f32(some_lights.is_first));
}
