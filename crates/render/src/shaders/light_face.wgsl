// A light with a size as it is seen from a point, and how much of it an edge covers: the twin of core's `LightFace`, about which the reasons are there.
// Needs view.wgsl and light.wgsl.

const DISC_OF_SUN = 0u;
const DISC_OF_BALL = 1u;
const RECTANGLE = 2u;

// Further than any scene, near enough that f32 can square it.
const FAR_AWAY = 1e15;

struct Extent {
    half_right: vec3f,
    kind: u32,
    half_up: vec3f,
    // The tangent of a sun's angular radius; else the radius of the ball that is the light or holds it.
    radius: f32,
}

@group(2) @binding(0) var<uniform> extent: Extent;

struct LightFace {
    to_center: vec3f,
    ahead: vec3f,
    distance: f32,
    across: vec3f,
    up: vec3f,
    shift: vec2f,
}

// `point` is from the eye, as everything here.
fn light_face(point: vec3f) -> LightFace {
    let w = light.position_world.w;
    let to_center = light.position_world.xyz - (view.eye_world + point) * w;
    let length_of = length(to_center);
    let toward = to_center / length_of;
    if extent.kind == RECTANGLE {
        let ahead = normalize(cross(extent.half_up, extent.half_right));
        let right = extent.half_right / dot(extent.half_right, extent.half_right);
        let up = extent.half_up / dot(extent.half_up, extent.half_up);
        let distance = dot(ahead, to_center);
        let shift = vec2f(dot(right, to_center), dot(up, to_center));
        return LightFace(to_center, ahead, distance, right * distance, up * distance, shift);
    }
    // Turns with the point without a jump, but for lights straight below (J. R. Frisvad, "Building an orthonormal basis from a 3D unit vector
    // without normalization", 2012).
    let s = 1.0 / (1.0 + max(toward.z, -0.999999));
    let across = vec3f(1.0 - toward.x * toward.x * s, -toward.x * toward.y * s, -toward.x);
    let up = vec3f(across.y, 1.0 - toward.y * toward.y * s, -toward.y);
    let is_sun = extent.kind == DISC_OF_SUN;
    let scale = select(length_of / extent.radius, 1.0 / extent.radius, is_sun);
    let distance = select(length_of, FAR_AWAY, is_sun);
    return LightFace(to_center, toward, distance, across * scale, up * scale, vec2f(0.0));
}

// Whether the light's centre is on the inner side of the edge from `a` to `b`, both from the point.
fn is_around_center(face: LightFace, a: vec3f, b: vec3f) -> bool {
    return dot(a, cross(b - a, face.to_center)) > 0.0;
}

fn seen_at(face: LightFace, way: vec3f) -> vec3f {
    let z = dot(way, face.ahead);
    return vec3f(dot(way, face.across) - face.shift.x * z, dot(way, face.up) - face.shift.y * z, z);
}

// Where the ray from the middle through `v` meets the border of the square light, along it.
fn along_border(v: vec2f) -> f32 {
    if abs(v.x) >= abs(v.y) {
        return select(v.y / v.x, 0.0, v.x == 0.0) + select(4.0, 0.0, v.x >= 0.0);
    }
    return 2.0 - v.x / v.y + select(4.0, 0.0, v.y >= 0.0);
}

// The share of the light between the sector of a chord and its triangle; `foot` is the chord's nearest point to the middle.
fn segment(foot: vec2f, along: vec2f, low: f32, high: f32) -> f32 {
    if low >= high {
        return 0.0;
    }
    let height = length(foot);
    let twice_triangle = height * (high - low);
    if extent.kind == RECTANGLE {
        let turn = abs(along_border(foot + along * high) - along_border(foot + along * low));
        return max(min(turn, 8.0 - turn) - twice_triangle, 0.0) / 8.0;
    }
    return max(atan2(twice_triangle, height * height + low * high) - twice_triangle, 0.0) / 6.283185307;
}

// What the edge from `a` to `b`, both from the point, as the lit side walks it, adds to the covered share of each quarter of the light: right
// and upper, left and upper, left and lower, right and lower.
fn edge_shares(face: LightFace, start: vec3f, end: vec3f) -> vec4f {
    var a = seen_at(face, start);
    var b = seen_at(face, end);
    if (a.z <= 0.0 && b.z <= 0.0) || (a.z > face.distance && b.z > face.distance) {
        return vec4f(0.0);
    }
    if a.z > face.distance {
        a = mix(a, b, (face.distance - a.z) / (b.z - a.z));
    } else if b.z > face.distance {
        b = mix(b, a, (face.distance - b.z) / (a.z - b.z));
    }
    let line = cross(a, b - a);
    let size = length(line.xy);
    if size == 0.0 {
        return vec4f(0.0);
    }
    let normal = line.xy / size;
    let foot = -normal * (line.z / size);
    let along = vec2f(normal.y, -normal.x);
    // An end that is beside or behind the point is seen at infinity.
    var low = -FAR_AWAY;
    var high = FAR_AWAY;
    if a.z > 0.0 {
        low = dot(along, a.xy) / a.z;
    }
    if b.z > 0.0 {
        high = dot(along, b.xy) / b.z;
    }
    // Where the line meets the axes and, for a rectangle, its sides; a step of 0 is made as good as none.
    let step = select(along, vec2f(1e-12), abs(along) < vec2f(1e-12));
    if extent.kind == RECTANGLE {
        let first = (vec2f(-1.0) - foot) / step;
        let second = (vec2f(1.0) - foot) / step;
        let enter = min(first, second);
        let leave = max(first, second);
        low = max(low, max(enter.x, enter.y));
        high = min(high, min(leave.x, leave.y));
    } else {
        let half_squared = 1.0 - dot(foot, foot);
        let half = sqrt(max(half_squared, 0.0));
        low = max(low, -half);
        high = min(high, half);
    }
    if low >= high {
        return vec4f(0.0);
    }
    let axes = -foot / step;
    let first = clamp(min(axes.x, axes.y), low, high);
    let second = clamp(max(axes.x, axes.y), low, high);
    var shares = quarter(foot + along * (0.5 * (low + first))) * segment(foot, along, low, first);
    shares += quarter(foot + along * (0.5 * (first + second))) * segment(foot, along, first, second);
    shares += quarter(foot + along * (0.5 * (second + high))) * segment(foot, along, second, high);
    // Shares of a quarter, not of the light.
    return shares * select(4.0, -4.0, is_around_center(face, start, end));
}

// 1 for the quarter of the light in which `at` is.
fn quarter(at: vec2f) -> vec4f {
    let is_upper = at.y >= 0.0;
    let of_upper = select(vec4f(0.0, 1.0, 0.0, 0.0), vec4f(1.0, 0.0, 0.0, 0.0), at.x >= 0.0);
    let of_lower = select(vec4f(0.0, 0.0, 1.0, 0.0), vec4f(0.0, 0.0, 0.0, 1.0), at.x >= 0.0);
    return select(of_lower, of_upper, is_upper);
}
