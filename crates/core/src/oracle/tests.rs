//! The judge against closed forms: discs of light on a floor, panes, and holes in a checkered sheet.

use glam::{DAffine3, DVec2, Vec2, Vec3};

use super::*;
use crate::{AlphaMode, Cone, Mesh, Object, Role, Scene, Surface, Wrap, shapes};

const SIZE_PX: [u32; 2] = [96, 96];
/// What a camera 20 m above the floor sees of it, from the middle to a side.
const HALF_VIEW_M: f64 = 4.0;
/// The camera is above this point, so that no diagonal of a square comes near the centre of a pixel.
const EYE: DVec2 = DVec2::new(0.013, 0.029);

/// Straight down onto the floor.
fn camera() -> Camera {
    let fov_y_rad = 2.0 * (HALF_VIEW_M / 20.0).atan();
    Camera::new(EYE.extend(20.0), EYE.extend(0.0), fov_y_rad, 0.5, SIZE_PX).unwrap()
}

/// East and north of the middle, the point of the floor at the centre of each pixel.
fn floor_points() -> impl Iterator<Item = DVec2> {
    let [width, height] = SIZE_PX;
    let at = |i: u32, count: u32| HALF_VIEW_M * (2.0 * (f64::from(i) + 0.5) / f64::from(count) - 1.0);
    (0..height).flat_map(move |y| (0..width).map(move |x| EYE + DVec2::new(at(x, width), -at(y, height))))
}

const PIXEL_M: f64 = 2.0 * HALF_VIEW_M / SIZE_PX[0] as f64;

/// A square sheet about `(0, 0, height)`, facing up, `half` to each side, with the texture once over it.
fn sheet(height: f32, half: f32, material: u32, role: Role) -> Object {
    let mut surface =
        shapes::sheet(Vec3::new(-half, -half, height), Vec3::X * 2.0 * half, Vec3::Y * 2.0 * half, [1, 1]);
    let uv = |i: u32| {
        let p = surface.positions[i as usize];
        Vec2::new(0.5 + p.x / (2.0 * half), 0.5 - p.y / (2.0 * half))
    };
    surface.corner_uvs = surface.triangles.iter().map(|t| t.map(uv)).collect();
    surface.triangle_materials = vec![material; surface.triangles.len()];
    object(surface, role)
}

fn object(surface: Surface, role: Role) -> Object {
    let mesh = Arc::new(Mesh::new(surface).unwrap());
    Object { role, ..Object::new("", mesh, DAffine3::IDENTITY) }
}

/// One triangle, that no pixel should be undecided for its edges.
fn floor() -> Object {
    let positions = vec![Vec3::new(-90.0, -50.0, 0.0), Vec3::new(90.0, -50.0, 0.0), Vec3::new(0.0, 90.0, 0.0)];
    object(Surface { positions, triangles: vec![[0, 1, 2]], ..Surface::default() }, Role::default())
}

fn oracle(objects: Vec<Object>) -> Oracle {
    Oracle::new(&Caster::of_scene(&Scene { objects, ..Scene::default() }))
}

fn lamp(x: f64, y: f64, z: f64) -> Light {
    Light::new("lamp", LightPosition::point(DVec3::new(x, y, z)), Vec3::ONE)
}

fn judge(oracle: &Oracle, light: Light) -> Vec<Judgement> {
    oracle.judge(&camera(), &[light], || ()).remove(0)
}

/// Asserts that each pixel is lit where `inside` is positive, dark where it is negative, and undecided only where that
/// is within half a pixel of a border. `inside` is, for a point of the floor, in metres how far inside the lit region
/// it is.
fn assert_lit_where(judged: &[Judgement], inside: impl Fn(DVec2) -> f64) {
    let (mut lit, mut dark) = (0, 0);
    for (judgement, point) in judged.iter().zip(floor_points()) {
        let inside = inside(point);
        assert!(judgement.has_surface);
        match judgement.verdict {
            None => assert!(inside.abs() < 0.5 * PIXEL_M, "undecided at {point}, {inside} m inside"),
            Some(Verdict::Lit) => {
                assert!(inside > 0.0, "lit at {point}, {inside} m inside");
                lit += 1;
            }
            verdict => {
                assert_eq!(verdict, Some(Verdict::Dark));
                assert!(inside < 0.0, "dark at {point}, {inside} m inside");
                dark += 1;
            }
        }
    }
    assert!(lit > 100 && dark > 100, "{lit} lit, {dark} dark");
}

