//! A simple polygon into triangles, by cutting off ears.
//!
//! Source: G. H. Meisters, "Polygons have ears", 1975. Cubic in the worst case, which outlines of buildings never are.

use glam::DVec2;

/// The `n - 2` triangles of a simple, counter-clockwise polygon, themselves counter-clockwise; corners on a straight
/// edge are kept and make no flat triangle.
///
/// # Panics
///
/// If the polygon crosses itself, is clockwise or has no area.
pub(super) fn triangulate(outline: &[DVec2]) -> Vec<[u32; 3]> {
    let mut left: Vec<u32> = (0..outline.len() as u32).collect();
    let mut triangles = Vec::with_capacity(outline.len().saturating_sub(2));
    // Going round, instead of cutting at one corner for as long as possible, avoids fans of slivers.
    let mut at = 0;
    while left.len() >= 3 {
        let n = left.len();
        let ear = (0..n).map(|step| (at + step) % n).find(|&i| is_ear(outline, &left, i));
        let i = ear.expect("a simple polygon has an ear; this outline crosses itself or is clockwise");
        triangles.push([left[(i + n - 1) % n], left[i], left[(i + 1) % n]]);
        left.remove(i);
        at = i + 1;
    }
    triangles
}

/// Whether corner `i` of the polygon `left` is convex and its triangle holds no other corner, not even on an edge.
fn is_ear(outline: &[DVec2], left: &[u32], i: usize) -> bool {
    let n = left.len();
    let point = |i: usize| outline[left[i % n] as usize];
    let [a, b, c] = [point(i + n - 1), point(i), point(i + 1)];
    let is_left = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) >= 0.0;
    (b - a).perp_dot(c - a) > 0.0
        && !(i + 2..i + n - 1).any(|k| {
            let p = point(k);
            is_left(a, b, p) && is_left(b, c, p) && is_left(c, a, p)
        })
}
