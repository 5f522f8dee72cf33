//! What has changed since the last light: for a sun or a lamp that has moved a little.
//!
//! ```text
//!     dual space         . .            A light that moves turns its hyperplane. Only faces whose
//!       old ------------.---.--------   dual points it sweeps over change sides, and only their
//!       new ---____    .  .             edges come or go. Points that were farther from it than it
//!                  ----____   .  .      has moved since can't be among them.
//! ```
//!
//! From time to time the faces within a band about the hyperplane are gathered. As long as the light has moved by less than the band is
//! wide, only those are looked at. The silhouette is kept as a list, from which edges are taken and to which they are added.
//!
//! Source: M. Pop et al., "Efficient perspective-accurate silhouette computation", 2001, have the sweep between two planes, in three dimensions.
//! The band and the list are ours.

use super::edges::Edges;
use super::faces::{Faces, FramedLight, WORD};
use super::facing::{Facing, for_each_change};
use super::simd;

/// Steps, as long as the last, that a band is to last: the more, the wider it is, and the more faces are looked at in each.
const STEPS: f32 = 24.0;
/// How wide a band is at first, at least and at most: distances of lights of length 1, radians for a sun.
const FIRST_BAND: f32 = 0.05;
const NARROWEST_BAND: f32 = 1e-3;
const WIDEST_BAND: f32 = 0.25;
/// No dual point is farther from the origin: `n` is 1 long and `d` at most 1.
const FARTHEST: f32 = 1.415;
/// More than rounding can do to a height, twice.
const ROUNDING: f32 = 2e-6;
/// A light of open components is followed while the distance that counts as in a plane grows no more than this many times.
const EDGE_ON_GROWTH: f32 = 2.0;

/// The pairs of each face.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Incidence {
    /// Those of face `f` are `of_face[starts[f]..starts[f + 1]]`.
    starts: Vec<u32>,
    /// The pair's number, doubled, and 1 more where the face is its second.
    of_face: Vec<u32>,
}

impl Incidence {
    pub(super) fn new(faces: &Faces, edges: &Edges) -> Self {
        let mut starts = vec![0; faces.len() + 1];
        for &face in edges.pairs.as_flattened() {
            starts[face as usize + 1] += 1;
        }
        for face in 0..faces.len() {
            starts[face + 1] += starts[face];
        }
        let mut next = starts.clone();
        let mut of_face = vec![0; 2 * edges.pairs.len()];
        for (i, &face) in edges.pairs.as_flattened().iter().enumerate() {
            of_face[next[face as usize] as usize] = i as u32;
            next[face as usize] += 1;
        }
        Self { starts, of_face }
    }

    fn of(&self, face: u32) -> &[u32] {
        &self.of_face[self.starts[face as usize] as usize..self.starts[face as usize + 1] as usize]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.starts.as_slice()) + size_of_val(self.of_face.as_slice())
    }
}

/// A silhouette that follows a light.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Follow {
    last: Option<FramedLight>,
    /// The light when the band was laid, and how far it may go from there.
    anchor: Option<(FramedLight, f32)>,
    /// The faces in the band: of closed components, and others.
    near: [Near; 2],
    list: List,
    /// Scratch.
    facing: [Facing; 2],
    coefficients: Vec<i8>,
}

/// Faces in the band, with copies of their planes, padded to whole words.
#[derive(Debug, Clone, PartialEq, Default)]
struct Near {
    faces: Vec<u32>,
    planes: [Vec<f32>; 4],
    coefficients: Vec<i8>,
}

impl Follow {
    /// Moves on to `light`; returns how many edges changed or might have.
    pub(super) fn go_to(&mut self, light: &FramedLight, faces: &Faces, edges: &Edges, incidence: &Incidence) -> usize {
        let is_in_band = self.anchor.is_some_and(|(anchor, band)| {
            FARTHEST * distance(&anchor, light) + ROUNDING < band && light.edge_on <= EDGE_ON_GROWTH * anchor.edge_on
        });
        let tested = if is_in_band {
            self.look_near(light, edges, incidence)
        } else {
            self.look_everywhere(light, faces, edges, incidence)
        };
        self.last = Some(*light);
        tested
    }

    /// The silhouette.
    pub(super) fn sides(&self) -> &[[u32; 2]] {
        &self.list.sides
    }

    fn look_near(&mut self, light: &FramedLight, edges: &Edges, incidence: &Incidence) -> usize {
        let mut tested = 0;
        for (near, edge_on) in self.near.iter_mut().zip([None, Some(light.edge_on)]) {
            near.tell(light, edge_on, &mut self.coefficients);
            for_each_change(&near.coefficients, &self.coefficients, |i, change| {
                tested += self.list.turn(near.faces[i], change, edges, incidence);
            });
            std::mem::swap(&mut near.coefficients, &mut self.coefficients);
        }
        tested
    }

    fn look_everywhere(&mut self, light: &FramedLight, faces: &Faces, edges: &Edges, incidence: &Incidence) -> usize {
        let [before, after] = &mut self.facing;
        match &self.last {
            Some(last) => before.tell(faces, last),
            None => before.tell_none(faces),
        }
        after.tell(faces, light);
        self.list.resize(edges);
        let mut tested = 0;
        before.for_each_change(after, |face, change| tested += self.list.turn(face as u32, change, edges, incidence));

        let step = self.last.map(|last| STEPS * FARTHEST * distance(&last, light));
        let band = step.map_or(FIRST_BAND, |step| step.clamp(NARROWEST_BAND, WIDEST_BAND));
        self.anchor = Some((*light, band));
        self.lay_band(light, band, faces);
        tested.max(faces.count)
    }

