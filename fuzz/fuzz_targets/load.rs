//! Bytes that a fuzzer makes up, read as each format.
//!
//! The first byte chooses the format, the others are the file. Nothing may panic, hang or fill the memory:
//!
//! ```text
//! cargo +nightly fuzz run load -- -rss_limit_mb=1024 -timeout=5 -max_len=4096
//! ```

#![no_main]

use libfuzzer_sys::fuzz_target;
use umbrae_formats::{Format, LoadOptions, UpAxis, load_bytes};

fuzz_target!(|data: &[u8]| {
    let Some((&choice, bytes)) = data.split_first() else { return };
    let format = [
        Format::CityJson,
        Format::GeoJson,
        Format::GeoTiff,
        Format::Gltf,
        Format::Obj,
        Format::Ply,
        Format::Stl,
    ][usize::from(choice % 7)];
    let up = [None, Some(UpAxis::Y), Some(UpAxis::Z)][usize::from(choice / 7 % 3)];
    let _ = load_bytes(bytes, format, "fuzz", None, &LoadOptions { up, normals: true, ..LoadOptions::default() });
});
