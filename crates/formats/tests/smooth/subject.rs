//! A real model, its smooth silhouettes, and the finely cut surface that has its shadow.

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec2, Vec3};
use umbrae_core::{
    Bounds, Caster, Chain, Counting, LightPosition, Mesh, Object, Precision, RayCaster, ShadowVolume, SmoothBody,
    SmoothVolume, Smoothness, Surface, Topology, corner_normals,
};
use umbrae_formats::{LoadOptions, load};

/// Edges that bend less are round.
pub(crate) const CREASE_RAD: f64 = 0.76;

/// How far a smooth silhouette may be from its curves, in radii of the body.
const EPSILON: f64 = 5e-4;

/// A shadow is thin where it is gone as soon as the curved surface is moved inward by so much, in radii of the body.
pub(crate) const THIN: f64 = 2e-3;

/// Part of a model that is smooth, or not, as a whole.
pub(crate) struct Part {
    /// In scene space, with texture coordinates that tell where on its triangle a point is.
    pub(crate) caster: Caster,
    pub(crate) normals: Vec<[Vec3; 3]>,
    /// With the curved surface, cut finely, whose texture coordinates are those of the caster.
    pub(crate) smooth: Option<(SmoothBody, Mesh)>,
}

/// A model and what rays say of its curved surface.
pub(crate) struct Subject {
    pub(crate) parts: Vec<Part>,
    /// Through the curved surface, or the triangles where there is none.
    pub(crate) rays: RayCaster,
    /// The same, moved inward a little.
    thinner: RayCaster,
    /// Of the curved surface.
    pub(crate) bounds: Bounds,
    pub(crate) radius_m: f64,
}

/// One part's shadow volumes under one light.
pub(crate) struct Lit {
    /// What its vertices are indices of.
    pub(crate) positions: Vec<Vec3>,
    pub(crate) smooth: ShadowVolume,
    pub(crate) discrete: ShadowVolume,
}

impl Subject {
    /// The model in `file`, in the middle of what moves it, if anything does, with a curved surface whose edges are cut into `pieces`.
    pub(crate) fn new(file: &Path, pieces: u32) -> Self {
        let mut model = load(file, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let playing = model.animations.choose(None).expect("what a file plays of itself");
        let middle_s = 0.4 * playing.duration_s();
        model.animations.pose(&mut model.scene, &playing, middle_s).expect("its own scene");
        model.scene.split_smooth_parts(CREASE_RAD);
        let parts: Vec<Part> = model.scene.objects.iter().map(|object| Part::new(object, pieces)).collect();
        let meshes = || parts.iter().map(Part::finest);
        let rays = RayCaster::new(meshes().map(|(positions, mesh)| (positions, mesh.triangles())));
        let points = meshes().flat_map(|(positions, _)| positions).map(|p| p.as_dvec3());
        let bounds = Bounds::of_points(points);
        let inward_m = THIN * bounds.radius();
        let moved: Vec<Vec<Vec3>> = meshes().map(|(positions, mesh)| moved_inward(positions, mesh, inward_m)).collect();
        let thinner = moved.iter().zip(meshes()).map(|(positions, (_, mesh))| (positions.as_slice(), mesh.triangles()));
        let thinner = RayCaster::new(thinner);
        Self { parts, rays, thinner, bounds, radius_m: bounds.radius() }
    }

    /// So many suns and lamps, far, near and very near, from all sides.
    pub(crate) fn lights(&self, count: u32) -> Vec<LightPosition> {
        let (middle, radius_m) = (self.bounds.center(), self.radius_m);
        let of = |i: u32| {
            let i = i * 64 / count;
            let (sin, cos) = (0.7 * f64::from(i)).sin_cos();
            let way = DVec3::new(cos, sin, 0.09 * f64::from(i % 21) - 0.9);
            let lamp = |distance: f64| LightPosition::point(middle + way.normalize_or_zero() * (distance * radius_m));
            match i % 4 {
                0 | 2 => LightPosition::directional(way).expect("not zero"),
                1 => lamp(3.1),
                _ => lamp(if i % 8 == 3 { 30.0 } else { 1.3 }),
            }
        };
        (0..count).map(of).collect()
    }

    /// Of the curved surface.
    pub(crate) fn finest_points(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.parts.iter().flat_map(|part| part.finest().0).map(|p| p.as_dvec3())
    }

    /// Each part's volumes under `light`.
    pub(crate) fn lit(&self, light: LightPosition) -> Vec<Lit> {
        self.parts.iter().map(|part| part.lit(light, EPSILON * self.radius_m)).collect()
    }

    /// Whether something of the curved surface is between `point` and `light`.
    pub(crate) fn is_blocked(&self, point: DVec3, light: LightPosition) -> bool {
        is_hit(&self.rays, point, light)
    }

    /// The same where the surface is thinner.
    pub(crate) fn is_blocked_amply(&self, point: DVec3, light: LightPosition) -> bool {
        is_hit(&self.thinner, point, light)
    }
}

fn is_hit(rays: &RayCaster, point: DVec3, light: LightPosition) -> bool {
    let end = if light.is_directional() { f64::INFINITY } else { 1.0 };
    rays.is_hit(point, light.offset_from(point), 0.0, end)
}

/// `positions` of `mesh`, each moved against the mean normal of the triangles around it.
fn moved_inward(positions: &[Vec3], mesh: &Mesh, by_m: f64) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|v| positions[v as usize].as_dvec3());
        corners.iter().for_each(|&v| sums[v as usize] += (b - a).cross(c - a));
    }
    let moved = |(p, sum): (&Vec3, DVec3)| (p.as_dvec3() - sum.normalize_or_zero() * by_m).as_vec3();
    positions.iter().zip(sums).map(moved).collect()
}