#[test]
fn a_spot_straight_above_a_floor_lights_a_disc() {
    let outer_rad = 25_f64.to_radians();
    let cone = Some(Cone { axis: DVec3::NEG_Z, inner_rad: 0.1, outer_rad });
    let judged = judge(&oracle(vec![floor()]), Light { cone, ..lamp(0.5, -0.3, 5.0) });
    let radius = 5.0 * outer_rad.tan();
    assert_lit_where(&judged, |p| radius - p.distance(DVec2::new(0.5, -0.3)));
}

#[test]
fn a_tilted_spot_lights_an_ellipse() {
    // From above the origin to the east and down at 45 degrees, 20 degrees around: the floor is lit from 25 to 65
    // degrees off the vertical, between two ends of the ellipse's long axis.
    let (height, tilt, outer_rad) = (2.0, 45_f64.to_radians(), 20_f64.to_radians());
    let axis = DVec3::new(tilt.sin(), 0.0, -tilt.cos());
    let light = Light { cone: Some(Cone { axis, inner_rad: 0.0, outer_rad }), ..lamp(-2.0, 0.0, height) };
    let [near, far] = [tilt - outer_rad, tilt + outer_rad].map(|angle| -2.0 + height * angle.tan());
    // A plane cuts a cone at eccentricity cos(angle between plane and axis) / cos(half angle).
    let (middle, long) = (f64::midpoint(near, far), 0.5 * (far - near));
    let eccentricity = tilt.sin() / outer_rad.cos();
    let short = long * (1.0 - eccentricity * eccentricity).sqrt();
    let judged = judge(&oracle(vec![floor()]), light);
    assert_lit_where(&judged, |p| {
        let from_middle = p - DVec2::new(middle, 0.0);
        // Half the way from 1 in the square is the way in shares of a radius; the shortest radius makes metres of it,
        // or less.
        short * (1.0 - (from_middle / DVec2::new(long, short)).length())
    });
}

#[test]
fn a_lamp_of_some_range_lights_a_disc_of_pythagoras() {
    let judged = judge(&oracle(vec![floor()]), Light { range_m: Some(5.0), ..lamp(0.0, 0.0, 4.0) });
    assert_lit_where(&judged, |p| 3.0 - p.length());
}

/// The floor, as if it were a dome: its normals lean outwards the more, the farther they are from the middle.
fn domed_floor(casts: bool, tilt: f32) -> Vec<Caster> {
    let mut floor = floor();
    floor.role.casts = casts;
    let mut casters = Caster::of_scene(&Scene { objects: vec![floor], ..Scene::default() });
    let normal = |p: Vec3| (Vec3::Z + tilt * p).normalize_or_zero();
    casters[0].shading_normals = vec![casters[0].corners(0).map(normal)];
    casters
}

#[test]
fn a_triangle_that_is_shaded_as_a_dome_is_lit_up_to_where_its_normals_turn_away() {
    // The corners' normals, before they get unit length, are (x, y, 10) / 10, so between them they are the mean of these weighted by
    // their lengths: for a sun over the horizon in the east the lit side ends at a line.
    let casters = domed_floor(true, 0.1);
    let [a, b, c] = casters[0].corners(0).map(Vec3::as_dvec3);
    let normals = casters[0].shading_normals[0].map(Vec3::as_dvec3);
    let to_sun = DVec3::new(1.0, 0.0, 0.02).normalize_or_zero();
    let sun = Light::new("sun", LightPosition::directional(to_sun).unwrap(), Vec3::ONE);
    // The normal is linear over the triangle, and so is its height over the light's horizon.
    let height = |p: DVec2| {
        let p = p.extend(0.0);
        let area = |q: DVec3, r: DVec3, s: DVec3| (r - q).cross(s - q).z;
        let weights = [area(p, b, c), area(a, p, c), area(a, b, p)].map(|part| part / area(a, b, c));
        weights.iter().zip(normals).map(|(weight, normal)| weight * normal.dot(to_sun)).sum::<f64>()
    };
    let judged = judge(&Oracle::new(&casters), sun);
    let (mut lit, mut dark, mut undecided) = (0, 0, 0);
    for (judgement, point) in judged.iter().zip(floor_points()) {
        match judgement.verdict {
            Some(Verdict::Lit) => lit += usize::from(height(point) > 0.0),
            Some(_) => dark += usize::from(height(point) < 0.0),
            None => undecided += usize::from(height(point).abs() < 4e-3),
        }
    }
    assert_eq!(lit + dark + undecided, judged.len());
    assert!(lit > 1_000 && dark > 1_000, "{lit} lit, {dark} dark, {undecided} undecided");
}

