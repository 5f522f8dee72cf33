//! GPU time of each pass, by timestamp queries.

use crate::{Gpu, GpuError, readback};

/// What one pass took on the GPU.
#[derive(Debug, Clone, PartialEq)]
pub struct PassTime {
    /// The pass, and the light it was for.
    pub name: String,
    /// Milliseconds between its first and last command.
    pub ms: f64,
}

/// Collects timestamps while a frame is recorded; does nothing where the device has none.
#[derive(Debug)]
pub(crate) struct PassTimer {
    queries: Option<wgpu::QuerySet>,
    capacity: u32,
    names: Vec<String>,
}

impl PassTimer {
    /// A timer for at most `passes` passes.
    pub(crate) fn new(gpu: &Gpu, passes: u32) -> Self {
        // The most that WebGPU lets a query set hold is 4096; later passes go untimed.
        let capacity = passes.min(2048);
        let queries = gpu.caps.has_timestamps.then(|| {
            gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: capacity * 2,
            })
        });
        Self { queries, capacity, names: Vec::new() }
    }

    /// A timer that times nothing.
    pub(crate) fn off() -> Self {
        Self { queries: None, capacity: 0, names: Vec::new() }
    }

    /// The timestamps for the next pass.
    pub(crate) fn writes(&mut self, name: String) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let query_set = self.queries.as_ref()?;
        let i = self.names.len() as u32;
        if i == self.capacity {
            return None;
        }
        self.names.push(name);
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * i),
            end_of_pass_write_index: Some(2 * i + 1),
        })
    }

    /// As [`PassTimer::writes`], for a compute pass.
    pub(crate) fn compute_writes(&mut self, name: &str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.queries.as_ref()?;
        let writes = self.writes(name.to_owned())?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: writes.query_set,
            beginning_of_pass_write_index: writes.beginning_of_pass_write_index,
            end_of_pass_write_index: writes.end_of_pass_write_index,
        })
    }

    /// Records the way of the results into a buffer; `None` where there are none.
    pub(crate) fn resolve(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Option<wgpu::Buffer> {
        let queries = self.queries.as_ref().filter(|_| !self.names.is_empty())?;
        let count = 2 * self.names.len() as u32;
        let size = u64::from(count) * 8;
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let resolved = buffer("pass times, resolved", wgpu::BufferUsages::QUERY_RESOLVE);
        encoder.resolve_query_set(queries, 0..count, &resolved, 0);
        let mapped = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pass times, for reading"),
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        encoder.copy_buffer_to_buffer(&resolved, 0, &mapped, 0, size);
        Some(mapped)
    }

    /// Reads what [`PassTimer::resolve`] recorded, after its submission.
    pub(crate) async fn read(self, gpu: &Gpu, resolved: Option<wgpu::Buffer>) -> Result<Vec<PassTime>, GpuError> {
        let Some(resolved) = resolved else { return Ok(Vec::new()) };
        let bytes = readback::buffer(gpu, &resolved).await?;
        let ms_per_tick = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let ticks = |i: usize| {
            let bytes: [u8; 8] = bytes[8 * i..8 * i + 8].try_into().expect("eight bytes are eight bytes");
            u64::from_le_bytes(bytes)
        };
        let times = self.names.into_iter().enumerate();
        Ok(times
            .map(|(i, name)| PassTime { name, ms: ticks(2 * i + 1).saturating_sub(ticks(2 * i)) as f64 * ms_per_tick })
            .collect())
    }
}
