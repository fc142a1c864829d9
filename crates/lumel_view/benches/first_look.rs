//! How soon after Enter there is a picture of all light, and how far that is from the finished one: `cargo x bench first_look`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

#[path = "../../lumel/benches/common/sponza.rs"]
mod sponza;

use eframe::egui::{Key, Modifiers};
use eframe::egui_wgpu::WgpuSetup;
use egui_kittest::Harness;
use glam::Vec3;
use lumel::{MaxEdge, OpenOptions, Preset, Scene, ScheduleKind, Settings};
use lumel_render_gpu::Gpu;
use lumel_scene::luminance;
use lumel_view::app::{App, StartUp};
use lumel_view::document::OpenRequest;
use lumel_view::lights::EditLight;
use lumel_view::selection::Selection;
use std::sync::Arc;
use std::time::{Duration, Instant};

const HELP: &str = "\
usage: cargo x bench first_look [SCENE]...

Opens scenes in the window without a display, 1280x720, presses Enter, and takes the time until all light can be seen in the
picture: by the clock, and the processor time until then (Linux only). The light of that picture, and what is shown at some
times later, is compared with that of the finished solve: the root mean square of the difference over the surfaces, relative
to that of the light, and by how many stops half and nine tenths of the lit surfaces are off at most. The clock is read
for some tries; in the first, the window is new, and later ones throw the light away that there is. The processor time is the least.

  SCENE   built-in scenes, scene files, or sponza (at 0.5 m); by default that
";

/// How often the time is taken.
const TRIES: usize = 3;

/// Seconds at which the picture is looked at again.
const LATER: [f64; 4] = [1.0, 2.0, 5.0, 10.0];

fn main() {
    // `cargo test --benches` only asks whether it runs.
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    if !names.iter().any(|argument| argument == "--bench") {
        return;
    }
    names.retain(|argument| argument != "--bench");
    if names.iter().any(|name| name == "--help") {
        return print!("{HELP}");
    }
    if names.is_empty() {
        names.push("sponza".to_owned());
    }
    for name in names {
        match request(&name) {
            Ok(request) => measure(&name, request),
            Err(reason) => println!("{name}: skipped, {reason}"),
        }
    }
}

fn request(name: &str) -> Result<OpenRequest, String> {
    if name != "sponza" {
        return Ok(OpenRequest::new(name));
    }
    let options = OpenOptions { max_edge: Some(MaxEdge::Length(0.5)), ..OpenOptions::default() };
    Ok(OpenRequest { name: sponza::file()?.to_string_lossy().into_owned(), options })
}

/// The window with a scene in it.
fn window(name: &str, request: OpenRequest, settings: &Settings) -> Harness<'static, App> {
    let start = StartUp { open: Some(request), ..StartUp::default() };
    let mut wgpu = egui_kittest::wgpu::default_wgpu_setup();
    if let WgpuSetup::CreateNew(new) = &mut wgpu {
        new.device_descriptor = Arc::new(Gpu::device_descriptor);
    }
    let builder = Harness::builder().with_size([1280.0, 720.0]).with_step_dt(1.0 / 60.0).wgpu_setup(wgpu);
    let mut window = builder.build_eframe(|cc| App::new(cc, start).unwrap());
    wait(&mut window, |app| app.session.document.is_some() && app.session.background_work().is_none());
    let session = &mut window.state_mut().session;
    session.settings = settings.clone();
    if name == "sponza" {
        session.lights.push(EditLight::new("course".to_owned(), sponza::light()));
    }
    window.run_steps(2);
    window
}

fn wait(window: &mut Harness<'static, App>, done: impl Fn(&App) -> bool) {
    while !done(window.state()) {
        std::thread::sleep(Duration::from_millis(2));
        window.run_steps(1);
    }
}

/// The light in the picture.
fn shown(app: &App) -> Vec<Vec3> {
    let mut light = app.session.selected_light(Selection::All);
    if let Some(unshot) = app.session.to_come() {
        unshot.add_to(&mut light);
    }
    light
}

/// The picture is there: it was drawn with this light, and read from the device.
fn read_picture(app: &App) {
    app.stage.as_ref().unwrap().picture().unwrap();
}