#[test]
fn where_only_the_normals_face_the_light_a_triangle_that_casts_is_undecided_and_one_that_does_not_is_lit() {
    let sun = |height| {
        let to_sun = DVec3::new(1.0, 0.0, height);
        Light::new("sun", LightPosition::directional(to_sun).unwrap(), Vec3::ONE)
    };
    // From below the floor, and normals that lean by up to 45 degrees towards it.
    for (casts, expected) in [(true, None), (false, Some(Verdict::Lit))] {
        let mut casters = domed_floor(casts, 0.0);
        casters[0].shading_normals = vec![[Vec3::new(0.6, 0.0, 0.8); 3]];
        let oracle = Oracle::new(&casters);
        assert!(judge(&oracle, sun(-0.3)).iter().all(|j| j.verdict == expected));
        assert!(judge(&oracle, sun(0.3)).iter().all(|j| j.verdict == Some(Verdict::Lit)));
        assert!(judge(&oracle, sun(-0.9)).iter().all(|j| j.verdict == Some(Verdict::Dark)));
    }
}

#[test]
fn a_floor_that_just_touches_the_range_is_undecided_there_and_dark_all_around() {
    // Above the centre of a pixel.
    let foot = EYE + 0.5 * PIXEL_M;
    let judged = judge(&oracle(vec![floor()]), Light { range_m: Some(4.0), ..lamp(foot.x, foot.y, 4.0) });
    for (judgement, point) in judged.iter().zip(floor_points()) {
        let expected = if point.distance(foot) < 0.5 * PIXEL_M { None } else { Some(Verdict::Dark) };
        assert_eq!(judgement.verdict, expected, "at {point}");
    }
}

#[test]
fn on_a_lights_border_a_shaded_pixel_is_dark_all_the_same() {
    let roof = sheet(3.0, 40.0, 0, Role { is_glass: true, ..Role::default() });
    let judged = judge(&oracle(vec![floor(), roof]), Light { range_m: Some(4.0), ..lamp(0.0, 0.0, 4.0) });
    assert!(judged.iter().all(|j| j.verdict == Some(Verdict::Dark)));
}

/// How far inside the shadow on the floor a point is, of a square sheet that reaches 1 m to each side and is half as
/// high as a lamp above its middle: 2 m to each side.
fn in_square_shadow(p: DVec2) -> f64 {
    2.0 - p.abs().max_element()
}

#[test]
fn glass_is_not_seen_and_shades_only_if_it_casts() {
    let clear = Role { casts: false, is_glass: true, ..Role::default() };
    let oracle_of_clear = oracle(vec![floor(), sheet(4.0, 1.0, 0, clear)]);
    assert!(oracle_of_clear.casting.is_none(), "one ray caster is enough");
    let judged = judge(&oracle_of_clear, lamp(0.0, 0.0, 8.0));
    assert!(judged.iter().all(|j| j.verdict == Some(Verdict::Lit)));

    let dark = Role { is_glass: true, ..Role::default() };
    let oracle_of_dark = oracle(vec![floor(), sheet(4.0, 1.0, 0, dark)]);
    assert!(oracle_of_dark.casting.is_some());
    assert_lit_where(&judge(&oracle_of_dark, lamp(0.0, 0.0, 8.0)), |p| -in_square_shadow(p));
}

