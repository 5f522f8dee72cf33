//! Where surfaces that are shaded as if they were curved turn away from a light.
//!
//! The light ends where it is as high as the tangent planes of the corners, its heights over which are interpolated, on whichever side of the triangle's
//! own plane. Where these face the light and the triangle does not, a body of flat triangles would shade itself, and a volume that follows the curved surface leaves it lit:
//! that is decided by how volumes are made, and not by rays.

use glam::{DVec3, Vec3};

use super::cut_out::weights_at;
use super::{EDGE_ON, Seen, faces};
use crate::{Caster, Hit, LightPosition};

/// The casters that have normals to be shaded with.
#[derive(Debug)]
pub(super) struct SmoothParts(Vec<Option<SmoothPart>>);

#[derive(Debug)]
struct SmoothPart {
    /// For each triangle; `None` where it is flat.
    normals: Vec<Option<[Vec3; 3]>>,
    casts: bool,
}

/// How a point is shaded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shading {
    /// The mean of the corners' normals, not of unit length, on the seen side as the triangle's own normal is.
    normal: DVec3,
    /// The mean of the corners' heights along their own normals, on the same side.
    height: f64,
    /// How much of what is interpolated may be lost, relative to the corners'.
    blur: f64,
    eye_distance: f64,
    /// Whether the triangle itself casts.
    casts: bool,
}

impl SmoothParts {
    /// `None` where all is flat.
    pub(super) fn new(casters: &[Caster]) -> Option<Self> {
        let part = |caster: &Caster| {
            (!caster.shading_normals.is_empty()).then(|| SmoothPart {
                normals: (0..caster.mesh.triangles().len()).map(|t| caster.shading_normals_of(t)).collect(),
                casts: caster.role.casts,
            })
        };
        let parts: Vec<Option<SmoothPart>> = casters.iter().map(part).collect();
        parts.iter().any(Option::is_some).then_some(Self(parts))
    }

    /// The shading at `point` of the triangle that was hit, which has these corners, from `eye`, which sees its back if it `is_turned`; `None` where
    /// it is flat. `blur` is how much of what is interpolated may be lost, relative to the corners'.
    pub(super) fn shading(
        &self,
        hit: &Hit,
        corners: [DVec3; 3],
        [eye, point]: [DVec3; 2],
        is_turned: bool,
        blur: f64,
    ) -> Option<Shading> {
        let part = self.0[hit.part as usize].as_ref()?;
        let normals = part.normals[hit.triangle as usize]?.map(Vec3::as_dvec3);
        let side = if is_turned { -1.0 } else { 1.0 };
        let weights = (side * weights_at(point, corners)).to_array();
        let normal: DVec3 = (0..3).map(|i| weights[i] * normals[i]).sum();
        let height = (0..3).map(|i| weights[i] * normals[i].dot(corners[i])).sum();
        // Opposite normals cancel out somewhere, and there the triangle is as flat as it is drawn.
        let is_smooth = normal.length() > 0.0;
        is_smooth.then(|| Shading { normal, height, blur, eye_distance: eye.distance(point), casts: part.casts })
    }
}

impl Shading {
    /// Whether the light is on the lit side of the point; `None` where that, or whether the surface shades itself there, is not to be told.
    pub(super) fn faces(&self, seen: &Seen, light: LightPosition) -> Option<bool> {
        let to_light = light.offset_from(seen.point);
        let homogeneous = light.homogeneous();
        let height = self.normal.dot(homogeneous.truncate()) - homogeneous.w * self.height;
        let lengths = self.normal.length() * to_light.length();
        let cosine = height / lengths;
        // Devices interpolate heights over the eye: what is lost is relative to how far that is away.
        let reach = to_light.length() + 2.0 * self.eye_distance * homogeneous.w;
        let is_told = cosine.abs() > EDGE_ON + self.blur * reach / lengths;
        if !is_told {
            return None;
        }
        if cosine < 0.0 {
            return Some(false);
        }
        let is_flat_lit = faces(seen.normal, to_light)?;
        (is_flat_lit || !self.casts).then_some(true)
    }
}
