//! What is called out of view, out of reach or unable to shade anything is so, for random cameras, lights and boxes; and it is called so
//! nearly as often as it is.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use umbrae_core::{Bounds, Camera, Cone, Culler, Light, LightPosition, PixelRect, Reach};

const SETTINGS: u32 = 4_000;
/// Points tried in each box, and distances behind each of them.
const SAMPLES: usize = 100;
const DISTANCES: [f64; 16] = [0.0, 0.03, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0, 300.0, 1e5];

#[derive(Debug, Clone)]
struct Setting {
    camera: Camera,
    light: Light,
    caster: Bounds,
    scene: Bounds,
    samples: Vec<DVec3>,
}

fn xyz(size: f64) -> impl Strategy<Value = DVec3> {
    [-size..size, -size..size, -size..size].prop_map(DVec3::from)
}

fn setting() -> impl Strategy<Value = Setting> {
    let camera = (xyz(10.0), xyz(10.0), 0.1..2.6_f64, -3.0..0.5_f64, [16..400_u32, 16..400_u32])
        .prop_filter_map("eye at target", |(eye, target, fov, near, size)| {
            Camera::new(eye, target, fov, 10_f64.powf(near), size).ok()
        });
    let position = prop_oneof![
        3 => xyz(12.0).prop_map(LightPosition::point),
        1 => xyz(1.0).prop_filter_map("no direction", LightPosition::directional),
    ];
    let angle = prop_oneof![0.01..FRAC_PI_2, Just(FRAC_PI_2)];
    let cone = prop::option::of((xyz(1.0), angle));
    let size = prop_oneof![Just(0.0), 0.01..1.0_f64, 1.0..8.0_f64];
    let sizes = (size.clone(), size.clone(), size);
    // Sometimes the light is at the eye, in the near plane, or in a side of the view, where planes through it are hard to find.
    let trick = 0..12_u8;
    (
        camera,
        position,
        cone,
        prop::option::of(0.1..20.0_f64),
        xyz(10.0),
        sizes,
        trick,
        prop::collection::vec(xyz(1.0), SAMPLES),
    )
        .prop_map(|(camera, mut position, cone, range_m, corner, (x, y, z), trick, samples)| {
            let [top_left, top_right, ..] = camera.near_rectangle();
            match trick {
                0 => position = LightPosition::point(camera.eye()),
                1 => position = LightPosition::point(top_left * 3.0 - top_right * 2.0),
                2 => position = LightPosition::point(camera.eye() + (top_left + top_right - 2.0 * camera.eye()) * 7.0),
                3 => position = LightPosition::point(camera.eye() + (top_left - camera.eye()) * 9.0),
                _ => {}
            }
            let mut light = Light::new("", position, Vec3::ONE);
            light.range_m = range_m;
            light.cone = cone
                .and_then(|(axis, outer_rad)| Some(Cone { axis: axis.try_normalize()?, inner_rad: 0.0, outer_rad }));
            let caster = Bounds { min: corner, max: corner + DVec3::new(x, y, z) };
            let scene = caster.union(Bounds { min: DVec3::splat(-10.0), max: DVec3::splat(10.0) });
            Setting { camera, light, caster, scene, samples }
        })
}

/// Runs `check` on as many settings; the same ones every time.
fn for_each_setting(check: impl Fn(&Setting) -> Result<(), TestCaseError>) {
    let config = Config { cases: SETTINGS, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[3; 32]);
    TestRunner::new_with_rng(config, rng)
        .run(&setting(), |setting| check(&setting))
        .expect("it holds in every setting");
}

impl Setting {
    fn culler(&self) -> Culler {
        Culler::new(&self.camera, &self.light, &self.scene)
    }

    /// The pixel, fractional, where the point is seen.
    fn pixel_of(&self, point: DVec3) -> Option<[f64; 2]> {
        self.pixel_of_clip(self.camera.clip_from_world() * point.extend(1.0), self.camera.near())
    }

