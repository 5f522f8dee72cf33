//! Casters posed on the GPU.
//!
//! Each vertex is moved once, and what comes out is drawn, casts, and is read back into the caster, so that the silhouettes, cases and
//! rays of the CPU are about the very bits that are on the screen. Reading back is the price of finding silhouettes on the CPU: 16 bytes
//! for each vertex that moves, and a wait for the GPU in each frame.
//!
//! A sum of matrices is taken in `f32`, where [`Caster::pose_to`] takes it in `f64` and rounds once: the two differ by a few roundings. The
//! matrices themselves, from rest to scene space, are composed in `f64`, so that large coordinates on the way cost nothing.

mod show;

use std::sync::Arc;

use bytemuck::Zeroable as _;
use glam::{DAffine3, Vec3};
use rustc_hash::FxHashMap;
use umbrae_core::{Bounds, Caster, Deformer, Mesh, Object};
use wgpu::util::DeviceExt as _;

use crate::displacement::NOT_MOVED;
use crate::gpu_scene::middle;
use crate::passes::{PoseBuffers, PosePass, PosedUniform};
use crate::{Displacement, Gpu, GpuError, GpuScene, Tier, readback};

/// Moves the objects of one scene on the GPU.
///
/// Of the same objects always comes the same, whatever was shown before.
#[derive(Debug)]
pub struct GpuPoser {
    pass: PosePass,
    /// `None` where there is nothing to move.
    group: Option<wgpu::BindGroup>,
    posed: wgpu::Buffer,
    now: wgpu::Buffer,
    parts: Vec<Part>,
    /// For each of [`GpuScene::glass`], its caster and its number in that.
    glass: Vec<(usize, usize)>,
    /// What is in `now` and has been drawn with; empty at first.
    shown: Vec<f32>,
    /// The time of what is shown, for a [`Displacement`].
    time_s: f32,
    /// Of each object, whether its caster's box is from [`GpuPoser::show`].
    is_boxed: Vec<bool>,
}

/// An object, with what of its [`PosedUniform`] never changes.
#[derive(Debug)]
struct Part {
    uniform: PosedUniform,
    matrix_count: usize,
}

impl Part {
    /// Weights, matrices and the origin are there in [`GpuPoser::now`].
    fn range(&self) -> std::ops::Range<usize> {
        let start = self.uniform.weights as usize;
        start..self.uniform.joints as usize + 12 * self.matrix_count
    }
}

impl GpuPoser {
    /// Uploads how each of `objects` may move; `casters` are theirs, in order, and `scene` is made of them. Vertices, morph targets and
    /// influences that instances share are uploaded once: 12 bytes a vertex, as many for each of its morph targets, 16 to 40 with a skin;
    /// and 16 bytes a triangle.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoCompute`] on a device of [`Tier::Basic`], [`GpuError::TooLarge`] when shaders can't be given a buffer that large,
    /// [`GpuError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If there are not as many objects as casters.
    pub fn new(gpu: &Gpu, objects: &[Object], casters: &[Caster], scene: &GpuScene) -> Result<Self, GpuError> {
        let nothing = Displacement { wgsl: NOT_MOVED, max_offset_m: 0.0, objects: &[] };
        Self::with(gpu, objects, casters, scene, &nothing)
    }

    /// As [`GpuPoser::new`], with a function that moves vertices besides.
    ///
    /// # Errors
    ///
    /// Those of [`GpuPoser::new`], and [`GpuError::Shader`] when the function is no good.
    ///
    /// # Panics
    ///
    /// As [`GpuPoser::new`].
    pub async fn displacing(
        gpu: &Gpu,
        objects: &[Object],
        casters: &[Caster],
        scene: &GpuScene,
        displacement: &Displacement<'_>,
    ) -> Result<Self, GpuError> {
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let poser = Self::with(gpu, objects, casters, scene, displacement);
        match scope.pop().await {
            Some(error) => Err(GpuError::Shader { reason: error.to_string() }),
            None => poser,
        }
    }

