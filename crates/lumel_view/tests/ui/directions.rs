//! Light by direction: normal maps, ripples, and what is known of it.

use crate::expected::differing;
use crate::harness::{Window, folder};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use lumel::{BounceLimit, Directional, Moment, Shading};
use lumel_render_cpu::Picture;
use lumel_view::app::App;
use lumel_view::document::OpenRequest;
use lumel_view::layout::LumelCount;
use lumel_view::prefs::ViewMode;
use lumel_view::selection::Selection;
use lumel_view::stage::Side;

/// The room, solved by direction.
fn room(kind: &str) -> Option<Window> {
    let mut window = Window::room()?;
    window.choose("Directional", kind);
    window.solve();
    Some(window)
}

/// The Cornell box with walls of leather, whose normal map is lit.
fn leather() -> Option<Window> {
    let open = Some(OpenRequest::new("cornell-leather"));
    let mut window = Window::start(folder(), |setup| setup.start.open = open)?;
    let settings = &mut window.session().settings;
    (settings.direct_samples, settings.indirect_samples) = (8, 16);
    (settings.bounces, settings.directional) = (BounceLimit::Count(1), Directional::Sh2);
    window.solve();
    window.tab("Display");
    Some(window)
}

fn is_on(app: &App) -> bool {
    app.view().relief.on
}

/// The part of a picture left or right of its middle.
fn half(picture: &Picture, right: bool) -> Vec<[u8; 3]> {
    let (width, middle) = (picture.width() as usize, picture.width() as usize / 2);
    let columns = if right { middle + 8..width } else { 0..middle - 8 };
    picture.pixels().chunks(width).flat_map(|row| row[columns.clone()].to_vec()).collect()
}

#[test]
fn without_directions_nothing_asks_for_them_but_tells_what_to_do() {
    let Some(mut window) = Window::solved_room() else { return };
    let flat = window.picture();
    window.tab("Display");
    assert!(window.reads("Where light comes from is not known"), "{}", window.texts());
    assert!(!window.has(Role::ComboBox, "Shading") && !window.has(Role::CheckBox, "Normal maps"));
    for modifiers in [Modifiers::NONE, Modifiers::SHIFT] {
        window.dismiss_messages();
        window.press_with(modifiers, Key::Z);
        assert!(window.told("Choose L1 or L2"));
    }
    assert!(is_on(window.state()) && !window.state().comparison.on);
    window.tab("Scene");
    assert!(!window.has(Role::CheckBox, "Ripple of white"));
    window.session().set_ripple("white", true);
    assert_eq!(differing(&flat, &window.picture()), 0);
    let offered =
        |app: &App| ViewMode::offered(app.session.known()).any(|m| matches!(m, ViewMode::Moment(_)));
    assert!(!offered(window.state()));
    // Directions are measured for the bounces that there are.
    window.tab("Solve");
    window.choose("Directional", "L1");
    assert_eq!(window.session().settings.directional, Directional::Sh1);
    let bounces = window.session().light.bounces.clone();
    window.solve();
    assert_eq!(window.session().directional(), Directional::Sh1);
    assert!(window.session().light.bounces == bounces && offered(window.state()));
}

#[test]
fn normal_maps_are_lit_by_key_and_box_in_every_shading() {
    let Some(mut window) = leather() else { return };
    let bumpy = window.picture();
    window.press(Key::Z);
    assert!(!is_on(window.state()) && !window.has(Role::ComboBox, "Shading"));
    let smooth = window.picture();
    assert!(differing(&bumpy, &smooth) > 30, "{}", differing(&bumpy, &smooth));
    window.check("Normal maps");
    assert!(is_on(window.state()));
    assert_eq!(differing(&bumpy, &window.picture()), 0);
    window.check("Green points down");
    assert!(differing(&bumpy, &window.picture()) > 30);
    window.check("Green points down");
    let mut pictures = vec![bumpy];
    for (name, shading) in [
        ("Linear L1 (error 11 %)", Shading::Linear),
        ("ZH3 (6 %)", Shading::Zh3),
        ("L2 (3 %)", Shading::Quadratic),
    ] {
        window.choose("Shading", name);
        assert_eq!(window.state().view().relief.shading(), shading);
        let picture = window.picture();
        assert!(pictures.iter().all(|other| differing(other, &picture) > 10), "{name}");
        pictures.push(picture);
    }
    window.check_accessibility();
    // What is not known by direction is shown on smooth surfaces.
    window.press(Key::G);
    let direct = window.picture();
    window.press(Key::Z);
    assert_eq!(differing(&direct, &window.picture()), 0);
}

