//! What the program costs: memory, and the time of a frame; and how often frames come while they follow each other.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// How often memory is read.
const PERIOD: Duration = Duration::from_secs(1);

/// Share of the newest frame in the mean.
const FRESH: f32 = 0.2;

/// Frames are counted over this time.
const COUNTED: Duration = Duration::from_secs(1);

/// Frames follow each other if there were so many of them: fewer were drawn because something changed now and then.
const IN_A_ROW: usize = 8;

/// The numbers at the end of the status bar.
#[derive(Debug, Default)]
pub struct Gauges {
    /// Mean time of the last frames, seconds.
    frame: Option<f32>,
    /// Memory of this process, bytes.
    memory: Option<u64>,
    read: Option<Instant>,
    /// When the last frames were drawn.
    drawn: VecDeque<Instant>,
}

impl Gauges {
    /// Notes how long the last frame took, seconds, and reads the memory now and then.
    pub fn update(&mut self, frame: Option<f32>) {
        self.count(Instant::now());
        if let Some(frame) = frame {
            self.frame = Some(self.frame.map_or(frame, |mean| mean + FRESH * (frame - mean)));
        }
        if self.read.is_none_or(|read| read.elapsed() > PERIOD) {
            (self.memory, self.read) = (resident(), Some(Instant::now()));
        }
    }

    fn count(&mut self, now: Instant) {
        self.drawn.push_back(now);
        while self.drawn.front().is_some_and(|&drawn| now.duration_since(drawn) > COUNTED) {
            self.drawn.pop_front();
        }
    }

    /// Frames per second, while they follow each other.
    fn rate(&self) -> Option<f64> {
        let passed = self.drawn.back()?.duration_since(*self.drawn.front()?);
        (self.drawn.len() >= IN_A_ROW).then(|| (self.drawn.len() - 1) as f64 / passed.as_secs_f64())
    }

    /// All of it in words, as far as it is known.
    pub fn texts(&self) -> impl Iterator<Item = String> {
        let memory = self.memory.map(bytes);
        let frame = self.frame.map(|frame| format!("{:.0} ms", (1e3 * frame).max(1.0)));
        let rate = self.rate().map(|rate| format!("{rate:.0} fps"));
        memory.into_iter().chain(frame).chain(rate)
    }
}

/// Memory that this process has, bytes, where the system tells.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? << 10)
}

fn bytes(n: u64) -> String {
    let mib = n as f64 / f64::from(1 << 20);
    if mib < 1000.0 { format!("{mib:.0} MiB") } else { format!("{:.1} GiB", mib / 1024.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_follow_each_other_are_counted() {
        let mut gauges = Gauges::default();
        let begun = Instant::now();
        (0..200).for_each(|k| gauges.count(begun + k * Duration::from_millis(25)));
        assert_eq!(gauges.texts().collect::<Vec<_>>(), ["40 fps"]);
        (1..4).for_each(|k| gauges.count(begun + Duration::from_secs(5 + k)));
        assert_eq!(gauges.rate(), None);
    }

    #[test]
    fn the_mean_follows_the_frames() {
        let mut gauges = Gauges::default();
        gauges.update(Some(0.02));
        (0..50).for_each(|_| gauges.update(Some(0.05)));
        assert!(gauges.texts().any(|text| text == "50 ms"));
        assert_eq!([1 << 20, 1 << 30].map(bytes), ["1 MiB", "1.0 GiB"]);
    }
}
