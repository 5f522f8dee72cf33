//! Exact stencil shadow volumes on wgpu: a scene of `umbrae-core` into pixels, headless or in a window.
//!
//! Read [`frame`] first: it is the list of passes in order. [`Renderer`] is where a program starts.
//!
//! Ownership is short: [`Gpu`] owns the device, [`GpuScene`] the geometry, each pass its pipelines, [`Targets`] the textures,
//! and a frame only borrows. Nothing here blocks, reads a file or knows a window; what waits is `async`.

mod caps;
mod displacement;
pub mod frame;
mod gpu;
mod gpu_finishes;
mod gpu_poser;
mod gpu_scene;
mod growing;
mod look;
mod mipmap;
mod overlay;
mod passes;
mod posing;
mod prepared;
mod readback;
mod renderer;
mod shaders;
mod shadow;
pub mod soft;
mod targets;
mod texture_displacer;
mod timing;
mod uniforms;
mod verify;

pub use caps::{Caps, Tier};
pub use displacement::Displacement;
pub use gpu::{AdapterChoice, Gpu, GpuError, adapter_labels};
pub use gpu_poser::GpuPoser;
pub use gpu_scene::GpuScene;
pub use look::Look;
pub use overlay::{Overlay, OverlayColor, OverlayVertex};
pub use posing::{Poser, Posing};
pub use renderer::{Mask, Picture, PreparedShadows, Renderer, Shot, Visibility};
pub use shadow::{
    CasterReport, FaceCounts, Fate, FoundShadows, FoundSilhouette, FoundSmoothSilhouette, LIT, LightMark, LightReport,
    Method, ShadowCasters, ShadowLight, ShadowOptions, ShadowSums, ShadowTarget, ShadowView, Shadows, SilhouetteSource,
    Smooth, Why,
};
pub use targets::{Output, Targets};
pub use texture_displacer::TextureDisplacer;
pub use timing::PassTime;
pub use verify::{Comparison, compare};
