//! One door to all finders.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::{Caster, Chain, Counting, LightPosition, Topology};

use super::coherent::{Follow, Incidence};
use super::cones::{self, Cone};
use super::dual::{self, Ends};
use super::edges::Edges;
use super::faces::Faces;
use super::facing::Facing;
use super::hierarchy::{Open, Trees};
use super::plain::{self, PlanesInRows};
use super::scan;

/// How silhouettes are found on the CPU. All find the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FinderKind {
    /// A loop over the edges with two products each: the baseline.
    Plain,
    /// Facing bits of all faces at once, then every edge through them.
    Scan,
    /// A tree over the edges in dual space (G. Wallner 2007): looks at edges near the light's hyperplane only.
    Dual,
    /// A tree over the surface with cones of normals (P. Sander et al. 2000).
    Cones,
    /// What has changed since the last light; for lights that move a little at a time.
    Coherent,
}

impl FinderKind {
    /// All, the baseline first.
    pub const ALL: [Self; 5] = [Self::Plain, Self::Scan, Self::Dual, Self::Cones, Self::Coherent];

    /// Its name on a command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Scan => "scan",
            Self::Dual => "dual",
            Self::Cones => "cones",
            Self::Coherent => "coherent",
        }
    }
}

/// Finds the silhouettes of one caster, as it was posed when this was made.
///
/// ```
/// use std::sync::Arc;
/// use glam::{DAffine3, DVec3, Vec3};
/// use umbrae_core::{Caster, Finder, FinderKind, Found, LightPosition, Mesh, Object, Topology, shapes};
///
/// let mesh = Arc::new(Mesh::new(shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 10.0, 30.0)))?);
/// let topology = Arc::new(Topology::new(&mesh));
/// let tower = Caster::new(&Object::new("tower", mesh, DAffine3::IDENTITY), topology);
///
/// let finder = Finder::new(&tower, FinderKind::Dual);
/// let mut found = Found::default();
/// // From straight above, the outline of a box is its square top.
/// finder.find(LightPosition::directional(DVec3::Z).expect("not zero"), &mut found);
/// assert_eq!(found.sides.len(), 4);
/// # Ok::<(), umbrae_core::MeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Finder {
    id: u64,
    topology: Arc<Topology>,
    faces: Faces,
    edges: Edges,
    method: Method,
}

#[derive(Debug, Clone)]
pub(super) enum Method {
    Plain(PlanesInRows),
    Scan,
    Dual(Trees<Ends>),
    Cones(Trees<Cone>),
    Coherent(Incidence),
}

/// What was found for one caster and one light, with memory that serves again for the next.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// The silhouette: start and end of each edge, as the lit side walks it; one of multiplicity m is here m times.
    ///
    /// The same edges from every finder, in an order that depends on the finder (and, for [`FinderKind::Coherent`], on the lights before).
    pub sides: Vec<[u32; 2]>,
    /// How many edges were tested.
    pub tested: usize,
    facing: Facing,
    open: Open,
    /// Which finder's answer is followed.
    of: u64,
    follow: Follow,
}

impl Found {
    /// Bytes of the last answer that [`FinderKind::Coherent`] keeps; a few otherwise.
    pub fn bytes(&self) -> usize {
        self.follow.bytes()
    }
}

/// Each finder has another, and 0 is none's.
static NEXT_ID: AtomicU64 = AtomicU64::new(1);

impl Finder {
    /// Prepares to find silhouettes of `caster`: its planes and edges, and a tree where the kind has one.
    ///
    /// Takes about 0.3 microseconds for each edge, and as long again for a tree, on two threads of the rayon pool; 30 bytes for each edge, and 50 more
    /// for a tree.
    pub fn new(caster: &Caster, kind: FinderKind) -> Self {
        let faces = Faces::new(caster);
        let mut edges = Edges::new(caster, &faces);
        let method = match kind {
            FinderKind::Plain => Method::Plain(PlanesInRows::new(&faces)),
            FinderKind::Scan => Method::Scan,
            FinderKind::Dual => Method::Dual(dual::trees(&faces, &edges)),
            FinderKind::Cones => Method::Cones(cones::trees(caster, &faces, &edges)),
            FinderKind::Coherent => Method::Coherent(Incidence::new(&faces, &edges)),
        };
        if matches!(method, Method::Dual(_) | Method::Cones(_)) {
            edges.drop_pairs();
        }
        Self::of_parts(caster, faces, edges, method)
    }

    /// A finder for `caster`, of what was found out about it.
    pub(super) fn of_parts(caster: &Caster, faces: Faces, edges: Edges, method: Method) -> Self {
        let id = NEXT_ID.fetch_add(1, Ordering::Relaxed);
        Self { id, topology: caster.topology.clone(), faces, edges, method }
    }

    pub(super) fn parts(&self) -> (&Faces, &Edges, &Method) {
        (&self.faces, &self.edges, &self.method)
    }

    /// How it finds.
    pub fn kind(&self) -> FinderKind {
        match self.method {
            Method::Plain(_) => FinderKind::Plain,
            Method::Scan => FinderKind::Scan,
            Method::Dual(_) => FinderKind::Dual,
            Method::Cones(_) => FinderKind::Cones,
            Method::Coherent(_) => FinderKind::Coherent,
        }
    }

