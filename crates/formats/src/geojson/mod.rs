//! GeoJSON (RFC 7946, and the older one that names its coordinate reference system): footprints of buildings, raised to
//! their heights.
//!
//! Every feature with polygons and a height is an object: a closed solid with a base, walls and a roof, courtyards open.
//! The base is at 0, or where the feature says ([`height`]); heights in coordinates are left out, for programs write the
//! roof's there as often as the ground's.

mod document;
mod height;
mod solid;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::{DAffine3, DVec2};
use umbrae_core::{Bounds, Mesh, Object, Scene};

use crate::error::{Problem, quoted};
use crate::georeference::{Georeference, Said};
use crate::json::{Nested, json_problem, without_mark};
use crate::load::Context;
use crate::look::Looks;
use crate::place::{OBJECT_SKIPPED, origin_on_earth};
use crate::sanity::warn_of_units;
use crate::warnings::Warnings;
use crate::{Animations, Crs, Format, Model, UpAxis};

use document::{Document, Feature};
use height::Fields;
use solid::{Footprint, Raiser};

/// Whether a JSON whose `type` this is is GeoJSON.
pub(crate) fn is_kind(kind: &str) -> bool {
    matches!(
        kind,
        "FeatureCollection"
            | "Feature"
            | "GeometryCollection"
            | "Polygon"
            | "MultiPolygon"
            | "Point"
            | "MultiPoint"
            | "LineString"
            | "MultiLineString"
    )
}

/// Reads a GeoJSON file.
pub(crate) fn read(bytes: &[u8], context: Context<'_>) -> Result<Model, Problem> {
    let mut warnings = Warnings::default();
    let document: Document = serde_json::from_slice(without_mark(bytes)).map_err(|error| json_problem(&error))?;
    if !is_kind(&document.kind) {
        return Err(Problem::whole(format!("its type is {}, which is no GeoJSON", quoted(&document.kind))));
    }
    let said = Said::by(document.crs_name().as_deref());
    let features = document.into_features();
    let (mut footprints, extent) = footprints(&features, context, &mut warnings)?;

    let file = system(said, &footprints, extent, context, &mut warnings)?;
    let is_degrees = file.as_ref().is_some_and(Crs::is_geographic);
    // Around the date line longitudes go on beyond half a turn.
    let goes_around = is_degrees && extent.size().x > 180.0;
    let unturned = |p: DVec2| if goes_around && p.x < 0.0 { p + DVec2::X * 360.0 } else { p };
    let middle = footprints.iter().flat_map(Footprint::points).map(|&p| unturned(p).extend(0.0));
    let middle = Bounds::of_points(middle).center().truncate();
    let georeference = Georeference::new(file, middle, context.options, &mut warnings)?;
    for footprint in &mut footprints {
        let id = &footprint.name;
        let mut failed = None;
        for ring in footprint.polygons.iter_mut().flatten() {
            for p in ring {
                match georeference.point(unturned(*p).extend(0.0)) {
                    Ok(placed) => *p = placed.truncate(),
                    Err(error) => failed = failed.or(Some(error)),
                }
            }
        }
        if let Some(error) = failed {
            return Err(Problem::in_part("feature", footprint.number, Some(id), error.to_string()));
        }
    }
    raise(&footprints, georeference, warnings)
}

/// What has polygons and a height, in the file's coordinates, and how far it reaches.
fn footprints(
    features: &[Feature],
    context: Context<'_>,
    warnings: &mut Warnings,
) -> Result<(Vec<Footprint>, Bounds), Problem> {
    let fields = Fields::new(context.options, features)?;
    let mut footprints = Vec::with_capacity(features.len());
    let mut has_heights_inside = 0;
    for (number, feature) in features.iter().enumerate() {
        let name = feature.name().unwrap_or_else(|| format!("{} {number}", context.stem));
        let place = || format!("feature {number} {}", quoted(&name));
        let mut polygons = Vec::new();
        let mut skipped = None;
        feature.for_each_geometry(&mut |kind, coordinates: &Nested| {
            let found = match kind {
                "Polygon" => solid::polygon(coordinates).map(|polygon| polygons.push(polygon)),
                "MultiPolygon" => match coordinates.list() {
                    Some(list) => list.iter().try_for_each(|one| solid::polygon(one).map(|one| polygons.push(one))),
                    None => Err(format!("{coordinates} is not a list of polygons")),
                },
                other => Err(format!("it is a {}", quoted(other))),
            };
            if let Err(reason) = found {
                skipped.get_or_insert(reason);
            }
        });
        if let Some(reason) = skipped {
            let words = ["geometry that is no polygon was skipped", "geometries that are no polygons were skipped"];
            warnings.add_one(words, || format!("{}: {reason}", place()));
        }
        if polygons.is_empty() {
            let words = ["feature without a polygon was skipped", "features without a polygon were skipped"];
            warnings.add_one(words, place);
            continue;
        }
        let Some(span) = fields.span_of(feature, place, warnings) else { continue };
        has_heights_inside += usize::from(polygons.iter().any(|polygon| polygon.has_heights));
        footprints.push(Footprint {
            number,
            name,
            bottom_m: span.start,
            top_m: span.end,
            polygons: polygons.into_iter().map(|polygon| polygon.rings).collect(),
        });
    }
    warnings.add(
        has_heights_inside,
        [
            "feature has heights in its coordinates, which were left out; a property can be its base",
            "features have heights in their coordinates, which were left out; a property can be their base",
        ],
    );
    if footprints.is_empty() {
        let reasons: Vec<String> = std::mem::take(warnings).finish().iter().map(ToString::to_string).collect();
        let because = if reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join("; ")) };
        let count = features.len();
        let hint = fields.hint(features);
        return Err(Problem::whole(format!("there is no usable footprint in it{because}; features: {count}{hint}")));
    }
    let extent = Bounds::of_points(footprints.iter().flat_map(Footprint::points).map(|p| p.extend(0.0)));
    Ok((footprints, extent))
}

