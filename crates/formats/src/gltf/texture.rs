//! Base colour textures of a glTF file, and where on them the corners of triangles are.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DAffine2, DMat2, DVec2, Vec2};
use umbrae_core::{Surface, Texture, Wrap};

use super::accessor::Accessors;
use super::container::{data_of_uri, path_of_uri};
use super::document::{Attributes, Document, Sampler, TextureOfMaterial};
use crate::error::quoted;
use crate::picture::{Pictures, Sampling, TEXTURE_SKIPPED};
use crate::warnings::Warnings;

/// Reads the textures that materials name, each once.
pub(super) struct Textures<'a> {
    document: &'a Document,
    accessors: &'a Accessors<'a>,
    folder: Option<&'a Path>,
    pictures: Pictures,
    /// By image and sampling, the place in `read`; `None` for one that can't be had.
    known: BTreeMap<(u32, [u8; 3]), Option<u32>>,
    pub(super) read: Vec<Arc<Texture>>,
    /// The least alpha of each in `read`.
    least_alphas: Vec<u8>,
}

/// Where the triangles of a material find their texture coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UvSource {
    /// The number of the set.
    set: u32,
    uv_from_file: DAffine2,
}

impl<'a> Textures<'a> {
    pub(super) fn new(document: &'a Document, accessors: &'a Accessors<'a>, folder: Option<&'a Path>) -> Self {
        let pictures = Pictures::new(accessors.file_bytes());
        Self {
            document,
            accessors,
            folder,
            pictures,
            known: BTreeMap::new(),
            read: Vec::new(),
            least_alphas: Vec::new(),
        }
    }

    /// The least alpha of what was read under this index, 0 to 1.
    pub(super) fn least_alpha(&self, index: u32) -> f32 {
        f32::from(self.least_alphas[index as usize]) / 255.0
    }

    /// The texture of a material, as an index into what is read, and its coordinates; `None` where it can't be had.
    pub(super) fn of_material(
        &mut self,
        texture: &TextureOfMaterial,
        warnings: &mut Warnings,
    ) -> Option<(u32, UvSource)> {
        let index = self.index_of(texture.index, warnings)?;
        let mut source = UvSource { set: texture.tex_coord, uv_from_file: DAffine2::IDENTITY };
        if let Some(transform) = &texture.extensions.transform {
            source.set = transform.tex_coord.unwrap_or(source.set);
            // Turns are counter-clockwise as seen, and v points down.
            let rotation = DMat2::from_angle(-transform.rotation);
            let scale = DMat2::from_diagonal(transform.scale.into());
            source.uv_from_file = DAffine2::from_mat2_translation(rotation * scale, transform.offset.into());
        }
        Some((index, source))
    }

    fn index_of(&mut self, texture_index: usize, warnings: &mut Warnings) -> Option<u32> {
        let describe = |message: String| format!("texture {texture_index}: {message}");
        let Some(texture) = self.document.textures.get(texture_index) else {
            let count = self.document.textures.len();
            warnings.add_one(TEXTURE_SKIPPED, || describe(format!("there are {count}")));
            return None;
        };
        let Some(image) = texture.source else {
            let words = "it has no PNG or JPEG (its picture may be in an extension's format, such as WebP or KTX2)";
            warnings.add_one(TEXTURE_SKIPPED, || describe(words.to_owned()));
            return None;
        };
        let sampler = texture.sampler.and_then(|sampler| self.document.samplers.get(sampler as usize));
        let sampling = sampling(sampler);
        let key = (image, sampling.key());
        if let Some(known) = self.known.get(&key) {
            // Warned of before, if there was a reason.
            return *known;
        }
        let index = match self.read(image as usize, texture.name.as_deref(), sampling) {
            Ok(texture) => {
                let alphas = texture.rgba.iter().skip(3).step_by(4);
                self.least_alphas.push(alphas.copied().min().unwrap_or(u8::MAX));
                self.read.push(Arc::new(texture));
                Some(self.read.len() as u32 - 1)
            }
            Err(message) => {
                warnings.add_one(TEXTURE_SKIPPED, || describe(message));
                None
            }
        };
        self.known.insert(key, index);
        index
    }