    fn with(
        gpu: &Gpu,
        objects: &[Object],
        casters: &[Caster],
        scene: &GpuScene,
        displacement: &Displacement<'_>,
    ) -> Result<Self, GpuError> {
        if gpu.caps.tier != Tier::Full {
            return Err(GpuError::NoCompute { adapter: gpu.label.clone() });
        }
        assert_eq!(objects.len(), casters.len(), "each object has a caster");
        let (volume, surface) = (&scene.shadow_casters.vertices, &scene.surface);
        gpu.ensure_binding_fits(volume.size())?;
        gpu.ensure_binding_fits(surface.size())?;

        let mut rest = AtRest::default();
        let mut place_starts = Vec::with_capacity(casters.len());
        let mut parts = Vec::with_capacity(objects.len());
        let mut now_len = 0;
        for (i, (object, block)) in objects.iter().zip(&scene.shadow_casters.blocks).enumerate() {
            let mut part = rest.part(object);
            if displacement.objects.contains(&i) {
                part.uniform.max_offset = displacement.max_offset_m as f32;
            }
            place_starts.push(rest.words.len());
            part.uniform.places = rest.words.len() as u32;
            rest.words.resize(rest.words.len() + object.mesh.triangles().len(), 0);
            part.uniform.near = block.first_vertex + block.near(0);
            part.uniform.far = block.first_vertex + block.far(0);
            part.uniform.weights = now_len;
            part.uniform.joints = now_len + part.uniform.morph_count;
            now_len = part.range().end as u32;
            parts.push(part);
            // Before words are too many to count.
            gpu.ensure_binding_fits(size_of_val(rest.words.as_slice()) as u64)?;
        }
        let mut places_of_glass = FxHashMap::default();
        scene.order.for_each_triangle(casters, |c, t, place| {
            rest.words[place_starts[c] + t] = place;
            if casters[c].role.is_glass {
                places_of_glass.insert(place, (c, t));
            }
        });
        let glass = scene.glass.iter().map(|glass| places_of_glass[&(glass.first_vertex / 3)]).collect();

        let at_rest = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("vertices at rest"),
            contents: bytemuck::cast_slice(&rest.words),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let buffer = |label, size: usize, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let now = buffer("weights and matrices", now_len as usize * size_of::<f32>(), wgpu::BufferUsages::STORAGE);
        let posed_size = parts.len() * PosePass::uniform_stride(gpu);
        let posed = buffer("posed objects", posed_size, wgpu::BufferUsages::UNIFORM);
        let pass = PosePass::new(gpu, displacement.wgsl);
        let has_any = [&at_rest, &now, volume, surface].iter().all(|buffer| buffer.size() > 0);
        let buffers = PoseBuffers { posed: &posed, at_rest: &at_rest, now: &now, volume, surface };
        let group = has_any.then(|| pass.group(gpu, buffers));
        let is_boxed = vec![false; parts.len()];
        gpu.unless_out_of_memory(Ok(Self {
            pass,
            group,
            posed,
            now,
            parts,
            glass,
            shown: Vec::new(),
            time_s: 0.0,
            is_boxed,
        }))
    }

