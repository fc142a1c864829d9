//! Meshes that follow light.

use crate::expected::{bits, differing, reference_of};
use crate::harness::Window;
use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use lumel::{Adaptive, Baker, Control, Solution};
use lumel_view::app::App;
use lumel_view::layout::{LightBasis, LumelCount};
use lumel_view::prefs::ViewMode;
use lumel_view::session::LightUse;
use lumel_view::solver::Phase;

/// The room with the switch on, and an error that a few steps reach.
fn following_room() -> Option<Window> {
    let mut window = Window::room()?;
    window.check("Follow light");
    window.session().settings.adaptive = Adaptive::At("4%".parse().unwrap());
    Some(window)
}

fn vertices(app: &App) -> usize {
    app.session.document.as_ref().unwrap().scene.vertex_count()
}

fn splits(app: &App) -> Vec<[u32; 2]> {
    let scene = &app.session.document.as_ref().unwrap().scene;
    scene.refinement().map_or(Vec::new(), |refinement| refinement.splits().to_vec())
}

/// Waits until an unfinished mesh is shown with its light.
fn wait_for_a_finer_mesh(window: &mut Window, than: usize) {
    window.wait_until("a finer mesh", |app| {
        matches!(app.session.phase(), Some(Phase::Refining { .. })) && vertices(app) > than
    });
}

/// That mesh and light are those that the command line makes.
#[track_caller]
fn assert_is_that_of_a_bake(app: &App) {
    let document = app.session.document.as_ref().unwrap();
    let scene = document.opened.scene().relit(document.scene.lights().to_vec()).unwrap();
    let baker = Baker::new(scene.into(), app.session.settings.clone());
    let adapted = baker.adapted(&Control::default(), &mut |_| {}).unwrap().unwrap().baker;
    assert!(
        splits(app) == adapted.scene().refinement().unwrap().splits(),
        "other edges than those of a bake"
    );
    assert!(bits(app) == reference_of(adapted.scene().clone(), app.session.settings.clone()));
}

#[test]
fn the_switch_and_the_sliders_set_error_and_budget() {
    let Some(mut window) = Window::room() else { return };
    assert!(!window.has(Role::Slider, "Bend") && !window.has(Role::Slider, "Vertices"));
    window.check("Follow light");
    assert_eq!(window.session().settings.adaptive, Adaptive::At("2%".parse().unwrap()));
    window.nudge("Bend", Key::ArrowRight, 8);
    window.nudge("Vertices", Key::ArrowLeft, 8);
    let settings = window.session().settings.clone();
    assert!(settings.adaptive.error().unwrap().get() > 0.02, "{settings:?}");
    assert!(settings.max_vertices < 500_000, "{settings:?}");
    window.check_accessibility();
    window.check("Follow light");
    assert_eq!(window.session().settings.adaptive, Adaptive::Off);
}

#[test]
fn a_mesh_is_refined_in_sight_stopped_resumed_and_has_the_bits_of_a_bake() {
    let Some(mut window) = following_room() else { return };
    let given = vertices(window.state());
    window.press(Key::X);
    let before = window.picture();
    window.press(Key::Enter);
    wait_for_a_finer_mesh(&mut window, given);
    // One flies on meanwhile, and stops it.
    window.press(Key::Escape);
    window.wait_until("the end", |app| app.session.phase().is_none());
    window.run_steps(2);
    let stopped = vertices(window.state());
    assert!(stopped > given && window.told("refine the mesh further"));
    assert!(differing(&before, &window.picture()) > 10, "the mesh and its light are shown");
    assert!(window.session().can_go_on() && !window.session().light.is_empty());
    window.session().save_solution("a.npz".as_ref()).unwrap_err();
    window.solve();
    assert!(vertices(window.state()) > stopped);
    assert_is_that_of_a_bake(window.state());
    window.press(Key::Enter);
    assert!(window.told("Already solved"));
    // Without the switch, the mesh is again what was opened.
    window.session().settings.adaptive = Adaptive::Off;
    window.run_steps(2);
    window.solve();
    assert_eq!(vertices(window.state()), given);
}

#[test]
fn bends_of_light_are_shown_in_colours_once_a_mesh_was_refined() {
    let Some(mut window) = following_room() else { return };
    window.tab("Display");
    window.choose("Surfaces show", "Bends of light");
    assert!(window.reads("Not known yet"));
    let plain = window.picture();
    window.solve();
    assert!(!window.reads("Not known yet"));
    assert_eq!(window.state().prefs.view.mode, ViewMode::Bends);
    assert!(differing(&plain, &window.picture()) > 100);
    let bends = window.session().document.as_ref().unwrap().indicator.clone().unwrap();
    assert!(bends.iter().filter(|bend| bend.x > 1.0).count() * 20 < bends.len(), "too many are left");
    assert!(bends.iter().any(|bend| bend.x > 0.5));
}

