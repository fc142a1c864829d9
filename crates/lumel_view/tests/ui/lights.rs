//! Placing, changing and dragging lights.

use crate::expected::differing;
use crate::hands::CTRL;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, PointerButton, vec2};
use glam::{Vec2, Vec3};
use lumel_view::lights::EditLight;

const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..CTRL };

fn lamp(window: &Window) -> &EditLight {
    &window.state().session.lights[window.state().session.active]
}

#[test]
fn space_puts_the_light_where_the_camera_is_facing_forward() {
    let Some(mut window) = Window::room() else { return };
    window.hold(Modifiers::NONE, Key::W, 4);
    window.hold(Modifiers::NONE, Key::ArrowLeft, 4);
    window.press(Key::Space);
    let camera = window.session().camera;
    assert_eq!(lamp(&window).rect.center, camera.position);
    assert!(lamp(&window).rect.normal().unwrap().dot(camera.forward()) > 0.999);
    assert!((lamp(&window).half_edges() - Vec2::splat(0.3)).length() < 1e-5, "it keeps its size");
    assert_eq!(window.session().lights.len(), 1);
    window.session().reset_camera();
    window.click("Place here");
    assert_eq!(lamp(&window).rect.center, window.state().session.camera.position);
}

#[test]
fn space_makes_a_light_where_there_is_none() {
    let Some(mut window) = Window::builtin("furnace") else { return };
    assert!(window.session().lights.is_empty());
    window.press(Key::Space);
    assert_eq!(window.session().lights.len(), 1);
    assert_eq!(lamp(&window).rect.center, window.state().session.camera.position);
}

#[test]
fn lights_are_added_chosen_and_removed() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::Insert);
    window.click("Add");
    let names = |window: &Window| -> Vec<String> {
        window.state().session.lights.iter().map(|light| light.name.clone()).collect()
    };
    assert_eq!(names(&window), ["Lamp", "Light 1", "Light 2"]);
    assert_eq!(window.session().active, 2);
    window.click("Light 1");
    assert_eq!(window.session().active, 1);
    window.press(Key::N);
    window.press(Key::N);
    assert_eq!(window.session().active, 0, "after the last comes the first");
    window.click("Light 1");
    window.click("Remove");
    assert_eq!(names(&window), ["Lamp", "Light 2"]);
    window.press(Key::Delete);
    assert_eq!(names(&window), ["Lamp"]);
}

#[test]
fn hidden_lights_do_not_shine_and_are_not_drawn() {
    let Some(mut window) = Window::room() else { return };
    window.state_mut().prefs.view.auto_exposure = false;
    let lit = window.picture();
    window.check("Lamp on");
    assert!(!lamp(&window).on);
    let after = window.picture();
    let n = differing(&lit, &after);
    assert!(n > 2, "{n}");
    window.press(Key::H);
    assert!(lamp(&window).on);
    assert_eq!(differing(&lit, &window.picture()), 0);
}

#[test]
fn the_size_slider_keeps_a_light_square_until_one_says_otherwise() {
    let Some(mut window) = Window::room() else { return };
    window.nudge("Size", Key::ArrowRight, 3);
    let half = lamp(&window).half_edges();
    assert!(half.x > 0.301 && (half.x - half.y).abs() < 1e-5, "{half}");
    assert_eq!(lamp(&window).rect.radiance.0, Vec3::splat(10.0), "the radiance stays");
    window.check("Square");
    window.nudge("Size v", Key::ArrowLeft, 10);
    let after = lamp(&window).half_edges();
    assert!(after.y < half.y && (after.x - half.x).abs() < 1e-6, "{after}");
    window.check("Square");
    let square = lamp(&window).half_edges();
    assert!((square.x * square.y - after.x * after.y).abs() < 1e-4 && (square.x - square.y).abs() < 1e-5);
}

#[test]
fn constant_power_keeps_the_power_when_the_size_changes() {
    let Some(mut window) = Window::room() else { return };
    let power = lamp(&window).power();
    window.check("Constant power");
    window.nudge("Size", Key::ArrowLeft, 10);
    assert!(lamp(&window).half_edges().x < 0.29 && lamp(&window).rect.radiance.0.x > 10.5);
    assert!((lamp(&window).power() / power - Vec3::ONE).length() < 1e-4);
    assert!(window.reads("11.3 11.3 11.3 W"));
}

#[test]
fn intensity_and_colour_change_the_radiance() {
    let Some(mut window) = Window::room() else { return };
    window.nudge("Intensity", Key::ArrowRight, 5);
    let bright = lamp(&window).rect.radiance.0;
    assert!(bright.x > 10.1 && bright.x == bright.y && bright.y == bright.z, "{bright}");
    window.find(Role::ColorWell, "Colour").click();
    window.run_steps(4);
    window.find(Role::Slider, "Saturation").set_value_accesskit(0.5);
    window.run_steps(2);
    let red = lamp(&window).rect.radiance.0;
    assert!((red - bright * Vec3::new(1.0, 0.5, 0.5)).length() < 1e-3, "{red}");
    window.find(Role::Slider, "Hue").set_value_accesskit(240.0);
    window.run_steps(2);
    let blue = lamp(&window).rect.radiance.0;
    assert!((blue - bright * Vec3::new(0.5, 0.5, 1.0)).length() < 1e-3, "{blue}");
    // The way over white keeps the hue.
    for saturation in [0.0, 0.5] {
        window.find(Role::Slider, "Saturation").set_value_accesskit(saturation);
        window.run_steps(2);
    }
    assert_eq!(lamp(&window).rect.radiance.0, blue);
}

