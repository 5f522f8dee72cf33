//! Receivers in packets of neighbours.

use glam::DVec3;

use crate::Receivers;

/// How many receivers are decided together.
pub const PACKET: usize = 64;

/// The receivers that are not inside of solids, sorted by place into packets of [`PACKET`]; the last has fewer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Packets {
    /// Indices of receivers.
    order: Vec<u32>,
}

/// Within a packet, neighbours of neighbours: what a processor tests at once.
const GROUP: usize = 8;

/// Below so many the work is not worth a thread.
const ALONE: usize = 4096;

impl Packets {
    /// Sorts the receivers; about a tenth of a microsecond for each, on all threads.
    pub fn new(receivers: &Receivers) -> Self {
        let mut order: Vec<u32> = (0..receivers.len() as u32).filter(|&r| !receivers.is_inside[r as usize]).collect();
        sort(&mut order, &receivers.positions);
        Self { order }
    }

    /// How many packets there are.
    pub fn len(&self) -> usize {
        self.order.len().div_ceil(PACKET)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// The receivers of packet `packet`, by lane; at least one.
    ///
    /// # Panics
    ///
    /// If there is no such packet.
    pub fn members(&self, packet: usize) -> &[u32] {
        let start = packet * PACKET;
        &self.order[start..self.order.len().min(start + PACKET)]
    }
}

/// Halves the longest side of the box again and again, between whole packets, then between whole groups.
fn sort(order: &mut [u32], positions: &[DVec3]) {
    let unit = if order.len() > PACKET { PACKET } else { GROUP };
    if order.len() <= GROUP {
        return;
    }
    let at = |r: u32| positions[r as usize];
    let (min, max) =
        order.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &r| (min.min(at(r)), max.max(at(r))));
    let size = max - min;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let middle = (order.len().div_ceil(unit) / 2) * unit;
    // By index where they are level, so that the order is the same on every run.
    order.select_nth_unstable_by(middle, |&a, &b| at(a)[axis].total_cmp(&at(b)[axis]).then(a.cmp(&b)));
    let (left, right) = order.split_at_mut(middle);
    if left.len() > ALONE {
        rayon::join(|| sort(left, positions), || sort(right, positions));
    } else {
        sort(left, positions);
        sort(right, positions);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_receiver_outside_of_solids_is_in_one_packet_with_its_neighbours() {
        let positions: Vec<DVec3> =
            (0..10_000).map(|i| DVec3::new(f64::from(i % 100), f64::from(i / 100), 0.0)).collect();
        let is_inside: Vec<bool> = (0..10_000).map(|i| i % 7 == 0).collect();
        let receivers = Receivers { normals: vec![glam::Vec3::ZERO; 10_000], positions, is_inside, groups: Vec::new() };
        let packets = Packets::new(&receivers);
        let mut seen: Vec<u32> = (0..packets.len()).flat_map(|p| packets.members(p).to_vec()).collect();
        seen.sort_unstable();
        assert_eq!(seen, (0..10_000).filter(|i| i % 7 != 0).collect::<Vec<u32>>());
        for p in 0..packets.len() {
            let bounds =
                umbrae_core::Bounds::of_points(packets.members(p).iter().map(|&r| receivers.positions[r as usize]));
            assert!(bounds.size().max_element() < 20.0, "packet {p} is {} wide", bounds.size());
        }
    }
}
