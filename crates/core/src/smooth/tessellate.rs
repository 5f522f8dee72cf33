//! The curved surface that a smooth body's normals tell of, as a finer mesh.
//!
//! ```text
//!          c               Each triangle becomes a cubic patch. Its rows of points along a-b, b-c and c-a are those of the
//!         / \              curves of its edges, the same for both sides, so that what is closed stays closed; the middle
//!        o . o             control point is the one that makes the patch quadratic where its edges are. Each side is cut
//!       / . . \            into as many pieces.
//!      a - o - b
//! ```
//!
//! Source: A. Vlachos, J. Peters, C. Boyd and J. Mitchell, "Curved PN triangles", 2001. Departures: edges are the curves from which smooth
//! silhouettes are made ([`super::curve`]), creases included, where the paper lets creases gape; and the quadratic that normals follow has the curve's
//! own normal in the middle of each edge.

use glam::{DVec3, Vec2, Vec3};

use crate::{Caster, Mesh, MeshError, Surface};

use super::body::SmoothBody;
use super::curve::Curve;

impl SmoothBody {
    /// The curved surface of the body, which is that of `caster`, each side of a triangle cut into as many `pieces`; 0 counts as 1.
    ///
    /// In scene space, with normals at its corners. What was triangle t is now those from `t * pieces * pieces` on, with its material, texture
    /// coordinates and colours. The mesh is closed where the caster's is: points on an edge are shared by all triangles there. The caster's
    /// vertices are on it, and what has the normals of a plane stays in it. Takes about a microsecond and 100 bytes for each new triangle.
    ///
    /// # Errors
    ///
    /// [`MeshError::TooLarge`] if there would be more triangles or vertices than a mesh can hold, [`MeshError::BadPosition`] if a curve leaves the range of
    /// coordinates.
    pub fn tessellated(&self, caster: &Caster, pieces: u32) -> Result<Mesh, MeshError> {
        let n = pieces.max(1) as usize;
        let count = n.checked_mul(n).and_then(|each| each.checked_mul(caster.mesh.triangles().len()));
        let count = count.filter(|&count| count < (u32::MAX / 8) as usize);
        if count.is_none() {
            let count = caster.mesh.triangles().len().saturating_mul(n.saturating_mul(n));
            return Err(MeshError::TooLarge { what: "triangles", count });
        }
        let mut cutter = Cutter::new(self, caster, n);
        for t in 0..caster.mesh.triangles().len() {
            cutter.add_triangle(t);
        }
        cutter.finish()
    }
}

/// A triangle's cubic patch and what goes over it.
struct Patch {
    corners: [DVec3; 3],
    normals: [DVec3; 3],
    /// Edge i goes from corner i to the next: its curve, whether that runs the other way, and the normal in its middle times two, less the mean of its ends'.
    edges: [(Curve, bool); 3],
    edge_normals: [DVec3; 3],
    /// Two of each edge, in the direction in which the triangle walks it.
    controls: [[DVec3; 2]; 3],
    middle: DVec3,
}

impl Patch {
    fn new(body: &SmoothBody, t: usize) -> Self {
        let wedges = body.wedges.mesh.triangles()[t];
        let [corners, normals] = [wedges.map(|w| body.place(w)), wedges.map(|w| body.normal(w))];
        let edges = [0, 1, 2].map(|i| {
            let (from, to) = (wedges[i], wedges[(i + 1) % 3]);
            let e = body.wedges.topology.edge_between(from, to).expect("the edge is the triangle's");
            (body.curve_of_edge(e), body.ends(e) != [from, to])
        });
        let edge_normals = [0, 1, 2].map(|i| {
            let (curve, is_turned) = &edges[i];
            let [a, b] = [normals[i], normals[(i + 1) % 3]];
            // From the lower vertex to the higher, so that both sides find the same bits.
            let ends = if *is_turned { [b, a] } else { [a, b] };
            2.0 * curve.normal(0.5, ends) - 0.5 * (ends[0] + ends[1])
        });
        let controls = edges.map(|(curve, is_turned)| {
            let [first, second] = curve.controls();
            if is_turned { [second, first] } else { [first, second] }
        });
        let of_edges = controls.as_flattened().iter().sum::<DVec3>() / 6.0;
        let of_corners = corners.iter().sum::<DVec3>() / 3.0;
        let middle = of_edges + 0.5 * (of_edges - of_corners);
        Self { corners, normals, edges, edge_normals, controls, middle }
    }

