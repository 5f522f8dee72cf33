//! Simple bodies whose volumes and shadows have closed forms, and the few operations that join them.
//!
//! Everything here returns a [`Surface`]: vertices shared, z up, corners counter-clockwise seen from outside. All
//! are closed but [`sheet`]. Round things are inscribed: their vertices lie on the round surface, and the
//! closed forms given are those of the polyhedron itself, so they hold to rounding.
//!
//! ```
//! use glam::Vec3;
//! use umbrae_core::{Mesh, shapes};
//!
//! let tower = Mesh::new(shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 10.0, 30.0)))?;
//! assert_eq!(tower.triangles().len(), 12);
//! # Ok::<(), umbrae_core::MeshError>(())
//! ```

mod polygon;
mod sweep;

use std::f64::consts::TAU;

use glam::{Affine3A, DVec2, DVec3, Vec2, Vec3};
use rustc_hash::FxHashMap;

pub use sweep::{cone, cylinder, loft, prism, revolution, strut, tube};

use crate::Surface;

/// The axis-aligned box between two opposite corners: 12 triangles.
///
/// Under a sun at azimuth `a` and altitude `h`, a box of `w` east by `d` north by `z` up covers `w d` of the ground
/// and its shadow another `z (w |cos a| + d |sin a|) / tan h`.
///
/// # Panics
///
/// If `min` is not below `max` on every axis.
pub fn cuboid(min: Vec3, max: Vec3) -> Surface {
    assert!(min.cmplt(max).all(), "a box from {min} to {max} has no inside");
    let ring = |z| {
        vec![
            DVec3::new(min.x.into(), min.y.into(), z),
            DVec3::new(max.x.into(), min.y.into(), z),
            DVec3::new(max.x.into(), max.y.into(), z),
            DVec3::new(min.x.into(), max.y.into(), z),
        ]
    };
    loft(&[ring(min.z.into()), ring(max.z.into())])
}

/// The tetrahedron with these corners, in either order: 4 triangles.
///
/// Its volume is a sixth of the determinant of three edges at one corner.
pub fn tetrahedron(corners: [Vec3; 4]) -> Surface {
    let [a, b, c, d] = corners.map(Vec3::as_dvec3);
    let is_right_handed = (b - a).cross(c - a).dot(d - a) > 0.0;
    let triangles = if is_right_handed {
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    } else {
        [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]
    };
    Surface { positions: corners.to_vec(), triangles: triangles.to_vec(), ..Surface::default() }
}

/// An icosahedron, each triangle split into four `subdivisions` times, on a sphere: `20 * 4^subdivisions` triangles.
///
/// The volume and the shadow's area `pi r^2 / sin(altitude)` are those of the sphere from below: 4.6 % too small after
/// two subdivisions, a quarter of that after each one more.
pub fn icosphere(center: Vec3, radius: f32, subdivisions: u32) -> Surface {
    let golden = f64::midpoint(1.0, 5_f64.sqrt());
    // The twelve corners are the cyclic permutations of (0, +-1, +-golden).
    let mut directions: Vec<DVec3> = Vec::new();
    for axis in 0..3 {
        for (short, long) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
            let mut corner = [0.0; 3];
            corner[(axis + 1) % 3] = short;
            corner[(axis + 2) % 3] = long;
            directions.push(DVec3::from(corner));
        }
    }
    // Neighbours are two apart; three mutual neighbours are a face.
    let is_edge = |a: usize, b: usize| (directions[a].distance(directions[b]) - 2.0).abs() < 0.1;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if is_edge(a, b) && is_edge(b, c) && is_edge(c, a) {
                    let is_outward = directions[a].dot(directions[b].cross(directions[c])) > 0.0;
                    let [b, c] = if is_outward { [b, c] } else { [c, b] };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    for _ in 0..subdivisions {
        triangles = split_in_four(&mut directions, &triangles);
    }
    let positions =
        directions.iter().map(|d| (center.as_dvec3() + f64::from(radius) / d.length() * d).as_vec3()).collect();
    Surface { positions, triangles, ..Surface::default() }
}

/// Splits every triangle at the middles of its edges, which are appended to `directions`.
fn split_in_four(directions: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middle_of_edge: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let mut middle = |a: u32, b: u32| {
        *middle_of_edge.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            // On the unit sphere, or the middles would bunch up towards the old corners' middles.
            let [p, q] = [a, b].map(|i| directions[i as usize] / directions[i as usize].length());
            directions.push(0.5 * (p + q));
            directions.len() as u32 - 1
        })
    };
    let mut split = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        split.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    split
}

