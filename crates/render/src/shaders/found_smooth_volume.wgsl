// Faces of the shadow volumes of smooth bodies, from lists of names. Needs view.wgsl, light.wgsl, volume.wgsl, dark_cap.wgsl and smooth_job.wgsl.

@group(2) @binding(0) var<uniform> job: SmoothJob;
@group(2) @binding(1) var<storage, read> tables: array<u32>;
@group(2) @binding(2) var<storage, read> positions: array<vec4f>;
@group(2) @binding(3) var<storage, read> points: array<vec4f>;
// Two names for each side, three for each face, the number of a triangle for each one of the light cap.
@group(2) @binding(4) var<storage, read> lists: array<u32>;

// As `VolumeVertex` has it.
const NEAR: f32 = 0.0;
const FAR: f32 = 1.0;

fn place_of(name: u32) -> vec3f {
    if (name & VERTEX) != 0u {
        return positions[job.near + (name & ~VERTEX)].xyz;
    }
    return points[name].xyz;
}

fn drawn(name: u32, extruded: f32) -> vec4f {
    return volume_position(vec4f(place_of(name), extruded));
}

fn axis(i: u32) -> vec4f {
    return volume_position(positions[job.axes + i]);
}

fn side(i: u32) -> vec2u {
    let at = job.sides + 2u * i;
    return vec2u(lists[at], lists[at + 1u]);
}

fn face(i: u32) -> vec3u {
    let at = job.faces + 3u * i;
    return vec3u(lists[at], lists[at + 1u], lists[at + 2u]);
}

fn cap(i: u32) -> vec3u {
    let t = job.triangles + 3u * lists[job.caps + i];
    return vec3u(VERTEX) | vec3u(
        tables[job.vertices + tables[t]],
        tables[job.vertices + tables[t + 1u]],
        tables[job.vertices + tables[t + 2u]],
    );
}

@vertex
fn vs_smooth_sides(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    if light.position_world.w == 0.0 {
        // All copies at infinity are one point.
        let s = side(i / 3u);
        return drawn(select(s.x, s.y, i % 3u == 2u), select(NEAR, FAR, i % 3u == 1u));
    }
    let s = side(i / 6u);
    // The diagonal starts at the lower name, so that quads of one side that run both ways cancel exactly.
    let lower = min(s.x, s.y);
    let higher = max(s.x, s.y);
    var corners = array<u32, 6>(lower, higher, higher, lower, higher, lower);
    var copies = array<f32, 6>(NEAR, NEAR, FAR, NEAR, FAR, FAR);
    if s.x < s.y {
        corners = array<u32, 6>(lower, lower, higher, lower, higher, higher);
        copies = array<f32, 6>(NEAR, FAR, FAR, NEAR, FAR, NEAR);
    }
    return drawn(corners[i % 6u], copies[i % 6u]);
}

@vertex
fn vs_smooth_faces(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    return drawn(face(i / 3u)[i % 3u], NEAR);
}

@vertex
fn vs_smooth_light_cap(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    return drawn(cap(i / 3u)[i % 3u], NEAR);
}

// The dark cap as a fan over the sides.
@vertex
fn vs_smooth_fan(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    if i % 3u == 2u {
        return axis(MIDDLE);
    }
    let s = side(i / 3u);
    return drawn(select(s.y, s.x, i % 3u == 1u), FAR);
}

// The dark cap of one triangle: nine vertices, as it may have to be three.
fn at_infinity(corners: vec3u, i: u32) -> vec4f {
    let piece = (i / 3u) % 3u;
    let about = fan_axis(-to_light(place_of(corners.x)), -to_light(place_of(corners.y)), -to_light(place_of(corners.z)));
    if about == MIDDLE {
        if piece > 0u {
            return NOWHERE;
        }
        return drawn(corners.xzy[i % 3u], FAR);
    }
    if i % 3u == 2u {
        return axis(about);
    }
    return drawn(select(corners[(3u - piece) % 3u], corners[2u - piece], i % 3u == 1u), FAR);
}

@vertex
fn vs_smooth_dark_caps(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    return at_infinity(cap(i / 9u), i);
}

@vertex
fn vs_smooth_dark_faces(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    return at_infinity(face(i / 9u), i);
}
