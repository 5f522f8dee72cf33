// How much of a light each caster covers: its hard volume, counted, and the penumbra wedges of its silhouette's edges. Needs view.wgsl, light.wgsl,
// volume.wgsl, light_face.wgsl, and `seen_depth` of soft_depth.wgsl or soft_depth_samples.wgsl.
//
// Whether a point is on the inner side of an edge decides both whether the hard count takes it in and the sign of the edge's share. One
// expression in one shader says it for both, so that they never disagree where the edge passes the light's centre: no seam is left along the hard boundary.

const SIDE = 0u;
const WEDGE = 1u;

// Where a face is nearer to what is seen than this share of its depth, or this, the edge tells which is in front, and not depth.
const NEAR_SHARE = 1e-3;
const NEAR = 2e-6;
// Hulls are widened by this share, for rounding: an edge adds nothing next to its hull's border.
const SLACK = 1.01;

struct Segment {
    @location(0) start_world: vec3f,
    // 1 where its caster is counted by z-fail.
    @location(1) is_fail: f32,
    @location(2) end_world: vec3f,
}

struct Covering {
    @builtin(position) @invariant clip: vec4f,
    // From the eye.
    @location(0) @interpolate(flat) start: vec3f,
    @location(1) @interpolate(flat) end: vec3f,
    @location(2) @interpolate(flat) kind: u32,
    @location(3) @interpolate(flat) is_fail: f32,
}

// The side of the hard volume: two triangles, of which the second is nothing for a directional light.
@vertex
fn vs_side(segment: Segment, @builtin(vertex_index) i: u32) -> Covering {
    let is_end = i == 4u || i == 2u || i == 5u;
    let is_far = i == 1u || i == 2u || i == 4u;
    let point = select(segment.start_world, segment.end_world, is_end);
    return Covering(
        volume_position(vec4f(point, select(0.0, 1.0, is_far))),
        segment.start_world - view.eye_world,
        segment.end_world - view.eye_world,
        SIDE,
        segment.is_fail,
    );
}

// Corners of a hull: 0 and 1 the ends of the edge, 2 to 5 at infinity: behind the start to the left and right, behind the end to the left and right.
// Triangles are counter-clockwise seen from inside.
const HULL = array<u32, 24>(0, 3, 2, 1, 4, 5, 0, 2, 4, 0, 4, 1, 0, 1, 5, 0, 5, 3, 2, 3, 5, 2, 5, 4);

