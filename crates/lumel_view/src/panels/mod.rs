//! The parts of the window around the picture, and where they are.

mod atlas;
mod camera;
mod compare;
mod convergence;
mod course;
mod display;
mod emissive;
mod lights;
mod log;
mod lumels;
mod menu;
mod operator;
mod order;
mod relief;
mod scene;
mod settings;
mod sky;
mod solve;
mod status;

pub(crate) use order::NO_BOUNCES;

use crate::atlas_view::AtlasView;
use crate::dock::{self, Pane};
use crate::gauges::Gauges;
use crate::theme::{self, Ground};
use crate::viewport::{Subject, Viewport};
use eframe::egui::{self, CentralPanel, Frame, Margin, Panel, ScrollArea, Ui, WidgetText};
use egui_tiles::{Behavior, SimplificationOptions, TabState, TileId, Tiles, Tree, UiResponse};

/// What the panels show and change.
pub(crate) struct Panels<'a> {
    pub(crate) subject: Subject<'a>,
    pub(crate) viewport: &'a mut Viewport,
    pub(crate) atlas: &'a mut AtlasView,
    pub(crate) gauges: Option<&'a Gauges>,
    pub(crate) ground: Ground,
}

impl Panels<'_> {
    /// Draws the picture alone.
    pub(crate) fn picture(&mut self, ui: &mut Ui) {
        CentralPanel::default().frame(Frame::new()).show(ui, |ui| self.viewport.show(&mut self.subject, ui));
    }

    /// Draws the menus, the status bar and all panels between them.
    pub(crate) fn all(&mut self, dock: &mut Tree<Pane>, ui: &mut Ui) {
        let frame = self.ground.frame().inner_margin(Margin::symmetric(8, 3));
        Panel::top("menu").frame(frame).show(ui, |ui| {
            let Subject { session, prefs, actions, .. } = &mut self.subject;
            menu::show(session, &prefs.recent, actions, ui);
        });
        Panel::bottom("status").frame(frame).show(ui, |ui| {
            let Subject { session, stage, prefs, .. } = &self.subject;
            status::show(session, stage.as_deref(), prefs, self.gauges, ui);
        });
        CentralPanel::default().frame(Frame::new()).show(ui, |ui| dock.ui(self, ui));
    }

    fn panel(&mut self, pane: Pane, ui: &mut Ui) {
        if pane == Pane::Operator {
            return operator::show(self.viewport, &mut self.subject, ui);
        }
        let Subject { session, prefs, stage, comparison, actions, .. } = &mut self.subject;
        match pane {
            Pane::View | Pane::Operator => {}
            Pane::Atlas => {
                let stops = stage.as_deref().map_or(0.0, |stage| stage.stops(&prefs.view));
                atlas::show(session, &prefs.view, stops, self.atlas, ui);
            }
            Pane::Convergence => convergence::show(session, &mut prefs.view.plot, ui),
            Pane::Log => log::show(&mut session.notices, ui),
            Pane::Solve => scrolled(ui, "solve", |ui| solve::show(session, actions, ui)),
            Pane::Lights => scrolled(ui, "lights", |ui| lights::show(session, actions, ui)),
            Pane::Display => {
                scrolled(ui, "display", |ui| {
                    display::show(session, stage.as_deref(), &mut prefs.view, ui);
                });
            }
            Pane::Camera => scrolled(ui, "camera", |ui| camera::show(session, prefs, actions, ui)),
            Pane::Compare => scrolled(ui, "compare", |ui| {
                compare::show(session, comparison, &mut prefs.view.selection, actions, ui);
            }),
            Pane::Scene => scrolled(ui, "scene", |ui| scene::show(session, ui)),
        }
    }
}

impl Behavior<Pane> for Panels<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        if *pane == Pane::View {
            self.viewport.show(&mut self.subject, ui);
            return UiResponse::None;
        }
        self.ground.frame().inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
            ui.set_min_size(ui.available_size());
            self.panel(*pane, ui);
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
