//! Times of finding on the GPU, by its own clock, all lights of a frame at once; and whether what it finds is right.

use std::sync::Arc;

use anyhow::Context as _;
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use umbrae_core::{Camera, Caster, Chain, Counting, Light, LightPosition, Mesh, Object, Topology, shapes, silhouette};
use umbrae_render::{
    FoundShadows, FoundSilhouette, Gpu, GpuError, Method, ShadowCasters, ShadowOptions, ShadowTarget, ShadowView,
    Shadows, SilhouetteSource,
};
use web_time::Instant;

use super::report::{Figures, FinderTimes};

/// The ways, by name.
pub(super) const SOURCES: [(&str, SilhouetteSource); 2] =
    [("gpu", SilhouetteSource::Gpu), ("gpu-basic", SilhouetteSource::GpuBasic)];
/// Times that all lights are measured, after one that warms up; odd, so that the median is one of them.
const FRAMES: usize = 5;
/// Where the eye is, in radii from the middle; nothing here is about pixels.
const EYE: DVec3 = DVec3::new(1.1, -1.9, 0.8);
const SIZE_PX: [u32; 2] = [64, 64];
/// How far from edge-on, for the size of everything, `f32` on a GPU may turn a triangle otherwise.
const EDGE_ON: f64 = 2e-6;

/// What `source` takes for `casters` under `lights`, called `name`.
///
/// All lights are found in one frame, or in as few as the device's buffers allow. Times are those of all frames together, divided by the lights.
///
/// # Errors
///
/// When the device can't find silhouettes so, or not of so large a model, or has no clock.
pub(super) fn measure(
    gpu: &Gpu,
    casters: &[Caster],
    lights: &[LightPosition],
    (name, source): (&'static str, SilhouetteSource),
) -> anyhow::Result<FinderTimes> {
    let lights: Vec<Light> = lights.iter().map(|&light| Light::new("light", light, Vec3::ONE)).collect();
    let mut stage = Stage::new(gpu, casters, source)?;
    let per_frame = stage.lights_in_a_frame(&lights)?;
    let bytes = stage.bytes();

    let (mut edges, mut is_equal) = (0, true);
    for lights in lights.chunks(per_frame) {
        stage.find(lights)?;
        let silhouettes = pollster::block_on(stage.found.read(gpu, casters))?;
        is_equal &= silhouettes.len() == casters.len() * lights.len();
        is_equal &= silhouettes.par_iter().all(|found| is_right(found, &casters[found.caster], lights));
        edges +=
            silhouettes.iter().flat_map(|found| &found.edges).map(|edge| edge.multiplicity as usize).sum::<usize>();
    }
    let mut us = [0.0; FRAMES];
    for us in &mut us {
        for lights in lights.chunks(per_frame) {
            *us += 1e3 * stage.find(lights)?.context("the device can't tell how long it takes")?;
        }
        *us /= lights.len() as f64;
    }
    Ok(FinderTimes {
        name,
        is_by_minutes: false,
        build_ms: stage.build_ms,
        bytes,
        us: Figures::of(&mut us),
        edges_tested: casters.iter().map(|caster| caster.topology.edges().len()).sum::<usize>() as f64,
        edges_found: edges as f64 / lights.len() as f64,
        is_equal,
    })
}

/// Some casters, and what finds their silhouettes.
struct Stage<'a> {
    gpu: &'a Gpu,
    casters: &'a [Caster],
    uploaded: ShadowCasters,
    view: ShadowView,
    found: FoundShadows,
    options: ShadowOptions,
    build_ms: f64,
    /// Allocated on the GPU before there was anything to find with.
    bytes_before: Option<u64>,
}

