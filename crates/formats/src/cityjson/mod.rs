//! CityJSON 1.0 to 2.0 and `CityJSONSeq`, read by a parser of our own.
//!
//! The crate `cityjson-lib` keeps every attribute in a model of its own, with memory to match; here are only shapes, in
//! lists as the file has them, so that what a hostile file can take is a small multiple of its size.
//!
//! Every city object with surfaces is an object of the scene with a mesh of its own, so that closed solids stay closed.
//! One that is part of others is named "building/part". Vertices are read first, then the geometries to show are chosen
//! ([`choice`]), then their polygons are cut ([`shape`]).

mod choice;
mod city;
mod document;
mod shape;
mod surfaces;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use rustc_hash::FxHashMap;
use umbrae_core::{Bounds, Mesh, Object, Scene};

use crate::error::{Problem, quoted};
use crate::georeference::Georeference;
use crate::load::Context;
use crate::place::{OBJECT_SKIPPED, is_in_range, origin_on_earth};
use crate::sanity::warn_of_units;
use crate::warnings::Warnings;
use crate::{Animations, Format, Model, UpAxis};

use crate::look::Looks;
use choice::Choice;
use city::City;
use shape::{Shaper, Source};

/// Reads a CityJSON file, or a sequence.
pub(crate) fn read(bytes: &[u8], context: Context<'_>) -> Result<Model, Problem> {
    let mut warnings = Warnings::default();
    let mut city = City::read(bytes)?;
    let words = [
        "vertex has a coordinate of -2147483648, which some programs write for an unknown height; it was believed",
        "vertices have a coordinate of -2147483648, which some programs write for an unknown height; they were believed",
    ];
    warnings.add(city.unknown, words);
    let choices = choice::choose(&city, context.options.lod.as_deref(), &mut warnings)?;
    let georeference = place(&mut city, &choices, context, &mut warnings)?;
    let used = choices.iter().flat_map(|choice| city.vertices_of(choice)).map(|v| city.vertices[v]);
    let origin = origin_on_earth(used.filter(|&p| is_in_range(p)));

    let names = city.names();
    let mut looks = Looks::default();
    let mut objects = Vec::with_capacity(choices.len());
    let mut first_problem = None;
    let mut shaper = Shaper::new(&city.vertices, origin);
    let mut templates = Templates {
        city: &city,
        georeference: &georeference,
        shaper: Shaper::new(&city.template_vertices, DVec3::ZERO),
        meshes: FxHashMap::default(),
    };
    for choice in &choices {
        let placed = &city.objects[choice.object];
        let source = Source { id: &placed.id, kind: &placed.object.kind, vertices: placed.vertices.clone() };
        let geometries = choice.geometries.iter().map(|&g| &placed.geometries()[g]);
        let (instances, own): (Vec<_>, Vec<_>) = geometries.partition(|geometry| geometry.kind == "GeometryInstance");
        let surface = shaper.surface(&source, &own, &mut looks, &mut warnings);
        let mut found: Vec<Result<Object, String>> = Vec::new();
        if !surface.triangles.is_empty() {
            let mesh = Mesh::new(surface).map_err(|error| error.to_string());
            found.push(mesh.map(|mesh| Object::new(names[choice.object].clone(), Arc::new(mesh), DAffine3::IDENTITY)));
        }
        for instance in instances {
            let placed = templates.place(instance, &source, origin, &mut looks, &mut warnings);
            found.push(placed.map(|(mesh, at)| Object::new(names[choice.object].clone(), mesh, at)));
        }
        for result in found {
            match result {
                Ok(object) => objects.push(object),
                Err(message) => {
                    let problem = Problem::whole(format!("city object {}: {message}", quoted(&placed.id)));
                    warnings.add_one(OBJECT_SKIPPED, || problem.to_string());
                    first_problem.get_or_insert(problem);
                }
            }
        }
    }
    if objects.is_empty() {
        let reasons: Vec<String> = warnings.finish().iter().map(ToString::to_string).collect();
        let because = if reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join("; ")) };
        let count = city.objects.len();
        let nothing = || Problem::whole(format!("there is no usable surface in it{because}; city objects: {count}"));
        return Err(first_problem.unwrap_or_else(nothing));
    }
    let scene = Scene { origin, objects, materials: looks.into_materials(), ..Scene::default() };
    warn_of_units(&scene, &mut warnings);
    Ok(Model {
        scene,
        format: Format::CityJson,
        up: UpAxis::Z,
        crs: georeference.crs,
        source_crs: georeference.source_crs,
        warnings: warnings.finish(),
        animations: Animations::default(),
    })
}

