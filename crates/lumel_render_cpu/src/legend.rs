//! The legend of false colours.

use crate::canvas::{Canvas, INK};
use crate::false_color::{Scale, false_color};

/// Draws the legend at the right edge of a picture: the unit, and a bar with ticks and numbers.
///
/// Pictures that are too small for it stay as they are.
pub(crate) fn draw_legend(canvas: &mut Canvas<'_>, range: [f32; 2], scale: Scale) {
    let Some(layout) = Layout::fitting(canvas, range, scale) else { return };
    let Layout { unit, ticks, panel, panel_size, bar, bar_size } = layout;
    canvas.shade(panel, panel_size);
    canvas.text([panel[0] + 4 * unit, panel[1] + 4 * unit], unit as u32, UNIT);
    canvas.fill([bar[0] - unit, bar[1] - unit], [bar_size[0] + 2 * unit, bar_size[1] + 2 * unit], INK);
    for row in 0..bar_size[1] {
        // The middle of the row, from the bottom.
        let t = 1.0 - (row as f32 + 0.5) / bar_size[1] as f32;
        canvas.fill([bar[0], bar[1] + row], [bar_size[0], 1], false_color(t));
    }
    for tick in &ticks {
        let y = bar[1] + ((1.0 - tick.position) * bar_size[1] as f32).round() as i64;
        let right = bar[0] + bar_size[0];
        canvas.fill([right, y - unit / 2], [4 * unit, unit], INK);
        // The middle of digits is on that of the tick.
        let top = y - unit / 2 + (unit - Canvas::digit_height(unit as u32)) / 2;
        canvas.text([right + 6 * unit, top], unit as u32, &tick.label);
    }
}

const UNIT: &str = "W/m²";

struct Layout {
    /// Pixels per unit of length.
    unit: i64,
    ticks: Vec<Tick>,
    panel: [i64; 2],
    panel_size: [i64; 2],
    bar: [i64; 2],
    bar_size: [i64; 2],
}

/// Height of the shortest bar that can be read, units.
const SHORTEST_BAR: i64 = 40;

impl Layout {
    /// The legend with the largest text that leaves at least three quarters of the picture's width free.
    fn fitting(canvas: &Canvas<'_>, range: [f32; 2], scale: Scale) -> Option<Self> {
        let ticks = ticks(range, scale);
        (1..=i64::from(canvas.text_scale())).rev().find_map(|unit| {
            let text_width = |text: &str| Canvas::text_size(text, unit as u32)[0];
            let longest = ticks.iter().map(|tick| text_width(&tick.label)).max().unwrap_or(0);
            // Padding, bar, tick, gap, number, padding; the unit is above them.
            let inner = ((10 + 6) * unit + longest).max(text_width(UNIT));
            let width = inner + (4 + 4) * unit;
            let height = (canvas.height() * 7 / 10).max((SHORTEST_BAR + 28) * unit);
            let fits = 4 * width <= canvas.width() && height <= canvas.height();
            let panel = [canvas.width() - width - 4 * unit, (canvas.height() - height) / 2];
            fits.then(|| Self {
                unit,
                ticks: ticks.clone(),
                panel,
                panel_size: [width, height],
                bar: [panel[0] + 5 * unit, panel[1] + 20 * unit],
                bar_size: [9 * unit, height - 28 * unit],
            })
        })
    }
}

/// A tick on the colour bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// 0 at the bottom, 1 at the top.
    pub position: f32,
    /// The number.
    pub label: String,
}

/// The number of ticks aimed at.
const TICKS_WANTED: f64 = 5.0;

/// About five ticks at round numbers within a range.
pub fn ticks(range: [f32; 2], scale: Scale) -> Vec<Tick> {
    let ends = range.map(f64::from);
    let logarithmic = match scale {
        Scale::Linear => Vec::new(),
        Scale::Log => log_values(ends),
    };
    // Over less than a factor of about three, a logarithmic scale is marked in equal steps as well.
    let values = if logarithmic.len() >= 3 { logarithmic } else { linear_values(ends) };
    let mark = |(value, label): (f64, String)| Tick { position: scale.position(value as f32, range), label };
    values.into_iter().map(mark).collect()
}

