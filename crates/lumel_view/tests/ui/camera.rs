//! Flying: keys and mouse over the picture, and the panel of the camera.

use crate::hands::CTRL;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, TouchPhase, vec2,
};
use glam::Vec3;
use lumel_view::camera::FlyCamera;

/// Where a key takes the camera within a tenth of a second.
fn flown(window: &mut Window, modifiers: Modifiers, key: Key) -> Vec3 {
    let before = window.session().camera.position;
    window.hold(modifiers, key, 6);
    window.session().camera.position - before
}

#[test]
fn wasd_rf_fly_along_the_view_and_up_in_the_world() {
    let Some(mut window) = Window::room() else { return };
    for (key, way) in [
        (Key::W, Vec3::NEG_Z),
        (Key::S, Vec3::Z),
        (Key::A, Vec3::NEG_X),
        (Key::D, Vec3::X),
        (Key::R, Vec3::Y),
        (Key::F, Vec3::NEG_Y),
    ] {
        let flown = flown(&mut window, Modifiers::NONE, key);
        assert!(flown.dot(way) > 0.01, "{key:?}: {flown}");
        assert!((flown - way * flown.dot(way)).length() < 1e-4, "{key:?}: {flown}");
    }
}

#[test]
fn q_and_e_roll_and_align_up_makes_the_horizon_level() {
    let Some(mut window) = Window::room() else { return };
    window.hold(Modifiers::NONE, Key::E, 4);
    assert!(window.session().camera.roll_deg > 1.0);
    window.hold(Modifiers::NONE, Key::Q, 10);
    assert!(window.session().camera.roll_deg < -1.0);
    window.press(Key::U);
    assert_eq!(window.session().camera.roll_deg, 0.0);
    window.hold(Modifiers::NONE, Key::Q, 4);
    window.tab("Camera");
    window.click("Align up");
    assert_eq!(window.session().camera.roll_deg, 0.0);
}

#[test]
fn arrow_keys_look_around() {
    let Some(mut window) = Window::room() else { return };
    let looked = |window: &mut Window, key| {
        let before = window.session().camera;
        window.hold(Modifiers::NONE, key, 4);
        let after = window.session().camera;
        assert_eq!(after.position, before.position);
        (after.yaw_deg - before.yaw_deg, after.pitch_deg - before.pitch_deg)
    };
    // With the focus on the picture or on nothing.
    for _ in 0..2 {
        assert!(looked(&mut window, Key::ArrowLeft).0 > 0.5);
        assert!(looked(&mut window, Key::ArrowRight).0 < -0.5);
        assert!(looked(&mut window, Key::ArrowUp).1 > 0.5);
        assert!(looked(&mut window, Key::ArrowDown).1 < -0.5);
        let middle = window.area().center();
        window.click_at(middle);
    }
}

#[test]
fn dragging_looks_pans_and_dollies() {
    let Some(mut window) = Window::room() else { return };
    let middle = window.area().center();
    let home = window.session().camera;
    let mut dragged = |button, way| {
        window.session().camera = home;
        window.drag(button, middle, middle + way);
        window.session().camera
    };
    let looked = dragged(PointerButton::Primary, vec2(60.0, -30.0));
    assert!(looked.yaw_deg < home.yaw_deg - 5.0 && looked.pitch_deg > home.pitch_deg + 2.0, "{looked:?}");
    assert_eq!(looked.position, home.position);
    let panned = dragged(PointerButton::Middle, vec2(60.0, -30.0));
    let way = panned.position - home.position;
    assert!(way.x < -0.05 && way.y < -0.02 && way.z.abs() < 1e-4, "what is grabbed follows: {way}");
    let near = dragged(PointerButton::Secondary, vec2(0.0, -60.0));
    let way = near.position - home.position;
    assert!(way.z < -0.1 && way.x.abs() < 1e-4 && way.y.abs() < 1e-4, "{way}");
    assert_eq!((panned.yaw_deg, near.yaw_deg), (home.yaw_deg, home.yaw_deg));
}

