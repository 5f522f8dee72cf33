//! The boundary of a caster's shadow on a level plane: that of its chain, projected along the sun.
//!
//! ```text
//!       ______             Each triangle of the chain is turned to the sun, so projected it is counter-clockwise; the boundary of all winds
//!      /\  +1 \            around a point of the plane once for each of them that covers it. Filled wherever it winds, it is their union:
//!     /  \_____\           the silhouette's few edges stand for all the triangles.
//!     \  /     /
//!  ----x-------x---- plane  Where the plane cuts the caster, each cut triangle adds its edge in the plane, and what is below goes.
//!       \/_____/
//! ```
//!
//! What counts is a point of the plane, and the ray from it to the sun. As long as a closed component has nothing below the plane, the point may be taken
//! just below it, outside: the ray leaves as often as it enters, so the triangles that face the sun are enough. Where the plane cuts it, the point may be
//! inside, and all triangles count, as those of open components do.

use std::ops::RangeInclusive;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use umbrae_core::{Caster, Chain, Counting, LightPosition, SilhouetteEdge, silhouette};

use super::loops::{Corner, loops};
use super::{Outline, boolean};

/// The sine of an altitude at which the sun counts as on the horizon: the shadow of a metre would be 1000 km long.
const ON_HORIZON: f64 = 1e-6;

/// Casters above a level plane, made ready to cast on it from any number of suns.
///
/// What is in the plane or below it casts nothing; what goes through it is cut.
///
/// ```
/// use std::sync::Arc;
/// use glam::{DAffine3, DVec3, Vec3};
/// use umbrae_core::{Caster, Mesh, Object, Topology, shapes};
/// use umbrae_study::Projection;
///
/// let mesh = Arc::new(Mesh::new(shapes::cuboid(Vec3::ZERO, Vec3::new(10.0, 10.0, 30.0)))?);
/// let topology = Arc::new(Topology::new(&mesh));
/// let casters = [Caster::new(&Object::new("tower", mesh, DAffine3::IDENTITY), topology)];
///
/// // From the south, half way up: as long as the tower is high.
/// let ground = Projection::new(&casters, 0.0);
/// let shadow = ground.outline(0, DVec3::new(0.0, -1.0, 1.0)).expect("the sun is up");
/// assert_eq!(shadow.area_m2(), 10.0 * (10.0 + 30.0));
/// assert_eq!(shadow.minus(&ground.section(0)).area_m2(), 10.0 * 30.0);
/// # Ok::<(), umbrae_core::MeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Projection<'a> {
    casters: &'a [Caster],
    plane_z_m: f64,
    parts: Vec<Part>,
}

/// What is known about a caster before there is a sun.
#[derive(Debug, Clone)]
struct Part {
    /// One for each component.
    counting: Vec<Counting>,
    /// Nothing of it is above the plane.
    is_sunk: bool,
    /// Something of it may be in the plane or below it.
    is_cut: bool,
}

impl<'a> Projection<'a> {
    /// Casters over the plane `z = plane_z_m`, scene space. Linear in the number of triangles.
    pub fn new(casters: &'a [Caster], plane_z_m: f64) -> Self {
        let parts = casters.par_iter().map(|caster| Part::new(caster, plane_z_m)).collect();
        Self { casters, plane_z_m, parts }
    }

    /// Where the plane is, in scene space.
    pub fn plane_z_m(&self) -> f64 {
        self.plane_z_m
    }

    /// How many casters there are.
    pub fn len(&self) -> usize {
        self.casters.len()
    }

    /// Whether there is no caster.
    pub fn is_empty(&self) -> bool {
        self.casters.is_empty()
    }

    /// The shadow of caster `index` when the sun is towards `to_sun`, which need not be of unit length; `None` when that is at or below the horizon.
    ///
    /// Nothing is cut off, however far away: a low sun's shadows are kilometres long, and on the round earth would not be. Take suns of some
    /// altitude, or [`Outline::intersection`] with what matters. Within an altitude of a fifth of an arc second the sun counts as on the horizon.
    ///
    /// Linear in the number of triangles, and n log n in the number of silhouette edges.
    ///
    /// # Panics
    ///
    /// If there is no such caster.
    pub fn outline(&self, index: usize, to_sun: DVec3) -> Option<Outline> {
        let sun = SlopedSun::new(to_sun)?;
        let (caster, part) = (&self.casters[index], &self.parts[index]);
        if part.is_sunk {
            return Some(Outline::default());
        }
        let chain = Chain::new(caster, sun.light, &part.counting);
        let edges = silhouette(&caster.topology, &chain);
        let plane = part.is_cut.then_some(self.plane_z_m);
        let sides = Boundary { caster, plane }.sides(&edges, chain.coefficients());
        Some(boolean::filled(&loops(sides, |corner| self.project(caster, corner, sun.metres_per_metre))))
    }

    /// The shadow of each caster, on all threads of rayon's pool; see [`Projection::outline`].
    pub fn outlines(&self, to_sun: DVec3) -> Option<Vec<Outline>> {
        (0..self.len()).into_par_iter().map(|index| self.outline(index, to_sun)).collect()
    }

