//! The JSON of a glTF file, as far as it concerns shapes, lights, cameras and what moves them.
//!
//! The crate `gltf` 1.4.1 does not serve here. It keeps transforms in `f32`, which at national coordinates puts a
//! building up to a metre off; its validation panics when POSITION names an accessor that does not exist; it refuses
//! files for extensions that don't concern us and for faults that do no harm. `tests/peers.rs` compares us with it
//! on good files. JSON itself is read by `serde_json`, which limits nesting and skips what is not named here.
//!
//! Indices are not checked here but where they are followed: a fault in a part that nobody draws does no harm.
//! Rare and large fields are boxed, since an empty node takes but three bytes of JSON.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::error::{Problem, quoted};
use crate::json::{json_problem, without_mark};

/// The root object.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    #[serde(default)]
    pub(super) extensions_required: Vec<String>,
    #[serde(default)]
    pub(super) extensions: RootExtensions,
    pub(super) scene: Option<usize>,
    #[serde(default)]
    pub(super) scenes: Vec<SceneRoots>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(super) skins: Vec<Skin>,
    #[serde(default)]
    pub(super) materials: Vec<Material>,
    #[serde(default)]
    pub(super) textures: Vec<Texture>,
    #[serde(default)]
    pub(super) images: Vec<Image>,
    #[serde(default)]
    pub(super) samplers: Vec<Sampler>,
    #[serde(default)]
    pub(super) cameras: Vec<Camera>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(super) animations: Vec<Animation>,
}

#[derive(Debug, Deserialize)]
struct Asset {
    version: String,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual", default)]
    pub(super) punctual: PunctualLights,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct PunctualLights {
    #[serde(default)]
    pub(super) lights: Vec<Light>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Light {
    pub(super) name: Option<String>,
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default = "white")]
    pub(super) color: [f32; 3],
    #[serde(default = "one")]
    pub(super) intensity: f32,
    pub(super) range: Option<f64>,
    #[serde(default)]
    pub(super) spot: Spot,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Spot {
    pub(super) inner_cone_angle: f64,
    pub(super) outer_cone_angle: f64,
}

impl Default for Spot {
    fn default() -> Self {
        Self { inner_cone_angle: 0.0, outer_cone_angle: std::f64::consts::FRAC_PI_4 }
    }
}

#[derive(Debug, Deserialize)]
pub(super) struct SceneRoots {
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Node {
    pub(super) name: Option<Box<str>>,
    #[serde(default)]
    pub(super) children: Box<[usize]>,
    pub(super) mesh: Option<u32>,
    pub(super) skin: Option<u32>,
    pub(super) camera: Option<u32>,
    /// Column by column.
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    /// x, y, z, w.
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
    /// In place of the mesh's.
    pub(super) weights: Option<Box<[f64]>>,
    pub(super) extensions: Option<Box<NodeExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) light: Option<LightOfNode>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing>,
}

#[derive(Debug, Deserialize)]
pub(super) struct LightOfNode {
    pub(super) light: usize,
}

/// Accessors by what they hold.
pub(super) type Attributes = BTreeMap<String, usize>;

/// Accessors of TRANSLATION, ROTATION and SCALE.
#[derive(Debug, Deserialize)]
pub(super) struct Instancing {
    #[serde(default)]
    pub(super) attributes: Attributes,
}

#[derive(Debug, Deserialize)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) primitives: Vec<Primitive>,
    /// Of the morph targets.
    #[serde(default)]
    pub(super) weights: Vec<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    #[serde(default)]
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    #[serde(default = "triangles")]
    pub(super) mode: u32,
    /// Morph targets: what each adds to each attribute.
    #[serde(default)]
    pub(super) targets: Vec<Attributes>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    #[serde(default)]
    pub(super) joints: Vec<usize>,
    pub(super) inverse_bind_matrices: Option<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Animation {
    pub(super) name: Option<Box<str>>,
    #[serde(default)]
    pub(super) channels: Box<[Channel]>,
    #[serde(default)]
    pub(super) samplers: Box<[KeySampler]>,
}

/// What of an animation moves one thing.
#[derive(Debug, Deserialize)]
pub(super) struct Channel {
    pub(super) sampler: Option<usize>,
    #[serde(default)]
    pub(super) target: Target,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Target {
    pub(super) node: Option<usize>,
    #[serde(default)]
    pub(super) path: Box<str>,
}

#[derive(Debug, Deserialize)]
pub(super) struct KeySampler {
    /// Accessor of the keys' times, in seconds.
    pub(super) input: Option<usize>,
    /// Accessor of their values.
    pub(super) output: Option<usize>,
    pub(super) interpolation: Option<Box<str>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) pbr_metallic_roughness: Pbr,
    pub(super) alpha_mode: Option<String>,
    pub(super) alpha_cutoff: Option<f32>,
    #[serde(default)]
    pub(super) extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Pbr {
    pub(super) base_color_factor: Option<[f32; 4]>,
    pub(super) base_color_texture: Option<Box<TextureOfMaterial>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureOfMaterial {
    pub(super) index: usize,
    #[serde(default)]
    pub(super) tex_coord: u32,
    #[serde(default)]
    pub(super) extensions: TextureOfMaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct TextureOfMaterialExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<TextureTransform>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureTransform {
    #[serde(default)]
    pub(super) offset: [f64; 2],
    /// Counter-clockwise, seen with v down.
    #[serde(default)]
    pub(super) rotation: f64,
    #[serde(default = "unscaled")]
    pub(super) scale: [f64; 2],
    /// In place of the material's.
    pub(super) tex_coord: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_transmission")]
    pub(super) transmission: Option<Transmission>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Transmission {
    #[serde(default)]
    pub(super) transmission_factor: f32,
}

#[derive(Debug, Deserialize)]
pub(super) struct Texture {
    pub(super) name: Option<Box<str>>,
    pub(super) sampler: Option<u32>,
    /// Extensions have their own, in formats that we don't read.
    pub(super) source: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image {
    pub(super) name: Option<Box<str>>,
    pub(super) uri: Option<Box<str>>,
    pub(super) buffer_view: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Sampler {
    pub(super) mag_filter: Option<u32>,
    pub(super) wrap_s: Option<u32>,
    pub(super) wrap_t: Option<u32>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    pub(super) perspective: Option<Perspective>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Perspective {
    pub(super) yfov: f64,
    pub(super) znear: f64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Box<Sparse>>,
}

/// Elements that replace those of the accessor.
#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: usize,
    pub(super) uri: Option<String>,
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

fn unscaled() -> [f64; 2] {
    [1.0; 2]
}

fn one() -> f32 {
    1.0
}

fn triangles() -> u32 {
    4
}

impl Document {
    /// Reads the JSON, and refuses what is not glTF 2.
    pub(super) fn read(json: &[u8]) -> Result<Self, Problem> {
        #[derive(Deserialize)]
        struct Head {
            asset: Asset,
        }
        let json = without_mark(json);
        match serde_json::from_slice::<Self>(json) {
            Ok(document) => document.asset.check().map(|()| document),
            Err(error) => {
                // The document of another version fails for its differences: better to name the version.
                let head: Option<Head> = serde_json::from_slice(json).ok();
                head.map_or(Ok(()), |head| head.asset.check())?;
                Err(json_problem(&error))
            }
        }
    }
}

impl Asset {
    fn check(&self) -> Result<(), Problem> {
        if self.version.starts_with("2.") {
            return Ok(());
        }
        let version = quoted(&self.version);
        Err(Problem::whole(format!("it is glTF version {version}; only 2 can be read, so convert it")))
    }
}
