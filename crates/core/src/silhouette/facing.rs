//! One byte for each face: how is it turned to the light?

use super::faces::{Faces, FramedLight, WORD};
use super::simd;

/// The coefficient of each face: 1 where it faces the light, else 0, or in components that are not closed -1 where it faces away.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Facing(Vec<i8>);

/// Words of planes that are looked at together: 16 KiB, that stay in the nearest cache while light after light goes through them.
const BLOCK: usize = 16 * WORD;

impl Facing {
    /// Tells each face of `faces` under `light`.
    pub(super) fn tell(&mut self, faces: &Faces, light: &FramedLight) {
        Self::tell_all(faces, std::slice::from_ref(light), std::iter::once(self));
    }

    /// Tells each face of `faces` under each of `lights`, in one pass over the planes.
    pub(super) fn tell_all<'a>(faces: &Faces, lights: &[FramedLight], facings: impl Iterator<Item = &'a mut Self>) {
        let mut facings: Vec<&mut Self> = facings.take(lights.len()).collect();
        facings.iter_mut().for_each(|facing| facing.0.resize(faces.len(), 0));
        for (kind, is_closed) in [(0..faces.closed, true), (faces.closed..faces.len(), false)] {
            for start in kind.clone().step_by(BLOCK) {
                let block = start..kind.end.min(start + BLOCK);
                let planes = faces.planes.each_ref().map(|axis| &axis[block.clone()]);
                for (light, facing) in lights.iter().zip(&mut facings) {
                    let edge_on = (!is_closed).then_some(light.edge_on);
                    simd::coefficients(planes, light.hyperplane, edge_on, &mut facing.0[block.clone()]);
                }
            }
        }
    }

    /// No face of `faces` is turned to or away from anything.
    pub(super) fn tell_none(&mut self, faces: &Faces) {
        self.0.clear();
        self.0.resize(faces.len(), 0);
    }

    /// Calls `act` with each face whose coefficient is another in `after`, and by how much it is larger there.
    pub(super) fn for_each_change(&self, after: &Self, act: impl FnMut(usize, i8)) {
        for_each_change(&self.0, &after.0, act);
    }

    /// The coefficients of all faces, padding included.
    pub(super) fn coefficients(&self) -> &[i8] {
        &self.0
    }
}

/// Calls `act` with each place where `after` differs from `before`, and by how much it is larger there.
pub(super) fn for_each_change(before: &[i8], after: &[i8], mut act: impl FnMut(usize, i8)) {
    for (i, (before, after)) in before.chunks(WORD).zip(after.chunks(WORD)).enumerate() {
        if before != after {
            for (j, (before, after)) in before.iter().zip(after).enumerate().filter(|(_, (a, b))| a != b) {
                act(i * WORD + j, after - before);
            }
        }
    }
}
