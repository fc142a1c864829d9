//! The program in a real window: keys and mouse go through the X server, as a user's do.

// The window is opened on an X server, which other systems do not have.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::print_stdout, reason = "tests say why they are skipped")]

mod peer;
mod screen;

use peer::{Node, Peer};
use screen::{Screen, tools_or_skip};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The program in a window of 1280 by 720 points.
struct Window<'a> {
    screen: &'a Screen,
    program: Child,
    peer: Peer,
}

impl<'a> Window<'a> {
    fn open(screen: &'a Screen, home: &std::path::Path, arguments: &[&str]) -> Self {
        let address = peer::free_address();
        let program = Command::new(env!("CARGO_BIN_EXE_lumel-view"))
            .args(arguments)
            .env("DISPLAY", screen.display())
            .env("EGUI_INSPECTION", &address)
            .env("HOME", home)
            .env("XDG_DATA_HOME", home.join("data"))
            .env("WGPU_BACKEND", "vulkan")
            .env_remove("WAYLAND_DISPLAY")
            .current_dir(home)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let peer = Peer::connect(&address);
        let window = Self { screen, program, peer };
        screen.focus("lumel");
        window
    }

    /// Waits until something on the screen is so.
    fn wait_for(&mut self, what: &str, holds: impl Fn(&[Node]) -> bool) -> Vec<Node> {
        let begun = Instant::now();
        loop {
            let nodes = self.peer.nodes();
            if holds(&nodes) {
                return nodes;
            }
            let texts: Vec<&str> = nodes.iter().map(|n| n.text.as_str()).filter(|t| !t.is_empty()).collect();
            assert!(
                begun.elapsed() < Duration::from_secs(180),
                "waited for {what}; there is: {}",
                texts.join(" | ")
            );
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    fn wait_for_text(&mut self, start: &str) {
        self.wait_for(start, |nodes| nodes.iter().any(|n| n.text.starts_with(start)));
    }

    fn key(&self, keys: &str) {
        self.screen.xdotool(&["key", keys]);
    }

    /// Clicks what has this text, right of `x_min`.
    fn click(&mut self, text: &str, x_min: f64) {
        let fits = |n: &&Node| n.text == text && n.center[0] >= x_min;
        let nodes = self.wait_for(text, |nodes| nodes.iter().any(|n| fits(&n)));
        let [x, y] = nodes.iter().find(fits).unwrap().center.map(|v| v.round().to_string());
        self.screen.xdotool(&["mousemove", &x, &y]);
        // A user's hand is slower than a frame; a click belongs to where the mouse is when the frame ends.
        self.peer.nodes();
        self.screen.xdotool(&["click", "1"]);
        self.peer.nodes();
    }

    /// Writes a path into the dialog that is open, and does what the dialog is for.
    fn answer(&mut self, dialog: &str, path: &std::path::Path) {
        self.wait_for_text(dialog);
        self.key("ctrl+a");
        self.screen.xdotool(&["type", "--delay", "5", &path.to_string_lossy()]);
        self.key("Return");
    }

    /// The camera's z, from its panel.
    fn camera_z(&mut self) -> f64 {
        let nodes = self.wait_for("Camera z", |nodes| nodes.iter().any(|n| n.text == "Camera z"));
        nodes.iter().find(|n| n.text == "Camera z").and_then(|n| n.number).unwrap()
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        // After a failed assertion it still runs.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

#[test]
fn cornell_is_lit_saved_and_recalled_in_a_window() {
    let Some(screen) = tools_or_skip() else { return };
    let home = tempfile::tempdir().unwrap();
    let mut window = Window::open(&screen, home.path(), &["cornell-box", "--threads", "2"]);
    window.wait_for_text("Not solved");
    window.click("Draft", 900.0);
    window.wait_for("the draft preset", |nodes| nodes.iter().any(|n| n.text == "Draft" && n.is_on));

    window.screen.hover_picture();
    window.key("space");
    window.wait_for_text("Placed ceiling at the camera");
    window.key("Return");
    window.wait_for_text("Solved: sobol");
    let all = window.peer.screenshot();
    all.keep("window-all.png");
    // The light is in front of the open side: the left wall is red, the right one green.
    let left = all.mean([235, 220], [60, 200]);
    let right = all.mean([650, 220], [50, 200]);
    assert!(left[0] > 2.0 * left[1] && left[0] > 30.0, "{left:?}");
    assert!(right[1] > 1.5 * right[0] && right[1] > 30.0, "{right:?}");

    window.click("1", 250.0);
    window.wait_for("bounce 1 is chosen", |nodes| nodes.iter().any(|n| n.text == "1" && n.is_on));
    let bounce = window.peer.screenshot();
    bounce.keep("window-bounce-1.png");
    assert!(all.difference(&bounce, [220, 80], [500, 440]) > 5.0, "bounce 1 looks like all light");

    let file = home.path().join("cornell.npz");
    window.screen.hover_picture();
    window.key("k");
    window.answer("Save the solution", &file);
    window.wait_for_text("Saved the solution");
    let saved = lumel::Solution::load(&file).unwrap();
    assert_eq!((saved.bounces.len(), saved.meta.complete), (3, true));

    window.key("l");
    window.answer("Load a solution", &file);
    window.wait_for_text("Loaded cornell.npz");
    window.wait_for_text("Solved: cornell.npz");

    window.click("Camera", 900.0);
    let start = window.camera_z();
    window.screen.hover_picture();
    window.key("alt+3");
    window.wait_for_text("Saved camera, lights and settings to slot 3");
    window.screen.xdotool(&["keydown", "w", "sleep", "0.7", "keyup", "w"]);
    let moved = window.camera_z();
    assert!(moved > start + 0.01, "W flies forward, along +z: {start} -> {moved}");
    window.key("3");
    window.wait_for_text("Recalled slot 3");
    assert!((window.camera_z() - start).abs() < 1e-3, "3 goes back: {start}");

    window.key("ctrl+q");
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = window.program.try_wait().unwrap() {
            break status;
        }
        assert!(begun.elapsed() < Duration::from_secs(20), "the program does not quit");
        std::thread::sleep(Duration::from_millis(50));
    };
    assert!(status.success(), "{status}");
}

#[test]
fn without_a_display_the_program_says_what_to_do() {
    let output = Command::new(env!("CARGO_BIN_EXE_lumel-view"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.starts_with("error: there is no display") && text.contains("--screenshot"), "{text}");
}

#[test]
fn without_a_graphics_driver_the_program_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_lumel-view"))
        .args(["sphere", "--screenshot"])
        .arg(folder.path().join("a.png"))
        // No driver file, no driver.
        .env("VK_DRIVER_FILES", folder.path().join("none.json"))
        .env("VK_ICD_FILENAMES", folder.path().join("none.json"))
        .env("WGPU_BACKEND", "vulkan")
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("mesa-vulkan-drivers"), "{text}");
    assert!(!folder.path().join("a.png").exists());
}
