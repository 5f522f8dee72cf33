//! Buffers that are filled again in each frame, in the memory that there is.

use crate::{Gpu, GpuError};

/// A buffer that is replaced by a larger one when it must be.
#[derive(Debug)]
pub(crate) struct GrowingBuffer {
    buffer: wgpu::Buffer,
    label: &'static str,
}

/// As much as one element of anything, as shaders are given no empty arrays.
const LEAST_BYTES: u64 = 512;

impl GrowingBuffer {
    pub(crate) fn new(gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages) -> Self {
        Self { buffer: buffer(gpu, label, LEAST_BYTES, usage | wgpu::BufferUsages::COPY_DST), label }
    }

    /// What it is now.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Makes room for `bytes`; whether that took another buffer, in which nothing is.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the device allows none that large.
    pub(crate) fn grow_to(&mut self, gpu: &Gpu, bytes: u64) -> Result<bool, GpuError> {
        if bytes <= self.buffer.size() {
            return Ok(false);
        }
        let usage = self.buffer.usage();
        gpu.ensure_buffer_fits(bytes as usize)?;
        let allowed = if usage.contains(wgpu::BufferUsages::STORAGE) {
            gpu.ensure_binding_fits(bytes)?;
            gpu.device.limits().max_storage_buffer_binding_size
        } else {
            gpu.device.limits().max_buffer_size
        };
        // Half as much again, so that it is not replaced in each frame.
        let size = (bytes + bytes / 2).min(allowed.min(gpu.device.limits().max_buffer_size)).max(bytes);
        self.buffer = buffer(gpu, self.label, size.next_multiple_of(4), usage);
        Ok(true)
    }

    /// Puts `bytes`, a multiple of 4, at its beginning; whether that took another buffer.
    ///
    /// # Errors
    ///
    /// As [`GrowingBuffer::grow_to`].
    pub(crate) fn fill(&mut self, gpu: &Gpu, bytes: &[u8]) -> Result<bool, GpuError> {
        let is_other = self.grow_to(gpu, bytes.len() as u64)?;
        gpu.queue.write_buffer(&self.buffer, 0, bytes);
        Ok(is_other)
    }
}

fn buffer(gpu: &Gpu, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}
