//! Moving without reading back: for silhouettes found on the GPU, to which the CPU gives nothing but boxes.

use glam::Vec3;
use umbrae_core::{Caster, Object};

use super::{GpuPoser, Part, VERTEX_SIZE};
use crate::displacement::widened;
use crate::gpu_scene::middle;
use crate::{Gpu, GpuError, GpuScene, readback};

impl GpuPoser {
    /// Submits the moving of `scene` to where `objects` are at `time_s`, and reads nothing back: for silhouettes found on the GPU
    /// ([`crate::SilhouetteSource`]), to which the CPU gives only boxes. Of `casters`, whatever else they say of where they are is from the CPU's own
    /// posing, without a [`crate::Displacement`], and must be asked for neither silhouettes nor rays. Linear in the vertices of what is posed anew; what is
    /// only displaced costs the CPU nothing.
    ///
    /// # Panics
    ///
    /// As [`GpuPoser::pose`].
    pub fn show(&mut self, gpu: &Gpu, scene: &mut GpuScene, objects: &[Object], casters: &mut [Caster], time_s: f32) {
        let before = self.shown.clone();
        let Some(moved) = self.stage(gpu, objects, casters, time_s) else { return };
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("posing") });
        self.record(gpu, &mut encoder, &moved);
        gpu.queue.submit([encoder.finish()]);
        for i in moved {
            let part = &self.parts[i];
            scene.shadow_casters.note_left(i);
            if !self.is_boxed[i] || before.get(part.range()) != self.shown.get(part.range()) {
                self.is_boxed[i] = true;
                let caster = &mut casters[i];
                caster.pose_to(&objects[i]);
                caster.bounds = widened(caster.bounds, &objects[i], part.uniform.max_offset.into());
                scene.shadow_casters.update_middle(gpu, i, caster);
            }
        }
        for (glass, &(caster, triangle)) in scene.glass.iter_mut().zip(&self.glass) {
            glass.center = middle(casters[caster].corners(triangle));
        }
    }

    /// Where the vertices of `scene` are now, object by object: for whoever must know, as a test must. Waits for the GPU.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub async fn positions(&self, gpu: &Gpu, scene: &GpuScene) -> Result<Vec<Vec<Vec3>>, GpuError> {
        let all: Vec<usize> = (0..self.parts.len()).collect();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read") });
        let copy = self.copy_near(gpu, &mut encoder, scene, &all);
        gpu.queue.submit([encoder.finish()]);
        let bytes = gpu.unless_out_of_memory(readback::buffer(gpu, &copy).await)?;
        let mut vertices = bytes.chunks_exact(VERTEX_SIZE).map(bytemuck::pod_read_unaligned::<[f32; 4]>);
        let of = |part: &Part| {
            let own = vertices.by_ref().take(part.uniform.vertex_count as usize);
            own.map(|[x, y, z, _]| Vec3::new(x, y, z)).collect()
        };
        Ok(self.parts.iter().map(of).collect())
    }
}
