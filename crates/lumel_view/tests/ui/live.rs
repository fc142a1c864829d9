//! Light that follows the hand.

use crate::expected::{bits, reference};
use crate::hands::CTRL;
use crate::harness::Window;
use eframe::egui::Key;
use glam::Vec3;
use lumel_view::app::App;
use lumel_view::lights::shining;

/// Whether the light is that of the lights as they are, with all shadow rays.
fn at_rest(app: &App) -> bool {
    let session = &app.session;
    let computed = session.computed();
    !session.is_following()
        && computed.is_some_and(|c| {
            c.complete
                && c.lights.as_ref() == Some(&shining(&session.lights))
                && c.settings.as_ref() == Some(&session.settings)
        })
}

fn live_room() -> Option<Window> {
    let mut window = Window::solved_room()?;
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
        assert!(!window.session().is_stale());
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
    assert_eq!(window.session().obstacle_to_live(), Some("solve once, then all rays are stored"));
    window.solve();
    assert_eq!(window.session().obstacle_to_live(), None);
    window.session().settings.seed += 1;
    assert_eq!(window.session().obstacle_to_live(), Some("solve once, then all rays are stored"));
    window.session().settings.seed -= 1;
    window.check("Light follows changes");
    window.session().lights[0].rect.center += Vec3::new(0.1, 0.0, 0.0);
    window.settle();
    assert!(window.session().is_stale() && !window.session().is_following());
    window.check("Light follows changes");
    window.wait_until("the light to follow", at_rest);
    assert_eq!(bits(window.state()), reference(window.state()));
}
