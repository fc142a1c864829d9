//! The bar that explains false colours.

use crate::prefs::{Unit, ViewMode, ViewPrefs};
use crate::theme;
use eframe::egui::{Align2, Color32, FontId, Rect, Stroke, Ui, pos2, vec2};
use lumel_render_cpu::{Scale, Tick, false_color, ticks};

/// Draws the legend of a range of W/m² at the right edge of the picture.
pub(super) fn show(view: &ViewPrefs, range: Option<[f32; 2]>, ui: &Ui, rect: Rect) {
    let Some(range) = range.filter(|_| view.mode.has_legend()) else { return };
    if rect.height() < 160.0 || rect.width() < 200.0 {
        return;
    }
    let (unit, factor) = match (view.mode, view.unit) {
        (ViewMode::TriangleSize, _) => ("m", Some(1.0)),
        (ViewMode::LumelDensity, _) => ("per m", Some(1.0)),
        (ViewMode::Bends, _) => ("of allowed", Some(1.0)),
        (ViewMode::FalseColor, Unit::Lux) => ("lux", Some(view.efficacy)),
        (ViewMode::FalseColor, Unit::Stops) => ("stops", None),
        _ => ("W/m²", Some(1.0)),
    };
    let panel = Rect::from_min_size(
        pos2(rect.right() - 92.0, rect.top() + 48.0),
        vec2(82.0, (rect.height() - 110.0).min(300.0)),
    );
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(panel, 6.0, Color32::from_black_alpha(170));
    painter.text(
        panel.left_top() + vec2(10.0, 7.0),
        Align2::LEFT_TOP,
        unit,
        FontId::proportional(12.0),
        theme::TEXT,
    );
    let bar =
        Rect::from_min_max(panel.min + vec2(10.0, 30.0), pos2(panel.left() + 26.0, panel.bottom() - 12.0));
    let rows = bar.height() as usize;
    for row in 0..rows {
        let t = 1.0 - (row as f32 + 0.5) / rows as f32;
        let [r, g, b] = false_color(t);
        let strip = Rect::from_min_size(pos2(bar.left(), bar.top() + row as f32), vec2(bar.width(), 1.5));
        painter.rect_filled(strip, 0.0, Color32::from_rgb(r, g, b));
    }
    let marks = match factor {
        Some(factor) => ticks(range.map(|x| x * factor), view.scale()),
        None => stops(range, view.scale()),
    };
    for tick in marks {
        let y = bar.bottom() - tick.position.clamp(0.0, 1.0) * bar.height();
        painter
            .line_segment([pos2(bar.right(), y), pos2(bar.right() + 4.0, y)], Stroke::new(1.0, theme::TEXT));
        painter.text(
            pos2(bar.right() + 7.0, y),
            Align2::LEFT_CENTER,
            tick.label,
            FontId::proportional(11.0),
            theme::TEXT,
        );
    }
}

/// Whole stops within a range of W/m², as many as fit.
fn stops([lo, hi]: [f32; 2], scale: Scale) -> Vec<Tick> {
    let (first, last) = (lo.max(hi * 1e-6).log2().ceil() as i32, hi.log2().floor() as i32);
    let step = match scale {
        Scale::Linear => 1,
        Scale::Log => ((last - first) / 6).max(1) as usize,
    };
    let tick = |stop: i32| {
        let position = scale.position((stop as f32).exp2(), [lo, hi]);
        Tick { position, label: format!("{stop:+}") }
    };
    // On a linear scale the lower stops lie on top of each other.
    let mut marks: Vec<Tick> = Vec::new();
    for mark in (first..=last).rev().step_by(step).map(tick) {
        if marks.last().is_none_or(|above| above.position - mark.position > 0.05) {
            marks.push(mark);
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_are_whole_and_apart() {
        let labels =
            |range, scale| stops(range, scale).into_iter().map(|t| t.label).collect::<Vec<_>>().join(" ");
        assert_eq!(labels([0.25, 4.0], Scale::Log), "+2 +1 +0 -1 -2");
        // On a linear scale they crowd at its start, where most are left out.
        assert_eq!(labels([0.0, 4.0], Scale::Linear), "+2 +1 +0 -1 -2 -5");
        assert!(stops([0.001, 1000.0], Scale::Log).len() < 14);
    }
}