impl Part {
    fn new(object: &Object, pieces: u32) -> Self {
        let posed = Caster::new(object, Arc::new(Topology::new(&object.mesh)));
        let mesh = Mesh::new(Surface {
            positions: posed.positions.clone(),
            triangles: posed.mesh.triangles().to_vec(),
            corner_uvs: vec![[Vec2::ZERO, Vec2::X, Vec2::Y]; posed.mesh.triangles().len()],
            weld_keys: (0..posed.positions.len() as u32).collect(),
            ..Surface::default()
        })
        .expect("it is as good as it was");
        let object = Object::new(object.name.as_str(), Arc::new(mesh), DAffine3::IDENTITY);
        let caster = Caster::new(&object, Arc::new(Topology::new(&object.mesh)));
        // The files' own normals are those of flat faces, where they have any.
        let normals = corner_normals(&caster, &[], CREASE_RAD);
        let body = SmoothBody::new(&caster, &normals).ok();
        let smooth = body.map(|body| {
            let finer = body.tessellated(&caster, pieces).expect("it is not too large");
            (body, finer)
        });
        Self { caster, normals, smooth }
    }

    fn finest(&self) -> (&[Vec3], &Mesh) {
        match &self.smooth {
            Some((_, finer)) => (finer.positions(), finer),
            None => (&self.caster.positions, &self.caster.mesh),
        }
    }

    fn lit(&self, light: LightPosition, epsilon_m: f64) -> Lit {
        let chain = Chain::new(&self.caster, light, &Counting::outside(&self.caster));
        let discrete = ShadowVolume::new(&self.caster, &chain);
        let Some((body, _)) = &self.smooth else {
            let positions = self.caster.positions.clone();
            return Lit { positions, smooth: discrete.clone(), discrete };
        };
        let smoothness = Smoothness::Smooth(Precision::in_world(epsilon_m));
        let (positions, smooth) = SmoothVolume::new(body, light, &smoothness).flattened(body, &self.caster);
        Lit { positions, smooth, discrete }
    }
}
