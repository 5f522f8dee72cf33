//! Textures, cut-outs and glass, against what plain colours give.

use crate::level::{Above, Level, SIDE_PX, place, texture, zenith};
use glam::{Vec2, Vec3};
use umbrae_core::{AlphaMode, Extent, Light, Material, Role, Texture, Wrap};

const RED: [u8; 4] = [255, 0, 0, 255];
const GREEN: [u8; 4] = [0, 255, 0, 255];
const BLUE: [u8; 4] = [0, 0, 255, 255];
const WHITE: [u8; 4] = [255; 4];
const WHOLE: [Vec2; 2] = [Vec2::ZERO, Vec2::ONE];

fn textured(texture: u32) -> Material {
    Material { base_color_texture: Some(texture), ..Material::new("textured", Vec3::ONE) }
}

fn glass(color: Vec3, alpha: f32) -> Material {
    Material { alpha, alpha_mode: AlphaMode::Blend, ..Material::new("glass", color) }
}

/// What a floor of each colour looks like.
fn plain_colors<const N: usize>(above: &Above, colors: [Vec3; N]) -> [Vec<[u8; 3]>; N] {
    colors.map(|color| above.picture(&Level::plain(color), &[zenith()]))
}

#[track_caller]
fn assert_near(found: [u8; 3], expected: [u8; 3], what: impl std::fmt::Display) {
    let is_near = found.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1);
    assert!(is_near, "{found:?} is not {expected:?}: {what}");
}

#[test]
fn the_four_texels_of_a_picture_are_in_its_four_quarters() {
    let above = Above::new(1);
    let mut level = Level::default();
    let four = level.texture(texture(2, &[RED, GREEN, BLUE, WHITE]));
    let material = level.material(textured(four));
    level.square(5.0, 0.0, material, WHOLE);
    let found = above.picture(&level, &[zenith()]);
    let expected = plain_colors(&above, [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE]);
    for (pixel, &color) in found.iter().enumerate() {
        let p = place(pixel);
        let texel = usize::from(p.x > 0.0) + 2 * usize::from(p.y < 0.0);
        assert_near(color, expected[texel][pixel], p);
    }
}

#[test]
fn beyond_its_border_a_picture_is_repeated_mirrored_or_its_border() {
    let above = Above::new(1);
    let expected = plain_colors(&above, [Vec3::X, Vec3::Z]);
    let texel_at = |wrap: Wrap, u: f64| match wrap {
        Wrap::Repeat => usize::from(u.rem_euclid(1.0) > 0.5),
        Wrap::Mirror => usize::from((u.rem_euclid(2.0) - 1.0).abs() < 0.5),
        Wrap::Clamp => usize::from(u > 0.5),
    };
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        for axis in [0, 1] {
            let mut level = Level::default();
            let two = Texture { wrap: [wrap; 2], ..texture([2, 1][axis], &[RED, BLUE]) };
            let two = level.texture(two);
            let material = level.material(textured(two));
            level.square(5.0, 0.0, material, [Vec2::splat(-2.0), Vec2::splat(3.0)]);
            for (pixel, &color) in above.picture(&level, &[zenith()]).iter().enumerate() {
                let p = place(pixel);
                let along = [p.x, -p.y][axis];
                let texel = texel_at(wrap, (along + 5.0) / 10.0 * 5.0 - 2.0);
                assert_near(color, expected[texel][pixel], format!("{wrap:?}, axis {axis}, {p}"));
            }
        }
    }
}

#[test]
fn a_texture_multiplies_the_colour_and_fades_into_its_mean() {
    let above = Above::new(1);
    let mut level = Level::default();
    // A chequer of a thousand squares a side is finer than pixels: half the light of white, whatever the numbers' mean.
    let fine =
        level.texture(Texture { is_nearest: false, ..texture(2, &[WHITE, [0, 0, 0, 255], [0, 0, 0, 255], WHITE]) });
    let material = level.material(Material { base_color: Vec3::new(0.8, 0.4, 0.2), ..textured(fine) });
    level.square(5.0, 0.0, material, [Vec2::ZERO, Vec2::splat(500.0)]);
    let [expected] = plain_colors(&above, [Vec3::new(0.4, 0.2, 0.1)]);
    for (pixel, &color) in above.picture(&level, &[zenith()]).iter().enumerate() {
        let is_near = color.iter().zip(expected[pixel]).all(|(a, b)| a.abs_diff(b) <= 3);
        assert!(is_near, "{color:?} is not {:?} at {}", expected[pixel], place(pixel));
    }
}

