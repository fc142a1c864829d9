//! A display without a monitor, and a user at it.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// An X server of its own.
pub(crate) struct Screen {
    server: Child,
    display: String,
}

/// The screen; `None` with the reason on the console where a test may be skipped.
pub(crate) fn tools_or_skip() -> Option<Screen> {
    let has = |program: &str| {
        Command::new(program).arg("-help").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
    };
    let missing: Vec<&str> = ["Xvfb", "xdotool"].into_iter().filter(|program| !has(program)).collect();
    if missing.is_empty() {
        return Some(Screen::start());
    }
    let text = format!("skipped: no {} (Debian packages xvfb, xdotool)", missing.join(", "));
    assert!(std::env::var_os("CI").is_none(), "CI must not skip: {text}");
    println!("{text}");
    None
}

impl Screen {
    fn start() -> Self {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x720x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Self { server, display: format!(":{}", number.trim()) }
    }

    pub(crate) fn display(&self) -> &str {
        &self.display
    }

    /// Does what a user does.
    pub(crate) fn xdotool(&self, arguments: &[&str]) {
        let output = Command::new("xdotool").args(arguments).env("DISPLAY", &self.display).output().unwrap();
        assert!(
            output.status.success(),
            "xdotool {arguments:?}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }

    /// Gives the keys to the window whose title contains this. There is no window manager that would.
    pub(crate) fn focus(&self, title: &str) {
        let begun = Instant::now();
        loop {
            let found = Command::new("xdotool")
                .args(["search", "--onlyvisible", "--name", title])
                .env("DISPLAY", &self.display)
                .output()
                .unwrap();
            let windows = String::from_utf8_lossy(&found.stdout).into_owned();
            if let Some(window) = windows.lines().next() {
                self.xdotool(&["windowfocus", "--sync", window]);
                return;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "there is no window \"{title}\"");
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Moves the mouse into the picture.
    pub(crate) fn hover_picture(&self) {
        self.xdotool(&["mousemove", "450", "480"]);
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
