//! Who casts: chosen by the names of objects and materials.
//!
//! Structural components cast or don't as a whole, as in C. Wallner, "Geometry of real time shadows", 2007, figure 7.

use std::collections::BTreeSet;

use umbrae_core::{Material, Object, Role, Scene};
use wildmatch::WildMatch;

/// What the user said about casting.
#[derive(Debug, Clone, Default)]
pub struct CastChoice {
    /// If there are any, nothing else casts.
    pub cast: Vec<Pattern>,
    /// These don't cast, even if they are in `cast`.
    pub no_cast: Vec<Pattern>,
    /// Whether glass may cast.
    pub glass_casts: bool,
}

/// A name in which `*` stands for anything and `?` for one character; letters may be large or small.
#[derive(Debug, Clone)]
pub struct Pattern {
    text: String,
    matcher: WildMatch,
}

/// How many names are offered for a pattern that finds none.
const NAMES_OFFERED: usize = 3;

impl Pattern {
    /// `text` as it was typed.
    ///
    /// # Errors
    ///
    /// A sentence when it is empty.
    pub fn new(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if text.is_empty() {
            return Err(
                "an empty pattern names nothing; write names separated by commas, such as facade*,roof".to_owned()
            );
        }
        Ok(Self { text: text.to_owned(), matcher: WildMatch::new(&text.to_lowercase()) })
    }

    /// As it was typed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it is the name of `object` or of `material`. Something without a name is matched by `*` alone.
    fn is_of(&self, object: &Object, material: &Material) -> bool {
        self.is_name(&object.name) || self.is_name(&material.name)
    }

    fn is_name(&self, name: &str) -> bool {
        self.matcher.matches(&name.to_lowercase())
    }
}

impl CastChoice {
    /// Gives every object of `scene` its role; an object in which triangles have several is split. Returns a warning for each pattern
    /// that is the name of nothing, and one if nothing casts.
    pub fn assign(&self, scene: &mut Scene) -> Vec<String> {
        let warnings = self.unmatched(scene);
        scene.assign_roles(|object, material| {
            let is_among = |patterns: &[Pattern]| patterns.iter().any(|pattern| pattern.is_of(object, material));
            let role = Role::of_material(material);
            let may_cast = role.casts || (role.is_glass && self.glass_casts);
            let is_chosen = (self.cast.is_empty() || is_among(&self.cast)) && !is_among(&self.no_cast);
            Role { casts: may_cast && is_chosen, ..role }
        });
        let is_nothing = !scene.objects.is_empty() && scene.objects.iter().all(|object| !object.role.casts);
        let nothing = is_nothing.then(|| "nothing casts a shadow".to_owned());
        warnings.into_iter().chain(nothing).collect()
    }

    fn unmatched(&self, scene: &Scene) -> Vec<String> {
        if self.cast.is_empty() && self.no_cast.is_empty() {
            return Vec::new();
        }
        let names = names_in(scene);
        let is_unmatched = |pattern: &&Pattern| !names.iter().any(|name| pattern.is_name(name));
        let of_option = |option: &'static str, patterns: &[Pattern]| {
            let sentence = |pattern: &Pattern| {
                let closest = closest_names(&pattern.text, &names);
                format!("`{option} {}` is the name of no object or material; the closest are {closest}", pattern.text)
            };
            patterns.iter().filter(is_unmatched).map(sentence).collect::<Vec<_>>()
        };
        [of_option("--cast", &self.cast), of_option("--no-cast", &self.no_cast)].concat()
    }
}

/// Names of objects, and of materials that are in use.
fn names_in(scene: &Scene) -> BTreeSet<&str> {
    let mut names = BTreeSet::new();
    for object in &scene.objects {
        names.insert(object.name.as_str());
        let mut used: Vec<u32> = object.mesh.triangle_materials().to_vec();
        used.sort_unstable();
        used.dedup();
        names.extend(used.iter().filter_map(|&m| scene.materials.get(m as usize)).map(|m| m.name.as_str()));
    }
    names.remove("");
    names
}