fn turn_wheel(window: &mut Window, points: f32) {
    let middle = window.area().center();
    window.hover_at(middle);
    window.run_steps(1);
    window.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(0.0, points),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    window.run_steps(20);
    window.remove_cursor();
    window.run_steps(1);
}

#[test]
fn the_wheel_sets_the_speed_of_flight() {
    let Some(mut window) = Window::room() else { return };
    let slow = flown(&mut window, Modifiers::NONE, Key::W).length();
    turn_wheel(&mut window, 200.0);
    let speed = window.state().prefs.speed;
    assert!(speed > 1.5, "{speed}");
    assert!(window.reads(&format!("speed {speed:.2}")));
    let fast = flown(&mut window, Modifiers::NONE, Key::W).length();
    assert!((fast / slow - speed).abs() < 0.01 * speed, "{slow} {fast}");
    turn_wheel(&mut window, -400.0);
    assert!(window.state().prefs.speed < 1.0);
}

#[test]
fn shift_flies_fast_and_control_slowly() {
    let Some(mut window) = Window::room() else { return };
    let usual = flown(&mut window, Modifiers::NONE, Key::D).length();
    let fast = flown(&mut window, Modifiers::SHIFT, Key::D).length();
    let slow = flown(&mut window, CTRL, Key::D).length();
    assert!((3.5..4.5).contains(&(fast / usual)), "{usual} {fast}");
    assert!((0.15..0.25).contains(&(slow / usual)), "{usual} {slow}");
}

#[test]
fn keys_do_not_fly_while_text_is_edited() {
    let Some(mut window) = Window::room() else { return };
    let before = window.session().camera;
    window.find(Role::TextInput, "Name").click();
    window.run_steps(2);
    window.hold(Modifiers::NONE, Key::W, 4);
    window.press(Key::M);
    window.press(Key::Num1);
    assert_eq!(window.session().camera, before);
    assert!(!window.state().dialogs.is_any_open() && !window.told("to slot 1"));
    // And again when one is done with it.
    let middle = window.area().center();
    window.click_at(middle);
    window.hold(Modifiers::NONE, Key::W, 4);
    assert_ne!(window.session().camera, before);
}

#[test]
fn keys_do_not_fly_behind_a_dialog() {
    let Some(mut window) = Window::room() else { return };
    let before = window.session().camera;
    window.press(Key::F1);
    window.hold(Modifiers::NONE, Key::W, 4);
    window.press(Key::Space);
    assert_eq!(window.session().camera, before);
    assert_eq!(window.session().lights[0].rect.center, Vec3::new(0.0, 1.9, 0.0));
}

#[test]
fn the_field_of_view_is_set_by_a_slider() {
    let Some(mut window) = Window::room() else { return };
    let before = window.picture();
    window.tab("Camera");
    window.nudge("Field of view", Key::ArrowRight, 5);
    let fov = window.session().camera.fov_deg;
    assert!(fov > 52.0, "{fov}");
    assert!(crate::expected::differing(&before, &window.picture()) > 20);
}

#[test]
fn home_and_reset_camera_go_back_to_where_the_scene_opened() {
    let Some(mut window) = Window::room() else { return };
    let home = window.session().camera;
    let fly = |window: &mut Window| {
        window.hold(Modifiers::NONE, Key::W, 3);
        window.hold(Modifiers::NONE, Key::Q, 3);
        assert_ne!(window.session().camera, home);
    };
    fly(&mut window);
    window.press(Key::Home);
    assert_eq!(window.session().camera, home);
    fly(&mut window);
    window.tab("Camera");
    window.click("Reset camera");
    assert_eq!(window.session().camera, home);
}

#[test]
fn views_of_the_scene_are_a_click_away() {
    let Some(mut window) = Window::room() else { return };
    let home = window.session().camera;
    window.session().camera = FlyCamera { yaw_deg: 70.0, ..home };
    window.tab("Camera");
    window.click("front");
    assert_eq!(window.session().camera, home);
}
