// Spheres without triangles: a rectangle around each in the picture, whose rays meet the sphere itself. Needs view.wgsl, light.wgsl and surface.wgsl.
//
// Every pass runs this one fragment shader, and what it is to do comes with the sphere: so the depths of two passes are the same bits,
// and `Equal` finds the surface again.

const AMBIENT = 0u;
const ADD_LIGHT = 1u;
const DARK_MASK = 2u;
// Also for marking: nothing where the light gives nothing.
const LIT_MASK = 3u;

struct Sphere {
    // Left, bottom, right and top in the picture, -1 to 1.
    @location(0) rect: vec4f,
    // From the eye; and the radius.
    @location(1) center_radius: vec4f,
    // Linear colour; and the square of the eye's distance from the centre less that of the radius.
    @location(2) color_power: vec4f,
    @location(3) task: u32,
}

struct Ray {
    @builtin(position) @invariant clip: vec4f,
    // -1 to 1 across and up the picture; at each sample, so that edges are smooth.
    @location(0) @interpolate(perspective, sample) screen: vec2f,
    @location(1) @interpolate(flat) center_radius: vec4f,
    @location(2) @interpolate(flat) color_power: vec4f,
    @location(3) @interpolate(flat) task: u32,
}

@vertex
fn vs_sphere(sphere: Sphere, @builtin(vertex_index) corner: u32) -> Ray {
    let is_right = corner == 1u || corner == 3u || corner == 4u;
    let is_top = corner == 2u || corner == 4u || corner == 5u;
    let screen = vec2f(select(sphere.rect.x, sphere.rect.z, is_right), select(sphere.rect.y, sphere.rect.w, is_top));
    return Ray(vec4f(screen, 0.5, 1.0), screen, sphere.center_radius, sphere.color_power, sphere.task);
}

struct Shaded {
    @builtin(frag_depth) depth: f32,
    @location(0) color: vec4f,
}

@fragment
fn fs_sphere(ray: Ray) -> Shaded {
    return shaded(ray);
}

fn shaded(ray: Ray) -> Shaded {
    let center = ray.center_radius.xyz;
    let radius = ray.center_radius.w;
    let power = ray.color_power.w;
    let near = view.clip_from_world[3].z;

    // A step along it goes one metre into the picture, so that lengths along the ray are view depths.
    let direction = view.forward_world + ray.screen.x * view.right_world + ray.screen.y * view.up_world;
    let step_squared = dot(direction, direction);
    let middle = dot(center, direction) / step_squared;
    // Where the ray is nearest to the centre: as a vector, because the difference of squares of large numbers would be rough.
    let across = center - direction * middle;
    let half_squared = (radius * radius - dot(across, across)) / step_squared;
    if half_squared < 0.0 {
        discard;
    }
    let half = sqrt(half_squared);
    // The one that is farther from the eye is a sum, and the nearer follows from their product.
    let larger = middle + select(-half, half, middle >= 0.0);
    let smaller = power / step_squared / larger;
    let first = min(larger, smaller);
    let last = max(larger, smaller);
    // Through the near plane one sees the sphere from inside.
    let is_outside = first >= near;
    let depth = select(last, first, is_outside);
    if !(depth >= near) {
        discard;
    }

    let point = view.eye_world + direction * depth;
    let outwards = normalize(direction * depth - center);
    // The side that is seen is known, and needs no test that could go wrong at the sphere's edge.
    let normal = select(-outwards, outwards, is_outside);
    let color = ray.color_power.rgb;
    let gives = is_lit_side(light, normal, point);
    let here = presence_at(point);
    var drawn = vec4f(0.0);
    switch ray.task {
        case AMBIENT: { drawn = vec4f(color * ambient_on(normal, point) * here, here); }
        case ADD_LIGHT: { drawn = vec4f(color * irradiance_on(light, normal, point) * (view.exposure * here), 0.0); }
        case LIT_MASK: { drawn = vec4f(1.0); }
        default: {}
    }
    if (ray.task == ADD_LIGHT || ray.task == LIT_MASK) && !gives {
        discard;
    }
    return Shaded(near / depth, drawn);
}

// On the sphere itself there is no shadow but its unlit half, which its volume holds; the normal decides where that begins.
fn is_lit_side(from_light: Light, normal: vec3f, point: vec3f) -> bool {
    let offset = offset_to_light(from_light, point);
    return dot(normal, offset) > 0.0 && reaches(from_light, offset);
}
