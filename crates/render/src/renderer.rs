//! A scene, a camera and lights into a picture or a mask.

use std::sync::OnceLock;

use umbrae_core::{Camera, Caster, Extent, Light, Sphere};

use crate::frame::{self, Frame, Passes};
use crate::passes::{
    GlassPass, GpuOverlay, Layouts, LightPass, OverlayPass, SpherePass, SurfacePass, TonePass, uniform_group,
};
use crate::prepared::PreparedLights;
use crate::shadow::{ShadowLight, ShadowTarget, Shadows, Tally, TallyKind};
use crate::soft::SoftLightPass;
use crate::targets::{Output, PICTURE_FORMAT};
use crate::timing::PassTimer;
use crate::uniforms::{LightUniform, View};
use crate::{Gpu, GpuError, GpuScene, LightReport, Look, Overlay, PassTime, ShadowOptions, SilhouetteSource, Targets};

/// Draws pictures and masks, with pipelines compiled once.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    layouts: Layouts,
    picture: Passes,
    mask: Passes,
    tally: Tally,
    glass: GlassPass,
    overlay: OverlayPass,
    tone: TonePass,
    samples: u32,
    format: wgpu::TextureFormat,
}

/// What a frame shows; all borrowed.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// `casters`, uploaded.
    pub scene: &'a GpuScene,
    /// What is drawn and casts.
    pub casters: &'a [Caster],
    /// Drawn and casting besides, as they are and not as triangles.
    pub spheres: &'a [Sphere],
    /// The eye; its size is the target's.
    pub camera: &'a Camera,
    /// Any number.
    pub lights: &'a [Light],
    /// How shadows are determined.
    pub shadows: ShadowOptions,
    /// Exposure and fading.
    pub look: &'a Look,
    /// Drawn last, over the lit picture; masks and tallies leave it out.
    pub overlay: Option<&'a Overlay>,
}

impl<'a> Shot<'a> {
    /// With default shadows, neither spheres, exposure nor fading, and nothing laid over.
    pub fn new(scene: &'a GpuScene, casters: &'a [Caster], camera: &'a Camera, lights: &'a [Light]) -> Self {
        Self {
            scene,
            casters,
            spheres: &[],
            camera,
            lights,
            shadows: ShadowOptions::default(),
            look: &Look::NONE,
            overlay: None,
        }
    }
}

/// A finished picture.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Four bytes a pixel (sRGB and 255), row by row from the top.
    pub rgba: Vec<u8>,
    /// For each light what was drawn.
    pub lights: Vec<LightReport>,
    /// GPU times of the passes in order; empty where the device can't tell.
    pub passes: Vec<PassTime>,
}

/// A finished mask.
#[derive(Debug, Clone)]
pub struct Mask {
    /// One byte a pixel, row by row from the top: 255 lit, 0 in shadow, facing away or out of the light's reach, 128 no surface.
    pub verdicts: Vec<u8>,
    /// What was drawn.
    pub light: LightReport,
}

/// How much of a light is seen.
#[derive(Debug, Clone)]
pub struct Visibility {
    /// One share a pixel, 0 to 1, row by row from the top.
    pub seen: Vec<f32>,
    /// What was drawn.
    pub light: LightReport,
    /// GPU times of the passes in order; empty where the device can't tell.
    pub passes: Vec<PassTime>,
}

impl Renderer {
    /// Compiles every pipeline, for pictures with `samples` (1 or 4) samples a pixel.
    pub fn new(gpu: Gpu, samples: u32) -> Self {
        Self::for_format(gpu, samples, PICTURE_FORMAT)
    }

