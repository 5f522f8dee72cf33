//! A picture of what `--verify` found.

use umbrae_core::Judgement;

/// A picture that shows where a mask is wrong: the mask in dim greys, undecided pixels blue, and a red ring with a white middle around each
/// wrong pixel. Four bytes a pixel.
pub fn error_picture(mask: &[u8], judgements: &[Judgement], errors: &[usize], width: usize) -> Vec<u8> {
    let mut rgba: Vec<[u8; 4]> = mask
        .iter()
        .zip(judgements)
        .map(|(&drawn, judged)| {
            let grey = match drawn {
                255 => 150,
                128 => 30,
                _ => 70,
            };
            if judged.verdict.is_some() { [grey, grey, grey, 255] } else { [grey / 2, grey / 2, grey / 2 + 90, 255] }
        })
        .collect();
    let height = rgba.len() / width.max(1);
    for &error in errors {
        let (x, y) = ((error % width) as i64, (error / width) as i64);
        for (dx, dy) in (-RING..=RING).flat_map(|dy| (-RING..=RING).map(move |dx| (dx, dy))) {
            let (px, py) = (x + dx, y + dy);
            let is_inside = (0..width as i64).contains(&px) && (0..height as i64).contains(&py);
            if is_inside && dx.abs().max(dy.abs()) == RING {
                rgba[py as usize * width + px as usize] = [230, 30, 30, 255];
            }
        }
    }
    for &error in errors {
        rgba[error] = [255, 255, 255, 255];
    }
    rgba.concat()
}

/// Half the side of the ring around a wrong pixel: seen at a glance, small enough to see what it is about.
const RING: i64 = 4;
