// The surfaces, from both sides: once with depth and ambient light, then once for each light.
// Entry points ending in `_mask` draw the verdict instead of the look. Needs view.wgsl and light.wgsl.

// What is false costs nothing: each pipeline has its own.
override has_texture: bool = true;
override has_cut_outs: bool = true;

struct Finish {
    // Multiplies the texture's.
    alpha: f32,
    // Where alpha is below it, there is no surface.
    cutoff: f32,
    // How much of what is behind is covered at least: 1 for all but glass.
    least_coverage: f32,
    unused: f32,
}

// White where the material has no texture.
@group(2) @binding(0) var base_color: texture_2d<f32>;
@group(2) @binding(1) var base_color_sampler: sampler;
@group(2) @binding(2) var<uniform> finish: Finish;
@group(2) @binding(3) var cut_out_sampler: sampler;
// The same texture: OpenGL gives each one sampler.
@group(2) @binding(4) var cut_out: texture_2d<f32>;

struct Vertex {
    @location(0) position_world: vec3f,
    // Of the triangle: unit length, the same at all three corners. Shadows are exact for flat triangles.
    @location(1) normal_world: vec3f,
    // The fourth is 1 where the triangle is flat, else 0.
    @location(2) color_srgb: vec4f,
    @location(3) uv: vec2f,
    // Of the surface that the triangle stands for, at this corner: unit length. Anything where the triangle is flat.
    @location(4) shading_normal_world: vec3f,
}

struct Fragment {
    @builtin(position) @invariant clip: vec4f,
    @location(0) position_world: vec3f,
    @location(1) @interpolate(flat) normal_world: vec3f,
    @location(2) color: vec3f,
    // One corner of the triangle, as it is: which side of the plane the eye and the light are on must not depend on how a
    // device interpolates positions over a triangle as large as the ground.
    @location(3) @interpolate(flat) corner_world: vec3f,
    @location(4) uv: vec2f,
    // The normal to shade with, not of unit length between corners; and how high each corner is over the eye along its own.
    @location(5) shading: vec4f,
    @location(6) @interpolate(flat) flatness: f32,
}

@vertex
fn vs_surface(vertex: Vertex) -> Fragment {
    var out: Fragment;
    out.clip = clip_position(vec4f(vertex.position_world, view.unit));
    out.position_world = vertex.position_world;
    out.normal_world = vertex.normal_world;
    out.corner_world = vertex.position_world;
    out.color = linear_from_srgb(vertex.color_srgb.rgb);
    out.uv = vertex.uv;
    let from_eye = vertex.position_world - view.eye_world;
    out.shading = vec4f(vertex.shading_normal_world, dot(vertex.shading_normal_world, from_eye));
    out.flatness = vertex.color_srgb.a;
    return out;
}

fn linear_from_srgb(c: vec3f) -> vec3f {
    return select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045));
}

// Whether it is the triangle's front that is seen.
fn is_front_seen(fragment: Fragment) -> bool {
    let to_eye = view.eye_world - fragment.corner_world;
    return dot(fragment.normal_world, to_eye) > 0.0;
}

// The triangle's normal on the eye's side.
fn seen_normal(fragment: Fragment) -> vec3f {
    return select(-fragment.normal_world, fragment.normal_world, is_front_seen(fragment));
}

// Whether the triangle stands for a curved surface here. Where opposite normals cancel out there is none to shade with.
fn is_smooth(fragment: Fragment) -> bool {
    return fragment.flatness < 0.5 && dot(fragment.shading.xyz, fragment.shading.xyz) > 0.0;
}

// The normal that the surface is shaded with, on the eye's side: on which side the eye is, the triangle alone says, as everywhere else.
fn shading_normal(fragment: Fragment) -> vec3f {
    if !is_smooth(fragment) {
        return seen_normal(fragment);
    }
    let n = normalize(fragment.shading.xyz);
    return select(-n, n, is_front_seen(fragment));
}

// Of a smooth surface: how high the light is over the tangent planes of the corners, on the seen side, interpolated between them; in lengths of the
// normal, and of the way to the light. Where it is 0, silhouettes of smooth bodies cross the triangle; the height over an interpolated plane
// would be another for a lamp nearby, and above 0 where no corner is lit.
fn light_height(from_light: Light, fragment: Fragment) -> f32 {
    let from_eye = offset_to_light(from_light, view.eye_world);
    let height = dot(fragment.shading.xyz, from_eye) - fragment.shading.w * from_light.position_world.w;
    return select(-height, height, is_front_seen(fragment));
}

// 1 near the model, 0 where the ground has faded into the sky.
fn presence(fragment: Fragment) -> f32 {
    return presence_at(fragment.position_world);
}

