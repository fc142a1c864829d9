//! Settings and progress of the solve.

use crate::app::App;
use crate::dialogs::Dialog;
use crate::input::Command;
use crate::prefs::{MAX_BOUNCES, MAX_DIRECT, MAX_INDIRECT};
use crate::session::Computed;
use crate::theme;
use crate::widgets::{check, choice, heading, number, primary_button, row, slider};
use eframe::egui::{Button, DragValue, RichText, Slider, Ui};
use lumel::{
    BasisKind, BounceLimit, EmitterSampling, LightSampling, Preset, SamplerKind, Settings, Share, Tail,
    TargetError,
};
use std::ops::RangeInclusive;

/// What the bounces slider offers when it is switched back from "until converged".
const DEFAULT_BOUNCES: u32 = 4;

/// The error that a solve stops at, when it is switched on.
const DEFAULT_ERROR: f32 = 0.02;

/// Least width of the row with the presets.
const PRESETS_WIDTH: f32 = 240.0;

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    buttons(app, ui);
    let settings = &mut app.session.settings;
    presets(ui, settings);
    samples(ui, settings);
    bounces(ui, settings);
    target(ui, settings);
    ui.collapsing("More", |ui| more(ui, settings));
    live(app, ui);
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Save solution...").clicked() {
            app.dialogs.open(Dialog::save_solution(&app.session));
        }
        if ui.button("Load solution...").clicked() {
            app.dialogs.open(Dialog::load_solution(&app.session));
        }
        let unknown = |c: &Computed| c.complete && c.solved.is_some() && c.accuracy().is_none();
        let ready = app.session.computed().is_some_and(unknown);
        let button = ui.add_enabled(ready && !app.session.is_solving(), Button::new("Measure standard error"));
        let hint = "Measures the light at every vertex again with eight independent sets of samples; takes about as \
                    long as the solve. It is the error of sampling there, not of the light that is gathered.";
        if button.on_hover_text(hint).clicked() {
            app.session.measure_standard_error();
        }
    });
}

/// Whether the light follows the hand.
fn live(app: &mut App, ui: &mut Ui) {
    let obstacle = app.session.obstacle_to_live();
    ui.horizontal_wrapped(|ui| {
        let hint = "While lights are moved, sized or coloured and materials painted, light and all bounces of it follow \
                    at once. The stored hemisphere rays are used again.";
        ui.checkbox(&mut app.session.live, "Light follows changes").on_hover_text(hint);
        if let Some(obstacle) = obstacle.filter(|_| app.session.live) {
            ui.label(RichText::new(obstacle).color(theme::WEAK));
        }
    });
}

fn buttons(app: &mut App, ui: &mut Ui) {
    let ctx = ui.ctx().clone();
    ui.horizontal(|ui| {
        let width = ui.available_width();
        if app.session.phase().is_some() {
            if ui.add_sized([width, 30.0], Button::new(RichText::new("Stop").strong())).clicked() {
                app.run(Command::Stop, &ctx);
            }
            return;
        }
        let text = if app.session.can_go_on() { "Go on" } else { "Solve" };
        if primary_button(ui, text, width).on_hover_text("Enter").clicked() {
            app.run(Command::Solve, &ctx);
        }
    });
}

fn presets(ui: &mut Ui, settings: &mut Settings) {
    let room = ui.available_width() - PRESETS_WIDTH;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.label(RichText::new("Preset").color(theme::WEAK));
        // In line with the other rows where there is room for that.
        if room > 0.0 {
            ui.add_space(room.min(theme::LABEL_WIDTH - 36.0));
        }
        for (preset, name, hint) in [
            (Preset::Draft, "Draft", "To see where the light goes"),
            (Preset::Medium, "Medium", "Clean enough to look at"),
            (Preset::Production, "Production", "To ship"),
        ] {
            let chosen = same_quality(&preset.settings(), settings);
            if ui.selectable_label(chosen, name).on_hover_text(hint).clicked() {
                apply(preset, settings);
            }
        }
    });
}

/// Whether rays and bounces are those of a preset.
fn same_quality(a: &Settings, b: &Settings) -> bool {
    (a.direct_samples, a.indirect_samples, a.bounces) == (b.direct_samples, b.indirect_samples, b.bounces)
}

/// Takes rays and bounces from a preset and leaves the rest.
fn apply(preset: Preset, settings: &mut Settings) {
    let Settings { direct_samples, indirect_samples, bounces, .. } = preset.settings();
    *settings = Settings { direct_samples, indirect_samples, bounces, ..settings.clone() };
}

