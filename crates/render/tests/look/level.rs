//! Squares on a level, seen from straight above.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec2, Vec3};
use umbrae_core::{Camera, Caster, Light, LightPosition, Material, Mesh, Object, Role, Scene, Surface, Texture, Wrap};
use umbrae_render::{AdapterChoice, Gpu, GpuScene, Renderer, ShadowOptions, Shot};

/// Pixels a side. The view holds -5 to 5 m in x and y at height 0, north up.
pub(crate) const SIDE_PX: usize = 120;

/// A scene of squares in the making.
#[derive(Default)]
pub(crate) struct Level(pub(crate) Scene);

impl Level {
    pub(crate) fn material(&mut self, material: Material) -> u32 {
        self.0.materials.push(material);
        self.0.materials.len() as u32 - 1
    }

    pub(crate) fn texture(&mut self, texture: Texture) -> u32 {
        self.0.textures.push(Arc::new(texture));
        self.0.textures.len() as u32 - 1
    }

    /// A square of 2 `half_m` a side about the middle at this height. `uvs` are its texture coordinates at the north-west and the south-east.
    pub(crate) fn square(&mut self, half_m: f32, height_m: f32, material: u32, uvs: [Vec2; 2]) -> &mut Self {
        let [start, end] = uvs;
        let corner = |x: f32, y: f32| Vec3::new(x * half_m, y * half_m, height_m);
        let uv = |x: f32, y: f32| start + (end - start) * Vec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y);
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let uvs = corners.map(|[x, y]| uv(x, y));
        let surface = Surface {
            positions: corners.map(|[x, y]| corner(x, y)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_materials: vec![material; 2],
            corner_uvs: vec![[uvs[0], uvs[1], uvs[2]], [uvs[0], uvs[2], uvs[3]]],
            ..Surface::default()
        };
        let mesh = Mesh::new(surface).expect("a square");
        self.0.objects.push(Object::new("square", Arc::new(mesh), DAffine3::IDENTITY));
        self
    }

    /// Gives everything the role of its material.
    pub(crate) fn with_roles(mut self) -> Self {
        self.0.assign_roles(|_, material| Role::of_material(material));
        self
    }

    /// One colour everywhere.
    pub(crate) fn plain(color: Vec3) -> Self {
        let mut level = Self::default();
        let material = level.material(Material::new("plain", color));
        level.square(5.0, 0.0, material, [Vec2::ZERO; 2]);
        level
    }
}

/// Draws levels.
pub(crate) struct Above {
    renderer: Renderer,
    camera: Camera,
}

impl Above {
    pub(crate) fn new(samples: u32) -> Self {
        let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))
            .expect("tests need a graphics driver: run scripts/setup.sh");
        let size_px = [SIDE_PX as u32; 2];
        let fov_rad = 2.0 * 0.5_f64.atan();
        let camera = Camera::with_up(DVec3::Z * 10.0, DVec3::ZERO, DVec3::Y, fov_rad, 1.0, size_px);
        Self { renderer: Renderer::new(gpu, samples), camera: camera.expect("a good camera") }
    }

    fn drawn<T>(&self, level: &Level, lights: &[Light], draw: impl AsyncFnOnce(&Renderer, &Shot<'_>) -> T) -> T {
        let casters = Caster::of_scene(&level.0);
        let uploaded = GpuScene::new(self.renderer.gpu(), &casters, &level.0.materials, &level.0.textures);
        let uploaded = uploaded.expect("a small scene");
        let shadows = ShadowOptions { soft: true, ..ShadowOptions::default() };
        let shot = Shot { shadows, ..Shot::new(&uploaded, &casters, &self.camera, lights) };
        pollster::block_on(draw(&self.renderer, &shot))
    }

    /// Row by row from the north.
    pub(crate) fn picture(&self, level: &Level, lights: &[Light]) -> Vec<[u8; 3]> {
        let drawn = self.drawn(level, lights, async |renderer, shot| renderer.picture(shot).await);
        drawn.expect("a picture").rgba.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
    }

    /// The verdicts on one light.
    pub(crate) fn mask(&self, level: &Level, light: &Light) -> Vec<u8> {
        let drawn = self.drawn(level, &[], async |renderer, shot| renderer.mask(shot, light).await);
        drawn.expect("a mask").verdicts
    }
}

/// Where at height 0 the centre of a pixel is.
pub(crate) fn place(pixel: usize) -> DVec3 {
    let to_m = |i: usize| (i as f64 + 0.5) * 10.0 / SIDE_PX as f64 - 5.0;
    DVec3::new(to_m(pixel % SIDE_PX), -to_m(pixel / SIDE_PX), 0.0)
}

/// Light from the zenith, the same everywhere.
pub(crate) fn zenith() -> Light {
    Light::new("zenith", LightPosition::directional(DVec3::Z).expect("a direction"), Vec3::splat(0.5))
}

/// A picture of squares, without blending.
pub(crate) fn texture(width: u32, texels: &[[u8; 4]]) -> Texture {
    Texture {
        name: "test".to_owned(),
        size_px: [width, texels.len() as u32 / width],
        rgba: texels.concat(),
        wrap: [Wrap::Repeat; 2],
        is_nearest: true,
    }
}
