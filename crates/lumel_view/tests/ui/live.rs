//! Light that follows the hand.

use crate::expected::{bits, reference, reference_of};
use crate::hands::CTRL;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, vec2};
use glam::Vec3;
use lumel::Settings;
use lumel_view::app::App;
use lumel_view::document::OpenRequest;
use lumel_view::lights::shining;

/// Whether the light is that of the lights as they are, with all shadow rays.
fn at_rest(app: &App) -> bool {
    let session = &app.session;
    let computed = session.computed();
    !session.is_following()
        && computed.is_some_and(|c| {
            c.complete
                && c.inputs.lights.as_ref() == Some(&shining(&session.lights))
                && session.document.as_ref().unwrap().scene.materials() == c.inputs.scene.materials()
                && c.settings() == Some(&session.settings)
        })
}

fn live_room() -> Option<Window> {
    let mut window = Window::room()?;
    // More than are traced while the hand moves.
    window.session().settings.direct_samples = 64;
    window.solve();
    window.session().live = true;
    assert_eq!(window.session().obstacle_to_live(), None);
    Some(window)
}

#[test]
fn each_step_of_a_drag_shows_all_bounces_of_the_light_where_it_is() {
    let Some(mut window) = live_room() else { return };
    for step in 1..=4 {
        window.session().lights[0].rect.center += Vec3::new(0.05, 0.0, 0.1 * step as f32);
        window.wait_until("the light to follow", at_rest);
        assert_eq!(bits(window.state()), reference(window.state()), "step {step}");
        assert!(window.session().out_of_date().is_none());
    }
}

#[test]
fn size_brightness_and_colour_are_followed_too() {
    let Some(mut window) = live_room() else { return };
    window.session().lights[0].rect.radiance.0 *= Vec3::new(2.0, 0.5, 1.0);
    window.wait_until("the colour", at_rest);
    assert_eq!(bits(window.state()), reference(window.state()));
    window.session().lights[0].rect.u *= 0.5;
    window.wait_until("the size", at_rest);
    assert_eq!(bits(window.state()), reference(window.state()));
    window.press_with(CTRL, Key::Z);
    window.wait_until("undoing", at_rest);
    assert_eq!(bits(window.state()), reference(window.state()));
}

#[test]
fn light_that_follows_is_never_a_mixture_of_old_and_new() {
    let Some(mut window) = live_room() else { return };
    let before = bits(window.state());
    window.session().lights[0].rect.center += Vec3::new(0.1, 0.0, 0.0);
    let mut seen = vec![before.clone()];
    while !at_rest(window.state()) {
        window.run_steps(1);
        let now = bits(window.state());
        if seen.last() != Some(&now) {
            seen.push(now);
        }
    }
    assert_eq!(seen.len(), 2, "old light, then new");
    assert_eq!(seen[1], reference(window.state()));
}

#[test]
fn light_follows_only_where_all_rays_are_stored_and_it_is_wanted() {
    let Some(mut window) = Window::room() else { return };
    window.session().live = true;
    assert_eq!(window.session().obstacle_to_live(), Some("solve once to store all rays"));
    window.solve();
    assert_eq!(window.session().obstacle_to_live(), None);
    window.session().settings.seed += 1;
    assert_eq!(window.session().obstacle_to_live(), Some("solve once to store all rays"));
    window.session().settings.seed -= 1;
    window.check("Live relighting");
    window.session().lights[0].rect.center += Vec3::new(0.1, 0.0, 0.0);
    window.settle();
    assert!(window.session().out_of_date().unwrap().lights && !window.session().is_following());
    window.check("Live relighting");
    window.wait_until("the light to follow", at_rest);
    assert_eq!(bits(window.state()), reference(window.state()));
}

/// What the library computes with the few shadow rays of a moving hand.
fn coarse_reference(app: &App) -> Vec<Vec<[u32; 3]>> {
    let scene = app.session.document.as_ref().unwrap().relit(&app.session.lights).unwrap();
    reference_of(scene, Settings { direct_samples: 8, ..app.session.settings.clone() })
}

