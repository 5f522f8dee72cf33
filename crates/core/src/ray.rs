//! The ray caster: which triangles a line meets, in `f64`, to prove the shadows of the rest of this crate right.
//!
//! ```text
//!     origin *-------- t = 1 -------- t = 2 ---------->     shear and turn space so that the ray runs along z;
//!                         /|                                 then it meets a triangle just where the origin of
//!                        / |                                 the xy plane lies in the triangle's projection
//!                       /__|
//! ```
//!
//! Sources: S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013; J. R. Shewchuk,
//! "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997 (exact sums). It shares no
//! code and no idea with silhouettes, chains and volumes, as it is what they are checked against.
//!
//! # Why no ray slips through a closed mesh
//!
//! Projecting a corner rounds: the difference of its `f32` and the origin's `f64`, two products of 53-bit numbers,
//! and their difference. But the result depends on the corner and the ray alone, so all triangles around a corner see
//! it projected to the same point: the mesh is moved by some 2^-52 of its distance, and never torn. After that no
//! rounding matters. A triangle is hit if no two of its three edge functions `a.x b.y - a.y b.x` have opposite signs,
//! and the signs are exact:
//!
//! - if the two products round to different numbers, those differ as the exact products do, as rounding is monotone;
//! - if they round to the same, what rounding cost them decides, which a fused multiply-add gives exactly.
//!
//! So a triangle is hit just when its moved, closed projection holds the origin and is not flat. A ray that leaves a
//! closed surface has, as near as one likes, rays that meet no edge; each leaves through some triangle that is not
//! flat; and as there are only so many triangles, one of those holds the origin too. Taking equal products for 0, as
//! the paper does after its last precision, is not enough: all three edge functions of a sliver can round to 0, and
//! it would be lost as flat.
//!
//! We depart from the paper in three things. The shear multiplies where the paper divides, so that a corner aimed at
//! exactly (its difference from the origin is the direction) is projected to exactly (0, 0), and even a ray at an
//! outline hits. A triangle seen nearly edge-on, whose weights are all rounding, still gets a parameter within its
//! own box. And winding does not matter, as both sides count.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::bvh::{Piece, Planes, Slabs, Tree};

/// One crossing of a ray with a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Where on the ray, in units of its direction: the point is `origin + t * direction`.
    pub t: f64,
    /// Index of the part (usually a caster), in the order given to [`RayCaster::new`].
    pub part: u32,
    /// Index of the triangle within its part.
    pub triangle: u32,
}

/// Triangles made ready to be met by rays.
///
/// Both sides of a triangle count. A ray exactly through an edge or a corner hits every triangle there that is not
/// seen edge-on, so none slips through a closed mesh. A triangle without area (its corners are exactly on one line,
/// or not finite) is never hit, so a mesh that is closed only by such triangles can leak along them, in gaps as wide
/// as rounding.
///
/// A direction need not have unit length; parameters and limits count in its lengths, and may be negative or
/// infinite. A ray with an origin that is not finite, or a direction that is zero or not finite, hits nothing; nor
/// does one with a number beyond 1e60 or a direction shorter than 1e-60.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use umbrae_core::RayCaster;
///
/// let floor = [Vec3::ZERO, Vec3::X, Vec3::ONE.with_z(0.0), Vec3::Y];
/// let caster = RayCaster::new([(&floor[..], &[[0, 1, 2], [0, 2, 3]][..])]);
///
/// let down = DVec3::new(0.0, 0.0, -2.0);
/// let hit = caster.first_hit(DVec3::new(0.75, 0.25, 3.0), down, 0.0, f64::INFINITY).expect("the floor is below");
/// assert_eq!((hit.t, hit.part, hit.triangle), (1.5, 0, 0));
/// assert!(!caster.is_hit(DVec3::new(1.75, 0.25, 3.0), down, 0.0, f64::INFINITY));
/// ```
#[derive(Debug, Clone)]
pub struct RayCaster {
    tree: Tree,
    /// In the order of the tree.
    corners: Vec<[[f32; 3]; 3]>,
    /// For each of `corners`, its number among all triangles of all parts.
    numbers: Vec<u32>,
    /// For each number, its index in `corners`, or [`NOWHERE`].
    places: Vec<u32>,
    /// The number of each part's first triangle.
    part_starts: Vec<u32>,
}

/// The place of a triangle that can't be hit.
const NOWHERE: u32 = u32::MAX;

