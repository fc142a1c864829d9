//! How a page of the lightmap is looked at.

use crate::layout::{Layout, LayoutKey};
use crate::lumel_values::of_lumels;
use crate::prefs::{ViewMode, ViewPrefs};
use crate::selection::Selection;
use crate::session::Session;
use eframe::egui::{
    self, Color32, ColorImage, Pos2, Rect, Response, TextureFilter, TextureHandle, TextureId, TextureOptions,
    Ui, Vec2, vec2,
};
use glam::{DVec2, Vec3};
use lumel_render_cpu::{Display, Show, ToneMapper, false_color, srgb_byte};
use lumel_scene::{Albedo, Irradiance, TriId, luminance};
use std::collections::HashMap;
use std::sync::Arc;

/// How far a page can be enlarged, points per lumel.
const MOST_ENLARGED: f32 = 64.0;

/// What no chart is at.
const EMPTY: Color32 = Color32::from_rgb(14, 14, 17);

/// Lumels of which nothing is known.
const UNKNOWN: Color32 = Color32::from_rgb(52, 52, 60);

/// How a page is looked at.
pub struct AtlasView {
    /// The page.
    pub page: usize,
    /// What it shows.
    pub mode: ViewMode,
    /// Whether the edges of charts are drawn.
    pub outlines: bool,
    /// The place under the pointer, lumels.
    pub hover: Option<Vec2>,
    /// Points per lumel; `None` to show the whole page.
    zoom: Option<f32>,
    /// The place in the middle, in parts of the page.
    middle: Vec2,
    shown: Option<ShownPage>,
    edges: Option<(LayoutKey, Vec<ChartEdge>)>,
}

/// An edge of a chart on a page.
pub struct ChartEdge {
    /// The page.
    pub page: usize,
    /// Its ends, lumels.
    pub ends: [DVec2; 2],
}

/// A page as a texture.
struct ShownPage {
    key: PageKey,
    texture: TextureHandle,
}

/// What a page looks like: equal ones need no new texture.
#[derive(Clone, PartialEq)]
struct PageKey {
    layout: LayoutKey,
    generation: u64,
    page: usize,
    mode: ViewMode,
    selection: Selection,
    /// Stops, tone mapper and white point, if there is light on it.
    exposure: Option<(f32, ToneMapper, f32)>,
}

impl Default for AtlasView {
    fn default() -> Self {
        Self {
            page: 0,
            mode: ViewMode::Irradiance,
            outlines: true,
            hover: None,
            zoom: None,
            middle: vec2(0.5, 0.5),
            shown: None,
            edges: None,
        }
    }
}

impl AtlasView {
    /// Shows the whole page.
    pub fn fit(&mut self) {
        (self.zoom, self.middle) = (None, vec2(0.5, 0.5));
    }

    /// Points per lumel.
    fn scale(&self, rect: Rect, [width, height]: [f32; 2]) -> f32 {
        let whole = (rect.width() / width.max(1.0)).min(rect.height() / height.max(1.0)).max(1e-3);
        self.zoom.unwrap_or(whole)
    }

    /// Where the page is in the window.
    pub fn area_of_page(&self, rect: Rect, page: [f32; 2]) -> Rect {
        let size = Vec2::from(page) * self.scale(rect, page);
        Rect::from_min_size(rect.center() - self.middle * size, size)
    }

    /// The place on the page at a point of the window, lumels.
    pub fn place_at(&self, rect: Rect, page: [f32; 2], at: Pos2) -> Vec2 {
        (at - self.area_of_page(rect, page).min) / self.scale(rect, page)
    }

    /// Moves the page with a drag and enlarges it with the wheel, about the pointer.
    pub fn move_by_hand(&mut self, ui: &Ui, response: &Response, rect: Rect, page: [f32; 2]) {
        let size = Vec2::from(page) * self.scale(rect, page);
        if response.dragged() {
            self.middle -= response.drag_delta() / size;
        }
        let Some(pointer) = response.hover_pos() else { return };
        let turned = ui.input(|i| i.smooth_scroll_delta().y + 200.0 * (i.zoom_delta() - 1.0));
        if turned == 0.0 {
            return;
        }
        let fixed = self.place_at(rect, page, pointer) / Vec2::from(page);
        let whole = Self::default().scale(rect, page);
        let scale =
            (self.scale(rect, page) * (turned * 0.005).exp()).clamp(0.5 * whole, MOST_ENLARGED.max(whole));
        self.zoom = Some(scale);
        self.middle = fixed - (pointer - rect.center()) / (Vec2::from(page) * scale);
    }

