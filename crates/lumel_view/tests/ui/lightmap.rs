//! Light on lumels.

use crate::expected::differing;
use crate::harness::Window;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use glam::Vec3;
use lumel::{Baker, Control, Lightmap, Lumels, Silent, SolveState};
use lumel_render_cpu::{Display, Exposure, Picture, Resolution, Show, View, draw};
use lumel_view::app::App;
use lumel_view::layout::LumelCount;
use lumel_view::prefs::{LumelFilter, ViewMode};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

impl Window {
    /// With the room and its lightmap.
    fn lightmapped_room() -> Option<Self> {
        let mut window = Self::room()?;
        window.choose("Basis", "Lightmap");
        window.session().lumels.count = LumelCount::Budget(3000);
        window.wait_until("the unwrap", |app| app.session.layout().is_some());
        window.solve();
        window.wait_for_lightmap();
        Some(window)
    }

    #[track_caller]
    fn wait_for_lightmap(&mut self) {
        self.wait_until("the lightmap", is_whole);
        self.run_steps(2);
    }
}

/// Whether there is a finished lightmap of the lights as they are, and nothing more to do.
fn is_whole(app: &App) -> bool {
    let session = &app.session;
    session.has_whole_lightmap() && session.phase().is_none() && session.out_of_date().is_none()
}

/// What is shown, and how: the layers of the lightmap.
fn lightmap(app: &App) -> Arc<Lightmap> {
    Arc::clone(app.session.lumel_light().unwrap().lightmap().unwrap())
}

/// What the library computes in one go for the lights and settings as they are.
fn reference(app: &App) -> Lightmap {
    let session = &app.session;
    let scene = session.document.as_ref().unwrap().relit(&session.lights).unwrap();
    let baker = Baker::new(scene, session.settings.clone());
    let (mut state, control) = (SolveState::new(), Control::default());
    baker.run(&mut state, &control, &Silent).unwrap();
    let lumels = &session.layout().unwrap().lumels;
    let light = baker.light_at_lumels(&state, lumels, &control).unwrap();
    let Lumels { scene, atlas, coverage } = lumels;
    let known = session.lumels.denoises.then(|| baker.solved_at_lumels(&state, lumels));
    Lightmap::finished(scene, atlas, coverage, &light, known.as_ref(), None)
}

#[test]
fn the_lightmap_that_follows_a_solve_is_that_of_the_library() {
    let Some(mut window) = Window::room() else { return };
    window.solve();
    let at_vertices = window.picture();
    window.choose("Basis", "Lightmap");
    window.session().lumels.count = LumelCount::Budget(3000);
    window.wait_for_lightmap();
    assert!(window.told("Unwrapped: ") && window.told("Measured "), "{}", window.texts());
    assert!(lightmap(window.state()).layers == reference(window.state()).layers);
    let tiles = window.state().stage.as_ref().unwrap().tiles;
    assert!(tiles > 0, "they were uploaded");
    let of_lumels = window.picture();
    assert!(differing(&at_vertices, &of_lumels) > 50, "shadows are sharper");
    // Another look at the same needs no upload, and going back shows what there was.
    window.choose("View mode", "Irradiance");
    window.picture();
    assert_eq!(window.state().stage.as_ref().unwrap().tiles, tiles);
    window.choose("View mode", "Final colour");
    window.choose("Basis", "Vertices");
    assert!(differing(&at_vertices, &window.picture()) < 5);
    assert!(window.session().lumel_light().is_none());
    window.choose("Basis", "Lightmap");
    window.wait_for_lightmap();
    assert_eq!(window.picture(), of_lumels);
}

#[test]
fn the_picture_of_a_lightmap_is_that_of_the_cpu() {
    let Some(mut window) = Window::lightmapped_room() else { return };
    window.state_mut().prefs.view.antialias = false;
    let device = window.picture();
    let app = window.state();
    let (session, stops) = (&app.session, app.stage.as_ref().unwrap().stops(app.view()));
    let (lightmap, layout) = (lightmap(app), session.layout().unwrap());
    let lit = session.document.as_ref().unwrap().relit(&session.lights).unwrap();
    let scene = layout.lumels.scene.relit(lit.lights().to_vec()).unwrap();
    let (tracer, lighting) = (lumel::tracer_of(&scene), lightmap.lighting(0));
    let view = View::new(&scene, &*tracer, &lighting);
    let display = Display {
        exposure: Exposure::Stops(stops),
        tone: app.view().tone(),
        white: app.view().white,
        ..Display::of(Show::Radiance)
    };
    let resolution = Resolution { width: device.width(), height: device.height(), samples_per_pixel: 1 };
    let camera = session.camera.camera();
    let cpu = draw(&view, &camera, &resolution, &display, &AtomicBool::new(false)).unwrap();
    let far = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|c| a[c].abs_diff(b[c]) > 2);
    let n = device.pixels().iter().zip(cpu.pixels()).filter(far).count();
    assert!(n * 200 < device.pixels().len(), "{n} of {} pixels", device.pixels().len());
}

