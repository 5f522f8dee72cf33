// One caster under one light. Put before find.wgsl and found_volume.wgsl.

struct Job {
    // The first near vertex and the first far one, and the first of the axes for caps, among positions.
    near: u32,
    far: u32,
    axes: u32,
    // Where the mesh's edges and triangles begin in `tables`.
    edges: u32,
    triangles: u32,
    // Where sides and caps begin in `lists`.
    sides: u32,
    caps: u32,
    flags: u32,
    box_min: vec3f,
    // Nearer to a plane than this is in it.
    edge_on: f32,
    box_max: vec3f,
    // Boxes are widened by this.
    slack: f32,
}

const SEE_THROUGH: u32 = 1u;
const NEEDS_CAPS: u32 = 2u;
const UNDECIDED: u32 = 4u;
const FAILS: u32 = 8u;
const DIRECTIONAL: u32 = 16u;
const FAN: u32 = 32u;
// The boxes of components are not known: `box_min` and `box_max` hold all of it.
const MOVED: u32 = 64u;
