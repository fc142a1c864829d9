//! The status bar: what is running, and what draws.

use crate::gauges::Gauges;
use crate::prefs::Prefs;
use crate::session::Session;
use crate::solver::Phase;
use crate::stage::Stage;
use crate::theme;
use crate::values::{grouped, percent};
use crate::widgets::busy;
use eframe::egui::{self, ProgressBar, RichText, Ui};
use lumel::{Accuracy, Ended, Settings};

pub(super) fn show(
    session: &Session,
    stage: Option<&Stage>,
    prefs: &Prefs,
    gauges: Option<&Gauges>,
    ui: &mut Ui,
) {
    ui.horizontal(|ui| {
        left(session, ui);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            right(stage, prefs, ui);
            for text in gauges.into_iter().flat_map(Gauges::texts) {
                let about = "Memory of the program, the time that a frame takes, and how many follow each other in a second";
                ui.label(RichText::new(text).color(theme::WEAK)).on_hover_text(about);
            }
        });
    });
}

fn left(session: &Session, ui: &mut Ui) {
    if let Some(phase) = session.phase() {
        solving(session, ui, &phase);
    } else if let Some(work) = session.background_work() {
        busy(ui);
        ui.label(RichText::new(work).color(theme::TEXT));
    } else {
        let (text, color) = state(session);
        ui.label(RichText::new(text).color(color));
    }
}

/// The state of the light while nothing runs.
fn state(session: &Session) -> (String, egui::Color32) {
    if session.document.is_none() {
        return ("No scene is open".to_owned(), theme::WEAK);
    }
    if session.light.is_empty() {
        let text = session.obstacle_to_solve().unwrap_or("Not solved: press Enter");
        return (text.to_owned(), theme::WEAK);
    }
    if let Some(changes) = session.out_of_date() {
        return (format!("{changes}: press Enter to solve again"), theme::WARNING);
    }
    match session.computed() {
        Some(computed) if session.is_light_in_motion() => {
            let time = computed.seconds.map_or_else(String::new, |s| format!(" in {s:.2} s"));
            (format!("Live: {}{time}", computed.label(&session.light)), theme::GOOD)
        }
        Some(computed) if !computed.complete => {
            let how = if session.can_go_on() { "resume" } else { "start over" };
            (format!("Stopped: press Enter to {how}"), theme::WARNING)
        }
        Some(computed) => {
            let time = computed.seconds.map_or_else(String::new, |s| format!(" in {s:.1} s"));
            let accuracy = computed.accuracy().zip(computed.settings());
            let missed = accuracy.is_some_and(|(a, _)| a.ended != Some(Ended::Reached));
            let within = accuracy.map_or_else(String::new, |(a, s)| format!(", {}", within(&a, s)));
            let text = format!("Solved: {}{time}{within}{}", computed.label(&session.light), lumels(session));
            (text, if missed { theme::WARNING } else { theme::GOOD })
        }
        None => (String::new(), theme::WEAK),
    }
}

/// How many lumels have the light, if there is a lightmap.
fn lumels(session: &Session) -> String {
    match session.layout().filter(|_| session.has_whole_lightmap()) {
        Some(layout) => format!("; {} lumels", grouped(layout.lumels.coverage.len())),
        None => String::new(),
    }
}

