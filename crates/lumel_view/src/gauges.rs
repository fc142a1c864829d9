//! What the program costs: memory, and the time of a frame.

use std::time::{Duration, Instant};

/// How often memory is read.
const PERIOD: Duration = Duration::from_secs(1);

/// Share of the newest frame in the mean.
const FRESH: f32 = 0.2;

/// The numbers at the end of the status bar.
#[derive(Debug, Default)]
pub struct Gauges {
    /// Mean time of the last frames, seconds.
    frame: Option<f32>,
    /// Memory of this process, bytes.
    memory: Option<u64>,
    read: Option<Instant>,
}

impl Gauges {
    /// Notes how long the last frame took, seconds, and reads the memory now and then.
    pub fn update(&mut self, frame: Option<f32>) {
        if let Some(frame) = frame {
            self.frame = Some(self.frame.map_or(frame, |mean| mean + FRESH * (frame - mean)));
        }
        if self.read.is_none_or(|read| read.elapsed() > PERIOD) {
            (self.memory, self.read) = (resident(), Some(Instant::now()));
        }
    }

    /// Both in words, as far as they are known.
    pub fn texts(&self) -> impl Iterator<Item = String> {
        let memory = self.memory.map(bytes);
        let frame = self.frame.map(|frame| format!("{:.0} ms", (1e3 * frame).max(1.0)));
        memory.into_iter().chain(frame)
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
    fn the_mean_follows_the_frames() {
        let mut gauges = Gauges::default();
        gauges.update(Some(0.02));
        (0..50).for_each(|_| gauges.update(Some(0.05)));
        assert_eq!(gauges.texts().last(), Some("50 ms".to_owned()));
        assert_eq!([1 << 20, 1 << 30].map(bytes), ["1 MiB", "1.0 GiB"]);
    }
}
