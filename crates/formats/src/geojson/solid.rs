//! A footprint, raised to a solid.
//!
//! ```text
//!      ______________
//!     /  roof  __    /|      The roof is the footprint cut into triangles, the base the same seen from below;
//!    /________/_/___/ |      each side of each ring has a wall of two triangles. The three share their
//!    |  wall        | |      corners, so that the solid is closed, and the outer ring goes around
//!    |______________|/       counter-clockwise, courtyards clockwise, so that all of it faces out.
//! ```

use glam::{DVec2, DVec3};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape;
use umbrae_core::Surface;

use crate::error::quoted;
use crate::json::Nested;
use crate::look::Looks;
use crate::place::MAX_COORDINATE;
use crate::polygon::{Cut, Triangulator};
use crate::warnings::Warnings;

/// A ring without its first corner again at the end.
type Ring = Vec<DVec2>;

/// A feature with a height.
#[derive(Debug)]
pub(super) struct Footprint {
    /// Its place in the file, from 0.
    pub(super) number: usize,
    pub(super) name: String,
    pub(super) bottom_m: f64,
    pub(super) top_m: f64,
    /// Each an outer ring and holes; in the file's coordinates at first.
    pub(super) polygons: Vec<Vec<Ring>>,
}

/// A polygon as it is in the file.
#[derive(Debug)]
pub(super) struct PolygonRead {
    pub(super) rings: Vec<Ring>,
    /// Whether its positions have heights other than 0.
    pub(super) has_heights: bool,
}

/// A polygon's coordinates, or what of them are none.
pub(super) fn polygon(coordinates: &Nested) -> Result<PolygonRead, String> {
    let rings = coordinates.list().ok_or_else(|| format!("{coordinates} is not a list of rings"))?;
    let mut polygon = PolygonRead { rings: Vec::with_capacity(rings.len()), has_heights: false };
    for ring in rings {
        let positions = ring.list().ok_or_else(|| format!("{ring} is not a list of positions"))?;
        let mut corners: Ring = Vec::with_capacity(positions.len());
        for position in positions {
            let number = |i: usize| position.list()?.get(i)?.number();
            let corner = number(0).zip(number(1)).map(DVec2::from).filter(|p| p.abs().max_element() < MAX_COORDINATE);
            corners.push(corner.ok_or_else(|| format!("{position} is not a position"))?);
            polygon.has_heights |= number(2).is_some_and(|height| height != 0.0);
        }
        polygon.rings.push(corners);
    }
    if polygon.rings.is_empty() { Err("it has no ring".to_owned()) } else { Ok(polygon) }
}

impl Footprint {
    pub(super) fn points(&self) -> impl Iterator<Item = &DVec2> + Clone {
        self.polygons.iter().flatten().flatten()
    }

    /// All corners, at the bottom and at the top.
    pub(super) fn corners(&self) -> impl Iterator<Item = DVec3> + Clone + '_ {
        self.points().flat_map(|p| [p.extend(self.bottom_m), p.extend(self.top_m)])
    }

    /// The longer side of its box, in the units of its coordinates.
    pub(super) fn size(&self) -> f64 {
        let (min, max) =
            self.points().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        (max - min).max_element()
    }
}

/// A ring that crosses itself everywhere has as many crossings as the square of this: a crafted file of many such rings must
/// not take minutes.
const MAX_RESOLVED_CORNERS: usize = 128;

/// Raises footprints; keeps its working memory from one to the next.
pub(super) struct Raiser {
    origin: DVec3,
    /// Materials of base, wall and roof.
    materials: [u32; 3],
    triangulator: Triangulator,
    corners: Vec<DVec3>,
    hole_starts: Vec<u32>,
    caps: Vec<[u32; 3]>,
}

impl Raiser {
    pub(super) fn new(origin: DVec3, looks: &mut Looks) -> Self {
        let materials = ["GroundSurface", "WallSurface", "RoofSurface"].map(|kind| looks.material_of("Building", kind));
        Self {
            origin,
            materials,
            triangulator: Triangulator::new(),
            corners: Vec::new(),
            hole_starts: Vec::new(),
            caps: Vec::new(),
        }
    }