    fn pixel_of_direction(&self, direction: DVec3) -> Option<[f64; 2]> {
        self.pixel_of_clip(self.camera.clip_from_world() * direction.extend(0.0), 1e-9)
    }

    fn pixel_of_clip(&self, clip: glam::DVec4, near: f64) -> Option<[f64; 2]> {
        let is_seen = clip.w >= near && clip.x.abs() < clip.w && clip.y.abs() < clip.w;
        let [width, height] = self.camera.size_px().map(f64::from);
        is_seen.then(|| [0.5 * (clip.x / clip.w + 1.0) * width, 0.5 * (1.0 - clip.y / clip.w) * height])
    }

    /// Points of the box; corners first.
    fn points_of_caster(&self) -> impl Iterator<Item = DVec3> + '_ {
        let inner = self.samples.iter().map(|s| self.caster.center() + 0.5 * s * self.caster.size());
        self.caster.corners().into_iter().chain(inner)
    }

    /// Points of the box and behind it.
    fn points_of_volume(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.points_of_caster()
            .flat_map(move |p| DISTANCES.into_iter().map(move |s| p - s * self.light.position.offset_from(p)))
    }

    /// Points that the light lights: all those in view, as far as samples go.
    fn points_of_light(&self) -> impl Iterator<Item = DVec3> + '_ {
        let center = self.light.position.homogeneous().truncate();
        let range = self.light.range_m.unwrap_or(30.0);
        let along_rays = self.samples.iter().flat_map(move |s| {
            let [width, height] = self.camera.size_px().map(f64::from);
            let ray = self.camera.ray_direction((s.x + 1.0) / 2.0 * width, (s.y + 1.0) / 2.0 * height);
            (0..12).map(move |i| self.camera.eye() + ray * (self.camera.near() + f64::from(i) * (1.0 + s.z) * 0.4))
        });
        let in_range = self.samples.iter().flat_map(move |s| {
            let direction = self.light.cone.map_or(*s, |cone| {
                let across = (*s - cone.axis * cone.axis.dot(*s)).normalize_or_zero();
                let from_axis = cone.outer_rad * s.x.abs().sqrt();
                cone.axis * from_axis.cos() + across * from_axis.sin()
            });
            (1..=8).map(move |i| center + range * f64::from(i) / 8.001 * direction.normalize_or_zero())
        });
        along_rays.chain(in_range).filter(|&p| self.is_lit(p))
    }

    fn is_lit(&self, point: DVec3) -> bool {
        if self.light.position.is_directional() {
            return true;
        }
        let from_light = -self.light.position.offset_from(point);
        let is_near = self.light.range_m.is_none_or(|range| from_light.length() <= range);
        is_near && self.light.cone.is_none_or(|cone| from_light.angle_between(cone.axis) <= cone.outer_rad)
    }
}

fn holds(rect: Option<PixelRect>, [x, y]: [f64; 2]) -> bool {
    rect.is_some_and(|rect| rect.contains([x as u32, y as u32]))
}

#[test]
fn a_box_that_shades_something_in_view_is_never_culled() {
    let counts = std::cell::Cell::new([0; 4]);
    for_each_setting(|setting| {
        let culler = setting.culler();
        let may = culler.may_shade_view(&setting.caster);
        let rect = culler.shadow_rect(&setting.caster);
        let mut seen = setting.points_of_volume().filter_map(|p| setting.pixel_of(p));
        let does = seen.next().is_some();
        prop_assert!(may || !does, "culled, though it shades the view");
        prop_assert!(rect.is_some() || !does, "no rectangle, though it shades the view");
        let mut n = counts.get();
        n[0] += usize::from(does);
        n[1] += usize::from(!does);
        n[2] += usize::from(!does && may);
        n[3] += usize::from(!does && rect.is_some());
        counts.set(n);
        Ok(())
    });
    let [does, does_not, may, has_rect] = counts.get();
    println!(
        "{does} shade the view, {does_not} don't as far as samples tell; of those {may} may by planes, {has_rect} by rectangle"
    );
    assert!(does > 1_000 && does_not > 1_000);
    assert!(may * 10 < does_not && has_rect * 10 < does_not, "{may} and {has_rect} of {does_not} are not culled");
}

