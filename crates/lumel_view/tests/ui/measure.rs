//! Reading the light at a spot, and how sure one can be of it.

use crate::expected::differing;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, vec2};
use egui_kittest::kittest::NodeT;
use glam::Vec3;
use lumel_view::prefs::ViewMode;
use lumel_view::solver::Phase;

/// Clicks on the middle of the back wall.
fn pick(window: &mut Window) {
    let at = window.project(Vec3::new(0.3, 0.8, -1.0));
    window.click_at(at);
    window.run_steps(2);
}

#[test]
fn a_click_reads_position_normal_and_light_of_a_surface() {
    let Some(mut window) = Window::solved_room() else { return };
    pick(&mut window);
    let spot = &window.state().pick.as_ref().unwrap().spot;
    assert!(spot.position.distance(Vec3::new(0.3, 0.8, -1.0)) < 0.02, "{}", spot.position);
    assert!(spot.normal.distance(Vec3::Z) < 1e-4);
    let p = spot.position;
    for text in
        [format!("{:.3}  {:.3}  {:.3} m", p.x, p.y, p.z), "0.000  0.000  1.000".into(), "white".into()]
    {
        assert!(window.reads(&text), "{text}");
    }
    let all = window.session().selected_light(Default::default());
    let state = window.state();
    let scene = &state.session.document.as_ref().unwrap().scene;
    let stored = state.pick.as_ref().unwrap().spot.value(scene, &all);
    let significant = lumel_view::values::significant;
    let text = format!("{}  {}  {}", significant(stored.x), significant(stored.y), significant(stored.z));
    assert!(window.reads(&text), "{text}");
}

#[test]
fn the_light_at_the_spot_is_measured_with_its_standard_error() {
    let Some(mut window) = Window::solved_room() else { return };
    pick(&mut window);
    window.wait_until("the measurement", |app| app.pick.as_ref().unwrap().measured.is_some());
    window.run_steps(2);
    let all = window.session().selected_light(Default::default());
    let state = window.state();
    let pick = state.pick.as_ref().unwrap();
    let stored = pick.spot.value(&state.session.document.as_ref().unwrap().scene, &all);
    let measured = pick.measured.as_ref().unwrap();
    assert_eq!(measured.bounces.len(), 3);
    // With a few samples only, but of the same light.
    assert!((measured.irradiance[0] / stored - Vec3::ONE).abs().max_element() < 0.5);
    assert!(measured.standard_error[0].y > 0.0);
    let significant = lumel_view::values::significant;
    let (value, error) = (measured.irradiance[0].y, measured.standard_error[0].y);
    let text = format!("{} ± {}", significant(value), significant(error));
    assert!(window.reads(&text), "{text}");
}

#[test]
fn escape_the_button_and_a_click_beside_close_the_inspector() {
    let Some(mut window) = Window::solved_room() else { return };
    for close in [
        (|window: &mut Window| window.press(Key::Escape)) as fn(&mut Window),
        |window| window.click("Close"),
        |window| {
            let beside = window.area().right_center() - vec2(20.0, 0.0);
            window.click_at(beside);
        },
    ] {
        pick(&mut window);
        assert!(window.reads("Irradiance, W/m²") && window.state().pick.is_some());
        close(&mut window);
        window.run_steps(1);
        assert!(!window.reads("Irradiance, W/m²") && window.state().pick.is_none());
    }
}

#[test]
fn a_spot_without_light_says_what_to_do() {
    let Some(mut window) = Window::room() else { return };
    pick(&mut window);
    assert!(window.reads("Not solved: press Enter."));
    window.solve();
    assert!(!window.reads("Not solved: press Enter."));
    window.wait_until("the measurement", |app| app.pick.as_ref().unwrap().measured.is_some());
}

#[test]
fn the_rays_of_the_picked_vertex_are_drawn() {
    let Some(mut window) = Window::solved_room() else { return };
    pick(&mut window);
    let with = window.picture();
    window.tab("Display");
    window.check("Rays of the picked vertex");
    assert!(differing(&with, &window.picture()) > 0);
}

#[test]
fn sample_points_are_drawn() {
    let Some(mut window) = Window::solved_room() else { return };
    let without = window.picture();
    window.tab("Display");
    window.check("Sample points");
    assert!(window.state().view().sample_points);
    assert!(differing(&without, &window.picture()) > 2);
    window.check("Sample points");
    assert_eq!(differing(&without, &window.picture()), 0);
}

#[test]
fn the_standard_error_is_measured_and_shown() {
    let Some(mut window) = Window::room() else { return };
    assert!(window.find(Role::Button, "Measure standard error").accesskit_node().is_disabled());
    window.solve();
    window.choose("View mode", "Standard error");
    window.tab("Display");
    assert!(window.reads("Not measured yet"));
    let unknown = window.picture();
    window.tab("Solve");
    window.click("Measure standard error");
    window.wait_until("the standard error", |app| app.session.light.standard_error.is_some());
    window.wait_until("its end", |app| app.session.phase().is_none());
    window.run_steps(2);
    window.tab("Display");
    assert!(window.told("Measured the standard error") && !window.reads("Not measured yet"));
    assert_eq!(window.state().view().mode, ViewMode::StandardError);
    assert!(differing(&unknown, &window.picture()) > 50);
    let errors = window.session().light.standard_error.clone().unwrap();
    let all = window.session().selected_light(Default::default());
    let relative = errors.iter().map(|e| e.y).sum::<f32>() / all.iter().map(|e| e.y).sum::<f32>();
    assert!((0.001..0.5).contains(&relative), "{relative}");
}

#[test]
fn measuring_the_standard_error_can_be_stopped() {
    let Some(mut window) = Window::solved_room() else { return };
    window.session().settings.indirect_samples = 2048;
    window.solve();
    window.click("Measure standard error");
    window.wait_until("the start", |app| app.session.phase() == Some(Phase::StandardError));
    window.run_steps(1);
    assert!(window.reads("Measuring the standard error"));
    window.press(Key::Escape);
    window.wait_until("the end", |app| app.session.phase().is_none());
    window.run_steps(2);
    assert!(window.told("Stopped; the standard error was not measured"));
    assert_eq!(window.session().light.bounces.len(), 3, "the light stays");
}