/// In quotation marks, the likeliest first.
fn closest_names(pattern: &str, names: &BTreeSet<&str>) -> String {
    let plain = pattern.replace(['*', '?'], "").to_lowercase();
    let mut ranked: Vec<(f64, &str)> =
        names.iter().map(|&name| (strsim::jaro_winkler(&plain, &name.to_lowercase()), name)).collect();
    // Sorting keeps the order of the alphabet among equals.
    ranked.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    ranked.iter().take(NAMES_OFFERED).map(|(_, name)| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, Vec3};
    use umbrae_core::{AlphaMode, Mesh, Surface, shapes};

    use super::*;

    /// "Facade west" of concrete and glass, "roof" of tiles, "tree 1" of leaves.
    fn scene() -> Scene {
        let mesh = |materials: [u32; 2]| {
            let surface = Surface { ..shapes::tetrahedron([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]) };
            let triangle_materials = vec![materials[0], materials[0], materials[1], materials[1]];
            Arc::new(Mesh::new(Surface { triangle_materials, ..surface }).expect("a good mesh"))
        };
        let object = |name: &str, materials| Object::new(name, mesh(materials), DAffine3::IDENTITY);
        let glass = Material { alpha_mode: AlphaMode::Blend, alpha: 0.3, ..Material::new("Glass", Vec3::ONE) };
        let opaque = |name: &str| Material::new(name, Vec3::ONE);
        Scene {
            objects: vec![object("Facade west", [0, 1]), object("roof", [2, 2]), object("tree 1", [3, 3])],
            materials: vec![opaque("concrete"), glass, opaque("tiles"), opaque("leaves")],
            ..Scene::default()
        }
    }

    /// "name: triangles" of what casts, and the warnings.
    fn casting(cast: &str, no_cast: &str, glass_casts: bool) -> (Vec<String>, Vec<String>) {
        let patterns =
            |list: &str| list.split_terminator(',').map(|p| Pattern::new(p).expect("it names something")).collect();
        let mut scene = scene();
        let warnings = CastChoice { cast: patterns(cast), no_cast: patterns(no_cast), glass_casts }.assign(&mut scene);
        let casts = scene.objects.iter().filter(|object| object.role.casts);
        (casts.map(|object| format!("{}: {}", object.name, object.mesh.triangles().len())).collect(), warnings)
    }

    #[test]
    fn all_but_glass_casts_when_nothing_is_said() {
        assert_eq!(casting("", "", false).0, ["Facade west: 2", "roof: 4", "tree 1: 4"]);
        assert_eq!(casting("", "", true).0, ["Facade west: 2", "Facade west: 2", "roof: 4", "tree 1: 4"]);
    }

    #[test]
    fn what_is_named_casts_and_nothing_else() {
        assert_eq!(casting("roof", "", false).0, ["roof: 4"]);
        assert_eq!(casting("FACADE*,t?ee*", "", false).0, ["Facade west: 2", "tree 1: 4"]);
        assert_eq!(casting("*", "tree*", false).0, ["Facade west: 2", "roof: 4"]);
    }

    #[test]
    fn materials_have_names_too() {
        assert_eq!(casting("", "concrete,leaves", false).0, ["roof: 4"]);
        assert_eq!(casting("tiles", "", false).0, ["roof: 4"]);
    }

    #[test]
    fn glass_that_is_named_casts_only_where_glass_casts() {
        assert_eq!(casting("glass", "", false), (vec![], vec!["nothing casts a shadow".to_owned()]));
        assert_eq!(casting("glass", "", true).0, ["Facade west: 2"]);
        assert_eq!(casting("", "glass", true).0, ["Facade west: 2", "roof: 4", "tree 1: 4"]);
    }

    #[test]
    fn a_pattern_that_finds_nothing_is_told_with_the_closest_names() {
        let (casts, warnings) = casting("rooof*", "trees", false);
        assert!(casts.is_empty());
        assert_eq!(warnings.len(), 3, "{warnings:?}");
        assert!(
            warnings[0].starts_with("`--cast rooof*` is the name of no object or material; the closest are `roof`"),
            "{warnings:?}"
        );
        assert!(
            warnings[1].starts_with("`--no-cast trees` is the name of no object or material; the closest are `tree 1`")
        );
        assert_eq!(warnings[2], "nothing casts a shadow");
    }

    #[test]
    fn an_empty_pattern_is_refused() {
        assert!(Pattern::new(" ").is_err());
    }
}
