//! Two solutions side by side.

use crate::actions::Actions;
use crate::compare::Comparison;
use crate::input::Command;
use crate::relief::UNKNOWN;
use crate::selection::Selection;
use crate::session::Session;
use crate::stage::Side;
use crate::theme;
use crate::widgets::{check, choice, heading, hint, value};
use eframe::egui::{RichText, Ui};
use lumel::Directional;

pub(super) fn show(
    session: &mut Session,
    comparison: &mut Comparison,
    shown: &mut Selection,
    actions: &mut Actions,
    ui: &mut Ui,
) {
    comparison.check(session);
    ui.horizontal_wrapped(|ui| {
        if ui
            .button("Keep this solution")
            .on_hover_text("Keeps the light as it is now, to compare with (P)")
            .clicked()
        {
            comparison.keep(session);
        }
        if ui.button("Load for comparison...").clicked() {
            actions.push(Command::CompareSolution);
        }
    });
    let mut on = comparison.on;
    if check(ui, "Split view", "Drag the divider in the picture (C)", &mut on).changed() {
        comparison.toggle(session);
    }
    let tilts = session.directional() != Directional::Off;
    let smooth = (Side::Smooth, "Without normal maps".to_owned());
    let names: Vec<(Side, String)> = std::iter::once((Side::Current, "Current solution".to_owned()))
        .chain(Some(smooth).filter(|_| tilts || comparison.right == Side::Smooth))
        .chain(session.kept.iter().map(|kept| (Side::Kept(kept.id), kept.name.clone())))
        .collect();
    let name =
        |side: Side| names.iter().find(|(s, _)| *s == side).map_or_else(String::new, |(_, n)| n.clone());
    let sides: Vec<Side> = names.iter().map(|(side, _)| *side).collect();
    heading(ui, "Left: current solution");
    let bounces = session.light.bounce_count();
    selection(ui, "Left shows", shown, bounces);
    heading(ui, "Right");
    choice(ui, "Light", "The solution right of the divider", &mut comparison.right, &sides, name);
    if comparison.right == Side::Smooth {
        hint(ui, if tilts { "The same light on surfaces as smooth as their meshes." } else { UNKNOWN });
        return list(session, ui);
    }
    let kept = match comparison.right {
        Side::Current | Side::Smooth => bounces,
        Side::Kept(id) => session.kept.iter().find(|k| k.id == id).map_or(0, |k| k.light.bounce_count()),
    };
    selection(ui, "Right shows", &mut comparison.selection, kept);
    difference(session, comparison, *shown, ui);
    list(session, ui);
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

fn difference(session: &Session, comparison: &mut Comparison, left: Selection, ui: &mut Ui) {
    let Some(difference) = comparison.difference(session, left) else {
        hint(ui, "Nothing to compare yet: solve, keep the solution, change something and solve again.");
        return;
    };
    heading(ui, "Left compared with right");
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

fn list(session: &mut Session, ui: &mut Ui) {
    if session.kept.is_empty() {
        return;
    }
    heading(ui, "Kept");
    let mut gone = None;
    for (i, kept) in session.kept.iter().enumerate() {
        ui.horizontal(|ui| {
            if ui.small_button("Discard").on_hover_text(format!("Discard {}", kept.name)).clicked() {
                gone = Some(i);
            }
            ui.add(eframe::egui::Label::new(RichText::new(&kept.name).color(theme::TEXT)).truncate());
        });
    }
    if let Some(i) = gone {
        session.kept.remove(i);
    }
}
