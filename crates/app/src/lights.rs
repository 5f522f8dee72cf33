//! The lights of a picture: the user's, else the model's, else an afternoon sun; and how far they reach.

use glam::{DVec3, Vec3};
use umbrae_core::{Bounds, Cone, Light, LightPosition, Scene};

use crate::extent::ExtentChoice;
use crate::parse::SpotPlace;

/// A lamp that the user wants, in the model's coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LampChoice {
    /// What it is, and where.
    pub place: LampPlace,
    /// Linear, each channel 0 to 1; a warm white for `None`.
    pub color: Option<Vec3>,
    /// In candela, or in lux for the sun; as much as suits the model for `None`.
    pub intensity: Option<f32>,
    /// See [`Light::range_m`]; nothing for the sun.
    pub range_m: Option<f64>,
    /// Of a spot: where its edge begins.
    pub inner_deg: Option<f64>,
    /// Of a lamp: how large it is; see [`crate::extent`].
    pub extent: Option<ExtentChoice>,
}

/// What a lamp is, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LampPlace {
    /// The sun.
    Sun {
        /// Clockwise from north.
        azimuth_deg: f64,
        /// Above the horizon.
        altitude_deg: f64,
    },
    /// Shines all around.
    Point(DVec3),
    /// Shines into a cone.
    Spot(SpotPlace),
}

impl LampChoice {
    /// A lamp about which nothing else was said.
    pub fn new(place: LampPlace) -> Self {
        Self { place, color: None, intensity: None, range_m: None, inner_deg: None, extent: None }
    }
}

/// The afternoon sun of a picture without lights: from the south-west, so that the shadows of a model that faces south fall back and to the right.
pub(crate) const DEFAULT_SUN_DEG: [f64; 2] = [238.0, 40.0];
/// Irradiance of the sun against that of anything else; only ratios are seen.
const SUN_STRENGTH: Vec3 = Vec3::new(3.2, 3.05, 2.8);
/// A lamp gives this irradiance at the model's middle, or where its bounding sphere would be if it is nearer…
const LAMP_STRENGTH: Vec3 = Vec3::new(3.1, 2.95, 2.7);
/// …or at this share of its range if that is nearer still: there it has faded by a sixteenth.
const RANGE_SHARE: f64 = 0.5;
/// Where the edge of a spot's cone begins, as a share of its angle.
const INNER_SHARE: f64 = 0.8;
/// A range is divided by, and a black light would have none.
const LEAST_RANGE_M: f64 = 1e-6;

/// The lights: the user's, else the model's, else an afternoon sun. `model` holds the model, which is in `scene`.
///
/// Some reach without end; see [`reaching`].
pub fn lights(lamps: &[LampChoice], scene: &Scene, model: &Bounds) -> Vec<Light> {
    let (mut points, mut spots) = (0, 0);
    let named = lamps.iter().map(|lamp| {
        let name = match lamp.place {
            LampPlace::Sun { .. } => "sun".to_owned(),
            LampPlace::Point(_) => numbered("point", &mut points),
            LampPlace::Spot(_) => numbered("spot", &mut spots),
        };
        light(lamp, name, scene.origin, model)
    });
    let mut lights: Vec<Light> = named.collect();
    if lights.is_empty() {
        lights.clone_from(&scene.lights);
    }
    if lights.is_empty() {
        let [azimuth_deg, altitude_deg] = DEFAULT_SUN_DEG;
        let sun = LampChoice::new(LampPlace::Sun { azimuth_deg, altitude_deg });
        lights.push(light(&sun, "sun".to_owned(), scene.origin, model));
    }
    // What draws and what verifies must mean the same light.
    lights.iter().map(Light::rounded_to_f32).collect()
}

/// The same lights with an end: a lamp without a range gets the distance at which it falls below what a display shows under
/// `exposure`, so that what is further away need not be looked at.
///
/// Source: M. McGuire et al., "Fast, practical and robust shadows", 2003, section 4.
pub fn reaching(lights: Vec<Light>, exposure: f32) -> Vec<Light> {
    let with_end = |light: Light| {
        if light.position.is_directional() || light.range_m.is_some() {
            return light;
        }
        let range_m = light.visible_range_m(exposure).max(LEAST_RANGE_M);
        Light { range_m: Some(range_m), ..light }.rounded_to_f32()
    };
    lights.into_iter().map(with_end).collect()
}

fn numbered(kind: &str, count: &mut usize) -> String {
    *count += 1;
    format!("{kind} {count}")
}

fn light(lamp: &LampChoice, name: String, origin: DVec3, model: &Bounds) -> Light {
    let (position, usual, cone) = match lamp.place {
        LampPlace::Sun { azimuth_deg, altitude_deg } => {
            (LightPosition::sun(azimuth_deg.to_radians(), altitude_deg.to_radians()), SUN_STRENGTH, None)
        }
        LampPlace::Point(point) => {
            let point = point - origin;
            (LightPosition::point(point), lamp_strength(point, lamp.range_m, model), None)
        }
        LampPlace::Spot(SpotPlace { position, axis, outer_deg }) => {
            let point = position - origin;
            let inner_deg = lamp.inner_deg.unwrap_or(INNER_SHARE * outer_deg);
            let cone = Cone { axis, inner_rad: inner_deg.to_radians(), outer_rad: outer_deg.to_radians() };
            (LightPosition::point(point), lamp_strength(point, lamp.range_m, model), Some(cone))
        }
    };
    let usual_intensity = usual.max_element();
    let color = lamp.color.unwrap_or(usual / usual_intensity);
    let strength = color * lamp.intensity.unwrap_or(usual_intensity);
    Light { cone, range_m: lamp.range_m, ..Light::new(name, position, strength) }
}

