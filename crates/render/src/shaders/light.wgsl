// One light. Put after view.wgsl, before each shader that needs it.

struct Light {
    // McGuire's homogeneous position: w = 1 a point, w = 0 the direction towards the light.
    position_world: vec4f,
    // Irradiance of a directional light; of a point light at 1 m.
    strength: vec3f,
    // The distance at which a point light has faded to nothing; the largest f32 where it never does.
    range_m: f32,
    // Where a spot light shines, and its outer angle. All around: axis 0 and such an angle that nothing is outside.
    axis_world: vec3f,
    cos_outer: f32,
    sin_outer: f32,
    cos_inner: f32,
    unused_a: f32,
    unused_b: f32,
}

@group(1) @binding(0) var<uniform> light: Light;

fn to_light(point_world: vec3f) -> vec3f {
    return offset_to_light(light, point_world);
}

// From the point to the light: the whole way to a point light, the unit direction to one at infinity.
fn offset_to_light(source: Light, point_world: vec3f) -> vec3f {
    return source.position_world.xyz - point_world * source.position_world.w;
}

// Whether a light that is `offset` away shines here, if nothing is between: in its range and in its cone, borders not.
//
// The angle is compared by its sine and cosine together, which is as precise for a narrow cone as for half of space.
fn reaches(source: Light, offset: vec3f) -> bool {
    let along = dot(source.axis_world, -offset);
    let across = length(-offset - source.axis_world * along);
    let is_outside = across * source.cos_outer >= along * source.sin_outer;
    let is_beyond = length(offset) >= source.range_m;
    return !(is_outside || is_beyond);
}

// What is left of the strength `offset` away: inverse square, glTF's window for the range, and the square of a ramp between the cone's angles.
// For a directional light 1. Where the light does not reach, something meaningless.
fn attenuation(source: Light, offset: vec3f) -> f32 {
    if source.position_world.w < 0.5 {
        return 1.0;
    }
    let distance_squared = dot(offset, offset);
    let share = distance_squared / source.range_m / source.range_m;
    let window = clamp(1.0 - share * share, 0.0, 1.0);
    let cosine = dot(source.axis_world, -offset) * inverseSqrt(distance_squared);
    let ramp = clamp((cosine - source.cos_outer) / max(source.cos_inner - source.cos_outer, 1e-6), 0.0, 1.0);
    return window * ramp * ramp / distance_squared;
}
