// Whether a triangle may be between a light and the near rectangle. Needs a `finding`, `lights` and flat_normal.wgsl.

struct Finding {
    light_count: u32,
    // Of coefficients, for each triangle.
    words: u32,
    job_count: u32,
    // Each block has two words in `tables`.
    triangle_blocks: u32,
    triangle_block_count: u32,
    edge_blocks: u32,
    edge_block_count: u32,
    unused: u32,
    // The box around the near rectangle, and its corners.
    near_min: vec4f,
    near_max: vec4f,
    near_corners: array<vec4f, 4>,
}

struct FoundLight {
    position_world: vec4f,
    // The hull of the light and the near rectangle: the inner side of these.
    plane_count: u32,
    unused_a: u32,
    unused_b: u32,
    unused_c: u32,
    planes: array<vec4f, 16>,
}

struct Triangle {
    corners: array<vec3f, 3>,
    // Counter-clockwise, about as long as the triangle is wide for its length; 0 for corners on one line.
    normal: vec3f,
    normal_length: f32,
}

fn triangle_of(a: vec3f, b: vec3f, c: vec3f) -> Triangle {
    let normal = scaled_normal(a, b, c);
    return Triangle(array<vec3f, 3>(a, b, c), normal, length(normal));
}

fn offset_from(homogeneous: vec4f, point: vec3f) -> vec3f {
    return homogeneous.xyz - point * homogeneous.w;
}

// A direction with a smaller sine to a plane may be in it.
const PARALLEL: f32 = 8e-6;
// The normal of edges of about 1 is rounded by less than this.
const NORMAL_ROUNDING: f32 = 2e-6;

// 1 or -1 for the side of the triangle's plane on which a point is, given from its first corner; 0 where that is not sure.
fn side_of(triangle: Triangle, offset: vec3f, slack: f32) -> i32 {
    let height = dot(triangle.normal, offset);
    let margin = slack * triangle.normal_length + NORMAL_ROUNDING * length(offset);
    return select(0, 1, height > margin) - select(0, 1, height < -margin);
}

// Whether nothing of the triangle is between the light and the near rectangle: all of it is outside of one plane of their hull, or the hull is on
// one side of its plane. In doubt not.
fn is_apart(triangle: Triangle, light: u32, slack: f32) -> bool {
    for (var i = 0u; i < lights[light].plane_count; i++) {
        let plane = lights[light].planes[i];
        let a = dot(plane.xyz, triangle.corners[0]) + plane.w;
        let b = dot(plane.xyz, triangle.corners[1]) + plane.w;
        let c = dot(plane.xyz, triangle.corners[2]) + plane.w;
        if max(a, max(b, c)) < 0.0 {
            return true;
        }
    }
    let position = lights[light].position_world;
    let side = side_of(triangle, offset_from(position, triangle.corners[0]), select(slack, PARALLEL, position.w == 0.0));
    for (var i = 0u; i < 4u; i++) {
        if side != side_of(triangle, finding.near_corners[i].xyz - triangle.corners[0], slack) {
            return false;
        }
    }
    return side != 0;
}
