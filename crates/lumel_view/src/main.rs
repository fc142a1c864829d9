//! `lumel-view`: the window, or a picture without one.

use clap::Parser;
use eframe::egui::ViewportBuilder;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup};
use lumel_view::app::{APP_ID, App, StartUp};
use lumel_view::cli::Cli;
use lumel_view::theme::Ground;
use lumel_view::{event_loop, instance, screenshot};
use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// The window's size at first, points; it is remembered.
const WINDOW_SIZE: [f32; 2] = [1280.0, 720.0];
const MIN_WINDOW_SIZE: [f32; 2] = [1000.0, 560.0];

fn main() -> ExitCode {
    let cli = Cli::parse();
    // Messages of libraries, if anybody asks for them with RUST_LOG; what matters is told anyway.
    let _ = env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("off")).try_init();
    match run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // A closed standard error is no reason to panic.
            let _ = writeln!(std::io::stderr(), "error: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run(cli: &Cli) -> anyhow::Result<()> {
    match (&cli.screenshot, cli.request()) {
        (Some(path), Some(request)) => screenshot::without_window(&request, &cli.picture, path),
        _ => window(cli),
    }
}

fn window(cli: &Cli) -> anyhow::Result<()> {
    instance::check_display()?;
    let viewport = ViewportBuilder::default()
        .with_inner_size(WINDOW_SIZE)
        .with_min_inner_size(MIN_WINDOW_SIZE)
        .with_title("lumel")
        .with_app_id(APP_ID)
        .with_drag_and_drop(true);
    let mut wgpu = WgpuConfiguration::default();
    if let WgpuSetup::CreateNew(setup) = &mut wgpu.wgpu_setup {
        setup.device_descriptor = Arc::new(lumel_render_gpu::Gpu::device_descriptor);
    }
    let options = eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: wgpu,
        // The window has no gradients outside the picture, which is drawn undithered.
        dithering: false,
        ..eframe::NativeOptions::default()
    };
    let start = StartUp {
        open: cli.request(),
        data_folder: eframe::storage_dir(APP_ID).map(|folder| folder.join("unsaved")),
        picture_folder: screenshot::default_folder(),
        threads: cli.threads,
        ground: Ground::Window,
        quit: Arc::default(),
        shows_gauges: true,
        numpad: Arc::default(),
    };
    let (quit, numpad) = (Arc::clone(&start.quit), Arc::clone(&start.numpad));
    let create = move |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, Box<dyn std::error::Error + Send + Sync>> {
        let ctx = cc.egui_ctx.clone();
        // Without a handler the program dies at once, and what was done since the last bounce with it.
        let handler = ctrlc::set_handler(move || {
            quit.store(true, Ordering::Relaxed);
            ctx.request_repaint();
        });
        if let Err(error) = handler {
            log::warn!("Ctrl-C will not keep unsaved work: {error}");
        }
        Ok(Box::new(App::new(cc, start)?))
    };
    event_loop::run(APP_ID, options, Box::new(create), numpad)
        .map_err(|error| anyhow::anyhow!("cannot open a window: {error}\n  hint: {}", instance::WINDOW_HINT))
}
