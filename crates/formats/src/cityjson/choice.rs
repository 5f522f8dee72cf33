//! Which geometries are shown: an object may have one for each level of detail.

use rustc_hash::FxHashMap;

use super::city::{City, Placed};
use super::document::{Geometry, Lod};
use crate::error::{Problem, quoted};
use crate::warnings::Warnings;

/// What is shown of one city object.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Choice {
    /// Index into the city's objects.
    pub(super) object: usize,
    /// Indices into its geometries, at least one.
    pub(super) geometries: Vec<usize>,
}

/// The geometries at level `lod` of each object, or its highest level.
///
/// Of the highest, a building's own geometry is left out where its parts have a higher one, for they are the same building.
///
/// # Errors
///
/// No object has that level: those that there are.
pub(super) fn choose(city: &City, lod: Option<&str>, warnings: &mut Warnings) -> Result<Vec<Choice>, Problem> {
    let mut choices = Vec::new();
    let wanted = lod.map(Lod::new);
    let of_parts = highest_of_parts(city);
    for (object, placed) in city.objects.iter().enumerate() {
        count_shapeless(placed, warnings);
        let level = match &wanted {
            Some(wanted) => geometries_of(city, placed).find(|(_, lod)| lod.is(wanted)).map(|(_, lod)| lod.clone()),
            None => highest(city, placed),
        };
        let Some(level) = level else {
            if geometries_of(city, placed).next().is_some() {
                let words = [
                    "city object has no geometry of the level of detail that was asked for and was left out",
                    "city objects have no geometry of the level of detail that was asked for and were left out",
                ];
                warnings.add_one(words, || quoted(&placed.id));
            }
            continue;
        };
        if wanted.is_none() && of_parts.get(placed.id.as_str()).is_some_and(|&parts| parts > level.level) {
            let words = [
                "geometry of a building was left out because its parts have a higher level of detail",
                "geometries of buildings were left out because their parts have a higher level of detail",
            ];
            warnings.add_one(words, || quoted(&placed.id));
            continue;
        }
        if level.level == 0.0 {
            let words = [
                "city object is a footprint (level of detail 0), which casts no shadow of a building",
                "city objects are footprints (level of detail 0), which cast no shadows of buildings",
            ];
            warnings.add_one(words, || quoted(&placed.id));
        }
        let geometries = geometries_of(city, placed).filter(|(_, lod)| lod.is(&level)).map(|(g, _)| g).collect();
        choices.push(Choice { object, geometries });
    }
    match (lod, choices.is_empty()) {
        (Some(lod), true) => Err(no_such_level(city, lod)),
        _ => Ok(choices),
    }
}

/// What has surfaces, with its level; an instance has that of its template.
fn geometries_of<'a>(city: &'a City, placed: &'a Placed) -> impl Iterator<Item = (usize, &'a Lod)> {
    const NONE: &Lod = &Lod { name: String::new(), level: -1.0 };
    placed.geometries().iter().enumerate().filter_map(|(g, geometry)| {
        let template = geometry.template.and_then(|template| city.templates.get(template));
        let is_instance = geometry.kind == "GeometryInstance";
        let lod = geometry.lod.as_ref().or_else(|| template.filter(|_| is_instance)?.lod.as_ref());
        (geometry.has_surfaces() || is_instance).then(|| (g, lod.unwrap_or(NONE)))
    })
}

fn highest(city: &City, placed: &Placed) -> Option<Lod> {
    let higher = |a: &&Lod, b: &&Lod| a.level.total_cmp(&b.level);
    geometries_of(city, placed).map(|(_, lod)| lod).max_by(higher).cloned()
}

/// For each object that has parts, the highest level that one of them has.
fn highest_of_parts(city: &City) -> FxHashMap<&str, f64> {
    let mut levels = FxHashMap::default();
    let parts = city.objects.iter().filter(|placed| placed.object.kind.ends_with("Part"));
    for (placed, level) in parts.filter_map(|placed| Some((placed, highest(city, placed)?.level))) {
        for parent in placed.object.parents.iter().flatten() {
            let highest = levels.entry(parent.as_str()).or_insert(level);
            *highest = highest.max(level);
        }
    }
    levels
}

fn count_shapeless(placed: &Placed, warnings: &mut Warnings) {
    let is_shapeless = |g: &&Geometry| !g.has_surfaces() && g.kind != "GeometryInstance";
    for geometry in placed.geometries().iter().filter(is_shapeless) {
        let words = ["geometry without surfaces was skipped", "geometries without surfaces were skipped"];
        warnings.add_one(words, || format!("city object {}: {}", quoted(&placed.id), quoted(&geometry.kind)));
    }
}

/// As many as belong in a message.
const LEVELS_SHOWN: usize = 12;

fn no_such_level(city: &City, wanted: &str) -> Problem {
    let mut levels: Vec<&Lod> = Vec::new();
    for (_, lod) in city.objects.iter().flat_map(|placed| geometries_of(city, placed)) {
        if levels.len() < LEVELS_SHOWN && !lod.name.is_empty() && !levels.iter().any(|known| known.is(lod)) {
            levels.push(lod);
        }
    }
    levels.sort_by(|a, b| a.level.total_cmp(&b.level));
    let wanted = quoted(wanted);
    if levels.is_empty() {
        return Problem::whole(format!("it has no level of detail {wanted}, nor any other; leave --lod out"));
    }
    let names: Vec<String> = levels.iter().map(|lod| quoted(&lod.name)).collect();
    Problem::whole(format!("it has no level of detail {wanted}; it has {}", names.join(", ")))
}
