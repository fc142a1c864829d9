//! Stopping at an error.

use crate::expected::{bits, reference};
use crate::harness::Window;
use crate::recovery::kept_by_an_earlier_version;
use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use lumel::{BounceLimit, Ended, TargetError};
use lumel_view::solver::Phase;
use std::time::{Duration, Instant};

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
    assert!(window.told("Stopped; press Enter to resume after the last finished round"));
    assert!(window.reads("Stopped: press Enter to resume"), "{}", window.texts());
    assert!(window.has(Role::Button, "Resume"));
    assert_eq!(window.session().light.bounces.len(), 3);
    // Other bounces may ask for other samples.
    window.session().settings.bounces = BounceLimit::Count(1);
    window.run_steps(2);
    assert!(window.reads("Stopped: press Enter to start over"), "{}", window.texts());
}

/// Ends a solve of several rounds after one of them.
fn stopped_between_rounds(window: &mut Window) {
    let settings = &mut window.session().settings;
    settings.target_error = TargetError::At("0.5%".parse().unwrap());
    settings.indirect_samples = 2048;
    window.press(Key::Enter);
    window.run_steps(1);
    // A frame may take longer than the rest of the solve.
    let begun = Instant::now();
    while window.session().job().unwrap().progress().accuracy.is_none() {
        assert!(begun.elapsed() < Duration::from_secs(60), "waited for a round");
        std::thread::sleep(Duration::from_millis(1));
    }
    window.session().stop();
    window.wait_until("the end", |app| !app.session.is_solving());
    window.run_steps(1);
    let computed = window.session().computed().unwrap();
    assert!(!computed.complete && computed.accuracy().unwrap().ended.is_none(), "it was over too soon");
}

#[test]
fn a_stopped_solve_goes_on_with_the_same_bits() {
    let Some(mut window) = Window::room() else { return };
    stopped_between_rounds(&mut window);
    window.solve();
    assert_eq!(window.session().computed().unwrap().accuracy().unwrap().ended, Some(Ended::Reached));
    assert_eq!(bits(window.state()), reference(window.state()));
}

#[test]
fn a_solve_that_was_closed_between_rounds_is_restored_and_ends_with_the_same_bits() {
    let Some(mut window) = Window::room() else { return };
    stopped_between_rounds(&mut window);
    let folder = window.closed();
    let Some(mut window) = Window::keeping(folder, |_| {}) else { return };
    window.click("Restore");
    window.wait_until("the solve", |app| app.session.computed().is_some_and(|c| c.complete));
    let computed = window.session().computed().unwrap();
    assert_eq!(computed.accuracy().unwrap().ended, Some(Ended::Reached));
    assert!(window.session().light.standard_error.is_some());
    assert_eq!(bits(window.state()), reference(window.state()));
}

#[test]
fn light_of_a_stopped_solve_is_restored_and_its_rounds_go_on() {
    let Some(mut window) = Window::room() else { return };
    stopped(&mut window);
    let before = bits(window.state());
    let folder = window.closed();
    let Some(mut window) = Window::keeping(folder, |_| {}) else { return };
    window.click("Restore");
    window.wait_until("the light", |app| !app.session.light.is_empty());
    assert_eq!(bits(window.state()), before);
    assert!(window.session().is_solving() && window.session().light.standard_error.is_some());
    assert!(window.session().job().unwrap().progress().accuracy.is_some());
    window.session().stop();
}

#[test]
fn a_solution_that_an_earlier_version_kept_is_shown_and_solved_again() {
    let Some(mut window) = Window::room() else { return };
    stopped(&mut window);
    let before = bits(window.state());
    let solution = window.session().solution().unwrap();
    let folder = window.closed();
    kept_by_an_earlier_version(folder.path(), &solution);
    let Some(mut window) = Window::keeping(folder, |_| {}) else { return };
    window.click("Restore");
    window.wait_until("the light", |app| !app.session.light.is_empty());
    window.run_steps(1);
    assert_eq!(bits(window.state()), before);
    assert!(!window.session().is_solving() && window.session().has_unsaved_light());
    assert!(window.told("press Enter to solve again"));
    // Left alone, it is offered once more.
    let folder = window.closed();
    let Some(mut window) = Window::keeping(folder, |_| {}) else { return };
    window.click("Restore");
    window.wait_until("the light", |app| !app.session.light.is_empty());
    assert_eq!(bits(window.state()), before);
}
