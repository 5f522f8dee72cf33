//! Soft shadows against closed forms and rays.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod curved;
#[path = "../held_to_webgl2/mod.rs"]
mod held_to_webgl2;
mod lamps;
mod seams;
mod stage;
mod sun;
mod tiers;
