//! Soft shadows: how much of a light with a size reaches what is seen.
//!
//! ```text
//! for each group of casters whose shadows are in different places of the picture:
//!   coverage     reset; the hard count of each from the light's centre, and each silhouette edge's share in its wedge, added up
//!   composite    visibility *= 1 - coverage, quarter by quarter of the light
//! light          this light, times the mean of what is left of its quarters
//! ```
//!
//! ```text
//!   plan       what each caster draws: segments, caps, rectangles, groups      coverage    pipelines of the two passes
//!   targets    where coverage and visibility go                                 light       surfaces and spheres in what is left
//! ```
//!
//! The share of a light that one caster covers is exact for its silhouette from the light's centre (`light_face.wgsl`). What is not:
//!
//! - Seen from the light's border a thick caster has another silhouette than from its centre. Near large lights that shows.
//! - Within a caster, what covers the light twice is counted twice, and no more than all of the light is covered. Bodies that are behind each other
//!   as the light sees them, in one caster, make its penumbra too dark where each covers a part.
//! - Different casters are taken as independent: what is left of each quarter of the light is the product of what each leaves. The truth is between the least of
//!   them and their sum less one. With quarters, casters that cover the light from different sides are right.
//! - A caster that cuts through the light itself is cut along no edge.
//!
//! Sources: U. Assarsson and T. Akenine-Möller, "A geometry-based soft shadow volume algorithm using graphics hardware", 2003. Departures: areas are
//! in closed form; edges need no neighbours, as hulls only have to hold all from where an edge is seen in front of the light; the side of an
//! edge is decided once, for the hard count and for the edge alike.

mod coverage;
mod light;
mod plan;
mod targets;

pub(crate) use coverage::{SoftLight, SoftPass};
pub(crate) use light::SoftLightPass;
pub(crate) use targets::SoftTargets;
