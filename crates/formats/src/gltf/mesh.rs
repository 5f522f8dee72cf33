//! A glTF mesh as one surface: all its primitives that are triangles, where they were modelled, and what moves their vertices.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use umbrae_core::Surface;

use super::accessor::Accessors;
use super::deform::Deformation;
use super::document::{Attributes, Mesh, Primitive};
use super::texture::{UvSource, add_corner_uvs};
use crate::warnings::{Warnings, Words};

/// Materials by number, each with its texture coordinates if it has a texture; there is one more for primitives that have none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Materials<'a>(pub(super) &'a [Option<UvSource>]);

/// The surface of `mesh`, without triangles if none of its primitives has any, and what moves its vertices: morph targets, and if
/// `has_skin` joints. Its normals, if someone `wants_normals`, are those of the mesh at rest.
///
/// What is wrong is said in words that fit after "mesh 3: ".
pub(super) fn surface(
    mesh: &Mesh,
    has_skin: bool,
    wants_normals: bool,
    accessors: &Accessors<'_>,
    materials: Materials<'_>,
    warnings: &mut Warnings,
) -> Result<(Surface, Deformation), String> {
    let mut merged = Merged { wants_normals, ..Merged::default() };
    for (index, primitive) in mesh.primitives.iter().enumerate() {
        if let Some(words) = skipped_mode(primitive.mode) {
            warnings.add(1, words);
            continue;
        }
        merged
            .add((index, primitive), has_skin, accessors, materials, warnings)
            .map_err(|message| format!("primitive {index}: {message}"))?;
    }
    let Merged { mut surface, deformation, normals, .. } = merged;
    if !normals.is_empty() {
        accessors.charge(surface.triangles.len(), 9)?;
        let normal = |v: u32| normals.get(v as usize).copied().unwrap_or_default();
        surface.corner_normals = surface.triangles.iter().map(|corners| corners.map(normal)).collect();
    }
    if !deformation.is_none() {
        surface.weld_keys = deformation.weld_keys();
    }
    Ok((surface, deformation))
}

fn skipped_mode(mode: u32) -> Option<Words> {
    match mode {
        0 => Some(["point primitive was skipped", "point primitives were skipped"]),
        1..=3 => Some(["line primitive was skipped", "line primitives were skipped"]),
        _ => None,
    }
}

/// The primitives of a mesh so far.
#[derive(Debug, Default)]
struct Merged<'a> {
    surface: Surface,
    deformation: Deformation,
    wants_normals: bool,
    /// One for each vertex up to the last that has one, zero for others.
    normals: Vec<Vec3>,
    /// Primitives of different materials often share their vertices: for what makes these, the first and the count.
    blocks: BTreeMap<(&'a Attributes, &'a [Attributes]), (u32, usize)>,
}

