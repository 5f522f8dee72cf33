//! Soft shadows against closed forms and rays.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod lamps;
mod seams;
mod stage;
mod sun;
