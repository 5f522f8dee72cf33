//! What was drawn for each light and caster, what was not, and why.

use umbrae_core::{Case, PixelRect};

/// What became of one caster under one light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CasterReport {
    /// Drawn, or why not.
    pub fate: Fate,
    /// What its volume is made of; `None` where only the GPU knows ([`crate::SilhouetteSource`]).
    pub faces: Option<FaceCounts>,
    /// Into how many volumes it was split so that none can overlap itself more often than the stencil can count.
    pub parts: usize,
    /// Bytes of an index: 2 or 4. A triangle moves three. 0 where silhouettes are found on the GPU, which needs none.
    pub index_bytes: usize,
    /// Pixels into which its volume was drawn; `None` if it was not.
    pub rect: Option<PixelRect>,
}

impl CasterReport {
    pub(crate) fn of_fate(fate: Fate) -> Self {
        Self { fate, faces: Some(FaceCounts::default()), parts: 0, index_bytes: 0, rect: None }
    }

    /// Drawn, with faces that only the GPU knows.
    pub(crate) fn of_found(fate: Fate) -> Self {
        Self { faces: None, parts: 1, ..Self::of_fate(fate) }
    }

    pub(crate) fn faces_mut(&mut self) -> &mut FaceCounts {
        self.faces.get_or_insert_default()
    }

    /// Its case if it was drawn and the CPU knows.
    pub fn case(&self) -> Option<Case> {
        if let Fate::Drawn { case, .. } = self.fate { Some(case) } else { None }
    }
}

/// How many faces a volume has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FaceCounts {
    /// Edges on the chain's boundary, each as often as it is extruded.
    pub silhouette_edges: usize,
    /// Triangles drawn for the sides.
    pub side_triangles: usize,
    /// Triangles drawn between the silhouette of a smooth body and its mesh.
    pub closing_triangles: usize,
    /// Triangles drawn for the dark cap.
    pub dark_cap_triangles: usize,
    /// Triangles drawn for the light cap.
    pub light_cap_triangles: usize,
    /// Triangles of the chain, multiplicities counted: what a light cap and a dark cap have each. Not counted where only sides are drawn.
    pub chain_triangles: Option<usize>,
}

/// Whether a caster was drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// It casts no shadow.
    NotCasting,
    /// The light's reach is out of view, or the light is shut in a sphere that is seen from outside.
    LightUnseen,
    /// It is outside the light's reach or cone.
    Unreached,
    /// Its shadow can't be in view.
    Unseen,
    /// Its volume was drawn.
    Drawn {
        /// McGuire's case.
        case: Case,
        /// What decided it.
        why: Why,
    },
    /// Its volume was drawn, by z-pass or z-fail as the GPU decided.
    DrawnAsFound,
}

/// Why a caster is in its case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Why {
    /// No triangle of it is between the light and the near rectangle.
    NearRectangleClear,
    /// Some triangle may be between the light and the near rectangle.
    NearRectangleMayBeShaded,
    /// The method leaves no choice.
    Method,
    /// So many of its volumes hold the near rectangle, and counting started there.
    EyeCounted(u32),
    /// A side of its volume crosses the near rectangle, so no one start is right.
    SideCrossesNearRectangle,
}

/// What one light cost and drew.
#[derive(Debug, Clone)]
pub struct LightReport {
    /// One entry for each caster, in order.
    pub casters: Vec<CasterReport>,
    /// One entry for each sphere, in order: its silhouette is a polygon, and it has no indices.
    pub spheres: Vec<CasterReport>,
    /// Time on the CPU for facing, silhouettes and volumes of all casters.
    pub cpu_ms: f64,
    /// The pixels that the light may change; `None` when its reach is out of view.
    pub rect: Option<PixelRect>,
    /// How often the stencil was emptied into its mark so that it would not wrap, plus 1; 0 without volumes.
    pub batches: usize,
    /// Bytes of indices uploaded.
    pub index_bytes: usize,
}
