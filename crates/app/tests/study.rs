//! `umbrae study` from outside: what it writes, read again by other means than wrote it; how it ends; how it goes on.
//!
//! Every file it reads is made here, so these tests need no data.

#[path = "study/bad_input.rs"]
mod bad_input;
#[path = "study/compared.rs"]
mod compared;
#[path = "study/disc.rs"]
mod disc;
#[path = "cli/files.rs"]
#[expect(dead_code, reason = "the tests of the command line need more of it")]
mod files;
#[path = "study/outputs.rs"]
mod outputs;
#[path = "study/stopped.rs"]
mod stopped;
#[path = "study/studied.rs"]
mod studied;
