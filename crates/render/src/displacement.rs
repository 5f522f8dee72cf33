//! Vertices moved by a function of the user's own, on the GPU.
//!
//! Each vertex is moved once, into the positions that the surface, its volumes and the silhouettes share, so that what moves shadows itself exactly.
//!
//! Source: S. Brabec and H.-P. Seidel, "Shadow volumes on programmable graphics hardware", 2003, figure 5: spheres displaced by
//! procedural noise, whose silhouettes no CPU knows.

use umbrae_core::{Bounds, Deformer, Object, Pose};

/// A function in WGSL that moves the vertices of some objects, for [`crate::GpuPoser::displacing`].
#[derive(Debug, Clone, Copy)]
pub struct Displacement<'a> {
    /// Declares `fn moved(position_world: vec3f, vertex: u32, time_s: f32) -> vec3f`, and what that needs: where the vertex, which is at
    /// `position_world` and the mesh's vertex number `vertex`, shall be at `time_s`, in scene space and metres. Names that begin with
    /// `moved_` are free for helpers; it declares no bindings and no entry points.
    pub wgsl: &'a str,
    /// How far a vertex may be moved, in metres: what culls and chooses cases sees boxes so much larger. Farther it is not moved, whatever
    /// `moved` gives.
    pub max_offset_m: f64,
    /// Numbers of the objects that it moves.
    pub objects: &'a [usize],
}

/// What moves nothing.
pub(crate) const NOT_MOVED: &str =
    "fn moved(position_world: vec3f, vertex: u32, time_s: f32) -> vec3f { return position_world; }";

/// A sum of a few dozen products, each rounded, of numbers as large as what goes into a vertex.
const ROUNDINGS: f64 = 4.0 / (1 << 24) as f64;

/// `bounds`, in which a CPU has the vertices of `object`, widened so that those of the GPU are in it when none is moved farther than
/// `max_offset_m` besides.
pub(crate) fn widened(bounds: Bounds, object: &Object, max_offset_m: f64) -> Bounds {
    if bounds.is_empty() {
        return bounds;
    }
    let rounding = ROUNDINGS * (size_of_terms(object) + max_offset_m);
    let by = glam::DVec3::splat(max_offset_m + rounding);
    Bounds { min: bounds.min - by, max: bounds.max + by }
}

/// The largest number that goes into where a vertex is.
fn size_of_terms(object: &Object) -> f64 {
    let longest = |vectors: &[glam::Vec3]| vectors.iter().map(|v| v.as_dvec3().length()).fold(0.0, f64::max);
    let to = object.world_from_object;
    let reach = |to: glam::DAffine3, rest: f64| {
        let stretch = to.matrix3.col(0).length() + to.matrix3.col(1).length() + to.matrix3.col(2).length();
        stretch * rest + to.translation.length()
    };
    let rest = longest(object.mesh.positions());
    let Some(Pose { deformer, morph_weights, joints }) = &object.pose else { return reach(to, rest) };
    let Deformer { morph_offsets, .. } = &**deformer;
    let of_target = |(offsets, weight): (&Vec<glam::Vec3>, &f32)| f64::from(weight.abs()) * longest(offsets);
    let rest = rest + morph_offsets.iter().zip(morph_weights).map(of_target).sum::<f64>();
    joints.iter().map(|&joint| reach(to * joint, rest)).fold(reach(to, rest), f64::max)
}
