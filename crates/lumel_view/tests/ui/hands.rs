//! Hands and eyes: keys, the mouse, and widgets by their roles and names.

use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, vec2};
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable, by};
use lumel_render_cpu::Lens;
use lumel_view::input::Pad;
use std::path::Path;

/// The height of tabs, which tells them from other buttons that stay down.
const TAB: f32 = 26.0;

/// Control, as egui reports it.
pub(crate) const CTRL: Modifiers = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };

impl Window {
    // Keys.

    pub(crate) fn press(&mut self, key: Key) {
        self.press_with(Modifiers::NONE, key);
    }

    pub(crate) fn press_with(&mut self, modifiers: Modifiers, key: Key) {
        self.key_press_modifiers(modifiers, key);
        self.run_steps(2);
    }

    /// Presses a key of the number pad, whose lock is on.
    pub(crate) fn press_pad(&mut self, pad: Pad, modifiers: Modifiers) {
        let key = match pad {
            Pad::Digit(digit) => Key::from_name(&digit.to_string()).unwrap(),
            Pad::Decimal => Key::Period,
        };
        self.numpad.press(pad);
        self.press_with(modifiers, key);
    }

    /// Holds a key for a number of frames.
    pub(crate) fn hold(&mut self, modifiers: Modifiers, key: Key, frames: usize) {
        self.event(Event::ModifiersChanged(modifiers));
        let event = |pressed| Event::Key { key, pressed, modifiers, repeat: false, physical_key: None };
        self.event(event(true));
        self.run_steps(frames);
        self.event(event(false));
        self.event(Event::ModifiersChanged(Modifiers::NONE));
        self.run_steps(1);
    }

    // Mouse.

    fn button_event(&mut self, pos: Pos2, button: PointerButton, pressed: bool) {
        self.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        self.run_steps(1);
    }

    /// Drags in a few steps, and leaves the window.
    pub(crate) fn drag(&mut self, button: PointerButton, from: Pos2, to: Pos2) {
        self.drag_with(Modifiers::NONE, button, from, to);
    }

    /// Drags while keys are held.
    pub(crate) fn drag_with(&mut self, modifiers: Modifiers, button: PointerButton, from: Pos2, to: Pos2) {
        self.event(Event::ModifiersChanged(modifiers));
        self.hover_at(from);
        self.run_steps(1);
        self.button_event(from, button, true);
        for step in 1..=4 {
            self.hover_at(from.lerp(to, 0.25 * step as f32));
            self.run_steps(1);
        }
        self.button_event(to, button, false);
        self.event(Event::ModifiersChanged(Modifiers::NONE));
        self.remove_cursor();
        self.run_steps(1);
    }

    pub(crate) fn click_at(&mut self, pos: Pos2) {
        self.hover_at(pos);
        self.run_steps(1);
        self.press_and_release(pos);
    }

    fn press_and_release(&mut self, pos: Pos2) {
        self.button_event(pos, PointerButton::Primary, true);
        self.button_event(pos, PointerButton::Primary, false);
        self.remove_cursor();
        self.run_steps(1);
    }

    /// Clicks in the middle of a widget, after it was scrolled into sight.
    #[track_caller]
    fn click_on(&mut self, role: Role, label: &str) {
        self.find(role, label).scroll_to_me();
        self.run_steps(4);
        self.click_in_sight(role, label);
    }

    /// Clicks in the middle of a widget that can be seen, wherever what goes on in the background moves it meanwhile.
    #[track_caller]
    fn click_in_sight(&mut self, role: Role, label: &str) {
        let center = |window: &Self| window.find(role, label).rect().center();
        let mut at = center(self);
        loop {
            self.hover_at(at);
            self.run_steps(1);
            match center(self) {
                now if now == at => return self.press_and_release(at),
                now => at = now,
            }
        }
    }

    // What is in the window.

    /// A widget by its role and name. Of several the last, which is in a dialog or a panel rather than in the menu.
    #[track_caller]
    pub(crate) fn find<'a>(&'a self, role: Role, label: &'a str) -> Node<'a> {
        let found = self.query_all(by().role(role).label(label)).rfind(|node| !is_tab(node));
        found.unwrap_or_else(|| panic!("there is no {role:?} \"{label}\" in\n{}", self.inventory()))
    }

    /// Whether there is such a widget.
    pub(crate) fn has(&self, role: Role, label: &str) -> bool {
        self.query_all(by().role(role).label(label)).next().is_some()
    }

