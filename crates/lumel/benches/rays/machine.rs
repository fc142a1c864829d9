//! What a benchmark ran on.

use lumel_accel::InstructionSet;

/// One line: processor, cores, instruction sets.
pub(crate) fn describe() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let line = info.lines().find(|line| line.starts_with(name));
        line.and_then(|line| line.split_once(':')).map(|(_, value)| value.trim().to_owned())
    };
    let model = field("model name").unwrap_or_else(|| "unknown processor".to_owned());
    let family = field("cpu family").map_or_else(String::new, |family| format!(" (family {family})"));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let sets: Vec<String> = InstructionSet::available().iter().map(ToString::to_string).collect();
    format!("lumel {} on {model}{family}, {cores} cores, {}", env!("CARGO_PKG_VERSION"), sets.join(", "))
}
