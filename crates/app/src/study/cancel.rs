//! Ctrl-C: what is finished is kept.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context as _;

/// The exit code of what was interrupted: 128 and the signal's number.
const INTERRUPTED: i32 = 130;

/// A flag that is set from the first Ctrl-C on; the second ends the program at once. Terminating and hanging up count as well.
///
/// # Errors
///
/// When the system does not let the program listen.
pub(super) fn when_interrupted() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let listen = move || {
        if flag.swap(true, Ordering::Relaxed) {
            #[expect(
                clippy::disallowed_methods,
                reason = "no result has its name yet, and the next study clears away what is half written"
            )]
            std::process::exit(INTERRUPTED);
        }
    };
    ctrlc::set_handler(listen).context("can't listen for Ctrl-C")?;
    Ok(stop)
}