/// White, with a hole in the west half and a cutoff that the east's alpha just reaches.
fn holed(level: &mut Level) -> u32 {
    let halves = level.texture(texture(2, &[[255, 255, 255, 101], [255, 255, 255, 102]]));
    let alpha_mode = AlphaMode::Mask { cutoff: 102.0 / 255.0 };
    level.material(Material { alpha_mode, ..textured(halves) })
}

#[test]
fn where_a_surface_is_cut_out_what_is_behind_is_seen() {
    for samples in [1, 4] {
        let above = Above::new(samples);
        let mut level = Level::plain(Vec3::X);
        let material = holed(&mut level);
        // Seen larger by 10 / 9: its border is between pixels.
        level.square(1.8, 1.0, material, WHOLE);
        let level = level.with_roles();
        let found = above.picture(&level, &[]);
        let [behind, sheet] = [Vec3::X, Vec3::ONE].map(|color| above.picture(&Level::plain(color), &[]));
        for (pixel, &color) in found.iter().enumerate() {
            let p = place(pixel);
            let is_sheet = p.y.abs() < 2.0 && (0.0..2.0).contains(&p.x);
            assert_near(color, if is_sheet { sheet[pixel] } else { behind[pixel] }, p);
        }
    }
}

#[test]
fn a_cut_out_is_no_surface_in_a_mask_and_casts_as_a_full_triangle() {
    let above = Above::new(1);
    let mut alone = Level::default();
    let material = holed(&mut alone);
    alone.square(2.0, 1.0, material, WHOLE);
    let mut over_floor = Level::plain(Vec3::X);
    let material = holed(&mut over_floor);
    over_floor.square(2.0, 1.0, material, WHOLE);
    let [alone, over_floor] = [alone, over_floor].map(|level| above.mask(&level.with_roles(), &zenith()));
    for pixel in 0..SIDE_PX * SIDE_PX {
        let p = place(pixel);
        let seen = 2.0 * 10.0 / 9.0;
        let is_sheet = p.y.abs() < seen && (0.0..seen).contains(&p.x);
        assert_eq!(alone[pixel], if is_sheet { 255 } else { 128 }, "{p}");
        let is_shaded = p.x.abs() < 2.0 && p.y.abs() < 2.0;
        assert_eq!(over_floor[pixel], if is_sheet || !is_shaded { 255 } else { 0 }, "{p}");
    }
}

#[test]
fn what_has_the_role_of_an_opaque_thing_is_drawn_whole() {
    let above = Above::new(1);
    let mut level = Level::default();
    let material = holed(&mut level);
    level.square(5.0, 0.0, material, WHOLE);
    let pane = level.material(glass(Vec3::ONE, 0.1));
    level.square(1.0, 0.5, pane, WHOLE);
    let [expected] = plain_colors(&above, [Vec3::ONE]);
    let ambient = above.picture(&Level::plain(Vec3::ONE), &[]);
    for (pixel, &color) in above.picture(&level, &[]).iter().enumerate() {
        assert_near(color, ambient[pixel], place(pixel));
    }
    assert_ne!(expected, ambient, "light is seen");
}

#[test]
fn glass_mixes_with_what_is_behind_by_its_alpha_and_is_lit_as_that_is() {
    for samples in [1, 4] {
        let above = Above::new(samples);
        let mut level = Level::plain(Vec3::X);
        let pane = level.material(glass(Vec3::Z, 0.25));
        level.square(5.0, 0.001, pane, WHOLE);
        let found = above.picture(&level.with_roles(), &[zenith()]);
        let [expected] = plain_colors(&above, [Vec3::new(0.75, 0.0, 0.25)]);
        for (pixel, &color) in found.iter().enumerate() {
            assert_near(color, expected[pixel], place(pixel));
        }
    }
}

