//! The faces of a volume as indices.

use std::ops::Range;

use glam::{DVec3, Vec3};
use umbrae_core::{Bounds, Case, Caster, Chain, LightPosition, ShadowVolume};

use super::casters::{AXES, Block};
use super::report::CasterReport;

/// How faces are counted; in the order in which they are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    /// In front of what is seen.
    Pass,
    /// Behind what is seen.
    Fail,
    /// Behind what is seen, by definition: these faces lie on visible surfaces.
    LightCap,
    /// [`Part::Pass`], for triangles that are wound the other way round than their volume.
    PassTurned,
    /// [`Part::Fail`], for triangles that are wound the other way round than their volume.
    FailTurned,
}

/// Indices of both widths; a caster's are in one of them.
#[derive(Debug, Default)]
pub(crate) struct Indices {
    pub(crate) short: Vec<u16>,
    pub(crate) long: Vec<u32>,
}

impl Indices {
    pub(super) fn add(&mut self, is_short: bool, triangles: &[[u32; 3]]) -> Range<u32> {
        let flat = triangles.as_flattened();
        let start = if is_short { self.short.len() } else { self.long.len() };
        if is_short {
            self.short.extend(flat.iter().map(|&i| i as u16));
        } else {
            self.long.extend_from_slice(flat);
        }
        start as u32..(start + flat.len()) as u32
    }

    pub(crate) fn clear(&mut self) {
        self.short.clear();
        self.long.clear();
    }

    /// Bytes of all.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.short.as_slice()) + size_of_val(self.long.as_slice())
    }
}

/// Adds what must be drawn of `volume`, the volume over `chain`, to `indices` and to `report`.
#[expect(clippy::too_many_arguments, reason = "one caller; a struct would only repeat the names")]
pub(super) fn emit(
    indices: &mut Indices,
    caster: &Caster,
    block: Block,
    chain: Option<&Chain>,
    volume: &ShadowVolume,
    (case, shows_dark_cap): (Case, bool),
    light: LightPosition,
    report: &mut CasterReport,
) -> Vec<(Part, bool, Range<u32>)> {
    let is_short = block.is_short();
    let mut added = Vec::new();
    let mut add = |part, triangles: &[[u32; 3]]| {
        if !triangles.is_empty() {
            added.push((part, is_short, indices.add(is_short, triangles)));
        }
    };
    let is_pass = case == Case::Pass;
    let mut body = sides(block, &volume.sides, light);
    report.faces_mut().side_triangles += body.len();
    if !is_pass && shows_dark_cap && !light.is_directional() {
        let before = body.len();
        add_dark_cap(&mut body, (&caster.positions, &caster.bounds), block, volume, light);
        report.faces_mut().dark_cap_triangles += body.len() - before;
    }
    add(if is_pass { Part::Pass } else { Part::Fail }, &body);

    if caster.role.is_see_through() {
        // Not every pixel of these surfaces is in the depth buffer, so their caps are in front of what is seen or behind it like any other
        // face; and where they are what is seen, only the triangle as it was drawn has the same depth.
        let chain = chain.expect("caps of what can be seen through are drawn in every case");
        let (faced, turned) = caps_as_drawn(block, caster, chain);
        report.faces_mut().light_cap_triangles += faced.len() + turned.len();
        add(if is_pass { Part::Pass } else { Part::Fail }, &faced);
        add(if is_pass { Part::PassTurned } else { Part::FailTurned }, &turned);
    } else if case == Case::Fail {
        let cap: Vec<[u32; 3]> = volume.light_cap.iter().map(|t| t.map(|i| block.near(i))).collect();
        report.faces_mut().light_cap_triangles += cap.len();
        add(Part::LightCap, &cap);
    }
    added
}

pub(super) fn sides(block: Block, edges: &[[u32; 2]], light: LightPosition) -> Vec<[u32; 3]> {
    let (near, far) = (|i| block.near(i), |i| block.far(i));
    if light.is_directional() {
        // All copies at infinity are one point, and so is that of the middle.
        return edges.iter().map(|&[a, b]| [near(a), Block::MIDDLE, near(b)]).collect();
    }
    let quad = |&[a, b]: &[u32; 2]| {
        // The diagonal starts at the lower vertex, so that quads of one edge that run both ways cancel exactly.
        if a < b {
            [[near(a), far(a), far(b)], [near(a), far(b), near(b)]]
        } else {
            [[near(b), near(a), far(a)], [near(b), far(a), far(b)]]
        }
    };
    edges.iter().flat_map(quad).collect()
}

