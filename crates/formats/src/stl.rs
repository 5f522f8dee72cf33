//! STL, binary and ascii, read by a parser of our own.
//!
//! The crate `stl_io` 0.11.0 does not serve here: it takes a binary file whose header begins with "solid" for text
//! (many programs write that), reads only the first of several solids, and its errors know no line.
//! `tests/peers.rs` compares us with it on good files.

use glam::DVec3;
use umbrae_core::MeshError;

use crate::error::{Problem, quoted};
use crate::load::Context;
use crate::place::{Part, scene_of_parts};
use crate::text::{Lines, first_word, lossy, number, words};
use crate::warnings::Warnings;
use crate::{Format, Model};

/// Reads an STL file: one object for each solid. Normals and attribute bytes are left out: corners say it all.
pub(crate) fn read(bytes: &[u8], context: Context<'_>) -> Result<Model, Problem> {
    let mut warnings = Warnings::default();
    let parts = if is_text(bytes) {
        read_text(bytes, context.stem)?
    } else {
        vec![read_binary(bytes, context.stem, &mut warnings)?]
    };
    let up = context.options.up.unwrap_or(Format::Stl.usual_up());
    let explain = |_: usize, part: &Part, error: &MeshError| match *error {
        MeshError::BadPosition { vertex, .. } => {
            let p = part.positions[vertex as usize];
            let message = format!(
                "corner {} is at ({}, {}, {}); coordinates must be finite and below 1e18",
                vertex % 3,
                p.x,
                p.y,
                p.z
            );
            Problem::in_part("facet", vertex as usize / 3, None, message)
        }
        _ => Problem::whole(format!("solid {}: {error}", quoted(&part.name))),
    };
    let scene = scene_of_parts(parts, up, Vec::new(), &mut warnings, explain)?;
    Ok(Model::of_mesh_file(scene, Format::Stl, up, warnings))
}

const HEADER_BYTES: usize = 80;
const FACET_BYTES: usize = 50;

/// The number of facets that a binary file announces, and the bytes after that number.
fn binary_facets(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let (count, facets) = bytes.get(HEADER_BYTES..)?.split_first_chunk()?;
    Some((u32::from_le_bytes(*count) as usize, facets))
}

/// Text begins with "solid", but so do many binary files: those have the length that they announce, or zeros.
fn is_text(bytes: &[u8]) -> bool {
    let is_binary_length = |(count, facets): (usize, &[u8])| facets.len() as u64 == count as u64 * FACET_BYTES as u64;
    let (keyword, _) = first_word(&bytes[..bytes.len().min(HEADER_BYTES)]);
    keyword.eq_ignore_ascii_case(b"solid")
        && !binary_facets(bytes).is_some_and(is_binary_length)
        && !bytes[..bytes.len().min(512)].contains(&0)
}

fn read_binary(bytes: &[u8], name: &str, warnings: &mut Warnings) -> Result<Part, Problem> {
    let Some((count, facets)) = binary_facets(bytes) else {
        let begin = quoted(&lossy(&bytes[..bytes.len().min(16)]));
        return Err(Problem::whole(format!(
            "{} bytes are too few for a binary STL file, and a text one begins with \"solid\", not {begin}",
            bytes.len()
        )));
    };
    let (whole, rest) = facets.as_chunks::<FACET_BYTES>();
    if count != whole.len() {
        return Err(Problem::at_byte(
            HEADER_BYTES,
            format!(
                "the header announces {count} facets, which take {} bytes, but {} bytes follow ({} facets)",
                count as u64 * FACET_BYTES as u64,
                facets.len(),
                whole.len(),
            ),
        ));
    }
    let words = ["byte after the last facet was skipped", "bytes after the last facet were skipped"];
    warnings.add(rest.len(), words);
    let mut solid = Solid::new(name);
    for facet in whole {
        let coordinate = |i: usize| f64::from(f32::from_le_bytes(std::array::from_fn(|k| facet[4 * i + k])));
        // Coordinates 0 to 2 are the normal.
        solid.add([3, 6, 9].map(|i| DVec3::new(coordinate(i), coordinate(i + 1), coordinate(i + 2))));
    }
    Ok(solid.0)
}

/// One solid: three positions for each facet.
struct Solid(Part);

impl Solid {
    fn new(name: &str) -> Self {
        Self(Part { name: name.to_owned(), ..Part::default() })
    }

    fn add(&mut self, corners: [DVec3; 3]) {
        let first = self.0.positions.len() as u32;
        self.0.positions.extend(corners);
        self.0.triangles.push([first, first + 1, first + 2]);
    }
}

fn read_text(bytes: &[u8], stem: &str) -> Result<Vec<Part>, Problem> {
    let mut solids: Vec<Solid> = Vec::new();
    let mut corners: Vec<DVec3> = Vec::with_capacity(3);
    let (mut last_line, mut is_open) = (1, false);
    for (line_number, line) in Lines::new(bytes) {
        let problem = |message: String| Problem::at_line(line_number, message);
        let (keyword, rest) = first_word(line);
        if !keyword.is_empty() {
            last_line = line_number;
        }
        match keyword.to_ascii_lowercase().as_slice() {
            b"solid" => {
                let name = lossy(rest);
                solids.push(Solid::new(if name.is_empty() { stem } else { &name }));
                is_open = true;
            }
            b"facet" => corners.clear(),
            b"vertex" => corners
                .push(corner(rest).ok_or_else(|| problem(format!("{} is not three numbers", quoted(&lossy(rest)))))?),
            b"endfacet" => {
                let &[a, b, c] = corners.as_slice() else {
                    return Err(problem(format!("the facet has {} corners, not 3", corners.len())));
                };
                solids.last_mut().ok_or_else(|| problem("a facet before any solid".to_owned()))?.add([a, b, c]);
                corners.clear();
            }
            b"endsolid" => is_open = false,
            b"" | b"outer" | b"endloop" | b"color" => {}
            _ => return Err(problem(format!("{} is no line of an STL file", quoted(&lossy(line))))),
        }
    }
    if is_open || !corners.is_empty() {
        return Err(Problem::at_line(last_line, "the file ends without \"endsolid\"; it was cut off"));
    }
    let with_facets = |solid: Solid| (!solid.0.triangles.is_empty()).then_some(solid.0);
    Ok(solids.into_iter().filter_map(with_facets).collect())
}

