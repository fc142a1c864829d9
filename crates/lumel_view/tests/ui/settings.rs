//! Settings of the solve, and the slots that keep them.

use crate::expected::{bits, reference};
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use lumel::{BounceLimit, EmitterSampling, LightSampling, Projection, SamplerKind};

#[test]
fn samples_and_bounces_are_set_by_sliders() {
    let Some(mut window) = Window::room() else { return };
    window.nudge("Direct samples", Key::ArrowRight, 8);
    window.nudge("Indirect samples", Key::ArrowRight, 8);
    window.nudge("Bounces", Key::ArrowRight, 3);
    let settings = window.session().settings.clone();
    assert!(settings.direct_samples > 4 && settings.indirect_samples > 8, "{settings:?}");
    assert_eq!(settings.bounces, BounceLimit::Count(5));
    window.nudge("Direct samples", Key::ArrowLeft, 30);
    assert!(window.session().settings.direct_samples < 4);
    window.nudge("Bounces", Key::ArrowLeft, 9);
    assert_eq!(window.session().settings.bounces, BounceLimit::Count(0));
}

#[test]
fn presets_set_rays_and_bounces_and_leave_the_rest() {
    let Some(mut window) = Window::room() else { return };
    window.session().settings.seed = 5;
    window.click("Production");
    let settings = window.session().settings.clone();
    assert_eq!((settings.direct_samples, settings.indirect_samples), (256, 1024));
    assert_eq!((settings.bounces, settings.seed), (BounceLimit::All, 5));
    window.click("Draft");
    assert_eq!(window.session().settings.indirect_samples, 64);
}

#[test]
fn the_sampler_is_chosen_from_a_list_or_by_f2() {
    let Some(mut window) = Window::room() else { return };
    for (name, kind) in [
        ("Halton", SamplerKind::Halton),
        ("Stratified", SamplerKind::Stratified),
        ("Random", SamplerKind::Random),
        ("Sobol (Owen)", SamplerKind::Sobol),
    ] {
        window.choose("Sampler", name);
        assert_eq!(window.session().settings.sampler, kind);
    }
    window.press(Key::F2);
    assert_eq!(window.session().settings.sampler, SamplerKind::Random);
    assert!(window.told("Sampler: random"));
    window.press(Key::F2);
    assert_eq!(window.session().settings.sampler, SamplerKind::Sobol);
}

#[test]
fn seed_projection_and_estimators_are_under_more() {
    let Some(mut window) = Window::solved_room() else { return };
    let before = bits(window.state());
    window.find(Role::DisclosureTriangle, "More").scroll_to_me();
    window.run_steps(4);
    window.find(Role::DisclosureTriangle, "More").click();
    window.run_steps(10);
    window.find(Role::SpinButton, "Seed").set_value_accesskit(7.0);
    window.run_steps(2);
    assert_eq!(window.session().settings.seed, 7);
    window.solve();
    assert!(bits(window.state()) != before, "another seed, other noise");
    window.choose("Projection", "Over areas");
    window.choose("Light sampling", "Area");
    window.choose("Emissive", "Off");
    let settings = window.session().settings.clone();
    assert_eq!(settings.projection, Projection::Area);
    assert_eq!((settings.light_sampling, settings.emitters), (LightSampling::Area, EmitterSampling::Off));
}

#[test]
fn means_over_areas_are_read_by_least_squares_without_a_solve() {
    let Some(mut window) = Window::room() else { return };
    window.session().settings.projection = Projection::Area;
    window.solve();
    let (means, seconds) = (bits(window.state()), window.session().computed().unwrap().seconds);
    let label = |window: &mut Window| {
        let session = window.session();
        session.computed().unwrap().label(&session.light)
    };
    let label_of_means = label(&mut window);
    window.find(Role::DisclosureTriangle, "More").scroll_to_me();
    window.run_steps(4);
    window.find(Role::DisclosureTriangle, "More").click();
    window.run_steps(10);
    window.choose("Projection", "Least squares");
    window.wait_until("the light to be read again", |app| bits(app) != means);
    window.run_steps(2);
    assert!(!window.session().is_solving() && window.session().out_of_date().is_none());
    let computed = window.session().computed().unwrap().clone();
    assert!(computed.complete && computed.seconds == seconds && !computed.saved);
    assert_eq!(computed.settings().unwrap().projection, Projection::LeastSquares);
    assert!(bits(window.state()) == reference(window.state()), "other bits than those of a solve");
    assert_ne!(label(&mut window), label_of_means);
    window.press(Key::Enter);
    assert!(window.told("Already solved"));
    window.session().settings.projection = Projection::Area;
    window.wait_until("the means", |app| bits(app) == means);
}

/// Changes camera, light and settings.
fn change_all(window: &mut Window) {
    window.hold(Modifiers::NONE, Key::W, 4);
    window.press(Key::Space);
    window.press(Key::F2);
}

#[test]
fn alt_and_a_digit_keep_camera_lights_and_settings_and_the_digit_recalls_them() {
    let Some(mut window) = Window::room() else { return };
    let state = |window: &mut Window| {
        let s = window.session();
        (s.camera, s.lights.clone(), s.settings.clone())
    };
    for digit in [Key::Num3, Key::Num0] {
        let kept = state(&mut window);
        window.press_with(Modifiers::ALT, digit);
        change_all(&mut window);
        let changed = state(&mut window);
        assert!(changed.0 != kept.0 && changed.1 != kept.1 && changed.2 != kept.2);
        window.press(digit);
        assert_eq!(state(&mut window), kept);
        change_all(&mut window);
    }
    assert_eq!(window.session().slots.digits().collect::<Vec<_>>(), [0, 3]);
    window.press(Key::Num7);
    assert!(window.told("Slot 7 is empty: save to it with Alt+7"));
}

#[test]
fn slots_have_buttons_and_menu_items() {
    let Some(mut window) = Window::room() else { return };
    window.tab("Camera");
    let home = window.session().camera;
    window.click("Slot 5");
    assert!(window.session().slots.get(5).is_some());
    change_all(&mut window);
    let changed = window.session().camera;
    window.click("Slot 5");
    assert_eq!(window.session().camera, home);
    change_all(&mut window);
    window.event(eframe::egui::Event::ModifiersChanged(Modifiers::ALT));
    window.click("Slot 5");
    window.event(eframe::egui::Event::ModifiersChanged(Modifiers::NONE));
    assert_eq!(window.session().slots.get(5).unwrap().camera, changed, "Alt replaces it");
    window.session().reset_camera();
    window.menu("Camera", "Recall slot 5");
    assert_eq!(window.session().camera, changed);
}
