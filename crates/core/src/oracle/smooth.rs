//! Where surfaces that are shaded as if they were curved turn away from a light.
//!
//! The light ends where the interpolated normal is at a right angle to it, on whichever side of the triangle's own plane. Where the normal faces
//! the light and the triangle does not, a body of flat triangles would shade itself, and a volume that follows the curved surface leaves it lit:
//! that is decided by how volumes are made, and not by rays.

use glam::{DVec3, Vec3};

use super::cut_out::weights_at;
use super::{EDGE_ON, Seen, faces};
use crate::{Caster, Hit};

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
    /// Unit length, on the seen side as the triangle's own normal is.
    normal: DVec3,
    /// How much of `normal` may be lost where a device interpolates it.
    blur: f64,
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

    /// The shading at `point` of the triangle that was hit, which has these corners and is seen from its back if it `is_turned`; `None` where it is
    /// flat. `blur` is how much of what is interpolated may be lost, relative to the corners'.
    pub(super) fn shading(
        &self,
        hit: &Hit,
        corners: [DVec3; 3],
        point: DVec3,
        is_turned: bool,
        blur: f64,
    ) -> Option<Shading> {
        let part = self.0[hit.part as usize].as_ref()?;
        let normals = part.normals[hit.triangle as usize]?.map(Vec3::as_dvec3);
        let weights = weights_at(point, corners);
        let sum = normals[0] * weights.x + normals[1] * weights.y + normals[2] * weights.z;
        // Opposite normals cancel out somewhere, and there the triangle is as flat as it is drawn.
        let normal = sum.try_normalize()?;
        Some(Shading { normal: if is_turned { -normal } else { normal }, blur: blur / sum.length(), casts: part.casts })
    }
}

impl Shading {
    /// Whether the light is on the lit side of the point; `None` where that, or whether the surface shades itself there, is not to be told.
    pub(super) fn faces(&self, seen: &Seen, to_light: DVec3) -> Option<bool> {
        let cosine = self.normal.dot(to_light) / to_light.length();
        let is_told = cosine.abs() > EDGE_ON + self.blur;
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
