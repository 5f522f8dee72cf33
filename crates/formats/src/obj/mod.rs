//! Wavefront OBJ, read by a parser of our own.
//!
//! The crate `tobj` 4.0.5 does not serve here: its errors name no line, one bad statement fails the whole file, it
//! cuts every polygon as a fan, and a short colour in an `.mtl` panics. `tests/peers.rs` compares us with it on good
//! files.
//!
//! Statements are read first ([`statements`]), faces become triangles afterwards, when every vertex is known: a
//! positive index may point ahead.

mod mtl;
mod statements;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::mem;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use umbrae_core::{Material, MeshError, Scene, Texture};

use crate::error::{Problem, quoted};
use crate::load::Context;
use crate::picture::{Pictures, Sampling, TEXTURE_SKIPPED};
use crate::place::{Part, scene_of_parts};
use crate::polygon::{Cut, Triangulator};
use crate::text::{first_word, lossy};
use crate::warnings::Warnings;
use crate::{Format, Model};

use mtl::{LibraryMaterial, PictureOfMaterial};
use statements::{Face, Obj, Statements};

/// Reads an OBJ file, and the material libraries beside it.
pub(crate) fn read(bytes: &[u8], context: Context<'_>) -> Result<Model, Problem> {
    let mut warnings = Warnings::default();
    let obj = Obj::read(bytes, context.options.normals, &mut warnings);
    let (materials, textures) = materials(&obj, context, bytes.len(), &mut warnings);
    let colors = obj.linear_colors(&mut warnings);
    let groups = obj.faces_by_group();
    let vertex_count = obj.positions.len();

    let mut shapes = Shapes {
        obj,
        colors,
        has_textures: !textures.is_empty(),
        triangulator: Triangulator::new(),
        local: Vec::new(),
    };
    let mut parts = Vec::with_capacity(groups.len());
    // For each part the vertices of the file that it uses; `None` where they are just the file's.
    let mut sources = Vec::with_capacity(groups.len());
    for (group, faces) in groups.iter().enumerate() {
        let name = shapes.obj.group_name(group, context.stem);
        let source = if groups.len() > 1 { Some(shapes.used_vertices(group, faces)) } else { None };
        let part = shapes.part(name, faces, source.as_deref(), &mut warnings);
        if !part.triangles.is_empty() {
            parts.push(part);
            sources.push(source);
        }
    }
    if parts.is_empty() {
        return Err(no_triangle(vertex_count, warnings));
    }

    let up = context.options.up.unwrap_or(Format::Obj.usual_up());
    let explain = |index: usize, part: &Part, error: &MeshError| match *error {
        MeshError::BadPosition { vertex, .. } => {
            let vertex = sources[index].as_ref().map_or(vertex, |source| source[vertex as usize]);
            bad_vertex(bytes, vertex as usize)
        }
        _ => Problem::whole(format!("object {}: {error}", quoted(&part.name))),
    };
    let scene = scene_of_parts(parts, up, materials, &mut warnings, explain)?;
    let scene = Scene { textures, ..scene };
    Ok(Model::of_mesh_file(scene, Format::Obj, up, warnings))
}

/// Cuts the faces of one group at a time.
struct Shapes {
    obj: Obj,
    /// One for each vertex, or none.
    colors: Vec<Vec3>,
    /// Else texture coordinates are not looked at.
    has_textures: bool,
    triangulator: Triangulator,
    /// For each vertex the last group that used it, and its index there.
    local: Vec<(u32, u32)>,
}

impl Shapes {
    /// The vertices that `faces` use, in the order in which they first do; fills `local` for the group.
    fn used_vertices(&mut self, group: usize, faces: &[Face]) -> Vec<u32> {
        self.local.resize(self.obj.positions.len(), (u32::MAX, 0));
        let mut used = Vec::new();
        for &vertex in faces.iter().flat_map(|face| self.obj.corners_of(face)) {
            if let Some(local) = self.local.get_mut(vertex as usize)
                && local.0 != group as u32
            {
                *local = (group as u32, used.len() as u32);
                used.push(vertex);
            }
        }
        used
    }

