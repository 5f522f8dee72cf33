//! What of a light and its casters can change a pixel, told from boxes alone.
//!
//! ```text
//!        * light                 A caster shades something in view exactly where it meets the hull of
//!        |\  \                   light and view: then, and only then, it is between the light and
//!        | \    \                something in view.
//!        |  \      \
//!        |   \  view  \          What may be seen of its volume is the volume of its box.
//!    eye <----------------
//! ```
//!
//! Every answer is on the safe side: in doubt a thing may matter.
//!
//! Sources: M. McGuire et al. 2003, sections 6 and 7 (light bounds, scissor region); C. Wallner 2007, section 5.

use glam::{DVec3, DVec4};

use crate::case::{slack_m, view_region};
use crate::few::Few;
use crate::screen::Screen;
use crate::{Bounds, Camera, ConvexRegion, Light, LightPosition, PixelRect, Reach};

/// Directions are widened by this cosine: `f32` rounding of a point at infinity turns it by less.
const TURN: f64 = 1e-6;
/// Planes through the light and an edge are found where these are not closer to one line than this sine.
const EDGE_ON: f64 = 1e-6;
/// A direction counts as in a plane that passes through it to rounding.
const PARALLEL: f64 = 1e-9;

/// Tells what can't matter for one camera and one light. Making it is cheap; each question takes less than a microsecond, but for
/// [`Culler::shadow_rect`] with a few.
#[derive(Debug, Clone)]
pub struct Culler {
    light: LightPosition,
    slack: f64,
    reach: Option<Reach>,
    view: ConvexRegion,
    /// Hull of the view and the light.
    shading: ConvexRegion,
    /// The view's sides through the origin, for points at infinity.
    view_directions: ConvexRegion,
    /// The directions through the corners of the picture.
    corner_directions: [DVec3; 4],
    screen: Screen,
    light_rect: Option<PixelRect>,
}

impl Culler {
    /// For casters in the same space as `camera` and `light`, which all lie in `scene`.
    pub fn new(camera: &Camera, light: &Light, scene: &Bounds) -> Self {
        let slack = slack_m(camera, light.position, scene);
        let screen = Screen::new(camera);
        let reach = Reach::widened(light, slack);
        let light_rect = match &reach {
            None => screen.whole(),
            Some(reach) => {
                screen.rect_of(reach.faces().iter().map(<[DVec4; 3]>::as_slice), |p| reach.region().contains(p))
            }
        };
        let view = view_region(camera, slack);
        let mut view_directions = ConvexRegion::default();
        for plane in view.planes() {
            view_directions.add(DVec3::ZERO, plane.truncate(), TURN);
        }
        Self {
            light: light.position,
            slack,
            shading: shading_region(camera, light.position, &view, slack),
            reach,
            view,
            view_directions,
            corner_directions: camera.near_rectangle().map(|corner| (corner - camera.eye()).normalize_or_zero()),
            screen,
            light_rect,
        }
    }

    /// Whether anything that the light reaches may be in view.
    pub fn light_may_show(&self) -> bool {
        self.light_rect.is_some()
    }

    /// Whether the light may reach the box. A caster that it does not reach shades nothing that it reaches.
    pub fn is_reached(&self, caster: &Bounds) -> bool {
        self.reach.as_ref().is_none_or(|reach| reach.may_meet_box(caster))
    }

    /// Whether anything in view, however far, may be behind the box as the light sees it.
    pub fn may_shade_view(&self, caster: &Bounds) -> bool {
        self.shading.may_meet_box(caster)
    }

    /// Whether anything in the box may be in view.
    pub fn light_cap_may_show(&self, caster: &Bounds) -> bool {
        self.view.may_meet_box(caster)
    }

    /// Whether a point at infinity behind the box may be in view; a directional light has no dark cap.
    pub fn dark_cap_may_show(&self, caster: &Bounds) -> bool {
        if self.light.is_directional() || caster.is_empty() {
            return false;
        }
        let light = self.light.homogeneous().truncate();
        let about_light = Bounds { min: caster.min - light, max: caster.max - light };
        let is_beside = |plane: &DVec4| {
            let n = plane.truncate();
            let farthest = DVec3::select(n.cmpgt(DVec3::ZERO), about_light.max, about_light.min);
            n.dot(farthest) < -self.slack - TURN * farthest.length()
        };
        if self.view_directions.planes().iter().any(is_beside) {
            return false;
        }
        let Some(swept) = Swept::new(&widened(caster, self.slack), self.light) else { return true };
        swept.sides.iter().all(|side| {
            // Through the light and an edge, with the box on the inner side.
            let [a, b] = [side[0], side[1]].map(|p| p.truncate() - light);
            let outwards = a.cross(b).normalize_or_zero();
            self.corner_directions.iter().any(|corner| outwards.dot(*corner) <= TURN)
        })
    }

