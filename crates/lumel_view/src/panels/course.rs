//! What was still to come at each time of this solve and of the one before.

use super::convergence::{decades, share};
use crate::session::{Course, Courses};
use crate::solver::Moment;
use crate::theme;
use crate::widgets::hint;
use eframe::egui::{Color32, RichText, Ui};
use egui_plot::{HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points};

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

/// Room for the names of curves.
const LEGEND_WIDTH: f32 = 160.0;

pub(super) fn show(courses: &Courses, ui: &mut Ui) {
    if courses.last.moments.is_empty() && courses.before.moments.is_empty() {
        hint(
            ui,
            "Unshot energy and the estimated error are plotted here against time, of a solve and of the one before it: \
             solve by Gather and by Shoot to compare them.",
        );
        return;
    }
    // Within the plot, names would lie over the curves.
    let width = (ui.available_width() - LEGEND_WIDTH).max(100.0);
    plot(courses, width, ui);
    ui.vertical(|ui| legend(courses, ui));
}

fn plot(courses: &Courses, width: f32, ui: &mut Ui) {
    Plot::new("course")
        .width(width)
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
            for (course, which) in shown(courses) {
                for series in &SERIES {
                    let points = points(course, series.value);
                    let name = format!("{}{}, {}", which.prefix, course.name, series.name);
                    let (color, dots) = (which.color(series), PlotPoints::from(points.clone()));
                    let line = Line::new(name.clone(), PlotPoints::from(points));
                    plot.line(line.color(color).style(which.style).width(2.0));
                    plot.points(Points::new(name, dots).color(color).radius(2.5).shape(MarkerShape::Circle));
                }
            }
        });
}

fn legend(courses: &Courses, ui: &mut Ui) {
    ui.spacing_mut().item_spacing.y = 1.0;
    for (course, which) in shown(courses) {
        let text = |text: String, color: Color32| RichText::new(text).small().color(color);
        ui.label(text(format!("{}{}", which.prefix, course.name), theme::TEXT));
        for series in &SERIES {
            ui.label(text(format!("{} {}", which.line, series.name), which.color(series)));
        }
        ui.add_space(4.0);
    }
}

/// How the curves of a solve are told from those of another one.
struct Which {
    prefix: &'static str,
    style: LineStyle,
    /// The same in its legend.
    line: &'static str,
    brightness: f32,
}

impl Which {
    fn color(&self, series: &Series) -> Color32 {
        series.color.gamma_multiply(self.brightness)
    }
}

/// The solves that have been seen, the last one in front.
fn shown(courses: &Courses) -> impl DoubleEndedIterator<Item = (&Course, Which)> {
    let before =
        Which { prefix: "Before: ", style: LineStyle::dashed_dense(), line: "- -", brightness: 0.65 };
    let last = Which { prefix: "", style: LineStyle::Solid, line: "---", brightness: 1.0 };
    [(&courses.before, before), (&courses.last, last)]
        .into_iter()
        .filter(|(course, _)| !course.moments.is_empty())
}

/// Seconds, and decades of a share.
fn points(course: &Course, value: fn(&Moment) -> f64) -> Vec<[f64; 2]> {
    let point = |moment: &Moment| {
        let value = value(moment);
        (value > 0.0).then(|| [moment.seconds, value.log10()])
    };
    course.moments.iter().filter_map(point).collect()
}