#[test]
fn a_refined_solution_is_saved_opened_compared_and_relit() {
    let Some(mut window) = Window::solved_room() else { return };
    let given = vertices(window.state());
    window.press(Key::P);
    window.check("Follow light");
    window.session().settings.adaptive = Adaptive::At("4%".parse().unwrap());
    window.session().live = true;
    window.solve();
    let (fine, light) = (splits(window.state()), bits(window.state()));
    // The even mesh beside it, read on the triangles that are shown.
    window.press(Key::C);
    window.tab("Compare");
    window.run_steps(2);
    assert!(window.reads("Relative RMSE"), "{}", window.texts());
    let kept = window.session().kept[0].light.select(Default::default(), given);
    let scene = window.session().document.as_ref().unwrap().scene.clone();
    let on_fine = window.session().kept[0].light_on(&scene).select(Default::default(), scene.vertex_count());
    for (v, value) in kept.iter().enumerate() {
        assert!((on_fine[v] - *value).length() <= 0.02 * value.length() + 1e-3, "{v}");
    }
    window.press(Key::C);
    let path = window.file("fine.npz");
    window.session().save_solution(&path).unwrap();
    window.wait_for_files();
    assert_eq!(Solution::load(&path).unwrap().splits, fine);
    let project = window.file("fine.toml");
    window.session().save_project(&project).unwrap();
    // Lights move on the mesh as it is; Enter refines it for where they are.
    window.session().lights[0].rect.center.x += 0.4;
    window.wait_until("live light", |app| !app.session.is_following() && bits(app) != light);
    assert_eq!(splits(window.state()), fine);
    window.tab("Solve");
    window.wait_until("rest", |app| app.session.follows_other_light() && !app.session.is_light_in_motion());
    window.run_steps(2);
    assert!(window.reads("The mesh follows light as it was"));
    window.solve();
    assert_ne!(splits(window.state()), fine);
    assert!(!window.session().follows_other_light());
    // From files, in another window.
    let folder = window.folder();
    drop(window);
    let mut window = Window::keeping(folder, |setup| {
        setup.start.open = Some(lumel_view::document::OpenRequest::new(project.to_string_lossy()));
    })
    .unwrap();
    window.click("Discard");
    assert_ne!(window.session().settings.adaptive, Adaptive::Off);
    assert_eq!(vertices(window.state()), given);
    window.session().load_solution(&path, LightUse::Show);
    window.wait_for_files();
    assert!(splits(window.state()) == fine && bits(window.state()) == light);
    window.press(Key::Enter);
    assert!(window.told("Already solved"));
}

#[test]
fn lumels_are_measured_from_a_refined_mesh() {
    let Some(mut window) = following_room() else { return };
    let lumels = &mut window.session().lumels;
    (lumels.basis, lumels.count) = (LightBasis::Lightmap, LumelCount::Budget(2000));
    window.wait_until("the unwrap", |app| app.session.layout().is_some());
    window.solve();
    assert!(!splits(window.state()).is_empty());
    window.wait_until("the lumels", |app| app.session.has_whole_lightmap() && app.session.phase().is_none());
    let lumels = window.picture();
    window.session().lumels.basis = LightBasis::Vertices;
    let on_vertices = window.picture();
    assert!(differing(&lumels, &on_vertices) > 0, "{}", differing(&lumels, &on_vertices));
}

#[test]
fn a_refinement_that_was_closed_is_restored_and_ends_with_the_same_bits() {
    let Some(mut window) = following_room() else { return };
    let given = vertices(window.state());
    window.press(Key::Enter);
    wait_for_a_finer_mesh(&mut window, given);
    let folder = window.closed();
    let mut window = Window::keeping(folder, |_| {}).unwrap();
    assert!(window.reads("room.toml: a mesh that is being refined"), "{}", window.texts());
    window.click("Restore");
    // Closed once more, after direct light on the finished mesh.
    window.wait_until("direct light", |app| !app.session.light.bounces.is_empty());
    let folder = window.closed();
    let mut window = Window::keeping(folder, |_| {}).unwrap();
    window.click("Restore");
    window.wait_until("the solve", |app| app.session.computed().is_some_and(|c| c.complete));
    window.run_steps(2);
    assert_is_that_of_a_bake(window.state());
}
