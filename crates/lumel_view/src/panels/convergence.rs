//! Energy by bounce.

use crate::session::Session;
use crate::theme;
use crate::widgets::hint;
use eframe::egui::Ui;
use egui_plot::{Corner, GridMark, HoverPosition, Legend, Line, MarkerShape, Plot, PlotPoints, Points};

pub(super) fn show(session: &Session, ui: &mut Ui) {
    let stats = &session.stats;
    if stats.is_empty() {
        hint(ui, "Power, change and remaining energy are plotted here for each bounce of a solve.");
        return;
    }
    let all: f64 = stats.iter().map(|s| s.power).sum();
    // Decades, because each bounce is a share of the one before.
    let log = |share: f64| (share > 0.0).then(|| share.log10());
    let series = |value: &dyn Fn(usize) -> Option<f64>| -> Vec<[f64; 2]> {
        (0..stats.len()).filter_map(|k| Some([k as f64, value(k)?])).collect()
    };
    let lines = [
        ("Power of the bounce / total", series(&|k| log(stats[k].power / all))),
        ("RMS change / light so far", series(&|k| log(stats[k].change))),
        ("Remaining energy", series(&|k| stats[k].unfinished.and_then(log))),
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
        .y_axis_formatter(|mark, _| percent(mark.value))
        .x_axis_formatter(
            |mark, _| if mark.value.fract() == 0.0 { format!("{}", mark.value) } else { String::new() },
        )
        .label_formatter(|at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\nbounce {:.0}: {}", position.x, percent(position.y)))
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

/// Marks at 1, 2 and 5 times each power of ten.
fn decades((lo, hi): (f64, f64)) -> Vec<GridMark> {
    let range = lo.max(-12.0).floor() as i32..=hi.min(12.0).ceil() as i32;
    let mark = |decade: i32, value: f64, step_size| GridMark { value: f64::from(decade) + value, step_size };
    range.flat_map(|d| [mark(d, 0.0, 1.0), mark(d, 2f64.log10(), 0.3), mark(d, 5f64.log10(), 0.3)]).collect()
}

/// A decade as a share.
fn percent(decades: f64) -> String {
    let percent = 100.0 * 10f64.powf(decades);
    if percent >= 10.0 {
        format!("{percent:.0} %")
    } else {
        let digits = (1.0 - percent.max(1e-6).log10().floor()).clamp(0.0, 5.0) as usize;
        format!("{percent:.digits$} %")
    }
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn decades_are_told_as_shares() {
        assert_eq!([0.0, -1.0, -2.0, -3.5].map(percent), ["100 %", "10 %", "1.0 %", "0.032 %"]);
    }
}
