//! OBJ material libraries: the diffuse colour of each material, and what of it we can't show.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use glam::Vec3;
use umbrae_core::Material;

use crate::error::quoted;
use crate::text::{Lines, first_word, lossy, number, words};
use crate::warnings::Warnings;

/// Materials by name, from every library that an OBJ file names.
///
/// `libraries` are what follows `mtllib`. A library that can't be read is a warning: shapes don't depend on it.
pub(super) fn read_libraries(
    libraries: &[String],
    folder: Option<&Path>,
    warnings: &mut Warnings,
) -> BTreeMap<String, Material> {
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
            match file_in(folder, name).map(fs::read) {
                Some(Ok(bytes)) => read_library(&bytes, &mut materials, warnings),
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
    // Names from Windows.
    let path = folder?.join(name.replace('\\', "/"));
    path.is_file().then_some(path)
}

fn read_library(bytes: &[u8], materials: &mut BTreeMap<String, Material>, warnings: &mut Warnings) {
    let mut current = None;
    for (_, line) in Lines::new(bytes) {
        let (keyword, rest) = first_word(line);
        if keyword == b"newmtl" {
            let name = lossy(rest);
            materials.insert(name.clone(), Material { name: name.clone(), ..Material::default() });
            current = Some(name);
            continue;
        }
        let Some(material) = current.as_ref().and_then(|name| materials.get_mut(name)) else { continue };
        match keyword {
            b"Kd" => match color(rest) {
                Some(color) => material.base_color = color,
                None => warnings.add_one(["diffuse colour can't be read", "diffuse colours can't be read"], || {
                    format!("{} of material {}", quoted(&lossy(rest)), quoted(&material.name))
                }),
            },
            b"map_Kd" => warnings.add(1, ["base colour texture is ignored", "base colour textures are ignored"]),
            b"d" if number(rest).is_some_and(|opacity| opacity < 1.0) => warn_transparent(material, warnings),
            b"Tr" if number(rest).is_some_and(|transparency| transparency > 0.0) => {
                warn_transparent(material, warnings);
            }
            _ => {}
        }
    }
}

fn warn_transparent(material: &Material, warnings: &mut Warnings) {
    let words =
        ["transparent material is drawn and casts as opaque", "transparent materials are drawn and cast as opaque"];
    warnings.add_one(words, || quoted(&material.name));
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
        write("my colours.mtl", "newmtl red\nKd 1 0 0\nmap_Kd bricks.png\n");
        write("a.mtl", "newmtl green\r\n\tKd 0 1 0\r\nd 0.5\r\n");
        let lines = ["my colours.mtl", "a.mtl b.mtl", "a.mtl b.mtl"].map(str::to_owned);
        let mut warnings = Warnings::default();
        let materials = read_libraries(&lines, Some(folder.path()), &mut warnings);
        assert_eq!(materials["red"].base_color, Vec3::X);
        assert_eq!(materials["green"].base_color, Vec3::Y);
        let texts: Vec<String> = warnings.finish().iter().map(ToString::to_string).collect();
        assert_eq!(
            texts,
            [
                "1 base colour texture is ignored",
                "1 transparent material is drawn and casts as opaque (first: \"green\")",
                "1 material library is missing; its colours are left out (first: \"b.mtl\")",
            ]
        );
    }
}
