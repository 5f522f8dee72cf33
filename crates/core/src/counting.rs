//! Counting on the CPU what a stencil buffer counts: crossings of a volume's faces along a path.
//!
//! Two paths, as McGuire et al. 2003 (section 2) and the lecture notes have them: from the point away from the
//! eye to infinity (z-fail), and from the eye to the point (z-pass), which tells the difference between the two.
//! Faces may have corners at infinity, so crossings are decided in oriented projective space (J. Stolfi, "Oriented projective geometry", 1991):
//! a triangle of homogeneous points with w >= 0 and a segment of such points cross where four determinants agree.

use glam::{DMat3, DMat4, DVec3, DVec4, Vec3};

use crate::{LightPosition, ShadowVolume};

/// Determinants smaller than this, relative to the lengths of their rows, may have the wrong sign: the path
/// passes through an edge or starts on a face.
const UNDECIDED: f64 = 1e-12;

impl ShadowVolume {
    /// How many of the volumes in `self` hold `point`, counted along the ray from it in `direction`: what z-fail leaves in the stencil.
    ///
    /// `positions` are the caster's, `light` the one for which the volume was made. `None` when the ray meets an edge or
    /// the point is on a face. Linear in the number of faces.
    pub fn count_to_infinity(
        &self,
        positions: &[Vec3],
        light: LightPosition,
        point: DVec3,
        direction: DVec3,
    ) -> Option<i32> {
        let count = exits(self.finite_faces(positions, light), point.extend(1.0), direction.extend(0.0))?;
        Some(count + exits_at_infinity(self.dark_cap(positions, light), direction)?)
    }

    /// How many more volumes hold `point` than hold `eye`: what z-pass leaves in the stencil.
    ///
    /// Exits count +1 from the point's end, so the difference is that of the two [`ShadowVolume::count_to_infinity`].
    pub fn count_from_eye(&self, positions: &[Vec3], light: LightPosition, eye: DVec3, point: DVec3) -> Option<i32> {
        exits(self.finite_faces(positions, light), point.extend(1.0), eye.extend(1.0))
    }
}

/// Exits less entries through `faces` on the way from `from` to `to`.
pub(crate) fn exits(mut faces: impl Iterator<Item = [DVec4; 3]>, from: DVec4, to: DVec4) -> Option<i32> {
    faces.try_fold(0, |sum, [a, b, c]| Some(sum + exit(from, to, a, b, c)?))
}

/// Exits less entries through `faces`, all at infinity, of whoever goes in `direction` for ever.
pub(crate) fn exits_at_infinity(mut faces: impl Iterator<Item = [DVec4; 3]>, direction: DVec3) -> Option<i32> {
    faces.try_fold(0, |sum, face| {
        let [a, b, c] = face.map(DVec4::truncate);
        Some(sum + exit_at_infinity(direction, a, b, c)?)
    })
}

/// +1 where the way from `p` to `q` leaves through the front of the triangle's back (exits), -1 where it enters, 0 where it
/// misses, `None` where that can't be said.
fn exit(p: DVec4, q: DVec4, a: DVec4, b: DVec4, c: DVec4) -> Option<i32> {
    let around = [sign(&[p, q, a, b]), sign(&[p, q, b, c]), sign(&[p, q, c, a])];
    let ends = [sign(&[p, a, b, c]), sign(&[q, a, b, c])];
    if misses(&around) || ends[0] * ends[1] > 0 {
        return Some(0);
    }
    if around.contains(&0) || ends.contains(&0) {
        return None;
    }
    Some(ends[1])
}

/// [`exit`] for a face at infinity, met by the ray's own end.
fn exit_at_infinity(direction: DVec3, a: DVec3, b: DVec3, c: DVec3) -> Option<i32> {
    let around = [sign3(direction, a, b), sign3(direction, b, c), sign3(direction, c, a)];
    let turn = sign3(a, b, c);
    if misses(&around) || (turn != 0 && around.contains(&-turn)) {
        return Some(0);
    }
    if turn == 0 || around.contains(&0) {
        return None;
    }
    // Seen from anywhere finite, a face of the dark cap shows its back where the volume is left through it.
    Some(turn)
}

fn misses(around: &[i32; 3]) -> bool {
    around.contains(&1) && around.contains(&-1)
}

fn sign(rows: &[DVec4; 4]) -> i32 {
    let determinant = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).determinant();
    decided_sign(determinant, rows.iter().map(|r| r.length()).product())
}

fn sign3(a: DVec3, b: DVec3, c: DVec3) -> i32 {
    decided_sign(DMat3::from_cols(a, b, c).determinant(), a.length() * b.length() * c.length())
}

fn decided_sign(determinant: f64, scale: f64) -> i32 {
    if determinant.abs() <= UNDECIDED * scale { 0 } else { determinant.signum() as i32 }
}
