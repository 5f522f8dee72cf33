//! A finder that was bytes finds what it found before; and whatever bytes are, nothing panics.

use super::*;

const CHECKSUM_BYTES: usize = 32;

fn bytes_of(caster: &Caster, kind: FinderKind) -> Vec<u8> {
    Finder::new(caster, kind).to_bytes(caster).expect("its numbers are numbers")
}

fn error_of(caster: &Caster, kind: FinderKind, bytes: &[u8]) -> Option<SavedError> {
    Finder::from_bytes(caster, kind, bytes).err()
}

/// Open and closed, with odd edges, nodes and packets.
fn casters(random: &mut Random) -> Vec<Caster> {
    let soups = [30, 400, 3000].into_iter().filter_map(|triangles| soup(random, triangles));
    soups.chain([ball(20, 0.02)]).collect()
}

#[test]
fn a_finder_that_was_bytes_finds_the_same_in_the_same_order() {
    let mut random = Random(11);
    for caster in casters(&mut random) {
        for kind in FinderKind::ALL {
            let finder = Finder::new(&caster, kind);
            let bytes = finder.to_bytes(&caster).expect("its numbers are numbers");
            let read = Finder::from_bytes(&caster, kind, &bytes).expect("the bytes are whole");
            assert_eq!((read.kind(), read.edge_count(), read.bytes()), (kind, finder.edge_count(), finder.bytes()));
            assert!(read.to_bytes(&caster).as_ref() == Some(&bytes), "{}", kind.name());
            let [mut before, mut after] = [Found::default(), Found::default()];
            for light in lights(&mut random, 30) {
                finder.find(light, &mut before);
                read.find(light, &mut after);
                assert_eq!((&before.sides, before.tested), (&after.sides, after.tested), "{}", kind.name());
            }
        }
    }
}

#[test]
fn a_bit_that_is_wrong_anywhere_is_found_out_and_so_is_a_byte_too_few_or_too_many() {
    let mut random = Random(12);
    let caster = soup(&mut random, 40).expect("a soup of 40 triangles has one with area");
    for kind in FinderKind::ALL {
        let mut bytes = bytes_of(&caster, kind);
        for place in 0..bytes.len() {
            let bit = 1 << random.below(8);
            bytes[place] ^= bit;
            assert!(error_of(&caster, kind, &bytes).is_some(), "byte {place} of {}", kind.name());
            assert!(error_of(&caster, kind, &bytes[..place]).is_some(), "{place} bytes of {}", kind.name());
            bytes[place] ^= bit;
        }
        assert_eq!(error_of(&caster, kind, &bytes), None);
        bytes.push(0);
        assert_eq!(error_of(&caster, kind, &bytes), Some(SavedError::Damaged));
    }
}

#[test]
fn bytes_for_others_are_told_from_damage() {
    let [caster, other] = [ball(10, 0.0), ball(10, 0.05)];
    let mut bytes = bytes_of(&caster, FinderKind::Dual);
    assert_eq!(error_of(&other, FinderKind::Dual, &bytes), Some(SavedError::OtherCaster));
    assert_eq!(error_of(&caster, FinderKind::Cones, &bytes), Some(SavedError::OtherCaster));
    assert_eq!(error_of(&caster, FinderKind::Dual, b"another file"), Some(SavedError::NoFinder));
    let version = b"umbrae finder\n".len();
    bytes[version] += 1;
    assert_eq!(error_of(&caster, FinderKind::Dual, &bytes), Some(SavedError::OtherVersion { found: 2 }));
}

#[test]
fn the_key_is_another_when_one_vertex_moves_or_a_triangle_is_turned() {
    let key = |caster: &Caster| Finder::key(caster, FinderKind::Scan);
    let caster = ball(10, 0.0);
    assert_eq!(key(&caster), key(&ball(10, 0.0)));
    let mut moved = caster.clone();
    moved.positions[7].x = f32::from_bits(moved.positions[7].x.to_bits() ^ 1);
    assert_ne!(key(&caster), key(&moved));
    assert_ne!(key(&caster), Finder::key(&caster, FinderKind::Dual));
    let tetrahedron = |triangles: [[u32; 3]; 2]| {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        super::caster(Surface { positions, triangles: triangles.to_vec(), ..Surface::default() })
    };
    assert_ne!(key(&tetrahedron([[0, 1, 2], [0, 2, 3]])), key(&tetrahedron([[0, 1, 2], [0, 3, 2]])));
}

/// Whoever can write the file can make its checksum good.
#[test]
fn bytes_with_a_good_checksum_that_lead_anywhere_are_refused_or_harmless() {
    let mut random = Random(13);
    let (mut refused, mut harmless) = (0, 0);
    for caster in casters(&mut random) {
        let lights = lights(&mut random, 12);
        let rounds = if caster.mesh.triangles().len() < 1000 { 1500 } else { 150 };
        for kind in FinderKind::ALL {
            let good = bytes_of(&caster, kind);
            // Behind magic, version and key.
            let (start, end) = (14 + 4 + 32, good.len() - CHECKSUM_BYTES);
            for round in 0..rounds {
                let mut bytes = good.clone();
                // The first bytes are lengths, and those behind are mostly numbers of four bytes.
                let reach = if round % 4 == 0 { 64.min(end - start) } else { end - start };
                for _ in 0..1 + random.below(3) {
                    let place = start + random.below(reach);
                    let width = 1 + random.below(8);
                    let value = [0, u64::MAX, 1 << 31, random.bits()][random.below(4)].to_le_bytes();
                    let width = width.min(end - place);
                    bytes[place..place + width].copy_from_slice(&value[..width]);
                }
                let checksum = blake3::hash(&bytes[..end]);
                bytes[end..].copy_from_slice(checksum.as_bytes());
                match Finder::from_bytes(&caster, kind, &bytes) {
                    Err(error) => {
                        assert_eq!(error, SavedError::Damaged);
                        refused += 1;
                    }
                    Ok(finder) => {
                        let mut found = Found::default();
                        for &light in &lights {
                            finder.find(light, &mut found);
                            let vertices = caster.positions.len();
                            assert!(found.sides.as_flattened().iter().all(|&v| (v as usize) < vertices));
                        }
                        let _ = finder.chain(lights[0], &Counting::outside(&caster));
                        harmless += 1;
                    }
                }
            }
        }
    }
    assert!(refused > 1000 && harmless > 1000, "{refused} refused, {harmless} harmless");
}
