//! Starting, stopping and going on.

use crate::expected::{bits, reference};
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, PointerButton, vec2};
use lumel::{BounceLimit, Tail};
use lumel_view::solver::Phase;
use std::time::{Duration, Instant};

/// Stops a long solve by the last event of `stop`; how long it takes until nothing is computed any more.
fn stopping_time(window: &mut Window, stop: &impl Fn(&mut Window)) -> Duration {
    window.solve_for_long();
    stop(window);
    let asked = Instant::now();
    window.run_steps(1);
    while window.state().session.is_solving() {
        assert!(asked.elapsed() < Duration::from_secs(10));
        std::thread::yield_now();
    }
    let time = asked.elapsed();
    window.run_steps(2);
    assert!(window.told("Stopped; press Enter to resume"));
    time
}

/// The promise to users is a tenth of a second. Tests share the processor, so one time in ten is enough.
fn stops_in_time(stop: impl Fn(&mut Window)) {
    let Some(mut window) = Window::room() else { return };
    let mut times = Vec::new();
    while times.iter().all(|time| *time >= Duration::from_millis(100)) {
        assert!(times.len() < 10, "{times:?}");
        times.push(stopping_time(&mut window, &stop));
    }
    assert_eq!(window.session().light.bounces.len(), 1, "what is done stays");
    assert!(window.reads("Stopped: press Enter to resume"));
}

#[test]
fn enter_starts_and_escape_stops_at_once() {
    stops_in_time(|window| {
        // A key that is held stops nothing again.
        window.key_up(Key::Escape);
        window.key_down(Key::Escape);
    });
}

#[test]
fn the_stop_button_stops_at_once() {
    stops_in_time(|window| {
        window.wait_until("the progress", |app| app.session.job().unwrap().progress().step_share > Some(0.0));
        assert!(window.reads("Bounce 1 of 2"));
        let at = window.find(Role::Button, "Stop").rect().center();
        window.drag_at(at);
        window.run_steps(2);
        window.drop_at(at);
    });
}

#[test]
fn the_solve_button_starts() {
    let Some(mut window) = Window::room() else { return };
    window.click("Solve");
    window.wait_until("the solve", |app| app.session.computed().is_some_and(|c| c.complete));
    window.run_steps(1);
    assert!(
        window.reads("Solved: sobol 4+8 rays, 2 bounces")
            && window.told("Solved: direct light and 2 bounces")
    );
}

#[test]
fn enter_solves_after_the_mouse_was_used_elsewhere() {
    let Some(mut window) = Window::room() else { return };
    let drag_slider = |window: &mut Window| {
        let slider = window.find(Role::Slider, "Indirect samples").rect();
        window.drag(PointerButton::Primary, slider.left_center() + vec2(8.0, 0.0), slider.center());
    };
    let uses = [
        ("slider", drag_slider as fn(&mut Window)),
        ("check box", |window| window.check("Stop at an error")),
        ("list", |window| window.choose("Sampler", "Halton")),
        ("button", |window| window.click("Draft")),
        ("tab", |window| window.tab("Camera")),
    ];
    for (what, use_mouse) in uses {
        use_mouse(&mut window);
        window.session().settings.seed += 1;
        let generation = window.session().light_generation;
        window.press(Key::Enter);
        window.wait_until(what, |app| app.session.light_generation > generation);
        window.session().stop();
        window.wait_until("the end", |app| app.session.phase().is_none());
    }
}

#[test]
fn light_and_picture_follow_the_solve() {
    let Some(mut window) = Window::room() else { return };
    window.solve_for_long();
    let begun = window.session().light_generation;
    let pictures = window.state().stage.as_ref().unwrap().pictures;
    window.wait_until("two more looks", |app| app.session.light_generation >= begun + 2);
    window.run_steps(1);
    let session = window.session();
    assert_eq!((session.light.bounces.len(), session.phase()), (1, Some(Phase::Bounce(1))));
    assert!(session.light.current.as_ref().unwrap().iter().any(|e| e.max_element() > 0.0));
    assert!(window.state().stage.as_ref().unwrap().pictures > pictures);
    assert!(window.reads("Mrays/s") && window.reads(" left"));
}

#[test]
fn a_solve_has_the_bits_of_the_library() {
    let Some(mut window) = Window::solved_room() else { return };
    assert_eq!(window.session().light.bounces.len(), 3);
    assert!(bits(window.state()) == reference(window.state()));
}

