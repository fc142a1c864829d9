//! Unsaved work that a closed window leaves behind.

use crate::expected::{bits, reference};
use crate::harness::Window;
use eframe::App as _;
use eframe::egui::{Key, Modifiers};
use lumel::{BounceLimit, Solution};
use std::path::Path;

/// The files of unsaved work; the lock of the process stays as long as this program runs.
fn left_behind(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder.join("unsaved")).into_iter().flatten().flatten();
    let names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
    let mut names: Vec<_> = names.filter(|name| !name.ends_with(".lock")).collect();
    names.sort();
    names
}

/// Replaces the checkpoint of unsaved work by a solution, as earlier versions kept it.
pub(crate) fn kept_by_an_earlier_version(folder: &Path, solution: &Solution) {
    let files = left_behind(folder);
    let checkpoint = files.iter().find(|name| name.ends_with(".checkpoint.npz")).unwrap();
    solution.save(&folder.join("unsaved").join(checkpoint)).unwrap();
}

/// Closes a window in mid-solve and opens another one, which offers what was left behind.
fn closed_in_mid_solve() -> Option<(Window, usize)> {
    let mut window = Window::room()?;
    window.press(Key::Insert);
    window.press_with(Modifiers::ALT, Key::Num2);
    window.solve_bounces(2);
    window.state_mut().on_exit();
    let done = window.session().light.bounces.len();
    assert!(!window.state().session.is_solving() && (2..9).contains(&done), "{done}");
    let folder = window.folder();
    drop(window);
    assert_eq!(left_behind(folder.path()).len(), 2);
    let next = Window::keeping(folder, |_| {})?;
    assert!(next.reads("Unsaved work"));
    let after = if done == 2 { "1 bounce".to_owned() } else { format!("{} bounces", done - 1) };
    assert!(next.reads(&format!("room.toml: a solve stopped after {after}")));
    Some((next, done))
}

#[test]
fn a_solve_that_was_closed_is_restored_and_ends_with_the_same_bits() {
    let Some((mut window, done)) = closed_in_mid_solve() else { return };
    window.click("Restore");
    window.wait_until("the solve", |app| app.session.computed().is_some_and(|c| c.complete));
    window.run_steps(2);
    assert!(!window.state().dialogs.is_any_open() && window.told("Restored room.toml"));
    assert_eq!(window.session().light.bounces.len(), 9);
    assert!(bits(window.state()) == reference(window.state()));
    let again = window.session().stats[..done].iter().any(|s| s.seconds > 0.0);
    assert!(!again, "nothing was computed twice");
    assert!(window.session().slots.get(2).is_some() && window.session().lights.len() == 2);
    // Saved, it is no longer kept.
    window.press(Key::K);
    window.answer(window.file("room.npz"));
    window.wait_for_files();
    assert_eq!(left_behind(window.folder().path()), [""; 0]);
}

#[test]
fn a_solution_that_an_earlier_version_kept_is_resumed() {
    // What is read by least squares would be known again to rounding only.
    let Some(mut window) = Window::room() else { return };
    window.session().settings.projection = lumel::Projection::Point;
    window.solve();
    let (before, solution) = (bits(window.state()), window.session().solution().unwrap());
    window.session().settings.bounces = BounceLimit::Count(4);
    let folder = window.closed();
    kept_by_an_earlier_version(folder.path(), &solution);
    let Some(mut window) = Window::keeping(folder, |_| {}) else { return };
    window.click("Restore");
    window.wait_until("the solve", |app| app.session.computed().is_some_and(|c| c.complete));
    let all = bits(window.state());
    assert!(all.len() == 5 && all[..before.len()] == before && all == reference(window.state()));
    assert_eq!(window.session().stats[..before.len()].iter().map(|s| s.seconds).sum::<f64>(), 0.0);
}

#[test]
fn discarding_unsaved_work_removes_its_files() {
    let Some((mut window, _)) = closed_in_mid_solve() else { return };
    window.click("Discard");
    assert_eq!(left_behind(window.folder().path()), [""; 0]);
    assert!(!window.state().dialogs.is_any_open() && window.session().document.is_none());
}

#[test]
fn unsaved_work_that_is_put_off_is_offered_the_next_time() {
    let Some((mut window, _)) = closed_in_mid_solve() else { return };
    window.click("Not now");
    assert!(!window.state().dialogs.is_any_open());
    // What is done meanwhile does not take its place.
    let project = window.file("room.toml");
    window.press(Key::M);
    window.answer(project);
    window.wait_for_files();
    window.solve();
    assert!(left_behind(window.folder().path()).len() > 2);
    let folder = window.folder();
    drop(window);
    let Some(next) = Window::keeping(folder, |_| {}) else { return };
    assert!(next.reads("Unsaved work"));
}

#[test]
fn nothing_is_left_behind_where_all_is_saved() {
    let Some(mut window) = Window::solved_room() else { return };
    assert_eq!(left_behind(window.folder().path()).len(), 2, "after each bounce");
    window.press(Key::K);
    window.answer(window.file("room.npz"));
    window.wait_for_files();
    window.state_mut().on_exit();
    assert_eq!(left_behind(window.folder().path()), [""; 0]);
}

#[test]
fn moved_lights_are_restored_without_a_solve() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::Space);
    let lights = window.session().lights.clone();
    let folder = window.closed();
    let Some(mut next) = Window::keeping(folder, |_| {}) else { return };
    assert!(next.reads("room.toml: lights, materials and slots"));
    next.click("Restore");
    next.wait_for_files();
    assert_eq!(next.session().lights, lights);
    assert!(next.session().light.is_empty() && next.session().has_unsaved_edits());
}
