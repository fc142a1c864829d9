//! What is kept from one run to the next, and how the program is told to end from outside.

use crate::harness::{Window, folder};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, ViewportCommand};
use eframe::{App as _, Storage};
use lumel_view::prefs::ViewMode;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Default)]
struct Memory(HashMap<String, String>);

impl Storage for Memory {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

fn started_with(memory: Memory) -> Option<Window> {
    Window::start(folder(), |setup| setup.memory = Some(Box::new(memory)))
}

#[test]
fn settings_view_and_panels_come_back() {
    let Some(mut window) = Window::room() else { return };
    window.choose("View mode", "Normals");
    window.press(Key::F2);
    window.tab("Log");
    window.state_mut().prefs.speed = 3.0;
    let mut memory = Memory::default();
    window.state_mut().save(&mut memory);
    let Some(mut next) = started_with(memory) else { return };
    assert_eq!((next.state().view().mode, next.state().prefs.speed), (ViewMode::Normals, 3.0));
    assert_eq!(next.session().settings, window.session().settings);
    assert!(next.state().prefs.recent[0].ends_with("room.toml"));
    assert!(next.has(Role::Button, "Clear log"), "the panel that was in front");
}

#[test]
fn what_was_kept_by_another_version_is_no_trouble() {
    let mut memory = Memory::default();
    for key in ["lumel_view.prefs", "lumel_view.dock"] {
        memory.set_string(key, "{\"version\": 0, \"root\": 7}".to_owned());
    }
    let Some(mut window) = started_with(memory) else { return };
    assert_eq!(window.state().prefs, Default::default());
    window.tab("Camera");
}

#[test]
fn the_window_closes_when_it_is_told_from_outside() {
    let quit = Arc::new(AtomicBool::new(false));
    let ours = Arc::clone(&quit);
    let Some(mut window) = Window::start(folder(), |setup| setup.start.quit = ours) else { return };
    window.run_steps(2);
    assert!(!window.window_commands().contains(&ViewportCommand::Close));
    quit.store(true, Ordering::Relaxed);
    window.run_steps(1);
    assert!(window.window_commands().contains(&ViewportCommand::Close));
}
