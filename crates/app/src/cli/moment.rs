//! When models are shown that move.

use clap::Args;

use crate::model::Moment;
use crate::parse::seconds;

/// A moment of the models' animations.
#[derive(Debug, Clone, Default, Args)]
pub struct MomentArgs {
    /// Show animated models as they are this long after the beginning; after its last key an animation stands still (default: at rest)
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    pub time: Option<f64>,

    /// The animation to play, by the name that `umbrae inspect` shows (default: all that move different things, else the first)
    #[arg(long, value_name = "NAME", requires = "time")]
    pub animation: Option<String>,
}

impl MomentArgs {
    /// The moment to show; `None` at rest.
    pub fn moment(&self) -> Option<Moment> {
        self.time.map(|time_s| Moment { time_s, animation: self.animation.clone() })
    }
}
