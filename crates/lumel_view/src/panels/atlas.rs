//! The pages of the lightmap.

use crate::atlas_view::AtlasView;
use crate::layout::LightBasis;
use crate::prefs::{ViewMode, ViewPrefs};
use crate::session::Session;
use crate::theme;
use crate::widgets::hint;
use eframe::egui::{
    self, Color32, ComboBox, CursorIcon, Rect, RichText, Sense, Shape, Stroke, Ui, Vec2, pos2, vec2,
};
use glam::DVec2;

/// Outlines of more edges than this are left out: they would cover the page.
const MOST_EDGES: usize = 20_000;

/// What a page can show.
const MODES: [ViewMode; 6] = [
    ViewMode::Irradiance,
    ViewMode::Charts,
    ViewMode::Chequerboard,
    ViewMode::LumelDensity,
    ViewMode::Validity,
    ViewMode::Seams,
];

pub(super) fn show(session: &Session, view: &ViewPrefs, stops: f32, atlas: &mut AtlasView, ui: &mut Ui) {
    let Some(layout) = session.layout() else {
        let text = match session.lumels.basis {
            LightBasis::Vertices => {
                "The pages of the lightmap are shown here. Choose it as the basis under Solve."
            }
            LightBasis::Lightmap => "The scene is being unwrapped.",
        };
        hint(ui, text);
        return;
    };
    let pages = layout.lumels.atlas.pages().len();
    atlas.page = atlas.page.min(pages - 1);
    ui.horizontal_wrapped(|ui| {
        bar(atlas, pages, ui);
        let [width, height] = layout.lumels.atlas.pages()[atlas.page];
        ui.label(RichText::new(format!("{width} × {height}")).color(theme::WEAK));
        if let Some(text) = under_pointer(session, atlas) {
            ui.label(RichText::new(text).color(theme::WEAK));
        }
    });
    let size = ui.available_size().max(vec2(16.0, 16.0));
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Image, true, "Page of the atlas"));
    let response = response.on_hover_cursor(CursorIcon::Grab);
    let page_size = layout.lumels.atlas.pages()[atlas.page].map(|length| length as f32);
    atlas.move_by_hand(ui, &response, rect, page_size);
    atlas.hover = response.hover_pos().map(|at| atlas.place_at(rect, page_size, at));
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 0.0, theme::DEEP);
    let area = atlas.area_of_page(rect, page_size);
    let texture = atlas.texture(ui.ctx(), session, view, stops);
    painter.image(texture, area, Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)), Color32::WHITE);
    painter.rect_stroke(area, 0.0, Stroke::new(1.0, theme::LINE), egui::StrokeKind::Outside);
    if atlas.outlines {
        outlines(atlas, layout, rect, area, &painter);
    }
}

fn bar(atlas: &mut AtlasView, pages: usize, ui: &mut Ui) {
    let combo = ComboBox::from_id_salt("page shows").width(112.0).selected_text(name(atlas.mode));
    let response = combo.show_ui(ui, |ui| {
        for mode in MODES {
            ui.selectable_value(&mut atlas.mode, mode, name(mode)).on_hover_text(mode.hint());
        }
    });
    let label = "Page shows";
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::ComboBox, true, label));
    if pages > 1 {
        for page in 0..pages {
            ui.selectable_value(&mut atlas.page, page, (page + 1).to_string())
                .on_hover_text(format!("Page {}", page + 1));
        }
    }
    ui.checkbox(&mut atlas.outlines, "Outlines").on_hover_text("Edges of charts");
    if ui.button("Fit").on_hover_text("Shows the whole page; drag and wheel move and enlarge it").clicked() {
        atlas.fit();
    }
}

fn name(mode: ViewMode) -> &'static str {
    if mode == ViewMode::Irradiance { "Light" } else { mode.name() }
}

/// The lumel under the pointer and its object.
fn under_pointer(session: &Session, atlas: &AtlasView) -> Option<String> {
    let layout = session.layout()?;
    let at = atlas.hover?;
    let [width, height] = layout.lumels.atlas.pages()[atlas.page];
    let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < width as f32 && at.y < height as f32;
    let [x, y] = [at.x as u32, at.y as u32];
    let lumel = layout.lumels.atlas.first_lumel(atlas.page) + y as usize * width as usize + x as usize;
    let lumels = layout.lumels.coverage.lumels();
    let place = lumels.binary_search(&(lumel as u32)).ok().filter(|_| inside)?;
    let tri = layout.lumels.coverage.shares(place)[0].tri;
    let scene = &layout.lumels.scene;
    let object = &scene.object_names()[scene.object_id(tri).index()];
    Some(format!("({x}, {y})  {object}"))
}

/// Draws the edges of charts.
fn outlines(
    atlas: &mut AtlasView,
    layout: &std::sync::Arc<crate::layout::Layout>,
    rect: Rect,
    area: Rect,
    painter: &egui::Painter,
) {
    let page = atlas.page;
    let scale = f64::from(area.width()) / f64::from(layout.lumels.atlas.pages()[page][0].max(1));
    let on_screen = |at: DVec2| pos2(area.left() + (at.x * scale) as f32, area.top() + (at.y * scale) as f32);
    let visible = rect.expand(2.0);
    // Small charts would be covered by their outlines.
    let alpha = (150.0 * scale.min(1.0)) as u8;
    let stroke = Stroke::new(1.0, Color32::from_rgba_unmultiplied(255, 255, 255, alpha));
    let edges = atlas.edges(layout).iter().filter(|edge| edge.page == page);
    let lines = edges.map(|edge| edge.ends.map(on_screen)).filter(|ends| {
        visible.intersects(Rect::from_two_pos(ends[0], ends[1])) && (ends[1] - ends[0]) != Vec2::ZERO
    });
    painter.extend(lines.take(MOST_EDGES).map(|ends| Shape::line_segment(ends, stroke)));
}
