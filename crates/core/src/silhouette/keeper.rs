//! Which finder a caster deserves, told from how often it is asked and how lights move.
//!
//! ```text
//!   a caster that           for each triangle      is looked at by
//!   moves                   nothing to build       the boundary of its chain: 45 ns
//!   stands                  500 ns to build        scan: 3 ns
//!   is asked 400 times      500 ns more            dual: 1 to 2 ns
//!   has lights that creep   40 ns more             coherent: 0.2 to 0.6 ns
//! ```
//!
//! A tree is built when what has been spent without it comes to what it costs, so that never more than twice the least is spent (the rule of whoever may
//! rent skis or buy them). The figures are those of one thread, in `BENCHMARKS.md`; only their ratios matter. All that is found for a caster that stands is the same
//! whatever was asked before.

use rustc_hash::FxHashMap;

use crate::{Caster, Chain, Counting, LightPosition};

use super::{Finder, FinderKind, Found, silhouette};

/// Lights after which a tree is worth its building.
const MANY: u32 = 400;
/// A light that moves no farther, in lengths of lights (radians, for a sun), creeps.
const CREEP: f64 = 0.02;
/// So often it must have crept, one after the other.
const PATIENCE: u32 = 4;

/// The silhouettes of one caster for any lights.
#[derive(Debug, Default)]
pub struct Silhouettes {
    finder: Option<Finder>,
    /// It was elsewhere before, and will be elsewhere soon.
    is_moving: bool,
    asked: u32,
    crept: u32,
    has_jumped: bool,
    lights: FxHashMap<String, Light>,
}

/// One light, as it was last.
#[derive(Debug)]
struct Light {
    last: LightPosition,
    found: Found,
}

/// The silhouette under one light, and what knows the chain that it is the boundary of.
#[derive(Debug)]
pub struct Outline<'a> {
    /// Start and end of each edge, as the lit side walks it; one of multiplicity m is here m times.
    pub sides: &'a [[u32; 2]],
    /// How it was found; `None` triangle by triangle, with nothing prepared.
    pub kind: Option<FinderKind>,
    chain: Option<Chain>,
    finder: Option<&'a Finder>,
}

impl Outline<'_> {
    /// The chain, which must be asked for with the light and the counting that the outline was found with. Linear in the number of triangles.
    ///
    /// # Panics
    ///
    /// As [`Finder::chain`].
    pub fn chain(&self, light: LightPosition, counting: &[Counting]) -> Chain {
        match (&self.chain, self.finder) {
            (Some(chain), _) => chain.clone(),
            (None, Some(finder)) => finder.chain(light, counting),
            (None, None) => unreachable!("an outline is found by a finder or from its chain"),
        }
    }
}

impl Silhouettes {
    /// Takes over `finder`, of the same caster as it is posed now.
    pub fn with_finder(finder: Finder) -> Self {
        Self { finder: Some(finder), ..Self::default() }
    }

    /// Forgets everything: the caster has moved, and what moves is not worth any preparation.
    pub fn forget(&mut self) {
        *self = Self { is_moving: true, ..Self::default() };
    }

