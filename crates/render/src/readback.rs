//! Getting results back. Everything waits in an `async` way; only the native program blocks.

use std::sync::mpsc;

use crate::{Gpu, GpuError};

/// The bytes of a mappable buffer, once all submitted work that writes it is done.
pub(crate) async fn buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let lost = |reason: String| GpuError::Lost { reason };
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver outlives the callback unless the caller gave up, and then nobody wants the result.
        let _ = sender.send(result);
    });
    loop {
        // In a browser, polling is a no-op and the callback comes with the event loop.
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| lost(e.to_string()))?;
        match receiver.try_recv() {
            Ok(result) => {
                result.map_err(|e| lost(e.to_string()))?;
                break;
            }
            Err(mpsc::TryRecvError::Empty) => yield_now().await,
            Err(mpsc::TryRecvError::Disconnected) => return Err(lost("the mapping was dropped".to_owned())),
        }
    }
    let bytes = buffer.get_mapped_range(..).map_err(|e| lost(e.to_string()))?.to_vec();
    buffer.unmap();
    Ok(bytes)
}

/// Lets the executor run other work once.
async fn yield_now() {
    let mut has_yielded = false;
    std::future::poll_fn(|context| {
        if has_yielded {
            return std::task::Poll::Ready(());
        }
        has_yielded = true;
        context.waker().wake_by_ref();
        std::task::Poll::Pending
    })
    .await;
}

/// A copy of a texture under way to the CPU: make it, submit the encoder, then [`TextureCopy::read`].
#[derive(Debug)]
pub(crate) struct TextureCopy {
    buffer: wgpu::Buffer,
    bytes_per_row: u32,
    padded_bytes_per_row: u32,
}

impl TextureCopy {
    pub(crate) fn record(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) -> Self {
        let size = texture.size();
        let bytes_per_texel = texture.format().block_copy_size(None).expect("colour formats have one size");
        let bytes_per_row = size.width * bytes_per_texel;
        let padded_bytes_per_row = bytes_per_row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture, for reading"),
            size: u64::from(padded_bytes_per_row) * u64::from(size.height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_bytes_per_row),
                    rows_per_image: None,
                },
            },
            size,
        );
        Self { buffer, bytes_per_row, padded_bytes_per_row }
    }

    /// The texels, row by row from the top, without padding.
    pub(crate) async fn read(self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        let padded = buffer(gpu, &self.buffer).await?;
        let rows = padded.chunks_exact(self.padded_bytes_per_row as usize);
        Ok(rows.flat_map(|row| &row[..self.bytes_per_row as usize]).copied().collect())
    }
}
