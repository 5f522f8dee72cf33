//! Points that may be in the sun: on the ground, on surfaces, anywhere.

mod ground;
mod inside;
mod level;
mod surfaces;
mod terrain;

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};
use umbrae_core::{Caster, RayCaster, SurfaceKind};

pub use ground::GroundGrid;
pub use inside::Solids;
pub use level::GroundLevel;
pub use surfaces::kind_of_triangles;
pub use terrain::Terrain;

/// How far a receiver stands in front of the surface it is on, in metres.
///
/// More than what rounding moves a surface within a city (`f32` at 10 km: 0.5 mm), and less than an edge of a building is
/// known to.
pub const LIFT_M: f64 = 0.01;

/// Houses may stand so much higher than the level that is taken for the ground, in metres. The crown of a tree, under which is shade, is higher.
pub const FOOT_M: f64 = 1.2;

/// All the points of a study, in groups that belong together.
///
/// The lists are of one length, and the groups' ranges cover them in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Receivers {
    /// Scene space, metres.
    pub positions: Vec<DVec3>,
    /// One unit vector for each position: the sun must be on its side. Zero where the receiver is open to all sides.
    pub normals: Vec<Vec3>,
    /// Inside a solid: no receiver at all, kept so that grids stay grids.
    pub is_inside: Vec<bool>,
    /// In order, each a range of the above; they cover all.
    pub groups: Vec<Group>,
}

/// Receivers that are reported together.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// "ground", or the name of an object, or that of a file of points.
    pub name: String,
    /// What they are on.
    pub kind: GroupKind,
    /// Which ones.
    pub range: Range<usize>,
}

/// What receivers are on.
#[derive(Debug, Clone, PartialEq)]
pub enum GroupKind {
    /// A grid on the ground, in rows from north to south, each from west to east.
    Ground(GroundGrid),
    /// Points on surfaces of one object.
    Surface {
        /// Index of the object in the scene.
        object: usize,
        /// What the surfaces are.
        surface: SurfaceKind,
        /// Square metres that each receiver of the range stands for.
        areas: Vec<f32>,
    },
    /// Points that the user gave, with their names.
    Points {
        /// One for each receiver of the range.
        names: Vec<String>,
    },
}

impl Receivers {
    /// How many there are, those inside solids included.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Adds a grid on the ground: on `terrain` where there is some above or below, else at the grid's level.
    ///
    /// Those inside of `solids` are marked, and off the terrain also those up to [`FOOT_M`] below one: its floor is higher than the level that stands for
    /// the ground.
    pub fn add_ground(&mut self, grid: GroundGrid, terrain: &Terrain, solids: &Solids) {
        let positions = grid.points(terrain);
        let inside = hold_ground(&grid, &positions, solids);
        self.add("ground".to_owned(), GroupKind::Ground(grid), positions.into_iter().map(|p| (p, Vec3::ZERO)), inside);
    }

    /// For each receiver whether it is inside of `solids`, as when it was added: for other solids than those.
    pub fn inside_of(&self, solids: &Solids) -> Vec<bool> {
        let of_group = |group: &Group| {
            let positions = &self.positions[group.range.clone()];
            match &group.kind {
                GroupKind::Ground(grid) => hold_ground(grid, positions, solids),
                GroupKind::Surface { .. } | GroupKind::Points { .. } => solids.hold(positions),
            }
        };
        self.groups.iter().flat_map(of_group).collect()
    }