fn measure(name: &str, request: OpenRequest) {
    for schedule in [ScheduleKind::Gather, ScheduleKind::Shoot] {
        let settings = Settings { schedule, ..Preset::Medium.settings() };
        let (mut clocks, mut processor) = (Vec::new(), [f64::INFINITY; 3]);
        let mut window = window(name, request.clone(), &settings);
        for _ in 0..TRIES {
            let (clock, spent, _) = first_look(&mut window);
            clocks.push(clock);
            if spent.iter().sum::<f64>() < processor.iter().sum() {
                processor = spent;
            }
            window.state_mut().session.stop();
            wait(&mut window, |app| app.session.phase().is_none());
        }
        let vertices = window.state().session.document.as_ref().unwrap().scene.vertex_count();
        let [solving, drawing, rest] = processor;
        println!(
            "{name}, {vertices} vertices, {schedule:?}: all light after {clocks:.2?} s; processor time {solving:.2} s of solving, \
             {drawing:.2} s of the software renderer, {rest:.2} s of the rest"
        );
        let (clock, _, begun) = first_look(&mut window);
        let mut looks = vec![(clock, shown(window.state()))];
        for seconds in LATER {
            wait(&mut window, |app| {
                begun.elapsed().as_secs_f64() >= seconds || app.session.phase().is_none()
            });
            looks.push((begun.elapsed().as_secs_f64(), shown(window.state())));
        }
        wait(&mut window, |app| app.session.phase().is_none());
        let whole = begun.elapsed().as_secs_f64();
        window.run_steps(2);
        let (exact, areas) =
            (shown(window.state()), areas(&window.state().session.document.as_ref().unwrap().scene));
        for (seconds, light) in looks.iter().filter(|(seconds, _)| *seconds < whole) {
            let (off, [half, most]) = error(light, &exact, &areas);
            println!(
                "  {seconds:6.2} s: {:.1} % off; half within {half:.2} stops, nine tenths within {most:.2}",
                100.0 * off
            );
        }
        println!("  {whole:6.2} s: solved");
    }
}

/// Starts a solve from scratch and waits for a picture of all light; seconds by the clock and of processor time, and when it was started.
fn first_look(window: &mut Harness<'static, App>) -> (f64, [f64; 3], Instant) {
    // A software renderer may still be busy with what was to be seen before.
    window.run_steps(2);
    read_picture(window.state());
    let before = window.state().session.light_generation;
    let (begun, spent) = (Instant::now(), processor());
    window.key_press_modifiers(Modifiers::SHIFT, Key::Enter);
    window.run_steps(1);
    wait(window, |app| {
        let session = &app.session;
        session.light_generation > before && session.to_come().is_some_and(|unshot| unshot.seen.is_some())
    });
    // The step that has read the light has drawn it.
    read_picture(window.state());
    let seconds = begun.elapsed().as_secs_f64();
    let now = processor();
    (seconds, std::array::from_fn(|k| now[k] - spent[k]), begun)
}

/// Processor time so far of the threads that solve, of those of the software renderer, and of all others, seconds.
fn processor() -> [f64; 3] {
    let mut spent = [0.0; 3];
    for thread in std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten() {
        let read = |name: &str| std::fs::read_to_string(thread.path().join(name)).unwrap_or_default();
        let nanoseconds = read("schedstat").split(' ').next().and_then(|n| n.parse::<f64>().ok());
        let kind = match read("comm") {
            name if name.starts_with("solve") => 0,
            name if name.starts_with("llvmpipe") => 1,
            _ => 2,
        };
        spent[kind] += 1e-9 * nanoseconds.unwrap_or(0.0);
    }
    spent
}

/// A third of the area of all triangles around each vertex, m².
fn areas(scene: &Scene) -> Vec<f64> {
    let mut areas = vec![0.0; scene.vertex_count()];
    for corners in scene.triangles() {
        let [a, b, c] = corners.map(|v| scene.positions()[v as usize]);
        let area = f64::from((b - a).cross(c - a).length()) / 6.0;
        corners.iter().for_each(|&v| areas[v as usize] += area);
    }
    areas
}

/// The relative root mean square of a difference over the surfaces; and by how many stops half and nine tenths of the surfaces
/// that have a hundredth of the mean light are off at most.
fn error(light: &[Vec3], exact: &[Vec3], areas: &[f64]) -> (f64, [f64; 2]) {
    let luminance = |value: Vec3| f64::from(luminance(value));
    let square =
        |of: &dyn Fn(usize) -> f64| (0..areas.len()).map(|v| areas[v] * of(v).powi(2)).sum::<f64>().sqrt();
    let off = square(&|v| luminance(light[v]) - luminance(exact[v])) / square(&|v| luminance(exact[v]));
    let mean =
        (0..areas.len()).map(|v| areas[v] * luminance(exact[v])).sum::<f64>() / areas.iter().sum::<f64>();
    let lit = (0..areas.len()).filter(|&v| luminance(exact[v]) > 0.01 * mean);
    let stops = |v: usize| (luminance(light[v]).max(1e-9) / luminance(exact[v])).log2().abs();
    let mut stops: Vec<(f64, f64)> = lit.map(|v| (stops(v), areas[v])).collect();
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = stops.iter().map(|(_, area)| area).sum();
    let within = |share: f64| {
        let mut sum = 0.0;
        let at = stops.iter().find(|(_, area)| {
            sum += area;
            sum >= share * all
        });
        at.map_or(0.0, |(stops, _)| *stops)
    };
    (off, [within(0.5), within(0.9)])
}
