// Finds the smooth silhouette of one body under one light, and what closes its volume: `find_normals` and `find_inner_places` (of bodies that have moved),
// `find_heights`, `find_crossings`, `find_faces`, `find_creases`, `find_smooth_arguments`. The same faces as in `core/src/smooth/volume.rs`, which has a picture
// of them. Needs smooth_job.wgsl, flat_normal.wgsl, near.wgsl, curve.wgsl, find_smooth_facing.wgsl and find_smooth_creases.wgsl.
//
// Whether a wedge is turned to the light is decided once, by the sign of a height that is stored, and a crossing is made once for each edge between
// wedges; triangles only name them. So neighbours walk the same points, bit for bit, and the volume is closed whatever the rounding.

struct SmoothResult {
    sides: atomic<u32>,
    faces: atomic<u32>,
    caps: atomic<u32>,
    // Points asked for between crossings: more than there is room for, if need be.
    inner: atomic<u32>,
    // Whether some face of the light cap, of a fold or a fin may shade the near rectangle.
    is_near: atomic<u32>,
    unused_a: u32,
    unused_b: u32,
    unused_c: u32,
    // In the order of `SmoothShape::ALL`: 4 words each.
    arguments: array<vec4u, 8>,
}

@group(0) @binding(0) var<uniform> finding: Finding;
@group(0) @binding(1) var<uniform> job: SmoothJob;
@group(0) @binding(2) var<storage, read> tables: array<u32>;
@group(0) @binding(3) var<storage, read> positions: array<vec4f>;
@group(0) @binding(4) var<storage, read> lights: array<FoundLight>;
// Of the wedges of a body; then their inner places, with 1 where that is the vertex's own whatever its edges do.
@group(0) @binding(5) var<storage, read_write> normals: array<vec4f>;
// Of the light above the tangent planes of wedges.
@group(0) @binding(6) var<storage, read_write> heights: array<f32>;
// Of each crossing the point of the silhouette, with where on its edge it is; the foot of the fin; and the normal. Then points between crossings, and
// inner places.
@group(0) @binding(7) var<storage, read_write> points: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> lists: array<u32>;
@group(0) @binding(9) var<storage, read_write> results: array<SmoothResult>;

const GROUP_SIZE: u32 = 64u;
// `core/src/smooth/crossing.rs` has these too, and says what they are.
const INSET: f32 = 0.02;
const STEPS: u32 = 3u;
// `core/src/smooth/body.rs`: with a smaller sine between them, two normals have no common tangent.
const NEARLY_PARALLEL: f32 = 1e-3;
const MOST_INWARD: f32 = 0.2;
// So that nothing is divided by 0.
const SMALLEST: f32 = 1e-37;
const NO_BEND: u32 = 0xFFFFFFFFu;
// `core/src/smooth/precision.rs`.
const LEAST_SINE: f32 = 0.05;
// Of a chord: by less, a crease does not go into its body.
const LEAST_DENT: f32 = 1e-6;

// Of two dimensions, as one can't have enough groups.
fn thread(id: vec3u, groups: vec3u) -> u32 {
    return id.y * groups.x * GROUP_SIZE + id.x;
}

fn place_of_vertex(v: u32) -> vec3f {
    return positions[job.near + v].xyz;
}

fn place_of_wedge(w: u32) -> vec3f {
    return place_of_vertex(tables[job.vertices + w]);
}

fn normal_of_wedge(w: u32) -> vec3f {
    return normals[job.normals + w].xyz;
}

fn height(w: u32) -> f32 {
    return heights[job.heights + w];
}

fn is_turned(w: u32) -> bool {
    return height(w) > 0.0;
}

fn wedge_of_corner(corner: u32) -> u32 {
    return tables[job.triangles + corner];
}

fn to_light(place: vec3f) -> vec3f {
    return job.position_world.xyz - place * job.position_world.w;
}

