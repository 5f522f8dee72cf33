//! Ctrl-C: what is finished is kept.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context as _;

/// A flag that is set from the first Ctrl-C on. Terminating and hanging up count as well.
///
/// # Errors
///
/// When the system does not let the program listen.
pub(super) fn when_interrupted() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("can't listen for Ctrl-C")?;
    Ok(stop)
}
