//! Masks against rays.

use umbrae_core::{Judgement, Verdict};

/// What a mask of one light is worth.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Comparison {
    /// Pixels in the picture.
    pub pixels: usize,
    /// Those whose centre ray meets a surface.
    pub surface: usize,
    /// Surface pixels on which the rays agree.
    pub decided: usize,
    /// Decided pixels, sky included, that the mask has wrong; indices from the top left, row by row.
    pub errors: Vec<usize>,
}

/// The byte that a mask holds for a verdict.
pub(crate) fn mask_byte(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::NoSurface => 128,
        Verdict::Lit => 255,
        Verdict::Dark => 0,
    }
}

/// Compares a mask with what the rays say of each pixel.
pub fn compare(mask: &[u8], judgements: &[Judgement]) -> Comparison {
    let is_surface = |j: &&Judgement| j.has_surface;
    let errors = mask.iter().zip(judgements).enumerate();
    Comparison {
        pixels: judgements.len(),
        surface: judgements.iter().filter(is_surface).count(),
        decided: judgements.iter().filter(is_surface).filter(|j| j.verdict.is_some()).count(),
        errors: errors
            .filter(|(_, (drawn, judged))| judged.verdict.is_some_and(|v| mask_byte(v) != **drawn))
            .map(|(pixel, _)| pixel)
            .collect(),
    }
}
