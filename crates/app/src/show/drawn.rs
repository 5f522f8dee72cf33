//! What became of each caster under one light, and into which pixels it was drawn.

use umbrae_core::{Case, CaseChooser, Caster, Culler, PixelRect};

use super::Subject;

/// What became of a caster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    /// Its volume was drawn.
    Drawn(Case),
    /// It casts no shadow.
    NotCasting,
    /// Nothing that the light reaches is in view.
    LightUnseen,
    /// The light does not reach it.
    Unreached,
    /// Its shadow can't be in view.
    Unseen,
}

/// What was drawn for one light.
#[derive(Debug)]
pub(super) struct Drawn {
    /// Its index.
    pub(super) light: usize,
    /// One for each caster.
    pub(super) fates: Vec<Fate>,
    /// The pixels that the light may change.
    pub(super) light_rect: Option<PixelRect>,
    /// For each caster, the pixels that its volume may change; `None` where it was not drawn.
    pub(super) caster_rects: Vec<Option<PixelRect>>,
}

impl Drawn {
    /// By the rules that are used in drawing. Linear in the number of casters, and in the triangles of those near the way from the light to the eye.
    pub(super) fn new(subject: &Subject<'_>, light: usize) -> Self {
        let all = Caster::bounds_of(subject.casters);
        let position = subject.lights[light].position.rounded_to_f32();
        let culler = Culler::new(subject.camera, &subject.lights[light], &all);
        let chooser = CaseChooser::new(subject.camera, position, &all);
        let fate_of = |caster: &Caster| {
            if !caster.role.casts {
                Fate::NotCasting
            } else if !culler.light_may_show() {
                Fate::LightUnseen
            } else if !culler.is_reached(&caster.bounds) {
                Fate::Unreached
            } else if !culler.may_shade_view(&caster.bounds) {
                Fate::Unseen
            } else {
                Fate::Drawn(chooser.case(caster))
            }
        };
        let fates: Vec<Fate> = subject.casters.iter().map(fate_of).collect();
        let light_rect = culler.light_rect();
        let rect_of = |(caster, fate): (&Caster, &Fate)| {
            let rect = matches!(fate, Fate::Drawn(_)).then(|| culler.shadow_rect(&caster.bounds)).flatten()?;
            rect.intersection(&light_rect?)
        };
        let caster_rects = subject.casters.iter().zip(&fates).map(rect_of).collect();
        Self { light, fates, light_rect, caster_rects }
    }
}
