//! Placing, changing and dragging lights.

use crate::expected::{bits, differing, reference};
use crate::hands::CTRL;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, PointerButton, vec2};
use glam::{Vec2, Vec3};
use lumel::LightKind;
use lumel_view::document::OpenRequest;
use lumel_view::lights::EditLight;

const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..CTRL };

/// The room, with the panel of its lights in front.
fn room() -> Option<Window> {
    let mut window = Window::room()?;
    window.tab("Lights");
    Some(window)
}

fn lamp(window: &Window) -> &EditLight {
    &window.state().session.lights[window.state().session.active]
}

#[test]
fn space_puts_the_light_where_the_camera_is_facing_forward() {
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
    let power = lamp(&window).power();
    window.check("Constant power");
    window.nudge("Size", Key::ArrowLeft, 10);
    assert!(lamp(&window).half_edges().x < 0.29 && lamp(&window).rect.radiance.0.x > 10.5);
    assert!((lamp(&window).power() / power - Vec3::ONE).length() < 1e-4);
    assert!(window.reads("11.3 11.3 11.3 W"));
}

#[test]
fn intensity_and_colour_change_the_radiance() {
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
    window.find(Role::TextInput, "Name").set_text_value_accesskit("Sun");
    window.run_steps(3);
    assert_eq!(lamp(&window).name, "Sun");
    assert!(window.has(Role::CheckBox, "Sun on"));
}

#[test]
fn dragging_its_handle_moves_the_light_and_nothing_else() {
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
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
    let Some(mut window) = room() else { return };
    window.session().camera.position = Vec3::new(0.6, 1.4, 2.5);
    window.run_steps(2);
    let before = lamp(&window).rect;
    let from = window.project(before.center);
    window.drag(PointerButton::Primary, from, from + vec2(40.0, 60.0));
    assert_ne!(lamp(&window).rect, before);
    window.press_with(CTRL, Key::Z);
    assert_eq!(lamp(&window).rect, before);
}

#[test]
fn every_kind_of_light_is_added_from_the_menu() {
    let Some(mut window) = Window::room() else { return };
    for (item, kind) in [
        ("Add a disk", LightKind::Disk),
        ("Add a point", LightKind::Point),
        ("Add a spot", LightKind::Spot),
        ("Add a sun", LightKind::Sun),
    ] {
        window.menu("Light", item);
        assert_eq!(lamp(&window).kind(), kind);
        assert!(
            lamp(&window).light().strength().min_element() > 0.0 && lamp(&window).light().problem().is_none()
        );
    }
    let sun = lamp(&window).rect;
    assert!(sun.normal().unwrap().y < -0.5 && sun.center.y > 2.0, "it shines from above");
    window.session().remove_light();
    window.solve();
    assert_eq!(bits(window.state()), reference(window.state()));
}

#[test]
fn the_sky_is_chosen_undone_and_solved_for() {
    let Some(mut window) = room() else { return };
    let scene = |window: &Window| window.state().session.document.as_ref().unwrap().scene.clone();
    window.choose("Sky", "Gradient");
    assert!(!scene(&window).sky().is_zero() && scene(&window).sky().uniform().is_none());
    let before = scene(&window).sky().mean().0;
    window.find(Role::Slider, "Sky intensity").set_value_accesskit(100.0);
    window.run_steps(2);
    let after = scene(&window).sky().mean().0;
    assert!(after.x > 10.0 * before.x && (after / after.x - before / before.x).length() < 1e-4, "{after}");
    window.press_with(CTRL, Key::Z);
    assert_eq!(scene(&window).sky().mean().0, before);
    window.solve();
    assert_eq!(bits(window.state()), reference(window.state()));
    window.choose("Sky", "Uniform");
    assert!(window.reads("Lights have changed: press Enter to solve again"));
    window.solve();
    assert_eq!(bits(window.state()), reference(window.state()));
    window.choose("Sky", "None");
    assert!(scene(&window).sky().is_zero() && !window.has(Role::Slider, "Sky intensity"));
}

#[test]
fn a_sky_is_saved_with_the_project() {
    let Some(mut window) = room() else { return };
    window.choose("Sky", "Uniform");
    let sky = window.session().sky.clone();
    window.press_with(CTRL, Key::S);
    window.press(Key::F5);
    window.wait_for_files();
    assert_eq!(window.session().sky, sky);
    assert!(!sky.sky.is_zero() && !window.session().has_unsaved_edits());
}