/// What suits a lamp at `position` that has no intensity.
fn lamp_strength(position: DVec3, range_m: Option<f64>, model: &Bounds) -> Vec3 {
    let radius = if model.radius() > 0.0 { model.radius() } else { 1.0 };
    let distance = position.distance(model.center()).max(radius);
    let distance = distance.min(range_m.map_or(f64::INFINITY, |range| range * RANGE_SHARE));
    LAMP_STRENGTH * (distance * distance) as f32
}

#[cfg(test)]
mod tests {
    use umbrae_render::Look;

    use super::*;

    fn model() -> Bounds {
        Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) }
    }

    fn lamp(place: LampPlace) -> LampChoice {
        LampChoice::new(place)
    }

    fn point() -> LampChoice {
        lamp(LampPlace::Point(DVec3::new(0.0, 0.0, 5.0)))
    }

    fn lights_of(lamps: &[LampChoice]) -> Vec<Light> {
        lights(lamps, &Scene::default(), &model())
    }

    #[test]
    fn lamps_are_numbered_each_kind_for_itself_and_stay_in_order() {
        let sun = LampPlace::Sun { azimuth_deg: 0.0, altitude_deg: 45.0 };
        let spot = LampPlace::Spot(SpotPlace { position: DVec3::Z, axis: DVec3::NEG_Z, outer_deg: 30.0 });
        let lights = lights_of(&[point(), lamp(spot), lamp(sun), point(), lamp(spot)]);
        let names: Vec<&str> = lights.iter().map(|light| light.name.as_str()).collect();
        assert_eq!(names, ["point 1", "spot 1", "sun", "point 2", "spot 2"]);
        assert!(lights[1].cone.is_some_and(|cone| (cone.inner_rad / cone.outer_rad - 0.8).abs() < 1e-6));
    }

    #[test]
    fn a_spot_of_half_of_space_is_no_wider_after_rounding() {
        let spot = LampPlace::Spot(SpotPlace { position: DVec3::Z, axis: DVec3::NEG_Z, outer_deg: 90.0 });
        let cone = lights_of(&[lamp(spot)])[0].cone.expect("it is a spot");
        assert!(cone.outer_rad <= std::f64::consts::FRAC_PI_2 && cone.inner_rad < cone.outer_rad, "{cone:?}");
    }

    #[test]
    fn an_intensity_is_what_arrives_at_one_metre() {
        let color = Some(Vec3::new(1.0, 0.5, 0.0));
        let lights = lights_of(&[LampChoice { intensity: Some(80.0), color, ..point() }]);
        assert_eq!(lights[0].strength, Vec3::new(80.0, 40.0, 0.0));
    }

    #[test]
    fn a_colour_alone_changes_no_intensity() {
        let lights = lights_of(&[point(), LampChoice { color: Some(Vec3::X), ..point() }]);
        let intensity = |light: &Light| light.strength.max_element();
        assert_eq!(intensity(&lights[0]), intensity(&lights[1]));
    }

    #[test]
    fn without_lamps_the_model_s_shine_and_without_those_the_sun() {
        let lantern = Light::new("lantern", LightPosition::point(DVec3::Z), Vec3::ONE);
        let scene = Scene { lights: vec![lantern], ..Scene::default() };
        let names = |lights: Vec<Light>| lights.into_iter().map(|light| light.name).collect::<Vec<_>>();
        assert_eq!(names(lights(&[], &scene, &model())), ["lantern"]);
        assert_eq!(names(lights(&[point()], &scene, &model())), ["point 1"]);
        assert_eq!(names(lights_of(&[])), ["sun"]);
    }

    #[test]
    fn at_the_end_of_its_reach_a_lamp_is_half_a_step_of_a_display() {
        let lights = lights_of(&[point()]);
        let exposure = Look::for_model(&model(), &lights).exposure;
        let lights = reaching(lights, exposure);
        let range_m = lights[0].range_m.expect("it ends");
        let shown = f64::from(lights[0].strength.max_element() * exposure) / (range_m * range_m);
        assert!((shown * 512.0 - 1.0).abs() < 1e-4, "{shown}");
    }

    #[test]
    fn a_range_that_was_given_stays_and_the_sun_has_none() {
        let sun = lamp(LampPlace::Sun { azimuth_deg: 0.0, altitude_deg: 45.0 });
        let lights = reaching(lights_of(&[LampChoice { range_m: Some(7.5), ..point() }, sun]), 1.0);
        assert_eq!(lights.iter().map(|light| light.range_m).collect::<Vec<_>>(), [Some(7.5), None]);
    }

    #[test]
    fn a_black_lamp_has_a_range_that_can_be_divided_by() {
        let lights = reaching(lights_of(&[LampChoice { color: Some(Vec3::ZERO), ..point() }]), 1.0);
        assert!(lights[0].range_m.is_some_and(|range| range as f32 > 0.0));
    }
}
