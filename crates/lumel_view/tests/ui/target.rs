//! Stopping at an error.

use crate::expected::{bits, reference};
use crate::harness::Window;
use eframe::App as _;
use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use lumel::{Ended, TargetError};
use lumel_view::solver::Phase;

/// Ends a solve after its first round, long before its target.
fn stopped(window: &mut Window) {
    let settings = &mut window.session().settings;
    settings.target_error = TargetError::At("0.1%".parse().unwrap());
    settings.indirect_samples = 8192;
    window.press(Key::Enter);
    window
        .wait_until("a round", |app| app.session.job().is_some_and(|job| job.progress().accuracy.is_some()));
    window.run_steps(1);
    assert!(window.reads("of values within 0.1 %"), "{}", window.texts());
    window.press(Key::Escape);
    window.wait_until("the end", |app| !app.session.is_solving());
    window.run_steps(2);
}

#[test]
fn a_solve_ends_at_the_error_that_was_asked_for_and_tells_it() {
    let Some(mut window) = Window::room() else { return };
    window.check("Stop at an error");
    assert_eq!(window.session().settings.target_error.to_string(), "2 %");
    window.solve();
    let accuracy = window.session().computed().unwrap().accuracy().unwrap();
    assert_eq!(accuracy.ended, Some(Ended::Reached));
    assert!(accuracy.rounds > 1, "nothing was added");
    let share = format!("{:.1} % of values within 2 %", 100.0 * accuracy.share);
    assert!(window.reads(&share), "{}", window.texts());
    let light = &window.state().session.light;
    assert!(light.standard_error.as_ref().unwrap().iter().any(|error| error.y > 0.0));
    assert_eq!(light.bounces.len(), 3);
    assert_eq!(bits(window.state()), reference(window.state()));
    // What is saved has the errors too.
    assert!(window.state().session.solution().unwrap().standard_error.is_some());
    window.check("Stop at an error");
    window.run_steps(1);
    assert_eq!(window.session().settings.target_error, TargetError::Off);
    assert!(window.state().session.out_of_date().is_some());
}

#[test]
fn direct_light_is_seen_before_the_first_round_is_done() {
    let Some(mut window) = Window::room() else { return };
    let settings = &mut window.session().settings;
    settings.target_error = TargetError::At("1%".parse().unwrap());
    (settings.direct_samples, settings.indirect_samples) = (4096, 65_536);
    window.press(Key::Enter);
    window.wait_until("a look", |app| app.session.light.current.is_some());
    let session = window.session();
    assert_eq!((session.phase(), session.light.bounces.len()), (Some(Phase::Round(0)), 0));
    session.stop();
}

#[test]
fn a_stopped_solve_keeps_the_light_of_its_last_round() {
    let Some(mut window) = Window::room() else { return };
    stopped(&mut window);
    assert!(window.told("Stopped; showing the last finished round"));
    assert!(window.reads("Stopped: press Enter to start over"), "{}", window.texts());
    assert!(window.has(Role::Button, "Solve"));
    assert_eq!(window.session().light.bounces.len(), 3);
}

#[test]
fn light_of_a_stopped_solve_is_restored() {
    let Some(mut window) = Window::room() else { return };
    stopped(&mut window);
    let before = bits(window.state());
    window.state_mut().on_exit();
    let folder = window.folder();
    drop(window);
    let Some(mut window) = Window::keeping(folder, |_| {}) else { return };
    window.click("Restore");
    window.wait_until("the light", |app| !app.session.light.is_empty());
    window.run_steps(1);
    assert_eq!(bits(window.state()), before);
    assert!(!window.session().is_solving() && window.session().has_unsaved_light());
    assert!(window.told("press Enter to solve again"));
}
