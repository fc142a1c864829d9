//! What the picture shows.

use crate::expected::differing;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Rect, pos2, vec2};
use lumel_render_cpu::Picture;
use lumel_view::prefs::{Known, Unit, ViewMode};
use lumel_view::selection::Selection;

fn shown(window: &Window) -> Selection {
    window.state().view().selection
}

#[test]
fn bounces_are_chosen_by_buttons_and_keys_without_computing_anything() {
    let Some(mut window) = Window::solved_room() else { return };
    let generation = window.session().light_generation;
    let mut pictures: Vec<Picture> = Vec::new();
    for (button, key, selection) in [
        ("All", Key::B, Selection::All),
        ("Direct", Key::G, Selection::DIRECT),
        ("Indirect", Key::J, Selection::Indirect),
    ] {
        window.state_mut().prefs.view.selection = Selection::bounce(2);
        window.click(button);
        assert_eq!(shown(&window), selection);
        let picture = window.picture();
        assert!(pictures.iter().all(|other| differing(other, &picture) > 20), "{button}");
        pictures.push(picture);
        window.state_mut().prefs.view.selection = Selection::bounce(2);
        window.press(key);
        assert_eq!(shown(&window), selection);
    }
    for k in [1, 2] {
        window.click(&k.to_string());
        assert_eq!(shown(&window), Selection::bounce(k));
    }
    let session = window.session();
    assert!(session.job().is_none() && session.light_generation == generation);
    assert!(session.stats.iter().all(|s| s.seconds > 0.0), "computed once");
}

#[test]
fn comma_and_period_go_through_the_bounces() {
    let Some(mut window) = Window::solved_room() else { return };
    let mut after = |key| {
        window.press(key);
        shown(&window)
    };
    assert_eq!([0; 4].map(|_| after(Key::Period)), [0, 1, 2, 2].map(Selection::bounce));
    assert_eq!([0; 3].map(|_| after(Key::Comma)), [1, 0, 0].map(Selection::bounce));
    assert_eq!(after(Key::J), Selection::Indirect);
    assert_eq!(after(Key::Comma), Selection::bounce(2), "before all is the last");
}

#[test]
fn a_range_of_bounces_is_dialled() {
    let Some(mut window) = Window::solved_room() else { return };
    let set = |window: &mut Window, name: &str, k: f64| {
        window.find(Role::SpinButton, name).set_value_accesskit(k);
        window.run_steps(2);
    };
    set(&mut window, "First bounce", 1.0);
    assert_eq!(shown(&window), Selection::Range(1, 2));
    set(&mut window, "Last bounce", 1.0);
    assert_eq!(shown(&window), Selection::Range(1, 1));
    set(&mut window, "Last bounce", 0.0);
    assert_eq!(shown(&window), Selection::Range(0, 0), "the other end gives way");
    set(&mut window, "Last bounce", 1.0);
    let range = window.picture();
    window.press(Key::G);
    assert!(differing(&range, &window.picture()) > 20);
}

#[test]
fn terms_of_the_series_are_shown_large_when_clicked() {
    let Some(mut window) = Window::solved_room() else { return };
    window.click("Show Direct light");
    assert_eq!(shown(&window), Selection::DIRECT);
    window.click("Show Bounce 1");
    assert_eq!(shown(&window), Selection::bounce(1));
    window.click("Show All light");
    assert_eq!(shown(&window), Selection::All);
}

#[test]
fn every_view_mode_draws_another_picture() {
    let Some(mut window) = Window::solved_room() else { return };
    let mut pictures: Vec<(ViewMode, Picture)> = Vec::new();
    // Bends are known once a mesh was refined.
    for mode in ViewMode::offered(Known::default()).filter(|mode| *mode != ViewMode::Bends) {
        window.choose("View mode", mode.name());
        assert_eq!(window.state().view().mode, mode);
        let picture = window.picture();
        for (other, of_other) in &pictures {
            assert!(differing(of_other, &picture) > 50, "{other:?} and {mode:?}");
        }
        pictures.push((mode, picture));
    }
    window.tab("Display");
    window.choose("Surfaces show", "Albedo");
    assert_eq!(window.state().view().mode, ViewMode::Albedo);
    assert_eq!(differing(&pictures[2].1, &window.picture()), 0);
}

/// The bytes of the window right of the picture's middle, where the legend is.
fn legend(window: &mut Window) -> Vec<u8> {
    window.settle();
    let area = window.area();
    let part = Rect::from_min_size(pos2(area.right() - 92.0, area.top() + 48.0), vec2(82.0, 300.0));
    let image = window.render().unwrap();
    let [x, y] = [part.left() as u32, part.top() as u32];
    image::imageops::crop_imm(&image, x, y, 82, 300).to_image().into_raw()
}

