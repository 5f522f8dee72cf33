//! Shadows of coarse meshes against those of the round bodies that they stand for, which have closed forms; and against each other at several levels
//! of detail. Run with `--nocapture` for the tables.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3, Vec3};
use umbrae_core::{
    Caster, Chain, Counting, LightPosition, Mesh, Object, Precision, SmoothBody, SmoothVolume, Smoothness, Surface,
    Topology, corner_normals, shapes, silhouette,
};

/// Edges that bend less are round: those of the coarsest bodies here bend by 45 degrees.
const CREASE_RAD: f64 = 0.8;

fn caster_of(surface: Surface) -> Caster {
    let mesh = Arc::new(Mesh::new(surface).expect("a good mesh"));
    let topology = Arc::new(Topology::new(&mesh));
    Caster::new(&Object::new("body", mesh, DAffine3::IDENTITY), topology)
}

/// Lights above the ground, suns and lamps, none at a place that a mesh is aligned with.
fn lights() -> Vec<LightPosition> {
    let at = |azimuth: f64, altitude: f64| {
        DVec3::new(azimuth.cos() * altitude.cos(), azimuth.sin() * altitude.cos(), altitude.sin())
    };
    let ways = [at(0.31, 0.9), at(1.77, 0.45), at(4.05, 0.7), at(5.6, 1.2)];
    let suns = ways.map(|way| LightPosition::directional(way).expect("not zero"));
    let lamps = ways.map(|way| LightPosition::point(way * 12.0));
    suns.into_iter().chain(lamps).collect()
}

const GROUND_Z: f64 = -3.0;

/// Where the shadow of `p` falls on the ground.
fn shadow(light: LightPosition, p: DVec3) -> DVec2 {
    let away = -light.offset_from(p);
    (p + away * ((GROUND_Z - p.z) / away.z)).truncate()
}

type Segment = [DVec2; 2];

fn smooth_outline(caster: &Caster, light: LightPosition, epsilon_m: f64) -> Vec<Segment> {
    let body = SmoothBody::new(caster, &corner_normals(caster, &[], CREASE_RAD)).expect("it is round");
    let volume = SmoothVolume::new(&body, light, &Smoothness::Smooth(Precision::in_world(epsilon_m)));
    volume.sides.iter().map(|side| side.map(|p| shadow(light, volume.points[p as usize].as_dvec3()))).collect()
}

fn discrete_outline(caster: &Caster, light: LightPosition) -> Vec<Segment> {
    let edges = silhouette(&caster.topology, &Chain::new(caster, light, &Counting::outside(caster)));
    let place = |v: u32| shadow(light, caster.positions[v as usize].as_dvec3());
    edges.iter().map(|edge| [place(edge.start), place(edge.end)]).collect()
}

/// `n` segments through `curve`, from 0 to 1.
fn along(n: u32, curve: impl Fn(f64) -> DVec3, light: LightPosition) -> Vec<Segment> {
    let at = |i: u32| shadow(light, curve(f64::from(i) / f64::from(n)));
    (0..n).map(|i| [at(i), at(i + 1)]).collect()
}

