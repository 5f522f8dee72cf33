//! What a volume says of points on its own body, against rays through the curved surface.

use glam::{DVec3, Vec2, Vec3};
use umbrae_core::{LightPosition, RayCaster};

use super::subject::{Lit, Part, Subject};

/// Normals with a cosine to the light below this are dark anyway, or nearly.
const LEAST_COSINE: f64 = 0.1;
/// Points are asked so far before their surface, in radii of the body: on the mesh less than any bulge of it, and on the curved surface more than
/// its own triangles are from it.
const BEFORE_MESH: f64 = 1e-5;
const BEFORE_SURFACE: f64 = 1e-3;

/// A point of a body, on its mesh and on its curved surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    on_mesh: DVec3,
    /// Of the triangle.
    face: DVec3,
    /// As it is shaded: between those of the triangle's corners.
    normal: DVec3,
    on_surface: DVec3,
    surface_normal: DVec3,
}

/// What was found on a body's own surface.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SelfShadow {
    pub(crate) lit: usize,
    /// Lit by normals and rays, and dark by the volume.
    pub(crate) darkened: usize,
    /// Dark by rays, and lit by normals and the volume.
    pub(crate) leaked: usize,
    /// Of these, those that are farther than a band from all points that rays decide as they are.
    pub(crate) strays: usize,
    /// The largest such distance, in radii.
    pub(crate) farthest: f64,
    /// Where that is.
    pub(crate) worst: DVec3,
}

impl SelfShadow {
    pub(crate) fn add(&mut self, other: Self) {
        self.lit += other.lit;
        self.darkened += other.darkened;
        self.leaked += other.leaked;
        self.strays += other.strays;
        if other.farthest > self.farthest {
            (self.farthest, self.worst) = (other.farthest, other.worst);
        }
    }
}

/// Numbers from 0 to 1, the same on every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }
}

/// So many points, as dense everywhere, of the parts that are smooth.
pub(crate) fn samples(subject: &Subject, count: usize, random: &mut Random) -> Vec<Sample> {
    let mut ends = Vec::new();
    let mut area = 0.0;
    for (p, part) in subject.parts.iter().enumerate() {
        let Some((_, finer)) = &part.smooth else { continue };
        for (t, corners) in finer.triangles().iter().enumerate() {
            let [a, b, c] = corners.map(|v| finer.positions()[v as usize].as_dvec3());
            area += (b - a).cross(c - a).length();
            ends.push((area, p, t));
        }
    }
    let mut sample = || {
        let (_, p, t) = ends[ends.partition_point(|end| end.0 < area * random.next()).min(ends.len() - 1)];
        let (u, v) = (random.next(), random.next());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        subject.parts[p].sample(t, [1.0 - u - v, u, v])
    };
    (0..count).map(|_| sample()).collect()
}

fn between(corners: [Vec3; 3], weights: [f64; 3]) -> DVec3 {
    (0..3).map(|i| corners[i].as_dvec3() * weights[i]).sum()
}

impl Part {
    /// The point of triangle `t` of the curved surface with these weights, and the one of the mesh that it stands for.
    fn sample(&self, t: usize, weights: [f64; 3]) -> Sample {
        let (_, finer) = self.smooth.as_ref().expect("it is smooth");
        let whole = t / (finer.triangles().len() / self.caster.mesh.triangles().len());
        let [uv_a, uv_b, uv_c] = finer.corner_uvs()[t].map(Vec2::as_dvec2);
        let uv = uv_a * weights[0] + uv_b * weights[1] + uv_c * weights[2];
        let on_whole = [1.0 - uv.x - uv.y, uv.x, uv.y];
        let corners = self.caster.corners(whole);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        Sample {
            on_mesh: between(corners, on_whole),
            face: (b - a).cross(c - a).normalize_or_zero(),
            normal: between(self.normals[whole], on_whole).normalize_or_zero(),
            on_surface: between(finer.triangles()[t].map(|v| finer.positions()[v as usize]), weights),
            surface_normal: between(finer.corner_normals()[t], weights).normalize_or_zero(),
        }
    }
}

/// How often the part's volume holds `point`: what is met of its light cap, folds and fins on the way to `light`, as no side is.
pub(crate) fn count_to_light(cap: &RayCaster, point: DVec3, light: LightPosition) -> i32 {
    let (way, mut count) = (light.offset_from(point), 0);
    let end = if light.is_directional() { f64::INFINITY } else { 1.0 };
    cap.for_each_hit(point, way, 0.0, end, |hit| count += cap.normal(&hit).dot(way).signum() as i32);
    count
}

/// The cap of one part's volume, for [`count_to_light`].
pub(crate) fn cap_of(lit: &Lit) -> RayCaster {
    RayCaster::new([(lit.positions.as_slice(), lit.smooth.light_cap.as_slice())])
}

/// `samples` under `light`, with a band of so many radii.
pub(crate) fn self_shadow(
    subject: &Subject,
    caps: &[RayCaster],
    samples: &[Sample],
    light: LightPosition,
    band: f64,
) -> SelfShadow {
    let is_dark_by_rays = |sample: &Sample| {
        let is_turned = sample.surface_normal.dot(light.offset_from(sample.on_surface)) > 0.0;
        let before = sample.on_surface + sample.surface_normal * (BEFORE_SURFACE * subject.radius_m);
        !is_turned || subject.is_blocked(before, light)
    };
    let by_rays: Vec<bool> = samples.iter().map(is_dark_by_rays).collect();
    let mut found = SelfShadow::default();
    for (sample, &is_dark) in samples.iter().zip(&by_rays) {
        let way = light.offset_from(sample.on_mesh).normalize_or_zero();
        if sample.normal.dot(way) < LEAST_COSINE {
            continue;
        }
        let point = sample.on_mesh + sample.face * (BEFORE_MESH * subject.radius_m);
        let is_counted = caps.iter().any(|cap| count_to_light(cap, point, light) != 0);
        found.lit += usize::from(!is_dark);
        if is_counted == is_dark {
            continue;
        }
        *if is_counted { &mut found.darkened } else { &mut found.leaked } += 1;
        let others = samples.iter().zip(&by_rays).filter(|&(_, &dark)| dark == is_counted);
        let distances = others.map(|(other, _)| other.on_surface.distance_squared(sample.on_surface));
        let distance = distances.fold(f64::INFINITY, f64::min).sqrt() / subject.radius_m;
        found.strays += usize::from(distance > band);
        if distance > found.farthest {
            (found.farthest, found.worst) = (distance, sample.on_mesh);
        }
    }
    found
}
