//! PLY, ascii and binary, also gzipped; read by a parser of our own.
//!
//! The crate `ply-rs-bw` 4.0.1 does not serve here: its errors are several lines long and know no byte, it refuses
//! comments that are not UTF-8, it looks properties up by name for every value, and a header with 4,000,000,000
//! rows of an element without properties makes it fill the memory. `tests/peers.rs` compares us with it on good files.
//!
//! What counts: the `vertex` element's x, y, z and red, green, blue (sRGB, as is custom), its nx, ny, nz if they are asked for, the `face` element's list
//! of vertices, and the `tristrips` of the Stanford archive.

mod header;
mod rows;

use std::borrow::Cow;
use std::io::Read;

use flate2::read::MultiGzDecoder;
use glam::{DVec3, Vec3};
use umbrae_core::MeshError;

use crate::error::Problem;
use crate::load::Context;
use crate::place::{Part, linear_from_srgb, scene_of_parts};
use crate::polygon::{Cut, Triangulator};
use crate::text::Lines;
use crate::warnings::Warnings;
use crate::{Format, Model};

use header::{Element, Header, Kind, Type};
use rows::Rows;

/// Reads a PLY file.
pub(crate) fn read(bytes: &[u8], context: Context<'_>) -> Result<Model, Problem> {
    let bytes = unzipped(bytes)?;
    let mut warnings = Warnings::default();
    let mut lines = Lines::new(&bytes);
    let header = Header::read(&mut lines)?;
    let mut rows = Rows::new(header.encoding, lines, bytes.len());

    let mut vertices = Vertices { wants_normals: context.options.normals, ..Vertices::default() };
    let mut polygons = Polygons::default();
    for element in &header.elements {
        rows.check_count(element)?;
        match element.name.as_str() {
            "vertex" => vertices.read(&mut rows, element, &mut warnings)?,
            "face" => polygons.read_faces(&mut rows, element)?,
            "tristrips" => polygons.read_strips(&mut rows, element)?,
            _ => {
                let skipped = rows.skip(element)?;
                let words = ["row of another element was skipped", "rows of other elements were skipped"];
                warnings.add_some(skipped, words, || element.name.clone());
            }
        }
    }
    let words = ["row has more values than properties", "rows have more values than properties"];
    warnings.add(rows.overlong(), words);
    if !rows.is_at_end() {
        let words = ["byte after the last element was skipped", "bytes after the last element were skipped"];
        warnings.add(rows.bytes_left(), words);
    }

    let triangles = polygons.cut(&vertices.positions, &mut warnings)?;
    let part = Part {
        name: context.stem.to_owned(),
        corner_normals: vertices.corner_normals(&triangles),
        triangles,
        positions: vertices.positions,
        vertex_colors: vertices.colors,
        ..Part::default()
    };
    if part.triangles.is_empty() {
        let vertices = part.positions.len();
        return Err(Problem::whole(format!("there is no usable face in it; vertices: {vertices}")));
    }
    let up = context.options.up.unwrap_or(Format::Ply.usual_up());
    let explain = |_: usize, part: &Part, error: &MeshError| match *error {
        MeshError::BadPosition { vertex, .. } => {
            let p = part.positions[vertex as usize];
            let message =
                format!("({}, {}, {}) is not a position; coordinates must be finite and below 1e18", p.x, p.y, p.z);
            Problem::in_part("vertex", vertex as usize, None, message)
        }
        _ => Problem::whole(error.to_string()),
    };
    let scene = scene_of_parts(vec![part], up, Vec::new(), &mut warnings, explain)?;
    Ok(Model::of_mesh_file(scene, Format::Ply, up, warnings))
}

/// A model shrinks to a tenth or a twentieth of its size; more than this, and the file was made to fill the memory.
const MAX_UNZIP_RATIO: u64 = 64;