    /// The solid parts of caster `index` just above the plane: where the plane is inside closed components. Where a building stands, it covers the ground, and
    /// no receiver is there.
    ///
    /// # Panics
    ///
    /// If there is no such caster.
    pub fn section(&self, index: usize) -> Outline {
        let caster = &self.casters[index];
        let is_closed = |&component: &u32| caster.topology.components()[component as usize].is_closed;
        let components = caster.topology.component_of_triangle();
        let coefficients: Vec<i8> = components.iter().map(|component| i8::from(is_closed(component))).collect();
        // The surface that is above the plane ends where the plane cuts it.
        let sides = Boundary { caster, plane: Some(self.plane_z_m) }.sides(&[], &coefficients);
        boolean::filled(&loops(sides, |corner| self.project(caster, corner, DVec2::ZERO)))
    }

    /// What caster `index` looks like from straight above: what is above the plane, eaves and bridges included.
    ///
    /// # Panics
    ///
    /// If there is no such caster.
    pub fn plan(&self, index: usize) -> Outline {
        self.outline(index, DVec3::Z).unwrap_or_default()
    }

    /// Where in the plane the shadow of `corner` is; it moves by `metres_per_metre` of height.
    fn project(&self, caster: &Caster, [low, high]: Corner, metres_per_metre: DVec2) -> DVec2 {
        let [low, high] = [low, high].map(|i| caster.positions[i as usize].as_dvec3());
        if low == high {
            low.truncate() + (low.z - self.plane_z_m) * metres_per_metre
        } else {
            low.lerp(high, (self.plane_z_m - low.z) / (high.z - low.z)).truncate()
        }
    }
}

impl Part {
    fn new(caster: &Caster, plane_z_m: f64) -> Self {
        let mut heights = vec![f64::INFINITY..=f64::NEG_INFINITY; caster.topology.components().len()];
        for (t, &component) in caster.topology.component_of_triangle().iter().enumerate() {
            let known: &mut RangeInclusive<f64> = &mut heights[component as usize];
            let zs = caster.corners(t).map(|corner| f64::from(corner.z));
            let low = zs.iter().copied().fold(*known.start(), f64::min);
            let high = zs.iter().copied().fold(*known.end(), f64::max);
            *known = low..=high;
        }
        let components = || caster.topology.components().iter().zip(&heights);
        let stands = |is_closed: bool, low: f64| if is_closed { low >= plane_z_m } else { low > plane_z_m };
        let is_cut = !components().all(|(component, z)| stands(component.is_closed, *z.start()));
        let counting = components().map(|(component, z)| {
            // What stands in the plane would lose its base to the cut.
            let is_whole = component.is_closed && (!is_cut || *z.start() > plane_z_m);
            if is_whole { Counting::Facing } else { Counting::Every }
        });
        let is_sunk = heights.iter().all(|z| *z.end() <= plane_z_m);
        Self { counting: counting.collect(), is_sunk, is_cut }
    }
}

/// A sun above the horizon.
struct SlopedSun {
    light: LightPosition,
    /// By how much a shadow moves for each metre of height.
    metres_per_metre: DVec2,
}

impl SlopedSun {
    fn new(to_sun: DVec3) -> Option<Self> {
        let light = LightPosition::directional(to_sun)?;
        let direction = light.homogeneous().truncate();
        let is_up = direction.z > ON_HORIZON;
        is_up.then(|| Self { light, metres_per_metre: -direction.truncate() / direction.z })
    }
}

/// The boundary of a chain of a caster, or of the part of the chain that is above a plane.
struct Boundary<'a> {
    caster: &'a Caster,
    /// `None` takes all of it.
    plane: Option<f64>,
}

impl Boundary<'_> {
    /// The boundary of the chain with `coefficients`, which without a plane has the boundary `edges`.
    fn sides(&self, edges: &[SilhouetteEdge], coefficients: &[i8]) -> Vec<[Corner; 2]> {
        let mut sides = Vec::new();
        for edge in edges {
            let side = self.above([edge.start, edge.end]);
            sides.extend(std::iter::repeat_n(side, edge.multiplicity as usize).flatten());
        }
        if self.plane.is_some() {
            let triangles = self.caster.mesh.triangles().iter().zip(coefficients);
            sides.extend(triangles.filter(|&(_, &c)| c != 0).filter_map(|(&triangle, &c)| self.cut(triangle, c)));
        }
        sides
    }

    /// A vertex in the plane is not above it.
    fn is_above(&self, vertex: u32) -> bool {
        self.plane.is_none_or(|z| f64::from(self.caster.positions[vertex as usize].z) > z)
    }

    /// The part of an edge that is above the plane.
    fn above(&self, [start, end]: [u32; 2]) -> Option<[Corner; 2]> {
        match [start, end].map(|vertex| self.is_above(vertex)) {
            [true, true] => Some([[start; 2], [end; 2]]),
            [true, false] => Some([[start; 2], on_edge(start, end)]),
            [false, true] => Some([on_edge(start, end), [end; 2]]),
            [false, false] => None,
        }
    }

    /// The edge that closes what the plane leaves of a triangle with coefficient `c`: from where its border goes down through the plane to where it comes up.
    fn cut(&self, [i, j, k]: [u32; 3], c: i8) -> Option<[Corner; 2]> {
        let walked = [[i, j], [j, k], [k, i]];
        let crossing = |from_above: bool| {
            walked.iter().find(|edge| self.is_above(edge[0]) == from_above && self.is_above(edge[1]) != from_above)
        };
        let [down, up] = [crossing(true)?, crossing(false)?].map(|&[from, to]| on_edge(from, to));
        Some(if c > 0 { [down, up] } else { [up, down] })
    }
}

/// Where the plane cuts an edge, whichever way it is walked.
fn on_edge(a: u32, b: u32) -> Corner {
    [a.min(b), a.max(b)]
}