    /// The surface of `faces`, with the vertices that `source` names; without it, this is the only part and takes all.
    fn part(&mut self, name: String, faces: &[Face], source: Option<&[u32]>, warnings: &mut Warnings) -> Part {
        let mut part = Part { name, ..Part::default() };
        let mut ring = Vec::new();
        let (mut cut, mut uvs, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        for face in faces {
            cut.clear();
            self.cut_face(face, &mut ring, &mut cut, warnings);
            let corners = self.obj.corners_of(face);
            part.triangles.extend(cut.iter().map(|t| t.map(|i| corners[i as usize])));
            part.triangle_materials.resize(part.triangles.len(), face.material);
            if self.has_textures {
                uvs.clear();
                uvs.extend(self.obj.uvs_of(face));
                part.corner_uvs.extend(cut.iter().map(|t| t.map(|i| uvs[i as usize])));
            }
            if self.obj.has_normals() {
                normals.clear();
                normals.extend(self.obj.normals_of(face));
                part.corner_normals.extend(cut.iter().map(|t| t.map(|i| normals[i as usize])));
            }
        }
        match source {
            Some(source) => {
                let local = &self.local;
                part.triangles.as_flattened_mut().iter_mut().for_each(|v| *v = local[*v as usize].1);
                part.positions = source.iter().map(|&v| self.obj.positions[v as usize]).collect();
                if !self.colors.is_empty() {
                    part.vertex_colors = source.iter().map(|&v| self.colors[v as usize]).collect();
                }
            }
            None => {
                part.positions = mem::take(&mut self.obj.positions);
                part.vertex_colors = mem::take(&mut self.colors);
            }
        }
        part
    }

    /// Adds the triangles of `face`, as places among its corners.
    fn cut_face(&mut self, face: &Face, ring: &mut Vec<DVec3>, triangles: &mut Vec<[u32; 3]>, warnings: &mut Warnings) {
        let corners = self.obj.corners_of(face);
        let positions = &self.obj.positions;
        if let Some(missing) = corners.iter().position(|&v| v as usize >= positions.len()) {
            // The rest of the polygon is still there: the triangles of its fan that do without missing corners.
            let fan = (2..corners.len() as u32).map(|i| [0, i - 1, i]);
            let whole = |t: &[u32; 3]| t.iter().all(|&i| (corners[i as usize] as usize) < positions.len());
            let kept = triangles.len();
            triangles.extend(fan.filter(whole));
            let words = [
                "triangle was skipped because it names a vertex that does not exist",
                "triangles were skipped because they name vertices that do not exist",
            ];
            warnings.add_some(corners.len() - 2 - (triangles.len() - kept), words, || {
                format!("line {}, corner {} of {}", face.line, missing + 1, corners.len())
            });
            return;
        }
        if corners.len() == 3 {
            triangles.push([0, 1, 2]);
            return;
        }
        ring.clear();
        ring.extend(corners.iter().map(|&v| positions[v as usize]));
        let cut = self.triangulator.triangulate(ring, |t| triangles.push(t));
        if cut == Cut::Fan {
            let words = [
                "polygon that crosses itself or has no area was cut as a fan",
                "polygons that cross themselves or have no area were cut as fans",
            ];
            warnings.add_one(words, || format!("line {}", face.line));
        }
    }
}

/// The materials that faces name, in the order of [`Face::material`], with the colours of the libraries, and their textures.
fn materials(
    obj: &Obj,
    context: Context<'_>,
    file_bytes: usize,
    warnings: &mut Warnings,
) -> (Vec<Material>, Vec<Arc<Texture>>) {
    let libraries = mtl::read_libraries(&obj.libraries, context.folder, warnings);
    let mut pictures = Pictures::new(file_bytes);
    let mut textures = Vec::new();
    // By path and sampling; `None` for one that can't be had.
    let mut known: BTreeMap<(PathBuf, [u8; 3]), Option<u32>> = BTreeMap::new();
    let mut texture_of = |picture: PictureOfMaterial, warnings: &mut Warnings| {
        let sampling = Sampling { wrap: [picture.wrap; 2], is_nearest: false };
        *known.entry((picture.path.clone(), sampling.key())).or_insert_with(|| {
            match pictures.texture_of_file(&picture.path, picture.name.clone(), sampling) {
                Ok(texture) => {
                    textures.push(Arc::new(texture));
                    Some(textures.len() as u32 - 1)
                }
                Err(message) => {
                    warnings.add_one(TEXTURE_SKIPPED, || format!("{}: {message}", quoted(&picture.name)));
                    None
                }
            }
        })
    };
    let mut material_named = |name: &String| {
        let Some(LibraryMaterial { material, picture }) = libraries.get(name).cloned() else {
            return Material { name: name.clone(), ..Material::default() };
        };
        let base_color_texture = picture.and_then(|picture| texture_of(picture, warnings));
        Material { base_color_texture, ..material }
    };
    let materials = obj.materials.iter().map(&mut material_named).collect();
    (materials, textures)
}

fn no_triangle(vertex_count: usize, warnings: Warnings) -> Problem {
    let reasons: Vec<String> = warnings.finish().iter().map(ToString::to_string).collect();
    let because = if reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join("; ")) };
    Problem::whole(format!("there is no usable face in it{because}; vertices: {vertex_count}"))
}

/// What is wrong with a vertex, with its line: found by reading the file again, which only failure has to pay for.
fn bad_vertex(bytes: &[u8], vertex: usize) -> Problem {
    let is_vertex = |(_, statement): &(usize, Cow<'_, [u8]>)| first_word(statement).0 == b"v";
    match Statements::new(bytes).filter(is_vertex).nth(vertex) {
        Some((line, statement)) => Problem::at_line(
            line,
            format!(
                "vertex {} is {}; it takes three finite numbers below 1e18",
                vertex + 1,
                quoted(&lossy(&statement))
            ),
        ),
        None => Problem::whole(format!("vertex {} is not a position", vertex + 1)),
    }
}

#[cfg(test)]
mod tests;
