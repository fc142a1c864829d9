//! The menus: all commands, from the table of keys.

use crate::app::App;
use crate::dock::Pane;
use crate::input::Command;
use crate::theme;
use eframe::egui::{self, Button, MenuBar, RichText, Ui};

pub(crate) fn menu(app: &mut App, ui: &mut Ui) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| {
            items(app, ui, &[Command::Open, Command::Reload]);
            recent(app, ui);
            ui.separator();
            items(app, ui, &[Command::SaveProject, Command::SaveProjectAs, Command::SaveMesh]);
            ui.separator();
            items(app, ui, &[Command::LoadSolution, Command::SaveSolution]);
            ui.separator();
            items(app, ui, &[Command::Screenshot, Command::Quit]);
        });
        ui.menu_button("Edit", |ui| items(app, ui, &[Command::Undo, Command::Redo]));
        ui.menu_button("Camera", |ui| {
            items(app, ui, &[Command::AlignUp, Command::ResetCamera]);
            ui.separator();
            slots(app, ui);
        });
        ui.menu_button("Light", |ui| {
            use Command::{AddLight, NextLight, PlaceLight, RemoveLight, ToggleLight};
            items(app, ui, &[PlaceLight, AddLight, RemoveLight, ToggleLight, NextLight]);
        });
        ui.menu_button("Solve", |ui| {
            items(app, ui, &[Command::Solve, Command::SolveAnew, Command::Stop]);
            ui.separator();
            items(app, ui, &[Command::ToggleQmc, Command::KeepLight]);
        });
        ui.menu_button("View", |ui| {
            use Command::{NextBounce, PreviousBounce, ShowAll, ShowDirect, ShowIndirect};
            items(app, ui, &[ShowAll, ShowDirect, ShowIndirect, PreviousBounce, NextBounce]);
            ui.separator();
            items(app, ui, &[Command::Wireframe, Command::Split]);
            ui.separator();
            items(app, ui, &[Command::Panels, Command::FullScreen]);
            if ui.button("Arrange panels as at first").clicked() {
                app.reset_panels();
                ui.close();
            }
            ui.menu_button("Panels", |ui| {
                for pane in Pane::ALL.into_iter().filter(|pane| *pane != Pane::View) {
                    if ui.button(pane.title()).clicked() {
                        app.show_panel(pane);
                        ui.close();
                    }
                }
            });
        });
        ui.menu_button("Help", |ui| items(app, ui, &[Command::Help]));
        title(app, ui);
    });
}

fn items(app: &mut App, ui: &mut Ui, commands: &[Command]) {
    ui.set_min_width(270.0);
    for &command in commands {
        let enabled = match command {
            Command::Undo => app.session.can_undo(),
            Command::Redo => app.session.can_redo(),
            Command::Reload | Command::SaveMesh | Command::SaveProject | Command::SaveProjectAs => {
                app.session.document.is_some()
            }
            Command::Stop => app.session.phase().is_some(),
            _ => true,
        };
        let button = Button::new(command.text()).shortcut_text(command.keys());
        if ui.add_enabled(enabled, button).clicked() {
            let ctx = ui.ctx().clone();
            app.run(command, &ctx);
            ui.close();
        }
    }
}

fn recent(app: &mut App, ui: &mut Ui) {
    let names = app.prefs.recent.clone();
    ui.add_enabled_ui(!names.is_empty(), |ui| {
        ui.menu_button("Open again", |ui| {
            for name in names {
                if ui.button(&name).clicked() {
                    app.open(crate::document::OpenRequest::new(name));
                    ui.close();
                }
            }
        });
    });
}

fn slots(app: &mut App, ui: &mut Ui) {
    for digit in 0..10 {
        let kept = app.session.slots.get(digit).is_some();
        let text = format!("Recall camera, lights and settings {digit}");
        if ui.add_enabled(kept, Button::new(text).shortcut_text(digit.to_string())).clicked() {
            app.session.recall_slot(digit);
            ui.close();
        }
    }
}

/// What is open, at the right end.
fn title(app: &App, ui: &mut Ui) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        if let Some(document) = &app.session.document {
            let unsaved = app.session.has_unsaved_edits() || app.session.has_unsaved_light();
            let mark = if unsaved { " *" } else { "" };
            let text = RichText::new(format!("{}{mark}", document.request.title())).color(theme::WEAK);
            let hint = if unsaved { "There is unsaved work" } else { "All is saved" };
            ui.add(egui::Label::new(text).truncate()).on_hover_text(hint);
        }
    });
}
