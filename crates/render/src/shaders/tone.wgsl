// High dynamic range in, display colours out, over a quiet sky. Needs view.wgsl.

@group(1) @binding(0) var radiance: texture_2d<f32>;

struct Fragment {
    @builtin(position) clip: vec4f,
    // -1 to 1 across and up the picture.
    @location(0) screen: vec2f,
}

// One triangle that covers the picture.
@vertex
fn vs_tone(@builtin(vertex_index) i: u32) -> Fragment {
    let screen = vec2f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0);
    return Fragment(vec4f(screen, 0.0, 1.0), screen);
}

fn sky(screen: vec2f) -> vec3f {
    let d = normalize(view.forward_world + screen.x * view.right_world + screen.y * view.up_world);
    let height = pow(clamp(abs(d.z), 0.0, 1.0), 0.6);
    return mix(vec3f(0.74, 0.765, 0.79), select(vec3f(0.62, 0.60, 0.57), vec3f(0.42, 0.56, 0.74), d.z > 0.0), height);
}

// Khronos PBR Neutral (2024): colours below 0.8 stay as they are, highlights lose saturation instead of hue.
fn neutral(radiance_in: vec3f) -> vec3f {
    let start_compression = 0.8 - 0.04;
    let desaturation = 0.15;
    let lowest = min(radiance_in.r, min(radiance_in.g, radiance_in.b));
    let offset = select(0.04, lowest - 6.25 * lowest * lowest, lowest < 0.08);
    var color = radiance_in - offset;
    let peak = max(color.r, max(color.g, color.b));
    if peak < start_compression {
        return color;
    }
    let range = 1.0 - start_compression;
    let new_peak = 1.0 - range * range / (peak + range - start_compression);
    color *= new_peak / peak;
    let gray = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
    return mix(color, vec3f(new_peak), gray);
}

@fragment
fn fs_tone(fragment: Fragment) -> @location(0) vec4f {
    let surface = textureLoad(radiance, vec2i(fragment.clip.xy), 0);
    let color = surface.rgb + (1.0 - surface.a) * sky(fragment.screen);
    return vec4f(neutral(color), 1.0);
}