    fn lay_band(&mut self, light: &FramedLight, band: f32, faces: &Faces) {
        // In open components a light may be in a plane, which is a state of its own.
        let width = band + EDGE_ON_GROWTH * light.edge_on;
        let planes = faces.planes.each_ref().map(Vec::as_slice);
        self.coefficients.resize(faces.len(), 0);
        simd::coefficients(planes, light.hyperplane, Some(width), &mut self.coefficients);
        self.near.iter_mut().for_each(Near::clear);
        for (face, _) in self.coefficients.iter().enumerate().filter(|(_, c)| **c == 0) {
            self.near[usize::from(face >= faces.closed)].push(face as u32, faces);
        }
        for (near, edge_on) in self.near.iter_mut().zip([None, Some(light.edge_on)]) {
            near.pad();
            near.tell(light, edge_on, &mut self.coefficients);
            std::mem::swap(&mut near.coefficients, &mut self.coefficients);
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let near = |near: &Near| (size_of::<u32>() + size_of::<[f32; 4]>()) * near.planes[0].len();
        self.near.iter().map(near).sum::<usize>() + self.list.bytes()
    }
}

/// How far apart two lights of length 1 are.
fn distance(a: &FramedLight, b: &FramedLight) -> f32 {
    a.hyperplane.iter().zip(&b.hyperplane).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt()
}

impl Near {
    fn clear(&mut self) {
        self.faces.clear();
        self.planes.iter_mut().for_each(Vec::clear);
    }

    fn push(&mut self, face: u32, faces: &Faces) {
        self.faces.push(face);
        self.planes.iter_mut().zip(faces.plane(face)).for_each(|(axis, x)| axis.push(x));
    }

    fn pad(&mut self) {
        let len = self.faces.len().next_multiple_of(WORD);
        self.planes.iter_mut().for_each(|axis| axis.resize(len, 0.0));
    }

    /// The coefficients of the faces, as [`Facing`] has them.
    fn tell(&self, light: &FramedLight, edge_on: Option<f32>, coefficients: &mut Vec<i8>) {
        let planes = self.planes.each_ref().map(Vec::as_slice);
        coefficients.resize(planes[0].len(), 0);
        simd::coefficients(planes, light.hyperplane, edge_on, coefficients);
    }
}

/// The silhouette, kept up to date.
#[derive(Debug, Clone, PartialEq, Default)]
struct List {
    /// How often each pair is walked from its start to its end.
    walks: Vec<i8>,
    /// Where in the list each copy of each pair is: one of a closed component has one copy at most, others have two.
    places: Vec<u32>,
    /// The copies in the list.
    copies: Vec<u32>,
    sides: Vec<[u32; 2]>,
}

const NOWHERE: u32 = u32::MAX;

impl List {
    /// Makes room for `edges`.
    fn resize(&mut self, edges: &Edges) {
        self.walks.resize(edges.pairs.len(), 0);
        self.places.resize(2 * edges.pairs.len() - edges.closed_pairs, NOWHERE);
    }

    /// Changes the coefficient of `face` by `change`, and with it the edges; returns how many.
    fn turn(&mut self, face: u32, change: i8, edges: &Edges, incidence: &Incidence) -> usize {
        let around = incidence.of(face);
        for &entry in around {
            let pair = (entry >> 1) as usize;
            self.walks[pair] += if entry & 1 == 0 { change } else { -change };
            self.list(pair, edges);
        }
        around.len()
    }

    /// Lists `pair` as often as it is walked.
    fn list(&mut self, pair: usize, edges: &Edges) {
        let walks = self.walks[pair];
        let [start, end] = edges.pair_ends[pair];
        let side = if walks > 0 { [start, end] } else { [end, start] };
        let (copies, first) = match pair.checked_sub(edges.closed_pairs) {
            None => (1, pair),
            Some(other) => (2, edges.closed_pairs + 2 * other),
        };
        for i in 0..copies {
            let (copy, is_wanted) = (first + i, usize::from(walks.unsigned_abs()) > i);
            match (self.places[copy], is_wanted) {
                (NOWHERE, false) => {}
                (NOWHERE, true) => {
                    self.places[copy] = self.sides.len() as u32;
                    self.copies.push(copy as u32);
                    self.sides.push(side);
                }
                (place, true) => self.sides[place as usize] = side,
                (place, false) => self.remove(copy, place as usize),
            }
        }
    }

    fn remove(&mut self, copy: usize, place: usize) {
        self.sides.swap_remove(place);
        self.copies.swap_remove(place);
        self.places[copy] = NOWHERE;
        if let Some(&moved) = self.copies.get(place) {
            self.places[moved as usize] = place as u32;
        }
    }

    fn bytes(&self) -> usize {
        self.walks.len()
            + size_of_val(self.places.as_slice())
            + size_of_val(self.copies.as_slice())
            + size_of_val(self.sides.as_slice())
    }
}