/// A fan about the axis is narrow when the light is at least this many radii from the middle: within 57 degrees of the axis.
pub(super) const FAN_RADII: f64 = 1.2;

/// Closes the volume at infinity; the shape of the cap does not matter, only its border.
///
/// Source: McGuire et al. 2003, section 6. He starts the fan at a vertex and must cut triangles that span more than 180 degrees; about the axis
/// through the middle of the caster none does. Where the light is too near for that, the chain itself is projected.
pub(crate) fn add_dark_cap(
    triangles: &mut Vec<[u32; 3]>,
    (positions, bounds): (&[Vec3], &Bounds),
    block: Block,
    volume: &ShadowVolume,
    light: LightPosition,
) {
    let is_fan_smaller = volume.sides.len() <= volume.light_cap.len();
    if is_fan_smaller && is_fan_narrow(bounds, light) {
        add_fan(triangles, block, &volume.sides);
    } else {
        add_at_infinity(triangles, block, positions, volume.light_cap.iter().copied(), light);
    }
}

/// Whether a dark cap may be a fan about the middle of the caster.
pub(super) fn is_fan_narrow(bounds: &Bounds, light: LightPosition) -> bool {
    light.offset_from(bounds.center()).length() >= FAN_RADII * bounds.radius()
}

/// The dark cap as a fan over `sides`.
pub(super) fn add_fan(triangles: &mut Vec<[u32; 3]>, block: Block, sides: &[[u32; 2]]) {
    triangles.extend(sides.iter().map(|&[a, b]| [block.far(b), block.far(a), Block::MIDDLE]));
}

/// The dark cap as the `chain` at infinity, of triangles of `positions`.
pub(super) fn add_at_infinity(
    triangles: &mut Vec<[u32; 3]>,
    block: Block,
    positions: &[Vec3],
    chain: impl Iterator<Item = [u32; 3]>,
    light: LightPosition,
) {
    let far = |i| block.far(i);
    for [a, b, c] in chain {
        let away = |i: u32| -light.offset_from(positions[i as usize].as_dvec3());
        match fan_axis([away(a), away(b), away(c)]) {
            None => triangles.push([far(a), far(c), far(b)]),
            Some(m) => triangles.extend([[far(a), far(c), m], [far(c), far(b), m], [far(b), far(a), m]]),
        }
    }
}

/// The cosine, between the triangle's normal and the direction to a corner, below which all directions are nearly in one plane.
const FLAT: f64 = 0.05;

/// The volume vertex about which the dark cap of a triangle must be a fan; `None` where it may be the triangle itself.
///
/// `away` points from the light to the corners, as they turn counter-clockwise seen from the light. Under a lamp close to a large triangle they spread
/// over nearly a half-plane all round, and so a cap of three such corners is clipped with errors of many pixels (for `f32`, and for McGuire's
/// "more than 180 degrees" ambiguous). Its shape does not matter, only its border: a fan about the axis that points away from the lamp most nearly
/// at a right angle to the triangle has only narrow triangles.
fn fan_axis(away: [DVec3; 3]) -> Option<u32> {
    let [a, b, c] = away;
    let is_wide = a.dot(b) < 0.0 || b.dot(c) < 0.0 || c.dot(a) < 0.0;
    if !is_wide {
        return None;
    }
    let normal_to_light = (b - a).cross(c - a);
    if a.dot(normal_to_light).abs() > FLAT * a.length() * normal_to_light.length() {
        return None;
    }
    let downness = |axis: &DVec3| -axis.dot(normal_to_light);
    let best = (0..AXES.len()).max_by(|&i, &j| downness(&AXES[i]).total_cmp(&downness(&AXES[j])))?;
    Some(best as u32)
}

/// The light cap as the mesh has its triangles: those that are wound as the volume needs them, and the others.
fn caps_as_drawn(block: Block, caster: &Caster, chain: &Chain) -> (Vec<[u32; 3]>, Vec<[u32; 3]>) {
    let (mut faced, mut turned) = (Vec::new(), Vec::new());
    for (t, &times) in caster.mesh.triangles().iter().zip(chain.coefficients()) {
        let cap = if times > 0 { &mut faced } else { &mut turned };
        cap.extend(std::iter::repeat_n(t.map(|i| block.near(i)), times.unsigned_abs().into()));
    }
    (faced, turned)
}
