//! Waves that run while one looks at them.

use super::state::{Subject, Viewport};
use crate::prefs::ViewMode;
use eframe::egui::Ui;
use lumel::Directional;
use lumel_render_cpu::Ripple;
use std::time::Duration;

/// Time from one frame to the next on a software renderer, which shares the processor with solves, seconds.
const SOFTWARE_FRAME: f64 = 0.032;

/// The longest step in seconds: after a pause, waves go on where they were.
const LONGEST_STEP: f64 = 0.1;

/// How far waves have run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Waves {
    phase: f64,
    /// The time of the last frame, seconds.
    at: f64,
    /// How long a software renderer rests between two frames, seconds.
    rest: f64,
    /// Whether they are seen.
    pub(super) are_seen: bool,
}

/// The waves of this frame, if they are seen; asks for the next frame while they run.
pub(super) fn waves(viewport: &mut Viewport, subject: &Subject<'_>, ui: &Ui) -> Option<Ripple> {
    let (session, prefs) = (&*subject.session, &subject.prefs.view.relief);
    let (waves, now) = (&mut viewport.waves, ui.input(|i| i.time));
    let step = (now - waves.at).clamp(0.0, LONGEST_STEP);
    waves.at = now;
    // As much longer as the last frame came too early.
    waves.rest = (waves.rest + SOFTWARE_FRAME - step).clamp(0.0, SOFTWARE_FRAME);
    let is_lit = match subject.prefs.view.mode {
        ViewMode::Normals => true,
        mode => mode.is_light() && session.directional() != Directional::Off,
    };
    waves.are_seen = prefs.on && is_lit && !session.rippled_materials().is_empty();
    let scene = &session.document.as_ref().filter(|_| waves.are_seen)?.scene;
    if prefs.speed > 0.0 {
        waves.phase += step * f64::from(prefs.speed);
        match subject.stage.as_ref().is_some_and(|stage| stage.gpu().is_software()) {
            true => ui.ctx().request_repaint_after(Duration::from_secs_f64(waves.rest)),
            false => ui.ctx().request_repaint(),
        }
    }
    Some(prefs.ripple(scene, waves.phase as f32))
}
