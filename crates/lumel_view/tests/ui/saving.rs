//! Saving meshes and projects.

use crate::hands::CTRL;
use crate::harness::Window;
use crate::scenes::write_mesh;
use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use lumel::{MaxEdge, OpenOptions, Project};
use lumel_view::app::App;
use lumel_view::document::OpenRequest;
use std::path::Path;

fn vertices_in(file: &Path) -> usize {
    let as_it_is = OpenOptions { max_edge: Some(MaxEdge::Off), ..OpenOptions::default() };
    let (scene, _) = lumel::open(&file, &as_it_is)
        .unwrap_or_else(|e| panic!("{e}: {}", file.display()))
        .builder
        .build()
        .unwrap();
    scene.vertex_count()
}

#[test]
fn the_lit_mesh_is_saved_in_three_formats() {
    let Some(mut window) = Window::solved_room() else { return };
    let n = window.state().session.document.as_ref().unwrap().scene.vertex_count();
    for name in ["lit.glb", "lit.ply", "lit.obj"] {
        let file = window.file(name);
        window.press(Key::O);
        assert!(window.has(Role::ComboBox, "Light"));
        window.answer(&file);
        window.wait_for_files();
        assert!(window.told("Saved the mesh with all light"), "{name}");
        let found = vertices_in(&file);
        assert!(found >= n / 2 && found <= 2 * n, "{name}: {found} vertices, not {n}");
    }
    assert!(std::fs::read_to_string(window.file("lit.obj")).unwrap().contains("\nf "));
}

#[test]
fn the_mesh_is_saved_with_the_light_that_is_shown() {
    let Some(mut window) = Window::solved_room() else { return };
    let mut saved = |name: &str| {
        let file = window.file(name);
        window.press(Key::O);
        window.answer(&file);
        window.wait_for_files();
        std::fs::read(file).unwrap()
    };
    let all = saved("all.ply");
    assert_eq!(all, saved("again.ply"));
    window.press(Key::G);
    let file = window.file("direct.ply");
    window.press(Key::O);
    window.answer(&file);
    window.wait_for_files();
    assert!(window.told("Saved the mesh with direct light"));
    assert_ne!(all, std::fs::read(file).unwrap());
}

#[test]
fn what_cannot_be_saved_is_told_where_one_asked_for_it() {
    let Some(mut window) = Window::empty() else { return };
    let mesh = write_mesh(window.folder().path());
    window.session().open(OpenRequest::new(mesh.to_string_lossy()));
    window.wait_for_files();
    window.press(Key::O);
    assert!(window.reads("There is no solution yet: the mesh is saved without light."));
    window.answer(window.file("lit.fbx"));
    assert!(window.reads("the name must end in .glb, .ply, .obj"));
    window.answer(&mesh);
    assert!(window.reads("this file belongs to the open scene and would be overwritten"));
    window.answer("");
    assert!(window.reads("enter a path"));
    window.answer(window.file("nowhere/lit.glb"));
    window.wait_for_files();
    assert!(window.told("Cannot save: ") && window.reads("Cannot save: "));
    assert_eq!(vertices_in(&mesh), 5 * 4);
}

#[test]
fn a_file_that_is_replaced_is_told_before() {
    let Some(mut window) = Window::room() else { return };
    let file = window.file("lit.ply");
    std::fs::write(&file, "old").unwrap();
    window.press(Key::O);
    window.write_path(&file);
    assert!(window.reads("This file exists and will be overwritten."));
}

#[test]
fn projects_are_saved_where_one_says_and_then_silently() {
    let Some(mut window) = Window::empty() else { return };
    let mesh = write_mesh(window.folder().path());
    window.session().open(OpenRequest::new(mesh.to_string_lossy()));
    window.wait_for_files();
    window.press(Key::Insert);
    window.press_with(CTRL, Key::S);
    let file = window.file("mine.toml");
    window.answer(&file);
    assert!(window.told("Saved the project") && !window.state().dialogs.is_any_open());
    assert_eq!(lights_in(&file), 1);
    window.press(Key::Insert);
    window.press_with(CTRL, Key::S);
    assert!(!window.state().dialogs.is_any_open());
    assert_eq!(lights_in(&file), 2);
    window.press_with(CTRL | eframe::egui::Modifiers::SHIFT, Key::S);
    let other = window.file("other.toml");
    window.answer(&other);
    assert_eq!(lights_in(&other), 2);
}