// A body around all from where the edge is seen in front of the light.
//
// With both ends equally far from the light, a prism does that opens to infinity, whose four planes touch the ball of the light.
// An end that is farther is moved towards the light, from where its share of the body is wider.
@vertex
fn vs_wedge(segment: Segment, @builtin(vertex_index) i: u32) -> Covering {
    let from_light = light.position_world.xyz;
    var a = segment.start_world;
    var b = segment.end_world;
    var away = -from_light;
    var along = b - a;
    // Tangents by which the body opens across the edge and beyond its ends.
    var across_tan = extent.radius;
    var along_tan = extent.radius;
    var is_everywhere = false;
    if light.position_world.w < 0.5 {
        let height_a = dot(a, from_light);
        let height_b = dot(b, from_light);
        a += from_light * max(height_b - height_a, 0.0);
        b += from_light * max(height_a - height_b, 0.0);
        along = b - a;
    } else {
        let far_a = length(a - from_light);
        let far_b = length(b - from_light);
        let nearest = min(far_a, far_b);
        a = from_light + (a - from_light) * (nearest / far_a);
        b = from_light + (b - from_light) * (nearest / far_b);
        along = b - a;
        let middle = 0.5 * (a + b) - from_light;
        let height = length(middle);
        let radius = extent.radius * SLACK;
        // Also where the ends are on different sides of the light.
        is_everywhere = !(height > 1.001 * radius);
        away = middle / height;
        // Of the angle under which half the edge is seen and that of the light's ball beyond.
        let edge_tan = 0.5 * length(along) / height;
        let ball_tan = radius / sqrt(max(nearest * nearest - radius * radius, 1e-30));
        across_tan = radius / sqrt(max(height * height - radius * radius, 1e-30));
        along_tan = (edge_tan + ball_tan) / max(1.0 - edge_tan * ball_tan, 1e-6);
    }
    across_tan *= SLACK;
    along_tan *= SLACK;
    let length_of = length(along);
    // Seen end-on, any direction will do.
    let any = normalize(cross(away, select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(away.x) > 0.7)));
    var u = any;
    if length_of > 1e-6 * max(length(a), length(b)) {
        u = normalize(along - away * dot(along, away));
    }
    let v = cross(away, u);

    let corner = HULL[i];
    var homogeneous = vec4f(a, view.unit);
    if corner == 1u {
        homogeneous = vec4f(b, view.unit);
    } else if corner > 1u {
        let is_of_end = corner > 3u;
        let is_right = (corner & 1u) == 1u;
        let direction = away + u * select(-along_tan, along_tan, is_of_end) + v * select(-across_tan, across_tan, is_right);
        homogeneous = vec4f(direction, 0.0);
    }
    var clip = clip_position(homogeneous);
    if is_everywhere {
        // One triangle that covers the picture, behind everything.
        let everywhere = array<vec2f, 3>(vec2f(-1.0, -1.0), vec2f(3.0, -1.0), vec2f(-1.0, 3.0));
        clip = vec4f(everywhere[min(i, 2u)], 0.0, 1.0);
    }
    return Covering(clip, segment.start_world - view.eye_world, segment.end_world - view.eye_world, WEDGE, 0.0);
}

// From the eye to what is seen at depth `z`.
fn seen_point(at: vec2f, z: f32) -> vec3f {
    let screen = at / seen_size() * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let direction = view.forward_world + screen.x * view.right_world + screen.y * view.up_world;
    return direction * (view.clip_from_world[3].z / z);
}

fn coverage(covering: Covering, is_front: bool, seen_z: f32) -> vec4f {
    if seen_z == 0.0 {
        return vec4f(0.0);
    }
    let point = seen_point(covering.clip.xy, seen_z);
    let face = light_face(point);
    let start = covering.start - point;
    let end = covering.end - point;
    let is_inner = is_around_center(face, start, end);
    if covering.kind == SIDE {
        let lead = covering.clip.z - seen_z;
        var is_in_front = lead > 0.0;
        if abs(lead) < max(NEAR_SHARE * seen_z, NEAR) {
            // From outside the eye looks through a front to what is inside.
            is_in_front = is_inner == is_front;
        }
        let sign = select(-1.0, 1.0, is_front);
        let is_fail = covering.is_fail > 0.5;
        return vec4f(select(0.0, select(sign, -sign, is_fail), is_in_front != is_fail));
    }
    // What is seen may be behind the hull.
    if covering.clip.z > seen_z * 1.0001 {
        return vec4f(0.0);
    }
    return edge_shares(face, start, end);
}

struct Cap {
    @builtin(position) @invariant clip: vec4f,
    // 1 where depth has to tell whether it is behind what is seen.
    @location(0) @interpolate(flat) is_compared: f32,
}

// Caps are drawn for z-fail alone: as they are on what is seen or at infinity, they are behind it by definition, but for those of glass and cut-outs.
@vertex
fn vs_cap(@location(0) vertex: vec4f) -> Cap {
    return Cap(volume_position(vertex), 0.0);
}

@vertex
fn vs_compared_cap(@location(0) vertex: vec4f) -> Cap {
    return Cap(volume_position(vertex), 1.0);
}

fn cap_coverage(cap: Cap, is_front: bool, seen_z: f32) -> vec4f {
    let is_behind = cap.is_compared < 0.5 || cap.clip.z <= seen_z * 1.00001;
    return vec4f(select(0.0, select(1.0, -1.0, is_front), is_behind));
}
