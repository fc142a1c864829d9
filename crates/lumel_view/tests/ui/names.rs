//! Everything in the window has a name and fits, and every character of its texts has a glyph: the harness stops at
//! one that has none.

use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, Pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable, by};
use lumel_view::dock::Pane;
use lumel_view::layout::LightBasis;

#[test]
fn every_panel_shows_itself_and_every_widget_has_a_name() {
    for solved in [false, true] {
        let Some(mut window) = (if solved { Window::solved_room() } else { Window::room() }) else { return };
        for pane in Pane::ALL.into_iter().filter(|pane| *pane != Pane::View) {
            window.tab(pane.title());
            window.run_steps(2);
            window.check_accessibility();
        }
        for (tab, text) in [
            ("Scene", "Triangles"),
            ("Lights", "Active light"),
            ("Display", "Overlays"),
            ("Camera", "Slots"),
            ("Compare", "Right"),
        ] {
            window.tab(tab);
            assert!(window.reads(text), "{tab}");
        }
    }
}

#[test]
fn dialogs_have_names_for_all_their_widgets() {
    let Some(mut window) = Window::solved_room() else { return };
    for key in [Key::M, Key::O, Key::K, Key::L, Key::F1] {
        window.press(key);
        assert!(window.state().dialogs.is_any_open(), "{key:?}");
        window.check_accessibility();
        window.press(Key::Escape);
        assert!(!window.state().dialogs.is_any_open(), "{key:?}");
    }
    window.press_with(Modifiers::SHIFT, Key::K);
    window.check_accessibility();
}

#[test]
fn everything_fits_into_a_small_window() {
    let Some(mut window) = Window::solved_room() else { return };
    window.session().lumels.basis = LightBasis::Lightmap;
    window.wait_until("the unwrap", |app| app.session.layout().is_some());
    window.set_size(vec2(1000.0, 640.0));
    for tab in ["Lights", "Display", "Camera", "Compare", "Scene", "Solve"] {
        window.tab(tab);
        window.run_steps(3);
        for role in [Role::Slider, Role::SpinButton, Role::ComboBox, Role::CheckBox, Role::TextInput] {
            for widget in window.query_all(by().role(role)) {
                assert!(widget.rect().right() <= 1000.0, "{tab}: {widget:?}");
            }
        }
    }
}

#[test]
fn every_menu_opens() {
    let Some(mut window) = Window::solved_room() else { return };
    for (menu, item) in [
        ("File", "Save the solution"),
        ("Edit", "Redo"),
        ("Camera", "View from the top"),
        ("Light", "Select the next light"),
        ("Solve", "Keep this solution for comparison"),
        ("View", "Full screen"),
        ("Help", "Show all keys"),
    ] {
        let at = window.get_all_by_label(menu).next().unwrap().rect().center();
        window.click_at(at);
        assert!(window.query_all(by().role(Role::Button).label_contains(item)).next().is_some(), "{menu}");
        window.check_accessibility();
        window.press(Key::Escape);
    }
}

/// The middles of all widgets within a part of the window.
fn middles(window: &Window) -> Vec<Pos2> {
    let roles = [Role::Button, Role::Slider, Role::SpinButton, Role::ComboBox, Role::CheckBox, Role::Label];
    let nodes = window.root().children_recursive();
    let shown = nodes.filter(|node| roles.contains(&node.accesskit_node().role()));
    let middles = shown.filter(|n| n.accesskit_node().bounding_box().is_some()).map(|n| n.rect().center());
    middles.filter(|at| window.ctx.content_rect().contains(*at)).collect()
}

/// Hovers over widgets and collects what is to be read then.
fn hover_all(window: &mut Window) -> String {
    let mut texts = String::new();
    // Hints wait until a click is past.
    window.run_steps(12);
    for at in middles(window) {
        window.hover_at(at);
        window.run_steps(8);
        texts += &window.texts();
    }
    window.remove_cursor();
    window.run_steps(2);
    texts
}

#[test]
fn hints_appear_under_the_pointer() {
    let Some(mut window) = Window::solved_room() else { return };
    window.ctx.all_styles_mut(|style| style.interaction.tooltip_delay = 0.0);
    let mut texts = String::new();
    for tab in ["Display", "Camera", "Compare", "Solve", "Lights"] {
        window.tab(tab);
        texts += &hover_all(&mut window);
    }
    for text in [
        "Shadow rays per vertex and light",
        "Radiance: albedo × irradiance / π, plus emission",
        "Each stop doubles the light",
        "Vertical",
        "Keeps the light as it is now, to compare with (P)",
        "Radiance of the brightest channel, W/(m² sr)",
        "Unsaved work",
    ] {
        assert!(texts.contains(text), "{text}");
    }
    let at = window.find(Role::ComboBox, "View mode").rect().center();
    window.click_at(at);
    assert!(hover_all(&mut window).contains("Mean edge length around each vertex"));
}
