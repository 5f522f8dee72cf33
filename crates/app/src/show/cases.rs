//! McGuire's case of every caster, as colours over the lit picture.
//!
//! Source: M. McGuire et al., "Fast, practical and robust shadows", 2003, section 6; in its image 6, too, case 3 is green.

use glam::Vec3;
use umbrae_core::{Case, Caster};
use umbrae_render::{Overlay, OverlayColor, OverlayVertex};

use super::canvas::Rgb;
use super::drawn::{Drawn, Fate};
use super::legend::{Legend, Swatch};
use super::numbers::{counted, grouped};
use super::{Subject, quoted};

/// How much of the lit picture a tint covers.
const TINT: f32 = 0.72;

impl Fate {
    fn color(self) -> Rgb {
        match self {
            Self::Drawn(Case::Pass) => [96, 150, 220],
            Self::Drawn(Case::FailWithoutLightCap) => [222, 190, 40],
            Self::Drawn(Case::Fail) => [60, 180, 70],
            Self::NotCasting => [205, 200, 196],
            Self::LightUnseen => [52, 52, 56],
            Self::Unreached => [92, 90, 96],
            Self::Unseen => [150, 146, 150],
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Self::Drawn(Case::Pass) => "in case 1: z-pass, sides only",
            Self::Drawn(Case::FailWithoutLightCap) => "in case 2: z-fail, sides and dark cap",
            Self::Drawn(Case::Fail) => "in case 3: z-fail, sides and both caps",
            Self::NotCasting => "not casting",
            Self::LightUnseen => "left out: the light's reach is out of view",
            Self::Unreached => "left out: beyond the light's reach",
            Self::Unseen => "left out: no shadow of theirs in view",
        }
    }

    const ALL: [Self; 7] = [
        Self::Drawn(Case::Pass),
        Self::Drawn(Case::FailWithoutLightCap),
        Self::Drawn(Case::Fail),
        Self::Unseen,
        Self::Unreached,
        Self::LightUnseen,
        Self::NotCasting,
    ];
}

/// Every caster in the colour of what became of it.
pub(super) fn cases(subject: &Subject<'_>, drawn: &Drawn) -> (Overlay, Legend) {
    let mut overlay = Overlay::default();
    for (i, (caster, &fate)) in subject.casters.iter().zip(&drawn.fates).enumerate() {
        let is_usual = fate == Fate::Drawn(Case::Pass);
        // The ground would give the whole picture its colour.
        if !(is_usual && Some(i) == subject.ground) {
            overlay.triangles.extend(tinted(caster, subject, fate.color()));
        }
    }
    let mut legend = Legend::new(format!(
        "McGuire's case of {}, light {}",
        counted(subject.casters.len(), "object"),
        quoted(&subject.lights[drawn.light].name)
    ));
    for fate in Fate::ALL {
        let casters = drawn.fates.iter().filter(|&&other| other == fate).count();
        // The three cases are told even where none is in them; other fates only where there are any.
        if casters > 0 || matches!(fate, Fate::Drawn(_)) {
            legend =
                legend.entry(Swatch::Area(fate.color()), format!("{} {}", grouped(casters as u64), fate.meaning()));
        }
    }
    (overlay, legend)
}

/// The triangles of `caster` in one colour, darker the more they turn from the eye, so that shapes stay readable.
fn tinted<'a>(caster: &'a Caster, subject: &Subject<'_>, color: Rgb) -> impl Iterator<Item = [OverlayVertex; 3]> + 'a {
    let eye = subject.camera.eye().as_vec3();
    (0..caster.mesh.triangles().len()).map(move |t| {
        let corners = caster.corners(t);
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let cosine = normal.dot((eye - (a + b + c) / 3.0).normalize_or(Vec3::ZERO)).abs();
        let shaded = color.map(|channel| (f32::from(channel) * (0.62 + 0.38 * cosine)).round() as u8);
        corners.map(|corner| OverlayVertex::at(corner, OverlayColor::new(shaded, TINT)))
    })
}