#[test]
fn a_stopped_solve_goes_on_with_the_same_bits() {
    let Some(mut window) = Window::room() else { return };
    window.solve_bounces(2);
    window.press(Key::Escape);
    window.wait_until("the end", |app| !app.session.is_solving());
    window.run_steps(2);
    let done = window.session().light.bounces.len();
    assert!((2..9).contains(&done), "{done}");
    window.click("Resume");
    window.wait_until("the solve", |app| app.session.computed().is_some_and(|c| c.complete));
    assert_eq!(window.session().light.bounces.len(), 9);
    assert!(bits(window.state()) == reference(window.state()));
    let again = window.session().stats[..done].iter().any(|s| s.seconds > 0.0);
    assert!(!again, "nothing was computed twice");
}

#[test]
fn enter_does_nothing_in_mid_solve() {
    let Some(mut window) = Window::room() else { return };
    window.solve_for_long();
    let seconds = window.session().job().unwrap().seconds();
    window.press(Key::Enter);
    window.run_steps(5);
    assert!(window.told("A solve is already running"));
    let session = window.session();
    assert_eq!((session.light.bounces.len(), session.phase()), (1, Some(Phase::Bounce(1))));
    assert!(session.job().unwrap().seconds() > seconds, "the same job");
}

#[test]
fn enter_computes_nothing_where_all_is_solved() {
    let Some(mut window) = Window::solved_room() else { return };
    let generation = window.session().light_generation;
    window.press(Key::Enter);
    assert!(window.told("Already solved") && window.session().job().is_none());
    assert_eq!(window.session().light_generation, generation);
    window.press_with(Modifiers::SHIFT, Key::Enter);
    window.wait_until("the new solve", |app| {
        app.session.light_generation > generation && app.session.phase().is_none()
    });
    assert!(window.session().stats.iter().all(|s| s.seconds > 0.0));
}

#[test]
fn more_bounces_are_added_to_those_that_are_there() {
    let Some(mut window) = Window::solved_room() else { return };
    window.nudge("Bounces", Key::ArrowRight, 2);
    assert_eq!(window.session().settings.bounces, BounceLimit::Count(4));
    let middle = window.area().center();
    window.click_at(middle);
    window.solve();
    assert!(bits(window.state()) == reference(window.state()));
    let seconds: Vec<f64> = window.session().stats.iter().map(|s| s.seconds).collect();
    assert!(seconds[..3].iter().all(|s| *s == 0.0) && seconds[3..].iter().all(|s| *s > 0.0), "{seconds:?}");
    window.session().settings.bounces = BounceLimit::Count(1);
    window.solve();
    assert_eq!(window.session().light.bounces.len(), 2, "and taken away");
}

#[test]
fn until_converged_adds_bounces_until_little_is_missing() {
    let Some(mut window) = Window::room() else { return };
    window.check("Until converged");
    assert_eq!(window.session().settings.bounces, BounceLimit::All);
    assert!(window.has(Role::SpinButton, "Remainder") && !window.has(Role::Slider, "Bounces"));
    window.find(Role::SpinButton, "Remainder").set_value_accesskit(2.0);
    window.run_steps(2);
    assert!((window.session().settings.remainder - 0.02).abs() < 1e-6);
    window.solve();
    let stats = &window.session().stats;
    let unfinished: Vec<f64> = stats.iter().map(|s| s.unfinished.unwrap_or(1.0)).collect();
    let (last, earlier) = unfinished.split_last().unwrap();
    assert!(earlier.len() > 2 && *last < 0.02 && earlier.iter().all(|u| *u > 0.02), "{unfinished:?}");
    window.check("Until converged");
    assert!(matches!(window.session().settings.bounces, BounceLimit::Count(_)));
}

#[test]
fn the_rest_is_estimated_when_one_asks_for_it() {
    let Some(mut window) = Window::room() else { return };
    window.choose("Later bounces", "Estimated");
    assert_eq!(window.session().settings.tail, Tail::Geometric);
    window.solve();
    assert!(window.session().light.tail.is_some());
    let all = window.session().selected_light(Default::default());
    let bounces: glam::Vec3 = window.session().light.bounces.iter().map(|b| b[0]).sum();
    assert!(all[0].y > bounces.y);
}

#[test]
fn nothing_is_solved_where_nothing_shines() {
    let Some(mut window) = Window::room() else { return };
    window.tab("Lights");
    window.check("Lamp on");
    window.press(Key::Enter);
    assert!(window.told("This scene has no light source") && window.session().job().is_none());
    window.press(Key::Delete);
    window.press(Key::Enter);
    assert!(
        window.session().job().is_none() && window.reads("No lights. Press Space to add one at the camera.")
    );
}
