//! Objects cut so that each part has smooth silhouettes as a whole, or none.
//!
//! A model may be a round body with an open cape on a square base. The cape has no outside, so it has no side to be turned to the light with,
//! and the base has no curves. Each component that has both an outside and a curve is smooth; the others cast the exact shadows of their triangles.

use std::sync::Arc;

use glam::DAffine3;
use rustc_hash::FxHashMap;

use crate::{Caster, Mesh, Object, Scene, Topology};

use super::normals::{corner_normals, is_flat};

/// A part of a mesh, and for each of its vertices the one of the whole.
struct Part {
    mesh: Arc<Mesh>,
    vertices: Vec<u32>,
}

impl Scene {
    /// Splits objects in which some components have smooth silhouettes and others have not, so that [`super::SmoothBody::new`] takes the
    /// ones and refuses the others. Returns how many objects were split.
    ///
    /// Closed components that are inside out where they are, as those of mirrored objects, are turned over before: what is closed has an outside, however it is
    /// wound. A cavity becomes a body of its own, whose shadow is within that of the one around it.
    ///
    /// A component has one if it is closed, consistently wound, and has a corner whose normal is not its triangle's, by the
    /// normals that [`corner_normals`] finds for the mesh at rest from the file's and `crease_rad`. Parts keep the object's name, role, pose and place, the smooth one
    /// first; instances of a mesh share its parts. Roles are to be assigned before ([`Scene::assign_roles`]), as they open what they cut. Linear in the
    /// number of triangles.
    pub fn split_smooth_parts(&mut self, crease_rad: f64) -> usize {
        let objects = std::mem::take(&mut self.objects);
        let whole = objects.len();
        // Meshes are kept, so that no two have one address.
        let mut known: FxHashMap<(*const Mesh, bool), (Arc<Mesh>, Prepared)> = FxHashMap::default();
        for mut object in objects {
            let is_mirrored = object.world_from_object.matrix3.determinant() < 0.0;
            let (_, prepared) = known
                .entry((Arc::as_ptr(&object.mesh), is_mirrored))
                .or_insert_with(|| (object.mesh.clone(), Prepared::new(&object.mesh, is_mirrored, crease_rad)));
            object.mesh = prepared.mesh.clone();
            if prepared.parts.is_empty() {
                self.objects.push(object);
                continue;
            }
            for part in &prepared.parts {
                let pose = object.pose.as_ref().map(|pose| pose.of_vertices(&part.vertices));
                self.objects.push(Object { mesh: part.mesh.clone(), pose, ..object.clone() });
            }
        }
        self.objects.len() - whole
    }
}

/// What becomes of a mesh.
struct Prepared {
    /// Whole, with the outside of its closed components out.
    mesh: Arc<Mesh>,
    /// What of it is smooth and what is not, or nothing where that is all of it.
    parts: Vec<Part>,
}

impl Prepared {
    fn new(mesh: &Arc<Mesh>, is_mirrored: bool, crease_rad: f64) -> Self {
        let mut mesh = mesh.clone();
        let mut topology = Topology::new(&mesh);
        let mut volumes_m3 = closed_volumes_m3(&mesh, &topology, is_mirrored);
        if volumes_m3.iter().any(|&volume_m3| volume_m3 < 0.0) {
            let component_of = topology.component_of_triangle();
            mesh = Arc::new(mesh.turned_over(|t| volumes_m3[component_of[t] as usize] < 0.0));
            volumes_m3.iter_mut().for_each(|volume_m3| *volume_m3 = volume_m3.abs());
            topology = Topology::new(&mesh);
        }
        let caster = Caster::new(&Object::new("", mesh.clone(), DAffine3::IDENTITY), Arc::new(topology));
        let normals = corner_normals(&caster, mesh.corner_normals(), crease_rad);
        let component_of = caster.topology.component_of_triangle();
        let mut is_round = vec![false; volumes_m3.len()];
        for (t, normals) in normals.iter().enumerate() {
            is_round[component_of[t] as usize] |= !is_flat(&caster, t, normals);
        }
        let is_smooth: Vec<bool> = is_round.iter().zip(volumes_m3).map(|(&round, v)| round && v > 0.0).collect();
        if is_smooth.iter().all(|&smooth| smooth == is_smooth[0]) {
            return Self { mesh, parts: Vec::new() };
        }
        let part = |wanted: bool| {
            let (mesh, vertices) = mesh.part(|t| is_smooth[component_of[t] as usize] == wanted);
            Part { mesh: Arc::new(mesh), vertices }
        };
        Self { parts: vec![part(true), part(false)], mesh }
    }
}

