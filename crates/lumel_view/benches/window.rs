//! What the window costs: processor time per frame, frames per second while a light changes that all bounces follow and while
//! waves run over all surfaces, and how much an open, idle window slows a solve.
//!
//! `cargo x bench window`, with `--ripple` for the waves alone; Linux only: needs Xvfb, xdotool and `/proc`. Solves with and without the window alternate, so that other work
//! on the machine falls on both.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

#[path = "../tests/window/peer.rs"]
#[allow(dead_code, reason = "the test in a window uses the rest")]
mod peer;
#[path = "../tests/window/screen.rs"]
#[allow(dead_code, reason = "the test in a window uses the rest")]
mod screen;

use lumel::{Baker, Bvh, Control, OpenOptions, Settings, Silent, SolveState};
use peer::Peer;
use screen::{Screen, tools_or_skip};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

const SCENE: &str = "cornell-box";
const SAMPLES: u32 = 16384;
const ROUNDS: usize = 3;

struct Window {
    program: Child,
    peer: Peer,
}

impl Window {
    fn open(screen: &Screen, home: &Path, samples: u32) -> Self {
        Self::with_settings(screen, home, &format!("indirect_samples = {samples}"))
    }

    fn with_settings(screen: &Screen, home: &Path, settings: &str) -> Self {
        let project = home.join("bench.lumel.toml");
        let text = format!("builtin = \"{SCENE}\"\n[bake]\n{settings}\n");
        std::fs::write(&project, text).unwrap();
        let address = peer::free_address();
        let program = Command::new(env!("CARGO_BIN_EXE_lumel-view"))
            .arg(&project)
            .env("DISPLAY", screen.display())
            .env("EGUI_INSPECTION", &address)
            .env("HOME", home)
            .env("XDG_DATA_HOME", home.join("data"))
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut window = Self { program, peer: Peer::connect(&address) };
        screen.focus("lumel");
        screen.hover_picture();
        window.wait_for("Not solved");
        window
    }

    /// Waits for a text; each look costs a frame, so there are few.
    fn wait_for(&mut self, start: &str) -> String {
        loop {
            if let Some(node) = self.peer.nodes().into_iter().find(|n| n.text.starts_with(start)) {
                return node.text;
            }
            std::thread::sleep(Duration::from_secs(2));
        }
    }

    /// What the status bar says.
    fn look(&mut self) -> String {
        let is_status = |text: &str| ["Live:", "Solved:", "Lights have"].iter().any(|s| text.starts_with(s));
        self.peer.nodes().into_iter().map(|node| node.text).find(|text| is_status(text)).unwrap_or_default()
    }

    /// Where something is that has a number and this text.
    fn center(&mut self, text: &str) -> [f64; 2] {
        let nodes = self.peer.nodes();
        nodes.into_iter().find(|node| node.text == text && node.number.is_some()).unwrap().center
    }

    /// Brings a panel to the front; returns where its tab is.
    fn open_tab(&mut self, screen: &Screen, name: &str) -> [f64; 2] {
        // The tab is above what else has its name.
        let named = self.peer.nodes().into_iter().filter(|node| node.text == name).map(|node| node.center);
        let tab = named.min_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
        click(screen, tab);
        tab
    }

    /// Processor time of the program so far, in ticks of a hundredth of a second.
    fn ticks(&self) -> u64 {
        ticks(Path::new(&format!("/proc/{}/stat", self.program.id())), "")
    }

