//! Settings of the solve, as the table of all settings has them.

use super::{order, points};
use crate::theme;
use crate::widgets::{check, choice, number, row, slider};
use eframe::egui::{DragValue, RichText, Slider, Ui};
use lumel::setting::{
    self, ADAPTIVE, About, BOUNCES, Bounds, Choice, DIRECT_SAMPLES, DIRECTIONAL, INDIRECT_SAMPLES, LEVELS,
    MAX_VERTICES, POINT_SPACING, REMAINDER, SAMPLER, SCHEDULE, Setting, Slot, TAIL, TARGET_ERROR,
    TARGET_SHARE, Value as _,
};
use lumel::{Adaptive, BounceLimit, Memory, Preset, Settings, SettingsPatch, Share, TargetError};
use std::ops::RangeInclusive;

/// What the bounces slider offers when it is switched back from "until converged".
const DEFAULT_BOUNCES: u32 = 4;

/// The error that a solve stops at, when it is switched on.
const DEFAULT_ERROR: f32 = 0.02;

/// Least width of the row with the presets.
const PRESETS_WIDTH: f32 = 240.0;

/// The settings with a place of their own, in that order; all others are under "More".
static PLACED: [&dyn Setting; 12] = [
    &DIRECT_SAMPLES,
    &INDIRECT_SAMPLES,
    &SAMPLER,
    &SCHEDULE,
    &BOUNCES,
    &REMAINDER,
    &TAIL,
    &DIRECTIONAL,
    &ADAPTIVE,
    &MAX_VERTICES,
    &TARGET_ERROR,
    &TARGET_SHARE,
];

pub(super) fn show(ui: &mut Ui, settings: &mut Settings) {
    presets(ui, settings);
    for setting in PLACED {
        match setting.about().name {
            name if name == REMAINDER.about.name && settings.bounces != BounceLimit::All => {}
            name if name == BOUNCES.about.name => {
                ui.add_enabled_ui(settings.tells_bounces(), |ui| control(ui, setting, settings));
                order::note(ui, settings);
            }
            name if name == MAX_VERTICES.about.name && settings.adaptive == Adaptive::Off => {}
            name if name == TARGET_SHARE.about.name && settings.target_error == TargetError::Off => {}
            _ => control(ui, setting, settings),
        }
        order::fit(settings);
        points::fit(settings);
    }
    ui.collapsing("More", |ui| {
        let is_placed = |setting: &dyn Setting| PLACED.iter().any(|s| s.about().name == setting.about().name);
        // They are beside the basis.
        let of_points = [POINT_SPACING.about.name, LEVELS.about.name];
        let is_of_points = |setting: &dyn Setting| of_points.contains(&setting.about().name);
        let is_shown = |setting: &dyn Setting| !is_placed(setting) && !is_of_points(setting);
        for setting in setting::ALL.iter().filter(|setting| is_shown(**setting)) {
            control(ui, *setting, settings);
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
        for (preset, Choice { label, help, .. }) in Preset::ALL.into_iter().zip(Preset::choices()) {
            let all = preset.settings();
            let by_preset = || setting::ALL.iter().filter(|setting| setting.is_by_preset());
            let chosen = by_preset().all(|setting| setting.is_same(&all, settings));
            if ui.selectable_label(chosen, *label).on_hover_text(*help).clicked() {
                by_preset().for_each(|setting| setting.copy(&all, settings));
            }
        }
    });
}

/// The widgets of one setting.
fn control(ui: &mut Ui, setting: &dyn Setting, settings: &mut Settings) {
    let about = setting.about();
    let hint = hint(setting);
    if let Some(name) = chosen(ui, setting, settings, &hint) {
        // It is the name of a choice, so it is understood.
        if let Ok(patch) = setting.parse(name) {
            *settings = SettingsPatch::complete(settings).overridden_by(patch).settings();
        }
        return;
    }
    match setting.slot(settings) {
        Slot::Choice => {}
        Slot::Count(n) => {
            let range = offered(about, 0.0..=f64::from(u32::MAX));
            slider(ui, about.label, &hint, Slider::new(n, whole(&range)).logarithmic(true));
        }
        Slot::Whole(n) => drop(number(ui, about.label, &hint, DragValue::new(n))),
        Slot::Number(x) => {
            let range = offered(about, f64::from(f32::MIN)..=f64::from(f32::MAX));
            if about.bounds == Bounds::Between(0.0, 1.0) {
                percent(ui, about, &hint, x);
            } else {
                number(ui, about.label, &hint, DragValue::new(x).range(range));
            }
        }
        Slot::Bounces(limit) => bounces(ui, about, &hint, limit),
        Slot::Memory(memory) => size(ui, about, &hint, memory),
        Slot::Share(share) => percent_of(ui, about, &hint, share),
        Slot::TargetError(error) => target(ui, about, &hint, error),
        // Its rows are beside the basis.
        Slot::PointSpacing(_) => {}
        Slot::Adaptive(adaptive) => follow_light(ui, about, &hint, adaptive),
    }
}

/// Lets the user choose one of a few values, if the setting has those. Returns the name of a new one.
fn chosen(ui: &mut Ui, setting: &dyn Setting, settings: &Settings, hint: &str) -> Option<&'static str> {
    let about = setting.about();
    let choices = setting.choices();
    let now = setting.text(settings);
    let before = choices.iter().find(|choice| choice.name == now)?.name;
    if let [Choice { name: off @ "off", .. }, Choice { name: on, .. }] = choices {
        let mut is_on = before == *on;
        let changed = check(ui, about.label, hint, &mut is_on).changed();
        return changed.then_some(if is_on { on } else { off });
    }
    let mut name = before;
    let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
    let label = |name: &str| {
        choices.iter().find(|choice| choice.name == name).map_or("", |choice| choice.label).to_owned()
    };
    choice(ui, about.label, hint, &mut name, &names, label);
    (name != before).then_some(name)
}

