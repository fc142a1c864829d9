//! What changes in mid-solve do.

use crate::expected::{bits, reference};
use crate::harness::Window;
use eframe::egui::Key;
use lumel::BounceLimit;

/// Waits until all is solved although something changed meanwhile.
fn wait_for_solve(window: &mut Window) {
    window.wait_until("the solve", |app| {
        app.session.phase().is_none() && app.session.computed().is_some_and(|c| c.complete)
    });
}

#[test]
fn moving_a_light_in_mid_solve_solves_anew() {
    let Some(mut window) = Window::room() else { return };
    window.solve_bounces(2);
    window.press(Key::Space);
    assert!(window.told("Lights have changed: solving again"));
    wait_for_solve(&mut window);
    assert_eq!(window.session().light.bounces.len(), 9);
    assert!(bits(window.state()) == reference(window.state()));
    assert!(window.session().stats.iter().all(|s| s.seconds > 0.0));
}

#[test]
fn asking_for_other_samples_in_mid_solve_solves_anew() {
    let Some(mut window) = Window::room() else { return };
    window.solve_for_long();
    window.find(eframe::egui::accesskit::Role::Slider, "Indirect samples").set_value_accesskit(16.0);
    window.run_steps(3);
    assert!(window.told("Settings have changed: solving again"));
    wait_for_solve(&mut window);
    assert_eq!(window.session().computed().unwrap().settings().unwrap().indirect_samples, 16);
    assert!(bits(window.state()) == reference(window.state()));
}

#[test]
fn asking_for_more_bounces_in_mid_solve_loses_none() {
    let Some(mut window) = Window::room() else { return };
    window.solve_bounces(2);
    window.nudge("Bounces", Key::ArrowRight, 1);
    assert!(window.told("Continuing with the new number of bounces"));
    wait_for_solve(&mut window);
    assert_eq!(window.session().light.bounces.len(), 10);
    assert!(bits(window.state()) == reference(window.state()));
    let seconds: Vec<f64> = window.session().stats.iter().map(|s| s.seconds).collect();
    assert!(seconds[0] == 0.0 && seconds[1] == 0.0 && seconds[9] > 0.0, "{seconds:?}");
}

#[test]
fn asking_for_fewer_bounces_in_mid_solve_ends_it() {
    let Some(mut window) = Window::room() else { return };
    window.solve_for_long();
    window.nudge("Bounces", Key::ArrowLeft, 2);
    wait_for_solve(&mut window);
    assert_eq!(window.session().settings.bounces, BounceLimit::Count(0));
    assert_eq!(window.session().light.bounces.len(), 1);
    assert!(bits(window.state()) == reference(window.state()));
}

#[test]
fn a_slider_that_is_held_does_not_solve_anew_at_every_pixel() {
    let Some(mut window) = Window::room() else { return };
    window.solve_for_long();
    window.tab("Lights");
    let slider = window.find(eframe::egui::accesskit::Role::Slider, "Size").rect();
    window.drag_at(slider.center());
    window.run_steps(1);
    for x in [10.0, 20.0, 30.0] {
        window.hover_at(slider.center() - eframe::egui::vec2(x, 0.0));
        window.run_steps(2);
    }
    assert!(window.session().lights[0].half_edges().x < 0.29);
    assert!(!window.told("Lights have changed"), "while it is held");
    window.drop_at(slider.center());
    window.run_steps(3);
    assert!(window.told("Lights have changed"));
}

#[test]
fn changes_after_a_solve_are_told_and_solved_anew() {
    let Some(mut window) = Window::solved_room() else { return };
    window.press(Key::Space);
    window.run_steps(1);
    assert!(window.reads("Lights have changed: press Enter to solve again"));
    window.solve();
    assert!(bits(window.state()) == reference(window.state()));
    assert!(!window.reads("press Enter to solve again"));
}
