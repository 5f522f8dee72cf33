//! What each caster draws of a light with a size.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use umbrae_core::{
    Bounds, Case, CaseChooser, Caster, Culler, Extent, Light, PixelRect, ShadowVolume, SmoothBody, SmoothVolume, Sphere,
};

use crate::shadow::caster_plan::CasterPlanner;
use crate::shadow::casters::{Block, VolumeVertex};
use crate::shadow::emit::add_dark_cap;
use crate::shadow::plan::{Seen, rect_by_culling, unseen_light, volume_vertex};
use crate::shadow::smooth_plan::smooth_volume;
use crate::shadow::spheres::{ERROR_PX, is_shut_in};
use crate::{CasterReport, Fate, ShadowCasters, ShadowOptions, Why};

/// `Segment` in `soft_coverage.wgsl`: an edge of a silhouette as the lit side walks it, in scene space.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Segment {
    start_world: [f32; 3],
    is_fail: f32,
    end_world: [f32; 3],
}

impl Segment {
    pub(crate) const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3],
    };
}

/// One caster: where it may show, and what it adds up.
#[derive(Debug, Clone)]
pub(crate) struct SoftDraw {
    /// Where its umbra and penumbra may show.
    pub(crate) rect: PixelRect,
    /// Of [`SoftPlan::segments`].
    pub(crate) segments: Range<u32>,
    /// Of [`SoftPlan::caps`], behind what is seen by definition.
    pub(crate) caps: Range<u32>,
    /// Of [`SoftPlan::caps`], behind what is seen if depth says so.
    pub(crate) compared_caps: Range<u32>,
}

/// What one light draws.
#[derive(Debug, Default)]
pub(crate) struct SoftPlan {
    /// Where it may change a pixel; `None` draws nothing.
    pub(crate) rect: Option<PixelRect>,
    /// In the order of groups.
    pub(crate) draws: Vec<SoftDraw>,
    /// Of `draws`: rectangles of one group have no pixel in common.
    pub(crate) groups: Vec<Range<usize>>,
    pub(crate) segments: Vec<Segment>,
    /// Triangles of volume vertices.
    pub(crate) caps: Vec<VolumeVertex>,
    pub(crate) casters: Vec<CasterReport>,
    pub(crate) spheres: Vec<CasterReport>,
}

/// The silhouette of one caster as segments, so that it may come from a mesh or from anything else, and what closes its volume.
///
/// Segments form closed loops, and none is longer than the mesh has it; corners where they meet are the same to the last bit.
struct Outline {
    segments: Vec<[Vec3; 2]>,
    caps: Vec<VolumeVertex>,
    compared_caps: Vec<VolumeVertex>,
    case: Case,
    why: Why,
}

impl SoftPlan {
    /// The plan for `light`, which is rounded as shaders see it and has a size. Silhouettes are found on the CPU.
    ///
    /// At most linear in the number of triangles of the casters that are not culled, and quadratic in the number of these. On all threads of the rayon pool.
    pub(crate) fn new(
        casters: &[Caster],
        uploaded: &ShadowCasters,
        seen: &Seen,
        light: &Light,
        options: &ShadowOptions,
    ) -> Self {
        let mut plan = Self::default();
        let culler = Culler::new(&seen.camera, light, &seen.bounds);
        let whole = PixelRect::whole(seen.camera.size_px());
        let light_rect = if options.light_scissor { culler.light_rect() } else { whole };
        let is_seen = !options.cull_lights || culler.light_may_show();
        plan.rect = light_rect.filter(|_| is_seen && !is_shut_in(light.position, &seen.spheres, &seen.camera));
        let Some(rect) = plan.rect else {
            plan.casters.extend(casters.iter().map(|caster| CasterReport::of_fate(unseen_light(caster))));
            plan.spheres.extend(seen.spheres.iter().map(|_| CasterReport::of_fate(Fate::LightUnseen)));
            return plan;
        };
        let chooser = CaseChooser::new(&seen.camera, light.position, &seen.bounds);
        let windings = seen.windings(casters);
        let smoothness = options.smooth.smoothness(&seen.camera, seen.bounds);
        let penumbra_rect = |bounds: &Bounds| {
            let wide = widened(bounds, spread_m(light, bounds, &seen.bounds));
            let rect = rect_by_culling(&wide, &culler, options, rect)?;
            if !options.caster_scissor {
                return Ok(rect);
            }
            // What is seen is in the scene, and so is what of a penumbra matters: the smaller, the fewer overlap.
            let within = culler.shadow_rect_within(&wide, &seen.bounds.union(wide));
            within.and_then(|within| within.intersection(&rect)).ok_or(Fate::Unseen)
        };
        let outlined: Vec<Result<(Outline, PixelRect), Fate>> = (0..casters.len())
            .into_par_iter()
            .map(|i| {
                let caster = &casters[i];
                if !caster.role.casts {
                    return Err(Fate::NotCasting);
                }
                // What is smooth may bulge.
                let rect = penumbra_rect(&uploaded.body(i).map_or(caster.bounds, SmoothBody::loose_bounds))?;
                let (windings, block) = (&windings[i], uploaded.blocks[i]);
                let smooth = smoothness.as_ref().zip(uploaded.body(i)).and_then(|(smoothness, body)| {
                    let volume = smooth_volume(caster, body, windings, light.position, smoothness)?;
                    Some((Outline::of_smooth(caster, body, &volume, light), volume.bounds(caster)))
                });
                if let Some((outline, bounds)) = smooth {
                    return Ok((outline, penumbra_rect(&bounds)?));
                }
                let (culler, chooser) = (&culler, &chooser);
                let planner = CasterPlanner { caster, windings, block, culler, chooser, rect };
                let (volume, case, why) = planner.whole(&uploaded.silhouettes[i], light, options);
                let shows_dark_cap = !options.cull_caps || culler.dark_cap_may_show(&caster.bounds);
                Ok((Outline::of_mesh(caster, block, &volume, (case, why), light, shows_dark_cap), rect))
            })
            .collect();
        let mut drawn: Vec<(Outline, PixelRect)> = Vec::new();
        for outlined in outlined {
            let report = tell(&mut drawn, outlined);
            plan.casters.push(report);
        }
        for sphere in &seen.spheres {
            let outlined = Outline::of_sphere(sphere, light, seen, &chooser)
                .ok_or(Fate::Unseen)
                .and_then(|outline| Ok((outline, penumbra_rect(&sphere.bounds())?)));
            let report = tell(&mut drawn, outlined);
            plan.spheres.push(report);
        }
        plan.group(drawn);
        plan
    }

