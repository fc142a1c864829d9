//! Solutions and pictures as files.

use crate::expected::bits;
use crate::harness::Window;
use eframe::egui::Key;
use lumel::{RadFile, Solution};
use lumel_view::document::OpenRequest;

#[test]
fn a_solution_is_saved_and_loaded_with_all_its_bounces() {
    let Some(mut window) = Window::solved_room() else { return };
    let before = bits(window.state());
    assert!(window.session().has_unsaved_light());
    window.click("Save solution...");
    let file = window.file("room.npz");
    window.answer(&file);
    window.wait_for_files();
    assert!(window.told("Saved the solution") && !window.session().has_unsaved_light());
    let solution = Solution::load(&file).unwrap();
    assert_eq!((solution.bounces.len(), solution.meta.complete), (3, true));
    window.session().reload();
    window.wait_for_files();
    assert!(window.session().light.is_empty());
    window.press(Key::L);
    window.answer(&file);
    window.wait_for_files();
    assert!(window.told("Loaded room.npz") && bits(window.state()) == before);
    assert!(window.reads("Solved: room.npz"));
}

#[test]
fn a_loaded_solution_is_gone_on_with() {
    // What is read by least squares would be known again to rounding only.
    let Some(mut window) = Window::room() else { return };
    window.session().settings.projection = lumel::Projection::Point;
    window.solve();
    let file = window.file("room.npz");
    window.press(Key::K);
    window.answer(&file);
    window.wait_for_files();
    window.click("Load solution...");
    window.answer(&file);
    window.wait_for_files();
    window.session().settings.bounces = lumel::BounceLimit::Count(4);
    window.solve();
    assert!(bits(window.state()) == crate::expected::reference(window.state()));
    assert!(window.session().stats[..3].iter().all(|s| s.seconds == 0.0));
}

#[test]
fn the_sum_is_saved_and_loaded_in_the_format_of_the_course() {
    let Some(mut window) = Window::solved_room() else { return };
    let all = window.session().selected_light(Default::default());
    let file = window.file("room.rad");
    window.press(Key::K);
    window.answer(&file);
    window.wait_for_files();
    assert!(RadFile::read(&file).unwrap().matches(&window.state().session.document.as_ref().unwrap().scene));
    assert!(window.session().has_unsaved_light(), "the bounces are in no file");
    window.press(Key::L);
    window.answer(&file);
    window.wait_for_files();
    let loaded = window.session().selected_light(Default::default());
    let close = all.iter().zip(&loaded).all(|(a, b)| (*a - *b).length() <= 1e-4 * a.length());
    assert!(close && window.session().light.bounce_count() == 0);
    assert!(window.told("The unsaved solution was kept for comparison") && window.session().kept.len() == 1);
}

#[test]
fn a_solution_of_another_scene_is_refused_by_both_names() {
    let Some(mut window) = Window::solved_room() else { return };
    let [solution, rad] = ["room.npz", "room.rad"].map(|name| window.file(name));
    for file in [&solution, &rad] {
        window.press(Key::K);
        window.answer(file);
        window.wait_for_files();
    }
    window.session().open(OpenRequest::new("furnace"));
    window.wait_for_files();
    for file in [&solution, &rad] {
        window.press(Key::L);
        window.answer(file);
        window.wait_for_files();
        let last = window.session().notices.all().last().unwrap().text.clone();
        assert!(last.contains("Cannot load the solution") && last.contains("\"furnace\""), "{last}");
        assert!(last.contains("room"), "{last}");
    }
    assert!(window.session().light.is_empty());
}

#[test]
fn solutions_that_cannot_be_are_told_in_the_dialog() {
    let Some(mut window) = Window::room() else { return };
    window.press(Key::K);
    window.answer(window.file("room.npz"));
    assert!(window.reads("there is no solution yet: solve first"));
    window.press(Key::Escape);
    window.press(Key::L);
    window.answer("nowhere.npz");
    assert!(window.reads("there is no such file: nowhere.npz"));
    let broken = window.file("broken.npz");
    std::fs::write(&broken, "PK").unwrap();
    window.answer(&broken);
    window.wait_for_files();
    assert!(window.told("Cannot load the solution") && window.session().light.is_empty());
}

#[test]
fn f12_saves_the_picture_with_its_settings_inside() {
    let Some(mut window) = Window::solved_room() else { return };
    let picture = window.picture();
    window.press(Key::F12);
    window.wait_for_files();
    let files = std::fs::read_dir(window.folder().path()).unwrap().flatten().map(|entry| entry.path());
    let saved: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "png")).collect();
    let [file] = saved.as_slice() else { panic!("{saved:?}") };
    assert!(file.file_name().unwrap().to_string_lossy().starts_with("room-2"));
    let image = image::open(file).unwrap().to_rgb8();
    assert_eq!((image.width(), image.height()), (picture.width(), picture.height()));
    assert!(image.pixels().zip(picture.pixels()).all(|(a, b)| a.0 == *b));
    let bytes = std::fs::read(file).unwrap();
    let has = |text: &str| bytes.windows(text.len()).any(|part| part == text.as_bytes());
    for text in
        ["Title\0", "Software\0lumel-view", "Comment\0Final colour, all light", "\"indirect_samples\":8"]
    {
        assert!(has(text), "{text}");
    }
}
