//! Axis-aligned boxes.

use glam::DVec3;

/// An axis-aligned box, possibly empty.
///
/// ```
/// use glam::DVec3;
/// use umbrae_core::Bounds;
///
/// let b = Bounds::of_points([DVec3::ZERO, DVec3::new(2.0, 4.0, 4.0)]);
/// assert_eq!(b.center(), DVec3::new(1.0, 2.0, 2.0));
/// assert_eq!(b.radius(), 3.0);
/// assert!(Bounds::EMPTY.is_empty());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The smallest coordinate on each axis.
    pub min: DVec3,
    /// The largest coordinate on each axis.
    pub max: DVec3,
}

impl Bounds {
    /// The box that holds nothing: neutral under [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box that holds `points`.
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// This box, grown to hold `point`.
    pub fn including(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box that holds both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box holds no point at all.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether the two closed boxes have a point in common.
    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// The middle; not a number for an empty box.
    pub fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// The edge lengths.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The radius of the sphere through the corners; 0 for a single point.
    pub fn radius(&self) -> f64 {
        0.5 * self.size().length()
    }

    /// The eight corners, x varying fastest.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }
}