    /// That of its threads whose names contain this.
    fn ticks_of(&self, name: &str) -> u64 {
        let threads = std::fs::read_dir(format!("/proc/{}/task", self.program.id())).unwrap();
        threads.flatten().map(|thread| ticks(&thread.path().join("stat"), name)).sum()
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn click(screen: &Screen, at: [f64; 2]) {
    let [x, y] = at.map(|at| format!("{at:.0}"));
    screen.xdotool(&["mousemove", &x, &y, "click", "1"]);
}

/// Processor time of a process or thread, unless its name does not contain `name`.
fn ticks(stat: &Path, name: &str) -> u64 {
    let stat = std::fs::read_to_string(stat).unwrap_or_default();
    let Some((_, numbers)) = stat.rsplit_once(')').filter(|(head, _)| head.contains(name)) else { return 0 };
    let fields: Vec<&str> = numbers.split_whitespace().collect();
    [11, 12].into_iter().filter_map(|i| fields.get(i)?.parse::<u64>().ok()).sum()
}

/// Seconds of a solve without a window, from the basis on, as the window counts them.
fn without_window() -> f64 {
    let (scene, _) = lumel::open(SCENE, &OpenOptions::default()).unwrap().builder.build().unwrap();
    let scene = Arc::new(scene);
    let tracer = Arc::new(Bvh::build(&scene));
    let settings = Settings { indirect_samples: SAMPLES, ..Settings::default() };
    let begun = Instant::now();
    let baker = Baker::with_tracer(scene, tracer, settings);
    baker.run(&mut SolveState::new(), &Control::default(), &Silent).unwrap();
    begun.elapsed().as_secs_f64()
}

/// Seconds of a solve beside a window, and processor time of the software renderer's threads meanwhile.
fn with_window(screen: &Screen) -> (f64, f64) {
    let home = tempfile::tempdir().unwrap();
    let mut window = Window::open(screen, home.path(), SAMPLES);
    let before = window.ticks_of("llvmpipe");
    screen.xdotool(&["key", "Return"]);
    std::thread::sleep(Duration::from_secs(20));
    let text = window.wait_for("Solved:");
    let drawing = (window.ticks_of("llvmpipe") - before) as f64 / 100.0;
    (text.rsplit(" in ").next().and_then(|s| s.strip_suffix(" s")?.parse().ok()).unwrap(), drawing)
}

fn frames(screen: &Screen) {
    const FRAMES: u64 = 60;
    let home = tempfile::tempdir().unwrap();
    let mut window = Window::open(screen, home.path(), SAMPLES);
    std::thread::sleep(Duration::from_secs(5));
    let before = window.ticks();
    (0..FRAMES).for_each(|_| drop(window.peer.nodes()));
    let frame = 10.0 * (window.ticks() - before) as f64 / FRAMES as f64;
    println!("a frame in which the picture stays, 1280x720: {frame:.0} ms of processor time");
    let before = window.ticks();
    std::thread::sleep(Duration::from_secs(5));
    println!("an idle window: {} ms of processor time in 5 s", 10 * (window.ticks() - before));
}

/// Frames per second while the size of the light is dragged and its light follows.
///
/// Each question for what is on the screen is answered by a frame, and building that answer takes time too: without
/// being asked, the window draws at least as often.
fn following(screen: &Screen) {
    const PERIOD: Duration = Duration::from_secs(10);
    let home = tempfile::tempdir().unwrap();
    let mut window = Window::open(screen, home.path(), Settings::default().indirect_samples);
    screen.xdotool(&["key", "Return"]);
    window.wait_for("Solved:");
    window.open_tab(screen, "Lights");
    window.wait_for("Size u");
    let [x, y] = window.center("Size u");
    let at = |x: f64| format!("{x:.0}");
    screen.xdotool(&["mousemove", &at(x), &at(y), "mousedown", "1"]);
    let (lights, mut frames) = (window.look(), 0);
    // A mouse tells a hundred times a second where it is.
    let moves: Vec<String> = (0..100 * PERIOD.as_secs())
        .flat_map(|step| {
            let sway = 40.0 * (0.03 * step as f64).sin();
            ["mousemove".to_owned(), at(x + sway), at(y), "sleep".to_owned(), "0.01".to_owned()]
        })
        .collect();
    let moves: Vec<&str> = moves.iter().map(String::as_str).collect();
    let begun = Instant::now();
    std::thread::scope(|scope| {
        scope.spawn(|| screen.xdotool(&moves));
        while begun.elapsed() < PERIOD {
            frames += 1;
            window.peer.nodes();
        }
    });
    let per_second = f64::from(frames) / begun.elapsed().as_secs_f64();
    let status = window.look();
    screen.xdotool(&["mouseup", "1"]);
    assert!(status.starts_with("Live:") && lights.starts_with("Solved:"), "{lights} | {status}");
    println!("while a light is dragged: at least {per_second:.1} frames per second; {status}");
}

/// Frames per second while waves run over all surfaces of the solved box, as the status bar has them: nobody asks for frames.
fn rippling(screen: &Screen) {
    const PERIOD: Duration = Duration::from_secs(3);
    let home = tempfile::tempdir().unwrap();
    let mut window = Window::with_settings(screen, home.path(), "directional = \"sh1\"");
    screen.xdotool(&["key", "Return"]);
    window.wait_for("Solved:");
    let tab = window.open_tab(screen, "Scene");
    let [x, y] = [tab[0], tab[1] + 100.0].map(|at| format!("{at:.0}"));
    screen.xdotool(&["mousemove", &x, &y, "click", "--repeat", "20", "5"]);
    for material in ["white", "red", "green"] {
        let name = format!("Ripple of {material}");
        // A busy machine takes a while to scroll and to switch.
        while let node = window.peer.nodes().into_iter().find(|node| node.text == name)
            && !node.as_ref().is_some_and(|node| node.is_on)
        {
            if let Some(node) = node {
                click(screen, node.center);
            }
            std::thread::sleep(Duration::from_secs(1));
        }
    }
    screen.hover_picture();
    let (mut rates, mut costs) = (Vec::new(), Vec::new());
    for _ in 0..5 {
        let before = window.ticks();
        std::thread::sleep(PERIOD);
        let spent = 0.01 * (window.ticks() - before) as f64;
        let texts = window.peer.nodes().into_iter().map(|node| node.text);
        rates.extend(texts.filter_map(|text| text.strip_suffix(" fps")?.parse::<f64>().ok()));
        costs.push(spent / PERIOD.as_secs_f64());
    }
    println!(
        "while waves run: {:.0} frames per second in the median, {:.2} cores busy",
        median(&mut rates),
        median(&mut costs)
    );
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    // `cargo test --benches` only asks whether it runs.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let Some(screen) = tools_or_skip() else { return };
    if std::env::args().any(|argument| argument == "--ripple") {
        return rippling(&screen);
    }
    frames(&screen);
    rippling(&screen);
    following(&screen);
    let (mut without, mut with, mut ratios, mut drawn) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        let a = without_window();
        let (b, drawing) = with_window(&screen);
        println!("round {round}: {a:.2} s without, {b:.2} s with an idle window, drawing {drawing:.2} s");
        without.push(a);
        with.push(b);
        ratios.push(b / a);
        drawn.push(drawing);
    }
    let ratio = median(&mut ratios);
    println!(
        "{SCENE}, {SAMPLES} rays, 4 bounces: {:.2} s without, {:.2} s with an idle window; median ratio {ratio:.3}; \
         {:.2} s of processor time went to the software renderer",
        median(&mut without),
        median(&mut with),
        median(&mut drawn)
    );
}
