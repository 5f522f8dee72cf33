//! Finding alone, without drawing: for measuring.

use super::FoundShadows;
use crate::timing::PassTimer;
use crate::{Gpu, GpuError};

/// More than finding has.
const PASSES: u32 = 64;

impl FoundShadows {
    /// Finds what was planned and uploaded last, draws nothing, and waits: how many milliseconds the GPU took by its own clock, or `None` where
    /// it has none.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub async fn time_alone(&self, gpu: &Gpu) -> Result<Option<f64>, GpuError> {
        let mut timer = PassTimer::new(gpu, PASSES);
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("silhouettes alone") });
        self.record_timed(&mut encoder, &mut timer);
        let resolved = timer.resolve(gpu, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
        let times = gpu.unless_out_of_memory(timer.read(gpu, resolved).await)?;
        Ok(gpu.caps.has_timestamps.then(|| times.iter().map(|time| time.ms).sum()))
    }
}
