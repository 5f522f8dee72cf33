//! The sun's disc.

use crate::stage::{Stage, camera, cuboid, sun};

#[test]
fn a_box_and_a_post_in_the_sun_are_as_rays_find_them() {
    let stage = Stage::new(vec![cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 5.0]), cuboid([2.0, 0.0, 0.0], [2.1, 0.1, 8.0])]);
    let camera = camera([9.0, -8.0, 9.0], [1.0, 4.0, 0.0], 0.7, [160, 120]);
    stage.assert_like_rays(&camera, &sun(0.6), (0.002, 0.2));
}
