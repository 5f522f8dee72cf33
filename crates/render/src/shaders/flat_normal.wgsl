// Normals of triangles.

fn largest(v: vec3f) -> f32 {
    return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

// Across the triangle, of edges of about 1, so that nothing overflows or underflows; 0 for corners in one place or on one line. From the two shorter
// edges: of the three pairs their product loses the least.
fn scaled_normal(a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    let scale = max(largest(b - a), largest(c - a));
    if scale == 0.0 {
        return vec3f(0.0);
    }
    let ab = (b - a) / scale;
    let bc = (c - b) / scale;
    let ca = (a - c) / scale;
    if dot(ab, ab) > max(dot(bc, bc), dot(ca, ca)) {
        return cross(bc, ca);
    }
    if dot(bc, bc) > dot(ca, ca) {
        return cross(ca, ab);
    }
    return cross(ab, bc);
}

// Of unit length, or 0 for corners on one line.
fn flat_normal(a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    let normal = scaled_normal(a, b, c);
    let size = largest(normal);
    if size == 0.0 {
        return vec3f(0.0);
    }
    return normalize(normal / size);
}
