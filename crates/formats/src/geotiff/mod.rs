//! GeoTIFF: a grid of heights, as a surface of triangles between neighbouring samples.
//!
//! Samples without a height are left open. Heights are metres unless the file says otherwise; a grid in degrees is
//! computed anew, sample by sample. TIFF itself is read by the crate `tiff`, what the tags of GeoTIFF mean by [`georef`].

mod georef;
mod samples;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};
use umbrae_core::{Bounds, Mesh, Object, Scene, Surface};

use crate::error::Problem;
use crate::georeference::Georeference;
use crate::load::Context;
use crate::look::Looks;
use crate::place::origin_on_earth;
use crate::sanity::warn_of_units;
use crate::warnings::Warnings;
use crate::{Animations, Format, Model, UpAxis};

use georef::GeoTags;
use samples::Grid;

/// Reads a GeoTIFF file: one object, called as the file.
pub(crate) fn read(bytes: &[u8], context: Context<'_>) -> Result<Model, Problem> {
    let mut warnings = Warnings::default();
    let mut decoder = samples::decoder(bytes)?;
    let tags = GeoTags::read(&mut decoder)?;
    let grid = Grid::read(&mut decoder, tags.no_data, context.options.terrain_step.unwrap_or(1), &mut warnings)?;

    let file = tags.said.clone().or_given(context.options.crs.as_ref(), &mut warnings);
    let at = |column: usize, row: usize| tags.position(DVec2::new(column as f64, row as f64) * f64::from(grid.step));
    let ends = [(0, 0), (grid.columns - 1, 0), (0, grid.rows - 1), (grid.columns - 1, grid.rows - 1)];
    let corners = ends.map(|(column, row)| at(column, row).extend(0.0));
    if !corners.iter().all(|corner| crate::place::is_in_range(*corner)) {
        return Err(Problem::whole(format!("its corner is at {}, which is no place", corners[0].truncate())));
    }
    let middle = Bounds::of_points(corners).center().truncate();
    let georeference = Georeference::new(file, middle, context.options, &mut warnings)?;
    let height_unit_m = tags.height_unit_m.unwrap_or(georeference.units_m()[1]);

    let mut points: Vec<DVec3> = Vec::new();
    // For each sample its number among those that have a height.
    let mut numbers: Vec<u32> = Vec::with_capacity(grid.heights.len());
    for (i, &height) in grid.heights.iter().enumerate() {
        if height.is_nan() {
            numbers.push(NO_SAMPLE);
            continue;
        }
        let (column, row) = (i % grid.columns, i / grid.columns);
        let point = georeference
            .point(at(column, row).extend(0.0))
            .map_err(|error| Problem::whole(format!("the sample in row {row}, column {column}: {error}")))?;
        numbers.push(points.len() as u32);
        points.push(point.truncate().extend(f64::from(height) * height_unit_m));
    }
    let origin = origin_on_earth(points.iter().copied());
    let triangles = triangles(&grid, &numbers, tags.is_mirrored());
    drop(numbers);
    if triangles.is_empty() {
        let (columns, rows) = (grid.columns, grid.rows);
        return Err(Problem::whole(format!("no three neighbours of its {columns} x {rows} samples have a height")));
    }
    let mut looks = Looks::default();
    let material = looks.material_of("TINRelief", "");
    debug_assert_eq!(material, 0, "the only one");
    let positions = points.iter().map(|&p| (p - origin).as_vec3()).collect();
    let mesh = Mesh::new(Surface { positions, triangles, ..Surface::default() });
    let mesh = mesh.map_err(|error| Problem::whole(error.to_string()))?;
    let objects = vec![Object::new(context.stem, Arc::new(mesh), DAffine3::IDENTITY)];
    let scene = Scene { origin, objects, materials: looks.into_materials(), ..Scene::default() };
    warn_of_units(&scene, &mut warnings);
    Ok(Model {
        scene,
        format: Format::GeoTiff,
        up: UpAxis::Z,
        crs: georeference.crs,
        source_crs: georeference.source_crs,
        warnings: warnings.finish(),
        animations: Animations::default(),
    })
}

/// Where there is no height.
const NO_SAMPLE: u32 = u32::MAX;

/// Two triangles between four neighbours, one where only three have a height; all face up.
///
/// ```text
///   a---d   columns to the right, rows down
///   | \ |   a, b, c and a, c, d; without a: b, c, d; without c: a, b, d
///   b---c
/// ```
fn triangles(grid: &Grid, numbers: &[u32], is_mirrored: bool) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for row in 1..grid.rows {
        for column in 1..grid.columns {
            let number = |column: usize, row: usize| numbers[row * grid.columns + column];
            let a = number(column - 1, row - 1);
            let b = number(column - 1, row);
            let c = number(column, row);
            let d = number(column, row - 1);
            let both = if a == NO_SAMPLE || c == NO_SAMPLE { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] };
            let whole = both.into_iter().filter(|triangle| !triangle.contains(&NO_SAMPLE));
            triangles.extend(whole.map(|[a, b, c]| if is_mirrored { [a, c, b] } else { [a, b, c] }));
        }
    }
    triangles
}