    /// The point with these weights of the corners, which add up to 1.
    fn at(&self, weights: [f64; 3]) -> DVec3 {
        let mut sum = 6.0 * weights[0] * weights[1] * weights[2] * self.middle;
        for i in 0..3 {
            let (u, v) = (weights[i], weights[(i + 1) % 3]);
            sum += u * u * u * self.corners[i] + 3.0 * u * v * (u * self.controls[i][0] + v * self.controls[i][1]);
        }
        sum
    }

    fn normal(&self, weights: [f64; 3]) -> Vec3 {
        let mut sum = DVec3::ZERO;
        for i in 0..3 {
            let (u, v) = (weights[i], weights[(i + 1) % 3]);
            sum += u * u * self.normals[i] + 2.0 * u * v * self.edge_normals[i];
        }
        let linear = || (0..3).map(|i| weights[i] * self.normals[i]).sum::<DVec3>();
        sum.try_normalize().unwrap_or_else(|| linear().normalize_or_zero()).as_vec3()
    }
}

/// Triangles as they are cut.
struct Cutter<'a> {
    body: &'a SmoothBody,
    caster: &'a Caster,
    n: usize,
    /// Vertices of the caster, then n - 1 for each of its edges, then those within its triangles.
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    corner_normals: Vec<[Vec3; 3]>,
    corner_uvs: Vec<[Vec2; 3]>,
    corner_colors: Vec<[Vec3; 3]>,
    /// Of the triangle that is being cut: in rows towards its last corner, each one shorter than the one before.
    grid: Vec<u32>,
}

impl<'a> Cutter<'a> {
    fn new(body: &'a SmoothBody, caster: &'a Caster, n: usize) -> Self {
        let mut points = caster.positions.clone();
        points.resize(points.len() + (n - 1) * caster.topology.edges().len(), Vec3::NAN);
        let count = n * n * caster.mesh.triangles().len();
        Self {
            body,
            caster,
            n,
            points,
            triangles: Vec::with_capacity(count),
            corner_normals: Vec::with_capacity(count),
            corner_uvs: Vec::new(),
            corner_colors: Vec::new(),
            grid: Vec::new(),
        }
    }

    /// The place in the grid of the point with `b` steps towards the second corner and `c` towards the last.
    fn place(&self, b: usize, c: usize) -> usize {
        c * (2 * self.n + 3 - c) / 2 + b
    }

    fn add_triangle(&mut self, t: usize) {
        let patch = Patch::new(self.body, t);
        let n = self.n;
        self.grid.clear();
        for c in 0..=n {
            for b in 0..=n - c {
                let point = self.point(&patch, t, [n - b - c, b, c]);
                self.grid.push(point);
            }
        }
        for c in 0..n {
            for b in 0..n - c {
                self.add_piece(&patch, t, [[b, c], [b + 1, c], [b, c + 1]]);
                if b + c + 1 < n {
                    self.add_piece(&patch, t, [[b + 1, c], [b + 1, c + 1], [b, c + 1]]);
                }
            }
        }
    }

    /// The point so many steps towards each corner of triangle `t`.
    fn point(&mut self, patch: &Patch, t: usize, steps: [usize; 3]) -> u32 {
        let corners = self.caster.mesh.triangles()[t];
        if let Some(i) = steps.iter().position(|&step| step == self.n) {
            return corners[i];
        }
        let weights = steps.map(|step| step as f64 / self.n as f64);
        let Some(i) = (0..3).find(|&i| steps[(i + 2) % 3] == 0) else {
            self.points.push(patch.at(weights).as_vec3());
            return self.points.len() as u32 - 1;
        };
        // On edge i, as far from the caster's lower vertex as the curve counts.
        let e =
            self.caster.topology.edge_between(corners[i], corners[(i + 1) % 3]).expect("the edge is the triangle's");
        let (curve, is_turned) = &patch.edges[i];
        let step = if *is_turned { steps[i] } else { steps[(i + 1) % 3] };
        let point = self.caster.positions.len() + e * (self.n - 1) + step - 1;
        self.points[point] = curve.at(step as f64 / self.n as f64).as_vec3();
        point as u32
    }

