//! Shadow boundaries that do not show how finely a mesh is cut: silhouettes of the smooth surface that its vertex normals tell of.
//!
//! ```text
//!   normals      one for each corner, given or computed, with creases
//!   body         the mesh split at creases, once for all lights
//!   planes       how its triangles lie
//!   posed        the same body where its caster has moved to
//!   tables       the body as numbers, for other processors
//!   curve        the cubic between two points with known normals
//!   crossing     where the silhouette crosses an edge
//!   parts        objects cut into what is smooth and what is not
//!   precision    how finely it must be cut: in the world, and on the picture
//!   tessellate   the curved surface itself, as a finer mesh
//!   volume       the silhouette of a body under a light, and the volume that it closes
//!   maker        how that is made
//!   added        what is found on many threads, to be put together
//!   cut          triangles that the silhouette cuts
//!   crease       creases that it runs along
//!   facing       what is on its wrong side goes over, so that no light leaks
//!   fins         what rises from the fold to the silhouette
//!   winding      how often a silhouette goes round a place
//!   straight     points that a silhouette can do without
//! ```
//!
//! Source: O. Mattausch, D. Scherzer, M. Wimmer and T. Igarashi, "Tessellation-independent smooth shadow boundaries", 2012.

mod added;
mod body;
mod crease;
mod crossing;
mod curve;
mod cut;
mod facing;
mod fins;
mod maker;
mod normals;
mod parts;
mod planes;
mod posed;
mod precision;
mod straight;
mod tables;
mod tessellate;
#[cfg(test)]
mod tests;
mod volume;
mod winding;

/// Fewer crossings, sides or pieces than this are not worth another thread.
const AT_ONCE: usize = 256;
/// And fewer triangles than this, of which most have nothing to do.
const TRIANGLES_AT_ONCE: usize = 4096;

pub use body::{NotSmooth, SmoothBody};
pub use normals::{corner_normals, given_normals};
pub use precision::{OnScreen, Precision};
pub use tables::{NO_BEND, SmoothTables, TwoSidedCrease};
pub use volume::{SmoothVolume, Smoothness};
