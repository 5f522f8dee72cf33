//! One bit for each receiver and step: in the sun or not.

use std::ops::Range;

use crate::Receivers;

/// Receivers that are decided together.
pub const PACKET: usize = 64;

/// The receivers in packets of neighbours.
#[derive(Debug, Clone, Default)]
pub struct Packets {
    /// For each packet its receivers; the last are `u32::MAX` where there are fewer than [`PACKET`].
    members: Vec<[u32; PACKET]>,
}

impl Packets {
    /// Sorts `receivers` by place; those inside solids are in no packet.
    pub fn new(receivers: &Receivers) -> Self {
        let outside: Vec<u32> = (0..receivers.positions.len() as u32)
            .filter(|&r| !receivers.is_inside.get(r as usize).copied().unwrap_or(false))
            .collect();
        let members = outside
            .chunks(PACKET)
            .map(|chunk| std::array::from_fn(|i| chunk.get(i).copied().unwrap_or(u32::MAX)))
            .collect();
        Self { members }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// The receivers of packet `packet`, by lane.
    pub fn members(&self, packet: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.members[packet].iter().enumerate().filter(|&(_, &r)| r != u32::MAX).map(|(lane, &r)| (lane, r as usize))
    }
}

/// Verdicts for some packets and every step of a timetable.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exposure {
    /// Which packets.
    pub packets: Range<usize>,
    /// How many steps.
    pub step_count: usize,
    /// Bit `lane` of word `(packet - packets.start) * step_count + step`: in the sun.
    pub lit: Vec<u64>,
    /// Verdicts that hold for the receiver as given, but not for some point within a millimetre of it: receiver, step. In order.
    pub undecided: Vec<(u32, u32)>,
}

impl Exposure {
    /// Whether the receiver in `lane` of `packet` is in the sun at `step`.
    pub fn is_lit(&self, packet: usize, lane: usize, step: usize) -> bool {
        self.lit[(packet - self.packets.start) * self.step_count + step] >> lane & 1 == 1
    }
}