#[test]
fn the_legend_of_false_colours_has_three_units() {
    let Some(mut window) = Window::solved_room() else { return };
    window.choose("View mode", "False colour");
    window.tab("Display");
    let picture = window.picture();
    let mut legends = vec![legend(&mut window)];
    for unit in [Unit::Lux, Unit::Stops] {
        window.choose("Unit", unit.symbol());
        assert_eq!(window.state().view().unit, unit);
        assert_eq!(window.has(Role::SpinButton, "Efficacy"), unit == Unit::Lux);
        legends.push(legend(&mut window));
    }
    assert!(legends[0] != legends[1] && legends[1] != legends[2]);
    assert_eq!(differing(&picture, &window.picture()), 0, "a unit changes no colour");
    window.check("Logarithmic");
    assert!(differing(&picture, &window.picture()) > 50);
}

#[test]
fn the_range_of_false_colours_is_automatic_until_it_is_set() {
    let Some(mut window) = Window::solved_room() else { return };
    window.choose("View mode", "False colour");
    window.tab("Display");
    let before = window.picture();
    let [lo, hi] = window.state().stage.as_ref().unwrap().range().unwrap();
    window.check("Automatic range");
    assert_eq!(differing(&before, &window.picture()), 0, "it begins where the automatic one was");
    window.find(Role::SpinButton, "Brightest").set_value_accesskit(f64::from(2.0 * hi));
    window.run_steps(2);
    assert_eq!(window.state().stage.as_ref().unwrap().range(), Some([lo, 2.0 * hi]));
    assert!(differing(&before, &window.picture()) > 50);
}

#[test]
fn the_exposure_slider_takes_over_from_automatic_exposure() {
    let Some(mut window) = Window::solved_room() else { return };
    window.tab("Display");
    window.settle();
    let metered = window.state().stage.as_ref().unwrap().stops(window.state().view());
    assert!(metered != 0.0 && window.reads(&format!("{metered:+.1} EV auto")));
    let before = window.picture();
    window.nudge("Exposure", Key::ArrowRight, 6);
    let view = window.state().view();
    assert!(!view.auto_exposure && view.stops > metered + 0.1, "{}", view.stops);
    assert!(differing(&before, &window.picture()) > 50);
    window.check("Automatic exposure");
    assert_eq!(differing(&before, &window.picture()), 0);
}

#[test]
fn automatic_exposure_follows_what_is_shown() {
    let Some(mut window) = Window::solved_room() else { return };
    let metered = |window: &mut Window| {
        window.settle();
        window.state().stage.as_ref().unwrap().stops(window.state().view())
    };
    let all = metered(&mut window);
    window.click("2");
    assert!(metered(&mut window) > all + 1.0, "the second bounce alone is darker");
}

#[test]
fn every_tone_mapper_draws_another_picture() {
    let Some(mut window) = Window::solved_room() else { return };
    window.tab("Display");
    let mut pictures: Vec<Picture> = Vec::new();
    for name in ["None", "Reinhard", "ACES-like", "AgX-like"] {
        window.choose("Tone mapper", name);
        assert_eq!(window.has(Role::Slider, "White"), name == "Reinhard");
        let picture = window.picture();
        assert!(pictures.iter().all(|other| differing(other, &picture) > 50), "{name}");
        pictures.push(picture);
    }
    window.choose("Tone mapper", "Reinhard");
    window.nudge("White", Key::ArrowLeft, 10);
    assert!(differing(&pictures[1], &window.picture()) > 20);
}

#[test]
fn x_and_the_check_box_show_edges() {
    let Some(mut window) = Window::solved_room() else { return };
    if !window.state().stage.as_ref().unwrap().gpu().draws_wireframes() {
        println!("skipped: the adapter draws no lines for triangles");
        return;
    }
    let before = window.picture();
    window.press(Key::X);
    let edges = window.picture();
    assert!(differing(&before, &edges) > 20);
    window.tab("Display");
    window.check("Wireframe");
    assert_eq!(differing(&before, &window.picture()), 0);
}

#[test]
fn smooth_edges_can_be_switched_off() {
    let Some(mut window) = Window::solved_room() else { return };
    let before = window.picture();
    window.tab("Display");
    window.check("Antialiasing");
    let n = before.pixels().iter().zip(window.picture().pixels()).filter(|(a, b)| a != b).count();
    assert!(n > 100, "{n}");
}
