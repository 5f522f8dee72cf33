//! The program `umbrae`, as a library so that its tests and benchmarks call what its commands call.
//!
//! Start with [`cli`], which says what can be asked; each command has a module of its own:
//! [`render`], [`inspect`], [`sample`], [`sun`], [`doctor`], [`mod@bench`]. They share [`model`] (files into one scene), [`view`] (camera and ground), [`lights`]
//! [`render`], [`study`], [`inspect`], [`sample`], [`doctor`], [`mod@bench`]. They share [`model`] (files into one scene), [`view`] (camera and ground), [`lights`]
//! and [`area`] (lamps with a size), [`cast`] (who casts), [`cache`] (what was prepared before), [`verify`] (pictures against rays), [`show`] (pictures of how it works), [`report`] (JSON), [`output`] (files that are whole or absent) and [`talk`] (standard error).

pub mod area;
pub mod bench;
pub mod cache;
pub mod cast;
pub mod cli;
pub mod doctor;
pub mod extent;
pub mod inspect;
mod light_warnings;
pub mod lights;
pub mod model;
pub mod output;
pub mod parse;
mod random;
pub mod render;
pub mod report;
pub mod sample;
pub mod show;
pub mod smooth;
pub mod study;
pub mod sun;
pub mod talk;
pub mod verify;
pub mod view;

/// The README's code, compiled.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