/// A ring lying flat: `2 * major_segments * minor_segments` triangles.
///
/// With `n` major and `m` minor segments its volume is `n sin(2 pi / n) R A`, where `A = m / 2 sin(2 pi / m) r^2`.
///
/// # Panics
///
/// If either number of segments is below 3.
pub fn torus(
    center: Vec3,
    major_radius: f32,
    minor_radius: f32,
    major_segments: usize,
    minor_segments: usize,
) -> Surface {
    assert!(major_segments.min(minor_segments) >= 3, "a torus needs three segments each way");
    let (n, m) = (major_segments, minor_segments);
    let mut surface = Surface::default();
    for i in 0..n {
        let outward = DVec2::from_angle(TAU * i as f64 / n as f64);
        for j in 0..m {
            let (sin, cos) = (TAU * j as f64 / m as f64).sin_cos();
            let flat = outward * (f64::from(major_radius) + f64::from(minor_radius) * cos);
            surface.positions.push((center.as_dvec3() + flat.extend(f64::from(minor_radius) * sin)).as_vec3());
            let at = |i: usize, j: usize| (i % n * m + j % m) as u32;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// A flat, open sheet of `cells[0]` by `cells[1]` cells, from `corner` along two edges: `2 * cells[0] * cells[1]`
/// triangles, facing along `edge_u x edge_v`.
///
/// Its area is `|edge_u x edge_v|`, its border has `2 * (cells[0] + cells[1])` edges.
pub fn sheet(corner: Vec3, edge_u: Vec3, edge_v: Vec3, cells: [u32; 2]) -> Surface {
    let [columns, rows] = cells;
    let mut surface = Surface::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let (u, v) = (f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
            let position = corner.as_dvec3() + u * edge_u.as_dvec3() + v * edge_v.as_dvec3();
            surface.positions.push(position.as_vec3());
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// Adds `other` to `surface`; vertices at equal positions stay apart until a [`crate::Mesh`] welds them.
///
/// What only one of the two has is completed: materials with 0, colours with white, texture coordinates with (0, 0), and normals with none.
pub fn append(surface: &mut Surface, other: &Surface) {
    let first = surface.positions.len() as u32;
    complete(
        &mut surface.triangle_materials,
        surface.triangles.len(),
        &other.triangle_materials,
        other.triangles.len(),
        0,
    );
    complete(
        &mut surface.vertex_colors,
        surface.positions.len(),
        &other.vertex_colors,
        other.positions.len(),
        Vec3::ONE,
    );
    let triangles = [surface.triangles.len(), other.triangles.len()];
    complete(&mut surface.corner_uvs, triangles[0], &other.corner_uvs, triangles[1], [Vec2::ZERO; 3]);
    complete(&mut surface.corner_normals, triangles[0], &other.corner_normals, triangles[1], [Vec3::ZERO; 3]);
    surface.positions.extend_from_slice(&other.positions);
    surface.triangles.extend(other.triangles.iter().map(|t| t.map(|i| first + i)));
}

/// Appends one optional list (empty, or one entry for each of `count` elements) to another.
fn complete<T: Copy>(list: &mut Vec<T>, count: usize, other: &[T], other_count: usize, neutral: T) {
    if list.is_empty() && other.is_empty() {
        return;
    }
    list.resize(count, neutral);
    list.extend_from_slice(other);
    list.resize(count + other_count, neutral);
}

/// All of `parts` as one surface, in order.
pub fn joined(parts: impl IntoIterator<Item = Surface>) -> Surface {
    let mut all = Surface::default();
    for part in parts {
        append(&mut all, &part);
    }
    all
}

/// `surface`, moved; a transform that mirrors also turns the triangles, so that outside stays outside. Of one that flattens, no normals are left.
pub fn transformed(mut surface: Surface, to_from_surface: Affine3A) -> Surface {
    // Normals stay across their surface, whatever happens to lengths along it.
    let normals_from_normals = to_from_surface.matrix3.inverse().transpose();
    for normal in surface.corner_normals.as_flattened_mut() {
        *normal = normals_from_normals * *normal;
    }
    for position in &mut surface.positions {
        *position = to_from_surface.transform_point3(*position);
    }
    if to_from_surface.matrix3.determinant() < 0.0 {
        surface.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        surface.corner_uvs.iter_mut().for_each(|corners| corners.swap(1, 2));
        surface.corner_normals.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    surface
}

#[cfg(test)]
mod tests;
