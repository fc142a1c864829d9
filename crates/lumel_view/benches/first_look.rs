//! How soon after Enter there is a picture of all light, and how far that is from the finished one: `cargo x bench first_look`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

#[path = "../../lumel/benches/common/sponza.rs"]
mod sponza;

use cpu_time::ProcessTime;
use eframe::egui::Key;
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
picture: by the clock, and the processor time of all threads until then. The light of that picture, and what is shown at some
times later, is compared with that of the finished solve: the root mean square of the difference over the surfaces, relative
to that of the light, and by how many stops half and nine tenths of the lit surfaces are off at most. The clock is the best of some
tries.

  SCENE   built-in scenes, scene files, or sponza (at 0.5 m); by default that
";

/// How often the time is taken.
const TRIES: usize = 5;

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
        let (mut best, mut processor) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..TRIES {
            let mut window = window(name, request.clone(), &settings);
            let (clock, spent, _) = first_look(&mut window);
            (best, processor) = (best.min(clock), processor.min(spent));
            window.state_mut().session.stop();
            wait(&mut window, |app| app.session.phase().is_none());
        }
        let mut window = window(name, request.clone(), &settings);
        let vertices = window.state().session.document.as_ref().unwrap().scene.vertex_count();
        println!(
            "{name}, {vertices} vertices, {schedule:?}: all light after {best:.2} s, {processor:.2} s of processor time"
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

/// Presses Enter and waits for a picture of all light; seconds by the clock and of processor time, and when Enter was pressed.
fn first_look(window: &mut Harness<'static, App>) -> (f64, f64, Instant) {
    let (begun, processor) = (Instant::now(), ProcessTime::now());
    window.key_press(Key::Enter);
    window.run_steps(1);
    wait(window, |app| app.session.to_come().is_some());
    window.run_steps(1);
    read_picture(window.state());
    (begun.elapsed().as_secs_f64(), processor.elapsed().as_secs_f64(), begun)
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
