//! Bodies made by moving an outline: straight up, around an axis, or along a path.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::polygon::triangulate;
use crate::Surface;

/// The closed body between outlines of equal length, each joined to the next by quads, the first and the last closed by
/// flat faces.
///
/// Seen from the end towards which they go, outlines are counter-clockwise. One of a single point is a tip. The
/// first and last must be flat and convex (or tips).
///
/// Triangles: for `k` outlines of `n` points, `2 n (k - 1) + 2 (n - 2)`; each tip has `2 (n - 1)` fewer.
///
/// # Panics
///
/// If the outlines differ in length and neither is a tip, or two tips follow each other.
pub fn loft(outlines: &[Vec<DVec3>]) -> Surface {
    let fan = |n: usize| (2..n as u32).map(|i| [0, i - 1, i]).collect::<Vec<_>>();
    let ends = [outlines.first(), outlines.last()].map(|outline| fan(outline.map_or(0, Vec::len)));
    loft_with_ends(outlines, &ends)
}

/// [`loft`] with given triangles for the two flat ends; both indexed from the start of their own outline, and both
/// counter-clockwise seen from the end towards which the outlines go.
fn loft_with_ends(outlines: &[Vec<DVec3>], ends: &[Vec<[u32; 3]>; 2]) -> Surface {
    let mut surface = Surface::default();
    surface.triangles.extend(ends[0].iter().map(|&[a, b, c]| [a, c, b]));
    let mut start = 0;
    for pair in outlines.windows(2) {
        let next = start + pair[0].len() as u32;
        let (n, m) = (pair[0].len() as u32, pair[1].len() as u32);
        assert!((n == m && n > 1) || (n == 1) != (m == 1), "outlines of {n} and {m} points can't be joined");
        for i in 0..n.max(m) {
            let j = (i + 1) % n.max(m);
            if n > 1 {
                surface.triangles.push([start + i, start + j, next + if m == 1 { 0 } else { j }]);
            }
            if m > 1 {
                surface.triangles.push([start + if n == 1 { 0 } else { i }, next + j, next + i]);
            }
        }
        start = next;
    }
    surface.triangles.extend(ends[1].iter().map(|t| t.map(|i| start + i)));
    surface.positions = outlines.iter().flatten().map(|p| p.as_vec3()).collect();
    surface
}

/// The upright prism over a simple polygon, given in either direction: `4 n - 4` triangles for `n` corners.
///
/// Its volume is the polygon's area times the height.
///
/// # Panics
///
/// If the outline crosses itself or has no area, or `bottom` is not below `top`.
pub fn prism(outline: &[Vec2], bottom: f32, top: f32) -> Surface {
    assert!(bottom < top, "a prism from {bottom} up to {top} has no inside");
    let mut outline: Vec<DVec2> = outline.iter().map(|p| p.as_dvec2()).collect();
    let twice_area: f64 = (0..outline.len()).map(|i| outline[i].perp_dot(outline[(i + 1) % outline.len()])).sum();
    if twice_area < 0.0 {
        outline.reverse();
    }
    let end = triangulate(&outline);
    let ring = |z: f32| outline.iter().map(|p| p.extend(z.into())).collect();
    loft_with_ends(&[ring(bottom), ring(top)], &[end.clone(), end])
}

/// A profile of (distance from the axis, height above `base`), listed upwards, turned around the vertical
/// through `base`: the first corner of every ring lies to the east.
///
/// A first or last point on the axis is a tip, else that end is closed by a flat face. The volume of the polyhedron is
/// `sides / 2 * sin(2 pi / sides)` times the integral of the squared distance over the height.
///
/// # Panics
///
/// If there are fewer than 3 sides, or a point other than the first or last lies on the axis.
pub fn revolution(base: Vec3, profile: &[Vec2], sides: usize) -> Surface {
    assert!(sides >= 3, "{sides} sides enclose nothing");
    let outlines: Vec<Vec<DVec3>> = profile
        .iter()
        .map(|p| {
            let point = |i: usize| {
                let flat = DVec2::from_angle(TAU * i as f64 / sides as f64) * f64::from(p.x);
                base.as_dvec3() + flat.extend(p.y.into())
            };
            (0..if p.x == 0.0 { 1 } else { sides }).map(point).collect()
        })
        .collect();
    loft(&outlines)
}

/// An upright cylinder standing on `base`: `4 sides - 4` triangles.
///
/// Its shadow on the plane of its base, the base included, tends to `pi r^2 + 2 r h / tan(altitude)`.
///
/// # Panics
///
/// If there are fewer than 3 sides.
pub fn cylinder(base: Vec3, radius: f32, height: f32, sides: usize) -> Surface {
    revolution(base, &[Vec2::new(radius, 0.0), Vec2::new(radius, height)], sides)
}

/// An upright cone standing on `base`: `2 sides - 2` triangles.
///
/// # Panics
///
/// If there are fewer than 3 sides.
pub fn cone(base: Vec3, radius: f32, height: f32, sides: usize) -> Surface {
    revolution(base, &[Vec2::new(radius, 0.0), Vec2::new(0.0, height)], sides)
}

/// A straight bar from `from` to `to` with a regular section: `4 sides - 4` triangles; see [`tube`].
///
/// # Panics
///
/// If there are fewer than 3 sides, or the ends are equal.
pub fn strut(from: Vec3, to: Vec3, radius: f32, sides: usize) -> Surface {
    tube(&[from, to], radius, sides)
}

/// A bar along `path` with a regular section and mitred joints: `2 sides (points - 1) + 2 (sides - 2)` triangles.
///
/// `radius` reaches to the corners of the section. With four sides the first piece has two upright faces, and stands
/// along the axes where the path starts vertically. The volume is the section's area times the path's length. A
/// path that turns back sharply in pieces shorter than the bar is thick gives a body that crosses itself.
///
/// # Panics
///
/// If there are fewer than 3 sides or 2 points, or two consecutive points are equal or the path turns straight back.
pub fn tube(path: &[Vec3], radius: f32, sides: usize) -> Surface {
    assert!(sides >= 3 && path.len() >= 2, "{sides} sides along {} points enclose nothing", path.len());
    let path: Vec<DVec3> = path.iter().map(|p| p.as_dvec3()).collect();
    let directions: Vec<DVec3> = path
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).try_normalize().expect("consecutive points of a path differ"))
        .collect();
    let along = directions[0];
    let across = if along.z.abs() < NEARLY_VERTICAL { DVec3::Z.cross(along) } else { DVec3::Y.cross(along) };
    let u = across.normalize_or_zero();
    let v = along.cross(u);
    // Half a step round, so that the faces of a square section, not its corners, look along u and v.
    let mut outline: Vec<DVec3> = (0..sides)
        .map(|i| DVec2::from_angle(TAU * (i as f64 + 0.5) / sides as f64) * f64::from(radius))
        .map(|p| path[0] + p.x * u + p.y * v)
        .collect();
    let mut outlines = vec![outline.clone()];
    for (i, &along) in directions.iter().enumerate() {
        // Slide the outline along this piece onto the plane that halves the angle to the next.
        let next = directions.get(i + 1).copied().unwrap_or(along);
        let mitre = (along + next).try_normalize().expect("a path does not turn straight back");
        for point in &mut outline {
            *point += along * ((path[i + 1] - *point).dot(mitre) / along.dot(mitre));
        }
        outlines.push(outline.clone());
    }
    loft(&outlines)
}

/// Sine of the angle with the ground from which a bar counts as vertical, where "up" no longer fixes its section;
/// any value below 1 would do, this keeps all but masts upright-sided.
const NEARLY_VERTICAL: f64 = 0.999;
