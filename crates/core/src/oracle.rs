//! What a picture should show, by casting rays: the judge of everything that is drawn.
//!
//! For each pixel and light: is there a surface, and does the light reach it? A pixel is *decided* when five rays, through
//! its centre and a quarter of a pixel around it, agree, and no surface they meet is edge-on to the light.
//!
//! Two things no picture can settle, and leave a pixel undecided as well. Where the centre is on an edge as far as a rasteriser can tell, a
//! hair of a hidden surface may show, or the volume that hangs on the edge come out in front of it: five rays may see one lit
//! surface on each side, and the drawn pixel is dark; the same holds for a hair of shadow that begins there. And where only a triangle is in the way whose plane holds the light as far as `f32`
//! can tell, it is not between them but beside them. Nothing here knows of silhouettes or volumes.

use glam::DVec3;
use rayon::prelude::*;

use crate::{Camera, Caster, Hit, LightPosition, RayCaster};

/// What one ray says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing is seen.
    NoSurface,
    /// The light reaches the surface on the side that is seen.
    Lit,
    /// Something is between, or the seen side is turned away.
    Dark,
}

/// What the rays of one pixel say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Judgement {
    /// Whether the ray through the centre meets a surface.
    pub has_surface: bool,
    /// The verdict on which all rays of the pixel agree; `None` leaves it undecided.
    pub verdict: Option<Verdict>,
}

/// A surface whose normal is within this of a right angle to the light (as a cosine, 0.11 degrees) is edge-on. The volume of a
/// neighbour that shades it lies on it at no greater angle, and a quarter of a pixel is about 1/4000 of the distance: nearer than that the two
/// depths differ by less than 5e-7 of themselves, a few roundings of `f32`.
const EDGE_ON: f64 = 2e-3;

/// A ray towards a light starts this far from its surface, relative to the size of the scene: beyond the rounding of
/// the point, which is 1e-15 of it and up to 500 times that along a ray that leaves at the angle of [`EDGE_ON`]; well within what `f32` positions
/// resolve.
const LIFT: f64 = 1e-9;

/// How far from a plane, relative to the coordinates' size (of a directional light: as a cosine), a light may be and yet come out on the plane's other
/// side: a few roundings of `f32` (2^-24 each).
const BLUR: f64 = 4e-7;

/// Where the centre ray and its four neighbours pass, in pixels from the centre.
const OFFSETS: [[f64; 2]; 5] = [[0.0, 0.0], [-0.25, 0.0], [0.25, 0.0], [0.0, -0.25], [0.0, 0.25]];

/// Rasterisers snap vertices to a grid, of 1/256 pixel on every device that we know (Vulkan asks for 1/16): nearer than this, in pixels, the
/// centre may be on either side of an edge.
const RASTER_PX: f64 = 1.0 / 256.0;

/// Casts the rays of pictures of one scene.
#[derive(Debug)]
pub struct Oracle {
    rays: RayCaster,
    /// The largest coordinate.
    scale: f64,
    lift: f64,
}

