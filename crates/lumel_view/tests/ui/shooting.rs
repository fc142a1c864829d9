//! The brightest first: its switch, what it shows, and what is only had without it.

use crate::expected::{bits, differing, reference};
use crate::hands::CTRL;
use crate::harness::Window;
use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable, by};
use glam::Vec3;
use lumel::{BounceLimit, Layers, ScheduleKind, SolverKind};
use lumel_view::prefs::{PlotKind, ViewMode};
use lumel_view::selection::Selection;
use lumel_view::solver::Phase;

const NO_BOUNCES: &str = "Shots tell no bounces apart";

/// The room, to be shot.
fn shooting_room() -> Option<Window> {
    let mut window = Window::room()?;
    window.choose("Order", "Shoot");
    Some(window)
}

/// Starts to shoot, with shadow rays for each shot, and waits until some have arrived.
fn shoot_for_long(window: &mut Window, shots: u32) {
    let settings = &mut window.session().settings;
    (settings.solver, settings.indirect_samples) = (SolverKind::Neumann, 512);
    (settings.schedule, settings.bounces) = (ScheduleKind::Shoot, BounceLimit::All);
    window.press(Key::Enter);
    window.wait_until("some shots", |app| {
        matches!(app.session.phase(), Some(Phase::Shot(shot)) if shot >= shots)
            && app.session.light.tail.is_some()
    });
}

/// Starts a solve by gathering whose bounces take long, and stops it after direct light.
fn stop_after_direct_light(window: &mut Window) {
    window.solve_for_long();
    window.press(Key::Escape);
    window.wait_until("the end", |app| app.session.phase().is_none());
    window.run_steps(2);
}

#[test]
fn the_order_is_chosen_from_a_list_and_takes_the_number_of_bounces_with_it() {
    let Some(mut window) = Window::room() else { return };
    assert!(window.has(Role::Slider, "Bounces") && !window.reads(NO_BOUNCES));
    window.choose("Order", "Shoot");
    let settings = window.session().settings.clone();
    assert_eq!((settings.schedule, settings.bounces), (ScheduleKind::Shoot, BounceLimit::All));
    assert!(window.reads(NO_BOUNCES) && window.has(Role::SpinButton, "Remainder"));
    assert!(!window.has(Role::Slider, "Bounces"));
    assert!(window.find(Role::CheckBox, "Until converged").accesskit_node().is_disabled());
    // Presets have a number of bounces, which does not stand in the way.
    window.click("Draft");
    let settings = window.session().settings.clone();
    assert_eq!((settings.schedule, settings.bounces), (ScheduleKind::Shoot, BounceLimit::All));
    settings.validate().unwrap();
    window.check_accessibility();
    window.choose("Order", "Gather");
    assert!(!window.reads(NO_BOUNCES));
    assert!(!window.find(Role::CheckBox, "Until converged").accesskit_node().is_disabled());
}

#[test]
fn shots_have_the_bits_of_a_bake_and_end_at_the_remainder() {
    let Some(mut window) = shooting_room() else { return };
    window.find(Role::SpinButton, "Remainder").set_value_accesskit(5.0);
    window.run_steps(2);
    window.solve();
    assert!(bits(window.state()) == reference(window.state()), "other bits than those of a bake");
    let few = window.session().computed().unwrap().shots().unwrap();
    assert!(few > 2 && window.told(&format!("Solved: direct light and {few} shots")));
    assert!(window.reads(&format!("{few} shots in ")), "{}", window.texts());
    window.find(Role::SpinButton, "Remainder").set_value_accesskit(0.5);
    window.run_steps(2);
    // What is there goes on.
    window.solve();
    let more = window.session().computed().unwrap().shots().unwrap();
    assert!(more > few, "{few}, {more}");
    assert!(bits(window.state()) == reference(window.state()));
}

#[test]
fn single_bounces_are_greyed_where_shots_tell_none() {
    let Some(mut window) = shooting_room() else { return };
    window.solve();
    let bounce = |window: &Window| {
        let found = window.query_all(by().role(Role::Button).label("Bounce")).next();
        found.map(|node| node.accesskit_node().is_disabled())
    };
    assert_eq!(bounce(&window), Some(true));
    for (tab, text) in [("Convergence", NO_BOUNCES), ("Bounces", NO_BOUNCES)] {
        window.tab(tab);
        window.run_steps(2);
        assert!(window.reads(text), "{tab}");
    }
    window.choose("Order", "Gather");
    window.solve();
    assert_eq!(bounce(&window), None);
}

