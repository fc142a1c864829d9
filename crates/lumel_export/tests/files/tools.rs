//! Programs that read our files, where they are installed.

use std::path::Path;
use std::process::Command;

/// Runs a program; `None`, with a line that says so, if it is not there. In CI it must be: `cargo x test` sees to it.
pub(crate) fn run_if_installed(program: &str, probe: &[&str], args: &[&str]) -> Option<String> {
    if !Command::new(program).args(probe).output().is_ok_and(|out| out.status.success()) {
        assert!(std::env::var_os("CI").is_none(), "CI must have {program}, run by `cargo x test`");
        println!("skipped: `{program} {}` does not work here", probe.join(" "));
        return None;
    }
    let out = Command::new(program).args(args).output().unwrap();
    let (stdout, stderr) = (String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
    assert!(out.status.success(), "{stdout}\n{stderr}");
    Some(stdout.into_owned())
}

/// Runs Python with NumPy as `np` and the file as `path`; `None` where there is none.
pub(crate) fn numpy(script: &str, path: &Path) -> Option<String> {
    let script = format!("import sys, numpy as np\npath = sys.argv[1]\n{script}");
    let path = path.to_str().unwrap();
    let python = std::env::var("LUMEL_PYTHON").unwrap_or_else(|_| "python3".into());
    run_if_installed(&python, &["-c", "import numpy"], &["-c", &script, path])
}