// The mean of the triangles' normals, weighted by the angle that each has there, over the corners that shared one where the body was made.
@compute @workgroup_size(64)
fn find_normals(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let w = thread(id, groups);
    if w >= job.wedge_count {
        return;
    }
    let end = tables[job.corner_starts + w + 1u];
    var sum = vec3f(0.0);
    for (var i = tables[job.corner_starts + w]; i < end; i++) {
        let corner = tables[i];
        let first = corner - corner % 3u;
        let own = place_of_wedge(wedge_of_corner(corner));
        let next = unit_or_zero(place_of_wedge(wedge_of_corner(first + (corner + 1u) % 3u)) - own);
        let last = unit_or_zero(place_of_wedge(wedge_of_corner(first + (corner + 2u) % 3u)) - own);
        let across = cross(next, last);
        sum += unit_or_zero(across) * atan2(length(across), dot(next, last));
    }
    normals[job.normals + w] = vec4f(unit_or_zero(sum), 0.0);
}

@compute @workgroup_size(64)
fn find_heights(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let w = thread(id, groups);
    if w < job.wedge_count {
        heights[job.heights + w] = dot(normal_of_wedge(w), to_light(place_of_wedge(w)));
        points[job.inner_places + w] = normals[inner_place(w)];
    }
}

// In the order of the caster's vertices.
fn ends_of_edge(e: u32) -> vec2u {
    return vec2u(tables[job.edges + 2u * e], tables[job.edges + 2u * e + 1u]);
}

// The direction of a crease at one of its ends, from the normals of its two sides there.
fn crease_direction(a: vec3f, b: vec3f, chord: vec3f) -> vec3f {
    let along = cross(a, b);
    if length(along) > NEARLY_PARALLEL {
        return select(along, -along, dot(along, chord) < 0.0);
    }
    return chord - a * dot(a, chord);
}

fn curve_of_edge(e: u32) -> Curve {
    let ends = ends_of_edge(e);
    let start = place_of_wedge(ends.x);
    let end = place_of_wedge(ends.y);
    let bend = tables[job.bends + e];
    if bend == NO_BEND {
        return straight_curve(start, end);
    }
    if bend == e {
        return curve_on_surface(start, end, normal_of_wedge(ends.x), normal_of_wedge(ends.y));
    }
    let lower = ends_of_edge(min(e, bend));
    let higher = ends_of_edge(max(e, bend));
    let chord = end - start;
    let curve = curve_along(
        start, end,
        crease_direction(normal_of_wedge(lower.x), normal_of_wedge(higher.x), chord),
        crease_direction(normal_of_wedge(lower.y), normal_of_wedge(higher.y), chord),
    );
    let share = min(
        curve_share_within(curve, MOST_INWARD * height_over(min(e, bend), start, chord)),
        curve_share_within(curve, MOST_INWARD * height_over(max(e, bend), start, chord)),
    );
    return flattened_curve(curve, share);
}

// From edge `e`, one side of a crease, at a right angle to the third corner of its triangle.
fn height_over(e: u32, start: vec3f, chord: vec3f) -> vec3f {
    let ends = ends_of_edge(e);
    // It has one triangle; the other number is the largest.
    let t = min(tables[job.edge_triangles + 2u * e], tables[job.edge_triangles + 2u * e + 1u]);
    var third = wedge_of_corner(3u * t);
    for (var k = 1u; k < 3u; k++) {
        let w = wedge_of_corner(3u * t + k);
        third = select(third, w, third == ends.x || third == ends.y);
    }
    let off = place_of_wedge(third) - start;
    return off - chord * (dot(off, chord) / max(dot(chord, chord), SMALLEST));
}

// Where the surface along the curve turns away from the light: regula falsi in the Illinois form.
fn refined(curve: Curve, first_normal: vec3f, last_normal: vec3f, ends: vec2f, guess: f32) -> f32 {
    var a = vec2f(0.0, ends.x);
    var b = vec2f(1.0, ends.y);
    var u = guess;
    for (var i = 0u; i < STEPS; i++) {
        let h = dot(curve_normal(curve, u, first_normal, last_normal), to_light(curve_at(curve, u)));
        if (h > 0.0) == (a.y > 0.0) {
            a = vec2f(u, h);
            b.y *= 0.5;
        } else {
            b = vec2f(u, h);
            a.y *= 0.5;
        }
        if b.y == a.y {
            break;
        }
        u = clamp((a.x * b.y - b.x * a.y) / (b.y - a.y), 0.0, 1.0);
    }
    return u;
}

