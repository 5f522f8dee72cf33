// Faces of shadow volumes whose silhouettes are in lists of edges and triangles. Needs view.wgsl, light.wgsl, volume.wgsl, dark_cap.wgsl and job.wgsl.
//
// The same vertices as in the indices of `shadow/emit.rs`, so that both give the same bits.

@group(2) @binding(0) var<uniform> job: Job;
@group(2) @binding(1) var<storage, read> tables: array<u32>;
@group(2) @binding(2) var<storage, read> positions: array<vec4f>;
// Twice the number of an edge or triangle; one more where it is walked from its higher vertex, or where the triangle is to be turned round.
@group(2) @binding(3) var<storage, read> lists: array<u32>;

fn near(i: u32) -> u32 {
    return job.near + i;
}

fn far(i: u32) -> u32 {
    return job.far + i;
}

fn drawn(vertex: u32) -> vec4f {
    return volume_position(positions[vertex]);
}

struct Side {
    start: u32,
    end: u32,
    // Whether it is walked from its lower vertex.
    is_forward: bool,
}

fn side(i: u32) -> Side {
    let entry = lists[job.sides + i];
    let low = tables[job.edges + (entry & ~1u)];
    let high = tables[job.edges + (entry | 1u)];
    if (entry & 1u) == 0u {
        return Side(low, high, true);
    }
    return Side(high, low, false);
}

struct Cap {
    // As the mesh has them.
    corners: vec3u,
    is_turned: bool,
}

fn cap(i: u32) -> Cap {
    let entry = lists[job.caps + i];
    let at = job.triangles + 3u * (entry >> 1u);
    return Cap(vec3u(tables[at], tables[at + 1u], tables[at + 2u]), (entry & 1u) != 0u);
}

// As they turn counter-clockwise seen from the light.
fn facing(cap: Cap) -> vec3u {
    return select(cap.corners, cap.corners.xzy, cap.is_turned);
}

@vertex
fn vs_sides(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    if light.position_world.w == 0.0 {
        // All copies at infinity are one point.
        let s = side(i / 3u);
        let corners = vec3u(near(s.start), far(s.start), near(s.end));
        return drawn(corners[i % 3u]);
    }
    let s = side(i / 6u);
    // The diagonal starts at the lower vertex, so that quads of one edge that run both ways cancel exactly.
    var corners = array<u32, 6>(
        near(s.end), near(s.start), far(s.start),
        near(s.end), far(s.start), far(s.end),
    );
    if s.is_forward {
        corners = array<u32, 6>(
            near(s.start), far(s.start), far(s.end),
            near(s.start), far(s.end), near(s.end),
        );
    }
    return drawn(corners[i % 6u]);
}

@vertex
fn vs_fan(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    let s = side(i / 3u);
    let corners = vec3u(far(s.end), far(s.start), job.axes + MIDDLE);
    return drawn(corners[i % 3u]);
}

@vertex
fn vs_light_cap(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    return drawn(near(facing(cap(i / 3u))[i % 3u]));
}

// Where only the triangle as it was drawn has the same depth: nothing of those that are turned.
@vertex
fn vs_faced(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    let c = cap(i / 3u);
    if c.is_turned {
        return NOWHERE;
    }
    return drawn(near(c.corners[i % 3u]));
}

@vertex
fn vs_turned(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    let c = cap(i / 3u);
    if !c.is_turned {
        return NOWHERE;
    }
    return drawn(near(c.corners[i % 3u]));
}

// From the light to a vertex.
fn away(i: u32) -> vec3f {
    return -to_light(positions[near(i)].xyz);
}

// Nine vertices for each triangle, as it may have to be three.
@vertex
fn vs_projected(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    let corners = facing(cap(i / 9u));
    let piece = (i / 3u) % 3u;
    let axis = fan_axis(away(corners.x), away(corners.y), away(corners.z));
    if axis == MIDDLE {
        if piece > 0u {
            return NOWHERE;
        }
        let own = corners.xzy;
        return drawn(far(own[i % 3u]));
    }
    let start = corners[(3u - piece) % 3u];
    let end = corners[2u - piece];
    let fan = vec3u(far(start), far(end), job.axes + axis);
    return drawn(fan[i % 3u]);
}
