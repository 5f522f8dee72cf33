// The curve between two points of a smooth surface: the same cubic as in `core/src/smooth/curve.rs`, which says why, in `f32`.

struct Curve {
    start: vec3f,
    chord: vec3f,
    first: vec3f,
    last: vec3f,
}

const MOST_PIECES: f32 = 256.0;

fn unit_or_zero(v: vec3f) -> vec3f {
    let size = length(v);
    if size == 0.0 {
        return vec3f(0.0);
    }
    return v / size;
}

// `direction` with the length with which the middle of a cubic lies on the arc that leaves `chord` in that direction.
fn scaled(direction: vec3f, chord: vec3f) -> vec3f {
    let unit = unit_or_zero(direction);
    let size = length(chord);
    if size == 0.0 || dot(unit, unit) == 0.0 {
        return chord;
    }
    let cosine = dot(unit, chord) / size;
    return select(unit, -unit, cosine < 0.0) * (2.0 * size / (1.0 + abs(cosine)));
}

fn curve_along(start: vec3f, end: vec3f, first: vec3f, last: vec3f) -> Curve {
    let chord = end - start;
    return Curve(start, chord, scaled(first, chord), scaled(last, chord));
}

fn curve_on_surface(start: vec3f, end: vec3f, first_normal: vec3f, last_normal: vec3f) -> Curve {
    let chord = end - start;
    return curve_along(
        start, end,
        chord - first_normal * dot(first_normal, chord),
        chord - last_normal * dot(last_normal, chord),
    );
}

fn straight_curve(start: vec3f, end: vec3f) -> Curve {
    return Curve(start, end - start, end - start, end - start);
}

fn curve_at(curve: Curve, u: f32) -> vec3f {
    let v = 1.0 - u;
    return curve.start + curve.chord * (u * u * (3.0 - 2.0 * u)) + (u * v) * (v * curve.first - u * curve.last);
}

fn curve_tangent(curve: Curve, u: f32) -> vec3f {
    return 6.0 * u * (1.0 - u) * curve.chord + (1.0 - u) * (1.0 - 3.0 * u) * curve.first + u * (3.0 * u - 2.0) * curve.last;
}

// How far the curve is from its chord.
fn curve_bulge(curve: Curve, u: f32) -> vec3f {
    return curve_at(curve, u) - (curve.start + curve.chord * u);
}

// How much of the curve's bend keeps it from going farther than `inward` in that direction from its chord.
fn curve_share_within(curve: Curve, inward: vec3f) -> f32 {
    let most = dot(inward, inward);
    let quarter = dot(curve_bulge(curve, 0.25), inward);
    let farthest = max(quarter, max(dot(curve_bulge(curve, 0.5), inward), dot(curve_bulge(curve, 0.75), inward)));
    if farthest > most {
        return most / farthest;
    }
    return 1.0;
}

fn flattened_curve(curve: Curve, share: f32) -> Curve {
    return Curve(curve.start, curve.chord, mix(curve.chord, curve.first, share), mix(curve.chord, curve.last, share));
}

// The unit normal of the surface at `u`, between those at the ends.
fn curve_normal(curve: Curve, u: f32, first_normal: vec3f, last_normal: vec3f) -> vec3f {
    let between = mix(first_normal, last_normal, u);
    let along = unit_or_zero(curve_tangent(curve, u));
    let across = unit_or_zero(between - along * dot(between, along));
    if dot(across, across) == 0.0 {
        return between;
    }
    return across;
}

// Into how many pieces the part of such a length in `u` must be cut.
fn curve_pieces(curve: Curve, span: f32, epsilon_m: f32) -> u32 {
    let a = length(6.0 * curve.chord - 4.0 * curve.first - 2.0 * curve.last);
    let b = length(6.0 * curve.chord - 2.0 * curve.first - 4.0 * curve.last);
    let count = abs(span) * sqrt(max(a, b) / (8.0 * epsilon_m));
    // Too many for a number come out as many.
    return u32(clamp(ceil(count), 1.0, MOST_PIECES));
}