/// Multiples of 1, 2 or 5 times a power of ten.
fn linear_values([lo, hi]: [f64; 2]) -> Vec<(f64, String)> {
    let raw = (hi - lo) / TICKS_WANTED;
    let decade = raw.log10().floor();
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * 10f64.powf(decade)).into_iter().find(|step| *step >= raw);
    let step = step.unwrap_or(raw);
    // The tolerance of rounding: ends that are multiples are marked.
    let (first, last) = ((lo / step - 1e-4).ceil(), (hi / step + 1e-4).floor());
    // Far from zero, floats are too coarse for steps: only the ends are marked.
    if !(last - first <= 20.0 && first.abs() < 1e9) {
        return vec![(lo, number(lo, 0.0)), (hi, number(hi, 0.0))];
    }
    let count = (last - first) as u32;
    (0..=count).map(|i| (first + f64::from(i)) * step).map(|value| (value, number(value, step))).collect()
}

/// Powers of ten, with 2 and 5 in between where there is room.
fn log_values([lo, hi]: [f64; 2]) -> Vec<(f64, String)> {
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let decades = (hi / lo).log10();
    let factors: &[f64] = if decades <= 2.2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let every = 1 + (decades / 8.0) as usize;
    let inside = |value: &f64| *value >= lo * 0.9999 && *value <= hi * 1.0001;
    let values =
        (first..=last).step_by(every).flat_map(|decade| factors.iter().map(move |f| f * 10f64.powi(decade)));
    values.filter(inside).map(|value| (value, number(value, value))).collect()
}

