//! The vertices of shadow volumes on the GPU.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use glam::{DVec3, Vec3};
use umbrae_core::{Bounds, Caster, Finder, Silhouettes, SmoothBody};
use wgpu::util::DeviceExt as _;

use super::found::basic::Displaced;
use crate::{Gpu, GpuError};

/// A vertex of shadow volumes: position and 0, the same and 1 for its copy at infinity (McGuire's doubled vertex array,
/// section 4), or a direction and 2.
pub(crate) type VolumeVertex = [f32; 4];

pub(crate) const VOLUME_VERTEX_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<VolumeVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x4],
};

/// Directions about which a dark cap may be a fan.
pub(crate) const AXES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

/// Where things are among a caster's own vertices, which come in one block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Block {
    /// Of the block, in the buffer.
    pub(crate) first_vertex: u32,
    /// Of the mesh.
    pub(crate) position_count: u32,
}

impl Block {
    /// The copy at infinity of the middle of the caster's box: the direction from the light through it.
    pub(crate) const MIDDLE: u32 = AXES.len() as u32;
    const FIRST_POSITION: u32 = Self::MIDDLE + 1;

    /// Vertex `i` of the mesh.
    pub(crate) fn near(self, i: u32) -> u32 {
        Self::FIRST_POSITION + i
    }

    /// Its copy at infinity.
    pub(crate) fn far(self, i: u32) -> u32 {
        Self::FIRST_POSITION + self.position_count + i
    }

    /// The vertex with an index of the block, as it is uploaded for `positions` in `bounds`, whose block it is.
    pub(crate) fn vertex(self, i: u32, (positions, bounds): (&[Vec3], &Bounds)) -> VolumeVertex {
        let Some(i) = i.checked_sub(Self::FIRST_POSITION) else {
            return AXES.get(i as usize).map_or_else(|| middle(bounds), |axis| axis.as_vec3().extend(2.0).to_array());
        };
        let is_far = i >= self.position_count;
        let position = positions[(if is_far { i - self.position_count } else { i }) as usize];
        position.extend(f32::from(u8::from(is_far))).to_array()
    }

    fn vertex_count(self) -> u32 {
        self.far(self.position_count)
    }

    /// Whether 16-bit indices name every vertex.
    pub(crate) fn is_short(self) -> bool {
        self.vertex_count() <= 1 << 16
    }
}

/// The vertices of casters, uploaded once and used by every light.
#[derive(Debug)]
pub struct ShadowCasters {
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) blocks: Vec<Block>,
    /// Whether a caster may be elsewhere than where it was.
    pub(crate) has_moved: Vec<AtomicBool>,
    /// What finds each caster's silhouettes on the CPU.
    pub(crate) silhouettes: Vec<Mutex<Silhouettes>>,
    /// Casters that stand for smooth bodies.
    pub(crate) bodies: Vec<Option<SmoothBody>>,
    /// Whether a caster may be elsewhere than where its body was made.
    pub(crate) has_left_body: Vec<AtomicBool>,
    /// How often bodies were given or moved.
    bodies_given: u64,
    moves: AtomicU64,
    /// Positions that only the GPU knows; see [`crate::TextureDisplacer`].
    displaced: OnceLock<Displaced>,
}