fn presence_at(point_world: vec3f) -> f32 {
    let d = distance(point_world, view.fade_center_world);
    return 1.0 - smoothstep(view.fade_start, view.fade_end, d);
}

// The colour of the surface; before any `discard`, because it looks at its neighbours.
fn color_of(fragment: Fragment) -> vec4f {
    if !has_texture {
        return vec4f(fragment.color, 1.0);
    }
    return vec4f(fragment.color, 1.0) * textureSample(base_color, base_color_sampler, fragment.uv);
}

// Whether there is no surface here. Always by the largest copy of the texture, so that it does not depend on the distance, and a CPU can tell too.
fn is_cut_out(fragment: Fragment) -> bool {
    if !has_cut_outs {
        return false;
    }
    let alpha = finish.alpha * textureSampleLevel(cut_out, cut_out_sampler, fragment.uv, 0.0).a;
    return alpha < finish.cutoff;
}

// The light that comes from everywhere, for white.
fn ambient(fragment: Fragment) -> vec3f {
    return ambient_on(shading_normal(fragment), fragment.position_world);
}

// For a seen side with the unit normal `n`.
fn ambient_on(n: vec3f, point_world: vec3f) -> vec3f {
    let to_eye = normalize(view.eye_world - point_world);
    // Sky from above, reflected ground from below, and a little from the eye's side so that no two faces merge.
    let hemisphere = mix(vec3f(0.150, 0.140, 0.130), vec3f(0.270, 0.305, 0.360), 0.5 + 0.5 * n.z);
    let fill = 0.10 * max(dot(n, to_eye), 0.0);
    return hemisphere + fill;
}

@fragment
fn fs_ambient(fragment: Fragment) -> @location(0) vec4f {
    let color = color_of(fragment).rgb;
    if is_cut_out(fragment) {
        discard;
    }
    let here = presence(fragment);
    return vec4f(color * ambient(fragment) * here, here);
}

// Whether the light gives anything to the side that is seen, if nothing is between: turned to it, in its range and in its cone.
fn gives_light(fragment: Fragment) -> bool {
    return reaches_seen_side(light, fragment);
}

// The one way in which it is decided where the lit side of a surface ends, for light, marks and masks.
fn is_turned_to_light(from_light: Light, fragment: Fragment) -> bool {
    if is_smooth(fragment) {
        return light_height(from_light, fragment) > 0.0;
    }
    return dot(seen_normal(fragment), offset_to_light(from_light, fragment.corner_world)) > 0.0;
}

fn reaches_seen_side(from_light: Light, fragment: Fragment) -> bool {
    return is_turned_to_light(from_light, fragment) && reaches(from_light, offset_to_light(from_light, fragment.position_world));
}

// Where the light reaches the seen side.
fn irradiance(from_light: Light, fragment: Fragment) -> vec3f {
    if is_smooth(fragment) {
        let offset = offset_to_light(from_light, fragment.position_world);
        let lengths_squared = dot(fragment.shading.xyz, fragment.shading.xyz) * dot(offset, offset);
        return from_light.strength
            * (max(light_height(from_light, fragment) * inverseSqrt(lengths_squared), 0.0) * attenuation(from_light, offset));
    }
    return irradiance_on(from_light, seen_normal(fragment), fragment.position_world);
}

fn irradiance_on(from_light: Light, n: vec3f, point_world: vec3f) -> vec3f {
    let offset = offset_to_light(from_light, point_world);
    let cosine = dot(n, offset) * inverseSqrt(dot(offset, offset));
    return from_light.strength * (max(cosine, 0.0) * attenuation(from_light, offset));
}

@fragment
fn fs_light(fragment: Fragment) -> @location(0) vec4f {
    let color = color_of(fragment).rgb;
    if is_cut_out(fragment) || !gives_light(fragment) {
        discard;
    }
    let radiance = color * irradiance(light, fragment) * (view.exposure * presence(fragment));
    return vec4f(radiance, 0.0);
}

// Draws nothing where the light gives nothing: for marking, in the stencil, the surfaces whose shadows matter.
@fragment
fn fs_mark(fragment: Fragment) {
    if is_cut_out(fragment) || !gives_light(fragment) {
        discard;
    }
}

@fragment
fn fs_dark_mask(fragment: Fragment) -> @location(0) vec4f {
    if is_cut_out(fragment) {
        discard;
    }
    return vec4f(0.0);
}

@fragment
fn fs_lit_mask(fragment: Fragment) -> @location(0) vec4f {
    if is_cut_out(fragment) || !gives_light(fragment) {
        discard;
    }
    return vec4f(1.0);
}
