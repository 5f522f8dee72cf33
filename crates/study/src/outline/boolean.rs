//! Boolean operations, by `i_overlay`, on a grid so fine that nothing is lost and so coarse that nothing is rounded on the way back.
//!
//! `i_overlay` works on whole numbers. On a grid whose numbers have 52 bits at most, each result is a `f64` exactly: its polygons are as valid
//! as the library made them, and going through it again moves no corner that is on the grid already.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::Solver;
use i_overlay::i_float::int::point::IntPoint;

use super::{Outline, Polygon, perimeter_m, signed_area_m2};

/// The grid is 2^-30 m, a nanometre: for a square of a millimetre that is still a millionth of its area.
const FINEST_EXPONENT: i32 = -30;

/// Numbers on the grid have fewer bits than an `f64` has for a whole number, so that they come back as they are.
const GRID_BITS: i32 = 52;

/// A polygon or a hole narrower than this in the mean is what rounding leaves between surfaces that share an edge, and goes. `f32` has less
/// than this for corners 16 m from the origin, and of a shadow of a square metre it is 2 parts in a million at most.
const SLIVER_WIDTH_M: f64 = 1e-6;

/// The region around which all of `loops` together wind, in either direction. One of them alone may be the border of a hole, so they can't be taken apart.
///
/// Halves of bodies done for themselves and then united take as long on one thread, and longer for bodies that overlap little.
pub(super) fn filled(loops: &[Vec<DVec2>]) -> Outline {
    let grid = Grid::reaching(loops.iter().flatten());
    operate(grid, OverlayRule::Subject, loops.iter().map(Vec::as_slice), std::iter::empty())
}

/// What any of `outlines` covers.
pub(super) fn union(outlines: &[&Outline]) -> Outline {
    let rings = || outlines.iter().flat_map(|outline| outline.rings());
    operate(Grid::reaching(rings().flatten()), OverlayRule::Subject, rings(), std::iter::empty())
}

pub(super) fn difference(a: &Outline, b: &Outline) -> Outline {
    of_two(OverlayRule::Difference, a, b)
}

pub(super) fn intersection(a: &Outline, b: &Outline) -> Outline {
    of_two(OverlayRule::Intersect, a, b)
}

fn of_two(rule: OverlayRule, a: &Outline, b: &Outline) -> Outline {
    operate(Grid::reaching(a.rings().chain(b.rings()).flatten()), rule, a.rings(), b.rings())
}

/// The rings around what any of `rings`, all counter-clockwise, has inside: counter-clockwise around it, clockwise around its holes. Slivers and all, on a grid of
/// at most 2^-50 of what is farthest from the origin.
pub(crate) fn united(rings: &[Vec<DVec2>]) -> Vec<Vec<DVec2>> {
    let grid = Grid::finest(rings.iter().flatten());
    let mut overlay = Overlay::<i64>::new_custom(0, IntOverlayOptions::default(), Solver::AUTO);
    for ring in rings {
        overlay.add_path_iter(ring.iter().map(|&p| grid.snap(p)), ShapeType::Subject);
    }
    let shapes = overlay.overlay(OverlayRule::Subject, FillRule::NonZero);
    shapes.iter().flatten().map(|ring| ring.iter().map(|&p| grid.place(p)).collect()).collect()
}

/// See [`Outline::on_grid`].
pub(super) fn on_grid(outline: &Outline, grid_m: f64) -> Outline {
    assert!(grid_m > 0.0 && grid_m.is_finite(), "a grid of {grid_m} m is none");
    let finest = Grid::reaching(outline.rings().flatten());
    let grid = Grid { exponent: finest.exponent.max(grid_m.log2().floor() as i32) };
    operate(grid, OverlayRule::Subject, outline.rings(), std::iter::empty())
}

fn operate<'a>(
    grid: Grid,
    rule: OverlayRule,
    subject: impl Iterator<Item = &'a [DVec2]>,
    clip: impl Iterator<Item = &'a [DVec2]>,
) -> Outline {
    let options = IntOverlayOptions { ogc: true, ..IntOverlayOptions::default() };
    let mut overlay = Overlay::<i64>::new_custom(0, options, Solver::AUTO);
    for (rings, kind) in
        [(&mut { subject } as &mut dyn Iterator<Item = _>, ShapeType::Subject), (&mut { clip }, ShapeType::Clip)]
    {
        for ring in rings {
            overlay.add_path_iter(ring.iter().map(|&p| grid.snap(p)), kind);
        }
    }
    let shapes = overlay.overlay(rule, FillRule::NonZero);
    let place = |ring: &Vec<IntPoint<i64>>| -> Vec<DVec2> { ring.iter().map(|&p| grid.place(p)).collect() };
    let polygon = |rings: &Vec<Vec<IntPoint<i64>>>| {
        let mut rings = rings.iter().map(place);
        Some(Polygon { exterior: rings.next()?, holes: rings.collect() })
    };
    without_slivers(Outline { polygons: shapes.iter().filter_map(polygon).collect() })
}

/// `outline` without polygons and holes that are slivers.
fn without_slivers(mut outline: Outline) -> Outline {
    let is_sliver = |area_m2: f64, perimeter_m: f64| area_m2.abs() < SLIVER_WIDTH_M * perimeter_m / 2.0;
    let ring_count = |outline: &Outline| outline.rings().count();
    let before = ring_count(&outline);
    outline.polygons.retain(|polygon| !is_sliver(polygon.area_m2(), polygon.rings().map(perimeter_m).sum()));
    let after_polygons = ring_count(&outline);
    for polygon in &mut outline.polygons {
        polygon.holes.retain(|hole| !is_sliver(signed_area_m2(hole), perimeter_m(hole)));
    }
    // What was an island in a hole that is gone would lie in its polygon twice.
    let has_lost_holes = ring_count(&outline) < after_polygons;
    debug_assert!(after_polygons <= before, "nothing is added");
    if has_lost_holes { union(&[&outline]) } else { outline }
}

/// Multiples of a power of two, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Grid {
    exponent: i32,
}

impl Grid {
    /// The finest that reaches to all `points`, and is not finer than outlines need.
    fn reaching<'a>(points: impl Iterator<Item = &'a DVec2>) -> Self {
        Self { exponent: Self::finest(points).exponent.max(FINEST_EXPONENT) }
    }

    /// The finest that reaches to all `points`.
    fn finest<'a>(points: impl Iterator<Item = &'a DVec2>) -> Self {
        let reach_m = points.fold(0.0_f64, |reach, p| reach.max(p.abs().max_element()));
        // One bit is the sign's, and one is left for the rounding of the logarithm.
        let coarse = if reach_m > 0.0 { reach_m.log2().ceil() as i32 - (GRID_BITS - 2) } else { FINEST_EXPONENT };
        Self { exponent: coarse }
    }

    fn snap(self, p: DVec2) -> IntPoint<i64> {
        let on_grid = (p * 2.0_f64.powi(-self.exponent)).round();
        IntPoint::new(on_grid.x as i64, on_grid.y as i64)
    }

    fn place(self, p: IntPoint<i64>) -> DVec2 {
        DVec2::new(p.x as f64, p.y as f64) * 2.0_f64.powi(self.exponent)
    }
}
