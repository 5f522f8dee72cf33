//! Scenes of our own making: for a first try, for tests and for benchmarks.
//!
//! They stand in for the scenes of Wallner 2007, and each has its structural components as named objects. Built from
//! closed bodies standing on z = 0, the same on every run.

mod command;
mod glb;
mod high_rise;
mod industry;
mod lattice_tower;
mod model;
mod staircase;
mod town;

pub use command::run;
pub use glb::glb_bytes;
use umbrae_core::Scene;

/// A scene that needs no file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Sample {
    /// An iron tower of struts, 300 m high (11,000 triangles)
    LatticeTower,
    /// Halls, tanks, silos, chimneys and pipes on racks (14,000 triangles)
    Industry,
    /// A turning tower of 51 floors, every mullion of it, inside a net of struts (182,000 triangles)
    HighRise,
    /// 300 steps and a lamp at the top that shines down along them (4,000 triangles)
    Staircase,
    /// An old town: houses around courtyards, a church, a market, walls and trees (60,000 triangles)
    Town,
    /// The town under 20 street lamps (64,000 triangles); on the command line `town --night`
    #[value(skip)]
    TownByNight,
}

impl Sample {
    /// The scene, built anew; takes well under a second.
    ///
    /// Objects are structural components, named so that one pattern finds a kind of them (`house*`, `trees*`). Every
    /// mesh is closed, and the lowest point of the scene is at z = 0.
    pub fn scene(self) -> Scene {
        match self {
            Self::LatticeTower => lattice_tower::scene(),
            Self::Industry => industry::scene(),
            Self::HighRise => high_rise::scene(),
            Self::Staircase => staircase::scene(),
            Self::Town => town::scene(),
            Self::TownByNight => town::scene_by_night(),
        }
    }

    /// The same scene with its lamps lit, if it has any.
    pub fn by_night(self) -> Option<Self> {
        match self {
            Self::Town | Self::TownByNight => Some(Self::TownByNight),
            Self::LatticeTower | Self::Industry | Self::HighRise | Self::Staircase => None,
        }
    }
}

#[cfg(test)]
mod tests;
