//! The parts of the window.

mod camera;
mod compare;
mod convergence;
mod display;
mod inspector;
mod legend;
mod lights;
mod log;
mod marks;
mod menu;
mod operator;
mod overlay;
mod scene;
mod settings;
mod solve;
mod status;

pub(crate) use marks::{MarksKey, marks};
pub(crate) use menu::menu;
pub(crate) use overlay::over_picture;
pub(crate) use status::status;

use crate::app::{App, panel_frame};
use crate::dock::{self, Pane};
use crate::theme;
use eframe::egui::{self, Margin, ScrollArea, Ui, WidgetText};
use egui_tiles::{Behavior, SimplificationOptions, TabState, TileId, Tiles, UiResponse};

/// Draws the panels of the dock.
pub(crate) struct Panes<'a>(pub(crate) &'a mut App);

/// Draws the picture.
pub(crate) fn viewport(app: &mut App, ui: &mut Ui) {
    crate::viewport::show(app, ui);
}

impl Behavior<Pane> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        if *pane == Pane::View {
            viewport(self.0, ui);
            return UiResponse::None;
        }
        let ground = self.0.ground;
        panel_frame(ground).inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
            let app = &mut *self.0;
            ui.set_min_size(ui.available_size());
            match pane {
                Pane::View => {}
                Pane::Operator => operator::show(app, ui),
                Pane::Convergence => convergence::show(app, ui),
                Pane::Log => log::show(app, ui),
                Pane::Solve => scrolled(ui, "solve", |ui| solve::show(app, ui)),
                Pane::Lights => scrolled(ui, "lights", |ui| lights::show(app, ui)),
                Pane::Display => scrolled(ui, "display", |ui| display::show(app, ui)),
                Pane::Camera => scrolled(ui, "camera", |ui| camera::show(app, ui)),
                Pane::Compare => scrolled(ui, "compare", |ui| compare::show(app, ui)),
                Pane::Scene => scrolled(ui, "scene", |ui| scene::show(app, ui)),
            }
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.title().into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        dock::simplification()
    }

    fn tab_bar_color(&self, _visuals: &egui::Visuals) -> egui::Color32 {
        theme::DEEP
    }

    fn tab_bg_color(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        state: &TabState,
    ) -> egui::Color32 {
        if state.active { theme::PANEL } else { theme::DEEP }
    }

    fn tab_text_color(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        state: &TabState,
    ) -> egui::Color32 {
        if state.active { theme::ACCENT } else { theme::WEAK }
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        26.0
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        3.0
    }

    fn min_size(&self) -> f32 {
        90.0
    }
}

/// A panel that may be longer than it has room for.
fn scrolled(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().id_salt(id).auto_shrink([false, false]).show(ui, |ui| {
        // Room for the bar, so that it covers nothing.
        ui.set_max_width(ui.available_width() - 8.0);
        add(ui);
    });
}

/// Tells that something has to be done first.
fn hint(ui: &mut Ui, text: &str) {
    ui.add_space(4.0);
    ui.add(egui::Label::new(egui::RichText::new(text).color(theme::WEAK)).wrap());
}
