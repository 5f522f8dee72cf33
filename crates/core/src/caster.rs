//! An object made ready to cast: scene-space positions and what is known about their edges.

use std::sync::Arc;

use glam::Vec3;
use rustc_hash::FxHashMap;

use crate::{Bounds, Mesh, Object, Role, Scene, Topology};

/// One object of a scene with its positions in scene space, rounded once to the `f32` that everything uses:
/// silhouettes, volumes, the GPU and the ray caster see the same bits.
#[derive(Debug, Clone)]
pub struct Caster {
    /// The object's name.
    pub name: String,
    /// Triangles, colours and materials; its positions are in object space.
    pub mesh: Arc<Mesh>,
    /// Shared between the instances of a mesh.
    pub topology: Arc<Topology>,
    /// Scene space, metres; one for each of the mesh's positions.
    pub positions: Vec<Vec3>,
    /// Holds `positions`.
    pub bounds: Bounds,
    /// What it does in a picture.
    pub role: Role,
    /// For each triangle the unit normals, scene space, of the surface that it stands for, at its corners: it is shaded as if it were curved.
    /// Empty where all triangles are flat, as a new caster's are; a triangle with a zero among its three is flat too.
    ///
    /// This says how surfaces look and where their lit side ends; what casts is the triangles.
    pub shading_normals: Vec<[Vec3; 3]>,
}

impl Caster {
    /// The caster of `object`, whose mesh has `topology`.
    pub fn new(object: &Object, topology: Arc<Topology>) -> Self {
        let mut caster = Self {
            name: object.name.clone(),
            mesh: object.mesh.clone(),
            topology,
            positions: Vec::new(),
            bounds: Bounds::EMPTY,
            role: object.role,
            shading_normals: Vec::new(),
        };
        caster.pose_to(object);
        caster
    }

    /// Moves the caster to where `object` is now, which must show the same mesh as the one that it was made of; takes no new memory.
    ///
    /// It is flat then, until it is given the normals of where it is.
    pub fn pose_to(&mut self, object: &Object) {
        self.shading_normals.clear();
        self.positions.clear();
        // Adding +0 turns -0 into +0, as welding did.
        self.positions.extend(object.positions().map(|p| p.as_vec3() + Vec3::ZERO));
        self.bounds = Bounds::of_points(self.positions.iter().map(|p| p.as_dvec3()));
    }

    /// The casters of every object of `scene`, in order; the topology of a shared mesh is found once.
    pub fn of_scene(scene: &Scene) -> Vec<Self> {
        let mut topology_of_mesh: FxHashMap<*const Mesh, Arc<Topology>> = FxHashMap::default();
        scene
            .objects
            .iter()
            .map(|object| {
                let topology = topology_of_mesh
                    .entry(Arc::as_ptr(&object.mesh))
                    .or_insert_with(|| Arc::new(Topology::new(&object.mesh)));
                Self::new(object, topology.clone())
            })
            .collect()
    }

    /// The smallest box that holds all `casters`; empty without any.
    pub fn bounds_of(casters: &[Self]) -> Bounds {
        casters.iter().fold(Bounds::EMPTY, |all, caster| all.union(caster.bounds))
    }

    /// The normals with which triangle `t` is shaded at its corners; `None` where it is flat.
    pub fn shading_normals_of(&self, t: usize) -> Option<[Vec3; 3]> {
        let is_given = |normal: &Vec3| normal.is_finite() && *normal != Vec3::ZERO;
        self.shading_normals.get(t).filter(|normals| normals.iter().all(is_given)).copied()
    }

    /// Corner positions of triangle `t`.
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.mesh.triangles()[t].map(|i| self.positions[i as usize])
    }
}
