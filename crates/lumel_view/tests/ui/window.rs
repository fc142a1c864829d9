//! The window as a whole: help, panels, the line at the bottom, and rest.

use crate::expected::differing;
use crate::hands::CTRL;
use crate::harness::{Setup, Window, folder};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, PointerButton, ViewportCommand, vec2};
use lumel_view::dock::Pane;
use lumel_view::input::{Group, help};

#[test]
fn f1_lists_every_key() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::F1);
    window.run_steps(2);
    for group in Group::ALL {
        assert!(window.reads(group.title()));
        for (keys, text) in help(group) {
            assert!(window.reads(&keys) && window.reads(text), "{keys}: {text}");
        }
    }
    window.check_accessibility();
    window.press(Key::F1);
    assert!(!window.reads("Look around"));
    window.menu("Help", "Show all keys");
    assert!(window.reads("Look around"));
    window.click("Close");
    assert!(!window.reads("Look around"));
}

#[test]
fn f10_hides_the_panels_and_shows_them_again() {
    let Some(mut window) = Window::room() else { return };
    let small = window.area();
    window.press(Key::F10);
    assert_eq!(window.area(), window.ctx.content_rect());
    assert!(!window.has(Role::Slider, "Indirect samples") && !window.state().panels_visible);
    let middle = window.area().center();
    window.click_at(middle);
    window.hold(Default::default(), Key::W, 3);
    assert_ne!(window.state().session.camera, window.state().session.document.as_ref().unwrap().home);
    window.press(Key::F10);
    assert_eq!(window.area(), small);
}

#[test]
fn nothing_open_is_a_state_too() {
    let Some(mut window) = Window::empty() else { return };
    for pane in Pane::ALL.into_iter().filter(|pane| *pane != Pane::View) {
        window.tab(pane.title());
        window.check_accessibility();
    }
    for key in [Key::Enter, Key::Space, Key::F5, Key::F12, Key::P, Key::Delete, Key::N, Key::H, Key::Period] {
        window.press(key);
    }
    for key in [Key::Z, Key::Y] {
        window.press_with(CTRL, key);
    }
    assert!(window.told("Open a scene first") && window.session().document.is_none());
}

#[test]
fn panels_are_shown_from_the_menu_and_arranged_as_at_first() {
    let Some(mut window) = Window::solved_room() else { return };
    let area = window.area();
    let from = area.right_center() + vec2(2.0, 0.0);
    window.drag(PointerButton::Primary, from, from - vec2(200.0, 0.0));
    assert!(window.area().width() < area.width() - 150.0);
    window.menu("View", "Reset panel layout");
    window.run_steps(2);
    assert_eq!(window.area(), area);
}

#[test]
fn convergence_and_log_show_what_the_solve_did() {
    let Some(mut window) = Window::room() else { return };
    window.tab("Convergence");
    assert!(window.reads("are plotted here for each bounce"));
    let empty = window.render().unwrap();
    window.solve();
    assert!(!window.reads("are plotted here for each bounce"));
    window.settle();
    assert!(empty != window.render().unwrap());
    window.tab("Log");
    window.run_steps(2);
    assert!(window.reads("Opened room.toml") && window.reads("Solved: direct light and 2 bounces"));
    window.click("Copy log");
    window.click("Clear log");
    assert!(window.session().notices.all().is_empty());
}

#[test]
fn an_idle_window_draws_nothing() {
    let Some(mut window) = Window::solved_room() else { return };
    window.dismiss_messages();
    window.settle();
    let pictures = |window: &Window| window.state().stage.as_ref().unwrap().pictures;
    let before = pictures(&window);
    window.run_steps(20);
    assert_eq!(pictures(&window), before);
    let delay = window.output().viewport_output[&eframe::egui::ViewportId::ROOT].repaint_delay;
    assert!(delay > std::time::Duration::from_secs(10), "it asks for another frame after {delay:?}");
    window.hold(Default::default(), Key::W, 1);
    assert!(pictures(&window) > before);
}

#[test]
fn a_software_renderer_is_told() {
    let Some(mut window) = Window::room() else { return };
    let gpu = window.state().stage.as_ref().unwrap().gpu();
    let (software, name) = (gpu.is_software(), gpu.name());
    assert_eq!(window.reads("software renderer"), software);
    assert!(software || window.reads(&name));
    window.tab("Log");
    window.run_steps(2);
    assert!(window.told(&name));
}

#[test]
fn messages_go_when_they_are_clicked() {
    let Some(mut window) = Window::room() else { return };
    assert!(window.reads("Opened room.toml"));
    window.dismiss_messages();
    assert!(!window.reads("Opened room.toml") && window.told("Opened room.toml"));
    assert!(window.state().pick.is_none(), "the click does not go through");
}

#[test]
fn the_window_is_asked_to_fill_the_screen_and_to_close() {
    let Some(mut window) = Window::room() else { return };
    let asked = |window: &mut Window, wanted: &ViewportCommand| {
        window.run_steps(1);
        window.window_commands().contains(wanted)
    };
    window.key_down(Key::F11);
    assert!(asked(&mut window, &ViewportCommand::Fullscreen(true)));
    window.key_up(Key::F11);
    assert!(!asked(&mut window, &ViewportCommand::Close));
    window.event(eframe::egui::Event::Key {
        key: Key::Q,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: CTRL,
    });
    assert!(asked(&mut window, &ViewportCommand::Close));
}

#[test]
fn menus_do_what_keys_do() {
    let Some(mut window) = Window::room() else { return };
    let before = window.picture();
    window.menu("Light", "Hide or show the light");
    assert!(!window.session().lights[0].on);
    window.menu("Edit", "Undo a change to lights, materials or slots");
    assert!(window.session().lights[0].on);
    assert_eq!(differing(&before, &window.picture()), 0);
    window.menu("Solve", "Start or resume the solve");
    window.wait_until("the solve", |app| app.session.computed().is_some_and(|c| c.complete));
}

#[test]
fn memory_and_frame_time_are_told() {
    let shown = |setup: &mut Setup| setup.start.shows_gauges = true;
    let Some(mut window) = Window::start(folder(), shown) else { return };
    window.run_steps(2);
    assert_eq!(window.reads("iB"), cfg!(target_os = "linux"));
}