    /// Finds the silhouette of `caster`, always the same and, unless it was [forgotten](Self::forget), in the same pose, under the light called `name`.
    ///
    /// With `kind` as that one does; else as is best, for one that has been asked so often, with lights that have moved so far.
    ///
    /// # Panics
    ///
    /// If `counting` has fewer entries than the caster has components.
    pub fn find(
        &mut self,
        caster: &Caster,
        (name, light): (&str, LightPosition),
        counting: &[Counting],
        kind: Option<FinderKind>,
    ) -> Outline<'_> {
        self.asked = self.asked.saturating_add(1);
        self.watch(caster, name, light);
        let kind = kind.or_else(|| self.best());
        let found = &mut self.lights.get_mut(name).expect("it is watched").found;
        let Some(kind) = kind else {
            let chain = Chain::new(caster, light, counting);
            found.sides.clear();
            for edge in silhouette(&caster.topology, &chain) {
                found.sides.extend(std::iter::repeat_n([edge.start, edge.end], edge.multiplicity as usize));
            }
            return Outline { sides: &found.sides, kind: None, chain: Some(chain), finder: None };
        };
        if self.finder.as_ref().is_none_or(|finder| finder.kind() != kind) {
            self.finder = Some(Finder::new(caster, kind));
        }
        let finder = self.finder.as_ref().expect("it was made if there was none");
        finder.find_counted(light, counting, found);
        Outline { sides: &found.sides, kind: Some(kind), chain: None, finder: Some(finder) }
    }

    /// Bytes of the finder, and of what is kept of its answers.
    pub fn bytes(&self) -> usize {
        let found: usize = self.lights.values().map(|light| light.found.bytes()).sum();
        self.finder.as_ref().map_or(0, Finder::bytes) + found
    }

    fn best(&self) -> Option<FinderKind> {
        let prepared = self.finder.as_ref().map(Finder::kind);
        match prepared {
            None if self.is_moving => None,
            _ if self.crept >= PATIENCE && !self.has_jumped => Some(FinderKind::Coherent),
            Some(FinderKind::Dual | FinderKind::Cones) => prepared,
            _ if self.asked > MANY => Some(FinderKind::Dual),
            _ => Some(FinderKind::Scan),
        }
    }

    /// Notes where the light is now, and how it came there.
    fn watch(&mut self, caster: &Caster, name: &str, light: LightPosition) {
        let Some(known) = self.lights.get_mut(name) else {
            self.lights.insert(name.to_owned(), Light { last: light, found: Found::default() });
            return;
        };
        let way = |light: LightPosition| light.offset_from(caster.bounds.center());
        let (before, now) = (way(known.last), way(light));
        let is_same_kind = known.last.is_directional() == light.is_directional();
        // How far the light has come, as seen from the caster, and a lamp also by how far the caster is large.
        let scale = if light.is_directional() { 1.0 } else { now.length().max(caster.bounds.radius()) };
        if is_same_kind && (now - before).length() <= CREEP * scale {
            self.crept = self.crept.saturating_add(1);
        } else {
            self.has_jumped |= self.crept >= PATIENCE;
            self.crept = 0;
        }
        known.last = light;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DVec3, Vec3};

    use super::*;
    use crate::{Mesh, Object, Topology, shapes};

    fn tower() -> Caster {
        let mesh = Arc::new(Mesh::new(shapes::cuboid(-Vec3::ONE, Vec3::ONE)).expect("a good mesh"));
        let topology = Arc::new(Topology::new(&mesh));
        Caster::new(&Object::new("tower", mesh, DAffine3::IDENTITY), topology)
    }

    fn sun(azimuth_rad: f64) -> LightPosition {
        let (sin, cos) = azimuth_rad.sin_cos();
        LightPosition::directional(DVec3::new(cos, sin, 0.7)).expect("not zero")
    }

    fn kinds(suns_rad: impl Iterator<Item = f64>) -> Vec<Option<FinderKind>> {
        let tower = tower();
        let counting = Counting::outside(&tower);
        let mut silhouettes = Silhouettes::default();
        suns_rad
            .map(|azimuth_rad| {
                let light = sun(azimuth_rad);
                let outline = silhouettes.find(&tower, ("sun", light), &counting, None);
                assert_eq!(outline.sides.len(), 6, "a box seen from beside a corner");
                let chain = outline.chain(light, &counting);
                assert_eq!(silhouette(&tower.topology, &chain).len(), 6);
                outline.kind
            })
            .collect()
    }

    #[test]
    fn a_caster_that_is_asked_often_gets_a_tree() {
        let kinds = kinds((0..500).map(|i| 0.3 + 0.9 * f64::from(i % 2)));
        assert_eq!(kinds[0], Some(FinderKind::Scan));
        assert_eq!(kinds[499], Some(FinderKind::Dual));
    }

    #[test]
    fn a_sun_that_creeps_is_followed_until_it_jumps() {
        let kinds =
            kinds((0..60).map(|i| if i < 40 { 0.3 + 0.004 * f64::from(i) } else { 0.4 + 0.7 * f64::from(i % 2) }));
        assert_eq!(kinds[20], Some(FinderKind::Coherent));
        assert_eq!(kinds[59], Some(FinderKind::Scan), "it does not come back to following one that jumped");
    }

    #[test]
    fn for_a_caster_that_moves_nothing_is_prepared() {
        let tower = tower();
        let counting = Counting::outside(&tower);
        let mut silhouettes = Silhouettes::default();
        silhouettes.forget();
        let outline = silhouettes.find(&tower, ("sun", sun(0.3)), &counting, None);
        assert_eq!((outline.kind, outline.sides.len()), (None, 6));
    }

    #[test]
    fn a_caster_is_looked_at_as_is_asked_for() {
        let tower = tower();
        let counting = Counting::outside(&tower);
        let mut silhouettes = Silhouettes::default();
        for kind in FinderKind::ALL {
            let outline = silhouettes.find(&tower, ("sun", sun(0.3)), &counting, Some(kind));
            assert_eq!((outline.kind, outline.sides.len()), (Some(kind), 6));
        }
    }
}
