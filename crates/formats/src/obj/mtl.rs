//! OBJ material libraries: the diffuse colour of each material, its texture and its opacity.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use glam::Vec3;
use umbrae_core::{AlphaMode, Material, Wrap};

use crate::error::quoted;
use crate::text::{Lines, first_word, lossy, number, words};
use crate::warnings::Warnings;

/// A material of a library.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct LibraryMaterial {
    pub(super) material: Material,
    /// What `map_Kd` names, if anything.
    pub(super) picture: Option<PictureOfMaterial>,
}

/// The picture of a `map_Kd` statement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PictureOfMaterial {
    /// As in the file.
    pub(super) name: String,
    /// Where it would be.
    pub(super) path: PathBuf,
    /// What is beyond its border.
    pub(super) wrap: Wrap,
}

/// Materials by name, from every library that an OBJ file names.
///
/// `libraries` are what follows `mtllib`. A library that can't be read is a warning: shapes don't depend on it.
pub(super) fn read_libraries(
    libraries: &[String],
    folder: Option<&Path>,
    warnings: &mut Warnings,
) -> BTreeMap<String, LibraryMaterial> {
    let mut materials = BTreeMap::new();
    let mut already_read: Vec<&str> = Vec::new();
    for line in libraries {
        if already_read.contains(&line.as_str()) {
            continue;
        }
        already_read.push(line);
        // A name may hold spaces, and spaces may stand between names.
        let whole = file_in(folder, line);
        let names = if whole.is_some() { vec![line.as_str()] } else { line.split_whitespace().collect() };
        for name in names {
            let path = file_in(folder, name);
            let bytes = path.as_ref().and_then(|path| fs::read(path).ok());
            match (path, bytes) {
                (Some(path), Some(bytes)) => {
                    // A file has a parent.
                    let folder = path.parent().unwrap_or(Path::new(""));
                    read_library(&bytes, folder, &mut materials, warnings);
                }
                _ => {
                    let words = [
                        "material library is missing; its colours are left out",
                        "material libraries are missing; their colours are left out",
                    ];
                    warnings.add_one(words, || quoted(name));
                }
            }
        }
    }
    materials
}

fn file_in(folder: Option<&Path>, name: &str) -> Option<PathBuf> {
    let path = folder?.join(with_slashes(name));
    path.is_file().then_some(path)
}

/// Names from Windows.
fn with_slashes(name: &str) -> String {
    name.replace('\\', "/")
}

fn read_library(
    bytes: &[u8],
    folder: &Path,
    materials: &mut BTreeMap<String, LibraryMaterial>,
    warnings: &mut Warnings,
) {
    let mut current = None;
    for (_, line) in Lines::new(bytes) {
        let (keyword, rest) = first_word(line);
        if keyword == b"newmtl" {
            let name = lossy(rest);
            let material = Material { name: name.clone(), ..Material::default() };
            materials.insert(name.clone(), LibraryMaterial { material, picture: None });
            current = Some(name);
            continue;
        }
        let Some(LibraryMaterial { material, picture }) = current.as_ref().and_then(|name| materials.get_mut(name))
        else {
            continue;
        };
        match keyword {
            b"Kd" => match color(rest) {
                Some(color) => material.base_color = color,
                None => warnings.add_one(["diffuse colour can't be read", "diffuse colours can't be read"], || {
                    format!("{} of material {}", quoted(&lossy(rest)), quoted(&material.name))
                }),
            },
            b"map_Kd" => {
                *picture = picture_of(rest, folder, warnings);
                // The grey of what says nothing of its colour is not for pictures.
                if picture.is_some() && material.base_color == Material::default().base_color {
                    material.base_color = Vec3::ONE;
                }
            }
            b"map_d" => {
                let words = ["opacity texture is ignored", "opacity textures are ignored"];
                warnings.add_one(words, || quoted(&material.name));
            }
            b"d" => set_opacity(material, number(rest)),
            b"Tr" => set_opacity(material, number(rest).map(|transparency| 1.0 - transparency)),
            _ => {}
        }
    }
}

