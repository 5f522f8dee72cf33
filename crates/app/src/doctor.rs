//! `umbrae doctor`: which adapters this machine has.

use std::io::Write as _;

use umbrae_render::{AdapterChoice, Gpu, adapter_labels};

/// Prints the adapters, best first, and what the first one can do.
///
/// # Errors
///
/// When there is no adapter, with the package to install.
pub fn run() -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "umbrae {}", env!("CARGO_PKG_VERSION"))?;
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))?;
    for (i, label) in pollster::block_on(adapter_labels()).iter().enumerate() {
        writeln!(out, "adapter {}: {label}{}", i + 1, if i == 0 { "  (used by default)" } else { "" })?;
    }
    writeln!(out, "tier: {:?}", gpu.caps.tier)?;
    writeln!(out, "depth and stencil: {:?}", gpu.caps.depth_stencil_format)?;
    writeln!(out, "pass times: {}", if gpu.caps.has_timestamps { "measured on the device" } else { "not available" })?;
    Ok(())
}