impl RayCaster {
    /// Takes for each part its positions (scene space, metres) and its triangles, three indices into the positions
    /// each.
    ///
    /// A city of 180,000 triangles takes about 0.1 s; the time is that of sorting, on all threads of rayon's pool.
    ///
    /// # Panics
    ///
    /// If an index is out of range, or there are 2^32 - 1 triangles or more.
    pub fn new<'a>(parts: impl IntoIterator<Item = (&'a [Vec3], &'a [[u32; 3]])>) -> Self {
        let parts: Vec<_> = parts.into_iter().collect();
        let mut part_starts = Vec::with_capacity(parts.len());
        let mut count = 0_usize;
        for (_, triangles) in &parts {
            part_starts.push(count as u32);
            count += triangles.len();
            assert!(count < NOWHERE as usize, "{count} triangles are too many; cast against fewer at a time");
        }
        let corners_of = |part: usize, triangle: usize| {
            let (positions, triangles) = parts[part];
            triangles[triangle].map(|i| positions[i as usize].to_array())
        };
        let mut pieces: Vec<Piece> = (0..parts.len())
            .into_par_iter()
            .flat_map(|part| (0..parts[part].1.len()).into_par_iter().map(move |triangle| (part, triangle)))
            .filter_map(|(part, triangle)| {
                let corners = corners_of(part, triangle);
                has_area(&corners).then(|| Piece::new(&corners, part_starts[part] + triangle as u32))
            })
            .collect();
        let tree = Tree::new(&mut pieces);
        let mut places = vec![NOWHERE; count];
        for (place, piece) in pieces.iter().enumerate() {
            places[piece.id as usize] = place as u32;
        }
        let corners = pieces
            .par_iter()
            .map(|piece| {
                let part = part_of(&part_starts, piece.id);
                corners_of(part, (piece.id - part_starts[part]) as usize)
            })
            .collect();
        Self { tree, corners, numbers: pieces.iter().map(|p| p.id).collect(), places, part_starts }
    }

    /// The nearest hit with `t_min <= t <= t_max`; of several at the same `t`, that of the lowest part, then triangle.
    pub fn first_hit(&self, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> Option<Hit> {
        self.nearest(origin, direction, t_min, t_max, |_, _| true)
    }

    /// As [`RayCaster::first_hit`], through every hit that `stops` does not stop at.
    ///
    /// `stops` is asked about some of the hits in the way, in no particular order, and must answer the same each time.
    pub fn first_hit_where(
        &self,
        origin: DVec3,
        direction: DVec3,
        t_min: f64,
        t_max: f64,
        mut stops: impl FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        self.nearest(origin, direction, t_min, t_max, |t, number| stops(&self.hit(t, number)))
    }

    fn nearest(
        &self,
        origin: DVec3,
        direction: DVec3,
        t_min: f64,
        t_max: f64,
        mut stops: impl FnMut(f64, u32) -> bool,
    ) -> Option<Hit> {
        let mut first: Option<(f64, u32)> = None;
        // Never breaks off.
        let _ = self.search(origin, direction, t_min, t_max, |t, number, limit| {
            let is_nearer =
                first.is_none_or(|(first_t, first_number)| t < first_t || (t == first_t && number < first_number));
            if is_nearer && stops(t, number) {
                first = Some((t, number));
                return ControlFlow::Continue(limit.min(t));
            }
            ControlFlow::Continue(limit)
        });
        first.map(|(t, number)| self.hit(t, number))
    }

    /// Some hit with `t_min <= t <= t_max` for which `is_wanted`, if there is one: on the triangle of `guess`, if that
    /// is one, else whichever is found first.
    ///
    /// Faster than [`RayCaster::first_hit`], as any hit will do, and much faster where the guess is right.
    ///
    /// # Panics
    ///
    /// If the guess is no hit of this caster.
    pub fn any_hit_where(
        &self,
        origin: DVec3,
        direction: DVec3,
        t_min: f64,
        t_max: f64,
        guess: Option<&Hit>,
        mut is_wanted: impl FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        let on_guess = guess.and_then(|guess| self.hit_on(guess, origin, direction));
        let mut found = on_guess.filter(|hit| t_min <= hit.t && hit.t <= t_max && is_wanted(hit));
        if found.is_none() {
            // Breaks off only where something is found.
            let _ = self.search(origin, direction, t_min, t_max, |t, number, limit| {
                found = Some(self.hit(t, number)).filter(&mut is_wanted);
                if found.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(limit) }
            });
        }
        found
    }

    /// Where a ray meets the triangle of `other`, which some ray hit, whatever else is in the way; `None` where it
    /// misses. Looks at that triangle only, and agrees to the last bit with the searches.
    ///
    /// # Panics
    ///
    /// As [`RayCaster::corners`].
    pub fn hit_on(&self, other: &Hit, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let place = self.place(other);
        let t = Ray::new(origin, direction)?.meets(&self.corners[place])?;
        Some(Hit { t, ..*other })
    }

    /// Whether anything is hit with `t_min < t < t_max`.
    ///
    /// Faster than [`RayCaster::first_hit`], as any hit will do.
    pub fn is_hit(&self, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> bool {
        self.search(origin, direction, t_min, t_max, |t, _, limit| {
            if t_min < t && t < t_max { ControlFlow::Break(()) } else { ControlFlow::Continue(limit) }
        })
        .is_break()
    }

    /// Calls `visit` with every hit with `t_min <= t <= t_max`, in no particular order.
    ///
    /// To count how often a ray enters or leaves a solid, choose one that meets no edge: one through an edge hits
    /// the triangles on both sides of it, one through a corner all triangles around it.
    pub fn for_each_hit(&self, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64, mut visit: impl FnMut(Hit)) {
        // Never breaks off.
        let _ = self.search(origin, direction, t_min, t_max, |t, number, limit| {
            visit(self.hit(t, number));
            ControlFlow::Continue(limit)
        });
    }

    /// Corner positions of a triangle that was hit, scene space, in the order of its indices.
    ///
    /// # Panics
    ///
    /// If this caster has no such triangle, or one that can't be hit.
    pub fn corners(&self, hit: &Hit) -> [DVec3; 3] {
        self.corners[self.place(hit)].map(|c| Vec3::from_array(c).as_dvec3())
    }

    /// Where in `corners` the triangle is.
    fn place(&self, hit: &Hit) -> usize {
        self.places[(self.part_starts[hit.part as usize] + hit.triangle) as usize] as usize
    }

    /// A normal of a triangle that was hit, out of the side from which its corners go round counter-clockwise; its
    /// length is twice the triangle's area.
    ///
    /// # Panics
    ///
    /// As [`RayCaster::corners`].
    pub fn normal(&self, hit: &Hit) -> DVec3 {
        let [a, b, c] = self.corners(hit);
        (b - a).cross(c - a)
    }

    /// How many triangles can be hit: those given, less those that have no area.
    pub fn triangle_count(&self) -> usize {
        self.corners.len()
    }

    /// Calls `visit` with the parameter and number of each hit with `t_min <= t <= t_max`, and the current `t_max`;
    /// it gives back what `t_max` is from then on, or breaks off.
    #[inline]
    fn search(
        &self,
        origin: DVec3,
        direction: DVec3,
        t_min: f64,
        t_max: f64,
        mut visit: impl FnMut(f64, u32, f64) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let Some(ray) = Ray::new(origin, direction) else { return ControlFlow::Continue(()) };
        self.tree.visit(&ray.slabs, t_min, t_max, |places, mut t_max| {
            for (corners, &number) in self.corners[places.clone()].iter().zip(&self.numbers[places]) {
                if let Some(t) = ray.meets(corners)
                    && t_min <= t
                    && t <= t_max
                {
                    t_max = visit(t, number, t_max)?;
                }
            }
            ControlFlow::Continue(t_max)
        })
    }

    fn hit(&self, t: f64, number: u32) -> Hit {
        let part = part_of(&self.part_starts, number);
        Hit { t, part: part as u32, triangle: number - self.part_starts[part] }
    }
}

