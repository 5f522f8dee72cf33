//! How large lights are, for soft shadows: the sun as it is seen, lamps as the user says.

use std::f64::consts::FRAC_PI_2;

use anyhow::{Context as _, ensure};
use glam::DVec3;
use umbrae_core::{Bounds, Cone, Extent, Light, SUN_DIAMETER_RAD};

use crate::lights::LampChoice;

/// What a lamp is to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ExtentChoice {
    /// A ball of this radius.
    Radius(f64),
    /// A rectangle, so wide and so high.
    Size([f64; 2]),
}

/// Within this angle from where it faces a rectangle that was a point all around gives its full strength; from there it fades to nothing in its plane.
const FULL_STRENGTH_RAD: f64 = 60.0 / 180.0 * std::f64::consts::PI;

/// A lamp is in the model's middle if it is not farther from that than this part of the model's size and of its own distance from the origin: `f32` keeps a
/// tenth of that.
const IN_THE_MIDDLE: f64 = 1e-6;

/// `lights` with their sizes: of each lamp its own, else that of `all`; with `sun_disc`, of each directional light the sun's. `lamps` are those that `lights`
/// were made of, or none if they are the model's own.
///
/// A rectangle faces the middle of `model`; that of a spot, where the spot does.
///
/// # Errors
///
/// When a lamp would be so large that all of the model could be in it, or a rectangle has nothing to face.
pub fn with_extents(
    lights: Vec<Light>,
    lamps: &[LampChoice],
    all: Option<ExtentChoice>,
    sun_disc: bool,
    model: &Bounds,
) -> anyhow::Result<Vec<Light>> {
    let own = |i: usize| lamps.get(i).and_then(|lamp| lamp.extent);
    let with_extent = |(i, light): (usize, Light)| {
        if light.position.is_directional() {
            let extent = Extent::Disc { radius_rad: 0.5 * SUN_DIAMETER_RAD };
            return Ok(if sun_disc { Light { extent, ..light }.rounded_to_f32() } else { light });
        }
        own(i).or(all).map_or(Ok(light.clone()), |choice| lamp_with_extent(light, choice, model))
    };
    lights.into_iter().enumerate().map(with_extent).collect()
}