#[test]
fn position_and_direction_are_typed() {
    let Some(mut window) = Window::room() else { return };
    window.find(Role::SpinButton, "Position x").set_value_accesskit(0.5);
    window.run_steps(2);
    window.find(Role::SpinButton, "Elevation").set_value_accesskit(0.0);
    window.run_steps(2);
    window.find(Role::SpinButton, "Azimuth").set_value_accesskit(90.0);
    window.run_steps(2);
    assert!((lamp(&window).rect.center - Vec3::new(0.5, 1.9, 0.0)).length() < 1e-6);
    let normal = lamp(&window).rect.normal().unwrap();
    assert!((normal - Vec3::NEG_X).length() < 1e-3, "{normal}");
}

#[test]
fn a_light_is_renamed() {
    let Some(mut window) = Window::room() else { return };
    window.find(Role::TextInput, "Name").set_text_value_accesskit("Sun");
    window.run_steps(3);
    assert_eq!(lamp(&window).name, "Sun");
    assert!(window.has(Role::CheckBox, "Sun on"));
}

#[test]
fn dragging_its_handle_moves_the_light_and_nothing_else() {
    let Some(mut window) = Window::room() else { return };
    // Level with the light its axes do not cover its centre.
    window.session().camera.position = Vec3::new(0.6, 1.4, 2.5);
    window.run_steps(2);
    let camera = window.session().camera;
    let from = window.project(lamp(&window).rect.center);
    window.drag(PointerButton::Primary, from, from + vec2(40.0, 60.0));
    let center = lamp(&window).rect.center;
    assert!(
        window.project(center).distance(from + vec2(40.0, 60.0)) < 1.5,
        "it follows the pointer: {center}"
    );
    assert!((center - Vec3::new(0.0, 1.9, 0.0)).dot(camera.forward()).abs() < 1e-3, "in the picture's plane");
    assert_eq!(window.session().camera, camera);
    assert!(window.state().pick.is_none());
}

#[test]
fn dragging_an_arrow_moves_along_it_and_a_corner_resizes() {
    let Some(mut window) = Window::room() else { return };
    window.session().camera.position = Vec3::new(0.6, 1.4, 2.5);
    window.run_steps(2);
    let camera = window.session().camera;
    let center = lamp(&window).rect.center;
    let tip = center + Vec3::X * 0.12 * camera.position.distance(center);
    let from = window.project(tip);
    window.drag(PointerButton::Primary, from, from + vec2(30.0, 0.0));
    let moved = lamp(&window).rect.center - center;
    assert!(moved.x > 0.05 && moved.y == 0.0 && moved.z == 0.0, "{moved}");
    let corner = lamp(&window).rect.corners()[0];
    let from = window.project(corner);
    let outwards = (from - window.project(lamp(&window).rect.center)) * 0.3;
    window.drag(PointerButton::Primary, from, from + outwards);
    assert!(lamp(&window).half_edges().x > 0.33, "{}", lamp(&window).half_edges());
    assert_eq!(window.session().camera, camera);
}

#[test]
fn without_handles_a_drag_looks_around() {
    let Some(mut window) = Window::room() else { return };
    window.tab("Display");
    window.check("Light handles");
    let center = lamp(&window).rect.center;
    let from = window.project(center);
    window.drag(PointerButton::Primary, from, from + vec2(40.0, 40.0));
    assert_eq!(lamp(&window).rect.center, center);
    assert!(window.session().camera.yaw_deg < -1.0);
}

#[test]
fn light_moves_and_slots_are_undone_and_redone() {
    let Some(mut window) = Window::room() else { return };
    let first = lamp(&window).rect;
    window.press(Key::Space);
    let second = lamp(&window).rect;
    window.press_with(Modifiers::ALT, Key::Num1);
    assert_ne!(first, second);
    window.press_with(CTRL, Key::Z);
    assert_eq!(window.session().slots.digits().count(), 0);
    assert_eq!(lamp(&window).rect, second);
    window.press_with(CTRL, Key::Z);
    assert_eq!(lamp(&window).rect, first);
    window.press_with(CTRL_SHIFT, Key::Z);
    assert_eq!(lamp(&window).rect, second);
    window.press_with(CTRL, Key::Y);
    assert_eq!(window.session().slots.digits().count(), 1);
    window.press_with(CTRL, Key::Y);
    assert!(window.told("Nothing to redo"));
}

#[test]
fn a_drag_is_undone_at_once() {
    let Some(mut window) = Window::room() else { return };
    window.session().camera.position = Vec3::new(0.6, 1.4, 2.5);
    window.run_steps(2);
    let before = lamp(&window).rect;
    let from = window.project(before.center);
    window.drag(PointerButton::Primary, from, from + vec2(40.0, 60.0));
    assert_ne!(lamp(&window).rect, before);
    window.press_with(CTRL, Key::Z);
    assert_eq!(lamp(&window).rect, before);
}