    /// The solids over all polygons of `footprint`; without triangles if none has an area.
    pub(super) fn raise(&mut self, footprint: &Footprint, warnings: &mut Warnings) -> Surface {
        let mut surface = Surface::default();
        let place = || format!("feature {} {}", footprint.number, quoted(&footprint.name));
        for rings in &footprint.polygons {
            let Some(rings) = cleaned(rings) else {
                let words = ["polygon without area was skipped", "polygons without area were skipped"];
                warnings.add_one(words, place);
                continue;
            };
            if self.cut(&rings) == Cut::Exact {
                self.add(&rings, footprint, &mut surface);
                continue;
            }
            let words = [
                "footprint crosses itself; what is inside an odd number of times was taken for the building",
                "footprints cross themselves; what is inside an odd number of times was taken for the building",
            ];
            warnings.add_one(words, place);
            for rings in resolved(&rings) {
                self.cut(&rings);
                self.add(&rings, footprint, &mut surface);
            }
        }
        surface
    }

    /// Cuts a polygon into the triangles of its roof.
    fn cut(&mut self, rings: &[Ring]) -> Cut {
        self.corners.clear();
        self.hole_starts.clear();
        for (number, ring) in rings.iter().enumerate() {
            if number > 0 {
                self.hole_starts.push(self.corners.len() as u32);
            }
            self.corners.extend(ring.iter().map(|p| p.extend(0.0)));
        }
        self.caps.clear();
        let caps = &mut self.caps;
        self.triangulator.triangulate_with_holes(&self.corners, &self.hole_starts, |triangle| caps.push(triangle))
    }

    /// Adds the solid over the polygon that was cut last.
    fn add(&self, rings: &[Ring], footprint: &Footprint, surface: &mut Surface) {
        let first = surface.positions.len() as u32;
        let count = self.corners.len() as u32;
        for height_m in [footprint.bottom_m, footprint.top_m] {
            let at = |p: &DVec3| (p.truncate().extend(height_m) - self.origin).as_vec3();
            surface.positions.extend(self.corners.iter().map(at));
        }
        let [base, wall, roof] = self.materials;
        for &[a, b, c] in &self.caps {
            surface.triangles.push([a, c, b].map(|i| first + i));
            surface.triangles.push([a, b, c].map(|i| first + count + i));
            surface.triangle_materials.extend([base, roof]);
        }
        let mut start = first;
        for ring in rings {
            let corners = ring.len() as u32;
            for i in 0..corners {
                let (a, b) = (start + i, start + (i + 1) % corners);
                surface.triangles.extend([[a, b, b + count], [a, b + count, a + count]]);
                surface.triangle_materials.extend([wall; 2]);
            }
            start += corners;
        }
    }
}

/// `rings` without corners that repeat the one before, the outer one counter-clockwise and holes clockwise. `None` if the outer
/// one has no area; holes without area are left out.
fn cleaned(rings: &[Ring]) -> Option<Vec<Ring>> {
    let mut result = Vec::with_capacity(rings.len());
    for (number, ring) in rings.iter().enumerate() {
        let mut ring = ring.clone();
        ring.dedup();
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        let area = signed_area(&ring);
        if ring.len() < 3 || !(has_area(&ring)) {
            if number == 0 {
                return None;
            }
            continue;
        }
        let is_outer = number == 0;
        if (area > 0.0) != is_outer {
            ring.reverse();
        }
        result.push(ring);
    }
    Some(result).filter(|rings| !rings.is_empty())
}

/// Whether some three corners are not in line: a bow tie's signed area may be 0, and it has one all the same.
fn has_area(ring: &[DVec2]) -> bool {
    ring.windows(2).any(|side| (side[0] - ring[0]).perp_dot(side[1] - ring[0]) != 0.0)
}

fn signed_area(ring: &[DVec2]) -> f64 {
    let Some(&first) = ring.first() else { return 0.0 };
    ring.windows(2).map(|side| (side[0] - first).perp_dot(side[1] - first)).sum::<f64>() / 2.0
}

/// What is inside of `rings` an odd number of times, as polygons that do not cross themselves. One with very many corners is
/// left as it is.
fn resolved(rings: &[Ring]) -> Vec<Vec<Ring>> {
    if rings.iter().map(Vec::len).sum::<usize>() > MAX_RESOLVED_CORNERS {
        return vec![rings.to_vec()];
    }
    // About a corner, so that the grid on which crossings are found is fine.
    let first = rings[0][0];
    let contours: Vec<Vec<[f64; 2]>> =
        rings.iter().map(|ring| ring.iter().map(|&p| (p - first).to_array()).collect()).collect();
    let shapes = contours.simplify_shape(FillRule::EvenOdd);
    let ring = |contour: Vec<[f64; 2]>| contour.into_iter().map(|p| DVec2::from(p) + first).collect();
    let polygons = shapes.into_iter().map(|shape| shape.into_iter().map(ring).collect::<Vec<Ring>>());
    polygons.filter_map(|rings| cleaned(&rings)).collect()
}