#[test]
fn a_solve_that_was_stopped_between_shots_goes_on_with_the_same_bits() {
    let Some(mut window) = Window::room() else { return };
    shoot_for_long(&mut window, 2);
    assert!(window.reads(" missing"), "{}", window.texts());
    window.press(Key::Escape);
    window.wait_until("the end", |app| app.session.phase().is_none());
    window.run_steps(2);
    assert!(window.told("resume after the last finished shot"));
    let done = window.session().computed().unwrap().shots().unwrap();
    let moments = window.session().courses.last.moments.clone();
    assert!(done >= 2 && moments.len() == done as usize + 1, "{done}, {}", moments.len());
    // Fewer than a hundredth would take minutes.
    window.session().settings.remainder = 0.2;
    window.solve();
    assert!(window.session().computed().unwrap().shots().unwrap() >= done);
    assert!(bits(window.state()) == reference(window.state()));
    let course = &window.session().courses.last.moments;
    assert!(course.starts_with(&moments), "the curve goes on");
    assert!(course.windows(2).all(|pair| pair[0].seconds <= pair[1].seconds));
}

#[test]
fn shots_that_were_closed_are_restored_and_end_with_the_same_bits() {
    let Some(mut window) = Window::room() else { return };
    window.session().settings.remainder = 0.2;
    shoot_for_long(&mut window, 2);
    let folder = window.closed();
    let Some(mut window) = Window::keeping(folder, |_| {}) else { return };
    assert!(window.reads(" shots"), "{}", window.texts());
    window.click("Restore");
    window.wait_until("what was shot", |app| app.session.light.tail.is_some());
    window.wait_until("the solve", |app| app.session.computed().is_some_and(|c| c.complete));
    assert!(bits(window.state()) == reference(window.state()));
}

#[test]
fn lights_that_move_are_followed_by_shots_and_moved_back_by_undo() {
    let Some(mut window) = shooting_room() else { return };
    window.session().settings.layers = Layers::Lights;
    window.solve();
    window.session().live = true;
    window.run_steps(2);
    let before = bits(window.state());
    let at_rest = |window: &mut Window, old: &Vec<Vec<[u32; 3]>>| {
        window.wait_until("the light to follow", |app| {
            let session = &app.session;
            bits(app) != *old && !session.is_following() && !session.is_light_in_motion()
        });
        assert!(bits(window.state()) == reference(window.state()));
    };
    window.session().lights[0].rect.center += Vec3::new(0.2, 0.0, 0.1);
    at_rest(&mut window, &before);
    let moved = bits(window.state());
    assert!(window.session().computed().unwrap().shots().is_some());
    window.press_with(CTRL, Key::Z);
    at_rest(&mut window, &moved);
    assert!(bits(window.state()) == before);
}

#[test]
fn unshot_power_is_shown_in_colours_and_falls() {
    let Some(mut window) = Window::room() else { return };
    window.tab("Display");
    window.choose("Surfaces show", "Unshot power");
    assert!(window.reads("Not known yet"));
    let plain = window.picture();
    stop_after_direct_light(&mut window);
    assert!(!window.reads("Not known yet"));
    assert!(differing(&plain, &window.picture()) > 100);
    let range = window.state().stage.as_ref().unwrap().range().unwrap();
    assert!(range[1] > range[0] && range[1] > 0.0, "{range:?}");
    // All direct light is unshot: nobody has reflected any of it.
    let power = |window: &mut Window| {
        window
            .session()
            .unshot()
            .unwrap()
            .radiosity
            .iter()
            .map(|radiosity| f64::from(radiosity.x))
            .sum::<f64>()
    };
    let direct = power(&mut window);
    let scene = window.session().document.as_ref().unwrap().scene.clone();
    let light = window.session().selected_light(Selection::DIRECT);
    let sent = |v: usize| lumel_scene::luminance(light[v]);
    assert!(direct > 0.0 && direct < (0..scene.vertex_count()).map(|v| f64::from(sent(v))).sum());
    let settings = &mut window.session().settings;
    (settings.solver, settings.indirect_samples) = (SolverKind::Cached, 8);
    (settings.schedule, settings.bounces) = (ScheduleKind::Shoot, BounceLimit::All);
    window.solve();
    assert!(power(&mut window) < 0.1 * direct);
    window.press(Key::F6);
    assert_eq!(window.state().prefs.view.mode, ViewMode::Final);
}

