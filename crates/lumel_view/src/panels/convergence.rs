//! Energy by bounce, or by time.

use super::course;
use super::order::NO_BOUNCES;
use crate::prefs::PlotKind;
use crate::session::Session;
use crate::solver::BounceStats;
use crate::theme;
use crate::values::percent;
use crate::widgets::hint;
use eframe::egui::Ui;
use egui_plot::{Corner, GridMark, HoverPosition, Legend, Line, MarkerShape, Plot, PlotPoints, Points};

/// What can be plotted.
const KINDS: [(PlotKind, &str, &str); 2] = [
    (PlotKind::Bounces, "Bounces", "What each bounce of the last solve brought"),
    (
        PlotKind::Time,
        "Time",
        "Unshot energy and the estimated error against time, of this solve and of the one before",
    ),
];

/// Room for their names.
const KINDS_WIDTH: f32 = 74.0;

pub(super) fn show(session: &Session, kind: &mut PlotKind, ui: &mut Ui) {
    ui.horizontal_top(|ui| {
        ui.vertical(|ui| {
            ui.set_width(KINDS_WIDTH);
            for (of, name, hint) in KINDS {
                ui.selectable_value(kind, of, name).on_hover_text(hint);
            }
        });
        match kind {
            PlotKind::Bounces => by_bounce(session, ui),
            PlotKind::Time => course::show(&session.courses, ui),
        }
    });
}

fn by_bounce(session: &Session, ui: &mut Ui) {
    if !session.tells_bounces() {
        hint(ui, NO_BOUNCES);
        return;
    }
    let stats = &session.stats;
    if stats.is_empty() {
        hint(ui, "Power, change and what is still missing are plotted here for each bounce of a solve.");
        return;
    }
    let all: f64 = stats.iter().map(|s| s.power).sum();
    let missing = missing(stats);
    // Decades, because each bounce is a share of the one before.
    let log = |share: f64| (share > 0.0).then(|| share.log10());
    let series = |value: &dyn Fn(usize) -> Option<f64>| -> Vec<[f64; 2]> {
        (0..stats.len()).filter_map(|k| Some([k as f64, value(k)?])).collect()
    };
    let lines = [
        ("Power of the bounce / total", series(&|k| log(stats[k].power / all))),
        ("RMS change / light so far", series(&|k| log(stats[k].change))),
        ("Light still missing", series(&|k| log(missing[k]))),
    ];
    Plot::new("convergence")
        .legend(Legend::default().position(Corner::RightTop))
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .include_x(0.0)
        .include_x(stats.len().max(4) as f64)
        .include_y(0.1)
        .include_y(-1.1)
        .x_grid_spacer(|_| (0..=400).map(|k| GridMark { value: f64::from(k), step_size: 1.0 }).collect())
        .y_grid_spacer(|input| decades(input.bounds))
        .x_axis_label("bounce")
        .y_axis_formatter(|mark, _| share(mark.value))
        .x_axis_formatter(
            |mark, _| if mark.value.fract() == 0.0 { format!("{}", mark.value) } else { String::new() },
        )
        .label_formatter(|at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\nbounce {:.0}: {}", position.x, share(position.y)))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for ((name, points), color) in lines.into_iter().zip(theme::SERIES) {
                let dots = PlotPoints::from(points.clone());
                plot.line(Line::new(name, PlotPoints::from(points)).color(color).width(2.0));
                plot.points(Points::new(name, dots).color(color).radius(3.5).shape(MarkerShape::Circle));
            }
        });
}

/// The share of all light that was missing after each bounce: what later ones have brought since, and what is estimated to
/// come after the last.
///
/// An estimate after each bounce alone may rise with the next one; this falls.
fn missing(stats: &[BounceStats]) -> Vec<f64> {
    let known: f64 = stats.iter().map(|s| s.power).sum();
    let to_come = known * stats.last().and_then(|last| last.unfinished).unwrap_or(0.0);
    let mut later = to_come;
    let mut shares = Vec::with_capacity(stats.len());
    for bounce in stats.iter().rev() {
        shares.push(if known > 0.0 { later / (known + to_come) } else { 0.0 });
        later += bounce.power;
    }
    shares.reverse();
    shares
}

/// Marks at 1, 2 and 5 times each power of ten.
pub(super) fn decades((lo, hi): (f64, f64)) -> Vec<GridMark> {
    let range = lo.max(-12.0).floor() as i32..=hi.min(12.0).ceil() as i32;
    let mark = |decade: i32, value: f64, step_size| GridMark { value: f64::from(decade) + value, step_size };
    range.flat_map(|d| [mark(d, 0.0, 1.0), mark(d, 2f64.log10(), 0.3), mark(d, 5f64.log10(), 0.3)]).collect()
}

/// A decade as a share.
pub(super) fn share(decades: f64) -> String {
    percent(10f64.powf(decades))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_falls_even_where_its_estimates_rise() {
        let bounce = |power, unfinished| BounceStats { power, change: 0.0, unfinished, seconds: 0.0 };
        let stats =
            [bounce(6.0, None), bounce(1.0, Some(0.1)), bounce(2.0, Some(0.5)), bounce(1.0, Some(0.25))];
        let shares = missing(&stats);
        assert_eq!(shares, [0.52, 0.44, 0.28, 0.2]);
        assert_eq!(missing(&[bounce(0.0, None)]), [0.0]);
    }
}