/// Three numbers, finite or not.
fn corner(text: &[u8]) -> Option<DVec3> {
    let mut numbers = words(text).map(number);
    let corner = DVec3::new(numbers.next()??, numbers.next()??, numbers.next()??);
    numbers.next().is_none().then_some(corner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadError, LoadOptions, UpAxis, load_bytes};

    const TEXT: &str = "solid a cube\nfacet normal 0 0 1\nouter loop\nvertex 0 0 5\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
        endfacet\nendsolid a cube\n";

    fn binary(header: &str, announced: u32, facets: &[[f32; 9]], tail: &[u8]) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.resize(HEADER_BYTES, b' ');
        bytes.extend(announced.to_le_bytes());
        for facet in facets {
            bytes.extend([0; 12]);
            bytes.extend(facet.iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0xff; 2]);
        }
        bytes.extend(tail);
        bytes
    }

    const FACET: [f32; 9] = [0.0, 0.0, 5.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

    fn load(bytes: &[u8], up: Option<UpAxis>) -> Result<Model, LoadError> {
        load_bytes(bytes, Format::Stl, "cube.stl", None, &LoadOptions { up, ..LoadOptions::default() })
    }

    fn error(bytes: &[u8]) -> String {
        load(bytes, None).expect_err("a bad file").to_string()
    }

    #[test]
    fn text_and_binary_say_the_same_and_z_is_up() {
        let text = load(TEXT.as_bytes(), None).expect("text");
        let binary = load(&binary("made by hand", 1, &[FACET], &[]), None).expect("binary");
        assert_eq!(text.scene.objects[0].mesh.positions(), binary.scene.objects[0].mesh.positions());
        assert_eq!(text.scene.objects[0].mesh.positions()[0].z, 5.0);
        assert_eq!([&text, &binary].map(|m| m.scene.objects[0].name.as_str()), ["a cube", "cube"]);
    }

    #[test]
    fn y_is_up_if_the_user_says_so() {
        let model = load(TEXT.as_bytes(), Some(UpAxis::Y)).expect("text");
        assert_eq!((model.up, model.scene.objects[0].mesh.positions()[0].y), (UpAxis::Y, -5.0));
    }

    #[test]
    fn a_binary_header_may_begin_with_solid() {
        let model = load(&binary("solid but not text", 1, &[FACET], &[]), None).expect("binary");
        assert_eq!(model.scene.triangle_count(), 1);
        let cut_off = binary("solid\0but not text", 7, &[FACET], &[]);
        assert!(error(&cut_off).contains("the header announces 7 facets"));
    }

    #[test]
    fn every_solid_of_a_text_file_is_an_object() {
        let two = TEXT.repeat(2).replacen("a cube", "", 1).to_uppercase().replace("\n", "\r\n");
        let model = load(two.as_bytes(), None).expect("text");
        let names: Vec<&str> = model.scene.objects.iter().map(|o| o.name.as_str()).collect();
        assert_eq!(names, ["cube", "A CUBE"]);
    }

    #[test]
    fn a_wrong_number_of_facets_is_told_with_both_numbers() {
        assert_eq!(
            error(&binary("", 1_000_000_000, &[FACET], &[])),
            "cube.stl: byte 80: the header announces 1000000000 facets, which take 50000000000 bytes, but 50 bytes \
             follow (1 facets)"
        );
        assert!(error(&binary("", 0, &[FACET; 2], &[])).contains("announces 0 facets"));
    }

    #[test]
    fn a_few_bytes_too_many_are_a_warning() {
        let model = load(&binary("", 1, &[FACET], b"\r\n"), None).expect("binary");
        assert_eq!(model.warnings[0].to_string(), "2 bytes after the last facet were skipped");
    }

    #[test]
    fn bad_text_is_told_by_its_line() {
        assert_eq!(
            error(TEXT.replace("1 0 0", "1 0 O").as_bytes()),
            "cube.stl: line 5: \"1 0 O\" is not three numbers"
        );
        assert!(
            error(TEXT.replace("vertex 1 0 0\n", "").as_bytes()).contains("line 7: the facet has 2 corners, not 3")
        );
        assert!(error(TEXT.replace("endsolid a cube\n", "").as_bytes()).contains("line 8: the file ends without"));
        assert!(error(b"hello").contains("5 bytes are too few"));
    }

    #[test]
    fn a_coordinate_that_is_no_number_is_told_by_its_facet() {
        assert_eq!(
            error(TEXT.replace("1 0 0", "1 nan 0").as_bytes()),
            "cube.stl: facet 0: corner 1 is at (1, NaN, 0); coordinates must be finite and below 1e18"
        );
    }
}
