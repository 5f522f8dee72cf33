//! Plans of the ground: hours of sun, the shadow profile, and before, after and their difference.

use std::collections::BTreeMap;
use std::io::Write as _;

use glam::DVec2;
use image::ExtendedColorType::Rgba8;
use umbrae_study::Outline;

use super::footprints::Footprint;
use super::legend::{Item, ticks};
use super::shadows_geojson::Shadows;
use super::sheet::{Map, Picture, Sheet, fill, line};
use crate::output::png;
use crate::show::canvas::{Area, Canvas, Rgb};
use crate::show::numbers::{counted, grouped};
use crate::study::folder::Folder;
use crate::study::results::{Results, State, duration_text};
use crate::study::scene::When;

/// Inside of solids, where no one stands.
pub(super) const SOLID: Rgb = [206, 204, 200];
/// What a study that was stopped has not come to.
const MISSING: Rgb = [244, 214, 224];
const BUILT: Rgb = [60, 62, 66];
const GOES: Rgb = [120, 120, 120];
const COMES: Rgb = [176, 0, 32];

/// Okabe and Ito's, which differ for all eyes, and three more.
const OBJECT_COLORS: [Rgb; 10] = [
    [0, 114, 178],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [213, 94, 0],
    [86, 180, 233],
    [240, 228, 66],
    [136, 34, 85],
    [68, 68, 68],
    [153, 153, 51],
];
const OTHER_OBJECTS: Rgb = [150, 150, 150];

const COLORS: usize = 256;
const LINE_WIDTH_PX: f64 = 2.0;

/// A picture with its name.
#[derive(Debug)]
pub(super) struct NamedMap {
    pub(super) name: String,
    pub(super) title: String,
    pub(super) picture: Picture,
}

/// Draws all plans, and writes them; nothing where the ground was not studied. With `shadows`, a profile in the colours of objects as well.
pub(super) fn write(
    results: &Results,
    footprints: &[Footprint],
    shadows: Option<&Shadows>,
    folder: &mut Folder,
) -> anyhow::Result<Vec<NamedMap>> {
    let Some((grid, _)) = results.ground() else { return Ok(Vec::new()) };
    let plan = Plan { results, map: Map::usual(grid), footprints };
    let mut maps = Vec::new();
    for state in &results.states {
        maps.push(plan.hours(state));
        maps.push(plan.profile(state));
    }
    if let [before, after] = results.states.as_slice() {
        maps.push(plan.difference(before, after));
    }
    if let (Some(shadows), Some(state)) = (shadows, results.last()) {
        maps.push(plan.by_object(state, shadows));
    }
    for map in &maps {
        let bytes = png(&map.picture.rgba, map.picture.size_px, Rgba8)?;
        folder.write(&map.name, |file| Ok(file.write_all(&bytes)?))?;
    }
    Ok(maps)
}

/// What all plans of a study share.
struct Plan<'a> {
    results: &'a Results,
    map: Map,
    footprints: &'a [Footprint],
}

/// What a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pixel {
    /// The mean of its cells.
    Value(f64),
    Solid,
    Missing,
}