/// What is shown over a setting.
fn hint(setting: &dyn Setting) -> String {
    let about = setting.about();
    let choices = setting.choices().iter().map(|choice| format!("{}: {}", choice.label, choice.help));
    let paragraphs = [about.help()].into_iter().chain(about.details()).chain(choices);
    paragraphs.collect::<Vec<_>>().join("\n")
}

fn bounces(ui: &mut Ui, about: &About, hint: &str, limit: &mut BounceLimit) {
    if let BounceLimit::Count(n) = limit {
        let range = offered(about, 0.0..=f64::from(u32::MAX));
        slider(ui, about.label, hint, Slider::new(n, whole(&range)));
    }
    let mut all = *limit == BounceLimit::All;
    let hint = "Adds bounces until less than the remainder of all light is missing";
    if check(ui, "Until converged", hint, &mut all).changed() {
        *limit = if all { BounceLimit::All } else { BounceLimit::Count(DEFAULT_BOUNCES) };
    }
}

fn target(ui: &mut Ui, about: &About, hint: &str, error: &mut TargetError) {
    let mut stops = *error != TargetError::Off;
    if check(ui, "Stop at an error", hint, &mut stops).changed() {
        let start = Share::new(DEFAULT_ERROR).map_or(TargetError::Off, TargetError::At);
        *error = if stops { start } else { TargetError::Off };
    }
    if let TargetError::At(error) = error {
        percent_of(ui, about, hint, error);
    }
}

/// Whether the mesh follows light, and how closely.
fn follow_light(ui: &mut Ui, about: &About, hint: &str, adaptive: &mut Adaptive) {
    let mut follows = *adaptive != Adaptive::Off;
    let about_switch =
        "Refines the mesh where light needs it before the bounces are solved, and shows it meanwhile";
    if check(ui, "Follow light", about_switch, &mut follows).changed() {
        let start = Adaptive::At(Preset::default().adaptive_error());
        *adaptive = if follows { start } else { Adaptive::Off };
    }
    let Some(error) = adaptive.error() else { return };
    let [lo, hi] = about.offered.unwrap_or([0.0, 1.0]).map(|share| 100.0 * share);
    let before = error.percent();
    let mut percent = before;
    let range = Slider::new(&mut percent, lo..=hi).logarithmic(true).suffix(" %").max_decimals(2);
    slider(ui, "Bend", hint, range);
    if let (true, Some(new)) = (percent != before, Share::new((percent / 100.0) as f32)) {
        *adaptive = Adaptive::At(new);
    }
}

/// A size of memory, to be typed with its unit or dragged.
fn size(ui: &mut Ui, about: &About, hint: &str, memory: &mut Memory) {
    let before = memory.0 as f64;
    let mut shown = before;
    let drag = DragValue::new(&mut shown)
        .range(0.0..=u64::MAX as f64)
        // A MiB for each point.
        .speed(f64::from(1 << 20))
        .custom_formatter(|bytes, _| Memory(bytes as u64).to_string())
        .custom_parser(|text| text.parse::<Memory>().ok().map(|memory| memory.0 as f64));
    number(ui, about.label, hint, drag);
    if shown != before {
        *memory = Memory(shown as u64);
    }
}

fn percent_of(ui: &mut Ui, about: &About, hint: &str, share: &mut Share) {
    let mut number = share.get();
    percent(ui, about, hint, &mut number);
    if let Some(new) = Share::new(number) {
        *share = new;
    }
}

/// A share that is edited in percent.
fn percent(ui: &mut Ui, about: &About, hint: &str, share: &mut f32) {
    let range = offered(about, 0.0..=1.0);
    let before = Share::new(*share).map_or(0.0, Share::percent);
    let mut shown = before;
    let drag = DragValue::new(&mut shown)
        .range(100.0 * range.start()..=100.0 * range.end())
        .speed(0.01 * before.max(0.1))
        .suffix(" %")
        .max_decimals(3);
    row(ui, about.label, hint, |ui| ui.add(drag));
    if shown != before {
        *share = (shown / 100.0) as f32;
    }
}

fn offered(about: &About, all: RangeInclusive<f64>) -> RangeInclusive<f64> {
    about.offered.map_or(all, |[lo, hi]| lo..=hi)
}

fn whole(range: &RangeInclusive<f64>) -> RangeInclusive<u32> {
    *range.start() as u32..=*range.end() as u32
}