impl<'a> Stage<'a> {
    fn new(gpu: &'a Gpu, casters: &'a [Caster], source: SilhouetteSource) -> anyhow::Result<Self> {
        let target =
            ShadowTarget { depth_stencil_format: gpu.caps.depth_stencil_format, samples: 1, color_formats: &[] };
        let shadows = Shadows::new(gpu, &target);
        let uploaded = ShadowCasters::new(gpu, casters)?;
        let bounds = Caster::bounds_of(casters);
        let (middle, radius) = (bounds.center(), bounds.radius());
        let camera = Camera::new(middle + EYE * radius, middle, 0.8, 0.01 * radius, SIZE_PX)?;
        let view = shadows.view(gpu, casters, &camera);
        // The first one compiles shaders; it is for next to nothing, so that what the model takes is measured alone.
        let small = [tetrahedron()?];
        drop(shadows.finder(gpu, &small, &ShadowCasters::new(gpu, &small)?, source)?);
        let bytes_before = allocated_bytes(gpu);
        let start = Instant::now();
        let found = shadows.finder(gpu, casters, &uploaded, source)?;
        let build_ms = start.elapsed().as_secs_f64() * 1e3;
        let options = ShadowOptions { silhouettes: source, ..ShadowOptions::without_culling(Method::Auto) };
        Ok(Self { gpu, casters, uploaded, view, found, options, build_ms, bytes_before })
    }

    /// How many of `lights` go into one frame: half as many as long as they are too many.
    fn lights_in_a_frame(&mut self, lights: &[Light]) -> Result<usize, GpuError> {
        let mut count = lights.len();
        loop {
            match self.find(&lights[..count]) {
                Ok(_) => return Ok(count),
                Err(GpuError::TooLarge { .. }) if count > 1 => count = count.div_ceil(2),
                Err(error) => return Err(error),
            }
        }
    }

    /// One frame, in milliseconds.
    fn find(&mut self, lights: &[Light]) -> Result<Option<f64>, GpuError> {
        self.found.plan(self.gpu, self.casters, &self.uploaded, &self.view, lights, &self.options);
        self.found.upload(self.gpu)?;
        pollster::block_on(self.found.time_alone(self.gpu))
    }

    /// Bytes on the GPU that finding takes, those for the lights of one frame included; 0 where the driver's memory can't be looked into.
    fn bytes(&self) -> usize {
        let before = self.bytes_before.zip(allocated_bytes(self.gpu));
        before.map_or(0, |(before, now)| now.saturating_sub(before) as usize)
    }
}

fn tetrahedron() -> anyhow::Result<Caster> {
    let mesh = Arc::new(Mesh::new(shapes::tetrahedron([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]))?);
    let topology = Arc::new(Topology::new(&mesh));
    Ok(Caster::new(&Object::new("tetrahedron", mesh, DAffine3::IDENTITY), topology))
}

fn allocated_bytes(gpu: &Gpu) -> Option<u64> {
    gpu.device.generate_allocator_report().map(|report| report.total_allocated_bytes)
}

/// Whether the edges of `found` are the boundary of its coefficients, which closes; and these are the CPU's but for triangles that are
/// edge-on as far as `f32` can tell.
fn is_right(found: &FoundSilhouette, caster: &Caster, lights: &[Light]) -> bool {
    let chain = Chain::from_coefficients(found.coefficients.clone());
    let [mut edges, mut boundary] = [found.edges.clone(), silhouette(&caster.topology, &chain)];
    edges.sort_unstable();
    boundary.sort_unstable();
    edges == boundary && is_turned_right(found, caster, lights[found.light].position)
}

/// Whether each component counts as one that the light is outside of, or each of its triangles, as either is right for any closed one.
fn is_turned_right(found: &FoundSilhouette, caster: &Caster, light: LightPosition) -> bool {
    let outside = Counting::outside(caster);
    let chains = [&outside, &vec![Counting::Every; outside.len()]].map(|counting| Chain::new(caster, light, counting));
    let mut is_beyond_rounding = vec![[false; 2]; outside.len()];
    for (t, &own) in found.coefficients.iter().enumerate() {
        let component = caster.topology.component_of_triangle()[t] as usize;
        for (way, chain) in chains.iter().enumerate() {
            if chain.coefficients()[t] != own {
                is_beyond_rounding[component][way] |= nearness(caster, t, light) >= EDGE_ON;
            }
        }
    }
    is_beyond_rounding.iter().all(|ways| ways.contains(&false))
}

/// How near the light is to the plane of triangle `t`, for the size of everything.
fn nearness(caster: &Caster, t: usize, light: LightPosition) -> f64 {
    let [a, b, c] = caster.corners(t).map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let reach = |p: DVec3| p.abs().max_element();
    let size = if light.is_directional() {
        1.0
    } else {
        reach(light.homogeneous().truncate()).max(reach(caster.bounds.min)).max(reach(caster.bounds.max))
    };
    normal.dot(light.offset_from(a)).abs() / size
}
