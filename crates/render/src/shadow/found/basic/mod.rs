//! Silhouettes found in textures, for devices that have neither compute shaders nor storage buffers (WebGL2).
//!
//! ```text
//!   positions     one texel a vertex; uploaded, or drawn where a shader moves them
//!       |
//!   coefficients  one fragment a triangle: c = -1, 0 or +1 for each of 64 lights, two bits each
//!       |
//!   multiplicities  one fragment an edge: how often each light's silhouette runs along it, as a sum over its triangles
//!       |
//!   volumes       every edge is drawn, so often as it might be a side; the vertex shader moves what is none out of the frustum
//! ```
//!
//! Source: S. Brabec and H.-P. Seidel, "Shadow volumes on programmable graphics hardware", 2003. Their step 2 tests an edge's two triangles
//! in one shader and so needs closed 2-manifolds; here each triangle is tested once, in a pass of its own, and edges add up what was
//! stored, so that the volume is closed for any mesh and any rounding. Their edges then go through the CPU, because
//! vertex shaders could not read textures; here they stay.
//!
//! | file | |
//! |---|---|
//! | `parts` | casters in parts that the stencil can count |
//! | `tables` | triangles, edges and positions as textures |
//! | `finder` | the two passes |
//! | `volumes` | what is drawn of the results |

mod finder;
mod parts;
mod tables;
#[cfg(test)]
mod tests;