impl Plan<'_> {
    fn hours(&self, state: &State) -> NamedMap {
        let possible = self.results.possible_hours();
        let colors = scale(|t| colorous::VIRIDIS.eval_continuous(t).as_array());
        let color = |pixel| match pixel {
            Pixel::Value(hours) => at(&colors, hours / possible),
            other => plain(other),
        };
        let mut legend = vec![
            Item::Heading(format!("Hours of sun, of {possible:.2} h")),
            Item::Scale(colors.clone(), ticks(possible)),
            Item::Gap,
        ];
        legend.extend(self.plain_items());
        let title = format!("Hours of sun on the ground{}", when_text(state));
        let value = |cell| state.hours(cell);
        self.named(state.file_name("hours", "png"), title, legend, state, value, color)
    }

    fn profile(&self, state: &State) -> NamedMap {
        let possible = self.results.possible_hours();
        let colors = scale(|t| colorous::BLUES.eval_continuous(0.02 + 0.98 * t).as_array());
        let never: Rgb = [255, 252, 240];
        let color = |pixel| match pixel {
            Pixel::Value(share) if share <= 0.0 => never,
            Pixel::Value(share) => at(&colors, share),
            other => plain(other),
        };
        let percent = |t: f64| (t, format!("{:.0} %", 100.0 * t));
        let mut legend = vec![
            Item::Heading("Shadow profile: share of the time in shadow".to_owned()),
            Item::Scale(colors.clone(), [0.0, 0.25, 0.5, 0.75, 1.0].map(percent).to_vec()),
            Item::Gap,
            Item::Area(never, "never in shadow".to_owned()),
        ];
        legend.extend(self.plain_items());
        let title = format!("Shadow profile{}", when_text(state));
        let value = |cell| state.hours(cell).map(|hours| (1.0 - hours / possible.max(1e-9)).max(0.0));
        self.named(state.file_name("profile", "png"), title, legend, state, value, color)
    }

    fn difference(&self, before: &State, after: &State) -> NamedMap {
        let difference = |cell| before.hours(cell).zip(after.hours(cell)).map(|(before, after)| after - before);
        let cells = self.map.grid.len();
        let most = (0..cells).filter_map(difference).map(f64::abs).fold(0.0, f64::max).max(1e-6);
        let colors = scale(|t| colorous::PURPLE_ORANGE.eval_continuous(t).as_array());
        let same: Rgb = [255, 255, 255];
        let color = |pixel| match pixel {
            Pixel::Value(0.0) => same,
            Pixel::Value(hours) => at(&colors, 0.5 + 0.5 * hours / most),
            other => plain(other),
        };
        let tick = |t: f64| (t, if t == 0.5 { "0".to_owned() } else { format!("{:+.1}", (2.0 * t - 1.0) * most) });
        let mut legend = vec![
            Item::Heading("Hours of sun, after less before".to_owned()),
            Item::Scale(colors.clone(), [0.0, 0.25, 0.5, 0.75, 1.0].map(tick).to_vec()),
            Item::Text("purple: less sun than before (net new shadow)".to_owned()),
            Item::Text("orange: more sun than before".to_owned()),
            Item::Gap,
            Item::Area(same, "no change".to_owned()),
        ];
        legend.extend(self.plain_items());
        self.named(
            "difference.png".to_owned(),
            "Change of the hours of sun".to_owned(),
            legend,
            after,
            difference,
            color,
        )
    }

    /// What each object shades at any step, in its own colour; those that shade most have names.
    fn by_object(&self, state: &State, shadows: &Shadows) -> NamedMap {
        let mut outlines: BTreeMap<&str, Vec<Outline>> = BTreeMap::new();
        for (i, name) in shadows.names.iter().enumerate() {
            outlines.entry(name).or_default().push(shadows.profile.object(i));
        }
        let mut named: Vec<(&str, Outline)> =
            outlines.into_iter().map(|(name, parts)| (name, Outline::union(&parts))).collect();
        named.sort_by(|(_, a), (_, b)| b.area_m2().total_cmp(&a.area_m2()));
        let color = |i: usize| OBJECT_COLORS.get(i).copied().unwrap_or(OTHER_OBJECTS);
        let mut legend = vec![Item::Heading("In shadow at any time, by what casts it".to_owned())];
        for (i, (name, outline)) in named.iter().take(OBJECT_COLORS.len()).enumerate() {
            let name = if name.is_empty() { "without a name" } else { name };
            legend.push(Item::Area(color(i), format!("{name}: {} m\u{b2}", grouped(outline.area_m2().round() as u64))));
        }
        if named.len() > OBJECT_COLORS.len() {
            legend.push(Item::Area(OTHER_OBJECTS, counted(named.len() - OBJECT_COLORS.len(), "other object")));
        }
        legend.push(Item::Gap);
        legend.extend(self.plain_items());
        let sheet = self.sheet("Shadow profile by object".to_owned(), legend);
        let background = |cells: &mut dyn Iterator<Item = usize>| match mean(cells, state, &|cell| state.hours(cell)) {
            Pixel::Value(_) => [255, 252, 240],
            other => plain(other),
        };
        let picture = sheet.draw(&self.map, background, |canvas, area| {
            // Those without a colour of their own lie below, then the largest, so that smaller ones are seen on it.
            let (own, others) = named.split_at(named.len().min(OBJECT_COLORS.len()));
            for (_, outline) in others {
                self.fill_outline(canvas, area, outline, OTHER_OBJECTS, 0.25);
            }
            for (i, (_, outline)) in own.iter().enumerate() {
                self.fill_outline(canvas, area, outline, color(i), 0.6);
            }
            self.draw_built(canvas, area, state);
        });
        NamedMap { name: state.file_name("profile_by_object", "png"), title: sheet.title, picture }
    }

    fn fill_outline(&self, canvas: &mut Canvas<'_>, area: Area, outline: &Outline, color: Rgb, opacity: f32) {
        for polygon in &outline.polygons {
            let on_map = |ring: &[DVec2]| ring.iter().map(|&p| self.map.place_px(p)).collect();
            let rings: Vec<Vec<DVec2>> = polygon.rings().map(on_map).collect();
            fill(canvas, area, &rings, color, opacity);
        }
    }

    fn sheet(&self, title: String, legend: Vec<Item>) -> Sheet {
        Sheet {
            title,
            lines: heading_lines(self.results),
            legend,
            notes: notes(self.results),
            north_deg: self.results.site.north_deg,
        }
    }

    fn named(
        &self,
        name: String,
        title: String,
        legend: Vec<Item>,
        state: &State,
        value: impl Fn(usize) -> Option<f64>,
        color: impl Fn(Pixel) -> Rgb,
    ) -> NamedMap {
        let sheet = self.sheet(title, legend);
        let pixel = |cells: &mut dyn Iterator<Item = usize>| color(mean(cells, state, &value));
        let picture = sheet.draw(&self.map, pixel, |canvas, area| self.draw_built(canvas, area, state));
        NamedMap { name, title: sheet.title, picture }
    }

    /// The outlines of what is there; of what comes and goes in colours of their own.
    fn draw_built(&self, canvas: &mut Canvas<'_>, area: Area, state: &State) {
        let is_difference = !state.name.is_empty();
        for footprint in self.footprints {
            let color = match (footprint.when, state.name) {
                (When::Always, _) => BUILT,
                (When::Before, "before") if is_difference => COMES,
                (When::Before, _) => GOES,
                (When::After, "before") => continue,
                (When::After, _) => COMES,
            };
            for edge in footprint.edges() {
                line(canvas, area, edge.map(|p| self.map.place_px(p)), LINE_WIDTH_PX, color);
            }
        }
    }

    /// What colours without a number mean, as far as they occur.
    fn plain_items(&self) -> Vec<Item> {
        let mut items = vec![Item::Area(SOLID, "inside of a building: no value".to_owned())];
        if self.results.is_partial {
            items.push(Item::Area(MISSING, "not computed: the study was stopped".to_owned()));
        }
        let is_compared = self.results.models.is_compared();
        items.push(Item::Line(
            BUILT,
            if is_compared { "there before and after" } else { "buildings, from above" }.to_owned(),
        ));
        if is_compared {
            items.push(Item::Line(GOES, "goes".to_owned()));
            items.push(Item::Line(COMES, "comes".to_owned()));
        }
        items
    }
}

