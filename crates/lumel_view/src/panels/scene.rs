//! What the scene consists of.

use crate::session::Session;
use crate::theme;
use crate::values::{grouped, significant};
use crate::widgets::{albedo_button, heading, hint, value};
use eframe::egui::{self, Align, Layout, RichText, Ui};
use glam::Vec3;
use lumel::Directional;
use lumel_basis::Basis as _;

/// More materials than this are only counted.
const MAX_MATERIALS: usize = 200;

pub(super) fn show(session: &mut Session, ui: &mut Ui) {
    let Some(document) = &session.document else {
        hint(ui, "Open a scene first.");
        return;
    };
    let scene = &document.scene;
    value(ui, "Scene", scene.name());
    value(ui, "Vertices", grouped(scene.vertex_count()));
    if let Some(edge) = document.auto_edge {
        value(ui, "Longest edge", format!("{} m, chosen automatically", significant(edge)));
    }
    value(ui, "Triangles", grouped(scene.traced_count()));
    let backs = scene.triangle_count() - scene.traced_count();
    if backs > 0 {
        value(ui, "Back faces", grouped(backs));
    }
    value(ui, "Objects", grouped(scene.object_names().len()));
    value(ui, "Materials", grouped(scene.materials().len()));
    value(ui, "Textures", grouped(scene.textures().len()));
    let size = scene.bounds().max - scene.bounds().min;
    value(
        ui,
        "Size",
        format!("{} × {} × {} m", significant(size.x), significant(size.y), significant(size.z)),
    );
    let area: f64 = document.baker.basis().node_areas().iter().map(|a| f64::from(*a)).sum();
    value(ui, "Surface", format!("{} m²", significant(area as f32)));
    value(ui, "Lights", format!("{}", session.lights.len()));
    let hidden = session.light.valid.iter().filter(|valid| !**valid).count();
    if hidden > 0 {
        value(ui, "Inside geometry", format!("{} vertices", grouped(hidden)));
    }
    value(ui, "Warnings", format!("{} (see the log)", document.warnings.len()));
    heading(ui, "Materials");
    let (mut repainted, mut rippled) = (None, None);
    let is_directional = session.directional() != Directional::Off;
    if !is_directional {
        hint(ui, "They can have a ripple where light is known by direction: L1 or L2 under Solve.");
    }
    for material in scene.materials().iter().take(MAX_MATERIALS) {
        ui.horizontal(|ui| {
            let mut rgb = material.albedo.to_array();
            let label = format!("Albedo of {}", material.name);
            let well = albedo_button(ui, &label, &mut rgb);
            if well.on_hover_text("Linear albedo: the fraction of light it reflects").changed() {
                repainted = Some((material.name.clone(), Vec3::from_array(rgb)));
            }
            let mut text = material.name.clone();
            if material.albedo_texture.is_some() {
                text += "  (textured)";
            }
            if material.emits() {
                text += "  (emits)";
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if is_directional {
                    let mut on = session.rippled.contains(&material.name);
                    if ripple_box(ui, &material.name, &mut on) {
                        rippled = Some((material.name.clone(), on));
                    }
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(egui::Label::new(RichText::new(text).color(theme::TEXT)).truncate());
                });
            });
        });
    }
    if scene.materials().len() > MAX_MATERIALS {
        hint(ui, &format!("and {} more", scene.materials().len() - MAX_MATERIALS));
    }
    if let Some((material, on)) = rippled {
        session.set_ripple(&material, on);
    }
    if let Some((material, albedo)) = repainted {
        session.repaint(&material, albedo);
    }
}

/// Whether a material has waves over it; true when that has changed.
fn ripple_box(ui: &mut Ui, material: &str, on: &mut bool) -> bool {
    let name = format!("Ripple of {material}");
    let response = ui.checkbox(on, RichText::new("Ripple").color(theme::WEAK));
    let is_on = *on;
    response.widget_info(|| egui::WidgetInfo::selected(egui::accesskit::Role::CheckBox, true, is_on, &name));
    response.on_hover_text("Waves that run over it, while one looks at light or normals").changed()
}
