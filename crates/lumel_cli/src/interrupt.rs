//! Ctrl-C and requests to terminate.

use crate::console::Console;
use crate::outcome::Outcome;
use anyhow::Context;
use lumel::Control;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// From now on, what would make a file longer than the limit of the process fails with an error, which names the file. The
/// signal that comes with it would end the program.
#[cfg(unix)]
pub(crate) fn outlive_file_size_limits() {
    // Without a handler the limit ends the program, as it does others.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::new(AtomicBool::new(false)));
}

/// There are no such limits.
#[cfg(not(unix))]
pub(crate) fn outlive_file_size_limits() {}

/// Requests of the user to stop.
///
/// While a caller heeds them, the first signal only requests a stop; otherwise, and for the second signal, the program
/// ends.
#[derive(Clone, Default)]
pub(crate) struct Interrupt(Arc<Flags>);

#[derive(Default)]
struct Flags {
    control: Control,
    picture: AtomicBool,
    requested: AtomicBool,
    heeded: AtomicBool,
}

impl Interrupt {
    /// Starts to listen for signals.
    pub(crate) fn listen(console: &Arc<Console>) -> anyhow::Result<Self> {
        let interrupt = Self::default();
        let (flags, console) = (Arc::clone(&interrupt.0), Arc::clone(console));
        let on_signal = move || {
            let again = flags.requested.swap(true, Ordering::SeqCst);
            if again || !flags.heeded.load(Ordering::SeqCst) {
                console.note("stopped");
                std::process::exit(i32::from(Outcome::Cancelled.exit_code()));
            }
            flags.control.cancel();
            flags.picture.store(true, Ordering::SeqCst);
            console.note("stopping; press again to stop at once");
        };
        ctrlc::set_handler(on_signal).context("cannot listen to Ctrl-C")?;
        Ok(interrupt)
    }

    /// The control of measurements.
    pub(crate) fn control(&self) -> &Control {
        &self.0.control
    }

    /// The flag that stops drawing.
    pub(crate) fn picture(&self) -> &AtomicBool {
        &self.0.picture
    }

    /// Whether to stop.
    pub(crate) fn is_requested(&self) -> bool {
        self.0.requested.load(Ordering::SeqCst)
    }

    /// Until the result is dropped, the caller checks the flags.
    pub(crate) fn heed(&self) -> Heeding<'_> {
        self.0.heeded.store(true, Ordering::SeqCst);
        Heeding(&self.0)
    }
}

/// A caller checks the flags.
pub(crate) struct Heeding<'a>(&'a Flags);

impl Drop for Heeding<'_> {
    fn drop(&mut self) {
        self.0.heeded.store(false, Ordering::SeqCst);
    }
}
