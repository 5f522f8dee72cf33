//! The example of a renderer of one's own draws what rays say: lit where a light reaches, and nothing of it elsewhere.

#[expect(dead_code, reason = "the example's main is not run")]
#[path = "../examples/own_renderer_on_gpu.rs"]
mod own_renderer_on_gpu;

use own_renderer_on_gpu::own_renderer;
use umbrae_core::{Judgement, Light, Oracle, Verdict};
use umbrae_render::GpuError;

#[test]
fn a_renderer_of_ones_own_is_lit_exactly_where_rays_say() {
    let (casters, camera) = (own_renderer::casters(), own_renderer::camera());
    check(|lights| pollster::block_on(own_renderer::picture(&casters, &camera, lights)));
}

#[test]
fn a_renderer_of_ones_own_with_silhouettes_from_the_gpu_is_lit_exactly_where_rays_say() {
    let (casters, camera) = (own_renderer_on_gpu::casters(), own_renderer_on_gpu::camera());
    check(|lights| pollster::block_on(own_renderer_on_gpu::picture(&casters, &camera, lights)));
}

fn check(draw: impl Fn(&[Light]) -> Result<Vec<u8>, GpuError>) {
    let draw = |lights: &[Light]| draw(lights).expect("tests need a graphics driver: run scripts/setup.sh");
    let (casters, camera, lights) = (own_renderer::casters(), own_renderer::camera(), own_renderer::lights());
    let judged = Oracle::new(&casters).judge(&camera, &lights, || ());
    for (light, judgements) in lights.iter().zip(&judged) {
        let rgba = draw(std::slice::from_ref(light));
        let ambient = darkest(&rgba, judgements);
        let is_lit = |pixel: &[u8]| pixel != ambient;
        let (mut lit, mut dark) = (0, 0);
        for (i, (pixel, judged)) in rgba.chunks_exact(4).zip(judgements).enumerate() {
            match judged.verdict {
                Some(Verdict::Lit) => {
                    lit += 1;
                    assert!(is_lit(pixel), "pixel {i} is dark under the {}", light.name);
                }
                Some(Verdict::Dark) => {
                    dark += 1;
                    assert!(!is_lit(pixel), "pixel {i} is lit by the {}", light.name);
                }
                Some(Verdict::NoSurface) | None => {}
            }
        }
        assert!(lit > 20_000 && dark > 10_000, "{lit} lit and {dark} dark pixels show nothing");
    }
}

/// The colour of the first pixel that is surely dark.
fn darkest(rgba: &[u8], judgements: &[Judgement]) -> [u8; 4] {
    let dark = judgements.iter().position(|j| j.verdict == Some(Verdict::Dark)).expect("there is shadow");
    rgba[4 * dark..4 * dark + 4].try_into().expect("four bytes")
}