    /// The page as a texture of the window.
    pub fn texture(
        &mut self,
        ctx: &egui::Context,
        session: &Session,
        view: &ViewPrefs,
        stops: f32,
    ) -> TextureId {
        let Some(layout) = session.layout() else { return TextureId::default() };
        let is_light = self.mode.is_exposed();
        let changes = is_light || self.mode == ViewMode::Validity;
        let key = PageKey {
            layout: layout.key,
            generation: if changes { session.lumel_generation } else { 0 },
            page: self.page,
            mode: self.mode,
            selection: if is_light { view.selection } else { Selection::All },
            exposure: is_light.then_some((stops, view.tone(), view.white)),
        };
        if let Some(shown) = self.shown.as_ref().filter(|shown| shown.key == key) {
            return shown.texture.id();
        }
        let image = page_image(session, layout, &key);
        let magnification = if is_light { TextureFilter::Linear } else { TextureFilter::Nearest };
        let options =
            TextureOptions { magnification, minification: TextureFilter::Linear, ..Default::default() };
        match &mut self.shown {
            Some(shown) => {
                shown.texture.set(image, options);
                shown.key = key;
                shown.texture.id()
            }
            None => {
                let texture = ctx.load_texture("page", image, options);
                self.shown.insert(ShownPage { key, texture }).texture.id()
            }
        }
    }

    /// The edges of all charts.
    pub fn edges(&mut self, layout: &Arc<Layout>) -> &[ChartEdge] {
        if self.edges.as_ref().is_none_or(|(key, _)| *key != layout.key) {
            self.edges = Some((layout.key, chart_edges(layout)));
        }
        self.edges.as_ref().map_or(&[], |(_, edges)| edges)
    }
}

/// The colours of a page.
fn page_image(session: &Session, layout: &Layout, key: &PageKey) -> ColorImage {
    let atlas = &layout.lumels.atlas;
    let [width, height] = atlas.pages()[key.page].map(|length| length as usize);
    let first = atlas.first_lumel(key.page);
    let values = of_lumels(session, key.mode, key.selection).unwrap_or_default();
    let values = values.get(first..first + width * height).unwrap_or_default();
    let color = |value: &Option<Vec3>| match (value, key.exposure) {
        (None, _) => EMPTY,
        (Some(value), Some((stops, tone, white))) => {
            let light = Irradiance(*value).reflected(Albedo(Vec3::ONE)).radiance().0;
            let display = Display { tone, white, ..Display::of(Show::Irradiance) };
            let [r, g, b] = display.light_pixel(stops, light);
            Color32::from_rgb(r, g, b)
        }
        (Some(value), None) if key.mode == ViewMode::LumelDensity => {
            let [r, g, b] = false_color(density_position(luminance(*value), atlas.density()));
            Color32::from_rgb(r, g, b)
        }
        (Some(value), None) => {
            let [r, g, b] = value.to_array().map(srgb_byte);
            Color32::from_rgb(r, g, b)
        }
    };
    let mut pixels = vec![EMPTY; width * height];
    let lumels = layout.lumels.coverage.lumels().iter();
    for lumel in lumels.filter_map(|&lumel| (lumel as usize).checked_sub(first)) {
        pixels.get_mut(lumel).into_iter().for_each(|pixel| *pixel = UNKNOWN);
    }
    for (pixel, value) in pixels.iter_mut().zip(values).filter(|(_, value)| value.is_some()) {
        *pixel = color(value);
    }
    ColorImage::new([width, height], pixels)
}

/// Where a density is between half and twice of what was asked for.
fn density_position(density: f32, asked: f32) -> f32 {
    0.5 + 0.5 * (density / asked).log2()
}

/// The edges of triangles that have no neighbour on their chart.
fn chart_edges(layout: &Layout) -> Vec<ChartEdge> {
    let atlas = &layout.lumels.atlas;
    let mut edges: HashMap<(usize, [[u32; 2]; 2]), u32> = HashMap::new();
    let tris = || (0..atlas.triangle_count() as u32).map(TriId);
    let ends = |tri: TriId| {
        let corners = atlas.corners(tri);
        [(0, 1), (1, 2), (2, 0)].map(|(from, to)| [corners[from], corners[to]])
    };
    let key = |tri: TriId, ends: [glam::Vec2; 2]| {
        let mut bits = ends.map(|end| end.to_array().map(f32::to_bits));
        bits.sort_unstable();
        (atlas.chart(tri), bits)
    };
    for tri in tris() {
        ends(tri).into_iter().for_each(|ends| *edges.entry(key(tri, ends)).or_default() += 1);
    }
    let outer = |tri: TriId| {
        let alone = ends(tri).into_iter().filter(|ends| edges.get(&key(tri, *ends)) == Some(&1));
        alone
            .map(|ends| ChartEdge { page: atlas.page(tri), ends: ends.map(|end| end.as_dvec2()) })
            .collect::<Vec<_>>()
    };
    tris().flat_map(outer).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn a_page_that_fits_is_whole_and_in_the_middle() {
        let view = AtlasView::default();
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(300.0, 100.0));
        let area = view.area_of_page(rect, [200.0, 100.0]);
        assert_eq!((area.center(), area.size()), (rect.center(), vec2(200.0, 100.0)));
        assert_eq!(view.place_at(rect, [200.0, 100.0], area.min + vec2(7.0, 3.0)), vec2(7.0, 3.0));
    }

    #[test]
    fn densities_are_placed_by_their_ratio() {
        assert_eq!([5.0, 10.0, 20.0].map(|density| density_position(density, 10.0)), [0.0, 0.5, 1.0]);
    }
}
