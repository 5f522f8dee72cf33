//! Casters as textures: everything that finding silhouettes must know of a mesh before there is a light.

use std::ops::Range;

use glam::Vec3;
use umbrae_core::{Bounds, Camera, Caster, Counting, LightPosition};

use super::parts::{Part, parts, parts_anywhere, still_holds};
use crate::{Gpu, GpuError};

/// Entries in a row; `found_tables.wgsl` has its logarithm. No device has textures narrower.
const WIDTH: u32 = 2048;

/// What a texel holds. Integers, also where they are the bits of floats: every device can draw into these, WebGL2 not into floats.
pub(crate) type Entry = [u32; 4];
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

/// Parts have sides between them, and the stencil is folded after each: with more, a float target is less work, where there may be one.
const MOST_PARTS: usize = 4;

/// Entries in a texture, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    pub(crate) texture: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
}

impl Table {
    pub(crate) const FORMAT: wgpu::TextureFormat = FORMAT;

    /// A table of `len` entries, all 0.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when there are more than a texture of the device has rows for: 4 million with WebGL2's 2048.
    pub(crate) fn new(gpu: &Gpu, label: &str, len: usize) -> Result<Self, GpuError> {
        let row_bytes = u64::from(WIDTH) * size_of::<Entry>() as u64;
        let rows = (len as u64).div_ceil(u64::from(WIDTH)).max(1);
        let allowed_rows = u64::from(gpu.device.limits().max_texture_dimension_2d);
        if rows > allowed_rows {
            let (needed_bytes, allowed_bytes) = (rows * row_bytes, allowed_rows * row_bytes);
            return Err(GpuError::TooLarge { adapter: gpu.label.clone(), needed_bytes, allowed_bytes });
        }
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: WIDTH, height: rows as u32, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { texture, view })
    }

    /// A table of `entries`.
    pub(crate) fn of(gpu: &Gpu, label: &str, entries: &[Entry]) -> Result<Self, GpuError> {
        let table = Self::new(gpu, label, entries.len())?;
        table.write(gpu, entries);
        Ok(table)
    }

    /// Records copying `range` from `buffer`, which has entries too, beginning with number `first`.
    pub(super) fn copy(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        buffer: &wgpu::Buffer,
        first: u32,
        range: Range<u32>,
    ) {
        let mut at = range.start;
        while at < range.end {
            let (x, y) = (at % WIDTH, at / WIDTH);
            let width = (WIDTH - x).min(range.end - at);
            let offset = u64::from(first + at - range.start) * size_of::<Entry>() as u64;
            let layout = wgpu::TexelCopyBufferLayout { offset, bytes_per_row: None, rows_per_image: None };
            let to =
                wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x, y, z: 0 }, ..self.texture.as_image_copy() };
            let size = wgpu::Extent3d { width, height: 1, depth_or_array_layers: 1 };
            encoder.copy_buffer_to_texture(wgpu::TexelCopyBufferInfo { buffer, layout }, to, size);
            at += width;
        }
    }

    /// How many entries there is room for.
    pub(crate) fn len(&self) -> usize {
        (self.texture.width() * self.texture.height()) as usize
    }

    /// Uploads the first entries.
    pub(crate) fn write(&self, gpu: &Gpu, entries: &[Entry]) {
        let whole_rows = entries.len() / WIDTH as usize;
        let (rows, rest) = entries.split_at(whole_rows * WIDTH as usize);
        for (entries, y, width, height) in
            [(rows, 0, WIDTH, whole_rows as u32), (rest, whole_rows as u32, rest.len() as u32, 1)]
        {
            if entries.is_empty() {
                continue;
            }
            let to =
                wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x: 0, y, z: 0 }, ..self.texture.as_image_copy() };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(width * size_of::<Entry>() as u32),
                rows_per_image: None,
            };
            let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
            gpu.queue.write_texture(to, bytemuck::cast_slice(entries), layout, size);
        }
    }
}

/// Edges of one part that can be on a silhouette equally often.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct EdgeRun {
    /// In the table.
    pub(super) edges: Range<u32>,
    copies: Copies,
}

/// How often an edge can be on a silhouette.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Copies {
    /// Where each triangle of a solid component counts once or not, +1.
    facing: u32,
    /// Where it may count -1 too.
    every: u32,
}

impl EdgeRun {
    /// How often an edge of the run is on a silhouette, at most. `is_facing` says that no solid component has every triangle counted.
    pub(super) fn most_copies(&self, is_facing: bool) -> u32 {
        if is_facing { self.copies.facing } else { self.copies.every }
    }
}

/// Where one part of a caster is in the tables.
#[derive(Debug, Clone)]
pub(super) struct PartTables {
    pub(super) triangles: Range<u32>,
    pub(super) edges: Vec<EdgeRun>,
    /// No point is in more of its volumes.
    pub(super) most_overlaps: u32,
}

/// Where one caster is in the tables.
#[derive(Debug, Clone)]
pub(super) struct CasterTables {
    /// Of its vertices; before them is the middle of its box.
    pub(super) positions: Range<u32>,
    pub(super) parts: Vec<PartTables>,
    pub(super) components: Range<usize>,
    /// As many as there are parts.
    pub(super) partition: Vec<Part>,
}

