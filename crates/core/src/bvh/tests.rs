//! The tree loses nothing, wherever its pieces are.

use super::*;

/// Boxes of single points.
fn pieces(points: impl IntoIterator<Item = [f32; 3]>) -> Vec<Piece> {
    points.into_iter().enumerate().map(|(id, p)| Piece::new(&[p; 3], id as u32)).collect()
}

/// Checks everything below the node and says how many levels that is.
fn check(tree: &Tree, pieces: &[Piece], index: usize, within: &Planes<1>, seen: &mut [bool]) -> usize {
    let node = &tree.nodes[index];
    let mut levels = 0;
    for (lane, link) in node.links.iter().enumerate() {
        let planes: Planes<1> = node.planes.map(|lanes| [lanes[lane]]);
        if planes[0] > planes[3] {
            continue;
        }
        let is_in = |outer: &Planes<1>| (0..3).all(|i| outer[i] <= planes[i] && planes[i + 3] <= outer[i + 3]);
        assert!(is_in(within), "the box of node {index}, child {lane} sticks out of that of the node");
        if link.count == 0 {
            levels = levels.max(check(tree, pieces, index + link.start as usize, &planes, seen));
            continue;
        }
        assert!(link.count as usize <= MAX_LEAF);
        for place in link.start..link.start + link.count {
            assert!(!std::mem::replace(&mut seen[place as usize], true), "place {place} is in two leaves");
            let Extent { min, max } = pieces[place as usize].extent;
            assert!((0..3).all(|i| planes[i][0] <= min[i] && max[i] <= planes[i + 3][0]), "place {place} sticks out");
        }
    }
    levels + 1
}

fn levels(mut pieces: Vec<Piece>) -> usize {
    let tree = Tree::new(&mut pieces);
    let mut seen = vec![false; pieces.len()];
    let all = std::array::from_fn(|plane| [if plane < 3 { f32::NEG_INFINITY } else { f32::INFINITY }]);
    let levels = check(&tree, &pieces, 0, &all, &mut seen);
    assert!(seen.iter().all(|&s| s), "a piece is in no leaf");
    levels
}

#[test]
fn each_piece_is_in_one_leaf_and_in_every_box_above_it() {
    for count in [1, 2, 7, 8, 9, 1000, 40_000] {
        let levels = levels(pieces((0..count).map(|i| [(i % 97) as f32, (i % 89) as f32, (i % 83) as f32])));
        assert!(levels <= 16, "{levels} levels for {count} pieces");
    }
}

#[test]
fn a_node_is_two_cache_lines() {
    assert_eq!(size_of::<Node>(), 128);
}

#[test]
fn pieces_all_in_one_place_make_a_shallow_tree() {
    let levels = levels(pieces(std::iter::repeat_n([1.0; 3], 100_000)));
    assert!(levels < AREA_LEVELS, "{levels} levels");
}

#[test]
fn pieces_ever_closer_to_one_point_do_not_make_the_tree_too_deep() {
    // Each cut of equal bins takes off only the few outermost, down to the smallest `f32`.
    let spiral = (0..200_000_u32).map(|i| {
        let mut point = [0.0; 3];
        point[i as usize % 3] = f32::from_bits((i / 3) * (f32::MAX.to_bits() / 70_000));
        point
    });
    let levels = levels(pieces(spiral));
    assert!((AREA_LEVELS..=MAX_LEVELS).contains(&levels), "{levels} levels");
}

#[test]
fn a_box_holds_the_interval_of_every_box_inside_it_to_the_last_bit() {
    let outer: Planes<1> = [[-0.1], [0.3], [1.0], [0.7], [0.9], [1.0]];
    let inner: Planes<1> = [[0.1], [0.3], [1.0], [0.1], [0.8], [1.0]];
    for i in 0..1000 {
        let angle = f64::from(i) * 0.1;
        // Among them rays in a face and along an edge of both boxes.
        let direction = [angle.cos() * f64::from(i % 3), angle.sin() * f64::from(i % 2), 3.0];
        let slabs = Slabs::new([0, 1, 2], [0.1_f32.into(), 0.3_f32.into(), 1.0 - f64::from(i % 5)], direction);
        let [([outer_near], [outer_far]), ([near], [far])] = [&outer, &inner].map(|planes| slabs.interval(planes));
        assert!(outer_near <= near && far <= outer_far, "ray {i}");
    }
}
