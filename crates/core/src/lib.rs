//! Exact shadows without a GPU: meshes and what is known about them, lights, cameras, scenes; silhouettes
//! and shadow volumes; and an independent ray caster that says whether they are right.
//!
//! Conventions, everywhere in this project:
//!
//! - metres; radians; world axes x east, y north, z up, right-handed;
//! - mesh positions are `f32` about a scene origin in `f64`, so that what is reasoned about here is, bit
//!   for bit, what a GPU draws;
//! - a light is a homogeneous position `(x, y, z, w)`: `w = 1` a point, `w = 0` the direction towards it;
//! - opaque surfaces block light from both sides;
//! - matrices and transforms are named `to_from_from`.
//!
//! Data flows one way: [`Scene`] -> [`Caster`]s -> (for a [`Light`]) [`Chain`] -> silhouette ->
//! [`ShadowVolume`] -> counts.

mod bounds;
mod bvh;
mod camera;
mod case;
mod caster;
mod chain;
mod convex;
mod counting;
mod cull;
mod disc;
mod eye_count;
mod few;
mod light;
mod light_cut;
mod mesh;
mod oracle;
mod overlap;
mod penumbra;
mod pose;
mod ray;
mod reach;
mod role;
mod scene;
mod screen;
pub mod shapes;
mod silhouette;
mod smooth;
mod sphere;
mod square;
mod texture;
mod topology;
mod volume;
mod winding;

pub use bounds::Bounds;
pub use camera::{Camera, CameraError};
pub use case::{Case, CaseChooser};
pub use caster::Caster;
pub use chain::{Chain, Counting};
pub use convex::ConvexRegion;
pub use cull::Culler;
pub use disc::{SUN_DIAMETER_RAD, disc_sector, disc_segment, disc_share};
pub use light::{Cone, Extent, Light, LightPosition};
pub use light_cut::distance_to_triangle;
pub use mesh::{Mesh, MeshCounts, MeshError, Surface};
pub use oracle::{Judgement, Oracle, SeenLight, Verdict};
pub(crate) use overlap::{Chart, Stack, ahead_of, most_overlaps_of};
pub use overlap::{most_overlaps, needs_light_cap, split_chain};
pub use penumbra::LightFace;
pub use pose::{Deformer, Influence, Pose};
pub use ray::{Hit, RayCaster};
pub use reach::Reach;
pub use role::Role;
pub use scene::{AlphaMode, Material, NamedCamera, Object, Scene, SceneError, SurfaceKind};
pub use screen::PixelRect;
pub use silhouette::{
    Finder, FinderKind, Found, NormalFinder, Outline, SavedError, SilhouetteEdge, Silhouettes, silhouette,
};
pub use smooth::{
    NO_BEND, NotSmooth, OnScreen, Precision, SmoothBody, SmoothTables, SmoothVolume, Smoothness, TwoSidedCrease,
    corner_normals, given_normals,
};
pub use sphere::{Sphere, SphereVolume};
pub use square::square_segment;
pub use texture::{Texture, Wrap};
pub use topology::{Component, Edge, Topology, TopologyCounts};
pub use volume::ShadowVolume;
pub use winding::Windings;
