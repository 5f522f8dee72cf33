//! The shadow volumes of spheres in the plan of one light: vertices in a row, because hardly any is used by more than two or three triangles.
//!
//! The polygon that is a sphere's light cap is inside of the sphere but for its rim, which stands out by less than [`ERROR_PX`]. So it is
//! no visible surface, and what is counted of it depends on depth as for any other face: z-fail must see that the lit half is in front of it. For
//! z-pass it is drawn too, because an eye on the light's side of it may look through the rim beside the sphere; a volume that is drawn whole
//! is right whatever is in the way.
//!
//! Source: the lecture notes "Shadow volumes", section 2.1.

use umbrae_core::{Camera, Case, CaseChooser, Culler, LightPosition, PixelRect, Sphere, SphereVolume};

use super::emit::Part;
use super::options::{Method, ShadowOptions};
use super::plan::{Draw, Plan, Seen, Source, rect_by_culling, volume_vertex};
use super::report::{CasterReport, Fate, Why};

/// How much wider than a sphere's shadow its polygon's may be, in pixels: the coarsest grid to which Vulkan lets devices snap vertices.
pub(crate) const ERROR_PX: f64 = 1.0 / 16.0;

/// The sphere that the shaders see.
pub(super) fn rounded_to_f32(sphere: &Sphere) -> Sphere {
    Sphere { center: sphere.center.as_vec3().as_dvec3(), radius: f64::from(sphere.radius as f32), ..sphere.clone() }
}

/// Whether a sphere is around the light but not around the eye: then nothing that is seen is lit.
pub(crate) fn is_shut_in(light: LightPosition, spheres: &[Sphere], camera: &Camera) -> bool {
    spheres.iter().any(|sphere| sphere.volume(light, 3).is_none() && !holds_eye(sphere, camera))
}

fn holds_eye(sphere: &Sphere, camera: &Camera) -> bool {
    camera.near_rectangle().iter().all(|corner| corner.distance(sphere.center) < sphere.radius)
}

impl Plan {
    /// Adds the volumes of the spheres; the light is shut in by none that can be seen from outside.
    pub(super) fn add_spheres(
        &mut self,
        seen: &Seen,
        light: LightPosition,
        (culler, chooser): (&Culler, &CaseChooser),
        options: &ShadowOptions,
        light_rect: PixelRect,
    ) {
        for sphere in &seen.spheres {
            let sides = sphere.sides_for(light, &seen.camera, ERROR_PX);
            let report = match sphere.volume(light, sides) {
                // Light and eye are both in it, and so is all that is seen.
                None => CasterReport::of_fate(Fate::Unseen),
                Some(volume) => match rect_by_culling(&volume.bounds(), culler, options, light_rect) {
                    Err(fate) => CasterReport::of_fate(fate),
                    Ok(rect) => self.add_sphere(&volume, (culler, chooser), options, rect),
                },
            };
            self.spheres.push(report);
        }
    }

    fn add_sphere(
        &mut self,
        volume: &SphereVolume,
        (culler, chooser): (&Culler, &CaseChooser),
        options: &ShadowOptions,
        rect: PixelRect,
    ) -> CasterReport {
        let bounds = volume.bounds();
        let shows_light_cap = !options.cull_caps || culler.light_cap_may_show(&bounds);
        let shows_dark_cap = !options.cull_caps || culler.dark_cap_may_show(&bounds);
        let zfail = if shows_light_cap { Case::Fail } else { Case::FailWithoutLightCap };
        let (case, why) = match (options.method, chooser.case_of_bounds(&bounds)) {
            (Method::ZPass, _) => (Case::Pass, Why::Method),
            (Method::ZFail, _) => (zfail, Why::Method),
            (Method::Auto | Method::EyeCount, Case::Pass) => (Case::Pass, Why::NearRectangleClear),
            (Method::Auto | Method::EyeCount, _) => (zfail, Why::NearRectangleMayBeShaded),
        };
        let mut report = CasterReport::of_fate(Fate::Drawn { case, why });
        report.faces_mut().silhouette_edges = volume.ring().len();
        report.faces_mut().chain_triangles = Some(volume.light_cap().count());
        report.parts = 1;
        report.rect = Some(rect);

        let first = self.loose.len() as u32;
        report.faces_mut().side_triangles = self.add_faces(volume.sides());
        if shows_light_cap {
            report.faces_mut().light_cap_triangles = self.add_faces(volume.light_cap());
        }
        if shows_dark_cap && case != Case::Pass {
            report.faces_mut().dark_cap_triangles = self.add_faces(volume.dark_cap());
        }
        let elements = first..self.loose.len() as u32;
        let part = if case == Case::Pass { Part::Pass } else { Part::Fail };
        // It is convex, and so holds no point twice.
        let draws = &mut self.batch_for(1).draws;
        draws.push(Draw { part, source: Source::Loose, elements, base_vertex: 0, rect });
        report
    }

    /// Returns how many there are.
    fn add_faces(&mut self, faces: impl Iterator<Item = [glam::DVec4; 3]>) -> usize {
        let before = self.loose.len();
        self.loose.extend(faces.flatten().map(volume_vertex));
        (self.loose.len() - before) / 3
    }
}