    /// Moves to where `objects` are all that is not there: in `scene`, and in `casters`. The first time that is all; so it is the GPU's
    /// rounding that decides where things are, from then on.
    ///
    /// What has moved is flat then. For smooth surfaces give its caster the [normals](Caster::shading_normals) of where it is, and
    /// [`GpuScene::update`] the scene.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If these are not the objects, casters and scene that the poser was made for, in other poses.
    pub async fn pose(
        &mut self,
        gpu: &Gpu,
        scene: &mut GpuScene,
        objects: &[Object],
        casters: &mut [Caster],
    ) -> Result<(), GpuError> {
        let Some(moved) = self.stage(gpu, objects, casters, self.time_s) else { return Ok(()) };
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("posing") });
        self.record(gpu, &mut encoder, &moved);
        let copy = self.copy_near(gpu, &mut encoder, scene, &moved);
        gpu.queue.submit([encoder.finish()]);
        let bytes = gpu.unless_out_of_memory(readback::buffer(gpu, &copy).await)?;

        let mut vertices = bytes.chunks_exact(VERTEX_SIZE).map(bytemuck::pod_read_unaligned::<[f32; 4]>);
        for &i in &moved {
            let caster = &mut casters[i];
            caster.shading_normals.clear();
            for (position, [x, y, z, _]) in caster.positions.iter_mut().zip(vertices.by_ref()) {
                *position = Vec3::new(x, y, z);
            }
            caster.bounds = Bounds::of_points(caster.positions.iter().map(|p| p.as_dvec3()));
            self.is_boxed[i] = false;
            scene.shadow_casters.update_middle(gpu, i, caster);
        }
        for (glass, &(caster, triangle)) in scene.glass.iter_mut().zip(&self.glass) {
            glass.center = middle(casters[caster].corners(triangle));
        }
        Ok(())
    }

    /// Uploads the moment; the numbers of those objects that are not there, or `None` where all are.
    fn stage(&mut self, gpu: &Gpu, objects: &[Object], casters: &[Caster], time_s: f32) -> Option<Vec<usize>> {
        let counts = [objects.len(), casters.len()];
        assert_eq!(counts, [self.parts.len(); 2], "the objects and casters are those that the poser was made for");
        let stride = PosePass::uniform_stride(gpu);
        let mut now = Vec::with_capacity(self.shown.len());
        let mut uniforms = vec![0; self.parts.len() * stride];
        for ((object, part), at) in objects.iter().zip(&self.parts).zip(uniforms.chunks_exact_mut(stride)) {
            add_moment(&mut now, object, part);
            let origin_world = object.world_from_object.translation.as_vec3().to_array();
            let uniform = PosedUniform { origin_world, time_s, ..part.uniform };
            at[..size_of::<PosedUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        let is_shown = |part: &Part| {
            let is_same_time = part.uniform.max_offset == 0.0 || time_s == self.time_s;
            is_same_time && self.shown.get(part.range()).is_some_and(|shown| *shown == now[part.range()])
        };
        let moved: Vec<usize> = (0..self.parts.len()).filter(|&i| !is_shown(&self.parts[i])).collect();
        if moved.is_empty() || self.group.is_none() {
            return None;
        }
        gpu.queue.write_buffer(&self.posed, 0, &uniforms);
        gpu.queue.write_buffer(&self.now, 0, bytemuck::cast_slice(&now));
        self.shown = now;
        self.time_s = time_s;
        Some(moved)
    }

    fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, moved: &[usize]) {
        let Some(group) = &self.group else { return };
        let counts = |i: usize| [self.parts[i].uniform.vertex_count, self.parts[i].uniform.triangle_count];
        let objects_and_counts: Vec<(usize, [u32; 2])> = moved.iter().map(|&i| (i, counts(i))).collect();
        self.pass.draw(gpu, encoder, group, &objects_and_counts);
    }

    /// The near vertices of those that moved, one after the other.
    fn copy_near(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        moved: &[usize],
    ) -> wgpu::Buffer {
        let bytes = |vertices: u32| u64::from(vertices) * VERTEX_SIZE as u64;
        let count = |i: &usize| bytes(self.parts[*i].uniform.vertex_count);
        let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("posed vertices, for reading"),
            size: moved.iter().map(count).sum(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut end = 0;
        for i in moved {
            let near = bytes(self.parts[*i].uniform.near);
            encoder.copy_buffer_to_buffer(&scene.shadow_casters.vertices, near, &copy, end, count(i));
            end += count(i);
        }
        copy
    }
}

/// Bytes of a vertex of volumes.
const VERTEX_SIZE: usize = size_of::<[f32; 4]>();

/// Adds what `object`, which is `part`, is moved by.
///
/// # Panics
///
/// If it is not.
fn add_moment(now: &mut Vec<f32>, object: &Object, part: &Part) {
    let pose = object.pose.as_ref();
    let morph_weights = pose.map_or(&[][..], |pose| &pose.morph_weights);
    let morph_count = part.uniform.morph_count as usize;
    // Targets without a weight count nothing, as on the CPU; an object that is not posed is at rest.
    now.extend((0..morph_count).map(|i| morph_weights.get(i).copied().unwrap_or(0.0)));
    let add = |now: &mut Vec<f32>, world_from_rest: DAffine3| {
        for row in 0..3 {
            now.extend(
                world_from_rest.matrix3.row(row).as_vec3().extend(world_from_rest.translation[row] as f32).to_array(),
            );
        }
    };
    if part.uniform.has_skin == 0 {
        add(now, object.world_from_object);
    } else {
        let joints = pose.map_or(&[][..], |pose| &pose.joints);
        assert_eq!(joints.len(), part.matrix_count, "`{}` has the skin that the poser was made for", object.name);
        joints.iter().for_each(|&joint| add(now, object.world_from_object * joint));
    }
    assert_eq!(now.len(), part.range().end, "`{}` is an object that the poser was made for", object.name);
}

/// What does not move, in words; what is shared is in it once.
#[derive(Debug, Default)]
struct AtRest {
    words: Vec<u32>,
    of_meshes: FxHashMap<(*const Mesh, *const Deformer), PosedUniform>,
}

impl AtRest {
    fn part(&mut self, object: &Object) -> Part {
        let deformer = object.pose.as_ref().map(|pose| &pose.deformer);
        let key = (Arc::as_ptr(&object.mesh), deformer.map_or(std::ptr::null(), Arc::as_ptr));
        let uniform = if let Some(&known) = self.of_meshes.get(&key) {
            known
        } else {
            let uniform = self.add(&object.mesh, deformer.map_or(&Deformer::default(), |deformer| deformer));
            self.of_meshes.insert(key, uniform);
            uniform
        };
        let joints = object.pose.as_ref().map_or(0, |pose| pose.joints.len());
        Part { uniform, matrix_count: if uniform.has_skin == 0 { 1 } else { joints } }
    }

    fn add(&mut self, mesh: &Mesh, deformer: &Deformer) -> PosedUniform {
        let positions = self.add_words(mesh.positions().iter().flat_map(Vec3::to_array).map(f32::to_bits));
        let offsets = deformer.morph_offsets.iter().flatten();
        let offsets = self.add_words(offsets.flat_map(Vec3::to_array).map(f32::to_bits));
        let ranges = self.add_words(deformer.influence_ranges.as_flattened().iter().copied());
        let influences = deformer.influences.iter().flat_map(|on| [on.joint, on.weight.to_bits()]);
        let influences = self.add_words(influences);
        let triangles = self.add_words(mesh.triangles().as_flattened().iter().copied());
        PosedUniform {
            vertex_count: mesh.positions().len() as u32,
            triangle_count: mesh.triangles().len() as u32,
            positions,
            offsets,
            ranges,
            influences,
            triangles,
            morph_count: deformer.morph_offsets.len() as u32,
            has_skin: u32::from(!deformer.influence_ranges.is_empty()),
            ..PosedUniform::zeroed()
        }
    }

    fn add_words(&mut self, words: impl Iterator<Item = u32>) -> u32 {
        let start = self.words.len() as u32;
        self.words.extend(words);
        start
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use umbrae_core::{Influence, Material, Pose, Role, Scene, Surface};

    use super::*;
    use crate::AdapterChoice;

    /// A bent tetrahedron of glass, twice, and a tetrahedron that is not bent.
    fn scene(turn_rad: f64) -> Scene {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mesh = Arc::new(Mesh::new(Surface { positions, triangles, ..Surface::default() }).expect("a good mesh"));
        let both = |v: u32| {
            let weight = v as f32 / 3.0;
            [Influence { joint: 0, weight: 1.0 - weight }, Influence { joint: 1, weight }]
        };
        let deformer = Arc::new(Deformer {
            morph_offsets: vec![vec![Vec3::X; 4], (0..4).map(|i| Vec3::Z * i as f32).collect()],
            influence_ranges: (0..4).map(|v| [2 * v, 2 * v + 2]).collect(),
            influences: (0..4).flat_map(both).collect(),
        });
        let joints =
            vec![DAffine3::from_rotation_x(turn_rad), DAffine3::from_translation(DVec3::new(0.1, turn_rad, 0.0))];
        let pose = Some(Pose { deformer, morph_weights: vec![turn_rad as f32, -0.3], joints });
        let at =
            |x: f64| DAffine3::from_rotation_z(1.0 - turn_rad) * DAffine3::from_translation(DVec3::new(x, 2.0, -0.0));
        let bent = |x: f64| {
            let role = Role { is_glass: true, ..Role::default() };
            Object { pose: pose.clone(), role, ..Object::new("bent", mesh.clone(), at(x)) }
        };
        let objects = vec![bent(0.0), Object::new("plain", mesh.clone(), at(5.0)), bent(-7.0)];
        Scene { objects, materials: vec![Material::default()], ..Scene::default() }
    }

    fn words(gpu: &Gpu, from: &wgpu::Buffer) -> Vec<f32> {
        let to = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test"),
            size: from.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("test") });
        encoder.copy_buffer_to_buffer(from, 0, &to, 0, from.size());
        gpu.queue.submit([encoder.finish()]);
        let bytes = pollster::block_on(readback::buffer(gpu, &to)).expect("it can be read");
        bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect()
    }

    /// Colours are not numbers, so they count by bits.
    fn assert_near(ours: &[f32], theirs: &[f32]) {
        assert_eq!(ours.len(), theirs.len());
        for (i, (a, b)) in ours.iter().zip(theirs).enumerate() {
            assert!(a.to_bits() == b.to_bits() || (a - b).abs() < 2e-6, "word {i}: {a} on the GPU, {b} on the CPU");
        }
    }

    #[test]
    fn what_is_drawn_and_what_casts_is_what_the_caster_has_and_does_not_depend_on_the_past() {
        let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default())).expect("a graphics driver");
        let at_rest = scene(0.0);
        let mut casters = Caster::of_scene(&at_rest);
        let mut drawn = GpuScene::new(&gpu, &casters, &at_rest.materials, &[]).expect("it fits");
        let mut poser = GpuPoser::new(&gpu, &at_rest.objects, &casters, &drawn).expect("a device that computes");
        let mut first: Option<[Vec<u32>; 2]> = None;
        for turn_rad in [0.7, -1.3, 0.7] {
            let now = scene(turn_rad);
            // Another deformer of the same kind, as only its numbers count.
            pollster::block_on(poser.pose(&gpu, &mut drawn, &now.objects, &mut casters)).expect("it is posed");
            let ours = [words(&gpu, &drawn.shadow_casters.vertices), words(&gpu, &drawn.surface)];

            // Uploaded from the casters that were read back: the same bits, but for normals.
            let same = GpuScene::new(&gpu, &casters, &at_rest.materials, &[]).expect("it fits");
            assert_eq!(ours[0], words(&gpu, &same.shadow_casters.vertices));
            let uploaded = words(&gpu, &same.surface);
            assert_near(&ours[1], &uploaded);
            for (a, b) in ours[1].chunks_exact(9).zip(uploaded.chunks_exact(9)) {
                assert_eq!(a[..3], b[..3]);
            }
            let centers = |scene: &GpuScene| scene.glass.iter().map(|glass| glass.center).collect::<Vec<_>>();
            assert_eq!(centers(&drawn), centers(&same));

            // Posed on the CPU: nearly.
            let posed = GpuScene::new(&gpu, &Caster::of_scene(&now), &at_rest.materials, &[]).expect("it fits");
            assert_near(&ours[1], &words(&gpu, &posed.surface));
            if turn_rad > 0.0 {
                let bits = ours.map(|words| words.into_iter().map(f32::to_bits).collect());
                assert!(*first.get_or_insert_with(|| bits.clone()) == bits);
            }
        }
    }
}