/// A building of this many units across is one of degrees if there are none larger, and one of metres otherwise:
/// 0.02 degrees are 2 km, and no footprint is 2 cm across.
const METRES_OR_DEGREES: f64 = 0.02;

/// What the coordinates are in: what the file says, or the user, or longitude and latitude as RFC 7946 has it, if they can
/// be that.
fn system(
    said: Said,
    footprints: &[Footprint],
    extent: Bounds,
    context: Context<'_>,
    warnings: &mut Warnings,
) -> Result<Option<Crs>, Problem> {
    let mut sizes: Vec<f64> = footprints.iter().map(Footprint::size).collect();
    let middle = sizes.len() / 2;
    let usual = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    let is_in_range = extent.min.x >= -360.0 && extent.max.x <= 360.0 && extent.min.y >= -90.0 && extent.max.y <= 90.0;
    let seems_degrees = is_in_range && usual < METRES_OR_DEGREES;
    let first = footprints.first().and_then(|footprint| footprint.points().next()).copied().unwrap_or_default();
    let is_silent = matches!(said, Said::Nothing);
    match said.or_given(context.options.crs.as_ref(), warnings) {
        Some(crs) if crs.is_geographic() || !seems_degrees => Ok(Some(crs)),
        Some(_) if is_silent => {
            let words = [
                "file has longitudes and latitudes, as GeoJSON should; the system of the options was not used for it",
                "files have longitudes and latitudes, as GeoJSON should; the system of the options was not used for them",
            ];
            warnings.add(1, words);
            Ok(Some(Crs::wgs84()))
        }
        Some(crs) => Err(Problem::whole(format!(
            "it says that it is in {crs}, but its coordinates, such as {}, {}, are longitudes and latitudes; correct its crs",
            first.x, first.y
        ))),
        None if seems_degrees => Ok(Some(Crs::wgs84())),
        None => Err(Problem::whole(format!(
            "its coordinates, such as {}, {}, are not longitudes and latitudes of buildings; name their system with --crs",
            first.x, first.y
        ))),
    }
}

fn raise(footprints: &[Footprint], georeference: Georeference, mut warnings: Warnings) -> Result<Model, Problem> {
    let corners = footprints.iter().flat_map(Footprint::corners);
    let origin = origin_on_earth(corners);
    let mut looks = Looks::default();
    let mut raiser = Raiser::new(origin, &mut looks);
    let mut objects = Vec::with_capacity(footprints.len());
    for footprint in footprints {
        let surface = raiser.raise(footprint, &mut warnings);
        if surface.triangles.is_empty() {
            let words = ["feature without area was skipped", "features without area were skipped"];
            warnings.add_one(words, || format!("feature {} {}", footprint.number, quoted(&footprint.name)));
            continue;
        }
        match Mesh::new(surface) {
            Ok(mesh) => objects.push(Object::new(footprint.name.clone(), Arc::new(mesh), DAffine3::IDENTITY)),
            Err(error) => warnings.add_one(OBJECT_SKIPPED, || format!("feature {}: {error}", footprint.number)),
        }
    }
    if objects.is_empty() {
        let reasons: Vec<String> = warnings.finish().iter().map(ToString::to_string).collect();
        return Err(Problem::whole(format!("there is no usable footprint in it ({})", reasons.join("; "))));
    }
    let scene = Scene { origin, objects, materials: looks.into_materials(), ..Scene::default() };
    warn_of_units(&scene, &mut warnings);
    Ok(Model {
        scene,
        format: Format::GeoJson,
        up: UpAxis::Z,
        crs: georeference.crs,
        source_crs: georeference.source_crs,
        warnings: warnings.finish(),
        animations: Animations::default(),
    })
}