#[test]
fn the_picture_is_split_into_with_and_without_normal_maps() {
    let Some(mut window) = leather() else { return };
    let bumpy = window.picture();
    window.press(Key::Z);
    let smooth = window.picture();
    window.press_with(Modifiers::SHIFT, Key::Z);
    assert!(is_on(window.state()) && window.state().comparison.is_smooth());
    let both = window.picture();
    assert!(half(&both, false) == half(&bumpy, false) && half(&both, true) == half(&smooth, true));
    assert_ne!(half(&bumpy, true), half(&smooth, true));
    window.choose("View mode", "Normals");
    let normals = window.picture();
    window.press_with(Modifiers::SHIFT, Key::Z);
    assert!(!window.state().comparison.on);
    assert_ne!(half(&window.picture(), true), half(&normals, true));
    window.tab("Compare");
    window.choose("Light", "Without normal maps");
    window.check("Split view");
    assert_eq!(window.state().comparison.right, Side::Smooth);
    assert!(!window.has(Role::ComboBox, "Right shows"));
    window.check_accessibility();
}

#[test]
fn a_ripple_runs_over_the_materials_that_have_one() {
    let Some(mut window) = room("L1") else { return };
    let still = window.picture();
    let drawn = |window: &Window| window.state().stage.as_ref().unwrap().pictures;
    let before = drawn(&window);
    window.run_steps(5);
    assert_eq!(drawn(&window), before, "nothing moves");
    window.tab("Scene");
    window.check("Ripple of white");
    let waves = window.picture();
    if window.state().stage.as_ref().unwrap().gpu().is_software() {
        let pixels = |picture: &Picture| picture.width() * picture.height();
        assert!(pixels(&waves) <= 150_000 && pixels(&waves) < pixels(&still), "it draws fewer");
    } else {
        assert!(differing(&still, &waves) > 100);
    }
    let before = drawn(&window);
    window.run_steps(5);
    assert_eq!(drawn(&window), before + 5);
    assert!(differing(&waves, &window.picture()) > 100, "they run");
    window.tab("Display");
    window.state_mut().prefs.view.relief.speed = 0.0;
    let stopped = window.picture();
    assert_eq!(differing(&stopped, &window.picture()), 0);
    window.nudge("Steepness", Key::ArrowLeft, 10);
    let flatter = window.picture();
    window.nudge("Wave length", Key::ArrowRight, 10);
    assert!(differing(&stopped, &flatter) > 50 && differing(&flatter, &window.picture()) > 50);
    window.check("Normal maps");
    assert_eq!(differing(&still, &window.picture()), 0, "flat without");
    window.check("Normal maps");
    // Other materials have none.
    window.tab("Scene");
    window.check("Ripple of red");
    assert_eq!(window.session().rippled_materials().len(), 2);
    window.check("Ripple of red");
    window.check("Ripple of white");
    assert!(window.session().rippled.is_empty() && differing(&still, &window.picture()) == 0);
}

#[test]
fn waves_keep_running_while_a_solve_runs() {
    let Some(mut window) = room("L1") else { return };
    window.session().set_ripple("white", true);
    let known = window.session().light.directional.clone().unwrap();
    window.solve_for_long();
    assert!(window.session().light.directional.is_none(), "it is not measured yet");
    assert_eq!(window.session().light.directional_before.as_ref(), Some(&known));
    assert_eq!(window.session().directional(), Directional::Sh1);
    let first = window.picture();
    window.run_steps(5);
    assert!(differing(&first, &window.picture()) > 100);
    window.press(Key::Escape);
    window.wait_until("the end", |app| app.session.phase().is_none());
    window.run_steps(2);
    assert_eq!(window.session().directional(), Directional::Off, "that of other light is not kept");
}

