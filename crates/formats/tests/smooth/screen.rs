//! A screen behind a body, across the light, and the shadow on it, pixel by pixel.

use glam::{DVec2, DVec3, Vec3};
use umbrae_core::LightPosition;

use super::subject::Subject;

/// The screen is so many radii behind the body's middle.
const BEHIND: f64 = 1.2;
/// And so much larger than the shadow, on each side.
const MARGIN: f64 = 0.04;

/// Where a shadow falls.
pub(crate) struct Screen {
    light: LightPosition,
    origin: DVec3,
    axes: [DVec3; 2],
    /// Towards the light.
    normal: DVec3,
    corner: DVec2,
    pixel_m: f64,
    size_px: [usize; 2],
}

/// Which pixels are dark, row by row.
pub(crate) struct Mask {
    pub(crate) width: usize,
    pub(crate) dark: Vec<bool>,
}

impl Screen {
    /// As large as the shadow of the curved surface, `longest_px` on its longer side.
    pub(crate) fn behind(subject: &Subject, light: LightPosition, longest_px: usize) -> Self {
        let normal = light.offset_from(subject.bounds.center()).normalize_or_zero();
        let (u, v) = normal.any_orthonormal_pair();
        let origin = subject.bounds.center() - normal * (BEHIND * subject.radius_m);
        let mut screen =
            Self { light, origin, axes: [u, v], normal, corner: DVec2::ZERO, pixel_m: 1.0, size_px: [0, 0] };
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for point in subject.finest_points() {
            let place = screen.place(point);
            (min, max) = (min.min(place), max.max(place));
        }
        let margin = MARGIN * (max - min).max_element();
        let size = max - min + 2.0 * margin;
        screen.corner = min - margin;
        screen.pixel_m = size.max_element() / longest_px as f64;
        screen.size_px = [size.x, size.y].map(|length| (length / screen.pixel_m).ceil() as usize);
        screen
    }

    /// Where the shadow of `point` is, along the axes.
    fn place(&self, point: DVec3) -> DVec2 {
        let away = -self.light.offset_from(point);
        let offset = point + away * ((self.origin - point).dot(self.normal) / away.dot(self.normal)) - self.origin;
        DVec2::new(offset.dot(self.axes[0]), offset.dot(self.axes[1]))
    }

    /// The same in pixels, whose centres are at whole numbers.
    pub(crate) fn pixel(&self, point: DVec3) -> DVec2 {
        (self.place(point) - self.corner) / self.pixel_m - 0.5
    }

    /// Half of the longer side of the shadow, in pixels.
    pub(crate) fn half_shadow_px(&self) -> f64 {
        let longest = self.size_px[0].max(self.size_px[1]) as f64;
        0.5 * longest / (1.0 + 2.0 * MARGIN)
    }

    /// Dark where a ray to the light meets the curved surface.
    pub(crate) fn of_rays(&self, subject: &Subject) -> Mask {
        let [width, height] = self.size_px;
        let is_dark = |i: usize| subject.is_blocked(self.middle_of(i), self.light);
        Mask { width, dark: (0..width * height).map(is_dark).collect() }
    }

    /// The middle of pixel `i`.
    pub(crate) fn middle_of(&self, i: usize) -> DVec3 {
        let width = self.size_px[0];
        let place = self.corner + (DVec2::new((i % width) as f64, (i / width) as f64) + 0.5) * self.pixel_m;
        self.origin + self.axes[0] * place.x + self.axes[1] * place.y
    }

    /// Adds to `mask` what `sides` wind around: all of the volume is before the screen, so that is its count.
    pub(crate) fn add_sides(&self, positions: &[Vec3], sides: &[[u32; 2]], mask: &mut Mask) {
        let place = |v: u32| self.pixel(positions[v as usize].as_dvec3());
        let mut crossings: Vec<Vec<(f64, i32)>> = vec![Vec::new(); self.size_px[1]];
        for side in sides {
            let [a, b] = side.map(place);
            let [from, to] = [a.y.min(b.y), a.y.max(b.y)].map(|y| y.ceil().max(0.0) as usize);
            for (row, crossings) in crossings.iter_mut().enumerate().take(to).skip(from) {
                let x = a.x + (b.x - a.x) * ((row as f64 - a.y) / (b.y - a.y));
                crossings.push((x, if a.y < b.y { 1 } else { -1 }));
            }
        }
        for (row, crossings) in mask.dark.chunks_exact_mut(self.size_px[0]).zip(&mut crossings) {
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut winding = 0;
            for pair in crossings.windows(2) {
                winding += pair[0].1;
                let [from, to] = [pair[0].0, pair[1].0].map(|x| (x.ceil().max(0.0) as usize).min(row.len()));
                if winding != 0 && from < to {
                    row[from..to].fill(true);
                }
            }
        }
    }

    pub(crate) fn lit(&self) -> Mask {
        Mask { width: self.size_px[0], dark: vec![false; self.size_px[0] * self.size_px[1]] }
    }
}

/// A pixel that is otherwise in the reference.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Difference {
    pub(crate) pixel: usize,
    /// To the reference's boundary: the nearest pixel of it that is as this one, less that pixel.
    pub(crate) to_boundary_px: f64,
}

impl Mask {
    /// The pixels that are otherwise in `reference`.
    pub(crate) fn differences(&self, reference: &Mask) -> Vec<Difference> {
        let differing = (0..self.dark.len()).filter(|&i| self.dark[i] != reference.dark[i]);
        let difference =
            |i: usize| Difference { pixel: i, to_boundary_px: reference.distance_px(i, self.dark[i]) - 1.0 };
        differing.map(difference).collect()
    }

    /// From pixel `i` to the nearest that is `dark` or is not.
    fn distance_px(&self, i: usize, dark: bool) -> f64 {
        let (x, y) = ((i % self.width) as i64, (i / self.width) as i64);
        let (width, height) = (self.width as i64, (self.dark.len() / self.width) as i64);
        let mut nearest = i64::MAX;
        for ring in 1..width.max(height) {
            if ring * ring >= nearest {
                break;
            }
            for step in -ring..=ring {
                for (dx, dy) in [(step, -ring), (step, ring), (-ring, step), (ring, step)] {
                    let (at_x, at_y) = (x + dx, y + dy);
                    let is_inside = (0..width).contains(&at_x) && (0..height).contains(&at_y);
                    if is_inside && self.dark[(at_y * width + at_x) as usize] == dark {
                        nearest = nearest.min(dx * dx + dy * dy);
                    }
                }
            }
        }
        if nearest == i64::MAX { f64::INFINITY } else { (nearest as f64).sqrt() }
    }
}