    /// The pixels where something that the light reaches may show; `None` when there are none.
    pub fn light_rect(&self) -> Option<PixelRect> {
        self.light_rect
    }

    /// The pixels where something of the box, or of what is behind it as the light sees it, may show, however far the light reaches; `None`
    /// when there are none.
    pub fn shadow_rect(&self, caster: &Bounds) -> Option<PixelRect> {
        if caster.is_empty() {
            return None;
        }
        let caster = widened(caster, self.slack);
        // Around the light, the box sweeps everything.
        let Some(swept) = Swept::new(&caster, self.light) else { return self.screen.whole() };
        let caps = swept.caps.iter().map(<[DVec4; 4]>::as_slice);
        let sides = swept.sides.iter().map(<[DVec4; 4]>::as_slice);
        self.screen.rect_of(caps.chain(sides), |point| is_behind(&caster, self.light, point))
    }
}

impl Culler {
    /// As [`Culler::shadow_rect`], where nothing that matters is outside of `scene`, which holds the caster: a shadow ends where it leaves that.
    pub fn shadow_rect_within(&self, caster: &Bounds, scene: &Bounds) -> Option<PixelRect> {
        let end = widened(&shadow_within(caster, self.light, scene), self.slack);
        let corners = end.corners().map(|corner| corner.extend(1.0));
        let faces = FACES.map(|face| face.map(|i| corners[i]));
        let holds = |point: DVec4| {
            let point = if point.w == 0.0 { return false } else { point.truncate() / point.w };
            point.clamp(end.min, end.max) == point
        };
        let of_end = self.screen.rect_of(faces.iter().map(<[DVec4; 4]>::as_slice), holds)?;
        self.shadow_rect(caster)?.intersection(&of_end)
    }
}

/// A box around what is in `scene` of the caster and behind it as the light sees it.
///
/// All points of the caster move away from the light at once, each by `t` times its offset from it (or by `t` along a directional light), until they have
/// left the scene on the side of some axis.
fn shadow_within(caster: &Bounds, light: LightPosition, scene: &Bounds) -> Bounds {
    let (at_min, at_max) = (-light.offset_from(caster.min), -light.offset_from(caster.max));
    let mut t = f64::INFINITY;
    for axis in 0..3 {
        if at_min[axis] > 0.0 {
            t = t.min((scene.max[axis] - caster.min[axis]).max(0.0) / at_min[axis]);
        } else if at_max[axis] < 0.0 {
            t = t.min((caster.max[axis] - scene.min[axis]).max(0.0) / -at_max[axis]);
        }
    }
    if !t.is_finite() {
        return *scene;
    }
    let end = Bounds { min: caster.min.min(caster.min + at_min * t), max: caster.max.max(caster.max + at_max * t) };
    Bounds { min: end.min.max(scene.min), max: end.max.min(scene.max) }
}

fn widened(bounds: &Bounds, by: f64) -> Bounds {
    Bounds { min: bounds.min - DVec3::splat(by), max: bounds.max + DVec3::splat(by) }
}

