//! Structs shared with WGSL, and the test that keeps the twins alike.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use umbrae_core::{Camera, Light};

use crate::{Look, Overlay};

/// `View` in `view.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct View {
    clip_from_world: [[f32; 4]; 4],
    eye_world: [f32; 3],
    unit: f32,
    right_world: [f32; 3],
    exposure: f32,
    up_world: [f32; 3],
    fade_start: f32,
    forward_world: [f32; 3],
    fade_end: f32,
    fade_center_world: [f32; 3],
    unused: f32,
}

impl View {
    pub(crate) fn new(camera: &Camera, look: &Look) -> Self {
        let [right, up, forward] = camera.axes();
        let half = camera.half_extent();
        Self {
            clip_from_world: camera.clip_from_world().as_mat4().to_cols_array_2d(),
            eye_world: camera.eye().as_vec3().to_array(),
            unit: 1.0,
            right_world: (right * half.x).as_vec3().to_array(),
            exposure: look.exposure,
            up_world: (up * half.y).as_vec3().to_array(),
            fade_start: look.fade_start_m,
            forward_world: forward.as_vec3().to_array(),
            fade_end: look.fade_end_m,
            fade_center_world: look.fade_center_world.to_array(),
            unused: 0.0,
        }
    }
}

/// `Light` in `light.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LightUniform {
    position_world: [f32; 4],
    strength: [f32; 3],
    range_m: f32,
    axis_world: [f32; 3],
    cos_outer: f32,
    sin_outer: f32,
    cos_inner: f32,
    unused_a: f32,
    unused_b: f32,
}

impl LightUniform {
    pub(crate) fn new(light: &Light) -> Self {
        let is_directional = light.position.is_directional();
        let cone = light.cone.filter(|_| !is_directional);
        let range_m = light.range_m.filter(|_| !is_directional).map_or(f32::MAX, |range| (range as f32).min(f32::MAX));
        // Without an axis every direction is at cosine 0 from it, and inside any angle whose cosine is negative.
        let (axis, [cos_outer, sin_outer, cos_inner]) = cone.map_or((DVec3::ZERO, [-1.0, 0.0, -0.5]), |cone| {
            (cone.axis, [cone.outer_rad.cos(), cone.outer_rad.sin(), cone.inner_rad.cos()])
        });
        Self {
            position_world: light.position.homogeneous().as_vec4().to_array(),
            strength: light.strength.to_array(),
            range_m,
            axis_world: axis.as_vec3().to_array(),
            cos_outer: cos_outer as f32,
            sin_outer: sin_outer as f32,
            cos_inner: cos_inner as f32,
            unused_a: 0.0,
            unused_b: 0.0,
        }
    }
}

/// How many lights a uniform buffer of the lowest tier, 16 KiB, holds.
const LIGHTS_AT_ONCE: usize = 255;

/// `Lights` in `glass.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LightsUniform {
    count: u32,
    is_first: u32,
    unused_a: u32,
    unused_b: u32,
    lights: [LightUniform; LIGHTS_AT_ONCE],
}

impl LightsUniform {
    /// All of `lights`, in as few as hold them; one even without any.
    pub(crate) fn of_all(lights: &[LightUniform]) -> Vec<Self> {
        let count = lights.len().div_ceil(LIGHTS_AT_ONCE).max(1);
        let chunk = |i: usize| {
            let some = lights.iter().skip(i * LIGHTS_AT_ONCE).take(LIGHTS_AT_ONCE);
            let mut chunk = Self { is_first: u32::from(i == 0), count: some.len() as u32, ..Self::zeroed() };
            chunk.lights.iter_mut().zip(some).for_each(|(to, light)| *to = *light);
            chunk
        };
        (0..count).map(chunk).collect()
    }
}

/// `Overlay` in `overlay.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct OverlayUniform {
    size_px: [f32; 2],
    half_width_px: f32,
    hidden_opacity: f32,
    lift: f32,
    unused_0: f32,
    unused_1: f32,
    unused_2: f32,
}

/// Lines come nearer by as much as a pixel is wide, times this: enough for the part of a line that lies over a surface as steep as this.
const LINE_LIFT_PX: f64 = 4.0;