#[test]
fn what_casts_not_is_seen_and_shades_nothing() {
    let tree = Role { casts: false, ..Role::default() };
    let objects = vec![floor(), sheet(4.0, 1.0, 0, tree)];
    let judged = judge(&oracle(objects), lamp(0.0, 0.0, 8.0));
    let decided = judged.iter().filter(|j| j.verdict.is_some());
    assert!(decided.clone().all(|j| j.verdict == Some(Verdict::Lit)));
    assert!(decided.count() > judged.len() * 98 / 100, "only on the sheet's border nothing can be told");

    // Under a lamp below it, its seen side is turned away.
    let below = judge(&oracle(vec![floor(), sheet(4.0, 1.0, 0, tree)]), lamp(0.0, 0.0, 2.0));
    // 20 m above the floor the eye is 16 m above the sheet.
    assert_lit_where(&below, |p| (EYE + (p - EYE) * 16.0 / 20.0).abs().max_element() - 1.0);
}

/// A checker of `alphas` over the sheet, which is opaque from `cutoff` on.
fn checkered(alphas: [u8; 4], cutoff: f32, alpha: f32, is_nearest: bool) -> (Material, Arc<Texture>) {
    let texture = Texture {
        name: "checker".to_owned(),
        size_px: [2, 2],
        rgba: alphas.iter().flat_map(|&alpha| [9, 9, 9, alpha]).collect(),
        wrap: [Wrap::Clamp; 2],
        is_nearest,
    };
    let alpha_mode = AlphaMode::Mask { cutoff };
    let material = Material { alpha, alpha_mode, base_color_texture: Some(0), ..Material::default() };
    (material, Arc::new(texture))
}

/// A floor, and 10 m above it a sheet of a cut-out material that the camera sees 3.2 m of to each side; as it judges a
/// lamp between the two, far out to the east: what is seen of the sheet is dark, the floor lit.
fn judge_under_cut_out((material, texture): (Material, Arc<Texture>)) -> Vec<Judgement> {
    let objects = vec![floor(), sheet(10.0, 1.6, 1, Role::of_material(&material))];
    let casters = Caster::of_scene(&Scene { objects, ..Scene::default() });
    let oracle = Oracle::with_materials(&casters, &[Material::default(), material], &[texture]);
    judge(&oracle, lamp(30.0, 0.0, 8.0))
}

/// The point of the sheet that is seen in front of a point of the floor, where there is a sheet.
fn in_front_of(p: DVec2) -> DVec2 {
    EYE.midpoint(p)
}

/// How far inside the sheet a point of its plane is.
fn in_sheet(q: DVec2) -> f64 {
    1.6 - q.abs().max_element()
}

#[test]
fn the_eye_sees_through_the_holes_of_a_checker() {
    let judged = judge_under_cut_out(checkered([255, 0, 0, 255], 0.5, 1.0, true));
    // Opaque where x and y have different signs: the first texel is the one in the north-west.
    assert_lit_where(&judged, |p| {
        let q = in_front_of(p);
        let to_middle = q.abs().min_element();
        let in_opaque = if q.x * q.y < 0.0 { to_middle } else { -to_middle };
        -in_opaque.min(in_sheet(q))
    });
}

#[test]
fn a_blended_hole_ends_where_alpha_is_the_cutoff() {
    // From west to east alpha goes from 1 to 0 between the middles of the two texels, at -0.5 and 0.5 of the sheet's
    // half.
    let judged = judge_under_cut_out(checkered([255, 0, 255, 0], 0.25, 1.0, false));
    let end = 1.6 * (-0.5 + 0.75);
    // The border is known to 6/256 of that way: 4 for the weights, 1 on each axis for the place.
    let known = 6.5 / 256.0 * 1.6;
    assert_lit_where(&judged, |p| {
        let q = in_front_of(p);
        let in_opaque = end - q.x;
        let inside = -in_opaque.min(in_sheet(q));
        if in_opaque.abs() < known { inside.signum() * 1e-9 } else { inside }
    });
}

#[test]
fn a_materials_alpha_multiplies_its_textures() {
    let whole = judge_under_cut_out(checkered([255; 4], 0.5, 0.6, false));
    assert_lit_where(&whole, |p| -in_sheet(in_front_of(p)));
    let gone = judge_under_cut_out(checkered([255; 4], 0.5, 0.4, false));
    assert!(gone.iter().all(|j| j.verdict == Some(Verdict::Lit)));
    let on_the_cutoff = judge_under_cut_out(checkered([255; 4], 0.5, 0.5, false));
    let undecided = on_the_cutoff.iter().zip(floor_points()).filter(|(_, p)| in_sheet(in_front_of(*p)) > 0.1);
    assert!(undecided.into_iter().all(|(j, _)| j.verdict.is_none() && j.has_surface));
}

