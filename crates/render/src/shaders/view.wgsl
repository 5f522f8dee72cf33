// What every pass knows: the camera and the light of the surroundings. Put before each shader that needs it.

struct View {
    clip_from_world: mat4x4f,
    eye_world: vec3f,
    // Always 1. A literal 1 would let a compiler simplify one shader's transform and not another's.
    unit: f32,
    // Half the picture's width and height at view depth 1, as vectors; and the view direction.
    right_world: vec3f,
    exposure: f32,
    up_world: vec3f,
    fade_start: f32,
    forward_world: vec3f,
    fade_end: f32,
    fade_center_world: vec3f,
    unused: f32,
}

@group(0) @binding(0) var<uniform> view: View;

// The one way from scene space to clip space, so that scene, caps and sides land on the same bits.
// `w` is 1 for a point and 0 for a direction, that is, a point at infinity, which lands on depth 0.
fn clip_position(homogeneous_world: vec4f) -> vec4f {
    return view.clip_from_world * homogeneous_world;
}
