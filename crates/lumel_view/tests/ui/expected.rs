//! What pictures and solutions are compared with.

use lumel::{Baker, Control, Scene, Settings, Silent, SolveState};
use lumel_render_cpu::Picture;
use lumel_view::app::App;
use std::sync::Arc;

/// How many of a thousand pixels differ.
pub(crate) fn differing(a: &Picture, b: &Picture) -> usize {
    assert_eq!((a.width(), a.height()), (b.width(), b.height()));
    let n = a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).count();
    1000 * n / a.pixels().len()
}

/// The light of every finished bounce, and what is beyond them, bit by bit.
pub(crate) fn bits(app: &App) -> Vec<Vec<[u32; 3]>> {
    let light = &app.session.light;
    light.bounces.iter().chain(&light.tail).map(|part| bits_of(part)).collect()
}

fn bits_of(values: &[glam::Vec3]) -> Vec<[u32; 3]> {
    values.iter().map(|value| value.to_array().map(f32::to_bits)).collect()
}

/// What the library computes in one go for the same lights and settings.
pub(crate) fn reference(app: &App) -> Vec<Vec<[u32; 3]>> {
    let scene = app.session.document.as_ref().unwrap().relit(&app.session.lights).unwrap();
    reference_of(scene, app.session.settings.clone())
}

/// What the library computes in one go.
pub(crate) fn reference_of(scene: Arc<Scene>, settings: Settings) -> Vec<Vec<[u32; 3]>> {
    let baker = Baker::new(scene, settings);
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let reader = baker.light_reader(&state);
    state
        .bounces
        .iter()
        .chain(&state.beyond_bounces())
        .map(|part| bits_of(&reader.at_vertices(part)))
        .collect()
}
