//! What the triangles of a material are drawn with, besides their colour: texture and alpha.

use std::collections::BTreeMap;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use umbrae_core::{AlphaMode, Material, Role, Texture, Wrap};

use crate::Gpu;
use crate::mipmap::levels;

/// How much of the surface shader triangles need; each has a pipeline of its own, so that most pay nothing for the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum FinishKind {
    /// Colour only.
    Plain,
    /// A texture.
    Textured,
    /// A texture or none, and parts that are no surface.
    CutOut,
    /// Seen through.
    Glass,
}

/// `Finish` in `surface.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FinishUniform {
    alpha: f32,
    cutoff: f32,
    least_coverage: f32,
    unused: f32,
}

/// A finish, ready to be bound.
#[derive(Debug)]
pub(crate) struct Finish {
    pub(crate) kind: FinishKind,
    pub(crate) group: wgpu::BindGroup,
}

/// All finishes of a scene, each once; number 0 is [`FinishKind::Plain`].
#[derive(Debug)]
pub(crate) struct Finishes<'a> {
    gpu: &'a Gpu,
    textures: &'a [Arc<Texture>],
    layout: wgpu::BindGroupLayout,
    /// For each texture once it is needed; the last is white, for what has none.
    uploaded: BTreeMap<usize, (wgpu::TextureView, [wgpu::Sampler; 2])>,
    numbers: BTreeMap<(FinishKind, usize, [u32; 4]), u32>,
    made: Vec<Finish>,
}

impl<'a> Finishes<'a> {
    pub(crate) fn new(gpu: &'a Gpu, textures: &'a [Arc<Texture>]) -> Self {
        let layout = layout(gpu);
        let mut finishes =
            Self { gpu, textures, layout, uploaded: BTreeMap::new(), numbers: BTreeMap::new(), made: Vec::new() };
        finishes.number(&Material::default(), Role::default());
        finishes
    }

    /// The number of the finish of `material` on an object in this role: the role, not the material, says whether it is cut out or glass, so that
    /// it is drawn as it casts.
    pub(crate) fn number(&mut self, material: &Material, role: Role) -> u32 {
        let texture = material.base_color_texture.map(|texture| texture as usize);
        let texture = texture.filter(|&texture| texture < self.textures.len()).unwrap_or(self.textures.len());
        let cutoff = match material.alpha_mode {
            AlphaMode::Mask { cutoff } if role.is_see_through() => cutoff,
            _ => NOTHING_CUT_OUT,
        };
        let kind = if role.is_glass {
            FinishKind::Glass
        } else if cutoff != NOTHING_CUT_OUT {
            FinishKind::CutOut
        } else if texture < self.textures.len() {
            FinishKind::Textured
        } else {
            FinishKind::Plain
        };
        let is_blended = role.is_glass && material.alpha_mode == AlphaMode::Blend;
        let least_coverage = if is_blended { 0.0 } else { 1.0 };
        let uniform = match kind {
            // Alike for all, so that they are drawn together.
            FinishKind::Plain | FinishKind::Textured => FinishUniform::OPAQUE,
            FinishKind::CutOut | FinishKind::Glass => {
                FinishUniform { alpha: material.alpha, cutoff, least_coverage, unused: 0.0 }
            }
        };
        let key = (kind, texture, bytemuck::cast(uniform));
        if let Some(&number) = self.numbers.get(&key) {
            return number;
        }
        let number = self.made.len() as u32;
        let group = self.group(texture, &uniform);
        self.made.push(Finish { kind, group });
        self.numbers.insert(key, number);
        number
    }

    pub(crate) fn finish(self) -> Vec<Finish> {
        self.made
    }

    fn group(&mut self, texture: usize, uniform: &FinishUniform) -> wgpu::BindGroup {
        use wgpu::util::DeviceExt as _;
        let buffer = self.gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("finish"),
            contents: bytemuck::bytes_of(uniform),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let (view, [sampler, cut_out_sampler]) = self.uploaded.entry(texture).or_insert_with(|| {
            let white = Texture {
                name: "white".to_owned(),
                size_px: [1, 1],
                rgba: vec![255; 4],
                wrap: [Wrap::Repeat; 2],
                is_nearest: false,
            };
            let texture = self.textures.get(texture).map_or(&white, |texture| texture);
            (upload(self.gpu, texture), samplers(self.gpu, texture))
        });
        let texture = || wgpu::BindingResource::TextureView(view);
        self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("finish"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: texture() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
                wgpu::BindGroupEntry { binding: 2, resource: buffer.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::Sampler(cut_out_sampler) },
                wgpu::BindGroupEntry { binding: 4, resource: texture() },
            ],
        })
    }
}

/// No alpha is below this.
const NOTHING_CUT_OUT: f32 = -1.0;

impl FinishUniform {
    const OPAQUE: Self = Self { alpha: 1.0, cutoff: NOTHING_CUT_OUT, least_coverage: 1.0, unused: 0.0 };
}

/// Group 2: a texture, its sampler, the uniform, and the sampler for cut-outs with the texture again, as OpenGL gives each texture one sampler.
pub(crate) fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let entry =
        |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::FRAGMENT, ty, count: None };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("finish"),
        entries: &[
            entry(0, texture),
            entry(4, texture),
            entry(1, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            entry(3, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            entry(
                2,
                wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: std::num::NonZeroU64::new(size_of::<FinishUniform>() as u64),
                },
            ),
        ],
    })
}

/// The picture with its smaller copies; where the device has no textures that large, only those that it can hold.
fn upload(gpu: &Gpu, texture: &Texture) -> wgpu::TextureView {
    let levels = levels(texture, gpu.device.limits().max_texture_dimension_2d);
    let extent = |[width, height]: [u32; 2]| wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let uploaded = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(&texture.name),
        size: extent(levels[0].size_px),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (mip_level, level) in levels.iter().enumerate() {
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: mip_level as u32, ..uploaded.as_image_copy() },
            &level.rgba,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(level.size_px[0] * 4), rows_per_image: None },
            extent(level.size_px),
        );
    }
    uploaded.create_view(&wgpu::TextureViewDescriptor::default())
}

/// What wgpu takes for more than the device has.
const MOST_ANISOTROPY: u16 = 16;

/// For colours, and for cut-outs: these are the same from everywhere, so theirs is not anisotropic, which would look at many places even in a
/// single level.
fn samplers(gpu: &Gpu, texture: &Texture) -> [wgpu::Sampler; 2] {
    let address = |wrap: Wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    let [across, down] = texture.wrap.map(address);
    let nearest_or_linear = if texture.is_nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear };
    let for_colors = wgpu::SamplerDescriptor {
        label: Some(&texture.name),
        address_mode_u: across,
        address_mode_v: down,
        address_mode_w: wgpu::AddressMode::ClampToEdge,
        mag_filter: nearest_or_linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        // Every filter must be linear for it.
        anisotropy_clamp: if texture.is_nearest { 1 } else { MOST_ANISOTROPY },
        ..wgpu::SamplerDescriptor::default()
    };
    let for_cut_outs = wgpu::SamplerDescriptor { min_filter: nearest_or_linear, anisotropy_clamp: 1, ..for_colors };
    [for_colors, for_cut_outs].map(|descriptor| gpu.device.create_sampler(&descriptor))
}
