//! The forward renderer of `own_renderer.rs` with silhouettes found on the GPU, for all lights at once.
//!
//! Meshes too large for the stencil to count are added up in a float target, so that each light takes a few passes in place of a part of one.
//!
//! Run with `cargo run -p umbrae-render --example own_renderer_on_gpu`; it writes `own_renderer_on_gpu.png`.

#[expect(dead_code, reason = "the other example's main and picture are not run")]
#[path = "own_renderer.rs"]
pub(crate) mod own_renderer;

use own_renderer::{COLOR, DEPTH, SIZE_PX, buffer, corners, frame_group, pipelines, texture};
use umbrae_core::{Camera, Caster, Light};
use umbrae_render::{
    AdapterChoice, Gpu, GpuError, LIT, ShadowCasters, ShadowOptions, ShadowSums, ShadowTarget, Shadows,
    SilhouetteSource,
};

pub(crate) use own_renderer::{camera, casters, lights};

/// Draws `casters`: four bytes a pixel, sRGB.
pub(crate) async fn picture(casters: &[Caster], camera: &Camera, lights: &[Light]) -> Result<Vec<u8>, GpuError> {
    let gpu = Gpu::new(&AdapterChoice::default()).await?;
    let vertices: Vec<_> = casters.iter().flat_map(corners).collect();
    let surface = buffer(&gpu.device, bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX);
    let [ambient, lit] = pipelines(&gpu.device);

    // Once for all frames. Shadows are drawn in passes without colour.
    let target = ShadowTarget { depth_stencil_format: DEPTH, samples: 1, color_formats: &[] };
    let shadows = Shadows::new(&gpu, &target);
    let uploaded = ShadowCasters::new(&gpu, casters)?;
    let mut found = shadows.finder(&gpu, casters, &uploaded, SilhouetteSource::Gpu)?;
    let mut view = shadows.view(&gpu, casters, camera);
    let sums = ShadowSums::new(&gpu, SIZE_PX, 1)?;
    let [color, depth] = [COLOR, DEPTH].map(|format| texture(&gpu.device, format));
    let [color_view, depth_view] = [&color, &depth].map(|texture| texture.create_view(&Default::default()));

    // In each frame. The options say what may be left out; who finds was said above.
    view.look_from(&gpu, casters, camera);
    found.plan(&gpu, casters, &uploaded, &view, lights, &ShadowOptions::default());
    found.upload(&gpu)?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    found.record(&mut encoder);
    let draw = |pass: &mut wgpu::RenderPass<'_>, pipeline, light| {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &frame_group(&gpu.device, pipeline, camera, light), &[]);
        pass.set_vertex_buffer(0, surface.slice(..));
        pass.set_stencil_reference(LIT);
        pass.draw(0..vertices.len() as u32, 0..1);
    };
    let load = |is_first: bool| if is_first { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
    let on_color = |is_first| wgpu::RenderPassColorAttachment {
        view: &color_view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: load(is_first), store: wgpu::StoreOp::Store },
    };
    draw(&mut begin(&mut encoder, Some(on_color(true)), &depth_view, true), &ambient, &lights[0]);
    for (light, volumes) in lights.iter().zip(found.lights()) {
        shadows.draw(&mut begin(&mut encoder, None, &depth_view, false), &uploaded, &view, volumes);
        for i in 0..volumes.sum_count() {
            let mut pass = begin(&mut encoder, Some(sums.attachment()), &depth_view, false);
            shadows.draw_sums(&mut pass, &view, volumes, i);
            drop(pass);
            shadows.draw_fold(&mut begin(&mut encoder, None, &depth_view, false), volumes, i, &sums);
        }
        draw(&mut begin(&mut encoder, Some(on_color(false)), &depth_view, false), &lit, light);
    }
    gpu.queue.submit([encoder.finish()]);
    gpu.read(&color).await
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    color: Option<wgpu::RenderPassColorAttachment<'_>>,
    depth: &wgpu::TextureView,
    is_first: bool,
) -> wgpu::RenderPass<'e> {
    let color_attachments = [color];
    let (depth_load, stencil_load) = if is_first {
        (wgpu::LoadOp::Clear(0.0), wgpu::LoadOp::Clear(0))
    } else {
        (wgpu::LoadOp::Load, wgpu::LoadOp::Load)
    };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: if color_attachments[0].is_some() { &color_attachments } else { &[] },
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: depth_load, store: wgpu::StoreOp::Store }),
            stencil_ops: Some(wgpu::Operations { load: stencil_load, store: wgpu::StoreOp::Store }),
        }),
        ..Default::default()
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rgba = pollster::block_on(picture(&casters(), &camera(), &lights()))?;
    let [width, height] = SIZE_PX;
    image::save_buffer("own_renderer_on_gpu.png", &rgba, width, height, image::ColorType::Rgba8)?;
    Ok(())
}
