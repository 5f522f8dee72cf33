//! A scene, a camera and lights into a picture or a mask.

use umbrae_core::{Camera, Caster, Light, Windings};
use web_time::Instant;

use crate::frame::{self, Frame, FrameLight, Passes};
use crate::light_volumes::CasterReport;
use crate::passes::{
    GpuOverlay, GpuVolumes, Layouts, LightPass, OverlayPass, SurfacePass, TonePass, VolumePass, uniform_group,
};
use crate::readback::TextureCopy;
use crate::targets::{Output, PICTURE_FORMAT};
use crate::timing::PassTimer;
use crate::uniforms::{LightUniform, View};
use crate::{Gpu, GpuError, GpuScene, LightVolumes, Look, Method, Overlay, PassTime, Targets};

/// Draws pictures and masks, with pipelines compiled once.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    layouts: Layouts,
    picture: Passes,
    mask: Passes,
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
    /// The eye; its size is the target's.
    pub camera: &'a Camera,
    /// Any number.
    pub lights: &'a [Light],
    /// How volumes are counted.
    pub method: Method,
    /// Exposure and fading.
    pub look: &'a Look,
    /// Drawn last, over the lit picture.
    pub overlay: Option<&'a Overlay>,
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
    /// One byte a pixel, row by row from the top: 255 lit, 0 in shadow or facing away, 128 no surface.
    pub verdicts: Vec<u8>,
    /// What was drawn.
    pub light: LightReport,
}

/// What one light cost and drew.
#[derive(Debug, Clone)]
pub struct LightReport {
    /// One entry for each caster, in order.
    pub casters: Vec<CasterReport>,
    /// Time on the CPU for facing, silhouettes and volumes of all casters.
    pub cpu_ms: f64,
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
        let passes = |output, samples| Passes {
            surface: SurfacePass::new(&gpu, &layouts, output, samples),
            volumes: VolumePass::new(&gpu, &layouts, samples),
            light: LightPass::new(&gpu, &layouts, output, samples),
        };
        let picture = passes(Output::Picture, samples);
        // Masks are compared with rays through pixel centres: one sample each, whatever the picture has.
        let mask = passes(Output::Mask, 1);
        let overlay = OverlayPass::new(&gpu, &layouts, samples);
        let tone = TonePass::new(&gpu, &layouts, format);
        Self { gpu, layouts, picture, mask, overlay, tone, samples, format }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Draws `casters`, uploaded as `scene`, as `camera` sees them under `lights`.
    ///
    /// # Errors
    ///
    /// [`GpuError`] when the picture or a volume does not fit on the device, or the device is lost.
    ///
    /// # Panics
    ///
    /// If the renderer was made for another format than `Rgba8UnormSrgb`.
    pub async fn picture(
        &self,
        scene: &GpuScene,
        casters: &[Caster],
        camera: &Camera,
        lights: &[Light],
        method: Method,
        look: &Look,
    ) -> Result<Picture, GpuError> {
        self.picture_of(&Shot { scene, casters, camera, lights, method, look, overlay: None }).await
    }

    /// Like [`Renderer::picture`], with all that a frame can show.
    ///
    /// # Errors
    ///
    /// As [`Renderer::picture`].
    ///
    /// # Panics
    ///
    /// As [`Renderer::picture`].
    pub async fn picture_of(&self, shot: &Shot<'_>) -> Result<Picture, GpuError> {
        assert_eq!(self.format, PICTURE_FORMAT, "pictures are read back as sRGB bytes");
        let targets = Targets::new(&self.gpu, Output::Picture, shot.camera.size_px(), self.samples)?;
        let finished = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: targets.resolved.size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: PICTURE_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let to = finished.create_view(&wgpu::TextureViewDescriptor::default());

        let mut timer = PassTimer::new(&self.gpu, frame::pass_count(shot.lights.len()));
        let mut encoder = self.encoder("picture");
        let reports = self.record(shot, &targets, &to, &mut encoder, &mut timer)?;
        let copy = TextureCopy::record(&self.gpu, &mut encoder, &finished);
        let times = timer.resolve(&self.gpu, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);

        let rgba = self.gpu.unless_out_of_memory(copy.read(&self.gpu).await)?;
        let passes = timer.read(&self.gpu, times).await?;
        Ok(Picture { rgba, lights: reports, passes })
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
        let reports = self.record(shot, targets, to, &mut encoder, &mut PassTimer::off())?;
        self.gpu.queue.submit([encoder.finish()]);
        Ok(reports)
    }