#[test]
fn what_shows_of_a_volume_is_in_its_rectangle() {
    let counts = std::cell::Cell::new([0_u64; 3]);
    for_each_setting(|setting| {
        let rect = setting.culler().shadow_rect(&setting.caster);
        let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for pixel in setting.points_of_volume().filter_map(|p| setting.pixel_of(p)) {
            prop_assert!(holds(rect, pixel), "{pixel:?} is not in {rect:?}");
            for i in 0..2 {
                min[i] = min[i].min(pixel[i].floor());
                max[i] = max[i].max(pixel[i].floor() + 1.0);
            }
        }
        if let Some(rect) = rect {
            let sampled = ((max[0] - min[0]).max(0.0) * (max[1] - min[1]).max(0.0)) as u64;
            let [width, height] = setting.camera.size_px().map(u64::from);
            let n = counts.get();
            counts.set([n[0] + sampled, n[1] + rect.area(), n[2] + width * height]);
        }
        Ok(())
    });
    let [sampled, area, whole] = counts.get();
    println!("rectangles of volumes: {area} pixels, the samples' own {sampled}, the pictures {whole}");
    assert!(area as f64 <= 1.3 * sampled as f64);
}

#[test]
fn what_shows_of_a_lights_reach_is_in_its_rectangle() {
    let counts = std::cell::Cell::new([0_u64; 5]);
    for_each_setting(|setting| {
        let culler = setting.culler();
        let rect = culler.light_rect();
        let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for pixel in setting.points_of_light().filter_map(|p| setting.pixel_of(p)) {
            prop_assert!(culler.light_may_show(), "the light reaches the view");
            prop_assert!(holds(rect, pixel), "{pixel:?} is not in {rect:?}");
            for i in 0..2 {
                min[i] = min[i].min(pixel[i].floor());
                max[i] = max[i].max(pixel[i].floor() + 1.0);
            }
        }
        let mut n = counts.get();
        if Reach::of(&setting.light).is_some() {
            let is_seen = max[0] > min[0];
            n[3] += u64::from(!is_seen);
            n[4] += u64::from(!is_seen && culler.light_may_show());
            if let (Some(rect), true) = (rect, is_seen) {
                let [width, height] = setting.camera.size_px().map(u64::from);
                n[0] += ((max[0] - min[0]) * (max[1] - min[1])) as u64;
                n[1] += rect.area();
                n[2] += width * height;
            }
        }
        counts.set(n);
        Ok(())
    });
    let [sampled, area, whole, unseen, kept] = counts.get();
    println!(
        "rectangles of lights: {area} pixels, the samples' own {sampled}, the pictures {whole}; {kept} of {unseen} unseen ones kept"
    );
    assert!(area as f64 <= 1.2 * sampled as f64);
    assert!(kept * 5 < unseen);
}

#[test]
fn a_box_that_takes_light_away_is_reached() {
    for_each_setting(|setting| {
        let culler = setting.culler();
        let does = setting.points_of_caster().any(|p| setting.is_lit(p));
        prop_assert!(culler.is_reached(&setting.caster) || !does);
        Ok(())
    });
}