/// A number with the digits that the step requires.
fn number(value: f64, step: f64) -> String {
    let size = value.abs().max(step.abs());
    if size == 0.0 || value.abs() < 1e-9 * step {
        return "0".to_owned();
    }
    let exponent = size.log10().floor() as i32;
    let step_exponent = if step > 0.0 { (step.log10() + 1e-9).floor() as i32 } else { exponent - 2 };
    if !(-3..=4).contains(&exponent) {
        let digits = (exponent - step_exponent).clamp(0, 6) as usize;
        let text = format!("{value:.digits$e}");
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        let short = if digits > 0 { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
        return format!("{short}e{power}");
    }
    format!("{value:.*}", (-step_exponent).clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Picture, false_color_map};

    fn labels(range: [f32; 2], scale: Scale) -> String {
        let ticks = ticks(range, scale);
        assert!(ticks.iter().all(|t| (-1e-3..=1.001).contains(&t.position)), "{ticks:?}");
        ticks.into_iter().map(|tick| tick.label).collect::<Vec<_>>().join(" ")
    }

    /// Whether a text stands somewhere on a picture that is shaded under it and of one colour.
    fn shows(picture: &Picture, color: [u8; 3], scale: u32, text: &str) -> bool {
        let [width, height] = Canvas::text_size(text, scale).map(|length| length as u32);
        let mut wanted = Picture::new(width, height, vec![color; (width * height) as usize]).unwrap();
        wanted.canvas().shade([0, 0], [width.into(), height.into()]);
        wanted.canvas().text([0, 0], scale, text);
        let stands_at = |left: u32, top: u32| {
            (0..height).all(|y| (0..width).all(|x| picture.pixel(left + x, top + y) == wanted.pixel(x, y)))
        };
        (0..=picture.height() - height).any(|y| (0..=picture.width() - width).any(|x| stands_at(x, y)))
    }

    fn index_of(color: [u8; 3]) -> usize {
        false_color_map().iter().position(|c| *c == color).unwrap()
    }

    #[test]
    fn the_legend_contains_its_unit_and_its_numbers() {
        for (width, height, scale) in [(320, 240, 1), (640, 480, 2)] {
            let color = [40, 90, 60];
            let pixels = vec![color; (width * height) as usize];
            let mut picture = Picture::new(width, height, pixels).unwrap();
            draw_legend(&mut picture.canvas(), [0.13, 0.86], Scale::Linear);
            for text in ["W/m²", "0.2", "0.4", "0.6", "0.8"] {
                assert!(shows(&picture, color, scale, text), "{text} at {width} x {height}");
            }
            assert!(!shows(&picture, color, scale, "0.9") && !shows(&picture, color, scale, "1.0"));
            // The bar has the ends of the map, the brighter one on top.
            let layout = Layout::fitting(&picture.canvas(), [0.13, 0.86], Scale::Linear).unwrap();
            let [left, top] = layout.bar.map(|v| v as u32);
            let bottom = top + layout.bar_size[1] as u32 - 1;
            let ends = [top, bottom].map(|y| index_of(picture.pixel(left, y).unwrap()));
            assert!(ends[0] >= 253 && ends[1] <= 2, "{ends:?}");
            assert_eq!(picture.pixel(width / 2, height / 2), Some(color));
        }
    }

    #[test]
    fn ticks_point_at_the_colour_of_their_value() {
        let mut picture = Picture::new(640, 480, vec![[0; 3]; 640 * 480]).unwrap();
        draw_legend(&mut picture.canvas(), [0.0, 10.0], Scale::Linear);
        let layout = Layout::fitting(&picture.canvas(), [0.0, 10.0], Scale::Linear).unwrap();
        let [left, top] = layout.bar.map(|v| v as u32);
        let right = left + layout.bar_size[0] as u32 + 2 * layout.unit as u32;
        let rows: Vec<u32> = (top - 2..480).filter(|&y| picture.pixel(right, y) == Some(INK)).collect();
        // Ticks are two pixels thick; the second row of a tick lies below its place.
        let mid_tick = rows.chunks(2).nth(2).unwrap()[1];
        let expected = top + (layout.bar_size[1] as f32 * 0.4) as u32;
        assert!(mid_tick.abs_diff(expected) <= 1, "{rows:?} {expected}");
        let color = picture.pixel(left + 1, mid_tick).unwrap();
        let index = index_of(color);
        assert!(index.abs_diff(153) <= 2, "{index}");
    }

    #[test]
    fn pictures_too_small_for_a_legend_stay_as_they_are() {
        for (width, height) in [(1, 1), (60, 300), (300, 60)] {
            let pixels = vec![[9; 3]; (width * height) as usize];
            let mut picture = Picture::new(width, height, pixels.clone()).unwrap();
            draw_legend(&mut picture.canvas(), [0.0, 1.0], Scale::Linear);
            assert_eq!(picture.pixels(), pixels);
        }
    }

    #[test]
    fn linear_ticks_are_round_numbers() {
        assert_eq!(labels([0.0, 10.0], Scale::Linear), "0 2 4 6 8 10");
        assert_eq!(labels([0.13, 0.86], Scale::Linear), "0.2 0.4 0.6 0.8");
        assert_eq!(labels([-1.0, 1.0], Scale::Linear), "-1.0 -0.5 0 0.5 1.0");
        assert_eq!(labels([990.0, 1010.0], Scale::Linear), "990 995 1000 1005 1010");
        assert_eq!(labels([0.0, 1e6], Scale::Linear), "0 2e5 4e5 6e5 8e5 1e6");
        assert_eq!(labels([0.0, 3e-5], Scale::Linear), "0 1e-5 2e-5 3e-5");
    }

    #[test]
    fn logarithmic_ticks_are_decades_and_their_parts() {
        assert_eq!(labels([0.01, 100.0], Scale::Log), "0.01 0.1 1 10 100");
        assert_eq!(labels([0.3, 30.0], Scale::Log), "0.5 1 2 5 10 20");
        assert_eq!(labels([1e-6, 1e-2], Scale::Log), "1e-6 1e-5 1e-4 0.001 0.01");
        assert_eq!(labels([4.0, 5.0], Scale::Log), "4.0 4.2 4.4 4.6 4.8 5.0");
    }

    #[test]
    fn ticks_lie_where_their_values_do() {
        let ticks = ticks([0.0, 10.0], Scale::Linear);
        assert_eq!(ticks[1].position, 0.2);
        let logarithmic = super::ticks([0.01, 100.0], Scale::Log);
        assert!((logarithmic[2].position - 0.5).abs() < 1e-6);
    }

    #[test]
    fn odd_ranges_have_few_ticks_and_do_no_harm() {
        let ends = [[1e7, 1e7 + 1.0], [0.0, 1e-38], [-3e38, 3e38], [1e-30, 1e30], [1.0, 1.000_001]];
        for range in ends {
            for scale in [Scale::Linear, Scale::Log] {
                if scale == Scale::Linear || range[0] > 0.0 {
                    let n = super::ticks(range, scale).len();
                    assert!((2..25).contains(&n), "{range:?} {scale}: {n}");
                }
            }
        }
    }
}