fn distance_to(segments: &[Segment], p: DVec2) -> f64 {
    let to = |[a, b]: &Segment| {
        let (along, off) = (*b - *a, p - *a);
        let share = (off.dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (off - along * share).length_squared()
    };
    segments.iter().map(to).fold(f64::INFINITY, f64::min).sqrt()
}

/// Those parts of closed `loops` that have the shadow on one side only, cut small.
fn border(loops: &[Segment]) -> Vec<Segment> {
    let finest = 0.02 * size(loops);
    let cut = |[from, to]: &Segment| -> Vec<Segment> {
        let n = (from.distance(*to) / finest).ceil().max(1.0) as u32;
        let at = |i: u32| from.lerp(*to, f64::from(i) / f64::from(n));
        (0..n).map(|i| [at(i), at(i + 1)]).collect()
    };
    let is_border = |[from, to]: &Segment| {
        let beside = (*to - *from).perp().normalize_or_zero() * (0.001 * size(loops));
        let middle = from.midpoint(*to);
        (winding(loops, middle + beside) == 0) != (winding(loops, middle - beside) == 0)
    };
    loops.iter().flat_map(cut).filter(is_border).collect()
}

/// How often `loops` wind around `p`.
fn winding(loops: &[Segment], p: DVec2) -> i32 {
    let crossed = |&[a, b]: &Segment| {
        let is_left = (b - a).perp_dot(p - a) > 0.0;
        match (a.y <= p.y, b.y <= p.y) {
            (true, false) if is_left => 1,
            (false, true) if !is_left => -1,
            _ => 0,
        }
    };
    loops.iter().map(crossed).sum()
}

/// The farthest that a point of one shadow's border is from the other's, relative to half the largest extent of the second.
fn hausdorff(a: &[Segment], b: &[Segment]) -> f64 {
    let borders = [border(a), border(b)];
    let one_way =
        |from: &[Segment], to: &[Segment]| from.iter().flatten().map(|&p| distance_to(to, p)).fold(0.0, f64::max);
    one_way(&borders[0], &borders[1]).max(one_way(&borders[1], &borders[0])) / size(b)
}

fn size(segments: &[Segment]) -> f64 {
    let corners = || segments.iter().flatten();
    let min = corners().fold(DVec2::INFINITY, |m, &p| m.min(p));
    let max = corners().fold(DVec2::NEG_INFINITY, |m, &p| m.max(p));
    0.5 * (max - min).max_element()
}

/// The shadow's outline of the unit sphere: the tangent cone's circle.
fn sphere(light: LightPosition) -> Vec<Segment> {
    let offset = light.offset_from(DVec3::ZERO);
    let axis = offset.normalize_or_zero();
    let towards = if light.is_directional() { 0.0 } else { 1.0 / offset.length() };
    let (u, v) = axis.any_orthonormal_pair();
    let radius = (1.0 - towards * towards).sqrt();
    let at = |s: f64| axis * towards + (u * (TAU * s).cos() + v * (TAU * s).sin()) * radius;
    along(720, at, light)
}

/// Where the side of a cylinder or cone turns away: its lines, as angles about the axis. `normal` is the side's unit normal at angle 0 as
/// `(outward, upward)`, `place` a point of the side as `(radius, z)`.
fn lines(light: LightPosition, normal: DVec2, place: DVec2) -> [f64; 2] {
    let l = light.homogeneous();
    // n.(l - w v) = 0 with n and v at the same angle: a cosine of the difference to the light's azimuth.
    let level = normal.x * place.x * l.w + normal.y * (place.y * l.w - l.z);
    let across = l.truncate().truncate();
    let angle = (level / (normal.x * across.length())).acos();
    let azimuth = across.to_angle();
    [azimuth - angle, azimuth + angle]
}

fn round(angle: f64, radius: f64, z: f64) -> DVec3 {
    DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
}

/// Of radius 1, from z = 0 to 2; the light is above both ends.
fn cylinder(light: LightPosition) -> Vec<Segment> {
    let [from, to] = lines(light, DVec2::X, DVec2::X);
    let line = |angle: f64| along(1, move |s| round(angle, 1.0, 2.0 * s), light);
    // Of the upper rim the part that is turned away, of the lower the other.
    let bottom = along(720, |s| round(from + s * (to - from), 1.0, 0.0), light);
    let top = along(720, |s| round(to + s * (TAU - (to - from)), 1.0, 2.0), light);
    let back = line(from).into_iter().map(|[a, b]| [b, a]).collect();
    [back, bottom, line(to), top].concat()
}

/// Of radius 0.5, from z = 0 to its tip at 1.5.
fn cone(light: LightPosition) -> Vec<Segment> {
    let normal = DVec2::new(1.5, 0.5).normalize_or_zero();
    let [from, to] = lines(light, normal, DVec2::new(0.0, 1.5));
    let line = |angle: f64| along(1, move |s| round(angle, 0.5 * (1.0 - s), 1.5 * s), light);
    let bottom = along(720, |s| round(from + s * (to - from), 0.5, 0.0), light);
    let back = line(from).into_iter().map(|[a, b]| [b, a]).collect();
    [back, bottom, line(to)].concat()
}

/// Of radii 1.5 and 0.5, flat. Both of its contours, with the parts that others hide.
fn torus(light: LightPosition) -> Vec<Segment> {
    let l = light.homogeneous();
    let contour = |turn: f64| {
        let at = move |s: f64| {
            let (sin, cos) = (TAU * s).sin_cos();
            let outward = DVec3::new(cos, sin, 0.0);
            // n.(l - w v) = 0, where v = 1.5 outward + 0.5 n and n is between outward and up.
            let (a, b, c) = (outward.dot(l.truncate()) - 1.5 * l.w, l.z, 0.5 * l.w);
            let angle = b.atan2(a) + turn * (c / a.hypot(b)).acos();
            let normal = outward * angle.cos() + DVec3::Z * angle.sin();
            1.5 * outward + 0.5 * normal
        };
        along(1440, at, light)
    };
    // The light cap is to the left of both.
    let inner = contour(-1.0).into_iter().map(|[a, b]| [b, a]).collect();
    [contour(1.0), inner].concat()
}

/// The worst over all lights, smooth and discrete.
fn worst(surface: Surface, exact: impl Fn(LightPosition) -> Vec<Segment>, epsilon_m: f64) -> [f64; 2] {
    let caster = caster_of(surface);
    let off = |outline: &[Segment], light| hausdorff(outline, &exact(light));
    lights().into_iter().fold([0.0, 0.0], |[smooth, discrete], light| {
        let smooth_off = off(&smooth_outline(&caster, light, epsilon_m), light);
        let discrete_off = off(&discrete_outline(&caster, light), light);
        [f64::max(smooth, smooth_off), f64::max(discrete, discrete_off)]
    })
}

#[test]
fn round_bodies_cast_the_shadows_of_their_closed_forms() {
    type Exact = fn(LightPosition) -> Vec<Segment>;
    let rows: Vec<(&str, usize, Surface, Exact, f64)> = [1, 2, 3]
        .map(|i| ("sphere", 20 << (2 * i), shapes::icosphere(Vec3::ZERO, 1.0, i), sphere as Exact, 0.01))
        .into_iter()
        .chain([8, 16, 32].map(|n| ("cylinder", n, shapes::cylinder(Vec3::ZERO, 1.0, 2.0, n), cylinder as Exact, 0.01)))
        .chain([12, 24, 48].map(|n| ("cone", n, shapes::cone(Vec3::ZERO, 0.5, 1.5, n), cone as Exact, 0.005)))
        .chain([12, 24, 48].map(|n| ("torus", n, shapes::torus(Vec3::ZERO, 1.5, 0.5, n, n), torus as Exact, 0.005)))
        .collect();
    println!("body       cut into   smooth off   discrete off");
    for (name, n, surface, exact, epsilon_m) in rows {
        let [smooth, discrete] = worst(surface, exact, epsilon_m);
        println!("{name:10} {n:8}   {:8.3} %   {:10.3} %", 100.0 * smooth, 100.0 * discrete);
        assert!(smooth < 0.01, "{name} of {n}: {smooth}");
        assert!(smooth < discrete.max(epsilon_m), "{name} of {n} is better than it was");
    }
}

/// A body with a waist and a head, in as many rings as segments.
fn figure(n: usize) -> Surface {
    let at = |i: usize| {
        let (sin, cos) = (PI * i as f64 / n as f64).sin_cos();
        let distance = 1.0 + 0.25 * (3.0 * PI * i as f64 / n as f64).cos();
        // The poles are on the axis, whatever rounding says.
        let radius = if i == 0 || i == n { 0.0 } else { distance * sin };
        glam::Vec2::new(radius as f32, (-distance * cos) as f32)
    };
    shapes::revolution(Vec3::ZERO, &(0..=n).map(at).collect::<Vec<_>>(), n)
}

/// Where the line at height `y` is inside of `loops`, as ends of intervals in ascending order.
fn inside(loops: &[Segment], y: f64) -> Vec<f64> {
    let mut crossings: Vec<(f64, i32)> = Vec::new();
    for &[a, b] in loops {
        if (a.y <= y) != (b.y <= y) {
            let x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
            crossings.push((x, if a.y <= y { 1 } else { -1 }));
        }
    }
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut winding = 0;
    let is_end = |(x, turn): (f64, i32)| {
        let before = winding;
        winding += turn;
        ((before == 0) != (winding == 0)).then_some(x)
    };
    crossings.into_iter().filter_map(is_end).collect()
}

/// The area that is in one shadow only, relative to that of `b`.
fn difference(a: &[Segment], b: &[Segment]) -> f64 {
    const ROWS: u32 = 2000;
    let ys = || b.iter().flatten().map(|p| p.y);
    let (min, max) = (ys().fold(f64::INFINITY, f64::min), ys().fold(f64::NEG_INFINITY, f64::max));
    let length = |ends: &[f64]| -> f64 { ends.chunks_exact(2).map(|ends| ends[1] - ends[0]).sum() };
    let (mut only_one, mut all) = (0.0, 0.0);
    for row in 0..ROWS {
        let y = min + (max - min) * (f64::from(row) + 0.5) / f64::from(ROWS);
        let (of_a, of_b) = (inside(a, y), inside(b, y));
        // What is in an odd number of them is in one.
        let mut both = [of_a, of_b.clone()].concat();
        both.sort_by(f64::total_cmp);
        only_one += length(&both);
        all += length(&of_b);
    }
    only_one / all
}

#[test]
fn levels_of_detail_cast_one_shadow() {
    println!("body      smooth shadows differ   discrete ones differ, in parts of their area");
    for (name, make) in [
        ("sphere", (|i| shapes::icosphere(Vec3::ZERO, 1.0, i + 1)) as fn(u32) -> Surface),
        ("torus", |i| shapes::torus(Vec3::ZERO, 1.5, 0.5, 12 << i, 12 << i)),
        ("figure", |i| figure(12 << i)),
    ] {
        let levels = [0, 1, 2, 3].map(|i| caster_of(make(i)));
        let (mut smooth, mut discrete) = (0.0_f64, 0.0_f64);
        for light in lights() {
            let smooth_outlines = levels.each_ref().map(|level| smooth_outline(level, light, 0.001));
            let discrete_outlines = levels.each_ref().map(|level| discrete_outline(level, light));
            for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
                smooth = smooth.max(difference(&smooth_outlines[i], &smooth_outlines[j]));
                discrete = discrete.max(difference(&discrete_outlines[i], &discrete_outlines[j]));
            }
        }
        println!("{name:10}{:>20.3} %{:>20.3} %", 100.0 * smooth, 100.0 * discrete);
        assert!(smooth < 0.1 * discrete, "{name}: {smooth} against {discrete}");
    }
}