impl ShadowCasters {
    /// Uploads the positions of `casters`: 32 bytes for each vertex of a mesh.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the buffer would be larger than the device allows.
    pub fn new(gpu: &Gpu, casters: &[Caster]) -> Result<Self, GpuError> {
        let mut blocks = Vec::with_capacity(casters.len());
        let mut vertex_count = 0;
        for caster in casters {
            let block = Block { first_vertex: vertex_count, position_count: caster.positions.len() as u32 };
            gpu.ensure_buffer_fits(
                (vertex_count as usize + block.vertex_count() as usize) * size_of::<VolumeVertex>(),
            )?;
            vertex_count += block.vertex_count();
            blocks.push(block);
        }
        let vertices = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("volume vertices"),
            contents: bytemuck::cast_slice(&volume_vertices(casters)),
            usage: gpu.caps.moving_vertices(),
        });
        let has_moved = casters.iter().map(|_| AtomicBool::new(false)).collect();
        let silhouettes = casters.iter().map(|_| Mutex::default()).collect();
        let bodies = casters.iter().map(|_| None).collect();
        let has_left_body = casters.iter().map(|_| AtomicBool::new(false)).collect();
        let (moves, displaced) = (AtomicU64::new(0), OnceLock::new());
        Ok(Self { vertices, blocks, has_moved, silhouettes, bodies, has_left_body, bodies_given: 0, moves, displaced })
    }

    /// Positions that only the GPU knows, if there are any.
    pub(crate) fn displaced(&self) -> Option<&Displaced> {
        self.displaced.get()
    }

    /// From now on positions are where `make` has them; what was said first holds.
    pub(crate) fn displace(&self, make: impl FnOnce() -> Displaced) -> &Displaced {
        self.moves.fetch_add(1, Ordering::Relaxed);
        self.displaced.get_or_init(make)
    }

    /// How often casters were moved so far.
    pub(crate) fn moves(&self) -> u64 {
        self.moves.load(Ordering::Relaxed)
    }

    /// Uploads the positions of `casters` again, which must have the meshes of those that this was made of.
    pub fn update(&self, gpu: &Gpu, casters: &[Caster]) {
        self.moves.fetch_add(1, Ordering::Relaxed);
        (0..self.blocks.len()).for_each(|i| self.note_move(i));
        gpu.queue.write_buffer(&self.vertices, 0, bytemuck::cast_slice(&volume_vertices(casters)));
    }

    /// Has the silhouettes of caster `i` found by `finder`, which was made for it as it is, until it moves or another kind is asked for.
    pub fn give_finder(&mut self, i: usize, finder: Finder) {
        self.silhouettes[i] = Mutex::new(Silhouettes::with_finder(finder));
    }

    /// Has caster `i` cast the shadow of the smooth `body`, which was made of it as it is, where [`crate::ShadowOptions::smooth`] asks for that.
    ///
    /// Where silhouettes are found by [`crate::SilhouetteSource::Gpu`], the body then moves with the caster. Where they are found on the CPU, a caster that has
    /// moved casts the shadow of its triangles until its body [is moved too](ShadowCasters::pose_bodies), or it is given another.
    pub fn give_body(&mut self, i: usize, body: SmoothBody) {
        self.bodies_given += 1;
        self.has_left_body[i].store(false, Ordering::Relaxed);
        self.bodies[i] = Some(body);
    }

    /// Moves the bodies of those of `casters` that have moved to where they are, for silhouettes that are found on the CPU: [`SmoothBody::pose_to`].
    pub fn pose_bodies(&mut self, casters: &[Caster]) {
        for ((body, has_left), caster) in self.bodies.iter_mut().zip(&self.has_left_body).zip(casters) {
            if let Some(body) = body
                && has_left.swap(false, Ordering::Relaxed)
            {
                self.bodies_given += 1;
                body.pose_to(caster);
            }
        }
    }

    /// Changes when a body is given, or moved on the CPU.
    pub(crate) fn bodies_given(&self) -> u64 {
        self.bodies_given
    }

    /// What caster `i` stands for, if that is known where it is now.
    pub(crate) fn body(&self, i: usize) -> Option<&SmoothBody> {
        self.bodies[i].as_ref().filter(|_| !self.has_left_body[i].load(Ordering::Relaxed))
    }

    /// Caster `i` is elsewhere.
    pub(crate) fn note_left(&self, i: usize) {
        self.has_moved[i].store(true, Ordering::Relaxed);
        self.has_left_body[i].store(true, Ordering::Relaxed);
    }

    fn note_move(&self, i: usize) {
        self.note_left(i);
        self.silhouettes[i].lock().unwrap_or_else(PoisonError::into_inner).forget();
    }

    /// Uploads the middle of the box of `caster`, number `i`, which something else has moved.
    pub(crate) fn update_middle(&self, gpu: &Gpu, i: usize, caster: &Caster) {
        self.moves.fetch_add(1, Ordering::Relaxed);
        self.note_move(i);
        let vertex = self.blocks[i].first_vertex + Block::MIDDLE;
        let offset = u64::from(vertex) * size_of::<VolumeVertex>() as u64;
        gpu.queue.write_buffer(&self.vertices, offset, bytemuck::bytes_of(&middle(&caster.bounds)));
    }
}

fn volume_vertices(casters: &[Caster]) -> Vec<VolumeVertex> {
    let mut vertices = Vec::new();
    for caster in casters {
        add_block(&mut vertices, &caster.bounds, &caster.positions, true);
    }
    vertices
}

/// Adds the vertices of one block: of what has `positions` in `bounds`. Without copies at infinity if nothing names any but that of the middle.
pub(super) fn add_block(vertices: &mut Vec<VolumeVertex>, bounds: &Bounds, positions: &[Vec3], has_far: bool) -> Block {
    let block = Block { first_vertex: vertices.len() as u32, position_count: positions.len() as u32 };
    vertices.extend(AXES.map(|axis| axis.as_vec3().extend(2.0).to_array()));
    vertices.push(middle(bounds));
    for extruded in if has_far { &[0.0, 1.0][..] } else { &[0.0] } {
        vertices.extend(positions.iter().map(|p| p.extend(*extruded).to_array()));
    }
    block
}

fn middle(bounds: &Bounds) -> VolumeVertex {
    bounds.center().as_vec3().extend(1.0).to_array()
}
