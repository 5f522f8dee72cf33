//! What the device can do, decided once.

/// How much of WebGPU the device has. The lower tier is the baseline; the higher only goes faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tier {
    /// Compute with eight storage buffers, as every WebGPU device has; storage buffers in vertex shaders too; indirect draws.
    Full,
    /// WebGL2: none of these.
    Basic,
}

/// The device's abilities as far as this crate asks for them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Caps {
    /// See [`Tier`].
    pub tier: Tier,
    /// Whether passes can be timed on the GPU.
    pub has_timestamps: bool,
    /// Float depth where the device has it: reversed, it is precise at every distance.
    pub depth_stencil_format: wgpu::TextureFormat,
    /// Whether fragments can be shaded at each sample.
    pub shades_samples: bool,
    /// A float that can be added to: of 32 bits, or of 16, exact up to 2048.
    pub tally_format: wgpu::TextureFormat,
}

const FULL: wgpu::DownlevelFlags = wgpu::DownlevelFlags::COMPUTE_SHADERS
    .union(wgpu::DownlevelFlags::INDIRECT_EXECUTION)
    .union(wgpu::DownlevelFlags::VERTEX_STORAGE);

impl Caps {
    /// How a buffer of vertices may be used that something is to move: also by compute shaders, where there are any.
    pub(crate) fn moving_vertices(&self) -> wgpu::BufferUsages {
        let vertices = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        match self.tier {
            Tier::Full => vertices | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            Tier::Basic => vertices,
        }
    }

    /// What a device made of `adapter` can do.
    pub(crate) fn of(adapter: &wgpu::Adapter, device: &wgpu::Device) -> Self {
        let has = |feature| device.features().contains(feature);
        let flags = adapter.get_downlevel_capabilities().flags;
        let is_full = flags.contains(FULL) && device.limits().max_storage_buffers_per_shader_stage >= 8;
        Self {
            tier: if is_full { Tier::Full } else { Tier::Basic },
            has_timestamps: has(wgpu::Features::TIMESTAMP_QUERY),
            shades_samples: flags.contains(wgpu::DownlevelFlags::MULTISAMPLED_SHADING),
            depth_stencil_format: if has(wgpu::Features::DEPTH32FLOAT_STENCIL8) {
                wgpu::TextureFormat::Depth32FloatStencil8
            } else {
                wgpu::TextureFormat::Depth24PlusStencil8
            },
            tally_format: if has(wgpu::Features::FLOAT32_BLENDABLE) {
                wgpu::TextureFormat::R32Float
            } else {
                wgpu::TextureFormat::R16Float
            },
        }
    }
}