    /// Whether some text is to be read anywhere.
    pub(crate) fn reads(&self, text: &str) -> bool {
        self.query_all(by().role(Role::Label).label_contains(text).include_labels()).next().is_some()
    }

    /// Whether something was told.
    pub(crate) fn told(&self, text: &str) -> bool {
        self.state().session.notices.all().iter().any(|notice| notice.text.contains(text))
    }

    /// All texts in the window.
    pub(crate) fn texts(&self) -> String {
        let labels = self.query_all(by().role(Role::Label));
        labels.filter_map(|label| label.value()).collect::<Vec<_>>().join("\n")
    }

    /// All names in the window, for messages.
    fn inventory(&self) -> String {
        let text = |node: Node<'_>| {
            let node = node.accesskit_node();
            Some(format!("{:?} {}", node.role(), node.label().or(node.value())?))
        };
        self.root().children_recursive().filter_map(text).collect::<Vec<_>>().join("\n")
    }

    #[track_caller]
    pub(crate) fn click(&mut self, button: &str) {
        self.click_on(Role::Button, button);
    }

    #[track_caller]
    pub(crate) fn check(&mut self, label: &str) {
        self.click_on(Role::CheckBox, label);
    }

    /// Takes one of several choices.
    #[track_caller]
    pub(crate) fn pick(&mut self, label: &str) {
        self.click_on(Role::RadioButton, label);
    }

    /// Brings a panel to the front by its tab.
    #[track_caller]
    pub(crate) fn tab(&mut self, title: &str) {
        let tab = self.query_all(by().role(Role::Button).label(title)).find(is_tab);
        let at = tab.unwrap().rect().center();
        self.click_at(at);
    }

    /// Chooses from a menu.
    #[track_caller]
    pub(crate) fn menu(&mut self, menu: &str, item: &str) {
        let at = self.query_all(by().role(Role::Button).label(menu)).next().unwrap().rect().center();
        self.click_at(at);
        let at =
            self.get_all(by().role(Role::Button).label_contains(item)).next_back().unwrap().rect().center();
        self.click_at(at);
    }

    /// Chooses from a list.
    #[track_caller]
    pub(crate) fn choose(&mut self, list: &str, option: &str) {
        self.click_on(Role::ComboBox, list);
        self.run_steps(1);
        self.click_in_sight(Role::Button, option);
    }

    /// Moves a slider by arrow keys.
    #[track_caller]
    pub(crate) fn nudge(&mut self, slider: &str, key: Key, times: usize) {
        self.find(Role::Slider, slider).focus();
        self.run_steps(1);
        (0..times).for_each(|_| self.press(key));
    }

    /// Writes into the path of a dialog.
    #[track_caller]
    pub(crate) fn write_path(&mut self, path: impl AsRef<Path>) {
        let path = path.as_ref().to_string_lossy();
        self.find(Role::TextInput, "Path").set_text_value_accesskit(&path);
        self.run_steps(2);
    }

    /// Writes into the path of a dialog and presses Enter.
    #[track_caller]
    pub(crate) fn answer(&mut self, path: impl AsRef<Path>) {
        self.write_path(path);
        self.find(Role::TextInput, "Path").focus();
        self.run_steps(1);
        self.press(Key::Enter);
    }

    /// Clicks all messages away.
    pub(crate) fn dismiss_messages(&mut self) {
        let texts: Vec<String> =
            self.state().session.notices.all().iter().map(|notice| notice.text.clone()).collect();
        for text in texts {
            let message =
                self.query_all(by().role(Role::Label).label(&text)).next_back().map(|m| m.rect().center());
            if let Some(at) = message {
                self.click_at(at);
                // The others take its place.
                self.run_steps(2);
            }
        }
    }

    /// Where the picture is.
    pub(crate) fn area(&self) -> Rect {
        self.find(Role::Canvas, "Scene").rect()
    }

    /// Where a point of the scene is in the window.
    pub(crate) fn project(&self, point: glam::Vec3) -> Pos2 {
        let area = self.area();
        let lens = Lens::new(&self.state().session.camera.camera(), area.width() / area.height()).unwrap();
        let at = lens.project(point).unwrap();
        area.lerp_inside(vec2(at.x, at.y))
    }
}

fn is_tab(node: &Node<'_>) -> bool {
    let is_button = node.accesskit_node().role() == Role::Button;
    is_button && node.accesskit_node().toggled().is_some() && node.rect().height() == TAB
}
