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
mod check;
mod clock;
mod dates;
mod disc_exposure;
mod events;
mod exposure;
mod hours;
mod julian;
mod local_time;
mod outline;
mod packets;
mod period;
mod place;
mod profile;
mod random;
mod receivers;
mod refinement;
pub mod rules;
mod sun;
mod sun_disc;
mod sun_path;
mod time_error;
mod timetable;
mod zone;

pub use blockers::Blockers;
pub use check::Check;
pub use clock::{Clock, ClockKind, LocalDay, equation_of_time_s};
pub use dates::{parse_date, parse_dates};
pub use disc_exposure::{DiscExposure, PartialSun};
pub use events::{DayKind, HORIZON_DEG, SunDay, equinoxes_and_solstices, spans_of_sun};
pub use exposure::Exposure;
pub use hours::{Interval, SunHours};
pub use local_time::LocalTime;
pub use outline::{Outline, Polygon, Projection};
pub use packets::{PACKET, Packets};
pub use period::{DayWindow, Edge, Period, parse_step};
pub use place::Place;
pub use profile::{Moment, Profile};
pub use receivers::{
    FOOT_M, GroundGrid, GroundLevel, Group, GroupKind, LIFT_M, Receivers, Solids, Terrain, kind_of_triangles,
};
pub use refinement::Refinement;
pub use sun::{Refraction, Sun, SunOptions};
pub use sun_disc::SunDisc;
pub use sun_path::SunPath;
pub use time_error::TimeError;
pub use timetable::{Step, Timetable};
pub use zone::Zone;
