//! Which faces of a volume must be drawn, and against which side of the depth buffer they count.
//!
//! ```text
//!           * light           The pyramid from the light to the near rectangle holds what can
//!          / \                shade the near rectangle. A caster outside it leaves every point
//!         /   \               of the near rectangle lit, so counting may start there: z-pass.
//!        /     \
//!   ____/__near_\____         Near plane and picture meet in the near rectangle.
//! ```
//!
//! Source: M. McGuire et al. 2003, section 6 and figure 4. We test the caster's own triangles where their bounds
//! do not settle it, so that a hall around the eye is z-pass wherever nothing of it is between light and eye.

use glam::DVec3;

use crate::eye_count::NearPlace;
use crate::{Bounds, Camera, Caster, Chain, ConvexRegion, LightPosition, ShadowVolume};

/// McGuire's three cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Case {
    /// 1, z-pass: nothing of the near rectangle is in shadow; sides only.
    Pass,
    /// 2, z-fail with the light cap out of view: sides and dark cap.
    FailWithoutLightCap,
    /// 3, z-fail with everything: sides, dark cap, light cap.
    Fail,
}

impl Case {
    /// The number that McGuire gives it.
    pub fn number(self) -> u32 {
        match self {
            Self::Pass => 1,
            Self::FailWithoutLightCap => 2,
            Self::Fail => 3,
        }
    }
}

/// Tells the case of each caster for one camera and one light.
#[derive(Debug, Clone)]
pub struct CaseChooser {
    view: ConvexRegion,
    near_pyramid: ConvexRegion,
    near_place: NearPlace,
    slack_m: f64,
}

/// Regions are widened by this much of the coordinates' size: the GPU works in `f32` (2^-24 a rounding, and a few of them),
/// and z-fail, to which doubt leads, is always right.
const SLACK: f64 = 4e-6;

/// The distance, in metres, by which regions are widened for a camera and a light among casters that lie in `scene`.
pub(crate) fn slack_m(camera: &Camera, light: LightPosition, scene: &Bounds) -> f64 {
    let l = light.homogeneous();
    let reach = |p: DVec3| p.abs().max_element();
    let of_scene = if scene.is_empty() { 0.0 } else { reach(scene.min).max(reach(scene.max)) };
    SLACK * reach(camera.eye()).max(reach(l.truncate() * l.w)).max(of_scene)
}

impl CaseChooser {
    /// For a camera and a light in the same space as the casters, which all lie in `scene`.
    pub fn new(camera: &Camera, light: LightPosition, scene: &Bounds) -> Self {
        let slack = slack_m(camera, light, scene);
        Self {
            view: view_region(camera, slack),
            near_pyramid: near_pyramid(camera, light, slack),
            near_place: NearPlace::new(camera, light, slack),
            slack_m: slack,
        }
    }

    /// The case of `caster`. Cheap where bounds decide; else linear in its triangles.
    pub fn case(&self, caster: &Caster) -> Case {
        if !self.may_shade_near_rectangle(caster) {
            Case::Pass
        } else if self.view.may_meet_box(&caster.bounds) {
            Case::Fail
        } else {
            Case::FailWithoutLightCap
        }
    }

    /// The case of anything that casts from within `bounds`; never a lower one than its triangles would have.
    pub fn case_of_bounds(&self, bounds: &Bounds) -> Case {
        if !self.near_pyramid.may_meet_box(bounds) {
            Case::Pass
        } else if self.view.may_meet_box(bounds) {
            Case::Fail
        } else {
            Case::FailWithoutLightCap
        }
    }

    /// The hull of the light and the near rectangle, widened for the rounding of `f32`: only what meets it can shade the near rectangle.
    pub fn near_pyramid(&self) -> &ConvexRegion {
        &self.near_pyramid
    }

    /// By how much, in metres, regions are widened.
    pub fn slack_m(&self) -> f64 {
        self.slack_m
    }

    /// The case when z-fail is asked for: 2 or 3.
    pub fn case_without_zpass(&self, caster: &Caster) -> Case {
        if self.view.may_meet_box(&caster.bounds) { Case::Fail } else { Case::FailWithoutLightCap }
    }

    /// How many of the volumes of `caster` over `chain` hold the near rectangle: what the stencil has to start from for z-pass to be right.
    ///
    /// `None` where that may not be one number: a side of the volume or the caster itself crosses the rectangle, or comes close enough
    /// for rounding to tell. Cheap where bounds decide; else linear in the volume's faces.
    pub fn eye_count(&self, caster: &Caster, chain: &Chain, volume: &ShadowVolume) -> Option<u32> {
        if !self.near_pyramid.may_meet_box(&caster.bounds) {
            return Some(0);
        }
        self.near_place.count(caster, chain, volume, &self.near_pyramid)
    }

    fn may_shade_near_rectangle(&self, caster: &Caster) -> bool {
        self.near_pyramid.may_meet_box(&caster.bounds)
            && (0..caster.mesh.triangles().len())
                .any(|t| self.near_pyramid.meets_triangle(caster.corners(t).map(glam::Vec3::as_dvec3)))
    }
}

/// What the camera sees: beyond the near plane and within the four sides.
pub(crate) fn view_region(camera: &Camera, slack: f64) -> ConvexRegion {
    let eye = camera.eye();
    let [_, _, forward] = camera.axes();
    let rectangle = camera.near_rectangle();
    let middle = eye + forward * camera.near();
    let mut region = ConvexRegion::default();
    region.add(middle, forward, slack);
    for i in 0..4 {
        let normal = (rectangle[i] - eye).cross(rectangle[(i + 1) % 4] - eye);
        region.add(eye, facing(normal, middle - eye), slack);
    }
    region
}

/// The hull of the light and the near rectangle.
fn near_pyramid(camera: &Camera, light: LightPosition, slack: f64) -> ConvexRegion {
    let [_, _, forward] = camera.axes();
    let rectangle = camera.near_rectangle();
    let middle = camera.eye() + forward * camera.near();
    let mut region = ConvexRegion::default();
    let to_light = light.offset_from(middle);
    let height = forward.dot(to_light);
    if height.abs() <= slack.max(SLACK * to_light.length()) {
        // The light is in the near plane, and so is the pyramid: it is flat, and its outline is made of sides of the rectangle and of
        // lines from its corners to the light.
        region.add(middle, forward, slack);
        region.add(middle, -forward, slack);
        for i in 0..4 {
            let (a, b) = (rectangle[i], rectangle[(i + 1) % 4]);
            let inwards = facing(forward.cross(b - a), middle - a);
            if inwards.dot(light.offset_from(a)) >= 0.0 {
                region.add(a, inwards, slack);
            }
            let beside = forward.cross(light.offset_from(a)).normalize_or_zero();
            for normal in [beside, -beside] {
                if rectangle.iter().all(|&corner| normal.dot(corner - a) >= -slack) {
                    region.add(a, normal, 2.0 * slack);
                }
            }
        }
        return region;
    }
    region.add(middle, forward * height.signum(), slack);
    for i in 0..4 {
        let (a, b) = (rectangle[i], rectangle[(i + 1) % 4]);
        let normal = (b - a).cross(light.offset_from(a));
        region.add(a, facing(normal, middle - a), slack);
    }
    region
}

fn facing(normal: DVec3, inwards: DVec3) -> DVec3 {
    if normal.dot(inwards) < 0.0 { -normal } else { normal }
}