    /// Like [`Renderer::new`], for [`Renderer::draw`] into views of `format`: that of a window's surface, say. An sRGB format gets the colours
    /// right; [`Renderer::picture`] needs `Rgba8UnormSrgb`, which `new` takes.
    pub fn for_format(gpu: Gpu, samples: u32, format: wgpu::TextureFormat) -> Self {
        let layouts = Layouts::new(&gpu);
        let passes = |output, samples| {
            let depth_stencil_format = gpu.caps.depth_stencil_format;
            let target = ShadowTarget { depth_stencil_format, samples, color_formats: &[] };
            Passes {
                surface: SurfacePass::new(&gpu, &layouts, output, samples),
                shadows: Shadows::new(&gpu, &target),
                light: LightPass::new(&gpu, &layouts, output, samples),
                spheres: SpherePass::new(&gpu, &layouts, output, samples),
                soft: OnceLock::new(),
                soft_light: OnceLock::new(),
            }
        };
        let picture = passes(Output::Picture, samples);
        // Masks are compared with rays through pixel centres: one sample each, whatever the picture has.
        let mask = passes(Output::Mask, 1);
        let tally = Tally::new(&gpu);
        let glass = GlassPass::new(&gpu, &layouts, samples);
        let overlay = OverlayPass::new(&gpu, &layouts, samples);
        let tone = TonePass::new(&gpu, &layouts, format);
        Self { gpu, layouts, picture, mask, tally, glass, overlay, tone, samples, format }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Draws what `shot` shows.
    ///
    /// # Errors
    ///
    /// [`GpuError`] when the picture or a volume does not fit on the device, or the device is lost.
    ///
    /// # Panics
    ///
    /// If the renderer was made for another format than `Rgba8UnormSrgb`.
    pub async fn picture(&self, shot: &Shot<'_>) -> Result<Picture, GpuError> {
        assert_eq!(self.format, PICTURE_FORMAT, "pictures are read back as sRGB bytes");
        let size_px = shot.camera.size_px();
        let targets = Targets::new(&self.gpu, Output::Picture, size_px, self.samples)?;
        let finished = readable_texture(&self.gpu, "picture", PICTURE_FORMAT, size_px);
        let to = finished.create_view(&wgpu::TextureViewDescriptor::default());

        let mut timer = PassTimer::off();
        let mut encoder = self.encoder("picture");
        let lights = self.record(shot, &targets, &to, &mut encoder, &mut timer, true)?;
        let times = timer.resolve(&self.gpu, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        let lights = lights.reports();

        let rgba = self.gpu.read(&finished).await?;
        let passes = timer.read(&self.gpu, times).await?;
        Ok(Picture { rgba, lights, passes })
    }

    /// Submits the drawing of `shot` into `to`, a view of the renderer's format and the camera's size: a window's frame or a texture of the
    /// caller's own. Waits for nothing.
    ///
    /// `targets`, made once for pictures of that size and the renderer's samples, are the frame's scratch.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when a volume does not fit on the device; nothing is drawn then.
    pub fn draw(
        &self,
        shot: &Shot<'_>,
        targets: &Targets,
        to: &wgpu::TextureView,
    ) -> Result<Vec<LightReport>, GpuError> {
        let mut encoder = self.encoder("frame");
        let lights = self.record(shot, targets, to, &mut encoder, &mut PassTimer::off(), false)?;
        self.gpu.queue.submit([encoder.finish()]);
        Ok(lights.reports())
    }

    /// What was prepared must be kept until `encoder` is submitted.
    fn record<'a>(
        &self,
        shot: &Shot<'a>,
        targets: &Targets,
        to: &wgpu::TextureView,
        encoder: &mut wgpu::CommandEncoder,
        timer: &mut PassTimer,
        is_timed: bool,
    ) -> Result<PreparedLights<'a>, GpuError> {
        let shadow_view = self.picture.shadows.view_with_spheres(&self.gpu, shot.casters, shot.spheres, shot.camera);
        let spheres = self.picture.spheres.upload(&self.gpu, shot.spheres, shot.camera)?;
        let prepared = PreparedLights::new(&self.gpu, &self.picture, shot, &shadow_view, shot.lights)?;
        let lights = prepared.for_frame(&self.gpu, shot.lights, targets)?;
        if is_timed {
            *timer = PassTimer::new(&self.gpu, frame::pass_count(&lights));
        }
        if lights.iter().any(|light| light.shadows.soft().is_some()) {
            let make = || SoftLightPass::new(&self.gpu, &self.layouts, self.samples);
            self.picture.soft_light.get_or_init(make);
        }
        let view = self.view_group(shot.camera, shot.look);
        let uniforms: Vec<LightUniform> = shot.lights.iter().map(LightUniform::new).collect();
        let glass = self.glass.prepare(&self.gpu, shot.scene, shot.camera.eye(), &uniforms)?;
        let glass = glass.as_ref().map(|glass| (&self.glass, glass));
        let overlay = shot.overlay.map(|overlay| self.upload_overlay(overlay, shot.camera)).transpose()?;
        let overlay = overlay.as_ref().map(|overlay| (&self.overlay, overlay));
        let shadow_view = &shadow_view;
        let spheres = &spheres;
        let frame = Frame {
            targets,
            scene: shot.scene,
            spheres,
            view: &view,
            shadow_view,
            found: prepared.found(),
            lights: &lights,
            glass,
            overlay,
        };
        frame::record(&self.gpu, &self.picture, frame, encoder, timer);
        let radiance = self.tone.bind(&self.gpu, targets);
        frame::record_tone(&self.tone, &radiance, &view, to, encoder, timer);
        Ok(prepared)
    }

