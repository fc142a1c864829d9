//! In which order light is transported, and what one of them leaves out.

use crate::widgets::hint;
use eframe::egui::Ui;
use lumel::{BounceLimit, Settings};

/// Why bounces cannot be told apart.
pub(crate) const NO_BOUNCES: &str =
    "Shots tell no bounces apart: each bounce by itself can be had with Gather only.";

/// Says what the chosen order leaves out.
pub(super) fn note(ui: &mut Ui, settings: &Settings) {
    if !settings.tells_bounces() {
        hint(ui, NO_BOUNCES);
    }
}

/// Takes back a number of bounces where the chosen order has none: a preset may have asked for it.
pub(super) fn fit(settings: &mut Settings) {
    if !settings.tells_bounces() {
        settings.bounces = BounceLimit::All;
    }
}
