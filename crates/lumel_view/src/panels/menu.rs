//! The menus, from the table of commands.

use super::lights::kind_name;
use crate::actions::{Action, Actions};
use crate::camera::ViewSide;
use crate::dock::Pane;
use crate::document::OpenRequest;
use crate::input::Command;
use crate::prefs::ViewMode;
use crate::session::Session;
use crate::theme;
use eframe::egui::{self, Button, MenuBar, RichText, Ui};
use lumel::{Directional, LightKind};

pub(super) fn show(session: &mut Session, recent: &[String], actions: &mut Actions, ui: &mut Ui) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| {
            items(session, actions, ui, &[Command::Open, Command::Reload]);
            reopen(recent, actions, ui);
            ui.separator();
            items(session, actions, ui, &[Command::SaveProject, Command::SaveProjectAs, Command::SaveMesh]);
            ui.separator();
            use Command::{LoadSolution, SaveLightmap, SaveSolution};
            items(session, actions, ui, &[LoadSolution, SaveSolution, SaveLightmap]);
            ui.separator();
            items(session, actions, ui, &[Command::Screenshot, Command::Quit]);
        });
        ui.menu_button("Edit", |ui| items(session, actions, ui, &[Command::Undo, Command::Redo]));
        ui.menu_button("Camera", |ui| {
            use Command::{AlignUp, Frame, Parallel, ResetCamera};
            items(session, actions, ui, &[Frame, ResetCamera, AlignUp]);
            ui.separator();
            items(session, actions, ui, &ViewSide::ALL.map(Command::View));
            items(session, actions, ui, &[Parallel]);
            ui.separator();
            slots(session, ui);
        });
        ui.menu_button("Light", |ui| {
            use Command::{AddLight, AimLight, NextLight, PlaceLight, RemoveLight, ToggleLight};
            items(session, actions, ui, &[PlaceLight, AimLight, AddLight]);
            kinds(session, ui);
            ui.separator();
            items(session, actions, ui, &[RemoveLight, ToggleLight, NextLight]);
        });
        ui.menu_button("Solve", |ui| {
            items(session, actions, ui, &[Command::Solve, Command::SolveAnew, Command::Stop]);
            ui.separator();
            items(session, actions, ui, &[Command::ToggleQmc, Command::KeepLight]);
        });
        ui.menu_button("View", |ui| {
            use Command::{NextBounce, PreviousBounce, ShowAll, ShowDirect, ShowIndirect};
            items(session, actions, ui, &[ShowAll, ShowDirect, ShowIndirect, PreviousBounce, NextBounce]);
            ui.separator();
            let modes = [
                ViewMode::Charts,
                ViewMode::Chequerboard,
                ViewMode::LumelDensity,
                ViewMode::Validity,
                ViewMode::Seams,
            ];
            items(session, actions, ui, &modes.map(Command::Show));
            ui.separator();
            items(session, actions, ui, &[Command::Wireframe, Command::LumelGrid, Command::Split]);
            items(session, actions, ui, &[Command::Relief, Command::SplitRelief]);
            ui.separator();
            items(session, actions, ui, &[Command::Panels, Command::FullScreen]);
            if ui.button("Reset panel layout").clicked() {
                actions.push(Action::ArrangePanels);
                ui.close();
            }
            ui.menu_button("Panels", |ui| {
                for pane in Pane::ALL.into_iter().filter(|pane| *pane != Pane::View) {
                    if ui.button(pane.title()).clicked() {
                        actions.push(Action::ShowPanel(pane));
                        ui.close();
                    }
                }
            });
        });
        ui.menu_button("Help", |ui| items(session, actions, ui, &[Command::Help]));
        title(session, ui);
    });
}

fn items(session: &Session, actions: &mut Actions, ui: &mut Ui, commands: &[Command]) {
    ui.set_min_width(270.0);
    for &command in commands {
        let enabled = match command {
            Command::Undo => session.can_undo(),
            Command::Redo => session.can_redo(),
            Command::Reload | Command::SaveMesh | Command::SaveProject | Command::SaveProjectAs => {
                session.document.is_some()
            }
            Command::Show(mode) => !mode.needs_lumels() || session.layout().is_some(),
            Command::Relief | Command::SplitRelief => session.directional() != Directional::Off,
            Command::LumelGrid => session.layout().is_some(),
            Command::SaveLightmap => session.has_whole_lightmap(),
            Command::Stop => session.phase().is_some(),
            Command::Solve | Command::SolveAnew => session.obstacle_to_solve().is_none(),
            _ => true,
        };
        let button = Button::new(command.text()).shortcut_text(command.keys());
        if ui.add_enabled(enabled, button).clicked() {
            actions.push(command);
            ui.close();
        }
    }
}

fn reopen(names: &[String], actions: &mut Actions, ui: &mut Ui) {
    ui.add_enabled_ui(!names.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for name in names {
                if ui.button(name).clicked() {
                    actions.push(Action::Open(OpenRequest::new(name)));
                    ui.close();
                }
            }
        });
    });
}

/// Adds lights of other kinds than the usual one.
fn kinds(session: &mut Session, ui: &mut Ui) {
    let has_scene = session.document.is_some();
    for kind in LightKind::ALL.into_iter().filter(|kind| *kind != LightKind::Rect) {
        let text = format!("Add a {}", kind_name(kind).to_lowercase());
        if ui.add_enabled(has_scene, Button::new(text)).clicked() {
            session.add_light_of(kind);
            ui.close();
        }
    }
    if ui.add_enabled(has_scene, Button::new("Use a clear sky")).clicked() {
        session.use_sky();
        ui.close();
    }
}

fn slots(session: &mut Session, ui: &mut Ui) {
    let filled: Vec<u8> = session.slots.digits().collect();
    if filled.is_empty() {
        ui.label(RichText::new("No slot is filled: Alt+digit fills one").color(theme::WEAK));
    }
    for digit in filled {
        let text = format!("Recall slot {digit}");
        if ui.add(Button::new(text).shortcut_text(digit.to_string())).clicked() {
            session.recall_slot(digit);
            ui.close();
        }
    }
}

/// What is open, at the right end.
fn title(session: &Session, ui: &mut Ui) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        if let Some(document) = &session.document {
            let unsaved = session.has_unsaved_edits() || session.has_unsaved_light();
            let mark = if unsaved { " *" } else { "" };
            let text = RichText::new(format!("{}{mark}", document.request.title())).color(theme::WEAK);
            let hint = if unsaved { "Unsaved work" } else { "Everything is saved" };
            ui.add(egui::Label::new(text).truncate()).on_hover_text(hint);
        }
    });
}