#[test]
fn the_light_follows_the_mouse_that_drags_it() {
    let Some(mut window) = live_room() else { return };
    let at = |window: &Window| window.project(window.state().session.lights[0].rect.center);
    let (from, before) = (at(&window), bits(window.state()));
    window.drag_at(from);
    let mut seen = vec![before];
    for step in 1..=5 {
        window.hover_at(from + vec2(8.0, 3.0) * step as f32);
        window.run_steps(1);
        window.wait_until("the light to follow", |app| {
            !app.session.is_following()
                && app.session.computed().unwrap().inputs.lights == Some(shining(&app.session.lights))
        });
        window.run_steps(1);
        assert!(window.reads("Live: sobol 8+8 rays, 2 bounces, least-squares in "), "{}", window.texts());
        assert!(window.session().out_of_date().is_none());
        let now = bits(window.state());
        assert_eq!(now, coarse_reference(window.state()), "step {step}");
        assert!(!seen.contains(&now), "step {step} shows something new");
        seen.push(now);
    }
    let to = at(&window);
    assert!(to.distance(from + vec2(40.0, 15.0)) < 3.0, "{from} to {to}");
    window.drop_at(from + vec2(40.0, 15.0));
    window.wait_until("the light to rest", at_rest);
    assert_eq!(bits(window.state()), reference(window.state()));
    window.run_steps(1);
    assert!(window.reads("Solved: sobol 64+8 rays, 2 bounces, least-squares in "), "{}", window.texts());
}

#[test]
fn what_is_refined_stops_when_the_hand_moves_on() {
    let Some(mut window) = live_room() else { return };
    // Seconds of shadow rays, once the hand rests.
    window.session().settings.direct_samples = 1 << 16;
    window.solve();
    window.session().lights[0].rect.center.x += 0.1;
    window.wait_until("the start", |app| app.session.is_following());
    let first = window.session().light_generation;
    let at = window.project(window.state().session.lights[0].rect.center);
    window.drag_at(at);
    window.hover_at(at + vec2(20.0, 0.0));
    window.wait_until("the light of the moving hand", |app| app.session.is_light_in_motion());
    window.wait_until("it to be seen", |app| app.session.light_generation > first);
    window.run_steps(1);
    assert_eq!(bits(window.state()), coarse_reference(window.state()), "not what was begun before");
    window.drop_at(at + vec2(20.0, 0.0));
}

#[test]
fn albedos_are_followed_and_can_be_undone_and_saved() {
    let Some(mut window) = live_room() else { return };
    let before = bits(window.state());
    window.tab("Scene");
    window.find(Role::ColorWell, "Albedo of red").scroll_to_me();
    window.run_steps(4);
    window.find(Role::ColorWell, "Albedo of red").click();
    window.run_steps(4);
    window.find(Role::Slider, "Brightness").set_value_accesskit(0.3);
    window.run_steps(2);
    window.wait_until("the light to follow", at_rest);
    let scene = &window.state().session.document.as_ref().unwrap().scene;
    let red = scene.materials().iter().find(|material| material.name == "red").unwrap();
    assert!((red.albedo - Vec3::new(0.3, 0.05, 0.05)).length() < 1e-3, "{}", red.albedo);
    assert_eq!(bits(window.state()), reference(window.state()));
    let painted = bits(window.state());
    assert_ne!(painted, before);
    window.press(Key::Escape);
    let path = window.file("painted.toml");
    window.session().save_project(&path).unwrap();
    window.press_with(CTRL, Key::Z);
    window.wait_until("undoing", at_rest);
    assert_eq!(bits(window.state()), before);
    window.session().open(OpenRequest::new(path.to_string_lossy()));
    window.wait_until("the project", |app| !app.session.is_opening());
    window.solve();
    assert_eq!(bits(window.state()), painted);
}