fn solving(session: &Session, ui: &mut Ui, phase: &Phase) {
    let Some(job) = session.job() else { return };
    let progress = job.progress();
    let share = match *phase {
        Phase::Lumels { percent, .. } => Some(f64::from(percent) / 100.0),
        _ => progress.share,
    };
    match share {
        Some(share) => {
            ui.add(
                ProgressBar::new(share as f32).desired_width(150.0).desired_height(12.0).fill(theme::ACCENT),
            );
        }
        None => drop(busy(ui)),
    }
    let mut text = match phase {
        Phase::Preparing => "Preparing".to_owned(),
        Phase::Refining { bounce: 0, vertices } => {
            format!("Refining by direct light: {} vertices", grouped(*vertices))
        }
        Phase::Refining { bounce, vertices } => {
            format!("Refining by bounce {bounce}: {} vertices", grouped(*vertices))
        }
        Phase::Probing if progress.traces_kept_rays => "Tracing rays".to_owned(),
        Phase::Probing => "Looking inside geometry".to_owned(),
        Phase::Bounce(0) if progress.traces_kept_rays => "Direct light, tracing rays".to_owned(),
        Phase::Bounce(0) => "Direct light".to_owned(),
        Phase::Bounce(k) => match progress.last_bounce.filter(|last| last >= k) {
            Some(last) => format!("Bounce {k} of {last}"),
            None => format!("Bounce {k}"),
        },
        Phase::Shot(shot) => match progress.missing {
            Some(missing) => format!("Shot {}, {} missing", shot + 1, percent(missing)),
            None => format!("Shot {}", shot + 1),
        },
        Phase::FinalGather => "Final gather".to_owned(),
        Phase::ReadDirect => "Direct light at vertices".to_owned(),
        Phase::Directional => "Light by direction".to_owned(),
        Phase::Round(round) => format!("Round {}", round + 1),
        Phase::Layer(layer) => format!("Layer {} of {}", layer + 1, progress.layers),
        Phase::StandardError => "Measuring the standard error".to_owned(),
        Phase::Lumels { round, .. } => format!("Measuring lumels, round {}", round + 1),
        Phase::Finishing => "Finishing the lightmap".to_owned(),
        Phase::Ended(_) => String::new(),
    };
    if let Some(accuracy) = progress.accuracy {
        text += &format!("  |  {}", within(&accuracy, job.settings()));
    }
    if let Some(rate) = progress.rays_per_second.and_then(lumel::ray_rate) {
        text += &format!("  |  {rate}");
    }
    if let Some(seconds) = progress.seconds_left {
        text += &format!("  |  {} left", duration(seconds));
    }
    ui.label(RichText::new(text).color(theme::TEXT));
}

/// What a solve with a target error has reached.
fn within(accuracy: &Accuracy, settings: &Settings) -> String {
    format!("{:.1} % of values within {}", 100.0 * accuracy.share, settings.target_error)
}

/// A time in words: "12 s", "3 min 20 s", "2 h 5 min".
fn duration(seconds: f64) -> String {
    let s = seconds.max(0.0).ceil() as u64;
    match s {
        0..60 => format!("{s} s"),
        60..3600 => format!("{} min {} s", s / 60, s % 60),
        _ => format!("{} h {} min", s / 3600, s % 3600 / 60),
    }
}

fn right(stage: Option<&Stage>, prefs: &Prefs, ui: &mut Ui) {
    if let Some(stage) = stage {
        if stage.gpu().is_software() {
            let text = RichText::new("software renderer").color(theme::WARNING);
            ui.label(text)
                .on_hover_text(format!("{}: a graphics driver would be faster", stage.gpu().name()));
        } else {
            ui.label(RichText::new(stage.gpu().name()).color(theme::WEAK));
        }
        if prefs.view.mode.is_exposed() {
            let auto = if prefs.view.auto_exposure { " auto" } else { "" };
            ui.label(RichText::new(format!("{:+.1} EV{auto}", stage.stops(&prefs.view))).color(theme::WEAK));
        }
    }
    let speed = RichText::new(format!("speed {:.2}", prefs.speed)).color(theme::WEAK);
    ui.label(speed).on_hover_text("Turn the wheel over the picture to fly faster or slower");
}

#[cfg(test)]
mod tests {
    use super::duration;

    #[test]
    fn times_are_told_in_two_units() {
        assert_eq!([0.2, 59.0, 200.0, 7500.0].map(duration), ["1 s", "59 s", "3 min 20 s", "2 h 5 min"]);
    }
}
