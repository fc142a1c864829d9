//! How often the light of a running solve is drawn.
//!
//! On a graphics device, and on any while the window is used: as often as there is more of it, twice a second. A
//! software renderer shares the processor with the solve; while nobody touches the window it draws so rarely that it
//! takes about a sixtieth of it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What is told within this time is shown in one frame.
pub(crate) const AT_ONCE: Duration = Duration::from_millis(8);

/// Sixty times the processor time of a frame of 1280 by 720 with new light on llvmpipe, about 0.1 s: the period at which
/// frames take a sixtieth of one core.
const SOFTWARE_PERIOD: Duration = Duration::from_secs(6);

/// So long after the last touch the window counts as used.
const USED: Duration = Duration::from_secs(2);

/// When frames were drawn, and how far apart they are to be.
#[derive(Debug)]
pub(crate) struct Rhythm {
    clock: Instant,
    /// Milliseconds of the clock at the last frame.
    drawn: AtomicU64,
    /// Milliseconds between frames that only show more of a bounce.
    period: AtomicU64,
    /// Milliseconds of the clock at the last touch.
    touched: AtomicU64,
}

impl Rhythm {
    /// A rhythm that begins now.
    pub(crate) fn new() -> Self {
        let zero = || AtomicU64::new(0);
        Self { clock: Instant::now(), drawn: zero(), period: zero(), touched: zero() }
    }

    fn now(&self) -> u64 {
        self.clock.elapsed().as_millis() as u64
    }

    /// Notes that a frame is drawn, by which kind of renderer, and whether the window was touched.
    pub(crate) fn frame(&self, software: bool, touched: bool) {
        let now = self.now();
        if touched {
            self.touched.store(now, Ordering::Relaxed);
        }
        let used = now.saturating_sub(self.touched.load(Ordering::Relaxed)) < USED.as_millis() as u64;
        let cores = std::thread::available_parallelism().map_or(1, usize::from) as u32;
        let period = if software && !used { SOFTWARE_PERIOD / cores } else { Duration::ZERO };
        self.period.store(period.as_millis() as u64, Ordering::Relaxed);
        self.drawn.store(now, Ordering::Relaxed);
    }

    /// How long more light of the bounce under way may wait to be drawn.
    pub(crate) fn until_next(&self) -> Duration {
        let due = self.drawn.load(Ordering::Relaxed) + self.period.load(Ordering::Relaxed);
        Duration::from_millis(due.saturating_sub(self.now())).max(AT_ONCE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_untouched_window_of_a_software_renderer_waits() {
        let rhythm = Rhythm::new();
        rhythm.frame(true, true);
        assert_eq!(rhythm.until_next(), AT_ONCE, "just touched");
        let rhythm = Rhythm { clock: Instant::now() - Duration::from_secs(10), ..Rhythm::new() };
        rhythm.frame(false, false);
        assert_eq!(rhythm.until_next(), AT_ONCE, "a graphics device");
        rhythm.frame(true, false);
        let cores = std::thread::available_parallelism().map_or(1, usize::from) as u32;
        let wait = rhythm.until_next();
        assert!(
            wait <= (SOFTWARE_PERIOD / cores).max(AT_ONCE) && wait >= (SOFTWARE_PERIOD / cores) / 2,
            "{wait:?}"
        );
    }
}
