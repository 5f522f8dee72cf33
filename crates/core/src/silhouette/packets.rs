//! Edges in packets of up to 64, each with a copy of the planes that they need: the leaves of the trees.
//!
//! ```text
//!    planes     8 at a time      ->  one bit for each, 64 at most
//!    first      64 numbers       ->  the bit of each edge's first face    \   differ: silhouette
//!    second     64 numbers       ->  the bit of its second face           /
//! ```
//!
//! Neighbours share planes, so a packet needs fewer planes than edges, and all that it needs is in one place: nothing is fetched from elsewhere, and a
//! packet takes about as long as ten edges do through a table of bits.

use borsh::{BorshDeserialize, BorshSerialize};
use rustc_hash::FxHashMap;

use super::edges::Edges;
use super::faces::{Faces, FramedLight, WORD};
use super::simd;

/// Planes are tested in groups of as many.
pub(super) const PLANES_AT_ONCE: usize = 8;

/// A group of planes: `nx` of each, `ny` of each, `nz` of each, `-d` of each.
pub(super) type PlaneGroup = [[f32; PLANES_AT_ONCE]; 4];

/// Up to 64 edges and the planes of their faces, in one place.
#[derive(Debug, Clone, PartialEq, BorshDeserialize, BorshSerialize)]
#[repr(C, align(64))]
pub(super) struct Packet {
    /// Which of the planes is that of each edge's first face; the same as `second` where there is no edge.
    pub(super) first: [u8; WORD],
    pub(super) second: [u8; WORD],
    /// Only the first `group_count` matter.
    pub(super) planes: [PlaneGroup; WORD / PLANES_AT_ONCE],
    /// Start and end of each edge.
    ends: [u64; WORD],
    pub(super) group_count: u32,
    edge_count: u32,
}

/// What is found of a packet: bit `i` for edge `i`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct PacketHits {
    pub(super) silhouette: u64,
    /// Of those: walked from start to end.
    pub(super) forward: u64,
    /// Of those: twice.
    pub(super) double: u64,
}

impl PacketHits {
    /// Of edges whose first and second faces are turned up (bit set in `up`), down, or neither.
    pub(super) fn of_turns(up: [u64; 2], down: [u64; 2]) -> Self {
        Self {
            silhouette: (up[0] ^ up[1]) | (down[0] ^ down[1]),
            forward: (up[0] & !up[1]) | (!down[0] & down[1]),
            double: (up[0] & down[1]) | (down[0] & up[1]),
        }
    }
}

impl Packet {
    /// Whether so many `pairs` fit into one packet.
    pub(super) fn holds(pairs: impl ExactSizeIterator<Item = [u32; 2]>) -> bool {
        if pairs.len() > WORD {
            return false;
        }
        let mut faces: Vec<u32> = pairs.flatten().collect();
        faces.sort_unstable();
        faces.dedup();
        faces.len() <= WORD
    }

    /// A packet of the edges with the numbers `pairs`, which it holds.
    pub(super) fn new(pairs: &[u32], edges: &Edges, faces: &Faces) -> Self {
        let mut packet = Self {
            first: [0; WORD],
            second: [0; WORD],
            planes: Default::default(),
            ends: [0; WORD],
            group_count: 0,
            edge_count: pairs.len() as u32,
        };
        let mut numbers: FxHashMap<u32, u8> = FxHashMap::default();
        for (i, &pair) in pairs.iter().enumerate() {
            let [a, b] = edges.pairs[pair as usize].map(|face| {
                let next = numbers.len();
                *numbers.entry(face).or_insert_with(|| {
                    let at = &mut packet.planes[next / PLANES_AT_ONCE];
                    at.iter_mut().zip(faces.plane(face)).for_each(|(axis, x)| axis[next % PLANES_AT_ONCE] = x);
                    next as u8
                })
            });
            packet.first[i] = a;
            packet.second[i] = b;
            packet.ends[i] = bytemuck::cast(edges.pair_ends[pair as usize]);
        }
        packet.group_count = numbers.len().div_ceil(PLANES_AT_ONCE) as u32;
        packet
    }

    /// Whether no number in it leads out of it, or to a vertex that is not among `vertices`.
    pub(super) fn is_whole(&self, vertices: usize) -> bool {
        let planes = self.group_count as usize * PLANES_AT_ONCE;
        let is_vertex = |ends: &u64| bytemuck::cast::<u64, [u32; 2]>(*ends).iter().all(|&v| (v as usize) < vertices);
        planes <= WORD
            && self.edge_count as usize <= WORD
            && self.first.iter().chain(&self.second).all(|&plane| usize::from(plane) < WORD)
            && self.ends.iter().all(is_vertex)
    }

    /// A packet of 64 edges between the first and the second of each of `pairs`, numbers of `planes`.
    #[cfg(test)]
    pub(super) fn of_planes(planes: &[[f32; 4]], pairs: &[[u8; 2]; WORD]) -> Self {
        let mut packet = Self {
            first: pairs.map(|[first, _]| first),
            second: pairs.map(|[_, second]| second),
            planes: Default::default(),
            ends: [0; WORD],
            group_count: planes.len().div_ceil(PLANES_AT_ONCE) as u32,
            edge_count: WORD as u32,
        };
        for (i, plane) in planes.iter().enumerate() {
            let at = &mut packet.planes[i / PLANES_AT_ONCE];
            at.iter_mut().zip(plane).for_each(|(axis, &x)| axis[i % PLANES_AT_ONCE] = x);
        }
        packet
    }

    /// Adds all of the packet's edges to `found`, as they are or walked back.
    pub(super) fn add_all(&self, is_forward: bool, found: &mut Vec<[u32; 2]>) {
        let ends = &self.ends[..self.edge_count as usize];
        if is_forward {
            found.extend_from_slice(bytemuck::cast_slice(ends));
        } else {
            found.extend(ends.iter().map(|ends| bytemuck::cast::<u64, [u32; 2]>(ends.rotate_left(32))));
        }
    }

    /// Adds the packet's silhouette edges to `found`; `is_closed` says of which components it is. Returns how many edges were tested.
    pub(super) fn add_silhouette(&self, light: &FramedLight, is_closed: bool, found: &mut Vec<[u32; 2]>) -> usize {
        let hits = simd::hits(self, light.hyperplane, (!is_closed).then_some(light.edge_on));
        let mut left = hits.silhouette;
        let mut next = || {
            let i = left.trailing_zeros();
            left &= left - 1;
            // Start and end change places where the edge is walked back.
            let is_backward = !(hits.forward >> i) & 1;
            let side = self.ends[i as usize % WORD].rotate_left(32 * is_backward as u32);
            bytemuck::cast::<u64, [u32; 2]>(side)
        };
        if hits.double == 0 {
            found.extend((0..hits.silhouette.count_ones()).map(|_| next()));
        } else {
            for i in (0..WORD).filter(|i| hits.silhouette >> i & 1 == 1) {
                let side = next();
                found.extend(std::iter::repeat_n(side, 1 + (hits.double >> i & 1) as usize));
            }
        }
        self.edge_count as usize
    }
}