/// The hull of the view and the light.
///
/// Each plane of the view with the light on its inner side is one of it, and so is each plane through the light and an edge of the view
/// (of the near rectangle, of the sides, or of a side's end at infinity) that has all of the view on one side. Which those are is found by
/// trying them all; one too few leaves the region too large.
fn shading_region(camera: &Camera, light: LightPosition, view: &ConvexRegion, slack: f64) -> ConvexRegion {
    let l = light.homogeneous();
    let near = camera.near_rectangle();
    let rays = near.map(|corner| (corner - camera.eye()).normalize_or_zero());
    let mut region = ConvexRegion::default();
    for plane in view.planes() {
        // With the light just outside of it, the plane is moved out to hold the light.
        let height = plane.dot(l) / l.truncate().length().max(1.0);
        if plane.dot(l) >= -slack || (light.is_directional() && height >= -PARALLEL) {
            let n = plane.truncate();
            region.add(-n * plane.w, n, slack);
        }
    }
    // A point of the plane, and two directions along it.
    let mut candidates: Few<(DVec3, DVec3, DVec3), 12> = Few::default();
    for i in 0..4 {
        let next = (i + 1) % 4;
        candidates.push((near[i], near[next] - near[i], light.offset_from(near[i])));
        candidates.push((near[i], rays[i], light.offset_from(near[i])));
        if !light.is_directional() {
            candidates.push((l.truncate(), rays[i], rays[next]));
        }
    }
    for &(point, along, across) in candidates.iter() {
        let (along, across) = (along.normalize_or_zero(), across.normalize_or_zero());
        let normal = along.cross(across);
        if normal.length() < EDGE_ON {
            continue;
        }
        let normal = normal.normalize_or_zero();
        let heights = near.map(|corner| normal.dot(corner - point));
        let slopes = rays.map(|ray| normal.dot(ray));
        let is_above = heights.iter().all(|&h| h >= -slack) && slopes.iter().all(|&s| s >= -PARALLEL);
        let is_below = heights.iter().all(|&h| h <= slack) && slopes.iter().all(|&s| s <= PARALLEL);
        if is_above {
            region.add(point, normal, 2.0 * slack);
        } else if is_below {
            region.add(point, -normal, 2.0 * slack);
        }
    }
    region
}

/// A box swept away from the light to infinity, as flat faces.
struct Swept {
    /// The sides of the box that face the light, and the same at infinity.
    caps: Few<[DVec4; 4], 6>,
    /// From an edge of those to infinity; the edge comes first, as the lit side walks it.
    sides: Few<[DVec4; 4], 6>,
}

/// The corners of a box around each of its faces, counter-clockwise seen from outside: -x, +x, -y, +y, -z, +z.
const FACES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

impl Swept {
    /// `None` when the light is in the box.
    fn new(bounds: &Bounds, light: LightPosition) -> Option<Self> {
        let corners = bounds.corners();
        let below = light.offset_from(bounds.min);
        let above = light.offset_from(bounds.max);
        let is_lit: [bool; 6] = std::array::from_fn(|face| {
            let axis = face / 2;
            if face % 2 == 0 { below[axis] < 0.0 } else { above[axis] > 0.0 }
        });
        if !is_lit.contains(&true) {
            return None;
        }
        let near = corners.map(|corner| corner.extend(1.0));
        let far = corners.map(|corner| -light.offset_from(corner).extend(0.0));
        let edges_of = |face: usize| (0..4).map(move |i| (FACES[face][i], FACES[face][(i + 1) % 4]));
        let (mut caps, mut sides) = (Few::default(), Few::default());
        for face in (0..6).filter(|&face| is_lit[face]) {
            caps.push(FACES[face].map(|i| near[i]));
            caps.push(FACES[face].map(|i| far[i]));
            for (a, b) in edges_of(face) {
                let is_inner = (0..6).any(|other| is_lit[other] && edges_of(other).any(|edge| edge == (b, a)));
                if !is_inner {
                    sides.push([near[a], near[b], far[b], far[a]]);
                }
            }
        }
        Some(Self { caps, sides })
    }
}

/// Whether the homogeneous point is in the box or behind it: the way from it to the light meets the box.
fn is_behind(bounds: &Bounds, light: LightPosition, point: DVec4) -> bool {
    // From the light away, so that points at infinity have a way too; a directional light has none but from the point.
    let (start, step, end) = if point.w == 0.0 {
        if light.is_directional() {
            return false;
        }
        (light.homogeneous().truncate(), point.truncate(), f64::INFINITY)
    } else {
        let end = if light.is_directional() { f64::INFINITY } else { 1.0 };
        (point.truncate(), light.offset_from(point.truncate()), end)
    };
    let (mut from, mut to) = (0.0_f64, end);
    for axis in 0..3 {
        let [enter, leave] = [bounds.min[axis] - start[axis], bounds.max[axis] - start[axis]];
        if step[axis] == 0.0 {
            if enter > 0.0 || leave < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (enter / step[axis], leave / step[axis]);
        from = from.max(a.min(b));
        to = to.min(a.max(b));
    }
    from <= to
}
