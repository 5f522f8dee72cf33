//! The statements of an OBJ file, gathered but not yet interpreted as surfaces.

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::error::quoted;
use crate::place::linear_from_srgb;
use crate::text::{Lines, first_word, integer, lossy, number, words};
use crate::warnings::Warnings;

/// What an OBJ file says, as far as it concerns surfaces.
#[derive(Debug, Default)]
pub(super) struct Obj {
    /// One for each `v`, not a number where it could not be read.
    pub(super) positions: Vec<DVec3>,
    /// sRGB as in the file, one for each `v`; empty when no vertex has one.
    colors: Vec<Option<Vec3>>,
    corners: Vec<u32>,
    /// One for each `vt`, (0, 0) the top left of a picture.
    uvs: Vec<Vec2>,
    /// For each corner, the index of its texture coordinates; empty when no corner has any.
    corner_uvs: Vec<u32>,
    /// Whether those of corners are wanted.
    wants_normals: bool,
    /// One for each `vn`, as in the file; zero where it could not be read.
    normals: Vec<Vec3>,
    /// For each corner, the index of its normal; empty when no corner has any.
    corner_normals: Vec<u32>,
    pub(super) faces: Vec<Face>,
    groups: Vec<Group>,
    /// Names, in the order in which faces first use them; empty where they use none.
    pub(super) materials: Vec<String>,
    /// The rest of each `mtllib` line.
    pub(super) libraries: Vec<String>,
}

/// An `f` statement of at least three corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    first_corner: usize,
    corner_count: u32,
    group: u32,
    /// Index into [`Obj::materials`].
    pub(super) material: u32,
    /// Where it begins.
    pub(super) line: u32,
}

/// The `o` and `g` statements in force at a face.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
struct Group {
    /// How many `o` statements came before: two objects of one name are two.
    object: usize,
    object_name: Option<String>,
    group_name: Option<String>,
}

/// Names no vertex, no texture coordinate and no normal, whatever their number.
const NOTHING: u32 = u32::MAX;

impl Obj {
    /// Normals are read if someone `wants_normals`.
    pub(super) fn read(bytes: &[u8], wants_normals: bool, warnings: &mut Warnings) -> Self {
        let mut obj = Self { wants_normals, ..Self::default() };
        let mut current = Current::default();
        for (line, statement) in Statements::new(bytes) {
            let (keyword, rest) = first_word(&statement);
            match keyword {
                b"v" => obj.read_vertex(line, rest, warnings),
                b"f" | b"fo" => obj.read_face(line, rest, &mut current, warnings),
                b"vt" => obj.read_uv(line, rest, warnings),
                b"vn" if wants_normals => obj.read_normal(line, rest, warnings),
                // Smoothing groups: which edges are creases is told from their angles.
                b"" | b"vn" | b"s" => {}
                b"o" => current.start_object(rest),
                b"g" => current.start_group(rest),
                b"usemtl" => current.start_material(rest),
                b"mtllib" => obj.libraries.push(lossy(rest)),
                [b'#', ..] => {}
                b"l" => {
                    let words = ["line primitive was skipped", "line primitives were skipped"];
                    warnings.add_one(words, || format!("line {line}"));
                }
                b"p" => {
                    let words = ["point primitive was skipped", "point primitives were skipped"];
                    warnings.add_one(words, || format!("line {line}"));
                }
                b"curv" | b"curv2" | b"surf" => {
                    let words = ["free-form curve or surface was skipped", "free-form curves or surfaces were skipped"];
                    warnings.add_one(words, || format!("line {line}"));
                }
                // What belongs to free-form curves, and how to draw things: without effect on polygons.
                b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp"
                | b"end" | b"con" | b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"usemap" | b"maplib"
                | b"shadow_obj" | b"trace_obj" | b"ctech" | b"stech" => {}
                _ => {
                    let words = ["unknown statement was skipped", "unknown statements were skipped"];
                    warnings.add_one(words, || format!("line {line}: {}", quoted(&lossy(&statement))));
                }
            }
        }
        obj
    }

    /// The corners of `face`, as indices into `positions` that may be out of range.
    pub(super) fn corners_of(&self, face: &Face) -> &[u32] {
        &self.corners[face.first_corner..][..face.corner_count as usize]
    }

    /// The texture coordinates of each corner of `face`, (0, 0) for one without.
    pub(super) fn uvs_of(&self, face: &Face) -> impl Iterator<Item = Vec2> {
        let indices = self.corner_uvs.get(face.first_corner..).unwrap_or_default();
        let uv = |i: usize| indices.get(i).and_then(|&index| self.uvs.get(index as usize));
        (0..face.corner_count as usize).map(move |i| uv(i).copied().unwrap_or_default())
    }