@compute @workgroup_size(64)
fn find_crossings(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let e = thread(id, groups);
    if e >= job.edge_count {
        return;
    }
    let ends = ends_of_edge(e);
    if is_turned(ends.x) == is_turned(ends.y) {
        return;
    }
    let above = vec2f(height(ends.x), height(ends.y));
    var u = 0.5;
    if above.x != above.y {
        u = clamp(above.x / (above.x - above.y), 0.0, 1.0);
    }
    let start = place_of_wedge(ends.x);
    let chord = place_of_wedge(ends.y) - start;
    let first_normal = normal_of_wedge(ends.x);
    let last_normal = normal_of_wedge(ends.y);
    // Of the surface as if normals and places were linear.
    let straight = unit_or_zero(mix(first_normal, last_normal, u));
    var point = start + chord * u;
    var normal = straight;
    if (job.flags & CURVED) != 0u {
        let curve = curve_of_edge(e);
        u = refined(curve, first_normal, last_normal, above, u);
        point = curve_at(curve, u);
        normal = curve_normal(curve, u, first_normal, last_normal);
    }
    let inset_m = min(INSET * length(chord), job.most_inset_m);
    let at = crossing(e);
    points[at] = vec4f(point, u);
    points[at + 1u] = vec4f(start + chord * u - straight * inset_m, 0.0);
    points[at + 2u] = vec4f(normal, 0.0);
}

// The name of the point of the silhouette on edge `e`; the next name is the fin's foot.
fn crossing(e: u32) -> u32 {
    return job.crossings + 3u * e;
}

fn place_of(name: u32) -> vec3f {
    if (name & VERTEX) != 0u {
        return place_of_vertex(name & ~VERTEX);
    }
    return points[name].xyz;
}

// How far a chord may be off its curve at `point`: half of what is allowed.
fn chord_m(point: vec3f) -> f32 {
    if job.epsilon_px == 0.0 {
        return 0.5 * job.epsilon_m;
    }
    let away = -to_light(point);
    var near = 0.0;
    var far = 3e38;
    for (var axis = 0u; axis < 3u; axis++) {
        let low = job.receivers_min[axis] - point[axis];
        let high = job.receivers_max[axis] - point[axis];
        if away[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return 0.5 * job.epsilon_m;
            }
            continue;
        }
        near = max(near, min(low / away[axis], high / away[axis]));
        far = min(far, max(low / away[axis], high / away[axis]));
    }
    if near > far {
        return 0.5 * job.epsilon_m;
    }
    let nearest = clamp(dot(job.eye_world - point, away) / dot(away, away), near, far);
    let pixel_m = min(pixel_on_ray(point, away, nearest), min(pixel_on_ray(point, away, near), pixel_on_ray(point, away, far)));
    let sine = max(abs(away.z) / length(away), LEAST_SINE);
    return 0.5 * min(job.epsilon_m, job.epsilon_px * pixel_m * sine);
}

// The size of a pixel at so many lengths of `away` from `point`, less where a shadow there is enlarged.
fn pixel_on_ray(point: vec3f, away: vec3f, t: f32) -> f32 {
    return job.pixel_at_1 * distance(point + away * t, job.eye_world) / (1.0 + t * job.position_world.w);
}

// The first of the points within a curve that is cut into so many pieces, and the pieces: one where there is no room for more.
struct Cut {
    first: u32,
    pieces: u32,
}

fn cut_for(pieces: u32) -> Cut {
    if pieces > 1u {
        let first = atomicAdd(&results[job.number].inner, pieces - 1u);
        if first + pieces - 1u <= job.inner_room {
            return Cut(job.inner + first, pieces);
        }
    }
    return Cut(0u, 1u);
}

fn put_side(i: u32, from_point: u32, to_point: u32) {
    let at = job.sides + 2u * i;
    lists[at] = from_point;
    lists[at + 1u] = to_point;
}

fn add_side(from_point: u32, to_point: u32) {
    put_side(atomicAdd(&results[job.number].sides, 1u), from_point, to_point);
}

