//! What a `case.toml` says, and the picture of it.

use std::sync::Arc;

use anyhow::Context as _;
use glam::{DAffine3, Vec2};
use image::RgbImage;
use serde::Deserialize;
use umbrae::lights::{LampChoice, LampPlace, lights, reaching};
use umbrae::view::{ViewChoice, add_ground, camera, ground_under};
use umbrae_core::{Caster, Light, LightPosition, Material, Mesh, Object, Scene, Surface, shapes};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Look, Renderer, Shot};

/// A picture to draw, as `umbrae render` would.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Case {
    /// What the picture proves, and what it would show if that went wrong.
    pub(crate) why: String,
    size_px: [u32; 2],
    #[serde(default = "four")]
    samples: u32,
    #[serde(default = "yes")]
    ground: bool,
    camera: CameraInCase,
    sun: Option<Sun>,
    /// Lamps as with `--point`.
    #[serde(default)]
    points_m: Vec<[f64; 3]>,
    /// Lamps of the model, which shine where there is neither a sun nor a point.
    #[serde(default)]
    lamps: Vec<Lamp>,
    objects: Vec<ObjectInCase>,
    #[serde(default)]
    pub(crate) tolerance: Tolerance,
}

/// How far a picture may be from the expected one.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Tolerance {
    /// Levels out of 255 that a channel may differ. Drivers round colours differently.
    pub(crate) channel: u8,
    /// Pixels that may differ by more: along edges, drivers may cover another sample.
    pub(crate) outliers: usize,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { channel: 2, outliers: 12 }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraInCase {
    eye_m: [f64; 3],
    target_m: [f64; 3],
    fov_y_deg: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sun {
    azimuth_deg: f64,
    altitude_deg: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Lamp {
    at_m: [f64; 3],
    /// Linear colour times irradiance at 1 m.
    strength: [f32; 3],
}

/// One mesh, in one place or several.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectInCase {
    /// Welded into one mesh.
    parts: Vec<Part>,
    /// Linear reflectance.
    #[serde(default = "light_grey")]
    base_color: [f32; 3],
    #[serde(default = "one_place")]
    places: Vec<Place>,
}

/// Where an instance stands; a negative scale mirrors it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Place {
    offset_m: [f64; 3],
    scale: [f64; 3],
}

/// See [`shapes`].
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum Part {
    Cuboid { min_m: [f32; 3], max_m: [f32; 3] },
    Prism { outline_m: Vec<[f32; 2]>, bottom_m: f32, top_m: f32 },
    Icosphere { center_m: [f32; 3], radius_m: f32, subdivisions: u32 },
    Torus { center_m: [f32; 3], major_radius_m: f32, minor_radius_m: f32, segments: [usize; 2] },
    Sheet { corner_m: [f32; 3], edge_u_m: [f32; 3], edge_v_m: [f32; 3] },
}

fn four() -> u32 {
    4
}

fn yes() -> bool {
    true
}

fn light_grey() -> [f32; 3] {
    Material::default().base_color.to_array()
}

fn one_place() -> Vec<Place> {
    vec![Place { offset_m: [0.0; 3], scale: [1.0; 3] }]
}

impl Case {
    /// The picture, drawn in software: cards differ along edges, and a machine for tests may have none.
    ///
    /// # Errors
    ///
    /// When the case makes no picture, or there is no driver.
    pub(crate) fn draw(&self) -> anyhow::Result<RgbImage> {
        let mut scene = self.scene()?;
        let model = scene.bounds();
        let choice = ViewChoice {
            size_px: self.size_px,
            eye: Some(self.camera.eye_m.into()),
            target: Some(self.camera.target_m.into()),
            fov_deg: Some(self.camera.fov_y_deg),
            camera_name: None,
            spheres: Vec::new(),
        };
        let sun = self.sun.as_ref();
        let sun = sun.map(|&Sun { azimuth_deg, altitude_deg }| LampPlace::Sun { azimuth_deg, altitude_deg });
        let points = self.points_m.iter().map(|&point| LampPlace::Point(point.into()));
        let lamps: Vec<LampChoice> = sun.into_iter().chain(points).map(LampChoice::new).collect();
        let ground = self.ground.then(|| ground_under(&model));
        let camera = camera(&choice, &scene, &model, ground.as_ref())?;
        let lights = lights(&lamps, &scene, &model);
        let look = Look::for_model(&model, &lights);
        let lights = reaching(lights, look.exposure);
        if let Some(ground) = &ground {
            add_ground(&mut scene, ground);
        }
        let casters = Caster::of_scene(&scene);

        let gpu = pollster::block_on(Gpu::new(&AdapterChoice { name: None, is_software: true }))?;
        let renderer = Renderer::new(gpu, self.samples);
        let gpu_scene = GpuScene::new(renderer.gpu(), &casters, &scene.materials, &scene.textures)?;
        let shot = Shot { look: &look, ..Shot::new(&gpu_scene, &casters, &camera, &lights) };
        let drawn = renderer.picture(&shot);
        let rgb =
            pollster::block_on(drawn)?.rgba.chunks_exact(4).flat_map(|rgba| [rgba[0], rgba[1], rgba[2]]).collect();
        RgbImage::from_raw(self.size_px[0], self.size_px[1], rgb)
            .context("the picture has another size than was asked for")
    }

    fn scene(&self) -> anyhow::Result<Scene> {
        let mut scene = Scene::default();
        for (i, object) in self.objects.iter().enumerate() {
            let name = format!("object {i}");
            let mut surface = shapes::joined(object.parts.iter().map(Part::surface));
            surface.triangle_materials = vec![i as u32; surface.triangles.len()];
            let mesh = Arc::new(Mesh::new(surface).with_context(|| name.clone())?);
            scene.materials.push(Material::new(name.clone(), object.base_color.into()));
            scene.objects.extend(object.places.iter().map(|place| {
                let world_from_object =
                    DAffine3::from_translation(place.offset_m.into()) * DAffine3::from_scale(place.scale.into());
                Object::new(name.clone(), mesh.clone(), world_from_object)
            }));
        }
        scene.lights.extend(self.lamps.iter().enumerate().map(|(i, lamp)| {
            let position = LightPosition::point(lamp.at_m.into());
            Light::new(format!("lamp {i}"), position, lamp.strength.into())
        }));
        Ok(scene)
    }
}

impl Part {
    fn surface(&self) -> Surface {
        match *self {
            Self::Cuboid { min_m, max_m } => shapes::cuboid(min_m.into(), max_m.into()),
            Self::Prism { ref outline_m, bottom_m, top_m } => {
                let outline: Vec<Vec2> = outline_m.iter().map(|&corner| corner.into()).collect();
                shapes::prism(&outline, bottom_m, top_m)
            }
            Self::Icosphere { center_m, radius_m, subdivisions } => {
                shapes::icosphere(center_m.into(), radius_m, subdivisions)
            }
            Self::Torus { center_m, major_radius_m, minor_radius_m, segments: [major, minor] } => {
                shapes::torus(center_m.into(), major_radius_m, minor_radius_m, major, minor)
            }
            Self::Sheet { corner_m, edge_u_m, edge_v_m } => {
                shapes::sheet(corner_m.into(), edge_u_m.into(), edge_v_m.into(), [1, 1])
            }
        }
    }
}