fn lamp_with_extent(light: Light, choice: ExtentChoice, model: &Bounds) -> anyhow::Result<Light> {
    let position = light.position.homogeneous().truncate();
    let to_middle = model.center() - position;
    let farthest_m = (model.min - position).abs().max((model.max - position).abs()).length();
    let fits = |what: &str, radius_m: f64| {
        ensure!(
            radius_m < farthest_m,
            "a {what} is too large for `{}`: all of the model, {farthest_m:.3} m away at the farthest, would be in it; give less",
            light.name
        );
        Ok(())
    };
    let light = match choice {
        ExtentChoice::Radius(radius_m) => {
            fits(&format!("ball of {radius_m} m"), radius_m)?;
            Light { extent: Extent::Sphere { radius_m }, ..light }
        }
        ExtentChoice::Size([width, height]) => {
            fits(&format!("rectangle of {width} by {height} m"), 0.5 * width.hypot(height))?;
            // What is nearer is there but for rounding.
            let least_m = IN_THE_MIDDLE * (position.abs().max_element() + model.size().length());
            let to_middle = if to_middle.length() > least_m { to_middle } else { DVec3::ZERO };
            let facing = light.cone.map_or(to_middle, |cone| cone.axis).try_normalize().with_context(|| {
                format!(
                    "a rectangle at `{}`, in the model's middle, faces nothing; a spot says where it faces (--spot)",
                    light.name
                )
            })?;
            let level = DVec3::Z.cross(facing).try_normalize().unwrap_or(DVec3::X);
            let (half_right, half_up) = (level * (0.5 * width), facing.cross(level) * (0.5 * height));
            let around = Cone { axis: facing, inner_rad: FULL_STRENGTH_RAD, outer_rad: FRAC_PI_2 };
            let cone = Some(light.cone.unwrap_or(around));
            Light { extent: Extent::Rectangle { half_right, half_up }, cone, ..light }
        }
    };
    Ok(light.rounded_to_f32())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use umbrae_core::LightPosition;

    use super::*;

    const MODEL: Bounds = Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };

    fn lamp() -> Light {
        Light::new("point 1", LightPosition::point(DVec3::new(0.0, -3.0, 4.0)), Vec3::ONE)
    }

    fn of(light: Light, choice: ExtentChoice) -> anyhow::Result<Light> {
        Ok(with_extents(vec![light], &[], Some(choice), false, &MODEL)?.remove(0))
    }

    #[test]
    fn a_rectangle_faces_the_model_with_its_width_level() {
        let light = of(lamp(), ExtentChoice::Size([2.0, 1.0])).expect("it is small enough");
        let Extent::Rectangle { half_right, half_up } = light.extent else { panic!("{:?}", light.extent) };
        assert!(half_right.z.abs() < 1e-6 && (half_right.length() - 1.0).abs() < 1e-6, "{half_right}");
        assert!((half_up.length() - 0.5).abs() < 1e-6 && half_right.dot(half_up).abs() < 1e-6, "{half_up}");
        let front = half_right.cross(half_up).normalize_or_zero();
        assert!(front.distance(DVec3::new(0.0, 0.6, -0.8)) < 1e-6, "{front}");
        assert!(light.cone.is_some_and(|cone| cone.axis.distance(front) < 1e-6), "its back gives no light");
    }

    #[test]
    fn a_spot_s_rectangle_faces_where_the_spot_does_and_keeps_its_cone() {
        let cone = Some(Cone { axis: DVec3::NEG_Z, inner_rad: 0.1, outer_rad: 0.2 });
        let light = of(Light { cone, ..lamp() }, ExtentChoice::Size([1.0, 1.0])).expect("it is small enough");
        let Extent::Rectangle { half_right, half_up } = light.extent else { panic!("{:?}", light.extent) };
        assert!(half_right.cross(half_up).normalize_or_zero().distance(DVec3::NEG_Z) < 1e-6);
        assert!(light.cone.is_some_and(|cone| cone.outer_rad < 0.21));
    }

    #[test]
    fn in_the_model_s_middle_a_ball_is_welcome_and_a_rectangle_must_face_somewhere() {
        let lamp = Light { position: LightPosition::point(DVec3::ZERO), ..lamp() };
        assert!(of(lamp.clone(), ExtentChoice::Radius(0.1)).is_ok());
        let error = of(lamp.clone(), ExtentChoice::Size([0.2, 0.1])).expect_err("it has no direction").to_string();
        assert!(error.contains("faces nothing"), "{error}");
        let cone = Some(Cone { axis: DVec3::NEG_Z, inner_rad: 0.1, outer_rad: 0.2 });
        assert!(of(Light { cone, ..lamp.clone() }, ExtentChoice::Size([0.2, 0.1])).is_ok());
        // As `f32` has them, neither is where it was said to be.
        let [min, max, middle] = [0.1, 0.3, 0.2].map(|x| DVec3::new(x, x, 10.0 * x).as_vec3().as_dvec3());
        let lamp = Light { position: LightPosition::point(middle), ..lamp };
        let size = Some(ExtentChoice::Size([0.02, 0.01]));
        let error = with_extents(vec![lamp], &[], size, false, &Bounds { min, max }).expect_err("it has no direction");
        assert!(error.to_string().contains("faces nothing"), "{error}");
    }

    #[test]
    fn a_lamp_that_could_hold_all_of_the_model_is_refused_and_the_sun_is_no_lamp() {
        let error =
            of(lamp(), ExtentChoice::Radius(6.5)).expect_err("it is larger than the way to every corner").to_string();
        assert!(error.contains("point 1") && error.contains("6.481 m"), "{error}");
        assert!(of(lamp(), ExtentChoice::Radius(6.4)).is_ok());
        assert!(of(lamp(), ExtentChoice::Size([12.0, 8.0])).is_err());
        let sun = Light::new("sun", LightPosition::sun(1.0, 1.0), Vec3::ONE);
        assert_eq!(of(sun.clone(), ExtentChoice::Radius(5.0)).expect("it has no radius").extent, Extent::Point);
        let disc = with_extents(vec![sun], &[], None, true, &MODEL).expect("it has one").remove(0).extent;
        assert!(matches!(disc, Extent::Disc { radius_rad } if (radius_rad.to_degrees() - 0.2665).abs() < 1e-6));
    }
}
