//! A city: the one document of a CityJSON file, or all lines of a sequence.

use std::ops::Range;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::choice::Choice;
use super::document::{CityObject, Document, Geometry, Transform, Version};
use crate::error::{Problem, quoted};
use crate::georeference::Said;
use crate::json::{Nested, json_problem, without_mark};

/// All that is in a file.
#[derive(Debug, Default)]
pub(super) struct City {
    /// Of all features, in the file's coordinates at first.
    pub(super) vertices: Vec<DVec3>,
    /// In the order of the file.
    pub(super) objects: Vec<Placed>,
    pub(super) templates: Vec<Geometry>,
    pub(super) template_vertices: Vec<DVec3>,
    /// What its coordinates are in.
    pub(super) said: Said,
    /// How many vertices have a coordinate that stands for none.
    pub(super) unknown: usize,
}

/// The least whole number of 32 bits, which some programs write for a height that they do not know.
const UNKNOWN: f64 = i32::MIN as f64;

/// A city object, and the vertices that its indices count from.
#[derive(Debug)]
pub(super) struct Placed {
    pub(super) id: String,
    pub(super) object: CityObject,
    pub(super) vertices: Range<usize>,
}

impl Placed {
    pub(super) fn geometries(&self) -> &[Geometry] {
        self.object.geometry.as_deref().unwrap_or_default()
    }
}

/// An object may be part of one that is part of one; real cities have two levels, and a crafted one has a cycle.
const MAX_ANCESTORS: usize = 8;

impl City {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Problem> {
        let mut city = Self::default();
        let mut transform = None;
        let documents = serde_json::Deserializer::from_slice(without_mark(bytes)).into_iter::<Document>();
        for (number, document) in documents.enumerate() {
            let document = document.map_err(|error| json_problem(&error))?;
            match (number, document.kind.as_str()) {
                (0, "CityJSON") => {
                    check_version(document.version.as_ref())?;
                    transform = document.transform;
                    let system = document.metadata.as_ref().and_then(|metadata| metadata.reference_system.as_deref());
                    city.said = Said::by(system);
                }
                (1.., "CityJSONFeature") => {}
                (0, "CityJSONFeature") => {
                    return Err(Problem::whole(
                        "it begins with a CityJSONFeature; a sequence begins with a line of type CityJSON, which has the transform",
                    ));
                }
                (0, other) => return Err(Problem::whole(format!("its type is {}, not CityJSON", quoted(other)))),
                (_, other) => {
                    let message = format!("its type is {}, not CityJSONFeature", quoted(other));
                    return Err(Problem::in_part("document", number, None, message));
                }
            }
            city.add(document, transform);
        }
        Ok(city)
    }

    /// Adds what is in `document`; the vertices of features are moved like those of the first document.
    fn add(&mut self, document: Document, transform: Option<Transform>) {
        let first = self.vertices.len();
        let identity = Transform { scale: [1.0; 3], translate: [0.0; 3] };
        let Transform { scale, translate } = document.transform.or(transform).unwrap_or(identity);
        let [scale, translate] = [scale, translate].map(DVec3::from);
        self.unknown += document.vertices.iter().filter(|vertex| vertex.contains(&UNKNOWN)).count();
        self.vertices.extend(document.vertices.into_iter().map(|v| DVec3::from(v) * scale + translate));
        let vertices = first..self.vertices.len();
        let placed = |(id, object)| Placed { id, object, vertices: vertices.clone() };
        self.objects.extend(document.objects.0.into_iter().map(placed));
        if let Some(templates) = document.templates {
            self.templates = templates.templates;
            self.template_vertices = templates.vertices.into_iter().map(DVec3::from).collect();
        }
    }

    /// The vertices that what is chosen of an object uses, as often as it does; indices that are none are left out.
    pub(super) fn vertices_of<'a>(&'a self, choice: &'a Choice) -> impl Iterator<Item = usize> + 'a {
        let placed = &self.objects[choice.object];
        let mut used = Vec::new();
        for &g in &choice.geometries {
            let geometry = &placed.geometries()[g];
            if geometry.kind == "GeometryInstance" {
                used.extend(Self::anchor_of(geometry, &placed.vertices));
                continue;
            }
            // Where nesting is wrong the surfaces before count; that it is wrong is told when they are cut.
            let _ = geometry.for_each_surface(|polygon| {
                let corners = polygon.rings.iter().filter_map(Nested::list).flatten();
                used.extend(corners.filter_map(|corner| vertex_at(corner, &placed.vertices)));
            });
        }
        used.into_iter()
    }

    /// The vertex at which an instance of a template stands.
    pub(super) fn anchor_of(instance: &Geometry, vertices: &Range<usize>) -> Option<usize> {
        vertex_at(instance.boundaries.list()?.first()?, vertices)
    }

    /// What each object is called: its id, after those of the objects it is part of.
    pub(super) fn names(&self) -> Vec<String> {
        let by_id: FxHashMap<&str, usize> =
            self.objects.iter().enumerate().map(|(i, placed)| (placed.id.as_str(), i)).collect();
        let parent = |i: usize| self.objects[i].object.parents.as_ref()?.first();
        let name = |(i, placed): (usize, &Placed)| {
            let mut path = vec![placed.id.as_str()];
            let mut at = Some(i);
            while let Some(id) = at.and_then(parent)
                && path.len() <= MAX_ANCESTORS
                && !path.contains(&id.as_str())
            {
                path.push(id);
                at = by_id.get(id.as_str()).copied();
            }
            path.reverse();
            path.join("/")
        };
        self.objects.iter().enumerate().map(name).collect()
    }
}

/// The vertex that an index counts to, if there is one.
pub(super) fn vertex_at(index: &Nested, vertices: &Range<usize>) -> Option<usize> {
    index.index().and_then(|index| vertices.start.checked_add(index)).filter(|v| vertices.contains(v))
}

fn check_version(version: Option<&Version>) -> Result<(), Problem> {
    let version = match version {
        None => return Err(Problem::whole("it says no version of CityJSON; 1.0, 1.1 and 2.0 can be read")),
        Some(Version::Text(text)) => text.clone(),
        Some(Version::Number(number)) => format!("{number:?}"),
    };
    if version.starts_with("1.") || version.starts_with("2.") {
        return Ok(());
    }
    let version = quoted(&version);
    Err(Problem::whole(format!(
        "it is CityJSON version {version}; 1.0, 1.1 and 2.0 can be read, so convert it with cjio"
    )))
}
