//! A model made finer, to exactly as many triangles as one wants.
//!
//! The longest edges are split at their middles, which move a little at random, so that what was flat is so no more; a triangle becomes two, three or four, as many of its
//! edges are split. No vertex is left on another triangle's edge: what was closed stays closed.

use glam::Vec3;
use rustc_hash::FxHashMap;
use umbrae_core::Surface;

use crate::random::Random;

const SEED: u64 = 0x0067_726f_7774_6821;
/// How far a middle moves on each axis, at most, for the length of its edge: enough that no two of its triangles share a plane.
const PUSH: f32 = 0.02;

/// Triangles between shared vertices, ever finer.
#[derive(Debug)]
pub(super) struct Finer {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    random: Random,
}

impl Finer {
    pub(super) fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, random: Random::new(SEED) }
    }

    /// Splits edges until there are at least `count` triangles: one more at most on a closed surface; the same ones on every run.
    pub(super) fn refine_to(&mut self, count: usize) {
        while self.triangles.len() < count {
            self.split_longest(count);
        }
    }

    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    pub(super) fn surface(&self) -> Surface {
        Surface { positions: self.positions.clone(), triangles: self.triangles.clone(), ..Surface::default() }
    }

    /// Splits the longest edges, each once at most, until there are `count` triangles.
    fn split_longest(&mut self, count: usize) {
        let mut uses: FxHashMap<[u32; 2], usize> = FxHashMap::default();
        for edge in self.triangles.iter().flat_map(edges) {
            *uses.entry(edge).or_default() += 1;
        }
        let length = |[a, b]: [u32; 2]| self.positions[a as usize].distance(self.positions[b as usize]);
        let mut longest: Vec<([u32; 2], usize, f32)> =
            uses.into_iter().map(|(edge, uses)| (edge, uses, length(edge))).collect();
        // By number where lengths are equal, as maps have no order.
        longest.sort_unstable_by(|a, b| b.2.total_cmp(&a.2).then(a.0.cmp(&b.0)));

        // A split edge makes two of each triangle at it.
        let mut missing = count - self.triangles.len();
        let mut middles: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        for ([a, b], uses, length) in longest {
            if missing == 0 {
                break;
            }
            let [a_m, b_m] = [a, b].map(|v| self.positions[v as usize]);
            let push = Vec3::from_array([(); 3].map(|()| self.random.between(-PUSH, PUSH)));
            middles.insert([a, b], self.positions.len() as u32);
            self.positions.push((a_m + b_m) / 2.0 + push * length);
            missing = missing.saturating_sub(uses);
        }
        let old = std::mem::take(&mut self.triangles);
        for triangle in old {
            let [i, j, k] = edges(&triangle).map(|edge| middles.get(&edge).copied());
            split(triangle, [i, j, k], &mut self.triangles);
        }
    }
}

/// The edges of a triangle, from each of its corners to the next, the lower number first.
fn edges(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
}

/// Adds the parts of a triangle whose edges have these middles.
fn split([a, b, c]: [u32; 3], middles: [Option<u32>; 3], parts: &mut Vec<[u32; 3]>) {
    match middles {
        [None, None, None] => parts.push([a, b, c]),
        [Some(ab), None, None] => parts.extend([[a, ab, c], [ab, b, c]]),
        [Some(ab), Some(bc), None] => parts.extend([[a, ab, c], [ab, bc, c], [ab, b, bc]]),
        [Some(ab), Some(bc), Some(ca)] => parts.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]),
        // Turned until the first edge is split and, where one is not, the last.
        [ab, bc, ca] => split([b, c, a], [bc, ca, ab], parts),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use umbrae_core::{Caster, Finder, FinderKind, Mesh, Object, Topology, shapes};

    use super::*;

    fn cube() -> Finer {
        let cube = shapes::cuboid(Vec3::ZERO, Vec3::ONE);
        let mesh = Mesh::new(cube).expect("a good mesh");
        Finer::new(mesh.positions().to_vec(), mesh.triangles().to_vec())
    }

    #[test]
    fn a_closed_surface_stays_closed_whatever_its_size_and_has_no_flat_face() {
        let mut finer = cube();
        for count in [13, 20, 100, 1001, 3000] {
            finer.refine_to(count);
            assert_eq!(finer.len(), count.next_multiple_of(2));
            let mesh = Arc::new(Mesh::new(finer.surface()).expect("a good mesh"));
            let topology = Arc::new(Topology::new(&mesh));
            assert!(topology.components().iter().all(|component| component.is_closed), "{count}");
            let object = Object::new("cube", mesh, glam::DAffine3::IDENTITY);
            let finder = Finder::new(&Caster::new(&object, topology), FinderKind::Scan);
            if count > 100 {
                assert_eq!(finder.face_count(), finer.len(), "each triangle has a plane of its own");
            }
        }
    }

    #[test]
    fn two_runs_make_the_same() {
        let [mut a, mut b] = [cube(), cube()];
        a.refine_to(500);
        b.refine_to(500);
        assert_eq!(a.surface(), b.surface());
    }
}
