//! What lights reach, against closed forms.

use crate::level::{Above, Level, SIDE_PX, place};
use glam::{DVec3, Vec3};
use umbrae_core::{Cone, Light, LightPosition};

/// A level floor of 10 m by 10 m, seen from straight above; a pixel is 1 / 12 m.
struct Floor {
    above: Above,
    floor: Level,
}

impl Floor {
    fn new() -> Self {
        Self { above: Above::new(1), floor: Level::plain(Vec3::splat(0.5)) }
    }

    fn mask(&self, light: &Light) -> Vec<u8> {
        self.above.mask(&self.floor, light)
    }

    /// The red of each pixel.
    fn picture(&self, light: &Light) -> Vec<u8> {
        self.above.picture(&self.floor, std::slice::from_ref(light)).iter().map(|pixel| pixel[0]).collect()
    }
}

fn lamp(height_m: f64) -> Light {
    Light::new("lamp", LightPosition::point(DVec3::Z * height_m), Vec3::splat(4.0))
}

/// `is_lit` says what is right, and how far from being otherwise it is, in any unit of which 1e-5 is little.
fn assert_lit_where(mask: &[u8], is_lit: impl Fn(DVec3) -> f64) -> usize {
    for (pixel, &verdict) in mask.iter().enumerate() {
        let clearance = is_lit(place(pixel));
        let expected = if clearance > 0.0 { 255 } else { 0 };
        assert!(verdict == expected || clearance.abs() < 1e-5, "{verdict} at {}: {clearance}", place(pixel));
    }
    mask.iter().filter(|&&verdict| verdict == 255).count()
}

#[test]
fn a_lamp_lights_a_disc_as_wide_as_its_range() {
    let floor = Floor::new();
    let range_m = 4.0;
    let light = Light { range_m: Some(range_m), ..lamp(3.0) };
    let lit = assert_lit_where(&floor.mask(&light), |p| range_m - p.distance(DVec3::Z * 3.0));
    assert!((lit as f64 / 144.0 - std::f64::consts::PI * 7.0).abs() < 0.3, "{lit} pixels");
    let light = Light { range_m: Some(2.9), ..lamp(3.0) };
    assert!(floor.mask(&light).iter().all(|&verdict| verdict == 0), "the floor is out of reach");
}

#[test]
fn a_spot_light_lights_what_is_in_its_outer_angle() {
    let floor = Floor::new();
    let tilted = DVec3::new(0.6, 0.0, -0.8);
    for (axis, outer_rad) in
        [(DVec3::NEG_Z, 0.5), (tilted, 0.7), (tilted, 0.02), (DVec3::X, std::f64::consts::FRAC_PI_2)]
    {
        let cone = Cone { axis, inner_rad: 0.0, outer_rad };
        let light = Light { cone: Some(cone), ..lamp(3.0) };
        let angle = |p: DVec3| (p - DVec3::Z * 3.0).angle_between(axis);
        let lit = assert_lit_where(&floor.mask(&light), |p| outer_rad - angle(p));
        assert!(lit > 0, "{cone:?}");
    }
    let away = Cone { axis: DVec3::Z, inner_rad: 0.0, outer_rad: std::f64::consts::FRAC_PI_2 };
    let light = Light { cone: Some(away), ..lamp(3.0) };
    assert!(floor.mask(&light).iter().all(|&verdict| verdict == 0), "it shines up, and the floor is below");
}

#[test]
fn a_sun_has_neither_range_nor_cone() {
    let floor = Floor::new();
    let towards = LightPosition::directional(DVec3::new(1.0, 0.0, 1.0)).expect("a direction");
    let cone = Cone { axis: DVec3::Z, inner_rad: 0.0, outer_rad: 0.1 };
    let sun = Light { cone: Some(cone), range_m: Some(0.001), ..Light::new("sun", towards, Vec3::ONE) };
    assert!(floor.mask(&sun).iter().all(|&verdict| verdict == 255));
}

/// Straight under the lamp, a light with a range or a cone gives what one without gives at a known share of the strength.
#[test]
fn range_and_cone_take_away_what_gltf_says() {
    let floor = Floor::new();
    let middle = SIDE_PX * SIDE_PX / 2 + SIDE_PX / 2;
    let from_lamp = place(middle) - DVec3::Z * 2.0;
    let share_of = |light: &Light, share: f64| {
        let weaker = Light { strength: light.strength * share as f32, cone: None, range_m: None, ..light.clone() };
        let [given, expected] = [light, &weaker].map(|light| floor.picture(light)[middle]);
        assert!(given.abs_diff(expected) <= 1, "{given} for {expected}, a share of {share}: {light:?}");
    };
    let range_m = 2.5;
    share_of(&Light { range_m: Some(range_m), ..lamp(2.0) }, 1.0 - (from_lamp.length() / range_m).powi(4));
    for axis in [DVec3::new(0.6, 0.0, -0.8), DVec3::new(0.2, 0.1, -1.0).try_normalize().expect("a direction")] {
        let cone = Cone { axis, inner_rad: 0.4, outer_rad: 0.8 };
        let [cos, inner, outer] = [from_lamp.angle_between(axis), 0.4, 0.8].map(f64::cos);
        let ramp = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0);
        share_of(&Light { cone: Some(cone), ..lamp(2.0) }, ramp * ramp);
    }
}