/// A material that is less than opaque is glass.
fn set_opacity(material: &mut Material, opacity: Option<f64>) {
    if let Some(opacity) = opacity.filter(|opacity| *opacity < 1.0) {
        material.alpha = opacity.max(0.0) as f32;
        material.alpha_mode = AlphaMode::Blend;
    }
}

/// Options of `map_Kd`, with the most numbers or words that each takes.
const OPTIONS: [(&str, usize); 11] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-bm", 1),
    ("-cc", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
];

/// What follows `map_Kd`: options and a name, which may hold spaces.
fn picture_of(rest: &[u8], folder: &Path, warnings: &mut Warnings) -> Option<PictureOfMaterial> {
    let mut rest = rest;
    let mut wrap = Wrap::Repeat;
    loop {
        let (option, after) = first_word(rest);
        if option == b"-clamp" {
            let (value, after) = first_word(after);
            wrap = if value == b"on" { Wrap::Clamp } else { Wrap::Repeat };
            rest = after;
            continue;
        }
        let Some((name, most)) = OPTIONS.into_iter().find(|(name, _)| name.as_bytes() == option) else { break };
        let words = ["option of a texture is ignored", "options of textures are ignored"];
        warnings.add_one(words, || name.to_owned());
        rest = after;
        for i in 0..most {
            let (word, after) = first_word(rest);
            // The second and third number of an offset may be missing.
            if i > 0 && number(word).is_none() {
                break;
            }
            rest = after;
        }
    }
    let name = lossy(rest);
    (!name.is_empty()).then(|| PictureOfMaterial { path: folder.join(with_slashes(&name)), name, wrap })
}

/// Three numbers from 0 to 1, or one for all three channels.
fn color(words_of_it: &[u8]) -> Option<Vec3> {
    let mut channels = words(words_of_it).map(|word| number(word).filter(|c| (0.0..=1.0).contains(c)));
    let red = channels.next()??;
    let (green, blue) = match (channels.next(), channels.next()) {
        (None, _) => (red, red),
        (Some(green), Some(blue)) => (green?, blue?),
        (Some(_), None) => return None,
    };
    Some(Vec3::new(red as f32, green as f32, blue as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_is_three_numbers_or_one() {
        assert_eq!(color(b"0.5 0.25 1"), Some(Vec3::new(0.5, 0.25, 1.0)));
        assert_eq!(color(b" 0.5 "), Some(Vec3::splat(0.5)));
        for bad in ["", "0.5 0.5", "1 2 3", "nan 0 0", "spectral a.rfl"] {
            assert_eq!(color(bad.as_bytes()), None, "{bad}");
        }
    }

    #[test]
    fn libraries_are_found_with_spaces_in_and_between_their_names() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
        write("my colours.mtl", "newmtl red\nKd 1 0 0\nmap_Kd -s 2 2 -o 0.5 -clamp on walls\\old bricks.png\n");
        write("a.mtl", "newmtl green\r\n\tKd 0 1 0\r\nd 0.5\r\n");
        let lines = ["my colours.mtl", "a.mtl b.mtl", "a.mtl b.mtl"].map(str::to_owned);
        let mut warnings = Warnings::default();
        let materials = read_libraries(&lines, Some(folder.path()), &mut warnings);
        assert_eq!(materials["red"].material.base_color, Vec3::X);
        let bricks = PictureOfMaterial {
            name: r"walls\old bricks.png".to_owned(),
            path: folder.path().join("walls/old bricks.png"),
            wrap: Wrap::Clamp,
        };
        assert_eq!(materials["red"].picture, Some(bricks));
        let green = &materials["green"].material;
        assert_eq!((green.base_color, green.alpha, green.alpha_mode), (Vec3::Y, 0.5, AlphaMode::Blend));
        let texts: Vec<String> = warnings.finish().iter().map(ToString::to_string).collect();
        assert_eq!(
            texts,
            [
                "2 options of textures are ignored (first: -s)",
                "1 material library is missing; its colours are left out (first: \"b.mtl\")",
            ]
        );
    }
}