    /// Adds points on those surfaces of caster `object` whose triangles have `kinds` (one for each triangle) equal to `surface`, about one in each
    /// square of `spacing` metres; nothing where there are none.
    ///
    /// A point stands [`LIFT_M`] before its surface, on the side from which its corners go round counter-clockwise; on the other, if the first is
    /// inside of one of `solids`.
    ///
    /// # Panics
    ///
    /// If there are not as many kinds as triangles.
    pub fn add_surfaces(
        &mut self,
        object: usize,
        caster: &Caster,
        kinds: &[SurfaceKind],
        surface: SurfaceKind,
        spacing: f64,
        solids: &Solids,
    ) {
        let samples = surfaces::samples(caster, kinds, surface, spacing);
        let lifted = |side: f64| -> Vec<DVec3> {
            samples.iter().map(|s| s.position + side * LIFT_M * s.normal.as_dvec3()).collect()
        };
        let front = lifted(1.0);
        let mut inside = solids.hold(&front);
        let back = lifted(-1.0);
        let inside_of_back = solids.hold(&back);
        let points = samples.iter().enumerate().map(|(i, sample)| {
            if inside[i] && !inside_of_back[i] { (back[i], -sample.normal) } else { (front[i], sample.normal) }
        });
        let points: Vec<_> = points.collect();
        for (is_inside, of_back) in inside.iter_mut().zip(inside_of_back) {
            *is_inside &= of_back;
        }
        let areas = samples.iter().map(|s| s.area).collect();
        let kind = GroupKind::Surface { object, surface, areas };
        self.add(caster.name.clone(), kind, points, inside);
    }

    /// Adds points by name, position and normal: zero is open to all sides, else the point is moved [`LIFT_M`] along it, before the surface on which
    /// it may lie.
    pub fn add_points(&mut self, name: String, points: Vec<(String, DVec3, Vec3)>, solids: &Solids) {
        let normals: Vec<Vec3> = points.iter().map(|p| p.2.normalize_or_zero()).collect();
        let lifted = |(p, normal): (&(String, DVec3, Vec3), &Vec3)| p.1 + LIFT_M * normal.as_dvec3();
        let positions: Vec<DVec3> = points.iter().zip(&normals).map(lifted).collect();
        let inside = solids.hold(&positions);
        let names = points.into_iter().map(|p| p.0).collect();
        self.add(name, GroupKind::Points { names }, positions.into_iter().zip(normals), inside);
    }

    fn add(
        &mut self,
        name: String,
        kind: GroupKind,
        points: impl IntoIterator<Item = (DVec3, Vec3)>,
        inside: Vec<bool>,
    ) {
        let start = self.len();
        for (position, normal) in points {
            self.positions.push(position);
            self.normals.push(normal);
        }
        self.is_inside.extend(inside);
        if self.len() > start {
            self.groups.push(Group { name, kind, range: start..self.len() });
        }
    }
}

/// Which points on the ground are inside of `solids`, or where no terrain says how high the ground is, up to [`FOOT_M`] below.
fn hold_ground(grid: &GroundGrid, points: &[DVec3], solids: &Solids) -> Vec<bool> {
    let mut inside = solids.hold(points);
    // Terrain is never level with the grid to the last bit but by chance, and then it does not matter.
    let is_asked = |i: &usize| !inside[*i] && points[*i].z == grid.level;
    let asked: Vec<usize> = (0..points.len()).filter(is_asked).collect();
    let feet: Vec<DVec3> = asked.iter().map(|&i| points[i] + FOOT_M * DVec3::Z).collect();
    for (i, is_below) in asked.into_iter().zip(solids.hold(&feet)) {
        inside[i] = is_below;
    }
    inside
}

/// Rays against the triangles of `casters` whose kind `is_wanted`; part `i` is caster `i`.
fn rays_against(casters: &[Caster], kinds: &[Vec<SurfaceKind>], is_wanted: impl Fn(SurfaceKind) -> bool) -> RayCaster {
    let wanted: Vec<Vec<[u32; 3]>> = casters
        .iter()
        .zip(kinds)
        .map(|(caster, kinds)| {
            let all = caster.mesh.triangles().iter().zip(kinds);
            all.filter(|(_, kind)| is_wanted(**kind)).map(|(triangle, _)| *triangle).collect()
        })
        .collect();
    let parts = casters.iter().zip(&wanted);
    RayCaster::new(parts.map(|(caster, triangles)| (caster.positions.as_slice(), triangles.as_slice())))
}

/// A position seen from above.
fn plan(p: DVec3) -> DVec2 {
    p.truncate()
}
