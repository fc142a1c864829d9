//! What there is to do while nothing is open, or nothing shines.

use crate::harness::{Setup, Window, folder};
use crate::scenes::{write_mesh, write_room};
use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use lumel_view::document::OpenRequest;

fn can_solve(window: &Window) -> bool {
    !window.find(Role::Button, "Solve").accesskit_node().is_disabled()
}

#[test]
fn a_card_opens_a_built_in_scene_and_then_it_can_be_solved() {
    let Some(mut window) = Window::empty() else { return };
    assert!(!can_solve(&window));
    window.check_accessibility();
    window.click("furnace");
    window.wait_for_files();
    assert_eq!(window.state().session.document.as_ref().unwrap().request.name, "furnace");
    assert!(can_solve(&window) && !window.has(Role::Button, "Open a file..."));
}

#[test]
fn cards_of_files_that_were_open_come_back() {
    let folder = folder();
    let room = write_room(folder.path()).to_string_lossy().into_owned();
    let Some(mut window) = Window::start(folder, |_: &mut Setup| {}) else { return };
    window.state_mut().prefs.opened(&room);
    window.run_steps(2);
    window.click("room.toml");
    window.wait_for_files();
    assert_eq!(window.session().lights[0].name, "Lamp");
}

#[test]
fn the_button_of_the_start_asks_for_a_file() {
    let Some(mut window) = Window::empty() else { return };
    window.click("Open a file...");
    assert!(window.state().dialogs.is_any_open());
}

/// The room as a mesh, in which nothing shines.
fn dark() -> Option<Window> {
    let folder = folder();
    let mesh = write_mesh(folder.path()).to_string_lossy().into_owned();
    Window::start(folder, |setup| setup.start.open = Some(OpenRequest::new(mesh)))
}

#[test]
fn where_nothing_shines_a_banner_stays_until_something_does() {
    let Some(mut window) = dark() else { return };
    assert!(window.reads("Nothing shines in this scene") && !can_solve(&window));
    window.press(Key::Enter);
    assert!(window.session().light.is_empty() && window.reads("Nothing shines in this scene"));
    window.click("Place a light here");
    assert!(!window.reads("Nothing shines in this scene") && can_solve(&window));
    assert_eq!(window.session().lights.len(), 1);
    window.press(Key::H);
    assert!(window.reads("Nothing shines in this scene"));
    window.click("Switch the lights on");
    assert!(window.session().lights[0].on && can_solve(&window));
}

#[test]
fn the_banner_lights_a_scene_by_the_sky_and_it_is_solved() {
    let Some(mut window) = dark() else { return };
    window.click("Use the sky");
    assert!(!window.session().sky.sky.is_zero() && !window.reads("Nothing shines in this scene"));
    window.session().settings.indirect_samples = 8;
    window.solve();
    assert!(!window.session().light.is_empty());
}

#[test]
fn nothing_is_cut_off_in_a_usual_window() {
    let Some(mut window) = Window::room() else { return };
    for (tab, last) in [("Lights", "Elevation"), ("Solve", "More")] {
        window.tab(tab);
        window.run_steps(2);
        let found = window.get_all_by_label(last).next().unwrap().rect();
        assert!(window.ctx.content_rect().shrink(20.0).contains_rect(found), "{last}: {found}");
    }
}