    /// Whether any corner names a normal.
    pub(super) fn has_normals(&self) -> bool {
        !self.corner_normals.is_empty()
    }

    /// The normal of each corner of `face`, zero for one without.
    pub(super) fn normals_of(&self, face: &Face) -> impl Iterator<Item = Vec3> {
        let indices = self.corner_normals.get(face.first_corner..).unwrap_or_default();
        let normal = |i: usize| indices.get(i).and_then(|&index| self.normals.get(index as usize));
        (0..face.corner_count as usize).map(move |i| normal(i).copied().unwrap_or_default())
    }

    /// The faces of each group, both in the order of the file. A group that is taken up again goes on.
    pub(super) fn faces_by_group(&self) -> Vec<Vec<Face>> {
        let mut faces = vec![Vec::new(); self.groups.len()];
        for face in &self.faces {
            faces[face.group as usize].push(*face);
        }
        faces
    }

    /// `object`, `group`, `object/group`, or `stem` where neither has a name.
    pub(super) fn group_name(&self, group: usize, stem: &str) -> String {
        match &self.groups[group] {
            Group { object_name: Some(object), group_name: Some(group), .. } => format!("{object}/{group}"),
            Group { object_name: Some(name), .. } | Group { group_name: Some(name), .. } => name.clone(),
            Group { .. } => stem.to_owned(),
        }
    }

    /// One colour for each vertex, or none: white where the file has none or no number.
    pub(super) fn linear_colors(&self, warnings: &mut Warnings) -> Vec<Vec3> {
        let finite = |color: &Option<Vec3>| color.filter(|c| c.is_finite());
        if self.colors.iter().all(|color| finite(color).is_none()) {
            return Vec::new();
        }
        let bad = self.colors.iter().flatten().filter(|color| !color.is_finite()).count();
        warnings.add(
            bad,
            ["vertex colour is not a number and became white", "vertex colours are not numbers and became white"],
        );
        let largest = self.colors.iter().filter_map(finite).fold(0.0, |largest, c| c.max_element().max(largest));
        // Some programs write bytes.
        let scale = if largest > 1.0 { 1.0 / 255.0 } else { 1.0 };
        let linear = |color: &Option<Vec3>| finite(color).map_or(Vec3::ONE, |c| linear_from_srgb(c * scale));
        self.colors.iter().map(linear).collect()
    }

    fn read_vertex(&mut self, line: usize, rest: &[u8], warnings: &mut Warnings) {
        let mut values = [f64::NAN; 6];
        let mut count = 0;
        for (value, word) in values.iter_mut().zip(words(rest)).take_while(|(_, word)| word[0] != b'#') {
            *value = number(word).unwrap_or(f64::NAN);
            count += 1;
        }
        let [x, y, z, red, green, blue] = values;
        let position = DVec3::new(x, y, z);
        if position.is_nan() {
            let words = ["vertex position is not three numbers", "vertex positions are not three numbers"];
            warnings.add_one(words, || format!("line {line}: {}", quoted(&lossy(rest))));
        }
        self.positions.push(position);
        // A fourth number is a weight, which only curves use; six are a position and a colour.
        let color = (count == 6).then(|| DVec3::new(red, green, blue).as_vec3());
        if color.is_some() && self.colors.is_empty() {
            self.colors.resize(self.positions.len() - 1, None);
        }
        if color.is_some() || !self.colors.is_empty() {
            self.colors.push(color);
        }
    }

    fn drop_corners_from(&mut self, first: usize) {
        self.corners.truncate(first);
        self.corner_uvs.truncate(first);
        self.corner_normals.truncate(first);
    }

    fn read_uv(&mut self, line: usize, rest: &[u8], warnings: &mut Warnings) {
        let mut numbers = words(rest).map(|word| number(word).unwrap_or(f64::NAN));
        // The file has v up.
        let uv = DVec2::new(numbers.next().unwrap_or(f64::NAN), 1.0 - numbers.next().unwrap_or(0.0)).as_vec2();
        if !uv.is_finite() {
            let words =
                ["texture coordinate can't be read and became 0", "texture coordinates can't be read and became 0"];
            warnings.add_one(words, || format!("line {line}: {}", quoted(&lossy(rest))));
        }
        self.uvs.push(if uv.is_finite() { uv } else { Vec2::ZERO });
    }

    fn read_normal(&mut self, line: usize, rest: &[u8], warnings: &mut Warnings) {
        let mut numbers = words(rest).map(|word| number(word).unwrap_or(f64::NAN));
        let mut next = || numbers.next().unwrap_or(f64::NAN) as f32;
        let normal = Vec3::new(next(), next(), next());
        if !normal.is_finite() {
            let words = ["normal can't be read and was left out", "normals can't be read and were left out"];
            warnings.add_one(words, || format!("line {line}: {}", quoted(&lossy(rest))));
        }
        self.normals.push(if normal.is_finite() { normal } else { Vec3::ZERO });
    }

