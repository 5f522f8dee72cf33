//! Every edge, through a table.
//!
//! Coefficients of all faces first, eight at a time; then the edges, each two bytes of the table and no branch. What is read is 16 bytes for each face and 8
//! for each edge, in order; the table itself stays in the nearest caches. Several lights go through one block of planes, or edges, after the other, so that
//! memory is read once for all.

use rayon::prelude::*;

use super::edges::Edges;
use super::faces::{Faces, FramedLight};
use super::facing::Facing;

/// With fewer edges than this, threads cost more than they save.
const MANY: usize = 1 << 17;
/// Edges that are looked at together: 32 KiB of faces, that stay in the nearest cache while light after light goes through them.
const BLOCK: usize = 1 << 12;
/// Edges for one thread at a time.
const PART: usize = 1 << 15;

/// Adds the silhouette under `light` to `found`, and leaves in `facing` which faces are turned to it.
///
/// On all threads of the rayon pool where there are many edges.
pub(super) fn find(faces: &Faces, edges: &Edges, light: &FramedLight, facing: &mut Facing, found: &mut Vec<[u32; 2]>) {
    find_all(faces, edges, std::slice::from_ref(light), &mut [(facing, found)]);
}

/// Does as [`find`] does, for each of `lights`, in one pass over planes and edges.
pub(super) fn find_all(
    faces: &Faces,
    edges: &Edges,
    lights: &[FramedLight],
    places: &mut [(&mut Facing, &mut Vec<[u32; 2]>)],
) {
    Facing::tell_all(faces, lights, places.iter_mut().map(|(facing, _)| &mut **facing));
    let all = 0..edges.pairs.len();
    if all.len() < MANY || rayon::current_num_threads() == 1 {
        for start in all.clone().step_by(BLOCK) {
            for (facing, found) in &mut places[..lights.len()] {
                add_pairs(edges, start..all.end.min(start + BLOCK), facing, found);
            }
        }
    } else {
        for (facing, found) in &mut places[..lights.len()] {
            let facing = &**facing;
            let starts: Vec<usize> = all.clone().step_by(PART).collect();
            let part = |start| {
                let mut found = Vec::new();
                add_pairs(edges, start..all.end.min(start + PART), facing, &mut found);
                found
            };
            let parts: Vec<_> = starts.into_par_iter().map(part).collect();
            parts.into_iter().for_each(|mut part| found.append(&mut part));
        }
    }
    for (facing, found) in &mut places[..lights.len()] {
        edges.add_odd(|on| i32::from(facing.coefficients()[on.face as usize]), found);
    }
}

/// Found edges that are written before any is handed on; a power of two, so that every place is in the block.
const HITS: usize = 256;

fn add_pairs(edges: &Edges, range: std::ops::Range<usize>, facing: &Facing, found: &mut Vec<[u32; 2]>) {
    let c = facing.coefficients();
    let times = |[a, b]: [u32; 2]| c[a as usize] - c[b as usize];
    let mut hits = [0_u32; HITS];
    for start in range.clone().step_by(HITS) {
        let end = range.end.min(start + HITS);
        let mut count = 0;
        // Every edge writes its number, and only a silhouette edge keeps its place.
        for (pair, &both) in (start..end).zip(&edges.pairs[start..end]) {
            hits[count % HITS] = pair as u32;
            count += usize::from(times(both) != 0);
        }
        let hits = &hits[..count];
        let side = |pair: u32| {
            let [start, end] = edges.pair_ends[pair as usize];
            if times(edges.pairs[pair as usize]) > 0 { [start, end] } else { [end, start] }
        };
        found.extend(hits.iter().map(|&pair| side(pair)));
        if end > edges.closed_pairs {
            let is_double = |&&pair: &&u32| times(edges.pairs[pair as usize]).abs() == 2;
            found.extend(hits.iter().filter(is_double).map(|&pair| side(pair)));
        }
    }
}
