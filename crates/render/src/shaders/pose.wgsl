// Moves an object: `pose_vertices` for each vertex of its mesh, then `pose_triangles` for each triangle.
// What is drawn and what casts get the same bits, as each position is computed once. Needs flat_normal.wgsl.

struct Posed {
    vertex_count: u32,
    triangle_count: u32,
    // The first near and the first far vertex in `volume`.
    near: u32,
    far: u32,
    // Where things begin in `at_rest`: three words for each vertex; for each morph target three for each vertex; for each vertex of a
    // skin its first influence and the one after the last; a joint and a weight for each influence; three vertices for each triangle;
    // and for each triangle where it is in `surface`, in triangles.
    positions: u32,
    offsets: u32,
    ranges: u32,
    influences: u32,
    triangles: u32,
    places: u32,
    // Where things begin in `now`: a weight for each morph target; three rows of four for each joint.
    weights: u32,
    joints: u32,
    // Of the object, in scene space.
    origin_world: vec3f,
    morph_count: u32,
    // 0 or 1: without a skin there is one matrix.
    has_skin: u32,
    time_s: f32,
    // How far `moved` may take a vertex, in metres; 0 where it does not move this object.
    max_offset: f32,
    unused: u32,
}

@group(0) @binding(0) var<uniform> posed: Posed;
@group(0) @binding(1) var<storage, read> at_rest: array<u32>;
@group(0) @binding(2) var<storage, read> now: array<f32>;
// Positions with what says how they are extruded.
@group(0) @binding(3) var<storage, read_write> volume: array<vec4u>;
// Vertices of `SURFACE_WORDS`: position, normal, colour and texture coordinates.
@group(0) @binding(4) var<storage, read_write> surface: array<u32>;

const SURFACE_WORDS: u32 = 9u;
// In a vertex's colour; see gpu_scene.rs.
const FLAT: u32 = 0xFF000000u;
const GROUP_SIZE: u32 = 64u;
// The bits of 0.0 and 1.0; see volume.wgsl.
const NEAR: u32 = 0u;
const FAR: u32 = 0x3F800000u;

fn rest_vector(word: u32) -> vec3f {
    return bitcast<vec3f>(vec3u(at_rest[word], at_rest[word + 1u], at_rest[word + 2u]));
}

fn moved_by(joint: u32, p: vec3f) -> vec3f {
    let m = posed.joints + 12u * joint;
    return vec3f(
        now[m] * p.x + now[m + 1u] * p.y + now[m + 2u] * p.z + now[m + 3u],
        now[m + 4u] * p.x + now[m + 5u] * p.y + now[m + 6u] * p.z + now[m + 7u],
        now[m + 8u] * p.x + now[m + 9u] * p.y + now[m + 10u] * p.z + now[m + 11u],
    );
}

fn posed_position(v: u32) -> vec3f {
    var p = rest_vector(posed.positions + 3u * v);
    for (var target_index = 0u; target_index < posed.morph_count; target_index++) {
        let weight = now[posed.weights + target_index];
        // Most targets of a face are at 0, and each is memory elsewhere.
        if weight != 0.0 {
            p += weight * rest_vector(posed.offsets + 3u * (target_index * posed.vertex_count + v));
        }
    }
    if posed.has_skin == 0u {
        return moved_by(0u, p);
    }
    var sum = vec3f(0.0);
    var weights = 0.0;
    let end = at_rest[posed.ranges + 2u * v + 1u];
    for (var i = at_rest[posed.ranges + 2u * v]; i < end; i++) {
        let weight = bitcast<f32>(at_rest[posed.influences + 2u * i + 1u]);
        sum += weight * moved_by(at_rest[posed.influences + 2u * i], p);
        weights += weight;
    }
    // Joints take vertices to scene space here, where the sum of their weights matters: what it lacks of 1 must not move the object.
    return sum + (1.0 - weights) * posed.origin_world;
}

// Where `moved` has it, but no farther than boxes hold. That function comes before or after this file; see displacement.rs.
fn shown_position(v: u32) -> vec3f {
    let p = posed_position(v);
    if posed.max_offset == 0.0 {
        return p;
    }
    let to = moved(p, v, posed.time_s);
    let size = length(to - p);
    if size > posed.max_offset {
        return p + (to - p) * (posed.max_offset / size);
    }
    return to;
}

// Of two dimensions, as one can't have enough groups.
fn thread(id: vec3u, groups: vec3u) -> u32 {
    return id.y * groups.x * GROUP_SIZE + id.x;
}

@compute @workgroup_size(64)
fn pose_vertices(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let v = thread(id, groups);
    if v >= posed.vertex_count {
        return;
    }
    let bits = bitcast<vec3u>(shown_position(v));
    // Adding +0 would turn -0 into +0 too, but a compiler may drop that.
    let position = select(bits, vec3u(0u), bits == vec3u(0x80000000u));
    volume[posed.near + v] = vec4u(position, NEAR);
    volume[posed.far + v] = vec4u(position, FAR);
}

@compute @workgroup_size(64)
fn pose_triangles(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let t = thread(id, groups);
    if t >= posed.triangle_count {
        return;
    }
    var corners: array<vec3u, 3>;
    for (var i = 0u; i < 3u; i++) {
        corners[i] = volume[posed.near + at_rest[posed.triangles + 3u * t + i]].xyz;
    }
    let normal = bitcast<vec3u>(
        flat_normal(bitcast<vec3f>(corners[0]), bitcast<vec3f>(corners[1]), bitcast<vec3f>(corners[2]))
    );
    for (var i = 0u; i < 3u; i++) {
        let word = SURFACE_WORDS * (3u * at_rest[posed.places + t] + i);
        for (var axis = 0u; axis < 3u; axis++) {
            surface[word + axis] = corners[i][axis];
            surface[word + 3u + axis] = normal[axis];
        }
        // Normals to shade with were those of another pose: what moves here is flat.
        surface[word + 6u] |= FLAT;
    }
}
