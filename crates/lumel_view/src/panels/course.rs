//! What was still to come at each time of this solve and of the one before.

use super::convergence::{decades, share};
use crate::session::{Course, Courses};
use crate::solver::Moment;
use crate::theme;
use crate::widgets::hint;
use eframe::egui::{Color32, Ui};
use egui_plot::{Corner, HoverPosition, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points};

/// What is plotted of moments.
struct Series {
    name: &'static str,
    value: fn(&Moment) -> f64,
    color: Color32,
}

const SERIES: [Series; 2] = [
    Series { name: "unshot energy", value: |moment| moment.unshot, color: theme::SERIES[0] },
    Series { name: "estimated error", value: |moment| moment.missing, color: theme::SERIES[1] },
];

/// What stands before the names of the solve before.
const BEFORE: &str = "Before: ";

pub(super) fn show(courses: &Courses, ui: &mut Ui) {
    if courses.last.moments.is_empty() && courses.before.moments.is_empty() {
        hint(
            ui,
            "Unshot energy and the estimated error are plotted here against time, of a solve and of the one before it: \
             solve by Gather and by Shoot to compare them.",
        );
        return;
    }
    Plot::new("course")
        .legend(Legend::default().position(Corner::RightTop))
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .include_x(0.0)
        .include_y(0.1)
        .include_y(-1.1)
        .y_grid_spacer(|input| decades(input.bounds))
        .x_axis_label("seconds")
        .y_axis_formatter(|mark, _| share(mark.value))
        .label_formatter(|at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{:.2} s: {}", position.x, share(position.y)))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for (course, before) in [(&courses.before, BEFORE), (&courses.last, "")] {
                for Series { name, value, color } in SERIES {
                    let points = points(course, value);
                    if points.is_empty() {
                        continue;
                    }
                    let name = format!("{before}{}, {name}", course.name);
                    let is_before = !before.is_empty();
                    let color = if is_before { color.gamma_multiply(0.6) } else { color };
                    let style = if is_before { LineStyle::dashed_dense() } else { LineStyle::Solid };
                    let dots = PlotPoints::from(points.clone());
                    let line = Line::new(name.clone(), PlotPoints::from(points));
                    plot.line(line.color(color).style(style).width(2.0));
                    plot.points(Points::new(name, dots).color(color).radius(2.5).shape(MarkerShape::Circle));
                }
            }
        });
}

/// Seconds, and decades of a share.
fn points(course: &Course, value: fn(&Moment) -> f64) -> Vec<[f64; 2]> {
    let point = |moment: &Moment| {
        let value = value(moment);
        (value > 0.0).then(|| [moment.seconds, value.log10()])
    };
    course.moments.iter().filter_map(point).collect()
}
