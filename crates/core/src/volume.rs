//! Everything that a caster hides from a light, as a closed body that reaches to infinity.
//!
//! ```text
//!       light
//!         *
//!        / \        light cap   the chain itself
//!       /___\       sides       the silhouette, swept away from the light to infinity
//!      /     \      dark cap    the chain at infinity, turned round; a directional light
//!     /       \                 needs none, for there all its points are one
//!    v         v
//! ```
//!
//! Faces are counter-clockwise seen from outside the volume, so a path that enters it meets a front face.
//!
//! Source: M. McGuire et al. 2003, sections 2 and 6.

use glam::{DVec4, Vec3};

use crate::{Caster, Chain, LightPosition, SilhouetteEdge, silhouette};

/// The shadow volume of one caster and one light, as vertex indices of the caster.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShadowVolume {
    /// Silhouette edges as the lit side walks them; one of multiplicity m is here m times.
    pub sides: Vec<[u32; 2]>,
    /// Triangles that face the light; the dark cap is the same triangles at infinity, wound the other way.
    ///
    /// Without any in a volume [of sides alone](ShadowVolume::of_sides).
    pub light_cap: Vec<[u32; 3]>,
    /// Triangles of the chain, multiplicities counted, at most; as many as the light cap has where there is one.
    pub most_triangles: usize,
}

impl ShadowVolume {
    /// The volume over `chain`, a chain of `caster`.
    pub fn new(caster: &Caster, chain: &Chain) -> Self {
        let edges = silhouette(&caster.topology, chain);
        let repeat = |e: &SilhouetteEdge| std::iter::repeat_n([e.start, e.end], e.multiplicity as usize);
        Self::of_boundary(caster, chain, &edges.iter().flat_map(repeat).collect::<Vec<_>>())
    }

    /// The volume of `caster` with `sides` and without its caps, which are not drawn where z-pass counts.
    ///
    /// Linear in the number of sides.
    pub fn of_sides(caster: &Caster, sides: &[[u32; 2]]) -> Self {
        Self { sides: sides.to_vec(), light_cap: Vec::new(), most_triangles: caster.mesh.triangles().len() }
    }

    /// The volume over `chain`, a chain of `caster` whose boundary is `sides`.
    ///
    /// Linear in the number of triangles.
    pub fn of_boundary(caster: &Caster, chain: &Chain, sides: &[[u32; 2]]) -> Self {
        let light_cap: Vec<[u32; 3]> = caster
            .mesh
            .triangles()
            .iter()
            .zip(chain.coefficients())
            .flat_map(|(&[a, b, c], &times)| {
                let turned = if times > 0 { [a, b, c] } else { [a, c, b] };
                std::iter::repeat_n(turned, times.unsigned_abs().into())
            })
            .collect();
        Self { sides: sides.to_vec(), most_triangles: light_cap.len(), light_cap }
    }

    /// Whether the sides are the light cap's boundary, each as often as it is walked, so that the volume is closed.
    ///
    /// Looks at indices alone. Linear in the number of faces, but for sorting; never of a volume [of sides alone](ShadowVolume::of_sides).
    pub fn is_closed(&self) -> bool {
        let of_cap = self.light_cap.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let backward = self.sides.iter().map(|&[start, end]| [end, start]);
        let walked = of_cap.chain(backward).filter(|[a, b]| a != b);
        let mut directed: Vec<([u32; 2], i32)> =
            walked.map(|[a, b]| if a < b { ([a, b], 1) } else { ([b, a], -1) }).collect();
        directed.sort_unstable();
        directed.chunk_by(|a, b| a.0 == b.0).all(|edge| edge.iter().map(|(_, times)| times).sum::<i32>() == 0)
    }

    /// The faces that are not at infinity, as homogeneous triangles: light cap, then sides.
    ///
    /// A side is a quad (two triangles) for a point light and one triangle for a directional one. The diagonal of a
    /// quad starts at the lower vertex of its edge, so that the quads of one edge cancel exactly, whichever way each runs.
    pub fn finite_faces<'a>(
        &'a self,
        positions: &'a [Vec3],
        light: LightPosition,
    ) -> impl Iterator<Item = [DVec4; 3]> + 'a {
        let near = move |i: u32| positions[i as usize].as_dvec3().extend(1.0);
        let far = move |i: u32| -light.offset_from(positions[i as usize].as_dvec3()).extend(0.0);
        let cap = self.light_cap.iter().map(move |t| t.map(near));
        let sides = self.sides.iter().flat_map(move |&[start, end]| {
            let (a, b, a_far, b_far) = (near(start), near(end), far(start), far(end));
            let first = if light.is_directional() {
                [a, a_far, b]
            } else if start < end {
                [a, b_far, b]
            } else {
                [b, a, a_far]
            };
            let second = if start < end { [a, a_far, b_far] } else { [b, a_far, b_far] };
            std::iter::once(first).chain((!light.is_directional()).then_some(second))
        });
        cap.chain(sides)
    }

    /// The dark cap as directions: empty for a directional light.
    pub fn dark_cap<'a>(
        &'a self,
        positions: &'a [Vec3],
        light: LightPosition,
    ) -> impl Iterator<Item = [DVec4; 3]> + 'a {
        let far = move |i: u32| -light.offset_from(positions[i as usize].as_dvec3()).extend(0.0);
        let cap = if light.is_directional() { &[] } else { self.light_cap.as_slice() };
        cap.iter().map(move |&[a, b, c]| [far(a), far(c), far(b)])
    }
}
