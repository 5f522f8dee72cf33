//! `shadows.geojson`: the exact outlines of shadows on the level of the ground, for each step and object, and all together.
//!
//! RFC 7946 where the models say where on Earth they are: longitudes and latitudes. Where they don't, coordinates are the
//! model's own metres, which that standard has no place for; a member of the collection says so.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::ops::ControlFlow;

use glam::DVec2;
use rayon::prelude::*;
use serde_json::{Value, json};
use umbrae_core::{Bounds, Caster, SurfaceKind};
use umbrae_study::{Outline, Profile, Projection};

use super::parameters::parameters;
use crate::study::folder::Folder;
use crate::study::results::{Results, State};
use crate::study::site::iso;

/// Corners are at multiples of this.
const GRID_M: f64 = 0.001;
/// A file of more is of no use to anyone; then only what all objects shade together is written…
const MOST_FEATURES: usize = 100_000;
/// …and beyond so many steps nothing.
const MOST_STEPS: usize = 2_000;
/// Shadows longer than so many heights of the models are cut off: they end beyond anything that the models show.
const LONGEST_HEIGHTS: f64 = 25.0;

/// Shadows of the objects of one state.
pub(super) struct Shadows {
    /// The name of each object that casts.
    pub(super) names: Vec<String>,
    pub(super) profile: Profile,
}

/// Writes the shadows of `state`, and returns them. `None`, with a warning for `said`, where there are too many.
pub(super) fn write(
    results: &Results,
    state: &State,
    folder: &mut Folder,
    said: &mut Vec<String>,
) -> anyhow::Result<Option<Shadows>> {
    let name = state.file_name("shadows", "geojson");
    if results.day_steps() > MOST_STEPS {
        said.push(format!("`{name}` is not written: outlines of {} steps are too many", results.day_steps()));
        return Ok(None);
    }
    let models = &results.models;
    let casting: Vec<usize> = state.objects.iter().copied().filter(|&i| casts_on_ground(results, i)).collect();
    let casters: Vec<Caster> = casting.iter().map(|&i| models.casters[i].clone()).collect();
    let names: Vec<String> = casters.iter().map(|caster| caster.name.clone()).collect();
    let with_objects = casters.len() * results.day_steps() <= MOST_FEATURES;
    if !with_objects {
        said.push(format!("`{name}` has the shadows of all objects together only: one by one they are too many"));
    }
    let level = models.ground_level();
    let projection = Projection::new(&casters, level);
    let frame = reach(&Caster::bounds_of(&casters));
    let mut profile = Profile::new(0);
    folder.write(&name, |file| {
        write_head(results, level, file)?;
        let mut separator = "\n";
        let mut write = |features: Vec<String>| -> anyhow::Result<()> {
            for feature in features {
                write!(file, "{separator}{feature}")?;
                separator = ",\n";
            }
            Ok(())
        };
        let feature = |outline: &Outline, properties: Value| -> Option<String> {
            let outline = outline.intersection(&frame).on_grid(GRID_M);
            let geometry = (!outline.is_empty()).then(|| geometry(results, &outline))?;
            Some(json!({ "type": "Feature", "properties": properties, "geometry": geometry }).to_string())
        };
        let mut failed = None;
        profile = Profile::cast(&projection, &results.suns, |step, of_objects, all| {
            let step = &results.timetable.steps[step];
            let properties = |source: &str, area_m2: f64| {
                json!({
                    "kind": "instant",
                    "time": iso(step.middle(), step.utc_offset_s),
                    "azimuth_deg": round(step.sun.azimuth_rad.to_degrees()),
                    "altitude_deg": round(step.sun.altitude_rad.to_degrees()),
                    "source": source,
                    "area_m2": round(area_m2),
                })
            };
            let each = if with_objects { of_objects } else { &[] };
            let mut features: Vec<String> = (each.par_iter().zip(&names))
                .filter_map(|(outline, name)| feature(outline, properties(name, outline.area_m2())))
                .collect();
            features.extend(feature(all, properties("all", all.area_m2())));
            match write(features) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    failed = Some(error);
                    ControlFlow::Break(())
                }
            }
        });
        if let Some(error) = failed {
            return Err(error);
        }
        let period = profile.period();
        let properties = json!({ "kind": "period", "source": "all", "area_m2": round(period.area_m2()) });
        write(feature(&period, properties).into_iter().collect())?;
        Ok(file.write_all(b"\n]}\n")?)
    })?;
    Ok(Some(Shadows { names, profile }))
}

/// Whether an object casts, and is not itself the ground.
fn casts_on_ground(results: &Results, object: usize) -> bool {
    let kinds = &results.models.kinds[object];
    let terrain = kinds.iter().filter(|&&kind| kind == SurfaceKind::Terrain).count();
    results.models.casters[object].role.casts && 2 * terrain <= kinds.len()
}

fn reach(bounds: &Bounds) -> Outline {
    let margin = DVec2::splat(LONGEST_HEIGHTS * bounds.size().z.max(1.0));
    Outline::rectangle(bounds.min.truncate() - margin, bounds.max.truncate() + margin)
}

fn write_head(results: &Results, level: f64, file: &mut BufWriter<File>) -> anyhow::Result<()> {
    let mut about: serde_json::Map<String, Value> =
        parameters(results).into_iter().map(|(name, value)| (name.to_ascii_lowercase(), value.into())).collect();
    about.insert("ground_level_m".to_owned(), json!(level + results.frame.origin.z));
    let coordinates = if results.frame.crs.is_some() {
        "longitude and latitude, WGS 84"
    } else {
        "the model's own, metres, x east and y north: not longitude and latitude as RFC 7946 has them"
    };
    write!(
        file,
        "{{\"type\":\"FeatureCollection\",\"coordinates\":{},\"study\":{},\"features\":[",
        json!(coordinates),
        Value::Object(about)
    )?;
    Ok(())
}

/// A multipolygon.
fn geometry(results: &Results, outline: &Outline) -> Value {
    let point = |p: DVec2| match results.frame.to_lon_lat(p.extend(0.0)) {
        Some([lon, lat]) => json!([rounded(lon, 1e9), rounded(lat, 1e9)]),
        None => {
            let p = results.frame.to_model(p.extend(0.0));
            json!([rounded(p.x, 1e4), rounded(p.y, 1e4)])
        }
    };
    let ring = |ring: &[DVec2]| -> Value { ring.iter().chain(ring.first()).map(|&p| point(p)).collect() };
    let polygon = |polygon: &umbrae_study::Polygon| -> Value { polygon.rings().map(ring).collect() };
    let polygons: Value = outline.polygons.iter().map(polygon).collect();
    json!({ "type": "MultiPolygon", "coordinates": polygons })
}

fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

fn round(value: f64) -> f64 {
    rounded(value, 1e4)
}
