//! Light from outside the scene.

use crate::session::Session;
use crate::sky::SkyKind;
use crate::widgets::{choice, heading, row, share_button, slider};
use eframe::egui::{Slider, Ui};
use glam::Vec3;
use lumel::{Radiance, Sky, SkyGradient};

const ABOUT: &str = "Light that arrives from outside the scene";

/// The brightest radiance that is offered, W·m⁻²·sr⁻¹.
const BRIGHTEST: f32 = 1000.0;

pub(super) fn show(session: &mut Session, ui: &mut Ui) {
    let Some(document) = &session.document else { return };
    heading(ui, "Light from outside");
    let mut kinds = vec![SkyKind::Black, SkyKind::Uniform, SkyKind::Gradient];
    if SkyKind::of(&document.sky) == SkyKind::Image {
        kinds.push(SkyKind::Image);
    }
    let before = SkyKind::of(&session.sky);
    let mut kind = before;
    choice(ui, "Sky", ABOUT, &mut kind, &kinds, |kind| kind.name().to_owned());
    if kind != before {
        session.sky = kind.sky(&session.sky, &document.sky);
    }
    match &mut session.sky {
        Sky::Uniform(radiance) if radiance.is_zero() => {}
        Sky::Uniform(radiance) => parts(ui, [("Sky colour", radiance)]),
        Sky::Gradient(SkyGradient { zenith, horizon, ground }) => {
            parts(ui, [("Zenith", zenith), ("Horizon", horizon), ("Ground", ground)]);
        }
        Sky::Image(_) => {}
    }
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