/// Brings the vertices that are shown to where the scene has them.
fn place(
    city: &mut City,
    choices: &[Choice],
    context: Context<'_>,
    warnings: &mut Warnings,
) -> Result<Georeference, Problem> {
    let file = std::mem::take(&mut city.said).or_given(context.options.crs.as_ref(), warnings);
    let mut is_used = vec![false; city.vertices.len()];
    choices.iter().flat_map(|choice| city.vertices_of(choice)).for_each(|v| is_used[v] = true);
    let used = || (0..is_used.len()).filter(|&v| is_used[v]);
    let bounds = |city: &City| Bounds::of_points(used().map(|v| city.vertices[v]).filter(|&p| is_in_range(p)));
    let mut extent = bounds(city);
    if file.as_ref().is_some_and(crate::Crs::is_geographic) && !extent.is_empty() && is_latitude_first(extent) {
        let words = ["list of vertices has latitudes first", "lists of vertices have latitudes first"];
        warnings.add(1, words);
        city.vertices.iter_mut().for_each(|p| *p = DVec3::new(p.y, p.x, p.z));
        extent = bounds(city);
    }
    let middle = if extent.is_empty() { DVec3::ZERO } else { extent.center() };
    let georeference = Georeference::new(file, middle.truncate(), context.options, warnings)?;
    for v in used() {
        let p = city.vertices[v];
        if is_in_range(p) {
            let placed = georeference.point(p);
            city.vertices[v] = placed.map_err(|error| Problem::in_part("vertex", v, None, error.to_string()))?;
        }
    }
    Ok(georeference)
}

/// EPSG has latitudes first, programs do not; beyond 90 degrees there is no doubt.
fn is_latitude_first(extent: Bounds) -> bool {
    extent.min.y < -90.0 || extent.max.y > 90.0
}

/// Shapes that are shown in many places.
struct Templates<'a> {
    city: &'a City,
    georeference: &'a Georeference,
    shaper: Shaper<'a>,
    /// By template and kind of city object, for the colour; `None` for one that has no usable surface.
    meshes: FxHashMap<(usize, &'a str), Option<Arc<Mesh>>>,
}

impl<'a> Templates<'a> {
    /// The mesh that `instance` shows, and where.
    fn place(
        &mut self,
        instance: &document::Geometry,
        source: &Source<'a>,
        origin: DVec3,
        looks: &mut Looks,
        warnings: &mut Warnings,
    ) -> Result<(Arc<Mesh>, DAffine3), String> {
        let count = self.city.templates.len();
        let template = instance.template.ok_or("its GeometryInstance names no template")?;
        let shape = self
            .city
            .templates
            .get(template)
            .ok_or_else(|| format!("its GeometryInstance shows template {template}, but there are {count}"))?;
        let anchor = City::anchor_of(instance, &source.vertices).ok_or_else(|| {
            format!("its GeometryInstance is at vertex {}, of {}", instance.boundaries, source.vertices.len())
        })?;
        let [unit_m, vertical_unit_m] = self.georeference.units_m();
        let scale = DAffine3::from_scale(DVec3::new(unit_m, unit_m, vertical_unit_m));
        let anchor = self.city.vertices[anchor];
        if !is_in_range(anchor) {
            return Err(format!("its GeometryInstance is at {anchor}; coordinates must be finite and below 1e18"));
        }
        let at = DAffine3::from_translation(anchor - origin) * scale * shape::affine_of(instance.matrix.as_deref())?;
        let mesh = self.meshes.entry((template, source.kind)).or_insert_with(|| {
            let vertices = 0..self.city.template_vertices.len();
            let source = Source { id: source.id, kind: source.kind, vertices };
            let surface = self.shaper.surface(&source, &[shape], looks, warnings);
            (!surface.triangles.is_empty()).then(|| Mesh::new(surface).ok().map(Arc::new)).flatten()
        });
        let mesh = mesh.clone().ok_or_else(|| format!("its template {template} has no usable surface"))?;
        Ok((mesh, at))
    }
}