/// What each component of `mesh` encloses where it is; 0 if it is open, and below 0 if its outside is in.
fn closed_volumes_m3(mesh: &Mesh, topology: &Topology, is_mirrored: bool) -> Vec<f64> {
    let components = topology.components();
    let mut volumes_m3 = vec![0.0; components.len()];
    let middle = mesh.bounds().center();
    for (corners, &component) in mesh.triangles().iter().zip(topology.component_of_triangle()) {
        if components[component as usize].is_closed {
            let [a, b, c] = corners.map(|v| mesh.positions()[v as usize].as_dvec3() - middle);
            volumes_m3[component as usize] += a.dot(b.cross(c)) / if is_mirrored { -6.0 } else { 6.0 };
        }
    }
    volumes_m3
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3, Vec3Swizzles as _};

    use super::*;
    use crate::smooth::{NotSmooth, SmoothBody, SmoothVolume, Smoothness, given_normals};
    use crate::{Deformer, Influence, LightPosition, Pose, Surface, shapes};

    const CREASE_RAD: f64 = 0.76;

    fn together(surfaces: impl IntoIterator<Item = Surface>) -> Arc<Mesh> {
        let mut all = Surface::default();
        for (material, surface) in surfaces.into_iter().enumerate() {
            let first = all.positions.len() as u32;
            all.triangle_materials.extend(std::iter::repeat_n(material as u32, surface.triangles.len()));
            all.positions.extend(surface.positions);
            all.triangles.extend(surface.triangles.iter().map(|corners| corners.map(|v| first + v)));
        }
        Arc::new(Mesh::new(all).expect("good shapes"))
    }

    /// A box, a ball, a sheet and a ball turned inside out, far from each other.
    fn mixed() -> Arc<Mesh> {
        let mut turned = shapes::icosphere(Vec3::Y * 9.0, 1.0, 1);
        turned.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
        together([
            shapes::cuboid(Vec3::splat(4.0), Vec3::splat(5.0)),
            shapes::icosphere(Vec3::ZERO, 1.0, 2),
            shapes::sheet(Vec3::splat(-5.0), Vec3::X, Vec3::Y, [2, 3]),
            turned,
        ])
    }

    /// The file's, as they are where the object is.
    fn corner_normals_of(caster: &Caster, object: &Object) -> Vec<[Vec3; 3]> {
        corner_normals(caster, &given_normals(object), CREASE_RAD)
    }

    fn body_of(object: &Object) -> Result<SmoothBody, NotSmooth> {
        let caster = Caster::new(object, Arc::new(Topology::new(&object.mesh)));
        SmoothBody::new(&caster, &corner_normals(&caster, object.mesh.corner_normals(), CREASE_RAD))
    }

    #[test]
    fn what_is_mirrored_has_its_outside_out_and_the_mirrored_silhouette() {
        let ball = shapes::icosphere(Vec3::ZERO, 1.0, 2);
        // Not those of its faces, and not what would be computed.
        let normal = |p: Vec3| (p + Vec3::new(0.2, 0.1, 0.0)).normalize_or_zero();
        let corner_normals = ball.triangles.iter().map(|t| t.map(|v| normal(ball.positions[v as usize]))).collect();
        let mesh = Arc::new(Mesh::new(Surface { corner_normals, ..ball }).expect("a good shape"));
        let placed = |x: f64| Object::new("", mesh.clone(), DAffine3::from_scale(DVec3::new(x, 1.0, 1.0)));
        let mut scene = Scene { objects: vec![placed(1.0), placed(-1.0), placed(-1.0)], ..Scene::default() };
        let silhouette = |object: &Object, x: f64| {
            let caster = Caster::new(object, Arc::new(Topology::new(&object.mesh)));
            let normals = corner_normals_of(&caster, object);
            let body = SmoothBody::new(&caster, &normals).expect("it is round, and its outside is out");
            let light = LightPosition::directional(DVec3::new(0.3 * x, 0.2, 1.0)).expect("not zero");
            let volume = SmoothVolume::new(&body, light, &Smoothness::Accurate);
            // To a tenth of a millimetre; mirrored again, so that both are the same.
            let rounded = |p: Vec3| (Vec3::new(p.x * x as f32, p.y, p.z) * 1e4).round().as_ivec3().to_array();
            let mut points: Vec<[i32; 3]> =
                volume.sides.iter().map(|&[from, _]| rounded(volume.points[from as usize])).collect();
            points.sort_unstable();
            points
        };
        assert_eq!(body_of(&scene.objects[1]).err(), Some(NotSmooth::InsideOut));
        // Once is enough.
        for _ in 0..2 {
            scene.split_smooth_parts(CREASE_RAD);
            assert_eq!(silhouette(&scene.objects[1], -1.0), silhouette(&scene.objects[0], 1.0));
            assert!(Arc::ptr_eq(&scene.objects[1].mesh, &scene.objects[2].mesh), "instances share a mesh");
            assert!(Arc::ptr_eq(&scene.objects[0].mesh, &mesh));
        }
    }

    #[test]
    fn what_is_inside_out_is_turned_over_and_split_as_what_is_not() {
        let over = |mesh: &Arc<Mesh>| Arc::new(mesh.turned_over(|_| true));
        let of = |mesh: Arc<Mesh>, x: f64| {
            let object = Object::new("", mesh, DAffine3::from_scale(DVec3::new(x, 1.0, 1.0)));
            let mut scene = Scene { objects: vec![object], ..Scene::default() };
            let split = scene.split_smooth_parts(CREASE_RAD);
            let smooth = |object: &Object| body_of(object).is_ok();
            (split, scene.objects.iter().map(|o| (o.mesh.triangles().len(), smooth(o))).collect::<Vec<_>>())
        };
        let expected = of(mixed(), 1.0);
        assert_eq!((expected.0, expected.1[0].1), (1, true));
        assert_eq!(of(mixed(), -1.0), expected);
        assert_eq!(of(over(&mixed()), 1.0), expected);
        assert_eq!(of(over(&mixed()), -1.0), expected);
        let ball = together([shapes::icosphere(Vec3::ZERO, 1.0, 2)]);
        assert_eq!(of(over(&ball), 1.0), (0, vec![(ball.triangles().len(), true)]));
    }

    #[test]
    fn the_balls_are_smooth_and_what_is_flat_or_open_is_not() {
        let object = Object::new("still life", mixed(), DAffine3::IDENTITY);
        assert_eq!(body_of(&object).err(), Some(NotSmooth::Open));
        let mut scene = Scene { objects: vec![object.clone()], ..Scene::default() };
        assert_eq!(scene.split_smooth_parts(CREASE_RAD), 1);
        let [balls, rest] = scene.objects.as_slice() else { panic!("two parts") };
        assert!(body_of(balls).is_ok() && body_of(rest).is_err());
        assert_eq!([&balls.name, &rest.name], ["still life"; 2]);
        // The ball that was inside out among them.
        assert!([1, 3].iter().all(|material| balls.mesh.triangle_materials().contains(material)));
        assert!(balls.mesh.triangle_materials().iter().all(|material| [1, 3].contains(material)));
        assert_eq!(rest.mesh.triangle_materials().iter().filter(|&&material| material == 0).count(), 12);
        assert_eq!(balls.mesh.triangles().len() + rest.mesh.triangles().len(), object.mesh.triangles().len());
        assert_eq!(scene.split_smooth_parts(CREASE_RAD), 0, "once is enough");
    }

    #[test]
    fn what_is_all_smooth_or_all_not_stays_whole() {
        let balls = [0.0, 3.0].map(|x| shapes::icosphere(Vec3::X * x, 1.0, 1));
        let flat = [shapes::cuboid(Vec3::ZERO, Vec3::ONE), shapes::sheet(Vec3::splat(-5.0), Vec3::X, Vec3::Y, [1, 1])];
        let objects = [together(balls), together(flat)].map(|mesh| Object::new("", mesh, DAffine3::IDENTITY));
        let mut scene = Scene { objects: objects.to_vec(), ..Scene::default() };
        assert_eq!(scene.split_smooth_parts(CREASE_RAD), 0);
        assert!(scene.objects.iter().zip(&objects).all(|(a, b)| Arc::ptr_eq(&a.mesh, &b.mesh)));
    }

    #[test]
    fn parts_are_posed_and_placed_as_the_whole_and_instances_share_them() {
        let mesh = mixed();
        let vertices = mesh.positions().len() as u32;
        let weighted = |joint: u32| [Influence { joint, weight: 0.25 }, Influence { joint: 1 - joint, weight: 0.75 }];
        let deformer = Arc::new(Deformer {
            morph_offsets: vec![mesh.positions().iter().map(|p| p.yzx()).collect()],
            influence_ranges: (0..vertices).map(|v| [2 * v, 2 * v + 2]).collect(),
            influences: (0..vertices).flat_map(|v| weighted(v % 2)).collect(),
        });
        let joints = vec![DAffine3::from_rotation_x(0.3), DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0))];
        let pose = Some(Pose { deformer, morph_weights: vec![0.4], joints });
        let placed = Object {
            pose,
            world_from_object: DAffine3::from_rotation_z(1.0),
            ..Object::new("whole", mesh.clone(), DAffine3::IDENTITY)
        };
        let other = Object::new("other", mesh, DAffine3::from_translation(DVec3::Y));
        let mut scene = Scene { objects: vec![placed.clone(), other], ..Scene::default() };
        assert_eq!(scene.split_smooth_parts(CREASE_RAD), 2);
        assert!((0..2).all(|i| Arc::ptr_eq(&scene.objects[i].mesh, &scene.objects[i + 2].mesh)));
        let corners = |objects: &[Object]| {
            let mut all: Vec<[[u64; 3]; 3]> = Vec::new();
            for object in objects {
                let places: Vec<DVec3> = object.positions().collect();
                let bits = |v: u32| places[v as usize].to_array().map(f64::to_bits);
                all.extend(object.mesh.triangles().iter().map(|corners| {
                    // Some are turned over.
                    let mut corners = corners.map(bits);
                    corners.sort_unstable();
                    corners
                }));
            }
            all.sort_unstable();
            all
        };
        assert_eq!(corners(&scene.objects[..2]), corners(&[placed]));
    }
}