    /// Draws the verdict of one light of `shot` at each pixel's centre.
    ///
    /// # Errors
    ///
    /// As [`Renderer::picture`].
    pub async fn mask(&self, shot: &Shot<'_>, light: &Light) -> Result<Mask, GpuError> {
        let targets = Targets::new(&self.gpu, Output::Mask, shot.camera.size_px(), 1)?;
        let shadows = ShadowOptions { soft: false, ..shot.shadows };
        let shot = &Shot { shadows, ..*shot };
        let (light, _) = self.submit_one(shot, light, &targets, "mask", |frame, encoder| {
            frame::record(&self.gpu, &self.mask, frame, encoder, &mut PassTimer::off());
        })?;
        let verdicts = self.gpu.read(&targets.resolved).await?;
        Ok(Mask { verdicts, light })
    }

    /// For each pixel, row by row from the top, the share of `light` that is seen from what is seen at the pixel's centre: 1 where nothing covers it, and
    /// where there is no surface. Whatever else the light may lack there (turned away, out of reach) does not count. See [`crate::soft`] for
    /// how exact it is.
    ///
    /// 32-bit numbers where the device can multiply these, else 16.
    ///
    /// # Errors
    ///
    /// As [`Renderer::picture`].
    ///
    /// # Panics
    ///
    /// If the light is a point or a direction: [`Renderer::mask`] has its verdicts.
    pub async fn visibility(&self, shot: &Shot<'_>, light: &Light) -> Result<Visibility, GpuError> {
        assert_ne!(light.extent, Extent::Point, "a light without a size is seen or not");
        let targets = Targets::new(&self.gpu, Output::Mask, shot.camera.size_px(), 1)?;
        let shot = &Shot { shadows: ShadowOptions { soft: true, ..shot.shadows }, ..*shot };
        let mut timer = PassTimer::off();
        let mut times = None;
        let (light, _) = self.submit_one(shot, light, &targets, "visibility", |frame, encoder| {
            timer = PassTimer::new(&self.gpu, frame::pass_count(frame.lights));
            frame::record_visibility_alone(&self.gpu, &self.mask, frame, encoder, &mut timer);
            times = timer.resolve(&self.gpu, encoder);
        })?;
        let texture = &targets.soft().expect("a soft light has targets").visibility_texture;
        let bytes = self.gpu.read(texture).await?;
        let numbers: Vec<f32> = if texture.format() == wgpu::TextureFormat::Rgba32Float {
            bytes.as_chunks().0.iter().map(|&four| f32::from_le_bytes(four)).collect()
        } else {
            bytes.as_chunks().0.iter().map(|&two| half::f16::from_le_bytes(two).to_f32()).collect()
        };
        let seen = numbers.as_chunks::<4>().0.iter().map(|quarters| quarters.iter().sum::<f32>() / 4.0).collect();
        let passes = timer.read(&self.gpu, times).await?;
        Ok(Visibility { seen, light, passes })
    }

    /// For each pixel, row by row from the top, how many of the volumes of one light of `shot` hold what is seen there, signed as they are
    /// counted; 0 outside the light's rectangle. Where nothing is seen it is what the volumes leave at infinity.
    ///
    /// Silhouettes are found on the CPU for this, whatever the options. Counted by addition to a float target, not by the stencil: nothing wraps (below 2048 where the device can't add to 32-bit floats).
    ///
    /// # Errors
    ///
    /// As [`Renderer::picture`].
    pub async fn counts(&self, shot: &Shot<'_>, light: &Light) -> Result<Vec<i32>, GpuError> {
        let (sums, report, start) = self.tally(shot, light, TallyKind::Counts).await?;
        let Some(rect) = report.rect else { return Ok(vec![0; sums.len()]) };
        let width = shot.camera.size_px()[0];
        let at = |i: usize| [i as u32 % width, i as u32 / width];
        let started = |(i, &sum): (usize, &f32)| sum as i32 + if rect.contains(at(i)) { start as i32 } else { 0 };
        Ok(sums.iter().enumerate().map(started).collect())
    }