#[test]
fn the_brightest_shooters_are_marked() {
    let Some(mut window) = Window::room() else { return };
    stop_after_direct_light(&mut window);
    let plain = window.picture();
    window.tab("Display");
    window.check("Brightest shooters");
    let marked = window.picture();
    assert!(marked != plain && differing(&plain, &marked) < 100);
    let brightest = window.session().unshot().unwrap().brightest.clone();
    // They lie where the lamp below the ceiling shines: on the floor and high on the walls.
    assert!((1..200).contains(&brightest.len()), "{}", brightest.len());
    window.press(Key::F7);
    assert!(window.picture() == plain);
}

#[test]
fn the_ambient_term_is_seen_until_a_solve_is_finished_and_never_saved() {
    let Some(mut window) = Window::room() else { return };
    stop_after_direct_light(&mut window);
    assert!(window.session().to_come().unwrap().ambient.min_element() > 0.0);
    window.state_mut().prefs.view.auto_exposure = false;
    let with = window.picture();
    let saved = |window: &mut Window| window.session().solution().unwrap().irradiance;
    let (light, file) = (window.session().selected_light(Selection::All), saved(&mut window));
    let direct = window.session().selected_light(Selection::DIRECT);
    assert!(light.iter().zip(&direct).all(|(all, direct)| *all == direct.max(Vec3::ZERO)));
    window.tab("Display");
    window.check("Ambient term");
    let without = window.picture();
    assert!(differing(&with, &without) > 300);
    let mean = |picture: &lumel_render_cpu::Picture| -> f64 {
        picture.pixels().iter().map(|p| f64::from(p.iter().take(3).map(|&c| u32::from(c)).sum::<u32>())).sum()
    };
    assert!(mean(&with) > mean(&without));
    assert!(file == saved(&mut window) && file == light);
    window.press(Key::F8);
    assert!(window.picture() == with);
    // Direct light alone, and colours with a legend, have what was computed.
    window.press(Key::G);
    let direct = window.picture();
    window.press(Key::F8);
    assert!(window.picture() == direct);
    window.press(Key::F8);
    let settings = &mut window.session().settings;
    (settings.solver, settings.indirect_samples) = (SolverKind::Cached, 8);
    window.press(Key::B);
    window.solve();
    assert!(window.session().to_come().is_none());
    let finished = window.picture();
    window.press(Key::F8);
    assert!(window.picture() == finished);
}

#[test]
fn both_orders_are_compared_in_one_plot_against_time() {
    let Some(mut window) = Window::room() else { return };
    window.tab("Convergence");
    window.click("Time");
    assert_eq!(window.state().prefs.view.plot, PlotKind::Time);
    assert!(window.reads("solve by Gather and by Shoot to compare them"));
    window.session().settings.bounces = BounceLimit::All;
    window.solve();
    window.settle();
    let gathered = window.render().unwrap();
    let first = window.session().courses.last.clone();
    assert_eq!((first.name.as_str(), first.moments.len()), ("Gather", window.session().light.bounces.len()));
    window.choose("Order", "Shoot");
    window.solve();
    window.settle();
    assert!(gathered != window.render().unwrap());
    let courses = window.session().courses.clone();
    assert_eq!((courses.last.name.as_str(), &courses.before), ("Shoot, rays stored", &first));
    let ends = [&courses.last, &courses.before].map(|course| *course.moments.last().unwrap());
    assert!(ends.iter().all(|end| end.missing < 0.02 && end.unshot < 0.05 && end.seconds > 0.0), "{ends:?}");
    let unshot: Vec<f64> = courses.last.moments.iter().map(|moment| moment.unshot).collect();
    assert!(unshot.windows(2).all(|pair| pair[1] < pair[0]), "{unshot:?}");
}
