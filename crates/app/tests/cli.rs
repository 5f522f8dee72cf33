//! The program from outside, as a stranger or a script meets it: what it is given, what it says where, what it writes, how it ends.
//!
//! Every file it reads is made here, so these tests need no data.

#[path = "cli/bad_files.rs"]
mod bad_files;
#[path = "cli/bad_options.rs"]
mod bad_options;
#[path = "cli/bench.rs"]
mod bench;
#[path = "cli/cache.rs"]
mod cache;
#[path = "cli/casting.rs"]
mod casting;
#[path = "cli/cities.rs"]
mod cities;
#[path = "cli/files.rs"]
mod files;
#[path = "cli/independent.rs"]
mod independent;
#[path = "cli/lights.rs"]
mod lights;
#[path = "cli/memory.rs"]
mod memory;
#[path = "cli/moments.rs"]
mod moments;
#[path = "cli/odd_models.rs"]
mod odd_models;
#[path = "cli/outputs.rs"]
mod outputs;
#[path = "cli/report.rs"]
mod report;
#[path = "cli/shadows.rs"]
mod shadows;
#[path = "cli/show.rs"]
mod show;
#[path = "cli/smooth.rs"]
mod smooth;
#[path = "cli/stranger.rs"]
mod stranger;
#[path = "cli/sun.rs"]
mod sun;