    /// For each pixel, row by row from the top, how many fragments one light of `shot` rasterises into the stencil, marks included; and
    /// what of the light was drawn. Silhouettes are found on the CPU for this, whatever the options.
    ///
    /// # Errors
    ///
    /// As [`Renderer::picture`].
    pub async fn fill(&self, shot: &Shot<'_>, light: &Light) -> Result<(Vec<u32>, LightReport), GpuError> {
        let (sums, report, _) = self.tally(shot, light, TallyKind::Fill).await?;
        Ok((sums.iter().map(|&sum| sum as u32).collect(), report))
    }

    /// Sums, what was drawn, and where counts start.
    async fn tally(
        &self,
        shot: &Shot<'_>,
        light: &Light,
        kind: TallyKind,
    ) -> Result<(Vec<f32>, LightReport, u32), GpuError> {
        let silhouettes = match shot.shadows.silhouettes {
            SilhouetteSource::Gpu | SilhouetteSource::GpuBasic => SilhouetteSource::Auto,
            on_cpu => on_cpu,
        };
        let shadows = ShadowOptions { silhouettes, soft: false, ..shot.shadows };
        let shot = &Shot { shadows, ..*shot };
        let size_px = shot.camera.size_px();
        let targets = Targets::new(&self.gpu, Output::Mask, size_px, 1)?;
        let sums = readable_texture(&self.gpu, "tally", self.tally.format, size_px);
        let to = sums.create_view(&wgpu::TextureViewDescriptor::default());
        let (report, start) = self.submit_one(shot, light, &targets, "tally", |frame, encoder| {
            frame::record_tally(&self.mask, (&self.tally, kind), frame, &to, encoder);
        })?;
        let bytes = self.gpu.read(&sums).await?;
        let sums = if self.tally.format == wgpu::TextureFormat::R32Float {
            bytes.as_chunks().0.iter().map(|&four| f32::from_le_bytes(four)).collect()
        } else {
            bytes.as_chunks().0.iter().map(|&two| half::f16::from_le_bytes(two).to_f32()).collect()
        };
        Ok((sums, report, start))
    }

    /// Submits what `record` records of a frame with one light of `shot`; what was drawn, and where counts start.
    fn submit_one(
        &self,
        shot: &Shot<'_>,
        light: &Light,
        targets: &Targets,
        label: &str,
        record: impl FnOnce(Frame<'_>, &mut wgpu::CommandEncoder),
    ) -> Result<(LightReport, u32), GpuError> {
        let shadow_view = self.mask.shadows.view_with_spheres(&self.gpu, shot.casters, shot.spheres, shot.camera);
        let spheres = self.mask.spheres.upload(&self.gpu, shot.spheres, shot.camera)?;
        let one = std::slice::from_ref(light);
        let prepared = PreparedLights::new(&self.gpu, &self.mask, shot, &shadow_view, one)?;
        let lights = prepared.for_frame(&self.gpu, one, targets)?;
        let view = self.view_group(shot.camera, &Look::NONE);
        let mut encoder = self.encoder(label);
        let frame = Frame {
            targets,
            scene: shot.scene,
            spheres: &spheres,
            view: &view,
            shadow_view: &shadow_view,
            found: prepared.found(),
            lights: &lights,
            glass: None,
            overlay: None,
        };
        record(frame, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        let start = lights.iter().filter_map(|light| light.shadows.hard()).map(ShadowLight::start).sum();
        let report = prepared.reports().pop().expect("one light has one report");
        Ok((report, start))
    }

    fn upload_overlay(&self, overlay: &Overlay, camera: &Camera) -> Result<GpuOverlay, GpuError> {
        let size_px = camera.size_px();
        let pixel_at_1 = 2.0 * camera.half_extent().y / f64::from(size_px[1]);
        self.overlay.upload(&self.gpu, overlay, size_px, pixel_at_1)
    }

    fn view_group(&self, camera: &Camera, look: &Look) -> wgpu::BindGroup {
        let view = View::new(camera, look);
        uniform_group(&self.gpu, "view", &self.layouts.view, bytemuck::bytes_of(&view))
    }

    fn encoder(&self, label: &str) -> wgpu::CommandEncoder {
        self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }
}

/// A texture to draw into and read back.
fn readable_texture(gpu: &Gpu, label: &str, format: wgpu::TextureFormat, [width, height]: [u32; 2]) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}
