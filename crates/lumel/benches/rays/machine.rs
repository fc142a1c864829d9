//! What the results were measured on.

use serde_json::{Value, json};
use std::process::Command;

/// Instruction sets that matter to ray tracers, as Linux calls them.
const FLAGS: [&str; 7] = ["sse4_2", "avx2", "fma", "avx512f", "avx512vl", "avx512dq", "avx512bw"];

/// Processor, instruction sets, cores, compiler. Outside Linux, only the architecture of the processor is known.
pub(crate) fn describe() -> Value {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let line = info.lines().find(|line| line.split(':').next().is_some_and(|key| key.trim() == name));
        line.and_then(|line| Some(line.split_once(':')?.1.trim().to_owned()))
    };
    let flags = field("flags").unwrap_or_default();
    let flags: Vec<&str> = FLAGS.into_iter().filter(|flag| flags.split(' ').any(|f| f == *flag)).collect();
    let family = field("cpu family").zip(field("model")).map(|(f, m)| format!(" (family {f}, model {m})"));
    let processor = field("model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let rustc = Command::new("rustc").arg("--version").output();
    let rustc = rustc.map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned()).unwrap_or_default();
    json!({
        "processor": processor + &family.unwrap_or_default(),
        "flags": flags,
        "cores": std::thread::available_parallelism().map_or(1, usize::from),
        "system": std::env::consts::OS,
        "rustc": rustc,
        "version": env!("CARGO_PKG_VERSION"),
    })
}

/// The description in a line.
pub(crate) fn line(machine: &Value) -> String {
    let text = |key: &str| machine[key].as_str().unwrap_or_default().to_owned();
    let flags: Vec<&str> =
        machine["flags"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    format!(
        "lumel {}, {}, {} cores, {}, {}",
        text("version"),
        text("processor"),
        machine["cores"],
        flags.join(" "),
        text("rustc")
    )
}