impl Oracle {
    /// Builds the ray caster over `casters`.
    pub fn new(casters: &[Caster]) -> Self {
        let rays = RayCaster::new(casters.iter().map(|c| (c.positions.as_slice(), c.mesh.triangles())));
        let bounds = Caster::bounds_of(casters);
        let scale = if bounds.is_empty() { 0.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        Self { rays, scale, lift: LIFT * scale }
    }

    /// The ray caster.
    pub fn rays(&self) -> &RayCaster {
        &self.rays
    }

    /// For each light the judgement of each pixel, row by row from the top; `row_done` is called after each row.
    ///
    /// Lights are taken as given: round them first ([`LightPosition::rounded_to_f32`]) where drawing did. All cores
    /// work; nine rays a pixel and up to nine more for each light.
    pub fn judge(&self, camera: &Camera, lights: &[LightPosition], row_done: impl Fn() + Sync) -> Vec<Vec<Judgement>> {
        let [width, height] = camera.size_px();
        let rows: Vec<Vec<Vec<Judgement>>> = (0..height)
            .into_par_iter()
            .map(|y| {
                let row = self.judge_row(camera, lights, y, width);
                row_done();
                row
            })
            .collect();
        (0..lights.len()).map(|l| rows.iter().flat_map(|row| row[l].iter().copied()).collect()).collect()
    }

    fn judge_row(&self, camera: &Camera, lights: &[LightPosition], y: u32, width: u32) -> Vec<Vec<Judgement>> {
        let mut row = vec![Vec::with_capacity(width as usize); lights.len()];
        for x in 0..width {
            let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let hits = OFFSETS.map(|offset| self.seen(camera, x, y, offset));
            let nearby = self.seen_nearby(camera, x, y, hits[0].as_ref());
            for (row, &light) in row.iter_mut().zip(lights) {
                let verdict = nearby.and_then(|nearby| self.agreed(hits.iter().chain(&nearby), light));
                row.push(Judgement { has_surface: hits[0].is_some(), verdict });
            }
        }
        row
    }

    /// The nearest surface on the ray at `(x, y) + offset` in pixels.
    fn seen(&self, camera: &Camera, x: f64, y: f64, [dx, dy]: [f64; 2]) -> Option<Seen> {
        let direction = camera.ray_direction(x + dx, y + dy);
        // The near plane cuts by view depth, which is what the parameter of this ray measures.
        let hit = self.rays.first_hit(camera.eye(), direction, camera.near(), f64::INFINITY)?;
        let normal = self.rays.normal(&hit).try_normalize()?;
        Some(Seen {
            hit,
            point: camera.eye() + direction * hit.t,
            normal: if normal.dot(direction) < 0.0 { normal } else { -normal },
        })
    }

    /// What is seen [`RASTER_PX`] around the centre; `None` where that is not one triangle (or nothing) all round.
    fn seen_nearby(&self, camera: &Camera, x: f64, y: f64, center: Option<&Seen>) -> Option<[Option<Seen>; 4]> {
        let around = [[-RASTER_PX, 0.0], [RASTER_PX, 0.0], [0.0, -RASTER_PX], [0.0, RASTER_PX]];
        let nearby = around.map(|offset| self.seen(camera, x, y, offset));
        let is_center = |seen: &Option<Seen>| seen.as_ref().map(Seen::triangle) == center.map(Seen::triangle);
        nearby.iter().all(is_center).then_some(nearby)
    }

    fn agreed<'a>(&self, seen: impl Iterator<Item = &'a Option<Seen>>, light: LightPosition) -> Option<Verdict> {
        let mut verdicts = seen.map(|seen| self.verdict(seen.as_ref(), light));
        let first = verdicts.next()??;
        verdicts.all(|verdict| verdict == Some(first)).then_some(first)
    }

    /// `None` where the surface is edge-on.
    fn verdict(&self, seen: Option<&Seen>, light: LightPosition) -> Option<Verdict> {
        let Some(seen) = seen else { return Some(Verdict::NoSurface) };
        let to_light = light.offset_from(seen.point);
        let distance = to_light.length();
        let cosine = seen.normal.dot(to_light) / distance;
        // A light on the surface itself leaves no cosine, which is not a number.
        if cosine.is_nan() || cosine.abs() <= EDGE_ON {
            return None;
        }
        if cosine < 0.0 {
            return Some(Verdict::Dark);
        }
        let (start, end) = (self.lift / distance, if light.is_directional() { f64::INFINITY } else { 1.0 });
        let Some(nearest) = self.rays.first_hit(seen.point, to_light, start, end) else { return Some(Verdict::Lit) };
        let mut is_dark = !self.holds_light(&nearest, light);
        if !is_dark {
            self.rays.for_each_hit(seen.point, to_light, start, end, |hit| is_dark |= !self.holds_light(&hit, light));
        }
        is_dark.then_some(Verdict::Dark)
    }

    /// Whether the light is in the plane of the triangle that was hit, as far as `f32` can tell.
    fn holds_light(&self, hit: &Hit, light: LightPosition) -> bool {
        let normal = self.rays.normal(hit);
        let to_light = light.offset_from(self.rays.corners(hit)[0]);
        let blur = if light.is_directional() {
            BLUR
        } else {
            BLUR * self.scale.max(light.homogeneous().truncate().abs().max_element())
        };
        normal.dot(to_light).abs() <= blur * normal.length()
    }
}

/// A visible point and the unit normal on its visible side.
#[derive(Debug, Clone, Copy)]
struct Seen {
    hit: Hit,
    point: DVec3,
    normal: DVec3,
}

impl Seen {
    fn triangle(&self) -> (u32, u32) {
        (self.hit.part, self.hit.triangle)
    }
}
