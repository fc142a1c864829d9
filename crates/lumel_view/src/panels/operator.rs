//! The terms of the Neumann series as pictures: what emits, and what each application of the operator makes of it.

use super::order::NO_BOUNCES;
use crate::selection::Selection;
use crate::session::Session;
use crate::stage::{Quality, Showing, Thumbnail};
use crate::theme;
use crate::viewport::{Subject, Viewport};
use crate::widgets::hint;
use eframe::egui::emath::GuiRounding as _;
use eframe::egui::{
    self, Align2, Color32, CornerRadius, FontId, Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui, pos2, vec2,
};

/// What the symbols mean.
const ABOUT: &str =
    "emission E is transported (T) and projected onto what carries light (P), over and over; Σ is the sum";

/// More terms than this are not shown.
const MAX_TERMS: usize = 24;

/// A picture of the strip.
struct Term {
    /// Its place in the strip.
    index: usize,
    /// `E`, `PTE`, `PTPTE` and so on.
    symbol: String,
    name: String,
    /// Nothing for emission alone.
    selection: Option<Selection>,
}

pub(super) fn show(viewport: &Viewport, subject: &mut Subject<'_>, ui: &mut Ui) {
    if subject.session.light.is_empty() {
        hint(
            ui,
            "Every bounce of the light has a picture here: what shines, what that lights, what those surfaces light in turn. \
             Solve to see them; click one to show it in the view.",
        );
        return;
    }
    let quality = viewport.quality(subject.session);
    let terms = terms(subject.session);
    let height = (ui.available_height() - 10.0).clamp(40.0, 220.0);
    let width = (height * viewport.aspect()).clamp(40.0, 400.0);
    ScrollArea::horizontal().id_salt("operator").auto_shrink([false, false]).show(ui, |ui| {
        ui.horizontal(|ui| {
            for term in &terms {
                one(quality, subject, ui, term, vec2(width, height));
            }
            if !subject.session.tells_bounces() {
                ui.allocate_ui(vec2(180.0, height), |ui| hint(ui, NO_BOUNCES));
            }
        });
    });
}

fn terms(session: &Session) -> Vec<Term> {
    let light = &session.light;
    let mut terms = vec![
        Term { index: 0, symbol: "Σ".into(), name: "All light".into(), selection: Some(Selection::All) },
        Term { index: 1, symbol: "E".into(), name: "Emission".into(), selection: None },
    ];
    // A bounce has a picture once it is done.
    for k in 0..light.bounces.len().min(MAX_TERMS) {
        terms.push(Term {
            index: k + 2,
            symbol: format!("{}E", "PT".repeat(k + 1)),
            name: if k == 0 { "Direct light".into() } else { format!("Bounce {k}") },
            selection: Some(Selection::bounce(k as u32)),
        });
    }
    terms
}

fn one(quality: Quality, subject: &mut Subject<'_>, ui: &mut Ui, term: &Term, size: egui::Vec2) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::accesskit::Role::Button, true, format!("Show {}", term.name))
    });
    if !ui.is_rect_visible(rect) {
        return;
    }
    let scale = ui.ctx().pixels_per_point();
    let pixels = [rect.width(), rect.height()].map(|x| (x * scale).round().max(1.0) as u32);
    let (session, view) = (&*subject.session, &subject.prefs.view);
    let showing = Showing { session, view, split: None, marks: None, quality, ripple: None };
    let finished = session.light.bounces.len() as u32;
    let selection = match term.selection {
        // What is being measured changes all the time.
        Some(Selection::All) if quality == Quality::Live && finished > 0 => {
            Some(Selection::Range(0, finished - 1))
        }
        selection => selection,
    };
    let emits = term.selection.is_none_or(Selection::is_all);
    let wanted = Thumbnail { index: term.index, selection, emits, size: pixels };
    let shown = match subject.stage.as_mut().map(|stage| stage.thumbnail(&showing, &wanted)) {
        Some(Ok(None)) if session.document.is_some() => {
            // It is drawn in the next frame.
            ui.ctx().request_repaint();
            None
        }
        shown => shown.and_then(Result::ok).flatten(),
    };
    let painter = ui.painter();
    if let Some(shown) = &shown {
        // Texel by texel: between pixels it would be blurred.
        let size = vec2(pixels[0] as f32, pixels[1] as f32) / scale;
        painter.add(shown.picture.shape(Rect::from_min_size(rect.min.round_to_pixels(scale), size)));
    }
    let selected = term.selection == Some(subject.prefs.view.selection);
    let stroke = if selected { Stroke::new(2.0, theme::ACCENT) } else { Stroke::new(1.0, theme::LINE) };
    painter.rect_stroke(rect, CornerRadius::same(3), stroke, StrokeKind::Inside);
    if let Some(shown) = shown.filter(|shown| shown.brighter.abs() >= 0.05) {
        label(painter, rect.right_top(), &format!("{:+.1} EV", shown.brighter), Align2::RIGHT_TOP);
    }
    label(painter, rect.left_bottom(), &term.name, Align2::LEFT_BOTTOM);
    let response = response.on_hover_text(format!("{}: {}", term.symbol, ABOUT));
    if let (true, Some(selection)) = (response.clicked(), term.selection) {
        subject.prefs.view.selection = selection;
    }
}

/// Text on a dark ground in a corner of a picture.
fn label(painter: &egui::Painter, corner: egui::Pos2, text: &str, align: Align2) {
    let inside = vec2(6.0, 4.0);
    let at = pos2(
        corner.x + if align.x() == egui::Align::Min { inside.x } else { -inside.x },
        corner.y + if align.y() == egui::Align::Min { inside.y } else { -inside.y },
    );
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(11.0), theme::TEXT);
    let rect = align.anchor_size(at, galley.size());
    painter.rect_filled(rect.expand2(vec2(4.0, 1.0)), 3.0, Color32::from_black_alpha(150));
    painter.galley(rect.min, galley, theme::TEXT);
}