#[test]
fn lumels_are_measured_again_for_other_light_and_other_settings() {
    let Some(mut window) = Window::lightmapped_room() else { return };
    let before = lightmap(window.state());
    window.session().live = true;
    window.session().lights[0].rect.center += Vec3::new(0.3, -0.4, 0.2);
    window.wait_until("the light to follow", |app| is_whole(app) && lightmap(app).layers != before.layers);
    assert!(lightmap(window.state()).layers == reference(window.state()).layers);
    window.check("Denoise");
    window.wait_until("the noise", |app| is_whole(app) && lightmap(app).layers.len() < before.layers.len());
    window.session().lumels.count = LumelCount::PerMetre(9.0);
    window.wait_until("other lumels", |app| {
        is_whole(app) && app.session.layout().unwrap().lumels.atlas.density() == 9.0
    });
    assert!(lightmap(window.state()).layers == reference(window.state()).layers);
}

#[test]
fn esc_stops_lumels_and_enter_measures_them_again() {
    let Some(mut window) = Window::room() else { return };
    window.solve();
    window.session().lumels.count = LumelCount::Budget(1 << 20);
    window.choose("Basis", "Lightmap");
    window.wait_until("lumels", |app| app.session.is_measuring_lumels());
    window.run_steps(1);
    assert!(window.reads("Measuring lumels"), "{}", window.texts());
    window.press(Key::Escape);
    window.wait_until("the end", |app| app.session.phase().is_none());
    window.run_steps(5);
    assert!(window.told("Stopped; press Enter to measure the lumels again"));
    assert!(!window.session().is_measuring_lumels() && !window.session().has_whole_lightmap());
    window.press(Key::Enter);
    window.wait_until("lumels again", |app| app.session.is_measuring_lumels());
    // Other lumels are wanted: these are not finished.
    window.session().lumels.count = LumelCount::Budget(3000);
    window.wait_for_lightmap();
}

#[test]
fn lumels_have_views_of_their_own() {
    let Some(mut window) = Window::lightmapped_room() else { return };
    let mut pictures: Vec<(&str, Picture)> = vec![("light", window.picture())];
    let views = [
        (Key::V, ViewMode::Charts),
        (Key::I, ViewMode::Chequerboard),
        (Key::Y, ViewMode::LumelDensity),
        (Key::F3, ViewMode::Validity),
        (Key::F4, ViewMode::Seams),
    ];
    for (key, mode) in views {
        window.press(key);
        assert_eq!(window.state().view().mode, mode);
        let picture = window.picture();
        for (name, other) in &pictures {
            // Nothing in the room lies inside geometry, and it has no smooth edge.
            let alike = mode == ViewMode::Seams && *name == "Validity";
            assert!(alike || differing(other, &picture) > 50, "{name} and {}", mode.name());
        }
        pictures.push((mode.name(), picture));
    }
    window.press(Key::F4);
    assert_eq!(window.state().view().mode, ViewMode::Final, "once more goes back");
    assert_eq!(window.picture(), pictures[0].1);
    window.press(Key::T);
    assert!(differing(&pictures[0].1, &window.picture()) > 20, "lumels have borders");
    window.press(Key::T);
    for filter in [LumelFilter::Nearest, LumelFilter::Bicubic] {
        window.tab("Display");
        window.choose("Between lumels", filter.name());
        assert!(differing(&pictures[0].1, &window.picture()) > 20, "{filter:?}");
    }
}

