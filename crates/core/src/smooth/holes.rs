//! Holes that normals tear into the light cap where the surface has none.
//!
//! ```text
//!      lit   lit   lit        A few vertices are turned away from the light, all round them are turned to it. Where the surface
//!        \ ___|___ /          folds there, the light cap covers itself on the other side of the fold, and the silhouette round
//!    lit--| dark  |--lit      them winds forward, as the outer one does. Where normals alone say so, it winds backward: a part
//!         |_______|           of the body that faces the light is taken away, and light falls through it.
//!        /    |    \
//! ```
//!
//! O. Mattausch et al. 2012 do not speak of it. Coarse and noisy meshes have them by the dozen, a pixel or less each; they shine in the middle of a shadow.

use glam::DVec3;

use crate::LightPosition;

use super::volume::SmoothVolume;

/// A silhouette of more sides is no accident of a few normals.
const MOST_SIDES: u32 = 256;

const NONE: u32 = u32::MAX;

/// What is needed while holes are looked for.
#[derive(Debug, Default, Clone)]
pub(super) struct HoleScratch {
    /// Of each point, one that hangs together with it; roots are their own.
    hangs_on: Vec<u32>,
    /// Of each point that is a root: where its sides go round, and how many they are.
    around: Vec<Around>,
    edges: Vec<(u32, [u32; 2], i32)>,
}

/// Sides that hang together.
#[derive(Debug, Clone, Copy, Default)]
struct Around {
    first: u32,
    sides: u32,
    vector_area: DVec3,
}

/// Takes out of `volume` the sides of short silhouettes that wind backward under `light`, with the folds and fins between them and the light cap, which
/// is whole without them. What is left is as closed as it was. Linear in the numbers of points, sides and faces.
///
/// A silhouette round a hole that is there, as in a ring, winds backward too. Behind its folds the light cap ends, so they are kept.
pub(super) fn fill(volume: &mut SmoothVolume, light: LightPosition, scratch: &mut HoleScratch) {
    scratch.hang_together(volume);
    scratch.go_around(volume);
    let HoleScratch { hangs_on, around, edges } = scratch;
    let winds_backward = |root: u32| {
        let Around { first, sides, vector_area } = around[root as usize];
        let from = |p: u32| light.offset_from(volume.points[p as usize].as_dvec3());
        (1..=MOST_SIDES).contains(&sides) && vector_area.dot(from(first)) < 0.0
    };
    // What is left of the boundary of folds and fins when the sides are taken away is where the light cap ends.
    edges.clear();
    let mut add = |root: u32, [a, b]: [u32; 2], times: i32| {
        edges.push(if a < b { (root, [a, b], times) } else { (root, [b, a], -times) });
    };
    for &[a, b, c] in &volume.faces {
        let root = hangs_on[a as usize];
        if winds_backward(root) {
            [[a, b], [b, c], [c, a]].into_iter().for_each(|edge| add(root, edge, 1));
        }
    }
    for &side in &volume.sides {
        let root = hangs_on[side[0] as usize];
        if winds_backward(root) {
            add(root, side, -1);
        }
    }
    edges.sort_unstable();
    let is_whole = |edges: &[(u32, [u32; 2], i32)]| {
        let is_gone = |edge: &[(u32, [u32; 2], i32)]| edge.iter().map(|(_, _, times)| times).sum::<i32>() == 0;
        edges.chunk_by(|a, b| a.1 == b.1).all(|edge| edge[0].1[0] == edge[0].1[1] || is_gone(edge))
    };
    let mut is_any = false;
    for of_root in edges.chunk_by(|a, b| a.0 == b.0) {
        if is_whole(of_root) {
            // Marked by what no silhouette has.
            around[of_root[0].0 as usize].sides = NONE;
            is_any = true;
        }
    }
    if is_any {
        let stays = |p: u32| around[hangs_on[p as usize] as usize].sides != NONE;
        volume.sides.retain(|side| stays(side[0]));
        volume.faces.retain(|face| stays(face[0]));
    }
}

impl HoleScratch {
    /// Finds which points are joined by sides, folds and fins.
    fn hang_together(&mut self, volume: &SmoothVolume) {
        self.hangs_on.clear();
        self.hangs_on.extend(0..volume.points.len() as u32);
        for &[a, b, c] in &volume.faces {
            self.join(a, b);
            self.join(b, c);
        }
        for &[a, b] in &volume.sides {
            self.join(a, b);
        }
        for p in 0..self.hangs_on.len() as u32 {
            self.hangs_on[p as usize] = self.root(p);
        }
    }

    fn root(&mut self, mut p: u32) -> u32 {
        while self.hangs_on[p as usize] != p {
            let next = self.hangs_on[p as usize];
            self.hangs_on[p as usize] = self.hangs_on[next as usize];
            p = next;
        }
        p
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.hangs_on[a.max(b) as usize] = a.min(b);
    }

    /// Adds up sides, each as seen from the first of those that it hangs together with.
    fn go_around(&mut self, volume: &SmoothVolume) {
        self.around.clear();
        self.around.resize(volume.points.len(), Around::default());
        for &[a, b] in &volume.sides {
            let around = &mut self.around[self.hangs_on[a as usize] as usize];
            if around.sides == 0 {
                around.first = a;
            }
            let [first, a, b] = [around.first, a, b].map(|p| volume.points[p as usize].as_dvec3());
            around.sides += 1;
            around.vector_area += (a - first).cross(b - first);
        }
    }
}
