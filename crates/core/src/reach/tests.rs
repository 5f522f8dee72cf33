use proptest::prelude::*;

use super::*;
use crate::{Cone, LightPosition};

fn lamp(outer_rad: Option<f64>, range_m: Option<f64>) -> Light {
    let mut light = Light::new("", LightPosition::point(DVec3::new(3.0, -2.0, 7.0)), Vec3::ONE);
    light.cone = outer_rad.map(|outer_rad| Cone { axis: DVec3::new(0.6, 0.0, -0.8), inner_rad: 0.0, outer_rad });
    light.range_m = range_m;
    light
}

/// Lamps of every kind, with what they are.
fn lamps() -> Vec<Light> {
    let angles = [None, Some(1e-3), Some(0.3), Some(0.7), Some(1.2), Some(1.55), Some(FRAC_PI_2)];
    let ranges = [None, Some(5.0), Some(200.0)];
    angles
        .into_iter()
        .flat_map(|a| ranges.map(|r| lamp(a, r)))
        .filter(|l| l.cone.is_some() || l.range_m.is_some())
        .collect()
}

/// Six times the volume of a body without corners at infinity.
fn volume(reach: &Reach) -> f64 {
    reach.faces().iter().map(|f| f.map(DVec4::truncate)).map(|[a, b, c]| a.dot(b.cross(c))).sum::<f64>() / 6.0
}

#[test]
fn the_surface_is_closed_to_the_last_bit() {
    for light in lamps() {
        let reach = Reach::of(&light).expect("it ends somewhere");
        let bits = |p: DVec4| p.as_vec4().to_array().map(f32::to_bits);
        let mut edges: Vec<_> = Vec::new();
        for &[a, b, c] in reach.faces() {
            edges.extend([(a, b), (b, c), (c, a)].map(|(from, to)| (bits(from), bits(to))));
        }
        edges.sort_unstable();
        let mut reversed: Vec<_> = edges.iter().map(|&(from, to)| (to, from)).collect();
        reversed.sort_unstable();
        assert_eq!(edges, reversed, "{light:?}");
        edges.dedup();
        assert_eq!(edges.len(), reach.faces().len() * 3, "every edge once each way: {light:?}");
        assert_eq!(reach.corners().len() + reach.faces().len() - edges.len() / 2, 2, "Euler: {light:?}");
    }
}

#[test]
fn every_corner_is_in_the_region_and_faces_show_their_fronts_outwards() {
    for light in lamps() {
        let reach = Reach::of(&light).expect("it ends somewhere");
        let center = light.position.homogeneous();
        assert!(reach.region().contains(center), "{light:?}");
        for corner in reach.corners() {
            let scale = corner.truncate().length() + center.length();
            assert!(reach.region().planes().iter().all(|p| p.dot(*corner) > -1e-9 * scale), "{light:?} {corner}");
        }
        for [a, b, c] in reach.faces() {
            let height = glam::DMat4::from_cols(*a, *b, *c, center).determinant();
            assert!(height > 0.0, "{light:?}: {height}");
        }
    }
}

#[test]
fn the_ball_has_7_percent_more_volume_than_the_sphere() {
    let reach = Reach::of(&lamp(None, Some(100.0))).expect("a range");
    let ratio = volume(&reach) / (4.0 / 3.0 * PI * 1e6);
    println!("ball: {} triangles, {ratio:.4} of the sphere", reach.faces().len());
    assert!((1.05..1.08).contains(&ratio), "{ratio}");
}

#[test]
fn a_cone_with_a_range_is_at_most_a_third_larger_than_what_it_lights() {
    for degrees in [10.0_f64, 20.0, 30.0, 45.0, 60.0, 75.0, 90.0] {
        let reach = Reach::of(&lamp(Some(degrees.to_radians()), Some(100.0))).expect("a range");
        let ratio = volume(&reach) / (TAU / 3.0 * (1.0 - degrees.to_radians().cos()) * 1e6);
        println!("{degrees} degrees: {} triangles, {ratio:.3} of the sector", reach.faces().len());
        assert!((1.0..1.34).contains(&ratio), "{degrees}: {ratio}");
    }
}

#[test]
fn a_sun_and_a_bare_lamp_reach_everywhere() {
    let mut sun = Light::new("", LightPosition::sun(1.0, 0.5), Vec3::ONE);
    sun.range_m = Some(3.0);
    assert!(Reach::of(&sun).is_none());
    assert!(Reach::of(&lamp(None, None)).is_none());
    assert!(Reach::of(&lamp(None, Some(f64::INFINITY))).is_none());
    assert!(Reach::of(&lamp(Some(2.0), None)).is_none(), "no cone is wider than a half-space");
}

proptest! {
    #[test]
    fn what_a_lamp_lights_is_in_its_reach(
        angle in prop::option::of(1e-3..FRAC_PI_2), range in prop::option::of(0.0..1e3_f64),
        direction in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], axis in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
        toward_rim in 0.0..1.0_f64, along in 0.0..=1.0_f64,
    ) {
        let Some(axis) = DVec3::from(axis).try_normalize() else { return Ok(()) };
        let mut light = lamp(angle, range);
        if let Some(cone) = &mut light.cone {
            cone.axis = axis;
        }
        let Some(reach) = Reach::of(&light) else { return Ok(()) };
        let center = light.position.homogeneous().truncate();
        let across = (DVec3::from(direction) - axis * axis.dot(DVec3::from(direction))).normalize_or_zero();
        let from_axis = toward_rim.sqrt() * angle.unwrap_or(PI);
        let ray = axis * from_axis.cos() + across * from_axis.sin();
        let point = center + ray * (along * range.unwrap_or(1e4));
        prop_assert!(reach.region().contains(point.extend(1.0)), "{light:?} {point}");
        let speck = Bounds::of_points([point]);
        prop_assert!(reach.may_meet_box(&speck));
        if range.is_none() {
            prop_assert!(reach.region().contains(ray.extend(0.0)), "{light:?} towards {ray}");
        }
    }
}
