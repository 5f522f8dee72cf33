//! One light in the report: what it is, what it drew for each caster, and what it left out.

use glam::DVec3;
use serde::Serialize;
use umbrae_core::{Case, Caster, Cone, Extent, Light, PixelRect, Role, Sphere};
use umbrae_render::{CasterReport, FaceCounts, Fate, LightReport, Why};

/// One light and what it drew.
///
/// A directional light gives a surface that faces it `strength`. A lamp d metres away gives it `strength / d^2 * (1 - (d / range)^4)`, and
/// nothing from its range on; a spot that times `edge^2`, where `edge` goes from 1 to 0 as the cosine of the angle from the cone's middle
/// goes from that of `inner_deg` to that of `outer_deg`.
#[derive(Debug, Serialize)]
pub struct LightJson {
    name: String,
    /// "directional", "point" or "spot".
    kind: &'static str,
    /// Of a point or a spot.
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<[f64; 3]>,
    /// Of a directional light: the unit vector towards it.
    #[serde(skip_serializing_if = "Option::is_none")]
    direction_to_light: Option<[f64; 3]>,
    /// Of a spot.
    #[serde(skip_serializing_if = "Option::is_none")]
    cone: Option<ConeJson>,
    /// Of a point or a spot: metres at which it has faded to nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    range: Option<f64>,
    /// Of a light that is drawn with soft shadows: how large it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    extent: Option<ExtentJson>,
    /// `color` times `intensity`: irradiance of a directional light, and of a lamp at 1 m.
    strength: [f32; 3],
    /// Linear; the strongest channel is 1, or all are 0.
    color: [f32; 3],
    /// Of the strongest channel: lux of a directional light, candela of a lamp.
    intensity: f32,
    /// Time on the CPU for facing, silhouettes and volumes of all casters.
    silhouettes_and_volumes_ms: f64,
    /// The pixels that it may change; absent if it is out of view.
    #[serde(skip_serializing_if = "Option::is_none")]
    scissor: Option<Rect>,
    /// How often counting was interrupted so that the stencil could not overflow, plus 1; 0 without volumes.
    batches: usize,
    /// How many casters are in McGuire's cases 1, 2 and 3.
    cases: [usize; 3],
    /// How many casters were not drawn, by the rule that left them out.
    culled: Culled,
    /// What this light's volumes cost.
    cost: Cost,
    /// With `--count-fragments`: the same with nothing left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    cost_without_culling: Option<Cost>,
    /// One entry for each object, the ground last, and then for each sphere; an object in which only some triangles cast has two, of one name.
    casters: Vec<CasterJson>,
}

impl LightJson {
    /// `light` of a scene about `origin`, with what was measured about it if anything was.
    pub fn new(
        light: &Light,
        report: &LightReport,
        measured: Option<[Cost; 2]>,
        (casters, spheres): (&[Caster], &[Sphere]),
        origin: DVec3,
    ) -> Self {
        let xyz = light.position.homogeneous().truncate();
        let is_directional = light.position.is_directional();
        let intensity = light.strength.max_element();
        let in_case = |number| all(report).filter(|c| c.case().map(Case::number) == Some(number)).count();
        let (cost, cost_without_culling) = match measured {
            Some([with, without]) => (with, Some(without)),
            None => (Cost::new(report, None), None),
        };
        Self {
            name: light.name.clone(),
            kind: match light.cone {
                _ if is_directional => "directional",
                Some(_) => "spot",
                None => "point",
            },
            position: (!is_directional).then(|| (xyz + origin).to_array()),
            direction_to_light: is_directional.then(|| xyz.to_array()),
            cone: light.cone.filter(|_| !is_directional).map(Into::into),
            range: light.range_m.filter(|_| !is_directional),
            extent: ExtentJson::new(light.extent),
            strength: light.strength.to_array(),
            color: (light.strength / if intensity > 0.0 { intensity } else { 1.0 }).to_array(),
            intensity,
            silhouettes_and_volumes_ms: report.cpu_ms,
            scissor: report.rect.map(Into::into),
            batches: report.batches,
            cases: [1, 2, 3].map(in_case),
            culled: Culled::new(report),
            cost,
            cost_without_culling,
            casters: casters
                .iter()
                .zip(&report.casters)
                .map(|(caster, report)| CasterJson::new("mesh", &caster.name, caster.role, report))
                .chain(
                    spheres
                        .iter()
                        .zip(&report.spheres)
                        .map(|(sphere, report)| CasterJson::new("sphere", &sphere.name, Role::default(), report)),
                )
                .collect(),
        }
    }
}

