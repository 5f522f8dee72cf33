//! Shadows on a level plane, as polygons.
//!
//! ```text
//!      sun                        project   casters, plane, sun -> the boundary of each caster's shadow, as closed loops
//!        \    ______              loops     directed edges in any order -> closed loops
//!         \  |      |             boolean   loops -> polygons; polygons and polygons -> polygons
//!          \ |      |
//!   ________\|______|____.......  plane
//!                   |__shadow__|
//! ```

mod boolean;
mod loops;
mod project;
#[cfg(test)]
mod tests;

use glam::DVec2;

pub(crate) use boolean::united;
pub use project::Projection;

/// A region of a level plane: polygons that do not overlap and touch in single points at most.
///
/// Metres, x east and y north, about the scene's origin. Valid as the Simple Features of OGC have it, up to the rounding of whoever
/// writes it with fewer digits; see [`Outline::on_grid`].
///
/// ```
/// use glam::DVec2;
/// use umbrae_study::Outline;
///
/// let park = Outline::rectangle(DVec2::ZERO, DVec2::new(40.0, 20.0));
/// let shadow = Outline::rectangle(DVec2::new(30.0, -5.0), DVec2::new(50.0, 10.0));
/// assert_eq!(park.intersection(&shadow).area_m2(), 100.0);
/// assert_eq!(park.minus(&shadow).area_m2(), 700.0);
/// assert_eq!(Outline::union([&park, &shadow]).area_m2(), 1000.0);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outline {
    /// In no order that means anything, but the same on every run.
    pub polygons: Vec<Polygon>,
}

/// A ring and the holes in it. A ring does not repeat its first point at its end, nor any other point next to itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Polygon {
    /// Counter-clockwise, as RFC 7946 asks for.
    pub exterior: Vec<DVec2>,
    /// Clockwise.
    pub holes: Vec<Vec<DVec2>>,
}

impl Polygon {
    /// The exterior, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &[DVec2]> {
        std::iter::once(&self.exterior).chain(&self.holes).map(Vec::as_slice)
    }

    /// What the exterior holds, less the holes; square metres.
    pub fn area_m2(&self) -> f64 {
        self.rings().map(signed_area_m2).sum()
    }
}

impl Outline {
    /// The rectangle between two opposite corners.
    pub fn rectangle(min: DVec2, max: DVec2) -> Self {
        let ring = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        boolean::filled(&[ring.to_vec()])
    }

    /// What any of `outlines` covers.
    ///
    /// Takes n log n for n corners in all, about a microsecond each.
    pub fn union<'a>(outlines: impl IntoIterator<Item = &'a Self>) -> Self {
        let outlines: Vec<&Self> = outlines.into_iter().filter(|outline| !outline.is_empty()).collect();
        match *outlines.as_slice() {
            [] => Self::default(),
            [only] => only.clone(),
            _ => boolean::union(&outlines),
        }
    }

    /// What this covers and `other` does not: net new shadow, where this is the proposed and `other` the existing one.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        boolean::difference(self, other)
    }

    /// What both cover.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        boolean::intersection(self, other)
    }

    /// The same region with corners at whole multiples of `grid_m` only, or of the nearest smaller power of two, and valid there.
    ///
    /// Whoever writes coordinates with few digits may write those of such an outline: rounding the corners of any other may make its rings
    /// cross. What is narrower than the grid goes. Corners move by at most a grid's diagonal.
    ///
    /// # Panics
    ///
    /// If `grid_m` is not a positive number.
    #[must_use]
    pub fn on_grid(&self, grid_m: f64) -> Self {
        boolean::on_grid(self, grid_m)
    }

    /// Whether nothing is covered.
    pub fn is_empty(&self) -> bool {
        self.polygons.is_empty()
    }

    /// What is covered, in square metres.
    pub fn area_m2(&self) -> f64 {
        self.polygons.iter().map(Polygon::area_m2).sum()
    }

    /// Every ring of every polygon.
    pub fn rings(&self) -> impl Iterator<Item = &[DVec2]> {
        self.polygons.iter().flat_map(Polygon::rings)
    }

    /// The least and the greatest coordinates; `None` where nothing is covered.
    pub fn bounds(&self) -> Option<[DVec2; 2]> {
        let corners = self.polygons.iter().flat_map(|polygon| &polygon.exterior).copied();
        corners.map(|p| [p, p]).reduce(|[low, high], [p, q]| [low.min(p), high.max(q)])
    }

    /// Whether `point` is covered; on the border, either. Linear in the number of corners.
    pub fn contains(&self, point: DVec2) -> bool {
        let is_crossed = |&[a, b]: &[DVec2; 2]| {
            let spans = (a.y > point.y) != (b.y > point.y);
            spans && ((b - a).perp_dot(point - a) > 0.0) == (b.y > a.y)
        };
        self.rings().flat_map(ring_edges).filter(is_crossed).count() % 2 == 1
    }

    /// Metres from `point` to the nearest border; infinite where there is none. Linear in the number of corners.
    pub fn distance_to_border_m(&self, point: DVec2) -> f64 {
        let distance = |[a, b]: [DVec2; 2]| {
            let along = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            point.distance(a + along * (b - a))
        };
        self.rings().flat_map(ring_edges).map(distance).fold(f64::INFINITY, f64::min)
    }
}

/// The edges of a ring, the last one back to its first point.
fn ring_edges(ring: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> + '_ {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}

/// Positive where the ring is counter-clockwise. Summed about its first point, so that far coordinates cost no digits.
fn signed_area_m2(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    0.5 * ring.windows(2).map(|edge| (edge[0] - origin).perp_dot(edge[1] - origin)).sum::<f64>()
}

fn perimeter_m(ring: &[DVec2]) -> f64 {
    ring_edges(ring).map(|[a, b]| a.distance(b)).sum()
}
