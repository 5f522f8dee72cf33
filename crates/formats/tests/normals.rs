//! The normals of real models stand on their faces.

mod shared_data;

use glam::Vec3;
use umbrae_core::Mesh;
use umbrae_formats::{LoadOptions, load};

/// Files with normals, and whether their exporters gave each corner of a flat face the face's own.
const MODELS: [(&str, bool); 12] = [
    ("gltf/Box.glb", true),
    ("gltf/BoxInterleaved.glb", true),
    ("gltf/BoxAnimated.glb", true),
    ("gltf/CesiumMan.glb", false),
    ("gltf/Lantern.glb", false),
    ("gltf/MetalRoughSpheresNoTextures.glb", false),
    ("gltf/Suzanne.glb", false),
    ("gltf/WaterBottle.glb", false),
    ("mesh/bunny_closed.obj", true),
    ("mesh/cube.obj", true),
    ("mesh/quadknot.obj", false),
    ("mesh/spot_low_resolution.obj", true),
];

/// A coarse mesh of a round body: at its sharpest corners a normal is as far from the face's as this.
const MIN_MEAN_COSINE: f32 = 0.9;

/// For each corner with a normal, the cosine between that and the normal of its triangle.
fn cosines(mesh: &Mesh) -> Vec<f32> {
    let of_triangle = |(corners, normals): (&[u32; 3], &[Vec3; 3])| {
        let [a, b, c] = corners.map(|v| mesh.positions()[v as usize]);
        let flat = (b - a).cross(c - a).try_normalize();
        let usable = normals.iter().filter(|normal| **normal != Vec3::ZERO).copied();
        flat.map_or(Vec::new(), |flat| usable.map(|normal| normal.dot(flat)).collect())
    };
    mesh.triangles().iter().zip(mesh.corner_normals()).flat_map(of_triangle).collect()
}

#[test]
fn normals_of_real_models_are_at_their_own_corners() {
    let Some(folder) = shared_data::folder() else { return };
    for (file, is_flat) in MODELS {
        let options = LoadOptions { normals: true, ..LoadOptions::default() };
        let model = load(&folder.join(file), &options).unwrap_or_else(|error| panic!("{error}"));
        let cosines: Vec<f32> = model.scene.objects.iter().flat_map(|object| cosines(&object.mesh)).collect();
        let corners = 3 * model.scene.objects.iter().map(|object| object.mesh.triangles().len()).sum::<usize>();
        assert!(cosines.len() > corners * 9 / 10, "{file}: {} of {corners} corners have a normal", cosines.len());
        let mean = cosines.iter().sum::<f32>() / cosines.len() as f32;
        let least = cosines.iter().copied().fold(1.0, f32::min);
        assert!(if is_flat { least > 0.9999 } else { mean > MIN_MEAN_COSINE }, "{file}: {mean}, {least}");
    }
}