#[test]
fn panes_are_mixed_from_the_farthest_to_the_nearest_in_whatever_order_they_come() {
    let above = Above::new(1);
    let mut heights = [(0.001, Vec3::Y), (0.002, Vec3::Z), (0.003, Vec3::ONE)];
    let [expected] = plain_colors(&above, [Vec3::new(0.125, 0.125, 0.25) + Vec3::new(0.5, 0.5, 0.5)]);
    for _ in 0..3 {
        heights.rotate_left(1);
        let mut level = Level::plain(Vec3::X);
        for (height, color) in heights {
            let pane = level.material(glass(color, 0.5));
            level.square(5.0, height, pane, WHOLE);
        }
        let found = above.picture(&level.with_roles(), &[zenith()]);
        for (pixel, &color) in found.iter().enumerate() {
            assert_near(color, expected[pixel], place(pixel));
        }
    }
}

#[test]
fn glass_has_the_alpha_of_its_texture_and_hides_nothing_before_it() {
    let above = Above::new(1);
    let mut level = Level::default();
    let red = level.material(Material::new("red", Vec3::X));
    let halves = level.texture(texture(2, &[[255, 255, 255, 0], [255, 255, 255, 204]]));
    let pane = level.material(Material { base_color_texture: Some(halves), ..glass(Vec3::Z, 0.5) });
    level.square(5.0, 0.0, red, WHOLE).square(5.0, 0.001, pane, WHOLE).square(1.0, 0.002, red, WHOLE);
    let found = above.picture(&level.with_roles(), &[zenith()]);
    let [plain, mixed] = plain_colors(&above, [Vec3::X, Vec3::new(0.6, 0.0, 0.4)]);
    for (pixel, &color) in found.iter().enumerate() {
        let p = place(pixel);
        let is_mixed = p.x > 0.0 && (p.x > 1.0 || p.y.abs() > 1.0);
        assert_near(color, if is_mixed { mixed[pixel] } else { plain[pixel] }, p);
    }
}

#[test]
fn glass_is_absent_from_masks() {
    let above = Above::new(1);
    let mut level = Level::default();
    let pane = level.material(glass(Vec3::Z, 0.5));
    level.square(5.0, 0.0, pane, WHOLE);
    assert!(above.mask(&level.with_roles(), &zenith()).iter().all(|&verdict| verdict == 128));
}

#[test]
fn glass_under_more_lights_than_one_buffer_holds_is_as_under_one_of_their_sum() {
    let above = Above::new(1);
    let mut level = Level::plain(Vec3::X);
    for height in [0.001, 0.002] {
        let pane = level.material(glass(Vec3::Z, 0.5));
        level.square(5.0, height, pane, WHOLE);
    }
    let level = level.with_roles();
    // A power of two: 16-bit floats add it without rounding.
    let weak = Light { strength: zenith().strength / 512.0, ..zenith() };
    let many = above.picture(&level, &vec![weak; 512]);
    let one = above.picture(&level, &[zenith()]);
    for (pixel, (&many, &one)) in many.iter().zip(&one).enumerate() {
        let is_near = many.iter().zip(one).all(|(a, b)| a.abs_diff(b) <= 4);
        assert!(is_near, "{many:?} is not {one:?} at {}", place(pixel));
    }
}

#[test]
fn a_role_may_make_glass_of_what_its_material_calls_opaque() {
    let above = Above::new(1);
    let mut level = Level::plain(Vec3::X);
    let pane = level.material(Material { alpha: 0.25, ..Material::new("opaque", Vec3::Z) });
    level.square(5.0, 0.001, pane, WHOLE);
    level.0.objects[1].role = Role { is_glass: true, casts: false, ..Role::default() };
    let [expected] = plain_colors(&above, [Vec3::Z]);
    assert_near(above.picture(&level, &[zenith()])[0], expected[0], "alpha means nothing to it");
}

/// Models have many a face twice; of those in one place the first is seen.
#[test]
fn faces_in_one_place_get_the_light_once() {
    for samples in [1, 4] {
        let above = Above::new(samples);
        let sun = Light { extent: Extent::Disc { radius_rad: 0.01 }, ..zenith() };
        let lights = [vec![zenith()], vec![zenith(), zenith()], vec![sun.clone()], vec![sun, zenith()]];
        for (i, lights) in lights.iter().enumerate() {
            let mut level = Level::plain(Vec3::new(0.4, 0.2, 0.1));
            let once = above.picture(&level, lights);
            let other = level.material(Material::new("other", Vec3::new(0.1, 0.2, 0.4)));
            for material in [0, other] {
                level.square(5.0, 0.0, material, WHOLE);
            }
            assert_eq!(above.picture(&level, lights), once, "{samples} samples, lights {i}");
        }
    }
}
