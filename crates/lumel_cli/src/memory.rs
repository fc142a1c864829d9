//! The memory that the program takes, where the system tells.

use crate::console::Console;
use lumel::{Baker, Lumels, Memory};
use std::fs;

/// The file in which Linux tells a process about itself.
const STATUS: &str = "/proc/self/status";

/// What a picture takes until it is written, bytes: 960 by 720 pixels.
const PICTURE: u64 = 20 << 20;

/// What allocating costs, as a share of what is allocated, about.
const OVERHEAD: u64 = 20;

/// Says before a bake how much memory it needs, and returns it.
///
/// Where the system does not tell what the scene takes, only what comes on top is said.
pub(crate) fn announce(
    baker: &Baker,
    lumels: Option<&Lumels>,
    draws: bool,
    console: &Console,
) -> Option<Memory> {
    let to_come = baker.memory_to_come(lumels).0 + if draws { PICTURE } else { 0 };
    let to_come = Memory(to_come + to_come / OVERHEAD);
    // What was taken and freed is taken again first.
    let needed = in_use().zip(peak()).map(|(now, peak)| Memory(now.0 + to_come.0).max(peak));
    console.note(&match needed {
        Some(needed) => format!("needs about {needed} of memory"),
        None => format!("needs about {to_come} of memory beyond what the scene takes"),
    });
    needed
}

/// What the program takes now.
fn in_use() -> Option<Memory> {
    told("VmRSS:")
}

/// The most that it has taken so far.
pub(crate) fn peak() -> Option<Memory> {
    told("VmHWM:")
}

fn told(name: &str) -> Option<Memory> {
    read(&fs::read_to_string(STATUS).ok()?, name)
}

/// A line such as `VmHWM:     9172 kB`, whose unit has 1024 bytes.
fn read(status: &str, name: &str) -> Option<Memory> {
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let number: u64 = line.trim().strip_suffix("kB")?.trim_end().parse().ok()?;
    Some(Memory(number << 10))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_tells_is_understood() {
        let status = "Name:\tlumel\nVmPeak:\t  123456 kB\nVmHWM:\t    9172 kB\nVmRSS:\t     100 kB\n";
        assert_eq!(read(status, "VmHWM:"), Some(Memory(9172 << 10)));
        assert_eq!(read(status, "VmRSS:"), Some(Memory(100 << 10)));
        assert_eq!(read(status, "VmSwap:"), None);
        assert_eq!(read("VmRSS: much\n", "VmRSS:"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn linux_tells_it() {
        // Other tests take memory at the same time: the peak is asked for last.
        let now = in_use().unwrap();
        assert!(now > Memory(0) && peak().unwrap() >= now);
    }
}
