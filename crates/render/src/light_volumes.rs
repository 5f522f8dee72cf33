//! The shadow volumes of one light, as index lists ready to draw.

use glam::DVec3;
use umbrae_core::{Camera, Case, CaseChooser, Caster, Chain, Counting, LightPosition, ShadowVolume, Windings};

use crate::gpu_scene::AXES;

/// How volumes are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// z-pass where nothing of the near rectangle can be in the caster's shadow, else z-fail. Always right.
    #[default]
    Auto,
    /// z-pass for all: wrong where the near rectangle is in shadow.
    ZPass,
    /// z-fail for all: always right, and dearer.
    ZFail,
}

/// What was drawn for one caster and one light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CasterReport {
    /// McGuire's case.
    pub case: Case,
    /// Different edges on the chain's boundary.
    pub silhouette_edges: usize,
    /// Triangles drawn for the sides.
    pub side_triangles: usize,
    /// Triangles drawn for the dark cap.
    pub dark_cap_triangles: usize,
    /// Triangles drawn for the light cap.
    pub light_cap_triangles: usize,
}

/// Indices into [`crate::GpuScene`]'s volume vertices, three a triangle, by the way they are counted.
#[derive(Debug, Clone, Default)]
pub struct LightVolumes {
    /// Sides of casters in case 1.
    pub(crate) zpass: Vec<u32>,
    /// Sides and dark caps of casters in cases 2 and 3.
    pub(crate) zfail: Vec<u32>,
    /// Light caps of casters in case 3, which lie on surfaces that are drawn.
    pub(crate) light_caps: Vec<u32>,
    /// One entry for each caster, in order.
    pub casters: Vec<CasterReport>,
}

impl LightVolumes {
    /// The volumes of all `casters`; `seen` has each caster's [`Windings::of_near_rectangle`], and `chooser` is for the same camera and
    /// for `light`.
    ///
    /// Linear in the number of triangles.
    pub fn new(
        casters: &[Caster],
        seen: &[Windings],
        chooser: &CaseChooser,
        light: LightPosition,
        method: Method,
    ) -> Self {
        let mut volumes = Self::default();
        let mut first_vertex = AXES.len() as u32;
        for (caster, seen) in casters.iter().zip(seen) {
            let case = match method {
                Method::Auto => chooser.case(caster),
                Method::ZPass => Case::Pass,
                Method::ZFail => chooser.case_without_zpass(caster),
            };
            let counting = Counting::choose(caster, seen, &Windings::of_light(caster, light));
            let chain = Chain::new(caster, light, &counting);
            let volume = ShadowVolume::new(caster, &chain);
            let report = volumes.add(caster, &volume, case, light, first_vertex);
            volumes.casters.push(report);
            first_vertex += 2 * caster.positions.len() as u32;
        }
        volumes
    }

    fn add(
        &mut self,
        caster: &Caster,
        volume: &ShadowVolume,
        case: Case,
        light: LightPosition,
        first_vertex: u32,
    ) -> CasterReport {
        let is_directional = light.is_directional();
        let vertex_count = caster.positions.len() as u32;
        let near = |i: u32| first_vertex + i;
        let far = |i: u32| first_vertex + vertex_count + i;
        let target = if case == Case::Pass { &mut self.zpass } else { &mut self.zfail };
        let before = target.len();
        for &[a, b] in &volume.sides {
            if is_directional {
                target.extend([near(a), far(a), near(b)]);
            } else if a < b {
                // The diagonal starts at the lower vertex, so that quads of one edge that run both ways cancel exactly.
                target.extend([near(a), far(a), far(b), near(a), far(b), near(b)]);
            } else {
                target.extend([near(b), near(a), far(a), near(b), far(a), far(b)]);
            }
        }
        let side_triangles = (target.len() - before) / 3;
        let mut report = CasterReport {
            case,
            silhouette_edges: volume.silhouette_edges,
            side_triangles,
            dark_cap_triangles: 0,
            light_cap_triangles: 0,
        };
        if case != Case::Pass && !is_directional {
            let before = target.len();
            for &[a, b, c] in &volume.light_cap {
                let away = |i: u32| -light.offset_from(caster.positions[i as usize].as_dvec3());
                match fan_axis([away(a), away(b), away(c)]) {
                    None => target.extend([far(a), far(c), far(b)]),
                    Some(m) => target.extend([far(a), far(c), m, far(c), far(b), m, far(b), far(a), m]),
                }
            }
            report.dark_cap_triangles = (target.len() - before) / 3;
        }
        if case == Case::Fail {
            self.light_caps.extend(volume.light_cap.iter().flatten().map(|&i| near(i)));
            report.light_cap_triangles = volume.light_cap.len();
        }
        report
    }

    /// Cases for `camera` and `light`, over `casters`.
    pub fn chooser(camera: &Camera, light: LightPosition, casters: &[Caster]) -> CaseChooser {
        CaseChooser::new(camera, light, &Caster::bounds_of(casters))
    }
}

/// The cosine, between the triangle's normal and the direction to a corner, below which all directions are nearly in one plane.
const FLAT: f64 = 0.05;

/// The volume vertex about which the dark cap of a triangle must be a fan; `None` where it may be the triangle itself.
///
/// `away` points from the light to the corners, as they turn counter-clockwise seen from the light. Under a lamp close to a large triangle they spread
/// over nearly a half-plane all round, and so a cap of three such corners is clipped with errors of many pixels (for `f32`, and for McGuire's
/// "more than 180 degrees" ambiguous). Its shape does not matter, only its border: a fan about the axis that points away from the lamp most nearly
/// at a right angle to the triangle has only narrow triangles.
fn fan_axis(away: [DVec3; 3]) -> Option<u32> {
    let [a, b, c] = away;
    let is_wide = a.dot(b) < 0.0 || b.dot(c) < 0.0 || c.dot(a) < 0.0;
    if !is_wide {
        return None;
    }
    let normal_to_light = (b - a).cross(c - a);
    if a.dot(normal_to_light).abs() > FLAT * a.length() * normal_to_light.length() {
        return None;
    }
    let downness = |axis: &DVec3| -axis.dot(normal_to_light);
    let best = (0..AXES.len()).max_by(|&i, &j| downness(&AXES[i]).total_cmp(&downness(&AXES[j])))?;
    Some(best as u32)
}
