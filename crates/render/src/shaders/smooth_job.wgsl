// One smooth body under one light. Put before find_smooth.wgsl and found_smooth_volume.wgsl.

struct SmoothJob {
    // Of the light.
    position_world: vec4f,
    eye_world: vec3f,
    // The width of a pixel at view depth 1.
    pixel_at_1: f32,
    // All that may receive shadows is in the box.
    receivers_min: vec3f,
    epsilon_m: f32,
    receivers_max: vec3f,
    // 0 where the picture does not matter.
    epsilon_px: f32,
    // The first near vertex of the caster among positions, and its block.
    near: u32,
    axes: u32,
    flags: u32,
    // Among results.
    number: u32,
    // Among lights, and by how much boxes and planes are widened.
    light: u32,
    slack: f32,
    // The most by which a fold is moved into the body.
    most_inset_m: f32,
    inner_room: u32,
    // Where things begin in `tables`, and how many there are.
    vertices: u32,
    corner_starts: u32,
    wedge_count: u32,
    triangles: u32,
    triangle_edges: u32,
    triangle_count: u32,
    edges: u32,
    // Two of each edge.
    edge_triangles: u32,
    bends: u32,
    edge_count: u32,
    creases: u32,
    crease_count: u32,
    // Where things begin in `normals`, `heights`, `points` (those of crossings, and those between them) and `lists`.
    normals: u32,
    heights: u32,
    crossings: u32,
    inner: u32,
    sides: u32,
    faces: u32,
    caps: u32,
    // Among `points`, of each wedge where its vertex is moved inward to.
    inner_places: u32,
}

// Silhouettes are moved onto curves, and cut.
const CURVED: u32 = 1u;
const NEEDS_CAPS: u32 = 2u;
const UNDECIDED: u32 = 4u;
const FAILS: u32 = 8u;
const DIRECTIONAL: u32 = 16u;

// What a side or a face names is a point, or, with this bit, a vertex of the caster.
const VERTEX: u32 = 0x80000000u;
