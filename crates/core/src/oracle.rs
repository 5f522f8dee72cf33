//! What a picture should show, by casting rays: the judge of everything that is drawn.
//!
//! For each pixel and light: is there a surface, and does the light reach it? A pixel is *decided* when five rays,
//! through its centre and a quarter of a pixel around it, agree, and no surface they meet is edge-on to the light.
//!
//! Some things no picture can settle, and leave a pixel undecided as well. Where the centre is on an edge as far as a
//! rasteriser can tell, a hair of a hidden surface may show, or the volume that hangs on the edge come out in front of
//! it: five rays may see one lit surface on each side, and the drawn pixel is dark; the same holds for a hair of shadow
//! that begins there. Where surfaces are as near to one another as depths are rounded, any of them may be drawn, and the
//! edges of all of them count. Where only a triangle is in the way whose plane holds the light as far as `f32` can tell, it is
//! not between them but beside them. Where a surface is cut out, its holes have borders, and so have a light's range
//! and cone. A surface that is shaded as if it were curved (see [`Caster::shading_normals`]) ends to be lit where its shading says. Nothing here knows of silhouettes or volumes.

mod border;
mod coincident;
mod cut_out;
mod smooth;
mod soft;
mod spheres;

pub use soft::SeenLight;

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use self::border::reaches;
use self::cut_out::{CutOuts, Presence};
use self::smooth::{Shading, SmoothParts};
use self::spheres::SeenSphere;
use crate::{Camera, Caster, Hit, Light, LightPosition, Material, RayCaster, Sphere, Texture};

/// What one ray says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing is seen.
    NoSurface,
    /// The light reaches the surface on the side that is seen.
    Lit,
    /// Something is between, the seen side is turned away, or the light ends before it.
    Dark,
}

/// What the rays of one pixel say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Judgement {
    /// Whether the ray through the centre meets a surface, or what may be one.
    pub has_surface: bool,
    /// The verdict on which all rays of the pixel agree; `None` leaves it undecided.
    pub verdict: Option<Verdict>,
}

/// A surface whose normal is within this of a right angle to the light (as a cosine, 0.11 degrees) is edge-on. The
/// volume of a neighbour that shades it lies on it at no greater angle, and a quarter of a pixel is about 1/4000 of the
/// distance: nearer than that the two depths differ by less than 5e-7 of themselves, a few roundings of `f32`.
const EDGE_ON: f64 = 2e-3;

/// A ray towards a light starts this far from its surface, relative to the size of the scene: beyond the rounding of
/// the point, which is 1e-15 of it and up to 500 times that along a ray that leaves at the angle of [`EDGE_ON`]; well
/// within what `f32` positions resolve.
const LIFT: f64 = 1e-9;

/// How far from a plane, relative to the coordinates' size (of a directional light: as a cosine), a light may be and
/// yet come out on the plane's other side: a few roundings of `f32` (2^-24 each).
const BLUR: f64 = 4e-7;

/// Rasterisers snap vertices to a grid, of 1/256 pixel on every device that we know (Vulkan asks for 1/16): nearer than
/// this, in pixels, the centre may be on either side of an edge.
const RASTER_PX: f64 = 1.0 / 256.0;

/// Where the rays around the centre pass, in pixels from it: four as near as [`RASTER_PX`], four a quarter of a pixel
/// away.
const OFFSETS: [[f64; 2]; 8] = [
    [-RASTER_PX, 0.0],
    [RASTER_PX, 0.0],
    [0.0, -RASTER_PX],
    [0.0, RASTER_PX],
    [-0.25, 0.0],
    [0.25, 0.0],
    [0.0, -0.25],
    [0.0, 0.25],
];

/// A point's place, or anything else that a device interpolates between corners, is good to this, relative to the
/// corners' and times how much nearer the triangle comes than the point: the quotients by depth that are interpolated
/// are as large as at its nearest corner, and take some roundings (2^-24 each).
const INTERPOLATION: f64 = 4e-7;

/// Casts the rays of pictures of one scene.
///
/// What is glass hides nothing, and what does not cast shades nothing.
#[derive(Debug)]
pub struct Oracle {
    seen: RayCaster,
    /// What casts; `None` where that is just what is seen.
    casting: Option<RayCaster>,
    cut_outs: Option<CutOuts>,
    smooth: Option<SmoothParts>,
    /// Seen and casting, rounded as they are drawn.
    spheres: Vec<Sphere>,
    /// The largest coordinate.
    scale: f64,
    lift: f64,
}

