//! How the picture is drawn.

use crate::prefs::{LumelFilter, Unit, ViewMode, ViewPrefs};
use crate::relief::UNKNOWN;
use crate::session::Session;
use crate::stage::Stage;
use crate::values::significant;
use crate::widgets::{check, choice, heading, hint, number, slider, value};
use eframe::egui::{DragValue, Slider, Ui};
use lumel_render_cpu::ToneMapper;

pub(super) fn show(session: &Session, stage: Option<&Stage>, view: &mut ViewPrefs, ui: &mut Ui) {
    let (stops, range) = stage.map_or((0.0, None), |stage| (stage.stops(view), stage.range()));
    let wireframes = stage.is_some_and(|stage| stage.gpu().draws_wireframes());
    let known = session.light.standard_error.is_some();
    let has_lumels = session.layout().is_some();
    let modes: Vec<ViewMode> = ViewMode::offered(session.known()).collect();
    choice(ui, "Surfaces show", view.mode.hint(), &mut view.mode, &modes, |mode| mode.name().to_owned());
    if view.mode == ViewMode::StandardError && !known {
        hint(ui, "Not measured yet: solve, then press \"Measure standard error\" under Solve.");
    }
    let is_refined = session.document.as_ref().is_some_and(|document| document.indicator.is_some());
    if view.mode == ViewMode::Bends && !is_refined {
        hint(
            ui,
            "Not known yet: it is measured while a mesh is refined. Switch \"Follow light\" on under Solve.",
        );
    }
    if view.mode == ViewMode::Unshot && session.unshot().is_none() {
        hint(ui, "Not known yet: it is found by a solve.");
    }
    if view.mode.needs_lumels() && !has_lumels {
        hint(ui, "There is no lightmap yet: choose it as the basis under Solve.");
    }
    if let ViewMode::Moment(moment) = view.mode
        && !moment.is_in(session.directional())
    {
        hint(ui, UNKNOWN);
    }
    if view.mode.is_exposed() {
        let hint = "Adds, until a solve is finished, what light that is still to come would bring on average. For looking at: \
                    it is never saved (F8)";
        check(ui, "Ambient term", hint, &mut view.ambient);
        exposure(ui, view, stops);
    }
    if view.mode.has_legend() {
        colors(ui, view, range);
    }
    let on_lumels = stage.and_then(Stage::bytes_of_directions);
    super::relief::show(session, &mut view.relief, on_lumels, ui);
    heading(ui, "Overlays");
    check(ui, "Antialiasing", "Four samples per pixel", &mut view.antialias);
    let response = ui.add_enabled_ui(wireframes, |ui| {
        check(ui, "Wireframe", "Draws the edges of triangles (X)", &mut view.wireframe)
    });
    if !wireframes {
        response.response.on_hover_text("This graphics device cannot draw wireframes");
    }
    if has_lumels {
        check(ui, "Lumel grid", "Borders of the lumels, where they are wide enough (T)", &mut view.grid);
        let hint = "How light is read between lumels. Bicubic is a B-spline: smooth, but softer";
        choice(ui, "Between lumels", hint, &mut view.filter, &LumelFilter::ALL, |filter| {
            filter.name().to_owned()
        });
    }
    check(
        ui,
        "Sample points",
        "Where light is measured; red points lie inside geometry",
        &mut view.sample_points,
    );
    check(
        ui,
        "Brightest shooters",
        "Marks where the most light is still to be reflected: a tenth of it altogether (F7)",
        &mut view.shooters,
    );
    check(ui, "Rays of the picked vertex", "Its hemisphere rays of the first bounce", &mut view.rays);
    let is_outdoors = session.document.as_ref().is_some_and(|document| document.is_outdoors);
    if is_outdoors {
        check(ui, "Ground grid", "Lines on the ground, for a sense of size", &mut view.ground);
    }
    check(ui, "Light handles", "Outlines of the lights, and handles for the active one", &mut view.gizmo);
}

fn exposure(ui: &mut Ui, view: &mut ViewPrefs, metered: f32) {
    check(ui, "Automatic exposure", "Exposes the picture to middle grey", &mut view.auto_exposure);
    let mut stops = if view.auto_exposure { metered } else { view.stops };
    let before = stops;
    let hint = "Each stop doubles the light";
    slider(ui, "Exposure", hint, Slider::new(&mut stops, -16.0..=16.0).suffix(" EV").max_decimals(2));
    if stops != before {
        (view.stops, view.auto_exposure) = (stops, false);
    }
    let mut tone = view.tone();
    let hint = "How radiance beyond the display's range is compressed";
    let name = |tone| match tone {
        ToneMapper::None => "None".to_owned(),
        ToneMapper::Reinhard => "Reinhard".to_owned(),
        ToneMapper::Aces => "ACES-like".to_owned(),
        ToneMapper::Agx => "AgX-like".to_owned(),
    };
    if choice(ui, "Tone mapper", hint, &mut tone, ToneMapper::ALL, name).changed() || tone != view.tone() {
        view.tone = tone.to_string();
    }
    if tone == ToneMapper::Reinhard {
        let hint = "The exposed luminance that maps to white";
        slider(ui, "White", hint, Slider::new(&mut view.white, 0.5..=100.0).logarithmic(true));
    }
}

fn colors(ui: &mut Ui, view: &mut ViewPrefs, range: Option<[f32; 2]>) {
    if !matches!(view.mode, ViewMode::LumelDensity | ViewMode::Bends | ViewMode::Moment(_)) {
        check(ui, "Logarithmic", "Equal ratios have equal steps", &mut view.logarithmic);
    }
    if view.mode != ViewMode::FalseColor {
        return;
    }
    choice(ui, "Unit", "The unit of the legend", &mut view.unit, &Unit::ALL, |unit| unit.symbol().to_owned());
    if view.unit == Unit::Lux {
        let hint = "Lumens per watt of the light's spectrum: 179 for equal-energy white; 1 for scenes \
                    with photometric lights";
        number(ui, "Efficacy", hint, DragValue::new(&mut view.efficacy).range(0.001..=683.0).suffix(" lm/W"));
    }
    check(ui, "Automatic range", "From the 1st to the 99th percentile of the vertices", &mut view.auto_range);
    if view.auto_range {
        if let Some([lo, hi]) = range {
            // What is edited next begins here.
            view.range = [lo, hi];
            let text = format!("{} to {} W/m²", significant(lo), significant(hi));
            value(ui, "Range", text);
        }
        return;
    }
    let [mut lo, mut hi] = view.range;
    let speed = 0.01 * (hi - lo).abs().max(1e-6);
    number(ui, "Darkest", "W/m²", DragValue::new(&mut lo).speed(speed).range(0.0..=1e9));
    number(ui, "Brightest", "W/m²", DragValue::new(&mut hi).speed(speed).range(0.0..=1e9));
    let least = if view.logarithmic { 1e-9 } else { 0.0 };
    let lo = lo.max(least);
    view.range = [lo, hi.max(lo * 1.001 + 1e-9)];
}