    /// Puts each caster into the first group in which it shares no pixel with another.
    fn group(&mut self, drawn: Vec<(Outline, PixelRect)>) {
        let mut groups: Vec<Vec<(Outline, PixelRect)>> = Vec::new();
        for (outline, rect) in drawn {
            let is_free = |group: &&mut Vec<(Outline, PixelRect)>| {
                group.iter().all(|(_, other)| rect.intersection(other).is_none())
            };
            match groups.iter_mut().find(is_free) {
                Some(group) => group.push((outline, rect)),
                None => groups.push(vec![(outline, rect)]),
            }
        }
        for group in groups {
            let first = self.draws.len();
            for (outline, rect) in group {
                let is_fail = f32::from(u8::from(outline.case != Case::Pass));
                let segment = |[start, end]: [Vec3; 2]| Segment {
                    start_world: start.to_array(),
                    is_fail,
                    end_world: end.to_array(),
                };
                let segments = extended(&mut self.segments, outline.segments.into_iter().map(segment));
                let caps = extended(&mut self.caps, outline.caps);
                let compared_caps = extended(&mut self.caps, outline.compared_caps);
                self.draws.push(SoftDraw { rect, segments, caps, compared_caps });
            }
            self.groups.push(first..self.draws.len());
        }
    }
}

impl Outline {
    fn of_mesh(
        caster: &Caster,
        block: Block,
        volume: &ShadowVolume,
        (case, why): (Case, Why),
        light: &Light,
        shows_dark_cap: bool,
    ) -> Self {
        let position = |i: u32| caster.positions[i as usize];
        let segments = volume.sides.iter().map(|side| side.map(position)).collect();
        let mut dark_cap = Vec::new();
        if case != Case::Pass && shows_dark_cap && !light.position.is_directional() {
            add_dark_cap(&mut dark_cap, (&caster.positions, &caster.bounds), block, volume, light.position);
        }
        let vertex = |i: &u32| block.vertex(*i, (&caster.positions, &caster.bounds));
        let caps: Vec<VolumeVertex> = dark_cap.as_flattened().iter().map(vertex).collect();
        let light_cap = volume.light_cap.as_flattened().iter().map(|&i| position(i).extend(0.0).to_array());
        let mut outline = Self { segments, caps, compared_caps: Vec::new(), case, why };
        if caster.role.is_see_through() {
            outline.compared_caps.extend(light_cap);
        } else if case == Case::Fail {
            outline.caps.extend(light_cap);
        }
        outline
    }