fn note_near(a: vec3f, b: vec3f, c: vec3f) {
    if (job.flags & UNDECIDED) != 0u && !is_apart(triangle_of(a, b, c), job.light, job.slack) {
        atomicStore(&results[job.number].is_near, 1u);
    }
}

fn put_face(i: u32, a: u32, b: u32, c: u32) {
    let at = job.faces + 3u * i;
    lists[at] = a;
    lists[at + 1u] = b;
    lists[at + 2u] = c;
    note_near(place_of(a), place_of(b), place_of(c));
}

fn add_face(a: u32, b: u32, c: u32) {
    put_face(atomicAdd(&results[job.number].faces, 1u), a, b, c);
}

// What is between the crossings of a triangle.
struct Crossed {
    // The crossing over which the triangle's walk leaves the light, and the other.
    leave: u32,
    entry: u32,
    curve: Curve,
    // The curve of the edge that is not crossed, from the exit to the entry, if that is a crease; and how near to it the crossings are.
    beside: Curve,
    nearness: vec2f,
    cut: Cut,
}

// 1 where a crossing is at wedge `w`, an end of its edge, and 0 where it is at the other end.
fn nearness(e: u32, w: u32) -> f32 {
    let u = points[crossing(e)].w;
    return select(u, 1.0 - u, ends_of_edge(e).x == w);
}

// Of triangle `t`, whose corner `k` is turned to the light and the next one is not.
fn crossed(t: u32, k: u32) -> Crossed {
    let second = wedge_of_corner(3u * t + (k + 1u) % 3u);
    let third = wedge_of_corner(3u * t + (k + 2u) % 3u);
    let has_two_turned = is_turned(third);
    let leave_edge = tables[job.triangle_edges + 3u * t + k];
    let entry_edge = tables[job.triangle_edges + 3u * t + (k + select(2u, 1u, has_two_turned)) % 3u];
    let leave = crossing(leave_edge);
    let entry = crossing(entry_edge);
    let start = points[leave].xyz;
    let curve = curve_on_surface(start, points[entry].xyz, points[leave + 2u].xyz, points[entry + 2u].xyz);
    var it = Crossed(leave, entry, curve, straight_curve(start, start), vec2f(0.0), Cut(0u, 1u));
    if (job.flags & CURVED) == 0u {
        return it;
    }
    let epsilon_m = chord_m(start);
    var pieces = curve_pieces(curve, 1.0, epsilon_m);
    let beside = tables[job.triangle_edges + 3u * t + (k + select(1u, 2u, has_two_turned)) % 3u];
    let bend = tables[job.bends + beside];
    if bend != beside && bend != NO_BEND {
        var along = curve_of_edge(beside);
        let from_wedge = select(second, wedge_of_corner(3u * t + k), has_two_turned);
        if ends_of_edge(beside).x != from_wedge {
            along = Curve(along.start + along.chord, -along.chord, -along.last, -along.first);
        }
        it.beside = along;
        it.nearness = vec2f(nearness(leave_edge, from_wedge), nearness(entry_edge, third));
        pieces = max(pieces, curve_pieces(along, 1.0, epsilon_m));
    }
    it.cut = cut_for(pieces);
    return it;
}

// Point `i` of the silhouette through a triangle, from the exit on. The surface bends with the crease at its border, of which normals say nothing; else one could
// cross the other.
fn crossed_place(it: Crossed, i: u32) -> vec3f {
    if i == 0u {
        return points[it.leave].xyz;
    }
    if i == it.cut.pieces {
        return points[it.entry].xyz;
    }
    let u = f32(i) / f32(it.cut.pieces);
    return curve_at(it.curve, u) + curve_bulge(it.beside, u) * mix(it.nearness.x, it.nearness.y, u);
}