fn samples(ui: &mut Ui, settings: &mut Settings) {
    let direct = Slider::new(&mut settings.direct_samples, 1..=MAX_DIRECT).logarithmic(true);
    slider(ui, "Direct samples", "Shadow rays per vertex and light", direct);
    let hemisphere = Slider::new(&mut settings.indirect_samples, 1..=MAX_INDIRECT).logarithmic(true);
    slider(ui, "Hemisphere", "Rays per vertex and bounce", hemisphere);
    let hint = "Where sample points come from. Sobol has the least noise; F2 switches to random and back.";
    let name = |sampler: SamplerKind| match sampler {
        SamplerKind::Random => "Random".to_owned(),
        SamplerKind::Stratified => "Stratified".to_owned(),
        SamplerKind::Halton => "Halton".to_owned(),
        SamplerKind::Sobol => "Sobol (Owen)".to_owned(),
    };
    use SamplerKind::{Halton, Random, Sobol, Stratified};
    choice(ui, "Sampler", hint, &mut settings.sampler, &[Random, Stratified, Halton, Sobol], name);
}

fn bounces(ui: &mut Ui, settings: &mut Settings) {
    let mut all = settings.bounces == BounceLimit::All;
    if let BounceLimit::Count(n) = &mut settings.bounces {
        let hint =
            "Reflections after direct light; while it solves, more are added and none are computed anew";
        slider(ui, "Bounces", hint, Slider::new(n, 0..=MAX_BOUNCES));
    } else {
        let hint = "The share of all light that may be missing";
        let percent = 100.0 * settings.remainder;
        let mut shown = percent;
        let drag = DragValue::new(&mut shown).range(0.001..=50.0).speed(0.01).suffix(" %").max_decimals(3);
        row(ui, "Bounces", hint, |ui| ui.add(drag));
        if shown != percent {
            settings.remainder = shown / 100.0;
        }
    }
    let hint = "Bounces are added until less than a set share of all light is missing";
    if check(ui, "Until converged", hint, &mut all).changed() {
        settings.bounces = if all { BounceLimit::All } else { BounceLimit::Count(DEFAULT_BOUNCES) };
    }
    let mut tail = settings.tail == Tail::Geometric;
    let hint = "Adds the bounces that are not computed, as a geometric series of the last";
    if check(ui, "Estimate the rest", hint, &mut tail).changed() {
        settings.tail = if tail { Tail::Geometric } else { Tail::Off };
    }
}

/// The error to stop at.
fn target(ui: &mut Ui, settings: &mut Settings) {
    let mut stops = settings.target_error != TargetError::Off;
    let hint = "Solves eight times with independent samples, and adds samples where the spread is above a target. The \
                numbers of samples above are those to begin with.";
    if check(ui, "Stop at an error", hint, &mut stops).changed() {
        let start = Share::new(DEFAULT_ERROR).map_or(TargetError::Off, TargetError::At);
        settings.target_error = if stops { start } else { TargetError::Off };
    }
    let TargetError::At(error) = &mut settings.target_error else { return };
    percent(ui, "Error", "Half the width of a value's 95 % interval, relative to it", error, 0.1..=50.0);
    let hint = "How many of all values must be as good as that";
    percent(ui, "Share of values", hint, &mut settings.target_share, 50.0..=99.9);
}

/// A share that is edited in percent.
fn percent(ui: &mut Ui, name: &str, hint: &str, share: &mut Share, range: RangeInclusive<f32>) {
    let before = share.percent() as f32;
    let mut shown = before;
    let drag = DragValue::new(&mut shown).range(range).speed(0.1).suffix(" %").max_decimals(2);
    row(ui, name, hint, |ui| ui.add(drag));
    if let Some(new) = Share::new(shown / 100.0).filter(|_| shown != before) {
        *share = new;
    }
}

fn more(ui: &mut Ui, settings: &mut Settings) {
    heading(ui, "Measuring");
    let hint = "Where light is measured: at vertices, or over the triangles around each";
    let name = |basis| match basis {
        BasisKind::Vertex => "At vertices".to_owned(),
        BasisKind::VertexArea => "Over areas".to_owned(),
    };
    choice(ui, "Basis", hint, &mut settings.basis, &[BasisKind::Vertex, BasisKind::VertexArea], name);
    let hint = "The estimator for lights: points on their area, or the closed form less what is blocked";
    let name = |sampling| match sampling {
        LightSampling::Area => "Area".to_owned(),
        LightSampling::Analytic => "Analytic".to_owned(),
    };
    let all = [LightSampling::Analytic, LightSampling::Area];
    choice(ui, "Light sampling", hint, &mut settings.light_sampling, &all, name);
    let hint = "How light from emissive surfaces is found";
    let name = |emitters| match emitters {
        EmitterSampling::Auto => "Automatic".to_owned(),
        EmitterSampling::Lights => "As lights".to_owned(),
        EmitterSampling::Rays => "By rays".to_owned(),
        EmitterSampling::Off => "Off".to_owned(),
    };
    use EmitterSampling::{Auto, Lights, Off, Rays};
    choice(ui, "Emissive", hint, &mut settings.emitters, &[Auto, Lights, Rays, Off], name);
    number(ui, "Seed", "Changes all random choices", DragValue::new(&mut settings.seed));
}
