// One light. Put after view.wgsl, before each shader that needs it.

struct Light {
    // McGuire's homogeneous position: w = 1 a point, w = 0 the direction towards the light.
    position_world: vec4f,
    // Irradiance of a directional light; of a point light at 1 m.
    strength: vec3f,
    unused: f32,
}

@group(1) @binding(0) var<uniform> light: Light;

fn to_light(point_world: vec3f) -> vec3f {
    return light.position_world.xyz - point_world * light.position_world.w;
}