/// The content of `bytes` if they are a gzip archive, else `bytes`.
fn unzipped(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Problem> {
    if !bytes.starts_with(b"\x1f\x8b") {
        return Ok(Cow::Borrowed(bytes));
    }
    let limit = bytes.len() as u64 * MAX_UNZIP_RATIO;
    let mut content = Vec::new();
    let size = MultiGzDecoder::new(bytes)
        .take(limit + 1)
        .read_to_end(&mut content)
        .map_err(|error| Problem::whole(format!("the gzip archive is damaged: {error}")))?;
    if size as u64 > limit {
        return Err(Problem::whole(format!(
            "the gzip archive unpacks to more than {MAX_UNZIP_RATIO} times its {} bytes; unpack it first if it is good",
            bytes.len()
        )));
    }
    Ok(Cow::Owned(content))
}

#[derive(Debug, Default)]
struct Vertices {
    positions: Vec<DVec3>,
    /// Linear; one for each position, or none.
    colors: Vec<Vec3>,
    wants_normals: bool,
    /// As in the file; one for each position, or none.
    normals: Vec<Vec3>,
}

impl Vertices {
    fn read(&mut self, rows: &mut Rows<'_>, element: &Element, warnings: &mut Warnings) -> Result<(), Problem> {
        let scalar = |names: &[&str]| {
            element.column(names).filter(|&column| matches!(element.properties[column].kind, Kind::Scalar(_)))
        };
        let [Some(x), Some(y), Some(z)] = [scalar(&["x"]), scalar(&["y"]), scalar(&["z"])] else {
            return Err(Problem::whole("the header's vertex element lacks one of the properties x, y and z"));
        };
        let color =
            [scalar(&["red", "diffuse_red"]), scalar(&["green", "diffuse_green"]), scalar(&["blue", "diffuse_blue"])];
        let color = if let [Some(red), Some(green), Some(blue)] = color { Some([red, green, blue]) } else { None };
        let normal = [scalar(&["nx"]), scalar(&["ny"]), scalar(&["nz"])];
        let normal = if let [Some(x), Some(y), Some(z)] = normal { Some([x, y, z]) } else { None };
        let normal = normal.filter(|_| self.wants_normals);
        let brightest = |column: usize| match element.properties[column].kind {
            Kind::Scalar(Type::F32 | Type::F64) => 1.0,
            Kind::Scalar(Type::I16 | Type::U16) => f64::from(u16::MAX),
            _ => f64::from(u8::MAX),
        };

        // `check_count` has seen that the file has as many rows.
        self.positions.reserve_exact(element.count);
        let mut row = vec![0.0; element.properties.len()];
        let mut items = Vec::new();
        let mut bad_colors = 0;
        for number in 0..element.count {
            rows.begin(element, number)?;
            for (value, property) in row.iter_mut().zip(&element.properties) {
                match property.kind {
                    Kind::Scalar(kind) => *value = rows.value(kind)?,
                    Kind::List(count, item) => rows.list(count, item, &mut items)?,
                }
            }
            self.positions.push(DVec3::new(row[x], row[y], row[z]));
            if let Some(columns) = color {
                let srgb = Vec3::from_array(columns.map(|column| (row[column] / brightest(column)) as f32));
                bad_colors += usize::from(!srgb.is_finite());
                self.colors.push(if srgb.is_finite() { linear_from_srgb(srgb) } else { Vec3::ONE });
            }
            if let Some(columns) = normal {
                self.normals.push(Vec3::from_array(columns.map(|column| row[column] as f32)));
            }
        }
        let words =
            ["vertex colour is not a number and became white", "vertex colours are not numbers and became white"];
        warnings.add(bad_colors, words);
        Ok(())
    }

    /// For the corners of each of `triangles`, whose vertices exist; empty if the file has no normals.
    fn corner_normals(&self, triangles: &[[u32; 3]]) -> Vec<[Vec3; 3]> {
        if self.normals.is_empty() {
            return Vec::new();
        }
        triangles.iter().map(|corners| corners.map(|v| self.normals[v as usize])).collect()
    }
}

/// Faces as lists of vertices; cut when all vertices are known, which may come later in the file.
#[derive(Debug, Default)]
struct Polygons {
    corners: Vec<i64>,
    /// For each polygon the end of its corners.
    ends: Vec<usize>,
}

impl Polygons {
    fn read_faces(&mut self, rows: &mut Rows<'_>, element: &Element) -> Result<(), Problem> {
        self.read_lists(rows, element, |polygons, corners| {
            polygons.corners.extend_from_slice(corners);
            polygons.ends.push(polygons.corners.len());
        })
    }

    /// A strip's triangles share a side with the one before; -1 begins another strip.
    fn read_strips(&mut self, rows: &mut Rows<'_>, element: &Element) -> Result<(), Problem> {
        self.read_lists(rows, element, |polygons, corners| {
            for strip in corners.split(|&corner| corner == -1) {
                for (i, &[a, b, c]) in strip.array_windows().enumerate() {
                    polygons.corners.extend(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                    polygons.ends.push(polygons.corners.len());
                }
            }
        })
    }

    fn read_lists(
        &mut self,
        rows: &mut Rows<'_>,
        element: &Element,
        mut add: impl FnMut(&mut Self, &[i64]),
    ) -> Result<(), Problem> {
        let names = ["vertex_indices", "vertex_index"];
        let Some(column) = element.column(&names).filter(|&c| matches!(element.properties[c].kind, Kind::List(..)))
        else {
            // Without rows it does no harm.
            let message = format!("the header's {} element has no list vertex_indices", element.name);
            return if element.count == 0 { Ok(()) } else { Err(Problem::whole(message)) };
        };
        let (mut items, mut corners) = (Vec::new(), Vec::new());
        for row in 0..element.count {
            rows.begin(element, row)?;
            for (i, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::Scalar(kind) => rows.value(kind).map(drop)?,
                    Kind::List(count, item) => rows.list(count, item, &mut items)?,
                }
                if i == column {
                    corners.clear();
                    // A fraction or an infinity becomes an index out of range, which is then refused.
                    corners.extend(items.iter().map(|&item| if item.fract() == 0.0 { item as i64 } else { i64::MIN }));
                    add(self, &corners);
                }
            }
        }
        Ok(())
    }

    fn cut(self, positions: &[DVec3], warnings: &mut Warnings) -> Result<Vec<[u32; 3]>, Problem> {
        let mut triangles = Vec::with_capacity(self.ends.len());
        let mut triangulator = Triangulator::new();
        let (mut corners, mut ring) = (Vec::new(), Vec::new());
        let (mut start, mut thin, mut fans) = (0, 0, 0);
        for (face, &end) in self.ends.iter().enumerate() {
            corners.clear();
            for &vertex in &self.corners[start..end] {
                match u32::try_from(vertex) {
                    Ok(index) if (index as usize) < positions.len() => corners.push(index),
                    _ => {
                        let message = format!("it names vertex {vertex}, but there are {} (from 0)", positions.len());
                        return Err(Problem::in_part("face", face, None, message));
                    }
                }
            }
            start = end;
            match *corners.as_slice() {
                [a, b, c] => triangles.push([a, b, c]),
                [] | [_] | [_, _] => thin += 1,
                _ => {
                    ring.clear();
                    ring.extend(corners.iter().map(|&v| positions[v as usize]));
                    let cut = triangulator.triangulate(&ring, |t| triangles.push(t.map(|i| corners[i as usize])));
                    fans += usize::from(cut == Cut::Fan);
                }
            }
        }
        warnings.add(
            thin,
            ["face of fewer than three corners was skipped", "faces of fewer than three corners were skipped"],
        );
        warnings.add(
            fans,
            [
                "polygon that crosses itself or has no area was cut as a fan",
                "polygons that cross themselves or have no area were cut as fans",
            ],
        );
        Ok(triangles)
    }
}

#[cfg(test)]
mod tests;