#[test]
fn a_click_reads_the_lumels_and_the_divider_compares_them_with_vertices() {
    let Some(mut window) = Window::lightmapped_room() else { return };
    let middle = window.area().center();
    window.click_at(middle);
    window.run_steps(2);
    assert!(window.reads("On lumels"), "{}", window.texts());
    let before = window.picture();
    window.session().keep_light();
    window.press(Key::C);
    let split = window.picture();
    let half = |picture: &Picture, right: bool| {
        let width = picture.width() as usize;
        let rows = picture.pixels().chunks(width);
        let columns = if right { width * 9 / 16..width * 11 / 16 } else { width * 5 / 16..width * 7 / 16 };
        rows.flat_map(|row| row[columns.clone()].to_vec()).collect::<Vec<_>>()
    };
    assert!(half(&before, false) == half(&split, false), "lumels on the left");
    assert!(half(&before, true) != half(&split, true), "vertices on the right");
}

#[test]
fn views_of_lumels_are_offered_where_there_are_some() {
    let Some(mut window) = Window::solved_room() else { return };
    window.tab("Display");
    assert!(!window.has(Role::CheckBox, "Lumel grid"));
    window.press(Key::V);
    assert!(window.reads("There is no lightmap yet"), "{}", window.texts());
}

#[test]
fn bounces_of_a_lightmap_are_shown_alone() {
    let Some(mut window) = Window::lightmapped_room() else { return };
    let mut pictures = vec![window.picture()];
    for key in [Key::G, Key::J] {
        window.press(key);
        let picture = window.picture();
        assert!(pictures.iter().all(|other| differing(other, &picture) > 50), "{key:?}");
        pictures.push(picture);
    }
}

#[test]
fn the_atlas_shows_its_pages() {
    let Some(mut window) = Window::room() else { return };
    window.tab("Atlas");
    assert!(window.reads("Choose it as the basis under Solve"), "{}", window.texts());
    drop(window);
    let Some(mut window) = Window::lightmapped_room() else { return };
    window.session().lumels.page_size = 256;
    window.session().lumels.count = LumelCount::PerMetre(150.0);
    window.wait_until("several pages", |app| {
        app.session.layout().is_some_and(|layout| layout.lumels.atlas.pages().len() > 1)
    });
    window.tab("Atlas");
    window.run_steps(2);
    window.check_accessibility();
    window.click("2");
    let mut seen: Vec<Vec<u8>> = Vec::new();
    for mode in ["Charts", "Chequerboard", "Lumel density", "Validity"] {
        window.choose("Page shows", mode);
        window.run_steps(2);
        let page = window.find(Role::Image, "Page of the atlas").rect();
        let image = window.render().unwrap();
        let [x, y, w, h] = [page.left(), page.top(), page.width(), page.height()].map(|n| n as u32);
        let pixels = image::imageops::crop_imm(&image, x, y, w, h).to_image().into_raw();
        assert!(!seen.contains(&pixels), "{mode}");
        seen.push(pixels);
    }
    let middle = window.find(Role::Image, "Page of the atlas").rect().center();
    window.hover_at(middle);
    window.run_steps(2);
    assert!(window.reads("room"), "the object under the pointer: {}", window.texts());
}

#[test]
fn a_lightmap_is_saved_as_pages_mesh_and_picture() {
    let Some(mut window) = Window::room() else { return };
    window.press_with(Modifiers::SHIFT, Key::K);
    assert!(window.reads("There is no lightmap yet"), "{}", window.texts());
    window.press(Key::Escape);
    drop(window);
    let Some(mut window) = Window::lightmapped_room() else { return };
    for (name, what) in [
        ("lit.exr", "Saved the lightmap"),
        ("lit.glb", "Saved the mesh with its lightmap"),
        ("lit.png", "Saved a picture of the lightmap"),
    ] {
        let file = window.file(name);
        window.press_with(Modifiers::SHIFT, Key::K);
        window.answer(&file);
        window.wait_for_files();
        assert!(window.told(what), "{name}: {}", window.texts());
        assert!(file.metadata().unwrap().len() > 1000, "{name}");
    }
    let whole = window.session().layout().unwrap().lumels.scene.triangle_count();
    let saved = lumel::open(
        window.file("lit.glb"),
        &lumel::OpenOptions { max_edge: Some(lumel::MaxEdge::Off), ..lumel::OpenOptions::default() },
    );
    let saved = saved.unwrap().builder.build().unwrap().0;
    assert_eq!(saved.triangle_count(), whole + 2, "the mesh as it is in its file, and its light");
}