#[test]
fn what_a_project_says_about_meshes_that_follow_light_stays() {
    let Some(mut window) = Window::empty() else { return };
    let file = window.file("follows.toml");
    let given = "builtin = \"cornell-box\"\n[bake]\nadaptive = 0.03\nmax_vertices = 9000\n";
    std::fs::write(&file, given).unwrap();
    let bake = |file: &Path| std::fs::read_to_string(file).unwrap().parse::<Project>().unwrap().bake;
    let before = bake(&file);
    window.session().open(OpenRequest::new(file.to_string_lossy()));
    window.wait_for_files();
    window.press(Key::Insert);
    window.session().save_project(&file).unwrap();
    let after = bake(&file);
    assert_eq!((after.adaptive, after.max_vertices), (before.adaptive, before.max_vertices));
    assert!(after.adaptive.is_some() && lights_in(&file) == 2);
}

fn lights_in(file: &Path) -> usize {
    std::fs::read_to_string(file).unwrap().parse::<Project>().unwrap().lights.len()
}

#[test]
fn a_saved_project_brings_back_lights_slots_settings_and_view() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::F2);
    window.nudge("Indirect samples", Key::ArrowRight, 8);
    window.press_with(eframe::egui::Modifiers::ALT, Key::Num4);
    window.press(Key::Insert);
    window.press(Key::H);
    window.hold(Default::default(), Key::W, 4);
    window.hold(Default::default(), Key::ArrowLeft, 4);
    window.press_with(CTRL, Key::S);
    let kept = |window: &mut Window| {
        let s = window.session();
        let lights: Vec<_> = s.lights.iter().map(|l| (l.name.clone(), l.on, l.rect)).collect();
        (lights, s.slots.digits().collect::<Vec<_>>(), s.settings.clone(), s.camera)
    };
    let before = kept(&mut window);
    assert_eq!((before.0.len(), before.0[1].1), (2, false));
    assert!(!window.session().has_unsaved_edits());
    let project = window.file("room.toml");
    let open = OpenRequest::new(project.to_string_lossy());
    let Some(mut again) = Window::start(window.folder(), |setup| setup.start.open = Some(open)) else {
        return;
    };
    let after = kept(&mut again);
    assert_eq!((&after.0, &after.1, &after.2), (&before.0, &before.1, &before.2));
    assert_eq!(
        again.session().slots.get(4).unwrap().settings,
        window.session().slots.get(4).unwrap().settings
    );
    let (a, b) = (before.3, after.3);
    assert!(a.position.distance(b.position) < 1e-4 && (a.yaw_deg - b.yaw_deg).abs() < 1e-2, "{a:?} {b:?}");
}

#[test]
fn a_project_away_from_its_mesh_is_refused() {
    let Some(mut window) = Window::room() else { return };
    let elsewhere = tempfile::tempdir().unwrap();
    window.press_with(CTRL | eframe::egui::Modifiers::SHIFT, Key::S);
    window.answer(elsewhere.path().join("far.toml"));
    assert!(window.reads("a project can only refer to files in its folder"));
}

#[test]
fn format_light_and_exposure_of_a_mesh_are_chosen() {
    let Some(mut window) = Window::solved_room() else { return };
    let mut saved = |light: &str, exposure: &str| {
        window.press(Key::O);
        window.write_path(window.file("lit.glb"));
        window.choose("Format", "PLY");
        window.choose("Light", light);
        window.choose("Exposure", exposure);
        if exposure == "Fixed" {
            window.find(Role::SpinButton, "Stops").set_value_accesskit(-8.0);
            window.run_steps(1);
        }
        window.click("Save");
        window.wait_for_files();
        std::fs::read(window.file("lit.ply")).unwrap()
    };
    let all = saved("All light", "Automatic");
    let bounce = saved("Bounce 1", "Automatic");
    let dark = saved("All light", "Fixed");
    assert!(all != bounce && all != dark && bounce != dark);
    assert!(window.told("Saved the mesh with bounce 1"));
}

#[test]
fn what_opening_another_scene_would_lose_is_saved_on_request() {
    let Some(mut window) = Window::solved_room() else { return };
    let taken = window.file("room.npz");
    std::fs::write(&taken, "another one").unwrap();
    window.press(Key::Insert);
    window.press(Key::M);
    window.click("furnace");
    window.click("Save and open");
    let is_furnace = |app: &App| app.session.document.as_ref().is_some_and(|d| d.request.name == "furnace");
    window.wait_until("the other scene", is_furnace);
    assert_eq!(std::fs::read_to_string(taken).unwrap(), "another one");
    assert!(lumel::Solution::load(&window.file("room-2.npz")).is_ok());
    assert_eq!(lights_in(&window.file("room.toml")), 2);
}
