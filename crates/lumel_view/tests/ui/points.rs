//! Light on scattered points.

use crate::expected::differing;
use crate::harness::{Window, folder};
use crate::scenes::write_mesh;
use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use glam::Vec3;
use lumel::{
    Adaptive, Baker, Control, Directional, PointSpacing, Silent, Solution, SolutionSelection, SolveState,
};
use lumel_render_cpu::{Display, Exposure, Picture, Resolution, Show, View, draw};
use lumel_view::app::App;
use lumel_view::document::OpenRequest;
use lumel_view::point_light::Direct;
use lumel_view::prefs::NodeColors;
use lumel_view::selection::Selection;
use lumel_view::session::LightUse;
use std::sync::atomic::AtomicBool;

impl Window {
    /// With the room, solved on points of two levels.
    fn room_with_points() -> Option<Self> {
        let mut window = Self::room()?;
        window.choose("Basis", "Points");
        let settings = &mut window.session().settings;
        (settings.point_spacing, settings.levels) = (PointSpacing::Points(600), 2);
        window.solve();
        Some(window)
    }
}

/// What the library computes in one go.
fn reference(app: &App) -> Solution {
    let scene = app.session.document.as_ref().unwrap().relit(&app.session.lights).unwrap();
    let baker = Baker::new(scene, app.session.settings.clone());
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    baker.solution(&state)
}

/// What the CPU draws of a solution from where the window looks.
fn traced(app: &App, solution: &Solution, selection: &SolutionSelection, size: [u32; 2]) -> Picture {
    let (session, stops) = (&app.session, app.stage.as_ref().unwrap().stops(app.view()));
    let scene = session.document.as_ref().unwrap().relit(&session.lights).unwrap();
    let scattered = solution.scattered_light(&scene, selection).unwrap().unwrap();
    let (tracer, lighting) = (lumel::tracer_of(&scene), scattered.lighting(&scene).unwrap());
    let view = View::new(&scene, &*tracer, &lighting);
    let display = Display {
        exposure: Exposure::Stops(stops),
        tone: app.view().tone(),
        white: app.view().white,
        ..Display::of(Show::Radiance)
    };
    let resolution = Resolution { width: size[0], height: size[1], samples_per_pixel: 1 };
    draw(&view, &session.camera.camera(), &resolution, &display, &AtomicBool::new(false)).unwrap()
}

/// How many of a thousand pixels differ by more than two steps.
fn far(a: &Picture, b: &Picture) -> usize {
    let is_far = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|c| a[c].abs_diff(b[c]) > 2);
    1000 * a.pixels().iter().zip(b.pixels()).filter(is_far).count() / a.pixels().len()
}

#[test]
fn what_points_carry_is_that_of_the_library_and_drawn_as_on_the_cpu() {
    let Some(mut window) = Window::room_with_points() else { return };
    let solution = reference(window.state());
    let light = &window.state().session.light;
    let points = light.points.as_ref().unwrap();
    assert_eq!(points.direct, Direct::AtVertices);
    let known = solution.points.as_ref().unwrap();
    assert!(points.bounces.iter().map(|b| &**b).eq(&known.bounces), "bit by bit");
    assert_eq!(*light.bounces[0], solution.bounces[0], "direct light was measured at the vertices");
    window.state_mut().prefs.view.antialias = false;
    for selection in [Selection::All, Selection::bounce(1), Selection::DIRECT] {
        window.state_mut().prefs.view.selection = selection;
        let device = window.picture();
        let part = match selection {
            Selection::All => SolutionSelection::Sum,
            Selection::DIRECT => SolutionSelection::Bounce(0),
            _ => SolutionSelection::Bounce(1),
        };
        let cpu = traced(window.state(), &solution, &part, [device.width(), device.height()]);
        assert!(far(&device, &cpu) < 10, "{selection}: {} of a thousand pixels", far(&device, &cpu));
    }
}

#[test]
fn points_come_and_go_by_the_basis_with_what_does_not_go_with_them() {
    let Some(mut window) = Window::room() else { return };
    window.solve();
    let at_vertices = window.picture();
    let settings = &mut window.session().settings;
    settings.directional = Directional::Sh1;
    window.choose("Basis", "Points");
    window.run_steps(2);
    let settings = &window.session().settings;
    assert!(matches!(settings.point_spacing, PointSpacing::Points(_)));
    assert_eq!((settings.directional, settings.adaptive), (Directional::Off, Adaptive::Off));
    window.nudge("Levels", Key::ArrowRight, 1);
    window.choose("Points by", "Spacing");
    let settings = &mut window.session().settings;
    assert!(settings.levels == 2 && matches!(settings.point_spacing, PointSpacing::Metres(_)));
    settings.point_spacing = PointSpacing::Metres(0.2);
    window.solve();
    assert!(window.reads("0.200 m apart") && window.reads("on 2 levels"), "{}", window.texts());
    let of_points = window.picture();
    assert!(differing(&at_vertices, &of_points) > 50, "light between vertices");
    window.choose("Basis", "Vertices");
    window.run_steps(2);
    assert!(!window.has(Role::Slider, "Levels"));
    assert_eq!(
        (window.session().settings.levels, window.session().settings.point_spacing),
        (1, PointSpacing::Off)
    );
    window.solve();
    assert!(window.session().light.points.is_none());
    assert!(differing(&at_vertices, &window.picture()) < 5);
}

