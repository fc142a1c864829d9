//! How light falls on normal maps and ripples.

use crate::relief::{ReliefPrefs, SLOPES, SPEEDS, UNKNOWN, WAVE_LENGTHS, has_normal_maps};
use crate::session::Session;
use crate::widgets::{check, choice, heading, hint, slider, value};
use eframe::egui::{Slider, Ui};
use lumel::{Directional, Shading};

/// Of lumels, `on_lumels` are the bytes that their own
/// directions take, if those are shown.
pub(super) fn show(session: &Session, prefs: &mut ReliefPrefs, on_lumels: Option<u64>, ui: &mut Ui) {
    let Some(document) = &session.document else { return };
    heading(ui, "Light by direction");
    let known = session.directional();
    if known == Directional::Off {
        hint(ui, if session.measures_directions() { "It is measured last." } else { UNKNOWN });
        return;
    }
    let about = "Lights normal maps and ripples from where light comes from (Z). Without, surfaces are as smooth as \
                 their meshes";
    check(ui, "Normal maps", about, &mut prefs.on);
    if !prefs.on {
        return;
    }
    let mut shading = prefs.shading();
    let about = "How light on tilted normals is found; the errors are root mean squares over normals tilted by up to 45°";
    let all: Vec<Shading> =
        Shading::ALL.into_iter().filter(|s| *s != Shading::Quadratic || known == Directional::Sh2).collect();
    choice(ui, "Shading", about, &mut shading, &all, |shading| shading_text(shading).to_owned());
    if shading != prefs.shading() {
        prefs.shading = shading.to_string();
    }
    if has_normal_maps(&document.scene) {
        check(ui, "Green points down", "For normal maps made that way", &mut prefs.green_down);
    } else if session.rippled.is_empty() {
        hint(ui, "The scene has no normal maps. Give materials a ripple under Scene.");
    }
    if session.lumel_light().is_some() {
        let of = match on_lumels {
            Some(bytes) => format!("by lumel, {} MB", bytes.div_ceil(1_000_000)),
            None => "by vertex".to_owned(),
        };
        value(ui, "Directions", of);
    }
    ripple(session, prefs, ui);
}

fn ripple(session: &Session, prefs: &mut ReliefPrefs, ui: &mut Ui) {
    heading(ui, "Ripple");
    let count = session.rippled_materials().len();
    if count == 0 {
        hint(ui, "No material has one: switch it on under Scene.");
        return;
    }
    value(ui, "Materials", format!("{count} (see Scene)"));
    let [lo, hi] = WAVE_LENGTHS;
    let mut percent = 100.0 * prefs.wave_length;
    let waves =
        Slider::new(&mut percent, 100.0 * lo..=100.0 * hi).logarithmic(true).suffix(" %").max_decimals(1);
    if slider(ui, "Wave length", "Of the longest waves, in hundredths of the scene's diagonal", waves)
        .changed()
    {
        prefs.wave_length = percent / 100.0;
    }
    let slopes = Slider::new(&mut prefs.slope, SLOPES[0]..=SLOPES[1]).max_decimals(2);
    slider(ui, "Steepness", "The steepest slope of the waves", slopes);
    let speeds = Slider::new(&mut prefs.speed, SPEEDS[0]..=SPEEDS[1]).suffix(" rad/s").max_decimals(1);
    slider(ui, "Wave speed", "How fast the longest waves run; at 0 they stand still", speeds);
}

fn shading_text(shading: Shading) -> &'static str {
    match shading {
        Shading::Linear => "Linear L1 (error 11 %)",
        Shading::NonLinear => "Non-linear L1 (6 %)",
        Shading::Zh3 => "ZH3 (6 %)",
        Shading::Quadratic => "L2 (3 %)",
    }
}