    /// The silhouette under `light` where each component is counted as [`Counting::outside`] has it: the boundary of [`Finder::chain`].
    pub fn find(&self, light: LightPosition, found: &mut Found) {
        let light = self.faces.framed(light);
        found.sides.clear();
        found.tested = self.edge_count();
        match &self.method {
            Method::Plain(planes) => plain::find(planes, &self.edges, &light, &mut found.sides),
            Method::Scan => scan::find(&self.faces, &self.edges, &light, &mut found.facing, &mut found.sides),
            Method::Dual(trees) => found.tested = trees.find(&light, &mut found.open, &mut found.sides),
            Method::Cones(trees) => found.tested = trees.find(&light, &mut found.open, &mut found.sides),
            Method::Coherent(incidence) => {
                if found.of != self.id {
                    (found.of, found.follow) = (self.id, Follow::default());
                }
                found.tested = found.follow.go_to(&light, &self.faces, &self.edges, incidence);
                found.sides.extend_from_slice(found.follow.sides());
            }
        }
        if !matches!(self.method, Method::Plain(_) | Method::Scan) {
            found.tested += self.edges.odd.len();
            self.edges.add_odd(|on| on.coefficient(&light), &mut found.sides);
        }
    }

    /// The silhouette under `light` where component `i` is counted as `counting[i]` says: the boundary of [`Finder::chain`].
    ///
    /// Where a closed component counts [`Counting::Every`] (a lamp on its surface, say, or the eye in it), all of the caster's edges are looked at.
    ///
    /// # Panics
    ///
    /// If `counting` has fewer entries than the caster has components.
    pub fn find_counted(&self, light: LightPosition, counting: &[Counting], found: &mut Found) {
        let components = self.topology.components().iter().zip(counting);
        // Counting those that face away takes the whole closed surface from the chain, which has no boundary.
        if components.clone().any(|(component, &counting)| component.is_closed && counting == Counting::Every) {
            let chain = self.chain(light, counting);
            found.sides.clear();
            found.tested = self.topology.edges().len();
            for edge in super::silhouette(&self.topology, &chain) {
                found.sides.extend(std::iter::repeat_n([edge.start, edge.end], edge.multiplicity as usize));
            }
        } else {
            self.find(light, found);
        }
    }

    /// The silhouettes under several lights, one after the other in `found`: [`FinderKind::Scan`] passes over memory once for all of them,
    /// others do as [`Finder::find`] does.
    ///
    /// # Panics
    ///
    /// If there are fewer of `found` than `lights`.
    pub fn find_all(&self, lights: &[LightPosition], found: &mut [Found]) {
        assert!(found.len() >= lights.len(), "each light needs a place for what is found");
        if matches!(self.method, Method::Scan) {
            let framed: Vec<_> = lights.iter().map(|&light| self.faces.framed(light)).collect();
            for found in &mut found[..lights.len()] {
                found.sides.clear();
                found.tested = self.edge_count();
            }
            let mut places: Vec<_> = found.iter_mut().map(|found| (&mut found.facing, &mut found.sides)).collect();
            scan::find_all(&self.faces, &self.edges, &framed, &mut places);
        } else {
            lights.iter().zip(found).for_each(|(&light, found)| self.find(light, found));
        }
    }

    /// The chain under `light`, from the same planes as the silhouettes, where component `i` is counted as `counting[i]` says.
    ///
    /// Linear in the number of triangles.
    ///
    /// # Panics
    ///
    /// If `counting` has fewer entries than the caster has components.
    pub fn chain(&self, light: LightPosition, counting: &[Counting]) -> Chain {
        let light = self.faces.framed(light);
        let mut facing = Facing::default();
        facing.tell(&self.faces, &light);
        let told = |face: u32| facing.coefficients()[face as usize];
        let triangles = self.faces.of_triangle.iter().zip(self.topology.component_of_triangle());
        let coefficient = |(&face, &component): (&u32, &u32)| {
            let component = component as usize;
            let is_closed = self.topology.components()[component].is_closed;
            match counting[component] {
                Counting::Every if is_closed => self.faces.turn(face, &light) as i8,
                Counting::Facing if !is_closed => told(face).max(0),
                Counting::FacingAway if !is_closed => told(face).min(0),
                Counting::Every | Counting::Facing => told(face),
                Counting::FacingAway => told(face) - 1,
            }
        };
        Chain::from_coefficients(triangles.map(coefficient).collect())
    }

    /// How many edges may ever be silhouette: those between faces that are not in one plane, and borders.
    pub fn edge_count(&self) -> usize {
        self.edges.count
    }

    /// How many flat faces there are.
    pub fn face_count(&self) -> usize {
        self.faces.count
    }

    /// Bytes of all that is kept for finding, besides the caster and its topology.
    pub fn bytes(&self) -> usize {
        let method = match &self.method {
            Method::Plain(planes) => planes.bytes(),
            Method::Scan => 0,
            Method::Dual(trees) => trees.bytes(),
            Method::Cones(trees) => trees.bytes(),
            Method::Coherent(incidence) => incidence.bytes(),
        };
        self.faces.bytes() + self.edges.bytes() + method
    }
}
