//! What a picture should show, by casting rays: the judge of everything that is drawn.
//!
//! For each pixel and light: is there a surface, and does the light reach it? A pixel is *decided* when five rays, through
//! its centre and a quarter of a pixel around it, agree, and no surface they meet is edge-on to the light. Where the
//! centre lies on an edge as far as a rasteriser can tell, the surfaces on both sides must besides be neighbours and turn the same
//! side to the light: otherwise the edge itself is an outline or casts, and what a rasteriser makes of a point on it is not
//! determined (a hair of a hidden surface may show, or the volume that hangs on the edge may come out in front). About one
//! pixel in a thousand is left out for that reason. Nothing here knows of silhouettes or volumes.

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
    /// The verdict on which all five rays agree; `None` leaves the pixel undecided.
    pub verdict: Option<Verdict>,
}

/// A surface whose normal is within this of a right angle to the light (as a cosine) is edge-on: the `f32` in which
/// drawing decides which side is turned to the light is good to about 1e-6.
const EDGE_ON: f64 = 1e-4;

/// A ray towards a light starts this far from its surface, relative to the size of the scene: beyond the rounding of
/// the point, which is 1e-15 of it and up to 1e4 times that along a ray that leaves at the angle of [`EDGE_ON`]; well within what `f32` positions
/// resolve.
const LIFT: f64 = 1e-9;

/// How far, relative to the size of the scene, a lamp may be from a surface and yet come out on its other side: a few roundings of `f32`
/// (2^-24 each).
const BLUR: f64 = 4e-7;

/// Where the centre ray and its four neighbours pass, in pixels from the centre.
const OFFSETS: [[f64; 2]; 5] = [[0.0, 0.0], [-0.25, 0.0], [0.25, 0.0], [0.0, -0.25], [0.0, 0.25]];

/// Rasterisers snap vertices to a grid, of 1/256 pixel on every device that we know (Vulkan asks for 1/16): nearer than this, in pixels, the
/// centre may be on either side of an edge.
const RASTER_PX: f64 = 1.0 / 256.0;

/// Depths that differ by more than this, relative to themselves, within [`RASTER_PX`] belong to two surfaces, or to one seen so
/// edge-on that it may as well be two.
const DEPTH_STEP: f64 = 1e-3;

/// Casts the rays of pictures of one scene.
#[derive(Debug)]
pub struct Oracle {
    rays: RayCaster,
    lift: f64,
    blur: f64,
}

impl Oracle {
    /// Builds the ray caster over `casters`.
    pub fn new(casters: &[Caster]) -> Self {
        let rays = RayCaster::new(casters.iter().map(|c| (c.positions.as_slice(), c.mesh.triangles())));
        let bounds = casters.iter().fold(crate::Bounds::EMPTY, |all, c| all.union(c.bounds));
        let scale = if bounds.is_empty() { 0.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        Self { rays, lift: LIFT * scale, blur: BLUR * scale }
    }

    /// The ray caster.
    pub fn rays(&self) -> &RayCaster {
        &self.rays
    }

    /// For each light the judgement of each pixel, row by row from the top; `row_done` is called after each row.
    ///
    /// Lights are taken as given: round them first ([`LightPosition::rounded_to_f32`]) where drawing did. All cores
    /// work; five rays a pixel and up to five more for each light.
    pub fn judge(
        &self,
        camera: &Camera,
        lights: &[LightPosition],
        row_done: impl Fn() + Sync,
    ) -> Vec<Vec<Judgement>> {
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
            let at_edge = self.around_edge(camera, x, y, hits[0].as_ref());
            for (row, &light) in row.iter_mut().zip(lights) {
                let verdict = self.agreed(&hits, light).filter(|_| self.is_unbroken(at_edge.as_ref(), light));
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

    /// What is seen [`RASTER_PX`] around `(x, y)`; `None` where that is one triangle, or nothing, all around.
    fn around_edge(&self, camera: &Camera, x: f64, y: f64, center: Option<&Seen>) -> Option<[Option<Seen>; 4]> {
        let around = [[-RASTER_PX, 0.0], [RASTER_PX, 0.0], [0.0, -RASTER_PX], [0.0, RASTER_PX]];
        let around = around.map(|offset| self.seen(camera, x, y, offset));
        let is_same = |seen: &Option<Seen>| seen.map(|s| s.triangle()) == center.map(Seen::triangle);
        (!around.iter().all(is_same)).then_some(around)
    }

    /// Whether neighbours with the same verdict, which turn the same side to the light, meet at an edge (if there is one).
    fn is_unbroken(&self, at_edge: Option<&[Option<Seen>; 4]>, light: LightPosition) -> bool {
        let Some(around) = at_edge else { return true };
        let [Some(first), Some(_), Some(_), Some(_)] = around else { return false };
        let verdict = self.verdict(Some(first), light);
        let is_turned_to_light = |seen: &Seen| seen.normal.dot(light.from_point(seen.point)) > 0.0;
        verdict.is_some()
            && around.iter().flatten().all(|other| {
                self.are_neighbours(first, other)
                    && is_turned_to_light(first) == is_turned_to_light(other)
                    && self.verdict(Some(other), light) == verdict
            })
    }

    /// Whether two triangles share an edge (or are one) and are seen at one depth: in a fan, all share an edge that may be
    /// elsewhere.
    fn are_neighbours(&self, a: &Seen, b: &Seen) -> bool {
        if (a.hit.t - b.hit.t).abs() > DEPTH_STEP * a.hit.t {
            return false;
        }
        let (of_a, of_b) = (self.rays.corners(&a.hit), self.rays.corners(&b.hit));
        of_a.iter().filter(|corner| of_b.contains(corner)).count() >= 2
    }

    fn agreed(&self, hits: &[Option<Seen>; 5], light: LightPosition) -> Option<Verdict> {
        let first = self.verdict(hits[0].as_ref(), light)?;
        hits[1..].iter().all(|hit| self.verdict(hit.as_ref(), light) == Some(first)).then_some(first)
    }

    /// `None` where the surface is edge-on.
    fn verdict(&self, seen: Option<&Seen>, light: LightPosition) -> Option<Verdict> {
        let Some(seen) = seen else { return Some(Verdict::NoSurface) };
        let to_light = light.from_point(seen.point);
        let distance = to_light.length();
        let cosine = seen.normal.dot(to_light) / distance;
        // A light on the surface itself leaves no cosine.
        if !(cosine.abs() > EDGE_ON) {
            return None;
        }
        if cosine < 0.0 {
            return Some(Verdict::Dark);
        }
        let start = self.lift / distance;
        if light.is_directional() {
            let is_dark = self.rays.is_hit(seen.point, to_light, start, f64::INFINITY);
            return Some(if is_dark { Verdict::Dark } else { Verdict::Lit });
        }
        // A lamp that lies in a surface as far as `f32` can tell is on neither side of it.
        let before_lamp = (1.0 - self.blur / distance).max(start);
        if self.rays.is_hit(seen.point, to_light, start, before_lamp) {
            return Some(Verdict::Dark);
        }
        let is_lamp_in_surface = self.rays.is_hit(seen.point, to_light, before_lamp, 1.0 + self.blur / distance);
        (!is_lamp_in_surface).then_some(Verdict::Lit)
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
