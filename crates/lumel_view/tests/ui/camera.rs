//! Flying: keys and mouse over the picture, and the panel of the camera.

use crate::hands::CTRL;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, TouchPhase, vec2,
};
use glam::Vec3;
use lumel_view::camera::FlyCamera;
use lumel_view::input::Pad;

/// Where a key takes the camera within a fifth of a second.
fn flown(window: &mut Window, modifiers: Modifiers, key: Key) -> Vec3 {
    let before = window.session().camera.position;
    // Longer than a tap.
    window.hold(modifiers, key, 12);
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
    let mut dragged = |modifiers, button, way| {
        window.session().camera = home;
        window.drag_with(modifiers, button, middle, middle + way);
        window.session().camera
    };
    let looked = dragged(Modifiers::NONE, PointerButton::Primary, vec2(60.0, -30.0));
    assert!(looked.yaw_deg < home.yaw_deg - 5.0 && looked.pitch_deg > home.pitch_deg + 2.0, "{looked:?}");
    assert_eq!(looked.position, home.position);
    let panned = dragged(Modifiers::SHIFT, PointerButton::Middle, vec2(60.0, -30.0));
    let way = panned.position - home.position;
    assert!(way.x < -0.05 && way.y < -0.02 && way.z.abs() < 1e-4, "what is grabbed follows: {way}");
    for (modifiers, button) in [(Modifiers::NONE, PointerButton::Secondary), (CTRL, PointerButton::Middle)] {
        let near = dragged(modifiers, button, vec2(0.0, -60.0));
        let way = near.position - home.position;
        assert!(way.z < -0.1 && way.x.abs() < 1e-4 && way.y.abs() < 1e-4, "{way}");
        assert_eq!((panned.yaw_deg, near.yaw_deg), (home.yaw_deg, home.yaw_deg));
    }
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
    window.tab("Lights");
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

/// Drags in the middle of the picture by what orbits.
fn orbit(window: &mut Window, modifiers: Modifiers, button: PointerButton, way: eframe::egui::Vec2) {
    let middle = window.area().center();
    window.drag_with(modifiers, button, middle, middle + way);
}

#[test]
fn the_middle_button_and_alt_orbit_around_what_is_under_the_pointer() {
    let Some(mut window) = Window::room() else { return };
    let home = window.session().camera;
    // The middle of the back wall.
    let pivot = Vec3::new(0.0, 1.0, -1.0);
    for (modifiers, button) in
        [(Modifiers::NONE, PointerButton::Middle), (Modifiers::ALT, PointerButton::Primary)]
    {
        window.session().camera = home;
        orbit(&mut window, modifiers, button, vec2(80.0, 30.0));
        let camera = window.session().camera;
        assert!((camera.position.distance(pivot) - home.position.distance(pivot)).abs() < 1e-3);
        assert!(camera.position.x < -0.5 && camera.position.y > 1.2, "{}", camera.position);
        let seen = window.project(pivot);
        assert!(seen.distance(window.area().center()) < 1.0, "it stays where it is: {seen}");
    }
}

#[test]
fn a_picked_spot_is_what_one_orbits_around_and_frames() {
    let Some(mut window) = Window::room() else { return };
    let spot = window.project(Vec3::new(-1.0, 0.5, 0.0));
    window.click_at(spot);
    let pivot = window.state().pick.as_ref().unwrap().spot.position;
    let distance = window.session().camera.position.distance(pivot);
    orbit(&mut window, Modifiers::NONE, PointerButton::Middle, vec2(60.0, 0.0));
    assert!((window.session().camera.position.distance(pivot) - distance).abs() < 1e-3);
}

#[test]
fn keys_of_the_number_pad_look_along_the_axes_and_digits_still_recall() {
    let Some(mut window) = Window::room() else { return };
    for (digit, modifiers, towards_eye) in [
        (1, Modifiers::NONE, Vec3::Z),
        (3, Modifiers::NONE, Vec3::X),
        (7, Modifiers::NONE, Vec3::Y),
        (3, CTRL, Vec3::NEG_X),
        (1, CTRL, Vec3::NEG_Z),
    ] {
        window.press_pad(Pad::Digit(digit), modifiers);
        let forward = window.session().camera.forward();
        assert!(forward.dot(-towards_eye) > 0.999, "{digit}: {forward}");
    }
    assert!(!window.told("Slot 1 is empty"));
    window.press(Key::Num1);
    assert!(window.told("Slot 1 is empty"));
    let fov = window.session().camera.fov_deg;
    window.press_pad(Pad::Digit(5), Modifiers::NONE);
    assert!(window.session().camera.fov_deg < 0.2 * fov);
    window.press_pad(Pad::Digit(5), Modifiers::NONE);
    assert_eq!(window.session().camera.fov_deg, fov);
}

#[test]
fn f_tapped_and_the_pads_point_frame_everything() {
    let Some(mut window) = Window::room() else { return };
    let home = window.session().camera;
    for by_pad in [false, true] {
        window.session().camera = FlyCamera { position: Vec3::new(0.0, 1.0, 0.5), ..home };
        if by_pad {
            window.press_pad(Pad::Decimal, Modifiers::NONE)
        } else {
            window.hold(Modifiers::NONE, Key::F, 4)
        }
        window.run_steps(1);
        let camera = window.session().camera;
        let to_middle = Vec3::new(0.0, 1.0, 0.0) - camera.position;
        assert!(to_middle.normalize().dot(camera.forward()) > 0.9999, "{}", camera.position);
        assert!((3.0..6.0).contains(&to_middle.length()), "{}", camera.position);
        let area = window.area().expand(1.0);
        for corner in [Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 2.0, 1.0)] {
            assert!(area.contains(window.project(corner)), "{corner}");
        }
    }
}

#[test]
fn a_click_on_an_axis_looks_along_it() {
    let Some(mut window) = Window::room() else { return };
    window.click("View from +X");
    assert!(window.session().camera.forward().dot(Vec3::NEG_X) > 0.999);
    window.menu("Camera", "View from the top");
    assert!(window.session().camera.forward().dot(Vec3::NEG_Y) > 0.999);
    assert!(window.state().pick.is_none(), "the click does not go through");
}

#[test]
fn the_ground_has_a_grid_in_open_scenes_until_one_says_otherwise() {
    let Some(mut window) = Window::room() else { return };
    assert!(!window.state().session.document.as_ref().unwrap().is_outdoors);
    window.tab("Display");
    assert!(!window.has(Role::CheckBox, "Ground grid"));
    let floor = window.file("floor.obj");
    std::fs::write(&floor, "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n").unwrap();
    window.session().open(lumel_view::document::OpenRequest::new(floor.to_string_lossy()));
    window.wait_for_files();
    window.session().camera =
        FlyCamera { position: Vec3::new(0.0, 1.0, 4.0), pitch_deg: -10.0, ..Default::default() };
    let with = window.picture();
    window.check("Ground grid");
    assert!(crate::expected::differing(&with, &window.picture()) > 5);
}
