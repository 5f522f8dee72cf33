//! What is said of lights that do less than one might think.

use glam::Vec3;
use umbrae_core::{Bounds, Caster, Extent, Light, Object, Sphere};

use crate::cli::RenderArgs;
use crate::extent::ExtentChoice;
use crate::talk::{Talk, and_more};

/// Says which options give no light a size, where `all` is what lamps are to be.
pub(crate) fn warn_of_no_extent(lights: &[Light], (args, all): (&RenderArgs, Option<ExtentChoice>), talk: &Talk) {
    let is_all = |is: fn(&Light) -> bool| lights.iter().all(is);
    if args.sun_disc && is_all(|light| !light.position.is_directional()) {
        talk.warning("--sun-disc changes nothing: no light is the sun; --light-radius gives lamps a size");
    }
    if all.is_some() && is_all(|light| light.position.is_directional()) {
        talk.warning(
            "--light-radius and --light-size change nothing: no light is a lamp; --sun-disc gives the sun its size",
        );
    }
    if args.soft && is_all(|light| light.extent == Extent::Point) {
        talk.warning(
            "--soft changes nothing: no light has a size; --sun-disc, --light-radius or --light-size give one",
        );
    }
}

/// Says which directional lights are below the horizon.
pub(crate) fn warn_of_darkness(lights: &[Light], talk: &Talk) {
    for light in lights {
        let l = light.position.homogeneous();
        if light.position.is_directional() && l.z <= 0.0 {
            talk.warning(&format!("the {} is not above the horizon: level ground is dark", light.name));
        }
    }
}

/// Says which of `objects`, whose casters are `casters`, and of `spheres` reach into a light with a size.
pub(crate) fn warn_of_cuts(
    lights: &[Light],
    (objects, casters): (&[Object], &[Caster]),
    spheres: &[Sphere],
    talk: &Talk,
) {
    for light in lights.iter().filter(|light| light.extent != Extent::Point) {
        let (middle, radius_m) = (light.position.homogeneous().truncate(), light.extent.radius_m());
        let reach = Bounds { min: middle - radius_m, max: middle + radius_m };
        let is_cut_by = |caster: &Caster| {
            caster.role.casts
                && caster.bounds.meets(&reach)
                && (0..caster.mesh.triangles().len()).any(|t| light.is_cut_by(caster.corners(t).map(Vec3::as_dvec3)))
        };
        let cutting = objects.iter().zip(casters).filter(|(_, caster)| is_cut_by(caster));
        let cutting_spheres = spheres.iter().filter(|sphere| light.is_cut_by_sphere(sphere));
        let names = cutting.map(|(object, _)| object.name.as_str());
        let names: Vec<&str> = names.chain(cutting_spheres.map(|sphere| sphere.name.as_str())).collect();
        if !names.is_empty() {
            let (verb, it) = if names.len() == 1 { ("reaches", "its") } else { ("reach", "their") };
            talk.warning(&format!(
                "{} {verb} into the light `{}`: {it} soft shadow is not right; leave out what is part of the lamp with --no-cast, or make the light smaller",
                and_more(&names),
                light.name
            ));
        }
    }
}
