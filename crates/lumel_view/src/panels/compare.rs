//! Two lights side by side.

use crate::app::App;
use crate::dialogs::Dialog;
use crate::selection::Selection;
use crate::stage::Side;
use crate::theme;
use crate::widgets::{check, choice, heading, value};
use eframe::egui::{RichText, Ui};

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    app.comparison.check(&app.session);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Keep this light").on_hover_text("Keeps it to compare with (P)").clicked() {
            app.session.keep_light();
        }
        if ui.button("Load to compare...").clicked() {
            app.dialogs.open(Dialog::compare_solution(&app.session));
        }
    });
    let mut on = app.comparison.on;
    if check(ui, "Split the picture", "Drag the divider in the picture (C)", &mut on).changed() {
        app.comparison.toggle(&app.session);
    }
    let names: Vec<(Side, String)> = std::iter::once((Side::Current, "This light".to_owned()))
        .chain(app.session.kept.iter().map(|kept| (Side::Kept(kept.id), kept.name.clone())))
        .collect();
    let name =
        |side: Side| names.iter().find(|(s, _)| *s == side).map_or_else(String::new, |(_, n)| n.clone());
    let sides: Vec<Side> = names.iter().map(|(side, _)| *side).collect();
    heading(ui, "Left: this light");
    let bounces = app.session.light.bounce_count();
    selection(ui, "Left shows", &mut app.prefs.view.selection, bounces);
    heading(ui, "Right");
    choice(ui, "Light", "What is right of the divider", &mut app.comparison.right, &sides, name);
    let kept = match app.comparison.right {
        Side::Current => bounces,
        Side::Kept(id) => app.session.kept.iter().find(|k| k.id == id).map_or(0, |k| k.light.bounce_count()),
    };
    selection(ui, "Right shows", &mut app.comparison.selection, kept);
    difference(app, ui);
    list(app, ui);
}

fn selection(ui: &mut Ui, name: &str, value: &mut Selection, bounces: usize) {
    let mut all = vec![Selection::All];
    if bounces > 0 {
        all.push(Selection::Indirect);
        all.extend((0..bounces as u32).map(Selection::bounce));
    }
    let text = |selection: Selection| {
        let text = selection.to_string();
        let mut letters = text.chars();
        letters.next().map(|c| c.to_uppercase().collect::<String>() + letters.as_str()).unwrap_or_default()
    };
    choice(ui, name, "Which bounces", value, &all, text);
}

fn difference(app: &mut App, ui: &mut Ui) {
    let left = app.prefs.view.selection;
    let Some(difference) = app.comparison.difference(&app.session, left) else {
        super::hint(
            ui,
            "There is nothing to compare yet: solve, keep the light, change something, solve again.",
        );
        return;
    };
    heading(ui, "Left against right");
    let percent =
        |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |s| format!("{:.2} %", 100.0 * s));
    value(ui, "RMSE", format!("{} W/m²", crate::values::significant(difference.rmse as f32)));
    value(ui, "Relative RMSE", percent(difference.relative_rmse));
    let ratio = difference.mean_ratio.map_or_else(|| "-".to_owned(), |r| format!("{r:.4}"));
    value(ui, "Mean ratio", ratio);
    if let Some(percentiles) = difference.percentiles {
        value(ui, "99th percentile", percent(Some(percentiles.p99)));
    }
}

fn list(app: &mut App, ui: &mut Ui) {
    if app.session.kept.is_empty() {
        return;
    }
    heading(ui, "Kept");
    let mut gone = None;
    for (i, kept) in app.session.kept.iter().enumerate() {
        ui.horizontal(|ui| {
            if ui.small_button("Forget").on_hover_text(format!("Forget {}", kept.name)).clicked() {
                gone = Some(i);
            }
            ui.add(eframe::egui::Label::new(RichText::new(&kept.name).color(theme::TEXT)).truncate());
        });
    }
    if let Some(i) = gone {
        app.session.kept.remove(i);
    }
}