/// What decides how a component counts.
#[derive(Debug, Clone, Copy)]
pub(super) struct ComponentBox {
    /// Its own, or its caster's.
    pub(super) bounds: Bounds,
    pub(super) of_caster: Bounds,
    /// Closed, and no part of it can be seen through.
    pub(super) is_solid: bool,
}

impl ComponentBox {
    /// Whether all of its triangles count, or only those that face the light.
    pub(super) fn is_every(&self, camera: &Camera, light: LightPosition) -> bool {
        !self.is_solid || Counting::of_box(&self.bounds, &self.of_caster, camera, light) == Counting::Every
    }

    /// The largest coordinate of the caster's box.
    pub(super) fn reach(&self) -> f64 {
        self.of_caster.min.abs().max(self.of_caster.max.abs()).max_element()
    }
}

/// All casters of a scene.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) positions: Table,
    pub(super) triangles: Table,
    pub(super) edges: Table,
    pub(super) incidences: Table,
    pub(super) component_boxes: Vec<ComponentBox>,
    pub(super) casters: Vec<CasterTables>,
    /// Others fill `positions`.
    are_positions_shared: bool,
    /// Of which casters nothing but boxes is known.
    are_anywhere: Vec<bool>,
    pub(super) triangle_count: u32,
    pub(super) edge_count: u32,
    /// Bits that hold any edge's multiplicity, with its sign.
    pub(super) lane_bits: u32,
}

impl Tables {
    /// Uploads `casters`: 16 bytes for each vertex and triangle, and 32 for each edge of up to three triangles. With `may_sum`, casters that would be in more than
    /// [`MOST_PARTS`] parts are in one. Positions may be those that others fill; and of casters that are anywhere, nothing but boxes is known.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] as for [`Table::new`].
    pub(super) fn new(
        gpu: &Gpu,
        casters: &[Caster],
        (shared_positions, are_anywhere): (Option<&Table>, Vec<bool>),
        may_sum: bool,
    ) -> Result<Self, GpuError> {
        let mut lists = Lists::default();
        let ranges = position_ranges(casters);
        let position_count = ranges.last().map_or(0, |range| range.end);
        let partition = |i: usize| {
            let parts = if are_anywhere[i] { parts_anywhere(&casters[i]) } else { parts(&casters[i]) };
            if may_sum && parts.len() > MOST_PARTS { vec![Part::whole(&casters[i])] } else { parts }
        };
        let ranges: Vec<CasterTables> =
            ranges.into_iter().enumerate().map(|(i, range)| lists.add(&casters[i], range, partition(i))).collect();
        // Bits are wanted for both signs.
        let lane_bits = [4, 8, 16].into_iter().find(|bits| lists.most_on_edge < 1 << (bits - 1)).unwrap_or(32);
        let tables = Self {
            are_positions_shared: shared_positions.is_some(),
            positions: match shared_positions {
                Some(shared) => shared.clone(),
                None => Table::new(gpu, "caster positions", position_count as usize)?,
            },
            triangles: Table::of(gpu, "caster triangles", &lists.triangles)?,
            edges: Table::of(gpu, "caster edges", &lists.edges)?,
            incidences: Table::of(gpu, "triangles on edges", lists.incidences.as_chunks().0)?,
            component_boxes: component_boxes(casters, &are_anywhere),
            casters: ranges,
            are_anywhere,
            triangle_count: lists.triangles.len() as u32,
            edge_count: lists.edges.len() as u32,
            lane_bits,
        };
        tables.write_positions(gpu, casters);
        Ok(tables)
    }

    /// Uploads the positions of `casters` again, which must have the meshes of those that this was made of. Whether what is known of them still
    /// holds where they are now: else new tables are needed.
    pub(super) fn update(
        &mut self,
        gpu: &Gpu,
        casters: &[Caster],
        (shared_positions, are_anywhere): (Option<&Table>, &[bool]),
    ) -> bool {
        if shared_positions.is_some() != self.are_positions_shared || *are_anywhere != *self.are_anywhere {
            return false;
        }
        self.component_boxes = component_boxes(casters, are_anywhere);
        self.write_positions(gpu, casters);
        let mut known = casters.iter().zip(&self.casters).zip(are_anywhere).filter(|(_, is_anywhere)| !**is_anywhere);
        known.all(|((caster, tables), _)| still_holds(caster, &tables.partition))
    }

    fn write_positions(&self, gpu: &Gpu, casters: &[Caster]) {
        if !self.are_positions_shared {
            self.positions.write(gpu, &position_entries(casters, |_| false));
        }
    }
}

/// Where the vertices of casters are in a table of positions; before each caster's is the middle of its box.
pub(crate) fn position_ranges(casters: &[Caster]) -> Vec<Range<u32>> {
    let mut end = 0;
    let range = |caster: &Caster| {
        let start = end + 1;
        end = start + caster.positions.len() as u32;
        start..end
    };
    casters.iter().map(range).collect()
}