    fn read(&mut self, image_index: usize, name: Option<&str>, sampling: Sampling) -> Result<Texture, String> {
        let images = &self.document.images;
        let image =
            images.get(image_index).ok_or_else(|| format!("there is no image {image_index}, only {}", images.len()))?;
        let names = [name, image.name.as_deref(), image.uri.as_deref().filter(|uri| !uri.starts_with("data:"))];
        let name = names.into_iter().flatten().find(|name| !name.is_empty()).unwrap_or_default().to_owned();
        let texture = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match data_of_uri(uri) {
                Some(data) => data.and_then(|data| self.pictures.texture(&data, name, sampling)),
                None => path_of_uri(uri, self.folder)
                    .and_then(|path| self.pictures.texture_of_file(&path, name, sampling))
                    .map_err(|message| format!("{}: {message}", quoted(uri))),
            },
            (None, Some(view)) => {
                let bytes = self.accessors.view_bytes(view as usize);
                bytes.and_then(|bytes| self.pictures.texture(bytes, name, sampling))
            }
            (None, None) => Err("it has neither a uri nor a buffer view".to_owned()),
        };
        texture.map_err(|message| format!("image {image_index}: {message}"))
    }
}

/// glTF's numbers are those of OpenGL; what is none of them counts as not said.
fn sampling(sampler: Option<&Sampler>) -> Sampling {
    const NEAREST: u32 = 9728;
    const CLAMP_TO_EDGE: u32 = 33071;
    const MIRRORED_REPEAT: u32 = 33648;
    let wrap = |wrap: Option<u32>| match wrap {
        Some(CLAMP_TO_EDGE) => Wrap::Clamp,
        Some(MIRRORED_REPEAT) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    sampler.map_or(Sampling::default(), |sampler| Sampling {
        wrap: [wrap(sampler.wrap_s), wrap(sampler.wrap_t)],
        is_nearest: sampler.mag_filter == Some(NEAREST),
    })
}

/// Gives the triangles of `surface` from `first_triangle` on, whose vertices begin at `first_vertex` and are as many as `vertex_count`, their
/// texture coordinates. Without a `source`, or where the file has no usable ones, they get (0, 0).
pub(super) fn add_corner_uvs(
    surface: &mut Surface,
    first_triangle: usize,
    (first_vertex, vertex_count): (u32, usize),
    attributes: &Attributes,
    source: Option<UvSource>,
    accessors: &Accessors<'_>,
    warnings: &mut Warnings,
) {
    let uvs = source.and_then(|source| {
        uvs(attributes, source, vertex_count, accessors)
            .map_err(|message| {
                let words =
                    ["primitive has no texture coordinates to use", "primitives have no texture coordinates to use"];
                warnings.add_one(words, || message);
            })
            .ok()
    });
    let Some(uvs) = uvs else {
        // Nothing has a texture so far: an empty list says the same.
        if !surface.corner_uvs.is_empty() {
            surface.corner_uvs.resize(surface.triangles.len(), [Vec2::ZERO; 3]);
        }
        return;
    };
    let bad = uvs.iter().filter(|uv| !uv.is_finite()).count();
    let words = ["texture coordinate is not a number and became 0", "texture coordinates are not numbers and became 0"];
    warnings.add(bad, words);
    surface.corner_uvs.resize(first_triangle, [Vec2::ZERO; 3]);
    let uv = |v: u32| Some(uvs[(v - first_vertex) as usize]).filter(|uv| uv.is_finite()).unwrap_or_default();
    surface.corner_uvs.extend(surface.triangles[first_triangle..].iter().map(|corners| corners.map(uv)));
}

/// One for each vertex, turned as the material says.
fn uvs(
    attributes: &Attributes,
    source: UvSource,
    vertex_count: usize,
    accessors: &Accessors<'_>,
) -> Result<Vec<Vec2>, String> {
    let name = format!("TEXCOORD_{}", source.set);
    let accessor = attributes.get(&name).ok_or_else(|| format!("there is no {name}"))?;
    let file_uvs: Vec<[f64; 2]> = accessors.vectors(*accessor).map_err(|message| format!("{name}: {message}"))?;
    if file_uvs.len() != vertex_count {
        return Err(format!("{name} has {} elements for {vertex_count} vertices", file_uvs.len()));
    }
    let turned = |uv: [f64; 2]| source.uv_from_file.transform_point2(DVec2::from(uv)).as_vec2();
    Ok(file_uvs.into_iter().map(turned).collect())
}
