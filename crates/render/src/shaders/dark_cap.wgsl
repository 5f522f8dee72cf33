// What closes volumes at infinity, triangle by triangle: the same as in `shadow/emit.rs`.

// Of `axes` and the middle of the caster's box, which come before near vertices.
const MIDDLE: u32 = 6u;

// Out of every view. A triangle of three equal corners in view would be nothing too, but Mesa's llvmpipe then loses narrow ones beside it.
const NOWHERE: vec4f = vec4f(2.0, 2.0, 2.0, 1.0);

// The cosine, between the triangle's normal and the direction to a corner, below which all directions are nearly in one plane.
const FLAT: f32 = 0.05;

// The axis about which the cap must be a fan, or MIDDLE where it may be the triangle itself: `fan_axis` in `shadow/emit.rs` says why.
fn fan_axis(a: vec3f, b: vec3f, c: vec3f) -> u32 {
    if dot(a, b) >= 0.0 && dot(b, c) >= 0.0 && dot(c, a) >= 0.0 {
        return MIDDLE;
    }
    let normal_to_light = cross(b - a, c - a);
    if abs(dot(a, normal_to_light)) > FLAT * length(a) * length(normal_to_light) {
        return MIDDLE;
    }
    let sizes = abs(normal_to_light);
    var axis = 0u;
    if sizes.y > sizes.x {
        axis = 1u;
    }
    if sizes.z > max(sizes.x, sizes.y) {
        axis = 2u;
    }
    // The positive axes come before their opposites.
    return 2u * axis + select(0u, 1u, normal_to_light[axis] > 0.0);
}