#[test]
fn caps_in_view_are_never_left_out() {
    let counts = std::cell::Cell::new([0; 6]);
    for_each_setting(|setting| {
        let culler = setting.culler();
        let is_light_cap_seen = setting.points_of_caster().any(|p| setting.pixel_of(p).is_some());
        let may_light_cap = culler.light_cap_may_show(&setting.caster);
        prop_assert!(may_light_cap || !is_light_cap_seen);
        let is_directional = setting.light.position.is_directional();
        let may_dark_cap = culler.dark_cap_may_show(&setting.caster);
        prop_assert!(!(is_directional && may_dark_cap), "there is none");
        let far = |p: DVec3| setting.pixel_of_direction(-setting.light.position.offset_from(p));
        let is_dark_cap_seen = !is_directional && setting.points_of_caster().any(|p| far(p).is_some());
        prop_assert!(may_dark_cap || !is_dark_cap_seen);
        let mut n = counts.get();
        for (i, (is_seen, may)) in
            [(is_light_cap_seen, may_light_cap), (is_dark_cap_seen, may_dark_cap)].into_iter().enumerate()
        {
            n[3 * i] += usize::from(is_seen);
            n[3 * i + 1] += usize::from(!is_seen);
            n[3 * i + 2] += usize::from(!is_seen && may);
        }
        counts.set(n);
        Ok(())
    });
    let [light, no_light, kept_light, dark, no_dark, kept_dark] = counts.get();
    println!(
        "light caps: {light} seen, {kept_light} of {no_light} others kept; dark caps: {dark} seen, {kept_dark} of {no_dark} others kept"
    );
    assert!(light.min(dark) > 400 && kept_light * 10 < no_light && kept_dark * 10 < no_dark);
}

#[test]
fn a_caster_behind_the_lamp_and_out_of_view_is_culled() {
    let camera = Camera::new(DVec3::ZERO, DVec3::Y, 1.0, 0.1, [100, 100]).expect("a good camera");
    // Above the view, which looks along y: only what is in front of and below it can shade the view.
    let lamp = Light::new("", LightPosition::point(DVec3::new(0.0, 5.0, 20.0)), Vec3::ONE);
    let everything = Bounds { min: DVec3::splat(-50.0), max: DVec3::splat(50.0) };
    let culler = Culler::new(&camera, &lamp, &everything);
    let cube = |at: DVec3| Bounds { min: at - 0.5, max: at + 0.5 };
    assert!(!culler.may_shade_view(&cube(DVec3::new(0.0, 5.0, 30.0))), "above the lamp");
    assert!(culler.may_shade_view(&cube(DVec3::new(0.0, 5.0, 10.0))), "between the lamp and the view");
    assert!(!culler.may_shade_view(&cube(DVec3::new(0.0, -5.0, 10.0))), "its shadow falls behind the eye");
    // The side of the hull that is parallel to the view's own: light that leaves the lamp less steeply than the view's upper side
    // never gets into view.
    assert!(!culler.may_shade_view(&cube(DVec3::new(0.0, 45.0, 45.0))));
    assert!(culler.may_shade_view(&cube(DVec3::new(0.0, 45.0, 35.0))));
}

#[test]
fn the_rectangle_of_a_lamp_around_the_eye_is_the_picture() {
    let camera = Camera::new(DVec3::ZERO, DVec3::Y, 1.0, 0.1, [64, 48]).expect("a good camera");
    let mut lamp = Light::new("", LightPosition::point(DVec3::new(0.3, 0.2, 0.1)), Vec3::ONE);
    lamp.range_m = Some(4.0);
    let culler = Culler::new(&camera, &lamp, &Bounds::EMPTY);
    assert_eq!(culler.light_rect(), PixelRect::whole([64, 48]));
}

#[test]
fn a_small_box_before_the_lamp_fills_its_own_rectangle_only() {
    // The lamp is at the eye, so a shadow is seen just where its caster is.
    let camera = Camera::new(DVec3::ZERO, DVec3::Y, FRAC_PI_2, 0.1, [100, 100]).expect("a good camera");
    let lamp = Light::new("", LightPosition::point(DVec3::ZERO), Vec3::ONE);
    let caster = Bounds { min: DVec3::new(-1.0, 10.0, 2.0), max: DVec3::new(1.0, 12.0, 4.0) };
    let rect = Culler::new(&camera, &lamp, &caster).shadow_rect(&caster).expect("it is in view");
    // At depth 10, 0.2 m are a pixel; at depth 12, 0.24 m.
    assert_eq!(rect, PixelRect { min: [44, 29], max: [56, 42] });
}
