//! Error against time, as SVG.

use std::fmt::Write as _;

/// What was found of one solve.
pub(crate) struct Curve {
    pub(crate) way: &'static str,
    pub(crate) order: &'static str,
    /// Seconds and relative error after each step.
    pub(crate) errors: Vec<(f64, f64)>,
}

const WIDTH: f64 = 300.0;
const HEIGHT: f64 = 220.0;
const MARGIN: [f64; 2] = [52.0, 44.0];

/// The errors that the axis goes from and to.
const ERRORS: [f64; 2] = [1e-3, 1.0];

/// A plot for each way of each scene: gathering and shooting, with lines at the limits.
pub(crate) fn svg(scenes: &[(String, Vec<Curve>)], limits: &[f64]) -> String {
    let columns = scenes.iter().map(|(_, curves)| curves.len() / 2).max().unwrap_or(0);
    let [step_x, step_y] = [WIDTH + MARGIN[0] + 16.0, HEIGHT + 2.0 * MARGIN[1]];
    let [width, height] = [columns as f64 * step_x, scenes.len() as f64 * step_y];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (row, (scene, curves)) in scenes.iter().enumerate() {
        for (column, both) in curves.chunks(2).enumerate() {
            let corner = [MARGIN[0] + column as f64 * step_x, MARGIN[1] + row as f64 * step_y];
            plot(&mut svg, corner, (scene, both), limits);
        }
    }
    svg + "</svg>\n"
}

fn plot(svg: &mut String, [left, top]: [f64; 2], (scene, curves): (&str, &[Curve]), limits: &[f64]) {
    let times = || curves.iter().flat_map(|curve| &curve.errors).map(|(seconds, _)| seconds.max(1e-3));
    let first = 10f64.powf(times().fold(f64::INFINITY, f64::min).log10().floor());
    let last = 10f64.powf(times().fold(0.0, f64::max).log10().ceil());
    let x = |seconds: f64| left + WIDTH * (seconds.max(first) / first).ln() / (last / first).ln();
    let share =
        |error: f64| (ERRORS[1] / error.clamp(ERRORS[0], ERRORS[1])).ln() / (ERRORS[1] / ERRORS[0]).ln();
    let y = |error: f64| top + HEIGHT * share(error);
    let mut line = |x1: f64, y1: f64, x2: f64, y2: f64, color: &str| {
        let ends = format!("x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\"");
        writeln!(svg, "<line {ends} stroke=\"{color}\"/>").unwrap();
    };
    for decade in 0..=(last / first).log10().round() as i32 {
        let at = x(first * 10f64.powi(decade));
        line(at, top, at, top + HEIGHT, "#ddd");
    }
    for error in [1e-3, 1e-2, 1e-1, 1.0] {
        line(left, y(error), left + WIDTH, y(error), "#ddd");
    }
    for &limit in limits {
        line(left, y(limit), left + WIDTH, y(limit), "#f0b0b0");
    }
    let mut text = |x: f64, y: f64, anchor: &str, color: &str, text: String| {
        writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{color}\">{text}</text>"
        )
        .unwrap();
    };
    for decade in 0..=(last / first).log10().round() as i32 {
        let seconds = first * 10f64.powi(decade);
        text(x(seconds), top + HEIGHT + 16.0, "middle", "black", format!("{seconds} s"));
    }
    for error in [1e-3, 1e-2, 1e-1, 1.0] {
        text(left - 6.0, y(error) + 4.0, "end", "black", format!("{} %", 100.0 * error));
    }
    let way = curves.first().map_or("", |curve| curve.way);
    text(left + WIDTH / 2.0, top - 24.0, "middle", "black", format!("{scene}, {way}"));
    for (k, (curve, color)) in curves.iter().zip(["#1f5fbf", "#d2691e"]).enumerate() {
        text(left + WIDTH * (0.25 + 0.5 * k as f64), top - 7.0, "middle", color, curve.order.to_owned());
    }
    for (curve, color) in curves.iter().zip(["#1f5fbf", "#d2691e"]) {
        let mut points = String::new();
        let mut before: Option<f64> = None;
        for &(seconds, error) in &curve.errors {
            // The picture stays as it is until the next step is done.
            if let Some(before) = before {
                write!(points, "{:.1},{:.1} ", x(seconds), y(before)).unwrap();
            }
            write!(points, "{:.1},{:.1} ", x(seconds), y(error)).unwrap();
            before = Some(error);
        }
        writeln!(
            svg,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.6\"/>"
        )
        .unwrap();
    }
}
