//! `shadows.geojson`: the exact outlines of shadows on the level of the ground, for each step and object, and all together.
//!
//! RFC 7946 where the models say where on Earth they are: longitudes and latitudes. Where they don't, coordinates are the
//! model's own metres, which that standard has no place for; a member of the collection says so.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec2;
use rayon::prelude::*;
use serde_json::{Value, json};
use umbrae_core::{Bounds, Caster, SurfaceKind};
use umbrae_study::{Outline, Polygon, Profile, Projection};

use super::parameters::parameters;
use crate::study::folder::Folder;
use crate::study::frame::Frame;
use crate::study::results::{Results, State};
use crate::study::site::iso;

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
    if results.frame.crs.is_none() {
        said.push(format!(
            "`{name}` is in metres of the models' own, as they have no coordinate reference system: programs for maps take that for degrees; give --crs if there is one"
        ));
    }
    if models.has_terrain() {
        said.push(format!(
            "the outlines in `{name}` are those on level ground at {:.1} m; hours are of receivers on the terrain",
            models.ground_level() + results.frame.origin.z
        ));
    }
    let casting: Vec<usize> = state.objects.iter().copied().filter(|&i| casts_on_ground(results, i)).collect();
    let casters: Vec<Caster> = casting.iter().map(|&i| models.casters[i].clone()).collect();
    let names: Vec<String> = casters.iter().map(|caster| caster.name.clone()).collect();
    let with_objects = casters.len() * results.day_steps() <= MOST_FEATURES;
    if !with_objects {
        said.push(format!("`{name}` has the shadows of all objects together only: one by one they are too many"));
    }
    let level = models.ground_level();
    let projection = Projection::new(&casters, level);
    let reach = reach(&Caster::bounds_of(&casters));
    let frame = Outline::rectangle(reach[0], reach[1]);
    let plane = Plane::new(&results.frame);
    let mut profile = Profile::new(0);
    let cut = AtomicUsize::new(0);
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
        let feature = |outline: &Outline, mut properties: Value| -> Option<String> {
            let is_cut = outline
                .bounds()
                .is_some_and(|[low, high]| [low, high] != [low, high].map(|p| p.clamp(reach[0], reach[1])));
            cut.fetch_add(usize::from(is_cut), Ordering::Relaxed);
            properties["is_cut"] = is_cut.into();
            let geometry = plane.multipolygon(&outline.intersection(&frame))?;
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
    let cut = cut.into_inner();
    if cut > 0 {
        said.push(format!(
            "{cut} outlines in `{name}` are of a sun so low that they reach further than {LONGEST_HEIGHTS} times the models' height, and are cut there (is_cut; area_m2 is of the whole)"
        ));
    }
    Ok(Some(Shadows { names, profile }))
}

/// Whether an object casts, and is not itself the ground.
fn casts_on_ground(results: &Results, object: usize) -> bool {
    let kinds = &results.models.kinds[object];
    let terrain = kinds.iter().filter(|&&kind| kind == SurfaceKind::Terrain).count();
    results.models.casters[object].role.casts && 2 * terrain <= kinds.len()
}

/// The least and the greatest coordinates that are written.
fn reach(bounds: &Bounds) -> [DVec2; 2] {
    let margin = DVec2::splat(LONGEST_HEIGHTS * bounds.size().z.max(1.0));
    [bounds.min.truncate() - margin, bounds.max.truncate() + margin]
}

fn write_head(results: &Results, level: f64, file: &mut BufWriter<File>) -> anyhow::Result<()> {
    let mut about: serde_json::Map<String, Value> =
        parameters(results).into_iter().map(|(name, value)| (name.to_ascii_lowercase(), value.into())).collect();
    if results.disc.is_some() {
        about.insert("outlines_of".to_owned(), "the middle of the sun's disc; hours are of its visible share".into());
    }
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

/// The plane in which a file's coordinates lie: degrees, or the model's metres, about an origin and in units of some decimetres.
///
/// Outlines are put on a grid there, and not before: a map projection bends edges, and rounding what comes out of it would make rings cross. All numbers are
/// multiples of powers of two, so that what is written is on the grid to the last bit.
#[derive(Debug, Clone, Copy)]
struct Plane<'a> {
    frame: &'a Frame,
    origin: DVec2,
    unit: f64,
}

/// In units of a plane: a millimetre or less.
const GRID: f64 = 1.0 / 1024.0;
/// 0.85 m or less.
const UNIT_DEG: f64 = 1.0 / 131_072.0;

impl<'a> Plane<'a> {
    fn new(frame: &'a Frame) -> Self {
        let unit = if frame.crs.is_some() { UNIT_DEG } else { 1.0 };
        let plane = Self { frame, origin: DVec2::ZERO, unit };
        let origin = plane.place(DVec2::ZERO).unwrap_or(DVec2::ZERO);
        Self { origin: (origin / unit).round() * unit, ..plane }
    }

    /// Where a point of the scene is, in the file's coordinates; `None` where the model's system does not reach.
    fn place(&self, point: DVec2) -> Option<DVec2> {
        if self.frame.crs.is_some() {
            self.frame.to_lon_lat(point.extend(0.0)).map(DVec2::from)
        } else {
            Some(self.frame.to_model(point.extend(0.0)).truncate())
        }
    }

    /// `outline` as a multipolygon; `None` where nothing is left of it, or it reaches beyond the model's system.
    fn multipolygon(&self, outline: &Outline) -> Option<Value> {
        let ring = |ring: &[DVec2]| -> Option<Vec<DVec2>> {
            ring.iter().map(|&p| Some((self.place(p)? - self.origin) / self.unit)).collect()
        };
        let polygon = |polygon: &Polygon| -> Option<Polygon> {
            let holes = polygon.holes.iter().map(|hole| ring(hole)).collect::<Option<_>>()?;
            Some(Polygon { exterior: ring(&polygon.exterior)?, holes })
        };
        let here = Outline { polygons: outline.polygons.iter().map(polygon).collect::<Option<_>>()? }.on_grid(GRID);
        let point = |p: &DVec2| json!((self.origin + *p * self.unit).to_array());
        let ring = |ring: &[DVec2]| -> Value { ring.iter().chain(ring.first()).map(point).collect() };
        let polygons: Value = here.polygons.iter().map(|p| p.rings().map(ring).collect::<Value>()).collect();
        (!here.is_empty()).then(|| json!({ "type": "MultiPolygon", "coordinates": polygons }))
    }
}

/// To tenths of thousandths.
fn round(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
