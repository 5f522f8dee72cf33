//! Where the sun reaches: place and time into the sun's positions, and those with a scene and receivers into hours of
//! sun, outlines of shadows, and verdicts. No GPU, no file, and no clock but the one it is given.
//!
//! ```text
//! Place + Period -> Timetable (steps, each with its sun)
//!                       |
//! Scene -> Blockers ----+--> Exposure (a bit for each receiver and step) -> Hours -> Verdict
//! Scene -> Receivers ---'                                            \
//! Scene + Sun -> Outline (polygons on a plane)                        '-> share of time in shadow
//! ```
//!
//! Conventions beside those of [`umbrae_core`]: azimuths are clockwise from true north; a step is a half-open span of
//! time and stands for its middle; durations are seconds of UTC.

mod blockers;
mod exposure;
mod hours;
mod outline;
mod packets;
mod receivers;
mod sun;
mod timetable;

pub use blockers::Blockers;
pub use exposure::Exposure;
pub use hours::{Interval, SunHours};
pub use outline::{Outline, Polygon, Projection};
pub use packets::{PACKET, Packets};
pub use receivers::{GroundGrid, Group, GroupKind, LIFT_M, Receivers, Solids, Terrain, kind_of_triangles};
pub use sun::Sun;
pub use timetable::{Step, Timetable};