#[test]
fn levels_and_the_points_themselves_are_shown() {
    let Some(mut window) = Window::room_with_points() else { return };
    let all = window.picture();
    window.tab("Display");
    window.nudge("Finest level", Key::ArrowLeft, 1);
    assert_eq!(window.state().view().finest_level, 0);
    let coarse = window.picture();
    assert!(differing(&all, &coarse) > 100);
    window.choose("Point dots", "By level");
    assert_eq!(window.state().view().nodes, NodeColors::Level);
    let dots = window.picture();
    assert!(differing(&coarse, &dots) > 5);
    window.nudge("Finest level", Key::ArrowRight, 1);
    assert_eq!(window.state().view().finest_level, u32::MAX);
    let more = window.picture();
    window.choose("Point dots", "By coefficient");
    assert!(differing(&more, &window.picture()) > 5);
    window.choose("Point dots", "Hidden");
    assert_eq!(differing(&all, &window.picture()), 0);
}

#[test]
fn light_at_points_is_seen_while_it_is_measured() {
    let Some(mut window) = Window::room() else { return };
    window.choose("Basis", "Points");
    let settings = &mut window.session().settings;
    (settings.point_spacing, settings.levels) = (PointSpacing::Points(1000), 3);
    window.solve_for_long();
    let current =
        |app: &App| app.session.light.points.as_ref().is_some_and(|points| points.current.is_some());
    window.wait_until("a part of the first bounce", current);
    let points = window.session().light.points.clone().unwrap();
    assert_eq!((points.direct, points.bounces.len()), (Direct::AtVertices, 1));
    window.press(Key::Escape);
    window.wait_until("the stop", |app| !app.session.is_solving());
    let points = window.session().light.points.as_ref().unwrap();
    assert!(points.current.is_none() && points.bounces.len() == 1);
}

#[test]
fn light_at_points_follows_a_light_that_is_dragged() {
    let Some(mut window) = Window::room_with_points() else { return };
    window.session().live = true;
    assert_eq!(window.session().obstacle_to_live(), None);
    window.session().lights[0].rect.center += Vec3::new(0.3, 0.0, 0.2);
    let wanted = reference(window.state()).points.unwrap().bounces;
    window.wait_until("the light to follow", |app| {
        let points = app.session.light.points.as_ref();
        !app.session.is_following()
            && points.is_some_and(|points| points.bounces.iter().map(|b| &**b).eq(&wanted))
    });
}

#[test]
fn projects_and_solutions_keep_their_points() {
    let folder = folder();
    write_mesh(folder.path());
    let project = folder.path().join("points.lumel.toml");
    let text = "scene = \"room.obj\"\nmax_edge = 0.5\nbasis = \"points\"\n[bake]\nlevels = 2\nbounces = 1\n\
                point_spacing = 0.3\ndirect_samples = 4\nindirect_samples = 16\n\
                [[light]]\ncenter = [0, 1.9, 0]\nu = [0.3, 0, 0]\nv = [0, 0, 0.3]\nradiance = [20, 20, 20]\n";
    std::fs::write(&project, text).unwrap();
    let open = OpenRequest::new(project.to_string_lossy());
    let Some(mut window) = Window::start(folder, |setup| setup.start.open = Some(open)) else { return };
    let settings = |window: &mut Window| window.session().settings.clone();
    let opened = settings(&mut window);
    assert_eq!((opened.point_spacing, opened.levels), (PointSpacing::Metres(0.3), 2));
    window.solve();
    let (shown, light) = (window.picture(), window.session().light.points.clone().unwrap());
    let [copy, solution] = ["copy.lumel.toml", "a.npz"].map(|name| window.file(name));
    window.session().save_project(&copy).unwrap();
    let kept = lumel::Project::read(&copy).unwrap().settings().settings();
    assert_eq!((kept.point_spacing, kept.levels), (PointSpacing::Metres(0.3), 2));
    window.session().save_solution(&solution).unwrap();
    window.wait_for_files();
    let saved = Solution::load(&solution).unwrap().points.unwrap();
    assert!(saved.len() == light.cloud.points().len() && *light.bounces[1] == saved.bounces[1]);
    window.session().load_solution(&solution, LightUse::Show);
    window.wait_for_files();
    assert_eq!(differing(&shown, &window.picture()), 0);
    // A solve goes on from the file.
    window.session().settings.bounces = lumel::BounceLimit::Count(2);
    window.solve();
    let points = window.session().light.points.as_ref().unwrap();
    assert!(points.bounces.len() == 3 && points.bounces[1] == light.bounces[1]);
}