#[test]
fn an_image_of_the_sky_is_loaded_turned_saved_and_restored() {
    let Some(mut window) = room() else { return };
    let file = window.file("noon.png");
    image::RgbImage::from_fn(16, 8, |x, y| image::Rgb([16 * x as u8, 32 * (7 - y) as u8, 200]))
        .save(&file)
        .unwrap();
    window.choose("Sky", "Image");
    window.answer(window.file("midnight.png"));
    assert!(window.reads("there is no such file"));
    window.press(Key::Escape);
    assert!(window.session().sky.sky.is_zero(), "nothing was chosen");
    window.choose("Sky", "Image");
    window.answer(&file);
    window.wait_for_files();
    let image = |window: &mut Window| window.session().sky.sky.image().cloned().unwrap();
    assert_eq!((image(&mut window).rotation(), image(&mut window).strength()), (0.0, 1.0));
    window.find(Role::Slider, "Sky rotation").set_value_accesskit(90.0);
    window.run_steps(2);
    window.find(Role::Slider, "Sky strength").set_value_accesskit(10.0);
    window.run_steps(2);
    let turned = image(&mut window);
    assert!((turned.rotation().to_degrees() - 90.0).abs() < 1e-4 && (turned.strength() - 10.0).abs() < 1e-4);
    window.press_with(CTRL, Key::S);
    window.press(Key::F5);
    window.wait_for_files();
    let saved = image(&mut window);
    assert!(saved.texture() == turned.texture() && (saved.rotation() - turned.rotation()).abs() < 1e-5);
    assert!(!window.session().has_unsaved_edits() && window.has(Role::Button, "Image"));
    assert!(window.session().sky.file.as_ref().is_some_and(|file| file.ends_with("noon.png")));

    window.find(Role::Slider, "Sky strength").set_value_accesskit(5.0);
    window.run_steps(2);
    window.solve();
    assert_eq!(bits(window.state()), reference(window.state()));
    let dimmed = image(&mut window);
    let Some(mut window) = Window::keeping(window.closed(), |_| {}) else { return };
    window.click("Restore");
    window.wait_for_files();
    assert_eq!(*image(&mut window), *dimmed);
}

#[test]
fn a_sky_that_is_still_being_read_does_not_light_the_next_scene() {
    let Some(mut window) = room() else { return };
    let file = window.file("noon.png");
    // Takes longer than opening the scene.
    image::RgbImage::from_fn(4096, 2048, |x, y| image::Rgb([x as u8, y as u8, (x * y) as u8]))
        .save(&file)
        .unwrap();
    window.session().load_sky(&file);
    window.session().open(OpenRequest::new("cornell-box"));
    window.wait_until("the scene", |app| !app.session.is_opening());
    assert_eq!(window.session().background_work(), None);
    window.wait_for_files();
    assert!(window.session().sky.sky.is_zero());
}

#[test]
fn a_light_is_aimed_at_what_is_picked() {
    let Some(mut window) = room() else { return };
    let wall = window.project(Vec3::new(-1.0, 1.0, 0.0));
    window.click_at(wall);
    let spot = window.state().pick.as_ref().unwrap().spot.position;
    window.click("Aim here");
    let way = (spot - lamp(&window).rect.center).normalize();
    assert!(lamp(&window).rect.normal().unwrap().dot(way) > 0.9999);
    assert!((lamp(&window).half_edges() - Vec2::splat(0.3)).length() < 1e-5, "it keeps its size");
    window.press(Key::Escape);
    window.press_with(Modifiers::SHIFT, Key::T);
    assert!(
        lamp(&window).rect.normal().unwrap().z < -0.5,
        "nothing is picked: towards the middle of the picture"
    );
}

#[test]
fn dragging_its_direction_turns_a_light_and_control_snaps() {
    let Some(mut window) = room() else { return };
    window.session().camera.position = Vec3::new(0.6, 1.4, 2.5);
    window.run_steps(2);
    let tip = |window: &Window| {
        let light = lamp(window);
        let length = 1.35 * 0.12 * window.state().session.camera.position.distance(light.rect.center);
        window.project(light.rect.center + light.rect.normal().unwrap() * length)
    };
    let from = tip(&window);
    window.drag(PointerButton::Primary, from, from + vec2(25.0, -10.0));
    let turned = lamp(&window).rect.normal().unwrap();
    assert!(turned.x > 0.2 && turned.y < -0.5, "{turned}");
    assert_eq!(lamp(&window).rect.center, Vec3::new(0.0, 1.9, 0.0));
    let from = tip(&window);
    window.drag_with(CTRL, PointerButton::Primary, from, from + vec2(12.0, -9.0));
    let snapped = lamp(&window).direction_deg() / 15.0;
    assert!((snapped - snapped.round()).length() < 1e-2, "{snapped}");
    let from = window.project(lamp(&window).rect.center);
    let wall = window.project(Vec3::new(0.3, 0.9, -1.0));
    window.drag_with(CTRL, PointerButton::Primary, from, wall);
    let light = lamp(&window).rect;
    assert!((light.center.z + 1.0).abs() < 0.05 && light.normal().unwrap().dot(Vec3::Z) > 0.999, "{light:?}");
}

#[test]
fn emissive_surfaces_are_listed_with_their_power() {
    let Some(mut window) = Window::builtin("furnace") else { return };
    window.tab("Lights");
    assert!(window.reads("Emissive surfaces"));
    let emissive = window.state().session.document.as_ref().unwrap().emissive.clone();
    assert!(emissive.len() == 1 && emissive[0].power.x > 0.0, "{emissive:?}");
    assert!(window.reads(&emissive[0].material));
}