impl Oracle {
    /// Builds the ray caster over `casters`, without a hole in any surface.
    pub fn new(casters: &[Caster]) -> Self {
        Self::with_materials(casters, &[], &[])
    }

    /// As [`Oracle::new`], for casters of `materials`, some of which may have holes: one sees through them, but their
    /// surface casts as if it had none.
    ///
    /// Where something is seen and casts not, or casts and is not seen, there are two ray casters, of about 100 bytes a
    /// triangle each; else one.
    ///
    /// # Panics
    ///
    /// If a material names a texture that is not there.
    pub fn with_materials(casters: &[Caster], materials: &[Material], textures: &[Arc<Texture>]) -> Self {
        // Each caster is the part of its own index, whether it takes part or not.
        let rays_of = |takes_part: fn(&Caster) -> bool| {
            let triangles = |caster| if takes_part(caster) { caster.mesh.triangles() } else { &[] };
            RayCaster::new(casters.iter().map(|caster| (caster.positions.as_slice(), triangles(caster))))
        };
        let is_seen = |caster: &Caster| !caster.role.is_glass;
        let casts = |caster: &Caster| caster.role.casts;
        let is_one = casters.iter().all(|caster| is_seen(caster) == casts(caster));
        let bounds = Caster::bounds_of(casters);
        let scale = if bounds.is_empty() { 0.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        Self {
            seen: rays_of(is_seen),
            casting: (!is_one).then(|| rays_of(casts)),
            cut_outs: CutOuts::new(casters, materials, textures),
            smooth: SmoothParts::new(casters),
            spheres: Vec::new(),
            scale,
            lift: LIFT * scale,
        }
    }

    /// The ray caster over what casts; parts are casters.
    pub fn casting(&self) -> &RayCaster {
        self.casting.as_ref().unwrap_or(&self.seen)
    }

    /// For each light the judgement of each pixel, row by row from the top; `row_done` is called after each row.
    ///
    /// Lights are those that are drawn: rounded ([`Light::rounded_to_f32`]). All cores work; up to nine rays a pixel
    /// and up to nine more for each light.
    pub fn judge(&self, camera: &Camera, lights: &[Light], row_done: impl Fn() + Sync) -> Vec<Vec<Judgement>> {
        let lights: Vec<Light> = lights.iter().map(Light::rounded_to_f32).collect();
        let eye = Eye::new(camera);
        let [width, height] = camera.size_px();
        let rows: Vec<Vec<Vec<Judgement>>> = (0..height)
            .into_par_iter()
            .map(|y| {
                let row = self.judge_row(&eye, &lights, y, width);
                row_done();
                row
            })
            .collect();
        (0..lights.len()).map(|l| rows.iter().flat_map(|row| row[l].iter().copied()).collect()).collect()
    }

    fn judge_row(&self, eye: &Eye, lights: &[Light], y: u32, width: u32) -> Vec<Vec<Judgement>> {
        let mut row = vec![Vec::with_capacity(width as usize); lights.len()];
        // For each light what shaded the point before: it is likely to shade the next one too.
        let mut in_the_way: Vec<Option<Hit>> = vec![None; lights.len()];
        for x in 0..width {
            let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let center = self.sight(eye, [x, y], None);
            let sights = self.sights_around(eye, [x, y], &center);
            let has_surface = !matches!(center, Sight::Nothing);
            for ((row, light), in_the_way) in row.iter_mut().zip(lights).zip(&mut in_the_way) {
                let verdict = sights.as_ref().and_then(|sights| self.agreed(eye, sights, light, in_the_way));
                row.push(Judgement { has_surface, verdict });
            }
        }
        row
    }

    /// What the nine rays of the pixel about `(x, y)` see, and what else may be drawn at its centre; `None` where that
    /// settles that it is undecided, because the five nearest to the centre don't see the same surfaces and the same one first (or nothing), or
    /// some ray can't tell a surface from a hole in it.
    fn sights_around(&self, eye: &Eye, [x, y]: [f64; 2], center: &Sight) -> Option<Vec<Sight>> {
        if matches!(center, Sight::Unsure) {
            return None;
        }
        let others = center.seen().map(|seen| self.coincident(eye, eye.direction(x, y), seen)).unwrap_or_default();
        let mut sights = Vec::with_capacity(1 + OFFSETS.len() + others.len());
        sights.push(*center);
        for (i, [dx, dy]) in OFFSETS.into_iter().enumerate() {
            let [x, y] = [x + dx, y + dy];
            let sight = self.sight(eye, [x, y], Some(center));
            let is_off_center = i < 4 && sight.surface() != center.surface();
            if is_off_center || matches!(sight, Sight::Unsure) {
                return None;
            }
            let is_near = |_: &&Seen| i < 4;
            if let Some(seen) = sight.seen().filter(is_near)
                && !self.are_coincident(eye, eye.direction(x, y), seen, &others)
            {
                return None;
            }
            sights.push(sight);
        }
        sights.extend(others);
        Some(sights)
    }

    /// What the ray at `(x, y)` in pixels meets first. It is likely to be the triangle that `neighbour` met.
    fn sight(&self, eye: &Eye, [x, y]: [f64; 2], neighbour: Option<&Sight>) -> Sight {
        let direction = eye.direction(x, y);
        self.or_nearer_sphere(eye, direction, self.sight_of_triangles(eye, direction, neighbour))
    }

    fn sight_of_triangles(&self, eye: &Eye, direction: DVec3, neighbour: Option<&Sight>) -> Sight {
        let presence = |hit: &Hit| self.presence(eye, direction, hit);
        let stops = |hit: &Hit| presence(hit) != Presence::Hole;
        // The near plane cuts by view depth, which is what the parameter of this ray measures.
        let near = eye.near;
        let guess =
            neighbour.and_then(Sight::seen).and_then(|seen| self.seen.hit_on(&seen.hit, eye.position, direction));
        let far = guess.filter(|hit| hit.t >= near && stops(hit)).map_or(f64::INFINITY, |hit| hit.t);
        let hit = if self.cut_outs.is_some() {
            self.seen.first_hit_where(eye.position, direction, near, far, stops)
        } else {
            self.seen.first_hit(eye.position, direction, near, far)
        };
        let Some(hit) = hit else { return Sight::Nothing };
        if presence(&hit) == Presence::Unsure {
            return Sight::Unsure;
        }
        self.sight_of(eye, direction, hit)
    }

    fn sight_of(&self, eye: &Eye, direction: DVec3, hit: Hit) -> Sight {
        let Some(normal) = self.seen.normal(&hit).try_normalize() else { return Sight::Nothing };
        let is_turned = normal.dot(direction) >= 0.0;
        let normal = if is_turned { -normal } else { normal };
        let point = eye.position + direction * hit.t;
        let shading = self.smooth.as_ref().and_then(|smooth| {
            smooth.shading(&hit, self.seen.corners(&hit), [eye.position, point], is_turned, self.blur(eye, &hit))
        });
        Sight::Surface(Seen { hit, point, normal, shading })
    }

    fn presence(&self, eye: &Eye, direction: DVec3, hit: &Hit) -> Presence {
        let Some(cut_outs) = &self.cut_outs else { return Presence::Surface };
        let point = eye.position + direction * hit.t;
        cut_outs.presence(hit, self.seen.corners(hit), point, || self.blur(eye, hit))
    }

    /// How much of what is interpolated between the corners of a triangle may be lost where it is hit, relative to the
    /// corners.
    fn blur(&self, eye: &Eye, hit: &Hit) -> f64 {
        let depths = self.seen.corners(hit).map(|corner| eye.forward.dot(corner - eye.position));
        let nearest = depths.into_iter().fold(f64::INFINITY, f64::min).max(eye.near);
        INTERPOLATION * (hit.t / nearest).max(1.0)
    }

    fn agreed(&self, eye: &Eye, sights: &[Sight], light: &Light, in_the_way: &mut Option<Hit>) -> Option<Verdict> {
        let mut verdicts = sights.iter().map(|sight| self.verdict(eye, sight, light, in_the_way));
        let first = verdicts.next()??;
        verdicts.all(|verdict| verdict == Some(first)).then_some(first)
    }

    /// `None` where the surface is edge-on, or on the light's border, or what is in the way is beside it; dark for
    /// another reason is dark all the same.
    fn verdict(&self, eye: &Eye, sight: &Sight, light: &Light, in_the_way: &mut Option<Hit>) -> Option<Verdict> {
        if let Sight::Sphere(seen) = sight {
            return self.verdict_on_sphere(seen, light, in_the_way);
        }
        let Some(seen) = sight.seen() else { return Some(Verdict::NoSurface) };
        let to_light = light.position.offset_from(seen.point);
        let is_reached = if light.cone.is_none() && light.range_m.is_none() {
            Some(true)
        } else {
            let corners = self.seen.corners(&seen.hit);
            let reach = corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
            reaches(light, to_light, reach * self.blur(eye, &seen.hit))
        };
        if is_reached == Some(false) {
            return Some(Verdict::Dark);
        }
        let faces_light =
            seen.shading.map_or_else(|| faces(seen.normal, to_light), |shading| shading.faces(seen, light.position));
        if !faces_light? {
            return Some(Verdict::Dark);
        }
        let is_shaded = self.spheres.iter().any(|sphere| sphere.shades(seen.point, light.position))
            || self.is_shaded_by_triangles(seen.point, light.position, in_the_way)?;
        if is_shaded { Some(Verdict::Dark) } else { is_reached.map(|_| Verdict::Lit) }
    }

    /// Whether a triangle between `point` and the light casts, and leaves in `in_the_way` which; `None` where all that
    /// are there hold the light in their planes.
    fn is_shaded_by_triangles(&self, point: DVec3, light: LightPosition, in_the_way: &mut Option<Hit>) -> Option<bool> {
        let casting = self.casting();
        let to_light = light.offset_from(point);
        let (start, end) = (self.lift / to_light.length(), if light.is_directional() { f64::INFINITY } else { 1.0 });
        let mut is_beside = false;
        *in_the_way = casting.any_hit_where(point, to_light, start, end, in_the_way.as_ref(), |hit| {
            let holds_light = self.holds_light(hit, light);
            is_beside |= holds_light;
            !holds_light
        });
        if in_the_way.is_some() { Some(true) } else { (!is_beside).then_some(false) }
    }

    /// Whether the light is in the plane of the triangle that was hit, as far as `f32` can tell.
    fn holds_light(&self, hit: &Hit, light: LightPosition) -> bool {
        let casting = self.casting();
        let normal = casting.normal(hit);
        let to_light = light.offset_from(casting.corners(hit)[0]);
        let blur = if light.is_directional() {
            BLUR
        } else {
            BLUR * self.scale.max(light.homogeneous().truncate().abs().max_element())
        };
        normal.dot(to_light).abs() <= blur * normal.length()
    }
}

/// Whether a surface with the unit `normal` is turned to the light; `None` where it is edge-on.
fn faces(normal: DVec3, to_light: DVec3) -> Option<bool> {
    let cosine = normal.dot(to_light) / to_light.length();
    // A light on the surface itself leaves no cosine, but what is not a number: that is edge-on, too.
    (cosine.abs() > EDGE_ON).then_some(cosine > 0.0)
}

/// A camera made ready for many rays.
#[derive(Debug)]
struct Eye {
    position: DVec3,
    near: f64,
    forward: DVec3,
    /// Through the top left corner of the picture; how that changes from one pixel to the next across and down.
    first: DVec3,
    across: DVec3,
    down: DVec3,
}

impl Eye {
    fn new(camera: &Camera) -> Self {
        let first = camera.ray_direction(0.0, 0.0);
        let [width, height] = camera.size_px().map(f64::from);
        Self {
            position: camera.eye(),
            near: camera.near(),
            forward: camera.axes()[2],
            first,
            across: (camera.ray_direction(width, 0.0) - first) / width,
            down: (camera.ray_direction(0.0, height) - first) / height,
        }
    }

    /// [`Camera::ray_direction`], but for rounding.
    fn direction(&self, x: f64, y: f64) -> DVec3 {
        self.first + self.across * x + self.down * y
    }
}

/// What one ray from the eye meets first.
#[derive(Debug, Clone, Copy)]
enum Sight {
    Nothing,
    Surface(Seen),
    Sphere(SeenSphere),
    /// What may be a surface or a hole in it.
    Unsure,
}

/// A visible point and the unit normal of its triangle on its visible side.
#[derive(Debug, Clone, Copy)]
struct Seen {
    hit: Hit,
    point: DVec3,
    normal: DVec3,
    /// `None` where that is the normal that it is shaded with.
    shading: Option<Shading>,
}

impl Sight {
    fn seen(&self) -> Option<&Seen> {
        if let Self::Surface(seen) = self { Some(seen) } else { None }
    }

    /// Part and triangle, or no part and the sphere.
    fn surface(&self) -> Option<(Option<u32>, u32)> {
        match self {
            Self::Nothing | Self::Unsure => None,
            Self::Surface(seen) => Some((Some(seen.hit.part), seen.hit.triangle)),
            Self::Sphere(seen) => Some((None, seen.sphere)),
        }
    }
}

#[cfg(test)]
mod tests;