/// The part that holds the triangle of this number.
fn part_of(part_starts: &[u32], number: u32) -> usize {
    // Parts without triangles start where the next one does; the last of those is the one that has it.
    part_starts.partition_point(|&start| start <= number) - 1
}

/// Larger coordinates and directions can overflow in a product of five, directions shorter than its inverse underflow.
const LARGEST: f64 = 1.606_938_044_258_990_3e60; // 2^200
/// Smaller components of a direction count as 0, so that those that don't have a finite inverse; this turns the ray by
/// less than 1e-90.
const SMALLEST: f64 = 3.054_936_363_499_605e-151; // 2^-500

/// A ray made ready to meet many triangles. Axis 2 is the one along which its direction is longest.
struct Ray {
    slabs: Slabs,
    /// Which axis of space each axis is.
    axes: [usize; 3],
    origin: [f64; 3],
    direction: [f64; 3],
}

impl Ray {
    /// `None` for a ray that hits nothing because it isn't one.
    fn new(origin: DVec3, direction: DVec3) -> Option<Self> {
        let length = direction.abs().max_element();
        let is_usable = origin.is_finite()
            && direction.is_finite()
            && origin.abs().max_element() <= LARGEST
            && (LARGEST.recip()..=LARGEST).contains(&length);
        if !is_usable {
            return None;
        }
        let longest = direction.abs().max_position();
        let axes = [(longest + 1) % 3, (longest + 2) % 3, longest];
        let origin = axes.map(|axis| origin[axis]);
        let direction = axes.map(|axis| if direction[axis].abs() < SMALLEST { 0.0 } else { direction[axis] });
        Some(Self { slabs: Slabs::new(axes, origin, direction), axes, origin, direction })
    }