/// What cells show together.
fn mean(cells: &mut dyn Iterator<Item = usize>, state: &State, value: &impl Fn(usize) -> Option<f64>) -> Pixel {
    let (mut sum, mut count, mut is_missing) = (0.0, 0, false);
    for cell in cells {
        match value(cell) {
            Some(value) => {
                sum += value;
                count += 1;
            }
            None => is_missing |= !state.is_inside[cell],
        }
    }
    match count {
        0 if is_missing => Pixel::Missing,
        0 => Pixel::Solid,
        _ => Pixel::Value(sum / f64::from(count)),
    }
}

fn plain(pixel: Pixel) -> Rgb {
    if pixel == Pixel::Missing { MISSING } else { SOLID }
}

fn scale(color: impl Fn(f64) -> Rgb) -> Vec<Rgb> {
    (0..COLORS).map(|i| color(i as f64 / (COLORS - 1) as f64)).collect()
}

fn at(colors: &[Rgb], place: f64) -> Rgb {
    colors[(place.clamp(0.0, 1.0) * (colors.len() - 1) as f64).round() as usize]
}

fn when_text(state: &State) -> &'static str {
    match state.name {
        "before" => ", before",
        "after" => ", after",
        _ => "",
    }
}

/// What, where and when, under the title of every picture.
pub(super) fn heading_lines(results: &Results) -> Vec<String> {
    let partial = if results.is_partial {
        ["PARTIAL: the study was stopped before its end".to_owned()].to_vec()
    } else {
        Vec::new()
    };
    let lines = [format!("{}, {}", results.subject, results.site.coordinates()), results.period_text()];
    partial.into_iter().chain(lines).collect()
}

/// How good it is and what made it, beside every picture.
pub(super) fn notes(results: &Results) -> Vec<String> {
    let [largest_s, mean_s] = results.error_bounds_s();
    let step_s = results.timetable.steps.first().map_or(0.0, umbrae_study::Step::duration_s);
    let mut notes = Vec::new();
    if let Some((grid, _)) = results.ground() {
        let what = if results.disc.is_some() {
            "each with its share of the sun's disc"
        } else {
            "each in the sun or in shadow"
        };
        notes.push(format!("Grid: a point every {} m, {what} every {} min.", grid.spacing, step_s / 60.0));
    }
    notes.push(format!(
        "Error bound of the hours: {} on average, {} at the worst point, if no sun or shade shorter than {} was missed.",
        duration_text(mean_s),
        duration_text(largest_s),
        results.shortest_seen()
    ));
    if let Some(check) = results.check {
        let (verdicts, differ) = (grouped(check.verdicts), grouped(check.disagreements));
        notes.push(format!("Check by rays in double precision: {differ} of {verdicts} verdicts differ."));
        if let Some(disc) = check.disc {
            let (shares, differ) = (grouped(disc.shares), grouped(disc.disagreements));
            notes.push(format!("Of the sun's disc, {differ} of {shares} shares differ from those of rays."));
        }
    }
    notes.push(format!("Sun: {}. Clear sky.", results.sun_text()));
    notes.push(format!("umbrae {}", env!("CARGO_PKG_VERSION")));
    notes
}
