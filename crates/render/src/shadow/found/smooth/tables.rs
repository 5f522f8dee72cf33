//! What is known of smooth bodies before there is a light, as words for shaders.
//!
//! ```text
//! vertices        of each wedge its vertex of the caster
//! corner starts   of each wedge its first corner, and the end
//! corners         of triangles, three each
//! triangles       three wedges each
//! triangle edges  three edges between wedges each
//! edges           two wedges each
//! edge triangles  two of each edge
//! bends           of each edge
//! creases         two vertices and two edges each
//! ```

use umbrae_core::{SmoothBody, SmoothTables};

/// Where the things of one body are among words, and how many there are.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyTables {
    pub(super) vertices: u32,
    pub(super) corner_starts: u32,
    pub(super) wedge_count: u32,
    pub(super) triangles: u32,
    pub(super) triangle_edges: u32,
    pub(super) triangle_count: u32,
    pub(super) edges: u32,
    pub(super) edge_triangles: u32,
    pub(super) bends: u32,
    pub(super) edge_count: u32,
    pub(super) creases: u32,
    pub(super) crease_count: u32,
    /// The first among normals; then, of each wedge, its inner place.
    pub(super) normals: u32,
}

/// Words and normals of all bodies.
#[derive(Debug, Default)]
pub(super) struct Tables {
    pub(super) words: Vec<u32>,
    /// Four words each. The fourth of an inner place is 1 where the vertex stays there, whatever its edges do: at the end of a crease.
    pub(super) normals: Vec<[f32; 4]>,
    /// Of each caster; `None` where it stands for none, or for one that shaders can't go through.
    pub(super) of_casters: Vec<Option<BodyTables>>,
}

impl Tables {
    /// About 100 bytes for each triangle.
    pub(super) fn new(bodies: &[Option<SmoothBody>]) -> Self {
        let mut tables = Self::default();
        for body in bodies {
            let of_body = body.as_ref().and_then(SmoothBody::tables).map(|body| tables.add(&body));
            tables.of_casters.push(of_body);
        }
        tables
    }

    fn add(&mut self, body: &SmoothTables) -> BodyTables {
        let normals = self.normals.len() as u32;
        self.normals.extend(body.normals.iter().map(|normal| normal.extend(0.0).to_array()));
        let inner = body.inner.iter().zip(&body.is_end_of_crease);
        self.normals.extend(inner.map(|(place, &stays)| place.extend(if stays { 1.0 } else { 0.0 }).to_array()));
        let mut put = |words: &[u32]| {
            let start = self.words.len() as u32;
            self.words.extend_from_slice(words);
            start
        };
        let creases: Vec<u32> =
            body.creases.iter().flat_map(|crease| [crease.vertices, crease.edges].concat()).collect();
        let mut of_body = BodyTables {
            vertices: put(&body.vertices),
            corner_starts: 0,
            wedge_count: body.vertices.len() as u32,
            triangles: put(body.triangles.as_flattened()),
            triangle_edges: put(body.triangle_edges.as_flattened()),
            triangle_count: body.triangles.len() as u32,
            edges: put(body.edges.as_flattened()),
            edge_triangles: put(body.edge_triangles.as_flattened()),
            bends: put(&body.bends),
            edge_count: body.edges.len() as u32,
            creases: put(&creases),
            crease_count: body.creases.len() as u32,
            normals,
        };
        of_body.corner_starts = self.add_corners(body);
        of_body
    }

    /// Of each wedge the corners that it is at.
    fn add_corners(&mut self, body: &SmoothTables) -> u32 {
        let wedges = body.triangles.as_flattened();
        let mut corners: Vec<u32> = (0..wedges.len() as u32).collect();
        corners.sort_by_key(|&corner| wedges[corner as usize]);
        let start = self.words.len() as u32;
        let first = start + body.vertices.len() as u32 + 1;
        let mut counts = vec![0; body.vertices.len()];
        wedges.iter().for_each(|&w| counts[w as usize] += 1);
        let mut next = first;
        for count in counts {
            self.words.push(next);
            next += count;
        }
        self.words.push(next);
        self.words.extend(corners);
        start
    }
}