impl<'a> Merged<'a> {
    fn add(
        &mut self,
        (index, primitive): (usize, &'a Primitive),
        has_skin: bool,
        accessors: &Accessors<'_>,
        materials: Materials<'_>,
        warnings: &mut Warnings,
    ) -> Result<(), String> {
        let (first, vertex_count) = self.vertices((index, primitive), has_skin, accessors, warnings)?;
        let indices = match primitive.indices {
            Some(accessor) => {
                let indices = accessors.indices(accessor)?;
                if let Some(i) = indices.iter().position(|&index| index as usize >= vertex_count) {
                    let index = indices[i];
                    return Err(format!(
                        "index {i} of accessor {accessor} is vertex {index}, but there are {vertex_count}"
                    ));
                }
                indices
            }
            None => (0..vertex_count as u32).collect(),
        };
        let before = self.surface.triangles.len();
        let unused = add_triangles(primitive.mode, &indices, first, &mut self.surface.triangles)?;
        warnings.add(
            unused,
            ["index beyond the last whole triangle was skipped", "indices beyond the last whole triangle were skipped"],
        );
        let material = match primitive.material {
            Some(material) if material < materials.0.len() => material,
            Some(material) => {
                let words = ["material that does not exist was replaced", "materials that do not exist were replaced"];
                warnings.add_one(words, || format!("material {material} of {}", materials.0.len()));
                materials.0.len()
            }
            None => materials.0.len(),
        };
        let added = self.surface.triangles.len() - before;
        self.surface.triangle_materials.extend(std::iter::repeat_n(material as u32, added));
        let source = materials.0.get(material).copied().flatten();
        let vertices = (first, vertex_count);
        add_corner_uvs(&mut self.surface, before, vertices, &primitive.attributes, source, accessors, warnings);
        Ok(())
    }

    /// Adds the vertices of a primitive unless they are there already; the first and their count.
    fn vertices(
        &mut self,
        (index, primitive): (usize, &'a Primitive),
        has_skin: bool,
        accessors: &Accessors<'_>,
        warnings: &mut Warnings,
    ) -> Result<(u32, usize), String> {
        let key = (&primitive.attributes, primitive.targets.as_slice());
        if let Some(&block) = self.blocks.get(&key) {
            return Ok(block);
        }
        let position = primitive.attributes.get("POSITION").ok_or("it has no POSITION")?;
        let positions = accessors.vectors::<3>(*position).map_err(|message| format!("POSITION: {message}"))?;
        let first = self.surface.positions.len();
        let block = (u32::try_from(first).map_err(|_| "there are too many vertices for one mesh")?, positions.len());
        self.surface.positions.extend(positions.iter().map(|&p| DVec3::from(p).as_vec3()));
        self.deformation.add((index, primitive), positions.len(), has_skin, accessors, warnings)?;

        let colors = &mut self.surface.vertex_colors;
        if let Some(&accessor) = primitive.attributes.get("COLOR_0") {
            let added = accessors.colors(accessor).map_err(|message| format!("COLOR_0: {message}"))?;
            check_count("COLOR_0", added.len(), positions.len())?;
            colors.resize(first, Vec3::ONE);
            let bad = added.iter().filter(|color| !DVec3::from(**color).is_finite()).count();
            warnings.add(
                bad,
                ["vertex colour is not a number and became white", "vertex colours are not numbers and became white"],
            );
            let finite = |color: [f64; 3]| Some(DVec3::from(color).as_vec3()).filter(|c| c.is_finite());
            colors.extend(added.into_iter().map(|color| finite(color).unwrap_or(Vec3::ONE)));
        } else if !colors.is_empty() {
            colors.resize(self.surface.positions.len(), Vec3::ONE);
        }
        if self.wants_normals
            && let Some(&accessor) = primitive.attributes.get("NORMAL")
        {
            match normals(accessor, positions.len(), accessors) {
                Ok(added) => {
                    self.normals.resize(first, Vec3::ZERO);
                    self.normals.extend(added);
                }
                Err(message) => {
                    let words = ["primitive has no normals to use", "primitives have no normals to use"];
                    warnings.add_one(words, || message);
                }
            }
        }
        self.blocks.insert(key, block);
        Ok(block)
    }
}

/// One for each vertex.
fn normals(accessor: usize, vertex_count: usize, accessors: &Accessors<'_>) -> Result<Vec<Vec3>, String> {
    let normals = accessors.vectors::<3>(accessor).map_err(|message| format!("NORMAL: {message}"))?;
    check_count("NORMAL", normals.len(), vertex_count)?;
    Ok(normals.into_iter().map(|normal| DVec3::from(normal).as_vec3()).collect())
}

pub(super) fn check_count(attribute: &str, count: usize, vertices: usize) -> Result<(), String> {
    if count == vertices { Ok(()) } else { Err(format!("{attribute} has {count} elements for {vertices} vertices")) }
}

/// Adds the triangles of `indices` with `first` added; gives the number of indices that make no triangle.
fn add_triangles(mode: u32, indices: &[u32], first: u32, triangles: &mut Vec<[u32; 3]>) -> Result<usize, String> {
    let corners = |t: [u32; 3]| t.map(|index| first + index);
    match mode {
        4 => {
            let (whole, rest) = indices.as_chunks();
            triangles.extend(whole.iter().map(|t| corners(*t)));
            return Ok(rest.len());
        }
        // Every other triangle of a strip is walked backwards, so that all face one way.
        5 => triangles.extend(
            indices
                .array_windows()
                .enumerate()
                .map(|(i, &[a, b, c])| corners(if i % 2 == 0 { [a, b, c] } else { [a, c, b] })),
        ),
        6 => triangles.extend(
            indices
                .first()
                .into_iter()
                .flat_map(|&a| indices[1..].array_windows().map(move |&[b, c]| corners([b, c, a]))),
        ),
        _ => return Err(format!("its mode {mode} does not exist")),
    }
    Ok(if indices.len() < 3 { indices.len() } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(mode: u32, indices: &[u32]) -> (Vec<[u32; 3]>, usize) {
        let mut triangles = Vec::new();
        let unused = add_triangles(mode, indices, 10, &mut triangles).expect("a mode of triangles");
        (triangles, unused)
    }

    #[test]
    fn the_triangles_of_a_strip_and_of_a_fan_all_face_one_way() {
        // Around a square 0, 1, 2, 3: the strip goes 0, 1, 3, 2.
        assert_eq!(triangles(5, &[0, 1, 3, 2]).0, [[10, 11, 13], [11, 12, 13]]);
        assert_eq!(triangles(6, &[0, 1, 2, 3]).0, [[11, 12, 10], [12, 13, 10]]);
        assert_eq!(triangles(4, &[0, 1, 2, 0, 2, 3]).0, [[10, 11, 12], [10, 12, 13]]);
    }

    #[test]
    fn what_makes_no_whole_triangle_is_counted() {
        assert_eq!(triangles(4, &[0, 1, 2, 0, 2]).1, 2);
        assert_eq!([triangles(5, &[0, 1]), triangles(6, &[0]), triangles(6, &[])].map(|t| t.1), [2, 1, 0]);
        assert!(add_triangles(7, &[0, 1, 2], 0, &mut Vec::new()).is_err());
    }
}
