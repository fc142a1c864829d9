//! Light from outside the scene.

use crate::actions::Actions;
use crate::input::Command;
use crate::session::Session;
use crate::sky::SkyKind;
use crate::widgets::{choice, heading, row, share_button, slider};
use eframe::egui::{Slider, Ui};
use glam::Vec3;
use lumel::{Radiance, Sky, SkyGradient};
use lumel_scene::SkyImage;
use std::sync::Arc;

const ABOUT: &str = "Light that arrives from outside the scene";

/// The brightest radiance that is offered, W·m⁻²·sr⁻¹.
const BRIGHTEST: f32 = 1000.0;

/// What an image of the sky can be multiplied by.
const STRENGTHS: std::ops::RangeInclusive<f32> = 1e-3..=1000.0;

pub(super) fn show(session: &mut Session, actions: &mut Actions, ui: &mut Ui) {
    let Some(document) = &session.document else { return };
    heading(ui, "Light from outside");
    let kinds = [SkyKind::Black, SkyKind::Uniform, SkyKind::Gradient, SkyKind::Image];
    let before = SkyKind::of(&session.sky.sky);
    let mut kind = before;
    choice(ui, "Sky", ABOUT, &mut kind, &kinds, |kind| kind.name().to_owned());
    if kind != before {
        match kind.sky(&session.sky.sky) {
            Some(sky) => session.sky = sky.into(),
            None if SkyKind::of(&document.sky.sky) == kind => session.sky = document.sky.clone(),
            None => actions.push(Command::LoadSky),
        }
    }
    let file = session.sky.file.as_ref().and_then(|file| file.file_name());
    let file =
        file.map_or_else(|| "that of the scene".to_owned(), |name| name.to_string_lossy().into_owned());
    match &mut session.sky.sky {
        Sky::Uniform(radiance) if radiance.is_zero() => {}
        Sky::Uniform(radiance) => parts(ui, [("Sky colour", radiance)]),
        Sky::Gradient(SkyGradient { zenith, horizon, ground }) => {
            parts(ui, [("Zenith", zenith), ("Horizon", horizon), ("Ground", ground)]);
        }
        Sky::Image(image) => {
            let chooses = row(ui, "Image", &file, |ui| ui.button(&file));
            if chooses.on_hover_text(Command::LoadSky.text()).clicked() {
                actions.push(Command::LoadSky);
            }
            if let Some(changed) = placed(ui, image) {
                *image = Arc::new(changed);
            }
        }
    }
}

/// How an image is turned and how strong it is; the image with what was changed.
fn placed(ui: &mut Ui, image: &SkyImage) -> Option<SkyImage> {
    let (before, mut strength) = (image.rotation().to_degrees(), image.strength());
    let mut rotation = before;
    let turned = slider(
        ui,
        "Sky rotation",
        "Degrees counter-clockwise, seen from above",
        Slider::new(&mut rotation, -180.0..=180.0).suffix("°"),
    );
    let dimmed = slider(
        ui,
        "Sky strength",
        "What multiplies the radiance of the image",
        Slider::new(&mut strength, STRENGTHS).logarithmic(true),
    );
    let radians = if rotation == before { image.rotation() } else { rotation.to_radians() };
    (turned.changed() || dimmed.changed()).then(|| image.with(radians, strength))
}

/// The brightest channel of all parts, and the colours that it multiplies.
fn parts<const N: usize>(ui: &mut Ui, parts: [(&str, &mut Radiance); N]) {
    let brightest = parts.iter().map(|(_, part)| part.0.max_element()).fold(0.0, f32::max);
    let mut intensity = brightest;
    // Black cannot be made brighter: that it is none is chosen above.
    let range = 1e-3..=BRIGHTEST;
    slider(
        ui,
        "Sky intensity",
        "Radiance of the brightest channel, W/(m² sr)",
        Slider::new(&mut intensity, range).logarithmic(true),
    );
    for (name, part) in parts {
        let mut rgb = (part.0 / brightest).to_array();
        let recolored = row(ui, name, "Relative to the intensity", |ui| share_button(ui, name, &mut rgb));
        if recolored.changed() || intensity != brightest {
            part.0 = Vec3::from_array(rgb) * intensity;
        }
    }
}