/// How large a light is.
#[derive(Debug, Serialize)]
#[serde(rename_all = "lowercase", tag = "shape")]
enum ExtentJson {
    /// About a lamp's position.
    Ball {
        /// Metres.
        radius: f64,
    },
    /// About a lamp's position; it shines to the side where `right x up` points.
    Rectangle {
        /// From the middle to the middle of the right side.
        half_right: [f64; 3],
        /// From the middle to the middle of the upper side.
        half_up: [f64; 3],
    },
    /// About a direction.
    Disc {
        /// From the middle to the edge.
        radius_deg: f64,
    },
}

impl ExtentJson {
    fn new(extent: Extent) -> Option<Self> {
        Some(match extent {
            Extent::Point => return None,
            Extent::Sphere { radius_m } => Self::Ball { radius: radius_m },
            Extent::Rectangle { half_right, half_up } => {
                Self::Rectangle { half_right: half_right.to_array(), half_up: half_up.to_array() }
            }
            Extent::Disc { radius_rad } => Self::Disc { radius_deg: radius_rad.to_degrees() },
        })
    }
}

/// Where a spot shines.
#[derive(Debug, Serialize)]
struct ConeJson {
    /// The unit vector along its middle, away from the light.
    direction: [f64; 3],
    /// From the middle to where its edge begins.
    inner_deg: f64,
    /// From the middle to where it ends.
    outer_deg: f64,
}

impl From<Cone> for ConeJson {
    fn from(cone: Cone) -> Self {
        Self {
            direction: cone.axis.to_array(),
            inner_deg: cone.inner_rad.to_degrees(),
            outer_deg: cone.outer_rad.to_degrees(),
        }
    }
}

/// Pixels of the picture, from the top left.
#[derive(Debug, Clone, Copy, Serialize)]
struct Rect {
    /// The first column and row.
    min: [u32; 2],
    /// One past the last column and row.
    max: [u32; 2],
}

impl From<PixelRect> for Rect {
    fn from(PixelRect { min, max }: PixelRect) -> Self {
        Self { min, max }
    }
}

/// How many casters were not drawn, and why.
#[derive(Debug, Default, Serialize)]
struct Culled {
    /// They cast no shadow: see `--cast`.
    not_casting: usize,
    /// The light's reach is out of view.
    light_out_of_view: usize,
    /// They are outside the light's range or cone.
    out_of_reach: usize,
    /// Their shadow can't be in view.
    shadow_out_of_view: usize,
}

impl Culled {
    fn new(report: &LightReport) -> Self {
        let mut culled = Self::default();
        for caster in all(report) {
            match caster.fate {
                Fate::NotCasting => culled.not_casting += 1,
                Fate::LightUnseen => culled.light_out_of_view += 1,
                Fate::Unreached => culled.out_of_reach += 1,
                Fate::Unseen => culled.shadow_out_of_view += 1,
                Fate::Drawn { .. } | Fate::DrawnAsFound => {}
            }
        }
        culled
    }
}

/// What the volumes of one light cost.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Cost {
    /// All casters together; absent where only the GPU knows.
    #[serde(skip_serializing_if = "Option::is_none")]
    triangles: Option<TrianglesByPart>,
    /// Bytes of indices uploaded.
    index_bytes: usize,
    /// With `--count-fragments`: fragments rasterised into the stencil, those of marks included, one sample a pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    fragments: Option<u64>,
}

impl Cost {
    /// Of what `report` tells, with the fragments if they were counted.
    pub fn new(report: &LightReport, fragments: Option<u64>) -> Self {
        Self {
            triangles: all(report).map(|caster| caster.faces.map(TrianglesByPart::from)).sum(),
            index_bytes: report.index_bytes,
            fragments,
        }
    }
}

