//! How fine a lightmap is.

use crate::layout::{BUDGETS, DENSITIES, LumelCount, PAGE_SIZES};
use crate::session::Session;
use crate::widgets::{check, choice, hint, number};
use eframe::egui::{DragValue, Ui};

/// Whether lumels are counted, or said to be so dense.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Budget,
    Density,
}

pub(super) fn show(session: &mut Session, ui: &mut Ui) {
    let density = session.layout().map(|layout| layout.lumels.atlas.density());
    let total = session.layout().map(|layout| layout.lumels.atlas.lumel_count() as u32);
    let lumels = &mut session.lumels;
    let before = match lumels.count {
        LumelCount::Budget(_) => Kind::Budget,
        LumelCount::PerMetre(_) => Kind::Density,
    };
    let mut kind = before;
    let name = |kind| match kind {
        Kind::Budget => "Budget".to_owned(),
        Kind::Density => "Density".to_owned(),
    };
    choice(ui, "Lumels by", "How fine the lightmap is", &mut kind, &[Kind::Budget, Kind::Density], name);
    if kind != before {
        // As fine as it was.
        lumels.count = match kind {
            Kind::Budget => LumelCount::Budget(total.unwrap_or(BUDGETS[0]).clamp(BUDGETS[0], BUDGETS[1])),
            Kind::Density => LumelCount::PerMetre(density.unwrap_or(1.0).clamp(DENSITIES[0], DENSITIES[1])),
        };
    }
    match &mut lumels.count {
        LumelCount::Budget(n) => {
            let speed = 0.01 * f64::from(*n);
            let drag = DragValue::new(n).range(BUDGETS[0]..=BUDGETS[1]).speed(speed);
            number(ui, "Lumels", "On all pages together, about", drag);
        }
        LumelCount::PerMetre(density) => {
            let speed = 0.01 * f64::from(*density);
            let drag = DragValue::new(density)
                .range(DENSITIES[0]..=DENSITIES[1])
                .speed(speed)
                .max_decimals(2)
                .suffix(" per m");
            number(ui, "Density", "Lumels per metre", drag);
        }
    }
    let about = "The largest width and height of a page; what does not fit is on further pages";
    choice(ui, "Page size", about, &mut lumels.page_size, &PAGE_SIZES, |size| size.to_string());
    let about = "Takes noise off where two halves of the samples say that it is noise";
    check(ui, "Denoise", about, &mut lumels.denoises);
    let summary = match session.layout() {
        Some(layout) => layout.summary(),
        None if session.document.is_none() => return,
        None => "Unwrapping...".to_owned(),
    };
    hint(ui, &summary);
}