    fn record(
        &self,
        shot: &Shot<'_>,
        targets: &Targets,
        to: &wgpu::TextureView,
        encoder: &mut wgpu::CommandEncoder,
        timer: &mut PassTimer,
    ) -> Result<Vec<LightReport>, GpuError> {
        let seen = windings_of(shot.casters, shot.camera);
        let (lights, reports) = shot
            .lights
            .iter()
            .map(|light| self.prepare_light(shot.casters, &seen, shot.camera, light, shot.method))
            .collect::<Result<(Vec<_>, Vec<_>), _>>()?;
        let view = self.view_group(shot.camera, shot.look);
        let overlay = shot.overlay.map(|overlay| self.upload_overlay(overlay, shot.camera)).transpose()?;
        let overlay = overlay.as_ref().map(|overlay| (&self.overlay, overlay));
        let frame = Frame { targets, scene: shot.scene, view: &view, lights: &lights, overlay };
        frame::record(&self.picture, frame, encoder, timer);
        let radiance = self.tone.bind(&self.gpu, targets);
        frame::record_tone(&self.tone, &radiance, &view, to, encoder, timer);
        Ok(reports)
    }

    /// Draws the verdict of one light at each pixel's centre.
    ///
    /// # Errors
    ///
    /// As [`Renderer::picture`].
    pub async fn mask(
        &self,
        scene: &GpuScene,
        casters: &[Caster],
        camera: &Camera,
        light: &Light,
        method: Method,
    ) -> Result<Mask, GpuError> {
        let targets = Targets::new(&self.gpu, Output::Mask, camera.size_px(), 1)?;
        let seen = windings_of(casters, camera);
        let (frame_light, report) = self.prepare_light(casters, &seen, camera, light, method)?;
        let look =
            Look { exposure: 1.0, fade_start_m: f32::MAX, fade_end_m: f32::MAX, fade_center_world: glam::Vec3::ZERO };
        let view = self.view_group(camera, &look);
        let mut timer = PassTimer::new(&self.gpu, frame::pass_count(1));
        let mut encoder = self.encoder("mask");
        let frame = Frame { targets: &targets, scene, view: &view, lights: &[frame_light], overlay: None };
        frame::record(&self.mask, frame, &mut encoder, &mut timer);
        let copy = TextureCopy::record(&self.gpu, &mut encoder, &targets.resolved);
        self.gpu.queue.submit([encoder.finish()]);
        let verdicts = self.gpu.unless_out_of_memory(copy.read(&self.gpu).await)?;
        Ok(Mask { verdicts, light: report })
    }

    fn prepare_light(
        &self,
        casters: &[Caster],
        seen: &[Windings],
        camera: &Camera,
        light: &Light,
        method: Method,
    ) -> Result<(FrameLight, LightReport), GpuError> {
        let start = Instant::now();
        // The shaders see the light in f32, so everything else must reason about that light too.
        let position = light.position.rounded_to_f32();
        let chooser = LightVolumes::chooser(camera, position, casters);
        let volumes = LightVolumes::new(casters, seen, &chooser, position, method);
        let cpu_ms = start.elapsed().as_secs_f64() * 1e3;
        let uniform = LightUniform::new(light);
        let frame_light = FrameLight {
            name: light.name.clone(),
            uniform: uniform_group(&self.gpu, "light", &self.layouts.light, bytemuck::bytes_of(&uniform)),
            volumes: GpuVolumes::new(&self.gpu, &volumes)?,
        };
        Ok((frame_light, LightReport { casters: volumes.casters, cpu_ms }))
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

fn windings_of(casters: &[Caster], camera: &Camera) -> Vec<Windings> {
    casters.iter().map(|caster| Windings::of_near_rectangle(caster, camera)).collect()
}