    /// Always by z-fail, with both caps: folds and fins are behind what is seen where depth says so.
    fn of_smooth(caster: &Caster, body: &SmoothBody, volume: &SmoothVolume, light: &Light) -> Self {
        let (positions, flat) = volume.flattened(body, caster);
        let block = Block { first_vertex: 0, position_count: positions.len() as u32 };
        let around = (positions.as_slice(), &volume.bounds(caster));
        let segments = volume.sides.iter().map(|side| side.map(|p| volume.points[p as usize])).collect();
        let mut dark_cap = Vec::new();
        if !light.position.is_directional() {
            add_dark_cap(&mut dark_cap, around, block, &flat, light.position);
        }
        let near = |triangles: &[[u32; 3]]| -> Vec<VolumeVertex> {
            triangles.as_flattened().iter().map(|&i| positions[i as usize].extend(0.0).to_array()).collect()
        };
        let (cap, faces) = flat.light_cap.split_at(flat.light_cap.len() - volume.closing().len());
        let mut caps: Vec<VolumeVertex> = dark_cap.as_flattened().iter().map(|&i| block.vertex(i, around)).collect();
        caps.extend(near(cap));
        Self { segments, caps, compared_caps: near(faces), case: Case::Fail, why: Why::Method }
    }

    /// Always by z-fail, with both caps: the light cap is no visible surface, and there are few triangles. `None` if the light is in the sphere.
    fn of_sphere(sphere: &Sphere, light: &Light, seen: &Seen, chooser: &CaseChooser) -> Option<Self> {
        let sides = sphere.sides_for(light.position, &seen.camera, ERROR_PX);
        let volume = sphere.volume(light.position, sides)?;
        let ring: Vec<Vec3> = volume.ring().iter().map(|corner| corner.as_vec3()).collect();
        let segments: Vec<[Vec3; 2]> = (0..ring.len()).map(|i| [ring[(i + 1) % ring.len()], ring[i]]).collect();
        let (case, why) = match chooser.case_of_bounds(&volume.bounds()) {
            Case::Pass => (Case::Fail, Why::Method),
            _ => (Case::Fail, Why::NearRectangleMayBeShaded),
        };
        let compared_caps = volume.light_cap().flatten().map(volume_vertex).collect();
        let axis = volume.axis().as_vec3().extend(2.0).to_array();
        // Copies at infinity are made as those of the sides are.
        let far = |corner: Vec3| corner.extend(1.0).to_array();
        let fan = |i: usize| [axis, far(ring[i]), far(ring[(i + 1) % ring.len()])];
        let caps = if light.position.is_directional() { Vec::new() } else { (0..ring.len()).flat_map(fan).collect() };
        Some(Self { segments, caps, compared_caps, case, why })
    }
}

/// Keeps what is drawn, and tells what became of it.
fn tell(drawn: &mut Vec<(Outline, PixelRect)>, outlined: Result<(Outline, PixelRect), Fate>) -> CasterReport {
    let (outline, rect) = match outlined {
        Err(fate) => return CasterReport::of_fate(fate),
        Ok(outlined) => outlined,
    };
    let mut report = CasterReport::of_fate(Fate::Drawn { case: outline.case, why: outline.why });
    report.rect = Some(rect);
    report.parts = 1;
    let faces = report.faces_mut();
    faces.silhouette_edges = outline.segments.len();
    faces.side_triangles = 2 * outline.segments.len();
    let is_far = |triangle: &&[VolumeVertex]| triangle[0][3] > 0.5;
    faces.dark_cap_triangles = outline.caps.chunks(3).filter(is_far).count();
    faces.light_cap_triangles = (outline.caps.len() + outline.compared_caps.len()) / 3 - faces.dark_cap_triangles;
    drawn.push((outline, rect));
    report
}

/// The part of `all` that `more` becomes.
fn extended<T>(all: &mut Vec<T>, more: impl IntoIterator<Item = T>) -> Range<u32> {
    let first = all.len() as u32;
    all.extend(more);
    first..all.len() as u32
}

/// How far from the way to the light's centre the way to any of its points can be where it meets something in `bounds`.
///
/// A caster that is wider by this has a hard shadow that holds its penumbra: the two ways part towards the light, and are at most so far apart
/// between the caster and what is seen, which is in `scene`.
fn spread_m(light: &Light, bounds: &Bounds, scene: &Bounds) -> f64 {
    match light.extent {
        Extent::Disc { radius_rad } => {
            let (tan, toward) = (radius_rad.tan(), light.position.homogeneous().truncate());
            let (below, above) = (bounds.max - scene.min, scene.max - bounds.min);
            // Away from the caster, a way to any point of the light leaves the scene after this at the latest, whichever axis comes first.
            let mut farthest = below.max(above).length();
            for axis in 0..3 {
                let lean = toward[axis].abs() - 2.0 * tan;
                let room = if toward[axis] > 0.0 { below[axis] } else { above[axis] };
                if lean > 0.0 {
                    farthest = farthest.min(room.max(0.0) / lean);
                }
            }
            farthest * tan
        }
        extent => extent.radius_m(),
    }
}

fn widened(bounds: &Bounds, by: f64) -> Bounds {
    Bounds { min: bounds.min - DVec3::splat(by), max: bounds.max + DVec3::splat(by) }
}