    /// Where the line meets the triangle, in units of the direction.
    #[inline]
    fn meets(&self, corners: &[[f32; 3]; 3]) -> Option<f64> {
        let [dx, dy, dz] = self.direction;
        let mut projected = [[0.0; 2]; 3];
        let mut along = [0.0; 3];
        for i in 0..3 {
            let at = |k: usize| f64::from(corners[i][self.axes[k]]) - self.origin[k];
            let (x, y, z) = (at(0), at(1), at(2));
            projected[i] = [x * dz - z * dx, y * dz - z * dy];
            along[i] = z;
        }
        let [u, v, w] = weights_at_origin(projected)?;
        let t = (u * along[0] + v * along[1] + w * along[2]) / ((u + v + w) * dz);
        // Only a triangle seen nearly edge-on needs this, and the tree relies on it.
        let ([near], [far]) = self.slabs.interval(&planes(corners));
        Some(t.max(near).min(far))
    }
}

/// How much each corner of a triangle counts at the origin, none with another sign than another; `None` if the
/// origin is outside or the triangle flat, which is decided exactly.
#[inline]
fn weights_at_origin([a, b, c]: [[f64; 2]; 3]) -> Option<[f64; 3]> {
    let mut weights = [edge(b, c), edge(c, a), edge(a, b)];
    if have_opposite_signs(weights) {
        return None;
    }
    if weights.contains(&0.0) {
        weights = [exact_edge(b, c), exact_edge(c, a), exact_edge(a, b)];
        if have_opposite_signs(weights) || weights == [0.0; 3] {
            return None;
        }
    }
    Some(weights)
}

/// Twice the signed area of the triangle (0, a, b): its sign is exact unless it is 0.
#[inline]
fn edge(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The same, with a sign that is exact (as long as the products are above 1e-290, where their errors underflow).
#[cold]
fn exact_edge(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (p, q) = (a[0] * b[1], a[1] * b[0]);
    if p != q { p - q } else { a[0].mul_add(b[1], -p) - a[1].mul_add(b[0], -q) }
}

#[inline]
fn have_opposite_signs([u, v, w]: [f64; 3]) -> bool {
    (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)
}

/// The box of a triangle.
fn planes([a, b, c]: &[[f32; 3]; 3]) -> Planes<1> {
    std::array::from_fn(|plane| {
        if plane < 3 {
            [a[plane].min(b[plane]).min(c[plane])]
        } else {
            [a[plane - 3].max(b[plane - 3]).max(c[plane - 3])]
        }
    })
}

/// Whether the corners are finite and not on one line, decided exactly.
fn has_area(corners: &[[f32; 3]; 3]) -> bool {
    corners.iter().flatten().all(|x| x.is_finite())
        && [(0, 1), (1, 2), (2, 0)].into_iter().any(|(x, y)| !is_flat(corners.map(|c| [c[x], c[y]])))
}

/// Whether three points of the plane are on one line.
fn is_flat(points: [[f32; 2]; 3]) -> bool {
    let [a, b, c] = points.map(|p| p.map(f64::from));
    let (p, q) = ((b[0] - a[0]) * (c[1] - a[1]), (b[1] - a[1]) * (c[0] - a[0]));
    // Three roundings make each product, and one their difference: 2 epsilons of |p| + |q|.
    if (p - q).abs() > 4.0 * f64::EPSILON * (p.abs() + q.abs()) {
        return false;
    }
    // Products of two f32 have 48 bits: they are exact. Adding them one by one to a sum kept in parts that don't
    // overlap is exact too, and such a sum is 0 only if all its parts are.
    let mut parts = [0.0; 6];
    let terms = [b[0] * c[1], -b[1] * c[0], c[0] * a[1], -c[1] * a[0], a[0] * b[1], -a[1] * b[0]];
    for (count, mut sum) in terms.into_iter().enumerate() {
        for part in &mut parts[..count] {
            (sum, *part) = sum_and_error(sum, *part);
        }
        parts[count] = sum;
    }
    parts == [0.0; 6]
}

/// `a + b` rounded, and what rounding lost, exactly (D. E. Knuth's two-sum).
fn sum_and_error(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

#[cfg(test)]
mod tests;
