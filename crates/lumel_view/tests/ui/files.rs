//! Opening scenes.

use crate::hands::CTRL;
use crate::harness::Window;
use crate::scenes::{write_mesh, write_room};
use eframe::egui::accesskit::Role;
use eframe::egui::{DroppedFile, Key};
use lumel_view::app::App;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn title(app: &App) -> String {
    app.session.document.as_ref().map_or_else(String::new, |d| d.request.title())
}

fn vertices(app: &App) -> usize {
    app.session.document.as_ref().map_or(0, |d| d.scene.vertex_count())
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

fn drop_file(window: &mut Window, path: PathBuf) {
    window.input_mut().dropped_files.push(Arc::new(Dropped(path)));
    window.run_steps(2);
    window.wait_for_files();
}

#[test]
fn m_offers_built_in_scenes() {
    let Some(mut window) = Window::empty() else { return };
    assert!(window.reads("No scene is open"));
    window.press(Key::M);
    window.click("furnace");
    window.wait_for_files();
    assert_eq!(title(window.state()), "furnace");
    assert_eq!(window.state().prefs.recent, ["furnace"]);
    assert!(!window.state().dialogs.is_any_open() && window.reads("Not solved: press Enter"));
}

#[test]
fn m_and_control_o_take_a_path() {
    let Some(mut window) = Window::empty() else { return };
    let folder = window.folder();
    let mesh = write_mesh(folder.path());
    window.press(Key::M);
    window.answer(&mesh);
    window.wait_for_files();
    assert_eq!(title(window.state()), "room.obj");
    let project = write_room(folder.path());
    window.press_with(CTRL, Key::O);
    window.find(Role::TextInput, "Path").set_text_value_accesskit(&project.to_string_lossy());
    window.run_steps(1);
    window.click("Open");
    window.wait_for_files();
    assert_eq!(title(window.state()), "room.toml");
    assert_eq!(window.session().lights[0].name, "Lamp");
    assert_eq!(window.session().settings.indirect_samples, 8);
}

#[test]
fn the_longest_edge_is_asked_for() {
    let Some(mut window) = Window::empty() else { return };
    let mesh = write_mesh(window.folder().path());
    let opened = |window: &mut Window, choice| {
        window.press(Key::M);
        window.pick(choice);
        if choice == "At most" {
            window.find(Role::SpinButton, "Longest edge").set_value_accesskit(0.25);
            window.run_steps(1);
        }
        window.answer(&mesh);
        window.wait_for_files();
        vertices(window.state())
    };
    assert_eq!(opened(&mut window, "As in the file"), 5 * 4);
    let at_most = opened(&mut window, "At most");
    assert!(at_most >= 5 * 64);
    let auto = opened(&mut window, "Automatic");
    assert!(auto > at_most);
    // How fine it became is told in the panel and where it is chosen.
    window.tab("Scene");
    assert!(window.reads("Longest edge") && window.reads("m, chosen automatically"));
    window.press(Key::M);
    assert!(window.reads("vertices: Automatic split edges to at most"));
}

#[test]
fn scenes_opened_last_are_a_click_away() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::M);
    window.click("furnace");
    window.wait_for_files();
    window.press(Key::M);
    window.click("room.toml");
    window.wait_for_files();
    assert_eq!(title(window.state()), "room.toml");
    let at = window.find(Role::Button, "File").rect().center();
    window.click_at(at);
    window.find(Role::Button, "Open recent").hover();
    window.run_steps(20);
    window.click("furnace");
    window.wait_for_files();
    assert_eq!(title(window.state()), "furnace");
}

#[test]
fn what_cannot_be_opened_is_told_and_the_scene_stays() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::M);
    window.click("Open");
    assert!(window.reads("enter a path"), "in the dialog, which stays");
    window.answer("nowhere.obj");
    window.wait_for_files();
    assert!(window.told("Cannot open nowhere.obj: there is no file") && window.reads("Cannot open"));
    let broken = window.file("broken.obj");
    std::fs::write(&broken, "v 1 2\nf 1 2 3\n").unwrap();
    drop_file(&mut window, broken);
    assert!(window.told("Cannot open broken.obj"));
    assert_eq!(title(window.state()), "room.toml");
}

#[test]
fn dialogs_close_by_cancel_and_by_escape() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::M);
    assert!(window.state().dialogs.is_any_open());
    window.click("Cancel");
    assert!(!window.state().dialogs.is_any_open());
    window.press(Key::M);
    window.press(Key::Escape);
    assert!(!window.state().dialogs.is_any_open());
}

#[test]
fn dropped_scenes_are_opened_and_dropped_solutions_shown() {
    let Some(mut window) = Window::solved_room() else { return };
    let solution = window.file("room.npz");
    window.press(Key::K);
    window.answer(&solution);
    window.wait_for_files();
    let mesh = write_mesh(window.folder().path());
    drop_file(&mut window, mesh);
    assert_eq!(title(window.state()), "room.obj");
    let project = window.file("room.toml");
    drop_file(&mut window, project);
    assert_eq!(title(window.state()), "room.toml");
    assert!(window.session().light.is_empty());
    drop_file(&mut window, solution);
    assert_eq!(window.session().light.bounce_count(), 3);
}

#[test]
fn f5_reads_the_scene_again_and_keeps_the_view() {
    let Some(mut window) = Window::room() else { return };
    window.hold(Default::default(), Key::W, 4);
    let camera = window.session().camera;
    let before = vertices(window.state());
    let project = window.file("room.toml");
    let text = std::fs::read_to_string(&project).unwrap();
    std::fs::write(&project, text.replace("max_edge = 0.25", "max_edge = 0.5")).unwrap();
    window.press(Key::F5);
    window.wait_for_files();
    assert!(vertices(window.state()) < before / 2);
    assert_eq!(window.session().camera, camera);
    assert_ne!(camera, window.state().session.document.as_ref().unwrap().home);
}

#[test]
fn opening_in_mid_solve_asks_first() {
    let Some(mut window) = Window::room() else { return };
    window.solve_for_long();
    window.press(Key::M);
    window.click("furnace");
    assert!(window.reads("The solve of room.toml has not finished."));
    window.click("Cancel");
    window.run_steps(5);
    assert!(window.state().session.is_solving() && title(window.state()) == "room.toml");
    window.press(Key::M);
    window.click("furnace");
    window.click("Open anyway");
    assert!(!window.reads("has not finished"), "it asks once");
    window.wait_for_files();
    assert!(!window.state().session.is_solving() && title(window.state()) == "furnace");
    assert!(window.session().light.is_empty());
}

#[test]
fn opening_asks_about_unsaved_light_and_unsaved_lights() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::Delete);
    window.press(Key::F5);
    assert!(window.reads("Lights, materials or slots of room.toml have unsaved changes."));
    window.click("Cancel");
    window.press_with(CTRL, Key::Z);
    window.solve();
    let project = window.file("room.toml");
    drop_file(&mut window, project);
    assert!(window.reads("The solution of room.toml is not saved."));
    window.press(Key::Escape);
    assert!(!window.reads("is not saved.") && !window.session().light.is_empty());
}