// The cycle from the fin's foot at the exit, along the curve, down to the fold, and back along the dark corners.
fn add_crossed(t: u32, k: u32, it: Crossed) {
    let second = wedge_of_corner(3u * t + (k + 1u) % 3u);
    let third = wedge_of_corner(3u * t + (k + 2u) % 3u);
    let foot = it.leave + 1u;
    let last = it.cut.pieces + select(3u, 2u, is_turned(third));
    let face = atomicAdd(&results[job.number].faces, last);
    var before = it.leave;
    for (var i = 1u; i <= last; i++) {
        var here = it.entry;
        if i < it.cut.pieces {
            here = it.cut.first + i - 1u;
            points[here] = vec4f(crossed_place(it, i), 0.0);
        } else if i == last {
            here = VERTEX | tables[job.vertices + second];
        } else if i == it.cut.pieces + 1u {
            here = it.entry + 1u;
        } else if i == it.cut.pieces + 2u {
            here = VERTEX | tables[job.vertices + third];
        }
        put_face(face + i - 1u, foot, before, here);
        before = here;
    }
}

var<workgroup> cap_count: atomic<u32>;
var<workgroup> first_cap: u32;

@compute @workgroup_size(64)
fn find_faces(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) own: u32,
) {
    let t = thread(id, groups);
    // A bit for each corner that is turned to the light.
    var turned = 0u;
    // The corner from which the triangle's walk leaves the light, if it does.
    var k = 3u;
    if t < job.triangle_count {
        for (var i = 0u; i < 3u; i++) {
            turned |= select(0u, 1u << i, is_turned(wedge_of_corner(3u * t + i)));
        }
        for (var i = 0u; i < 3u; i++) {
            if ((turned >> i) & 1u) != 0u && ((turned >> ((i + 1u) % 3u)) & 1u) == 0u {
                k = i;
            }
        }
    }
    let is_in_cap = turned != 0u;
    var place = 0u;
    if is_in_cap && (job.flags & NEEDS_CAPS) != 0u {
        place = atomicAdd(&cap_count, 1u);
    }
    workgroupBarrier();
    if own == 0u {
        first_cap = atomicAdd(&results[job.number].caps, atomicLoad(&cap_count));
    }
    workgroupBarrier();
    if t >= job.triangle_count {
        return;
    }
    let corners = vec3u(wedge_of_corner(3u * t), wedge_of_corner(3u * t + 1u), wedge_of_corner(3u * t + 2u));
    if is_in_cap {
        if (job.flags & NEEDS_CAPS) != 0u {
            lists[job.caps + first_cap + place] = t;
        }
        note_near(place_of_wedge(corners.x), place_of_wedge(corners.y), place_of_wedge(corners.z));
    }
    if k < 3u {
        let it = crossed(t, k);
        add_crossed(t, k, it);
        add_pieces(corners, k, turned, it.leave, it.entry, it.cut);
    } else if (job.flags & CURVED) != 0u {
        add_pieces(corners, k, turned, 0u, 0u, Cut(0u, 0u));
    }
}

// What is drawn, now that it is known whether the body is counted by z-pass or by z-fail.
@compute @workgroup_size(1)
fn find_smooth_arguments() {
    let n = job.number;
    let sides = atomicLoad(&results[n].sides);
    let faces = 3u * atomicLoad(&results[n].faces);
    let caps = atomicLoad(&results[n].caps);
    let is_near = atomicLoad(&results[n].is_near) != 0u;
    let is_fail = (job.flags & FAILS) != 0u || ((job.flags & UNDECIDED) != 0u && is_near);
    let of_sides = sides * select(6u, 3u, (job.flags & DIRECTIONAL) != 0u);
    let in_pass = select(1u, 0u, is_fail);
    let in_fail = select(0u, 1u, is_fail);
    results[n].arguments[0] = vec4u(of_sides * in_pass, 1u, 0u, 0u);
    results[n].arguments[1] = vec4u(faces * in_pass, 1u, 0u, 0u);
    results[n].arguments[2] = vec4u(of_sides * in_fail, 1u, 0u, 0u);
    results[n].arguments[3] = vec4u(faces * in_fail, 1u, 0u, 0u);
    results[n].arguments[4] = vec4u(3u * sides * in_fail, 1u, 0u, 0u);
    results[n].arguments[5] = vec4u(9u * caps * in_fail, 1u, 0u, 0u);
    results[n].arguments[6] = vec4u(3u * faces * in_fail, 1u, 0u, 0u);
    results[n].arguments[7] = vec4u(3u * caps * in_fail, 1u, 0u, 0u);
}