#[test]
fn a_surface_with_holes_casts_as_if_it_had_none() {
    let (material, texture) = checkered([0; 4], 0.5, 1.0, true);
    let objects = vec![floor(), sheet(4.0, 1.0, 1, Role::of_material(&material))];
    let casters = Caster::of_scene(&Scene { objects, ..Scene::default() });
    let oracle = Oracle::with_materials(&casters, &[Material::default(), material], &[texture]);
    assert!(oracle.casting.is_none(), "one ray caster serves eyes and lights");
    assert_lit_where(&judge(&oracle, lamp(0.0, 0.0, 8.0)), |p| -in_square_shadow(p));
}

#[test]
fn what_only_a_triangle_around_the_lamp_is_in_the_way_of_is_undecided() {
    let oracle = oracle(vec![floor(), sheet(4.0, 1.0, 0, Role { is_glass: true, ..Role::default() })]);
    let judged = judge(&oracle, lamp(0.3, 0.2, 4.0));
    assert!(judged.iter().all(|j| j.verdict.is_none()), "the lamp is in the sheet: on which side can't be told");
}

#[test]
fn several_lights_are_judged_as_each_alone() {
    let oracle = oracle(vec![floor(), sheet(4.0, 1.0, 0, Role::default())]);
    let lights = [lamp(0.0, 0.0, 8.0), lamp(3.0, 1.0, 2.0), Light { range_m: Some(9.0), ..lamp(-5.0, 0.0, 6.0) }];
    let together = oracle.judge(&camera(), &lights, || ());
    for (light, judged) in lights.into_iter().zip(together) {
        assert_eq!(judge(&oracle, light), judged);
    }
}

/// The floor, and on it a sheet that ends just where the centres of a column of pixels are.
fn sheet_on_floor(height: f32) -> (Vec<Judgement>, f64) {
    let end = EYE.x + HALF_VIEW_M * (2.0 * (70.5 / f64::from(SIZE_PX[0])) - 1.0);
    let judged = judge(&oracle(vec![floor(), sheet(height, end as f32, 0, Role::default())]), lamp(0.3, 0.2, 8.0));
    (judged, end)
}

#[test]
fn an_edge_that_lies_in_the_surface_behind_it_is_an_edge_all_the_same() {
    let (judged, end) = sheet_on_floor(0.0);
    let (mut on_edge, mut inside) = (0, 0);
    for (judgement, point) in judged.iter().zip(floor_points()) {
        if point.abs().max_element() > end + 0.5 * PIXEL_M {
            assert_eq!(judgement.verdict, Some(Verdict::Lit), "at {point}");
        } else if (point.x - end).abs() < RASTER_PX * PIXEL_M && point.y.abs() < end {
            assert_eq!(judgement.verdict, None, "at {point}");
            on_edge += 1;
        } else {
            // Rounding says which of the two is first: where rays don't agree on that, it is undecided too.
            assert_ne!(judgement.verdict, Some(Verdict::Dark), "at {point}");
            inside += usize::from(judgement.verdict.is_some());
        }
    }
    assert!(on_edge > 40 && inside > 100, "{on_edge} on the edge, {inside} lit within");
}

#[test]
fn which_of_two_sheets_is_in_front_is_undecided_just_where_depth_can_not_tell() {
    // The lower is dark, as the upper shades it. Depths are 20 m; those of the floor, with corners 90 m away, are good to 36 micrometres.
    for (height, in_sheet) in [(1e-6, None), (1e-3, Some(Verdict::Lit))] {
        let (judged, end) = sheet_on_floor(height);
        for (judgement, point) in judged.iter().zip(floor_points()) {
            let inside = end - point.abs().max_element();
            if inside.abs() > PIXEL_M {
                let expected = if inside > 0.0 { in_sheet } else { Some(Verdict::Lit) };
                assert_eq!(judgement.verdict, expected, "at {point}, {height} m");
            }
        }
    }
}