    /// One of the small triangles of triangle `t`, by its corners' steps towards the second and last of its corners.
    fn add_piece(&mut self, patch: &Patch, t: usize, corners: [[usize; 2]; 3]) {
        self.triangles.push(corners.map(|[b, c]| self.grid[self.place(b, c)]));
        let n = self.n as f64;
        let weights = corners.map(|[b, c]| [n - b as f64 - c as f64, b as f64, c as f64].map(|steps| steps / n));
        self.corner_normals.push(weights.map(|weights| patch.normal(weights)));
        if let Some(uvs) = self.caster.mesh.corner_uvs().get(t) {
            let at = |weights: [f64; 3]| (0..3).map(|i| weights[i] as f32 * uvs[i]).sum();
            self.corner_uvs.push(weights.map(at));
        }
        if let Some(colors) = self.caster.mesh.corner_colors().get(t) {
            let at = |weights: [f64; 3]| (0..3).map(|i| weights[i] as f32 * colors[i]).sum();
            self.corner_colors.push(weights.map(at));
        }
    }

    fn finish(self) -> Result<Mesh, MeshError> {
        let Self { caster, n, points, mut triangles, corner_normals, corner_uvs, corner_colors, .. } = self;
        let materials = caster.mesh.triangle_materials().iter();
        let mut surface = Surface {
            triangle_materials: materials.flat_map(|&material| std::iter::repeat_n(material, n * n)).collect(),
            // What is at one place without being one point is kept apart, as it was.
            weld_keys: (0..points.len() as u32).collect(),
            positions: points,
            corner_uvs,
            corner_normals,
            ..Surface::default()
        };
        if !corner_colors.is_empty() {
            // A surface has colours of positions: each corner gets one of its own, which welding joins again.
            surface.weld_keys = triangles.as_flattened().to_vec();
            surface.positions = surface.weld_keys.iter().map(|&point| surface.positions[point as usize]).collect();
            surface.vertex_colors = corner_colors.into_flattened();
            for (t, corners) in triangles.iter_mut().enumerate() {
                *corners = [0, 1, 2].map(|i| 3 * t as u32 + i);
            }
        }
        surface.triangles = triangles;
        Mesh::new(surface)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DAffine3;

    use super::*;
    use crate::smooth::tests::{bodies, body_of, caster_of};
    use crate::{Object, Topology, shapes};

    fn finer(caster: &Caster, pieces: u32) -> Mesh {
        body_of(caster).tessellated(caster, pieces).expect("it is small")
    }

    #[test]
    fn what_is_closed_stays_closed_and_keeps_its_vertices() {
        for (name, caster) in bodies() {
            for pieces in [1, 2, 5] {
                let mesh = finer(&caster, pieces);
                let counts = Topology::new(&mesh).counts();
                assert!(counts.is_closed() && counts.inconsistent_edges == 0, "{name} in {pieces}: {counts:?}");
                let n = pieces as usize;
                assert_eq!(mesh.triangles().len(), n * n * caster.mesh.triangles().len());
                // Euler: two vertices fewer than half of the triangles on a sphere, none on a torus.
                let euler = |mesh: &Mesh| mesh.positions().len() as i64 - mesh.triangles().len() as i64 / 2;
                assert_eq!(euler(&mesh), euler(&caster.mesh), "{name} in {pieces}");
                assert!(caster.positions.iter().all(|p| mesh.positions().contains(p)), "{name} in {pieces}");
            }
        }
    }

    #[test]
    fn any_normals_leave_it_closed_and_finite() {
        let torus = caster_of(shapes::torus(Vec3::ZERO, 1.5, 0.5, 12, 8));
        let normals: Vec<[Vec3; 3]> = (0..torus.mesh.triangles().len())
            .map(|t| {
                std::array::from_fn(|i| (Vec3::from(torus.corners(t)[i]) * 97.3).map(f32::sin).normalize_or_zero())
            })
            .collect();
        let body = SmoothBody::new(&torus, &normals).expect("it is not flat");
        let mesh = body.tessellated(&torus, 4).expect("it is small");
        assert!(Topology::new(&mesh).counts().is_closed());
        assert!(mesh.positions().iter().all(|p| p.length() < 4.0));
    }

    #[test]
    fn a_sphere_of_eighty_triangles_becomes_round() {
        for (subdivisions, off_m) in [(0, 0.03), (1, 0.003), (2, 0.001)] {
            let sphere = caster_of(shapes::icosphere(Vec3::ZERO, 1.0, subdivisions));
            let mesh = finer(&sphere, 6);
            for (corners, normals) in mesh.triangles().iter().zip(mesh.corner_normals()) {
                for (&v, normal) in corners.iter().zip(normals) {
                    let p = mesh.positions()[v as usize];
                    assert!((p.length() - 1.0).abs() < off_m, "{} from the middle of {subdivisions}", p.length());
                    // As near as those of its vertices are.
                    assert!(normal.dot(p.normalize_or_zero()) > 0.997, "{normal} at {p}");
                }
            }
        }
    }

    #[test]
    fn the_ends_of_a_cylinder_stay_flat_and_become_round() {
        let cylinder = caster_of(shapes::cylinder(Vec3::ZERO, 1.0, 2.0, 12));
        let mesh = finer(&cylinder, 4);
        for (t, corners) in mesh.triangles().iter().enumerate() {
            let whole = cylinder.corners(t / 16);
            let is_end = whole.iter().all(|p| p.z == whole[0].z);
            for (p, normal) in corners.map(|v| mesh.positions()[v as usize]).iter().zip(mesh.corner_normals()[t]) {
                if is_end {
                    assert!(p.z == 0.0 || p.z == 2.0, "{p} is in an end");
                    assert!(normal.z.abs() > 1.0 - 1e-6);
                } else {
                    let radius = p.truncate().length();
                    // The middle of a patch is a twentieth of its height off.
                    assert!((radius - 1.0).abs() < 1.7e-3 && normal.z.abs() < 1e-6, "{p} with {normal}");
                }
            }
        }
    }

    #[test]
    fn a_box_beside_a_ball_stays_as_it_is() {
        let (mut both, cube) =
            (shapes::icosphere(Vec3::ZERO, 1.0, 1), shapes::cuboid(Vec3::splat(2.0), Vec3::splat(3.0)));
        let first = both.positions.len() as u32;
        both.positions.extend(cube.positions);
        both.triangles.extend(cube.triangles.iter().map(|corners| corners.map(|v| first + v)));
        let mesh = finer(&caster_of(both), 3);
        for corners in &mesh.triangles()[80 * 9..] {
            let on_side = |axis: usize| {
                let at = corners.map(|v| mesh.positions()[v as usize][axis]);
                [2.0, 3.0].iter().any(|&side| at.iter().all(|&x| x == side))
            };
            assert!((0..3).any(on_side), "{corners:?}");
        }
    }

    #[test]
    fn materials_colours_and_textures_go_along() {
        let mut surface = shapes::icosphere(Vec3::ZERO, 1.0, 1);
        surface.triangle_materials = (0..80).collect();
        surface.vertex_colors = surface.positions.iter().map(|p| 0.5 * (*p + Vec3::ONE)).collect();
        surface.corner_uvs = vec![[Vec2::ZERO, Vec2::X, Vec2::Y]; 80];
        let mesh = Arc::new(Mesh::new(surface).expect("a good sphere"));
        let topology = Arc::new(Topology::new(&mesh));
        let caster = Caster::new(&Object::new("body", mesh, DAffine3::IDENTITY), topology);
        let finer = finer(&caster, 2);
        assert!(Topology::new(&finer).counts().is_closed());
        assert_eq!(finer.positions().len(), 162);
        assert_eq!(finer.triangle_materials()[4 * 33..][..4], [33; 4]);
        for (t, (colors, uvs)) in finer.corner_colors().iter().zip(finer.corner_uvs()).enumerate() {
            for i in 0..3 {
                let of = finer.positions()[finer.triangles()[t][i] as usize];
                // Colours are interpolated along chords, points along arcs.
                assert!(colors[i].distance(0.5 * (of + Vec3::ONE)) < 0.1);
                assert!(uvs[i].min_element() >= 0.0 && uvs[i].element_sum() <= 1.0);
            }
        }
    }

    #[test]
    fn too_fine_is_refused_before_memory_is_asked_for() {
        let sphere = caster_of(shapes::icosphere(Vec3::ZERO, 1.0, 1));
        let refused = body_of(&sphere).tessellated(&sphere, u32::MAX).expect_err("it is too large");
        assert!(matches!(refused, MeshError::TooLarge { what: "triangles", .. }), "{refused}");
    }
}