#[test]
fn the_direction_and_every_coefficient_are_shown() {
    let Some(mut window) = room("L2") else { return };
    let mut pictures: Vec<Picture> = Vec::new();
    for mode in Moment::ALL.map(ViewMode::Moment) {
        match mode {
            // Those are at the end of the list.
            ViewMode::Moment(Moment::Direction | Moment::Sh0) => window.choose("View mode", mode.name()),
            mode => window.state_mut().prefs.view.mode = mode,
        }
        assert_eq!(window.state().view().mode, mode);
        let picture = window.picture();
        assert!(pictures.iter().all(|other| differing(other, &picture) > 50), "{mode:?}");
        pictures.push(picture);
        let range = window.state().stage.as_ref().unwrap().range();
        match range {
            Some([low, high]) => assert!(mode.has_legend() && low == -high, "{mode:?}"),
            None => assert_eq!(mode, ViewMode::Moment(Moment::Direction)),
        }
    }
    window.state_mut().prefs.view.selection = Selection::DIRECT;
    assert!(differing(pictures.last().unwrap(), &window.picture()) > 50, "of direct light it is not known");
    window.state_mut().prefs.view.selection = Selection::All;
    // Four coefficients are no nine.
    window.tab("Solve");
    window.choose("Directional", "L1");
    window.solve();
    window.tab("Display");
    assert!(window.reads("Where light comes from is not known"));
    let offered = ViewMode::offered(window.session().known()).filter(|m| matches!(m, ViewMode::Moment(_)));
    assert_eq!(offered.count(), 5);
}

#[test]
fn lumels_are_lit_by_directions_of_their_own() {
    let Some(mut window) = Window::room() else { return };
    window.choose("Basis", "Lightmap");
    window.session().lumels.count = LumelCount::Budget(3000);
    window.wait_until("the unwrap", |app| app.session.layout().is_some());
    window.choose("Directional", "L1");
    window.solve();
    window.wait_until("the lightmap", |app| app.session.has_whole_lightmap());
    window.run_steps(2);
    assert_eq!(window.session().lumel_light().unwrap().directional(), Directional::Sh1);
    let bytes = |window: &Window| window.state().stage.as_ref().unwrap().bytes_of_directions();
    window.picture();
    assert_eq!(bytes(&window), None, "nothing is tilted");
    window.state_mut().prefs.view.relief.speed = 0.0;
    window.session().set_ripple("white", true);
    window.tab("Display");
    let of_lumels = window.picture();
    assert!(bytes(&window).is_some_and(|bytes| bytes >= 48 * 2000), "{:?}", bytes(&window));
    assert!(window.reads("by lumel"), "{}", window.texts());
    for mode in ["Light direction", "sh1"] {
        window.choose("View mode", mode);
        let by_lumel = window.picture();
        window.session().lumels.basis = lumel_view::layout::LightBasis::Vertices;
        window.run_steps(2);
        assert!(differing(&by_lumel, &window.picture()) > 50, "{mode}");
        window.session().lumels.basis = lumel_view::layout::LightBasis::Lightmap;
        window.wait_until("the lightmap", |app| app.session.has_whole_lightmap());
    }
    window.choose("View mode", "Final colour");
    assert_eq!(differing(&of_lumels, &window.picture()), 0);
}

#[test]
fn a_solution_that_is_opened_lights_normal_maps() {
    let Some(mut window) = room("L1") else { return };
    window.state_mut().prefs.view.relief.speed = 0.0;
    window.session().set_ripple("white", true);
    let solved = window.picture();
    let file = window.file("room.npz");
    for key in [Key::K, Key::L] {
        window.press(key);
        window.answer(&file);
        window.wait_for_files();
    }
    assert!(window.session().job().is_none() && window.session().directional() == Directional::Sh1);
    assert_eq!(differing(&solved, &window.picture()), 0);
}
