//! `umbrae doctor`: which adapters this machine has.

use std::fmt::Write as _;

use umbrae_render::{AdapterChoice, Gpu, Tier, adapter_labels};

use crate::output::write_to_stdout;

/// Prints the adapters, best first, what the first one can do, and what is missing.
///
/// # Errors
///
/// When there is no adapter, with the package to install.
pub fn run() -> anyhow::Result<()> {
    let gpu = pollster::block_on(Gpu::new(&AdapterChoice::default()))?;
    let labels = pollster::block_on(adapter_labels());
    let mut text = format!("umbrae {}\n", env!("CARGO_PKG_VERSION"));
    // Writing to a string can't fail.
    for (i, label) in labels.iter().enumerate() {
        let _ = writeln!(text, "adapter {}: {label}{}", i + 1, if i == 0 { "  (used by default)" } else { "" });
    }
    let tier = match gpu.caps.tier {
        Tier::Full => "full (compute, storage buffers, indirect draws)",
        Tier::Basic => "basic (neither compute nor storage buffers nor indirect draws)",
    };
    let _ = writeln!(text, "tier: {tier}");
    let _ = writeln!(text, "depth and stencil: {:?}", gpu.caps.depth_stencil_format);
    let _ = writeln!(
        text,
        "pass times: {}",
        if gpu.caps.has_timestamps { "measured on the device" } else { "not available" }
    );
    let _ = writeln!(text, "missing: {}", missing(&labels));
    write_to_stdout(text.as_bytes())
}

/// What would be better than the adapters that there are.
fn missing(labels: &[String]) -> &'static str {
    if labels.iter().all(|label| label.contains(", gl ")) {
        "a Vulkan driver; on Debian or Ubuntu, `apt install mesa-vulkan-drivers` gives one"
    } else if labels.iter().all(|label| label.contains(", software, ")) {
        "nothing that is needed; the driver of a graphics card would draw the same faster"
    } else {
        "nothing"
    }
}
