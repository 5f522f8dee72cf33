// Faces of shadow volumes whose silhouettes were found in textures, for the stencil only. Needs view.wgsl, light.wgsl, volume.wgsl and
// found_tables.wgsl.
//
// Which face and corner a vertex is follows from its number; which of several copies of a side, from the instance's. What is not there is
// moved out of the frustum.

// Where the light's numbers are.
struct FoundIn {
    // Among the coefficients of a triangle.
    number: u32,
    // Among the multiplicities of an edge.
    lane: u32,
    lane_bits: u32,
    unused: u32,
}

@group(2) @binding(0) var<uniform> found: FoundIn;
@group(2) @binding(1) var positions: texture_2d<u32>;
@group(2) @binding(2) var triangles: texture_2d<u32>;
@group(2) @binding(3) var edges: texture_2d<u32>;
@group(2) @binding(4) var coefficients: texture_2d<u32>;
@group(2) @binding(5) var multiplicities: texture_2d<u32>;

// Nearer than the near plane.
const NOWHERE: vec4f = vec4f(0.0, 0.0, 2.0, 1.0);

fn volume_corner(i: u32, is_far: bool) -> vec4f {
    let position = position_in(textureLoad(positions, place_of(i), 0));
    return volume_position(vec4f(position, select(0.0, 1.0, is_far)));
}

fn multiplicity(edge: u32) -> i32 {
    let bit = found.lane * found.lane_bits;
    let word = textureLoad(multiplicities, place_of(edge), 0)[bit >> 5u];
    let unused = 32u - found.lane_bits;
    let lane = (word << (unused - (bit & 31u))) >> unused;
    return i32(lane - (1u << (found.lane_bits - 1u)));
}

// Bits of the corners 0 to 5 of a quad: the diagonal starts at the near lower corner, as in emit.rs, whichever way the side runs.
const SECOND_CORNERS: u32 = 0x34u;
const OTHER_CORNERS: u32 = 0x16u;

// A quad, six vertices an edge; or, up to the one point at infinity of a directional light, a triangle, three vertices an edge.
@vertex
fn vs_sides(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) copy: u32,
) -> @builtin(position) @invariant vec4f {
    let is_quad = light.position_world.w != 0.0;
    let corner_count = select(3u, 6u, is_quad);
    let edge = vertex / corner_count;
    let times = multiplicity(edge);
    if copy >= u32(abs(times)) {
        return NOWHERE;
    }
    let corner = vertex % corner_count;
    let is_forward = times > 0;
    var is_high = (corner == 2u) == is_forward;
    var is_far = corner == 1u;
    if is_quad {
        is_high = ((select(OTHER_CORNERS, SECOND_CORNERS, is_forward) >> corner) & 1u) == 1u;
        is_far = ((select(SECOND_CORNERS, OTHER_CORNERS, is_forward) >> corner) & 1u) == 1u;
    }
    let ends = textureLoad(edges, place_of(edge), 0);
    return volume_corner(select(ends.x, ends.y, is_high), is_far);
}

// The dark cap as a fan about the middle of the caster's box; three vertices an edge.
@vertex
fn vs_fan(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) copy: u32,
) -> @builtin(position) @invariant vec4f {
    let edge = vertex / 3u;
    let times = multiplicity(edge);
    if copy >= u32(abs(times)) {
        return NOWHERE;
    }
    let corner = vertex % 3u;
    let ends = textureLoad(edges, place_of(edge), 0);
    let end = select(ends.x, ends.y, (corner == 0u) == (times > 0));
    return volume_corner(select(end, ends.w, corner == 2u), true);
}

struct CastingTriangle {
    // As the volume needs them.
    corners: vec3u,
    times: i32,
}

fn casting_triangle(triangle: u32) -> CastingTriangle {
    let times = coefficient_in(textureLoad(coefficients, place_of(triangle), 0), found.number);
    let corners = textureLoad(triangles, place_of(triangle), 0).xyz;
    return CastingTriangle(select(corners.xzy, corners, times > 0), times);
}

// The light cap, turned as the volume needs it; three vertices a triangle.
@vertex
fn vs_light_cap(@builtin(vertex_index) vertex: u32) -> @builtin(position) @invariant vec4f {
    let triangle = casting_triangle(vertex / 3u);
    if triangle.times == 0 {
        return NOWHERE;
    }
    return volume_corner(triangle.corners[vertex % 3u], false);
}

// The triangles of the light cap that face the light, as they are; three vertices a triangle.
@vertex
fn vs_faced(@builtin(vertex_index) vertex: u32) -> @builtin(position) @invariant vec4f {
    let triangle = casting_triangle(vertex / 3u);
    if triangle.times <= 0 {
        return NOWHERE;
    }
    return volume_corner(triangle.corners[vertex % 3u], false);
}

// The triangles of the light cap that do not, as they are: the other way round than the volume needs them; three vertices a triangle.
@vertex
fn vs_turned(@builtin(vertex_index) vertex: u32) -> @builtin(position) @invariant vec4f {
    let triangle = casting_triangle(vertex / 3u);
    if triangle.times >= 0 {
        return NOWHERE;
    }
    return volume_corner(triangle.corners.xzy[vertex % 3u], false);
}

// `FLAT` in emit.rs.
const FLAT: f32 = 0.05;

// `fan_axis` in emit.rs; 0 where the cap may be the triangle itself.
fn fan_axis(a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    let is_wide = dot(a, b) < 0.0 || dot(b, c) < 0.0 || dot(c, a) < 0.0;
    let normal_to_light = cross(b - a, c - a);
    if !is_wide || abs(dot(a, normal_to_light)) > FLAT * length(a) * length(normal_to_light) {
        return vec3f(0.0);
    }
    let size = abs(normal_to_light);
    let down = select(vec3f(-1.0), vec3f(1.0), normal_to_light <= vec3f(0.0));
    if size.z >= size.x && size.z >= size.y {
        return vec3f(0.0, 0.0, down.z);
    }
    return select(vec3f(down.x, 0.0, 0.0), vec3f(0.0, down.y, 0.0), size.y >= size.x);
}

// Three triangles of two corners each and the axis, as bits of vertices 0 to 8.
const AXIS_VERTICES: u32 = 0x124u;

// The dark cap as the chain itself, at infinity; nine vertices a triangle, of which most need three.
@vertex
fn vs_projected(@builtin(vertex_index) vertex: u32) -> @builtin(position) @invariant vec4f {
    let triangle = casting_triangle(vertex / 9u);
    if triangle.times == 0 {
        return NOWHERE;
    }
    var away: array<vec3f, 3>;
    for (var i = 0u; i < 3u; i += 1u) {
        let position = position_in(textureLoad(positions, place_of(triangle.corners[i]), 0));
        away[i] = -to_light(position);
    }
    let axis = fan_axis(away[0], away[1], away[2]);
    let i = vertex % 9u;
    let is_single = all(axis == vec3f(0.0));
    if is_single {
        if i >= 3u {
            return NOWHERE;
        }
        return volume_corner(triangle.corners.xzy[i], true);
    }
    if ((AXIS_VERTICES >> i) & 1u) == 1u {
        return volume_position(vec4f(axis, 2.0));
    }
    // Triangle `i / 3` goes from corner `i / 3` of a, c, b to the next.
    return volume_corner(triangle.corners.xzy[(i / 3u + i % 3u) % 3u], true);
}