/// What casts, meshes first.
fn all(report: &LightReport) -> impl Iterator<Item = &CasterReport> {
    report.casters.iter().chain(&report.spheres)
}

/// One caster under one light.
#[derive(Debug, Serialize)]
struct CasterJson {
    name: String,
    /// "mesh" or "sphere".
    kind: &'static str,
    /// Whether it casts at all: see `--cast`, `--no-cast` and `--glass-casts`.
    casts: bool,
    /// Whether what is behind it shows through.
    is_glass: bool,
    /// "drawn", or why it was not: "not casting", "light out of view", "out of reach" or "shadow out of view".
    fate: &'static str,
    /// McGuire's: 1 z-pass, 2 z-fail without light cap, 3 z-fail; absent if it was not drawn, or if only the GPU knows.
    #[serde(skip_serializing_if = "Option::is_none")]
    case: Option<u32>,
    /// What decided the case: "near rectangle clear", "near rectangle may be shaded", "method", "eye counted" or "side crosses near rectangle".
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<&'static str>,
    /// By the method `eye-count`: how many of its volumes the eye is in.
    #[serde(skip_serializing_if = "Option::is_none")]
    volumes_around_eye: Option<u32>,
    /// Different edges between what is turned to the light and what is not; this and the next two are absent where only the GPU knows.
    #[serde(skip_serializing_if = "Option::is_none")]
    silhouette_edges: Option<usize>,
    /// What its shadow volume is drawn with.
    #[serde(skip_serializing_if = "Option::is_none")]
    triangles: Option<TrianglesByPart>,
    /// What each cap would have if it were drawn whole; null where z-pass draws only sides, and nobody has counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    chain_triangles: Option<Option<usize>>,
    /// Into how many volumes it was split so that none can overlap itself more often than the stencil can count.
    parts: usize,
    /// Bytes of each of a triangle's three indices: 2 or 4; 0 if it was not drawn.
    bytes_per_index: usize,
    /// The pixels into which its volume was drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    scissor: Option<Rect>,
}

#[derive(Debug, Clone, Copy, Default, Serialize)]
struct TrianglesByPart {
    /// Between the silhouette and its shadow.
    sides: usize,
    /// At infinity.
    dark_cap: usize,
    /// On the caster itself.
    light_cap: usize,
}

impl From<FaceCounts> for TrianglesByPart {
    fn from(faces: FaceCounts) -> Self {
        Self { sides: faces.side_triangles, dark_cap: faces.dark_cap_triangles, light_cap: faces.light_cap_triangles }
    }
}

impl std::iter::Sum for TrianglesByPart {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |a, b| Self {
            sides: a.sides + b.sides,
            dark_cap: a.dark_cap + b.dark_cap,
            light_cap: a.light_cap + b.light_cap,
        })
    }
}

impl CasterJson {
    fn new(kind: &'static str, name: &str, role: Role, report: &CasterReport) -> Self {
        let why = if let Fate::Drawn { why, .. } = report.fate { Some(why) } else { None };
        Self {
            name: name.to_owned(),
            kind,
            casts: role.casts,
            is_glass: role.is_glass,
            fate: match report.fate {
                Fate::NotCasting => "not casting",
                Fate::LightUnseen => "light out of view",
                Fate::Unreached => "out of reach",
                Fate::Unseen => "shadow out of view",
                Fate::Drawn { .. } | Fate::DrawnAsFound => "drawn",
            },
            case: report.case().map(Case::number),
            why: why.map(|why| match why {
                Why::NearRectangleClear => "near rectangle clear",
                Why::NearRectangleMayBeShaded => "near rectangle may be shaded",
                Why::Method => "method",
                Why::EyeCounted(_) => "eye counted",
                Why::SideCrossesNearRectangle => "side crosses near rectangle",
            }),
            volumes_around_eye: if let Some(Why::EyeCounted(volumes)) = why { Some(volumes) } else { None },
            silhouette_edges: report.faces.map(|faces| faces.silhouette_edges),
            triangles: report.faces.map(TrianglesByPart::from),
            chain_triangles: report.faces.map(|faces| faces.chain_triangles),
            parts: report.parts,
            bytes_per_index: report.index_bytes,
            scissor: report.rect.map(Into::into),
        }
    }
}
