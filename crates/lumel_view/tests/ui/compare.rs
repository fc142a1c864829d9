//! Two lights side by side.

use crate::expected::differing;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, PointerButton, vec2};
use lumel_view::stage::Side;

/// Keeps the light of one solve and makes another with more samples.
fn compared() -> Option<Window> {
    let mut window = Window::solved_room()?;
    window.press(Key::P);
    window.session().settings.indirect_samples = 64;
    window.solve();
    window.tab("Compare");
    Some(window)
}

#[test]
fn light_is_kept_by_key_and_button_under_what_made_it() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::P);
    assert!(window.told("There is no solution to keep yet") && window.session().kept.is_empty());
    window.solve();
    window.press(Key::P);
    window.tab("Compare");
    window.click("Keep this solution");
    let names: Vec<_> = window.session().kept.iter().map(|kept| kept.name.clone()).collect();
    assert_eq!(names, ["sobol 4+8 rays, 2 bounces, least-squares"; 2]);
    let first = window.session().kept[0].id;
    assert_eq!(window.state().comparison.right, Side::Kept(first));
    window.click("Discard");
    assert_eq!(window.session().kept.len(), 1);
}

#[test]
fn the_picture_is_split_between_two_lights() {
    let Some(mut window) = compared() else { return };
    let whole = window.picture();
    window.check("Split view");
    let split = window.state().comparison.split().unwrap();
    assert!(matches!(split.right, Side::Kept(_)) && split.at == 0.5);
    let both = window.picture();
    let half = |picture: &lumel_render_cpu::Picture, right: bool| -> Vec<[u8; 3]> {
        let (w, middle) = (picture.width() as usize, picture.width() as usize / 2);
        let columns = if right { middle + 8..w } else { 0..middle - 8 };
        picture.pixels().chunks(w).flat_map(|row| row[columns.clone()].to_vec()).collect()
    };
    assert_eq!(half(&whole, false), half(&both, false));
    assert_ne!(half(&whole, true), half(&both, true));
    window.press(Key::C);
    assert_eq!(differing(&whole, &window.picture()), 0);
}

#[test]
fn dragging_the_divider_moves_it_and_nothing_else() {
    let Some(mut window) = compared() else { return };
    window.press(Key::C);
    let camera = window.session().camera;
    // Below the lamp and its handles.
    let from = window.area().center() + vec2(0.0, 120.0);
    let before = window.picture();
    window.drag(PointerButton::Primary, from, from + vec2(150.0, 0.0));
    let at = window.state().comparison.split().unwrap().at;
    assert!((at - 0.5 - 150.0 / window.area().width()).abs() < 0.01, "{at}");
    assert_eq!(window.session().camera, camera);
    assert!(differing(&before, &window.picture()) > 5);
    window.drag(PointerButton::Primary, from + vec2(40.0, 0.0), from + vec2(80.0, 0.0));
    assert_eq!(window.state().comparison.split().unwrap().at, at, "away from it one looks around");
    assert_ne!(window.session().camera, camera);
}

#[test]
fn how_much_two_lights_differ_is_told() {
    let Some(mut window) = compared() else { return };
    assert!(window.reads("RMSE") && window.reads("Relative RMSE"), "direct light against all");
    window.check("Split view");
    let value = |window: &Window| {
        let app = window.state();
        let difference =
            app.comparison.clone().difference(&app.session, app.view().selection).cloned().unwrap();
        assert!(window.reads(&format!("{:.2} %", 100.0 * difference.relative_rmse.unwrap())));
        assert!(window.reads(&format!("{} W/m²", lumel_view::values::significant(difference.rmse as f32))));
        difference.rmse
    };
    let rough = value(&window);
    assert!(rough > 0.0);
    window.choose("Light", "Current solution");
    window.choose("Right shows", "All light");
    assert_eq!(value(&window), 0.0, "the same light");
    window.choose("Left shows", "Direct light");
    assert!(value(&window) > rough);
}

#[test]
fn a_solution_is_loaded_to_compare_with() {
    let Some(mut window) = Window::solved_room() else { return };
    let file = window.file("other.npz");
    window.press(Key::K);
    window.answer(&file);
    window.wait_for_files();
    let generation = window.session().light_generation;
    window.tab("Compare");
    window.click("Load for comparison...");
    assert!(window.reads("Compare with a solution"));
    window.answer(&file);
    window.wait_for_files();
    assert_eq!(window.session().kept[0].name, "other.npz");
    assert_eq!(window.session().light_generation, generation, "the light of the scene stays");
    window.check("Split view");
    window.run_steps(1);
    assert!(window.has(Role::ComboBox, "Light") && window.reads("0 W/m²"));
}
