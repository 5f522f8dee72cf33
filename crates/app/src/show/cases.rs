//! McGuire's case of every caster, as colours over the lit picture.
//!
//! Source: M. McGuire et al., "Fast, practical and robust shadows", 2003, section 6; in its image 6, too, case 3 is green.

use glam::Vec3;
use umbrae_core::{Case, Caster};
use umbrae_render::{Fate, Overlay, OverlayColor, OverlayVertex};

use super::canvas::Rgb;
use super::legend::{Legend, Swatch};
use super::numbers::{counted, grouped};
use super::{Subject, quoted};

/// How much of the lit picture a tint covers.
const TINT: f32 = 0.72;

/// What became of a caster, as far as its colour tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Pass,
    FailWithoutLightCap,
    Fail,
    Found,
    Unseen,
    Unreached,
    LightUnseen,
    NotCasting,
}

impl Kind {
    const ALL: [Self; 8] = [
        Self::Pass,
        Self::FailWithoutLightCap,
        Self::Fail,
        Self::Found,
        Self::Unseen,
        Self::Unreached,
        Self::LightUnseen,
        Self::NotCasting,
    ];

    fn of(fate: Fate) -> Self {
        match fate {
            Fate::Drawn { case: Case::Pass, .. } => Self::Pass,
            Fate::Drawn { case: Case::FailWithoutLightCap, .. } => Self::FailWithoutLightCap,
            Fate::Drawn { case: Case::Fail, .. } => Self::Fail,
            Fate::DrawnAsFound => Self::Found,
            Fate::Unseen => Self::Unseen,
            Fate::Unreached => Self::Unreached,
            Fate::LightUnseen => Self::LightUnseen,
            Fate::NotCasting => Self::NotCasting,
        }
    }

    fn color(self) -> Rgb {
        match self {
            Self::Pass => [96, 150, 220],
            Self::FailWithoutLightCap => [222, 190, 40],
            Self::Fail => [60, 180, 70],
            Self::Found => [170, 110, 200],
            Self::Unseen => [150, 146, 150],
            Self::Unreached => [92, 90, 96],
            Self::LightUnseen => [52, 52, 56],
            Self::NotCasting => [205, 200, 196],
        }
    }

    /// To be read after a number.
    fn meaning(self) -> &'static str {
        match self {
            Self::Pass => "in case 1: z-pass, sides only",
            Self::FailWithoutLightCap => "in case 2: z-fail, sides and dark cap",
            Self::Fail => "in case 3: z-fail, sides and both caps",
            Self::Found => "in a case that only the GPU knows",
            Self::Unseen => "left out: no shadow of theirs in view",
            Self::Unreached => "left out: beyond the light's reach",
            Self::LightUnseen => "left out: the light's reach is out of view",
            Self::NotCasting => "not casting",
        }
    }
}

/// Every caster in the colour of what became of it.
pub(super) fn cases(subject: &Subject<'_>, light: usize) -> (Overlay, Legend) {
    let kinds: Vec<Kind> = subject.reports[light].casters.iter().map(|report| Kind::of(report.fate)).collect();
    let mut overlay = Overlay::default();
    for (i, (caster, &kind)) in subject.casters.iter().zip(&kinds).enumerate() {
        // The ground would give the whole picture its colour.
        if !(kind == Kind::Pass && Some(i) == subject.ground) {
            overlay.triangles.extend(tinted(caster, subject, kind.color()));
        }
    }
    let mut legend = Legend::new(format!("McGuire's cases, light {}", quoted(&subject.lights[light].name)));
    for kind in Kind::ALL {
        let casters = kinds.iter().filter(|&&other| other == kind).count();
        let is_case = matches!(kind, Kind::Pass | Kind::FailWithoutLightCap | Kind::Fail);
        // The three cases are told even where none is in them; the others only where there are any.
        if casters > 0 || is_case {
            legend =
                legend.entry(Swatch::Area(kind.color()), format!("{} {}", grouped(casters as u64), kind.meaning()));
        }
    }
    (overlay, legend.text(format!("of {}", counted(subject.casters.len(), "object"))))
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