/// The table: three bit patterns of `f32`, and, for vertices of those casters of which `is_numbered` says so, their number in the mesh and one more.
pub(crate) fn position_entries(casters: &[Caster], is_numbered: impl Fn(usize) -> bool) -> Vec<Entry> {
    let mut entries = Vec::new();
    for (i, caster) in casters.iter().enumerate() {
        let is_numbered = is_numbered(i);
        let entry = |p: Vec3, number| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), number];
        entries.push(entry(caster.bounds.center().as_vec3(), 0));
        let numbered = caster.positions.iter().zip(1..);
        entries.extend(numbered.map(|(&p, number)| entry(p, if is_numbered { number } else { 0 })));
    }
    entries
}

/// Positions that only the GPU knows.
#[derive(Debug)]
pub(crate) struct Displaced {
    /// As [`position_entries`] has them.
    pub(crate) positions: Table,
    /// Those whose vertices are anywhere in their boxes.
    pub(crate) casters: Vec<bool>,
}

/// The tables while they grow.
#[derive(Debug, Default)]
struct Lists {
    triangles: Vec<Entry>,
    edges: Vec<Entry>,
    /// Words.
    incidences: Vec<u32>,
    most_on_edge: u32,
    components: usize,
}

impl Lists {
    fn add(&mut self, caster: &Caster, positions: Range<u32>, parts: Vec<Part>) -> CasterTables {
        let topology = &caster.topology;
        let components = self.components..self.components + topology.components().len();
        self.components = components.end;
        let is_solid = |t: usize| {
            let component = topology.component_of_triangle()[t] as usize;
            topology.components()[component].is_closed && !caster.role.is_see_through()
        };

        // Of each triangle: its part, and its number in the table.
        let mut places = vec![(0, 0); caster.mesh.triangles().len()];
        let mut tables = Vec::with_capacity(parts.len());
        for (p, part) in parts.iter().enumerate() {
            let first = self.triangles.len() as u32;
            for (&t, number) in part.triangles.iter().zip(first..) {
                let [a, b, c] = caster.mesh.triangles()[t as usize].map(|i| positions.start + i);
                let component = topology.component_of_triangle()[t as usize];
                self.triangles.push([a, b, c, components.start as u32 + component]);
                places[t as usize] = (p, number);
            }
            let triangles = first..self.triangles.len() as u32;
            tables.push(PartTables { triangles, edges: Vec::new(), most_overlaps: part.most_overlaps });
        }

        // Of each part, the edges with their triangles there: a part's chain has a boundary of its own.
        let mut order: Vec<(usize, Copies, usize)> = Vec::with_capacity(topology.edges().len());
        let mut on_edge: Vec<(usize, usize, i32)> = Vec::new();
        for e in 0..topology.edges().len() {
            on_edge.clear();
            on_edge.extend(topology.triangles_on_edge(e).map(|(t, direction)| (places[t].0, t, direction)));
            on_edge.sort_unstable();
            for of_part in on_edge.chunk_by(|a, b| a.0 == b.0) {
                let every = of_part.len() as u32;
                let forward = of_part.iter().filter(|(.., direction)| *direction > 0).count() as u32;
                let facing = if is_solid(of_part[0].1) { forward.max(every - forward) } else { every };
                order.push((of_part[0].0, Copies { facing, every }, e));
            }
        }
        order.sort_unstable();
        for (part, copies, e) in order {
            let number = self.edges.len() as u32;
            match tables[part].edges.last_mut() {
                Some(run) if run.copies == copies => run.edges.end = number + 1,
                _ => tables[part].edges.push(EdgeRun { edges: number..number + 1, copies }),
            }
            let edge = topology.edges()[e];
            let incidences = (self.incidences.len() / 4) as u32;
            let of_part = topology.triangles_on_edge(e).filter(|&(t, _)| places[t].0 == part);
            self.incidences.push(copies.every);
            self.incidences.extend(of_part.map(|(t, direction)| places[t].1 << 1 | u32::from(direction < 0)));
            self.incidences.resize(self.incidences.len().next_multiple_of(4), 0);
            self.most_on_edge = self.most_on_edge.max(copies.every);
            self.edges.push([positions.start + edge.low, positions.start + edge.high, incidences, positions.start - 1]);
        }
        CasterTables { positions, parts: tables, components, partition: parts }
    }
}

/// For each component of each caster, in order.
fn component_boxes(casters: &[Caster], are_anywhere: &[bool]) -> Vec<ComponentBox> {
    let mut boxes = Vec::new();
    for (caster, &is_anywhere) in casters.iter().zip(are_anywhere) {
        let first = boxes.len();
        boxes.extend(caster.topology.components().iter().map(|component| ComponentBox {
            bounds: if is_anywhere { caster.bounds } else { Bounds::EMPTY },
            of_caster: caster.bounds,
            is_solid: component.is_closed && !caster.role.is_see_through(),
        }));
        if is_anywhere {
            continue;
        }
        for (t, &component) in caster.topology.component_of_triangle().iter().enumerate() {
            let bounds = &mut boxes[first + component as usize].bounds;
            *bounds = caster.corners(t).into_iter().map(Vec3::as_dvec3).fold(*bounds, Bounds::including);
        }
    }
    boxes
}