    fn read_face(&mut self, line: usize, rest: &[u8], current: &mut Current, warnings: &mut Warnings) {
        let first_corner = self.corners.len();
        for word in words(rest).take_while(|word| word[0] != b'#') {
            let mut indices = word.split(|&byte| byte == b'/');
            let index = indices.next().and_then(integer);
            let Some(index) = index else {
                self.drop_corners_from(first_corner);
                let words = ["face can't be read and was skipped", "faces can't be read and were skipped"];
                warnings.add_one(words, || format!("line {line}: {}", quoted(&lossy(rest))));
                return;
            };
            self.corners.push(place_of(index, self.positions.len()));
            // No coordinates or normals, or broken ones, concern only the look.
            let uv = indices.next().and_then(integer).map(|uv| place_of(uv, self.uvs.len()));
            name_at_last(&mut self.corner_uvs, self.corners.len(), uv);
            let normal = indices.next().filter(|_| self.wants_normals).and_then(integer);
            let normal = normal.map(|normal| place_of(normal, self.normals.len()));
            name_at_last(&mut self.corner_normals, self.corners.len(), normal);
        }
        let corner_count = self.corners.len() - first_corner;
        if corner_count < 3 {
            self.drop_corners_from(first_corner);
            let words =
                ["face of fewer than three corners was skipped", "faces of fewer than three corners were skipped"];
            warnings.add_one(words, || format!("line {line}"));
            return;
        }
        let group = *current.group_index.get_or_insert_with(|| {
            *current.groups.entry(current.group.clone()).or_insert_with(|| {
                self.groups.push(current.group.clone());
                self.groups.len() as u32 - 1
            })
        });
        let material = *current.material_index.get_or_insert_with(|| {
            *current.materials.entry(current.material.clone()).or_insert_with(|| {
                self.materials.push(current.material.clone());
                self.materials.len() as u32 - 1
            })
        });
        self.faces.push(Face { first_corner, corner_count: corner_count as u32, group, material, line: line as u32 });
    }
}

/// Adds what the last of `corner_count` corners names to a list that is empty while no corner has named anything.
fn name_at_last(names: &mut Vec<u32>, corner_count: usize, name: Option<u32>) {
    if name.is_some() || !names.is_empty() {
        names.resize(corner_count - 1, NOTHING);
        names.push(name.unwrap_or(NOTHING));
    }
}

/// Where in a list of `count` so far an index of the file points: from 1 forward, from -1 back.
fn place_of(index: i64, count: usize) -> u32 {
    let place = if index > 0 { index - 1 } else { count as i64 + index };
    if index == 0 { NOTHING } else { u32::try_from(place).unwrap_or(NOTHING) }
}

/// The state that statements leave behind for the faces after them.
#[derive(Debug, Default)]
struct Current {
    group: Group,
    material: String,
    /// Of `group` and `material`, once a face has used them.
    group_index: Option<u32>,
    material_index: Option<u32>,
    groups: BTreeMap<Group, u32>,
    materials: BTreeMap<String, u32>,
}

impl Current {
    fn start_object(&mut self, name: &[u8]) {
        self.group = Group { object: self.group.object + 1, object_name: some_name(name), group_name: None };
        self.group_index = None;
    }

    fn start_group(&mut self, name: &[u8]) {
        self.group.group_name = some_name(name);
        self.group_index = None;
    }

    fn start_material(&mut self, name: &[u8]) {
        self.material = lossy(name);
        self.material_index = None;
    }
}

fn some_name(name: &[u8]) -> Option<String> {
    (!name.is_empty()).then(|| lossy(name))
}

/// The lines of an OBJ file with the line each begins at; one that ends in a backslash goes on in the next.
#[derive(Debug)]
pub(super) struct Statements<'a>(Lines<'a>);

impl<'a> Statements<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self(Lines::new(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)))
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = (usize, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let (line, text) = self.0.next()?;
        let Some(begun) = text.strip_suffix(b"\\") else { return Some((line, Cow::Borrowed(text))) };
        let mut joined = begun.to_vec();
        for (_, text) in self.0.by_ref() {
            joined.push(b' ');
            match text.strip_suffix(b"\\") {
                Some(more) => joined.extend_from_slice(more),
                None => {
                    joined.extend_from_slice(text);
                    break;
                }
            }
        }
        Some((line, Cow::Owned(joined)))
    }
}