impl OverlayUniform {
    /// `pixel_at_1` is the width of a pixel at view depth 1.
    pub(crate) fn new(overlay: &Overlay, size_px: [u32; 2], pixel_at_1: f64) -> Self {
        Self {
            size_px: size_px.map(|side| side as f32),
            half_width_px: 0.5 * overlay.line_width_px,
            hidden_opacity: overlay.hidden_opacity,
            lift: (LINE_LIFT_PX * pixel_at_1) as f32,
            unused_0: 0.0,
            unused_1: 0.0,
            unused_2: 0.0,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::mem::offset_of;

    use crate::gpu_finishes::FinishUniform;
    use crate::passes::{
        FindingUniform, FoundLightData, JobSlot, JobUniform, PosedUniform, SmoothJobSlot, SmoothJobUniform,
    };
    use crate::soft::ExtentUniform;
    use crate::texture_displacer::DisplacingUniform;

    /// Size of the WGSL struct `name`, and for each member its name and offset.
    pub(crate) fn wgsl_layout(source: &str, name: &str) -> (usize, Vec<(String, usize)>) {
        let module = naga::front::wgsl::parse_str(source).expect("valid WGSL");
        module
            .types
            .iter()
            .find_map(|(_, ty)| match &ty.inner {
                naga::TypeInner::Struct { members, span } if ty.name.as_deref() == Some(name) => Some((
                    *span as usize,
                    members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect(),
                )),
                _ => None,
            })
            .expect("the struct is in the source")
    }

    macro_rules! assert_same_layout {
        ($rust:ty, $source:expr, $name:literal, [$($field:ident),* $(,)?]) => {
            let (span, members) = wgsl_layout($source, $name);
            assert_eq!(span, size_of::<$rust>(), "size of {}", $name);
            let rust = vec![$((stringify!($field).to_owned(), offset_of!($rust, $field))),*];
            assert_eq!(members, rust, "members of {}", $name);
        };
    }

    #[test]
    fn overlay_has_the_same_bytes_in_rust_and_wgsl() {
        // naga wants every name known, so the part before comes along.
        let source = concat!(include_str!("shaders/view.wgsl"), include_str!("shaders/overlay.wgsl"));
        assert_same_layout!(
            OverlayUniform,
            source,
            "Overlay",
            [size_px, half_width_px, hidden_opacity, lift, unused_0, unused_1, unused_2]
        );
    }

    #[test]
    fn what_is_posed_has_the_same_bytes_in_rust_and_wgsl() {
        assert_same_layout!(
            PosedUniform,
            &[
                include_str!("shaders/flat_normal.wgsl"),
                include_str!("shaders/pose.wgsl"),
                crate::displacement::NOT_MOVED
            ]
            .concat(),
            "Posed",
            [
                vertex_count,
                triangle_count,
                near,
                far,
                positions,
                offsets,
                ranges,
                influences,
                triangles,
                places,
                weights,
                joints,
                origin_world,
                morph_count,
                has_skin,
                time_s,
                max_offset,
                unused,
            ]
        );
    }

    #[test]
    fn what_silhouettes_are_found_with_has_the_same_bytes_in_rust_and_wgsl() {
        let source = concat!(
            include_str!("shaders/job.wgsl"),
            include_str!("shaders/flat_normal.wgsl"),
            include_str!("shaders/near.wgsl"),
            include_str!("shaders/find.wgsl")
        );
        assert_same_layout!(
            FindingUniform,
            source,
            "Finding",
            [
                light_count,
                words,
                job_count,
                triangle_blocks,
                triangle_block_count,
                edge_blocks,
                edge_block_count,
                unused,
                near_min,
                near_max,
                near_corners,
            ]
        );
        assert_same_layout!(
            FoundLightData,
            source,
            "FoundLight",
            [position_world, plane_count, unused_a, unused_b, unused_c, planes]
        );
        assert_same_layout!(
            JobUniform,
            source,
            "Job",
            [near, far, axes, edges, triangles, sides, caps, flags, box_min, edge_on, box_max, slack]
        );
        assert_same_layout!(JobSlot, source, "JobSlot", [job, unused]);
        assert_eq!(size_of::<JobSlot>(), 256, "the largest offset that a device may ask for");
        let (span, members) = wgsl_layout(source, "Result");
        assert_eq!(span as u64, crate::shadow::RESULT_BYTES);
        assert_eq!(members.last(), Some(&("arguments".to_owned(), 16)));
    }

    #[test]
    fn what_smooth_silhouettes_are_found_with_has_the_same_bytes_in_rust_and_wgsl() {
        let source = concat!(
            include_str!("shaders/smooth_job.wgsl"),
            include_str!("shaders/flat_normal.wgsl"),
            include_str!("shaders/near.wgsl"),
            include_str!("shaders/curve.wgsl"),
            include_str!("shaders/find_smooth.wgsl"),
            include_str!("shaders/find_smooth_facing.wgsl"),
            include_str!("shaders/find_smooth_creases.wgsl")
        );
        assert_same_layout!(
            SmoothJobUniform,
            source,
            "SmoothJob",
            [
                position_world,
                eye_world,
                pixel_at_1,
                receivers_min,
                epsilon_m,
                receivers_max,
                epsilon_px,
                near,
                axes,
                flags,
                number,
                light,
                slack,
                most_inset_m,
                inner_room,
                vertices,
                corner_starts,
                wedge_count,
                triangles,
                triangle_edges,
                triangle_count,
                edges,
                edge_triangles,
                bends,
                edge_count,
                creases,
                crease_count,
                normals,
                heights,
                crossings,
                inner,
                sides,
                faces,
                caps,
                inner_places,
            ]
        );
        assert_eq!(size_of::<SmoothJobSlot>(), 256, "the largest offset that a device may ask for");
        let (span, members) = wgsl_layout(source, "SmoothResult");
        assert_eq!(span as u64, crate::shadow::SMOOTH_RESULT_BYTES);
        assert_eq!(members.last(), Some(&("arguments".to_owned(), 32)));
    }

    #[test]
    fn what_is_displaced_has_the_same_bytes_in_rust_and_wgsl() {
        let source = [
            include_str!("shaders/found_tables.wgsl"),
            include_str!("shaders/flat_normal.wgsl"),
            include_str!("shaders/displace.wgsl"),
            crate::displacement::NOT_MOVED,
        ];
        assert_same_layout!(
            DisplacingUniform,
            &source.concat(),
            "Displacing",
            [time_s, max_offset, triangle_count, unused]
        );
    }

    #[test]
    fn view_has_the_same_bytes_in_rust_and_wgsl() {
        assert_same_layout!(
            View,
            include_str!("shaders/view.wgsl"),
            "View",
            [
                clip_from_world,
                eye_world,
                unit,
                right_world,
                exposure,
                up_world,
                fade_start,
                forward_world,
                fade_end,
                fade_center_world,
                unused,
            ]
        );
    }

    #[test]
    fn light_has_the_same_bytes_in_rust_and_wgsl() {
        assert_same_layout!(
            LightUniform,
            include_str!("shaders/light.wgsl"),
            "Light",
            [position_world, strength, range_m, axis_world, cos_outer, sin_outer, cos_inner, unused_a, unused_b]
        );
    }

    #[test]
    fn a_light_s_extent_has_the_same_bytes_in_rust_and_wgsl() {
        let source = [
            include_str!("shaders/view.wgsl"),
            include_str!("shaders/light.wgsl"),
            include_str!("shaders/light_face.wgsl"),
        ];
        let (span, members) = wgsl_layout(&source.concat(), "Extent");
        assert_eq!(span, size_of::<ExtentUniform>());
        assert_eq!(members, ExtentUniform::members().map(|(name, offset)| (name.to_owned(), offset)));
    }

    #[test]
    fn finish_and_lights_have_the_same_bytes_in_rust_and_wgsl() {
        let surface = [
            include_str!("shaders/view.wgsl"),
            include_str!("shaders/light.wgsl"),
            include_str!("shaders/surface.wgsl"),
            include_str!("shaders/glass.wgsl"),
        ]
        .concat();
        let (span, members) = wgsl_layout(&surface, "Finish");
        assert_eq!(span, size_of::<FinishUniform>());
        let names: Vec<&str> = members.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["alpha", "cutoff", "least_coverage", "unused"]);
        assert_same_layout!(LightsUniform, &surface, "Lights", [count, is_first, unused_a, unused_b, lights]);
        assert!(size_of::<LightsUniform>() <= 16 << 10, "WebGL2 has uniform buffers of 16 KiB");
    }

    #[test]
    fn every_light_is_in_one_of_the_uniforms() {
        let light = |i: usize| LightUniform { range_m: i as f32, ..LightUniform::zeroed() };
        for (count, expected) in [(0, vec![0]), (255, vec![255]), (256, vec![255, 1])] {
            let lights: Vec<LightUniform> = (0..count).map(light).collect();
            let chunks = LightsUniform::of_all(&lights);
            assert_eq!(chunks.iter().map(|chunk| chunk.count as usize).collect::<Vec<_>>(), expected);
            assert_eq!(chunks.iter().map(|chunk| chunk.is_first).sum::<u32>(), 1);
            let found = chunks.iter().flat_map(|chunk| &chunk.lights[..chunk.count as usize]);
            assert!(found.zip(&lights).all(|(found, light)| found.range_m == light.range_m));
        }
    }
}
