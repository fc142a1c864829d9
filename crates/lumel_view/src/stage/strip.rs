//! Thumbnails of the terms of the series.

use super::blit::{Blit, ShownPicture};
use super::content::{Content, Side};
use super::metered::{Metered, stops_for};
use super::showing::{Quality, Showing};
use crate::camera::FlyCamera;
use crate::lights::drawn;
use crate::prefs::ViewMode;
use crate::selection::Selection;
use eframe::egui_wgpu::RenderState;
use lumel::{RectLight, Scene, VertexLighting};
use lumel_render_cpu::Relief;
use lumel_render_gpu::{
    Backdrop, Frame, LightBuffer, Lit, Look, Model, RenderError, Renderer, Samples, Target,
};

/// What a small picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thumbnail {
    /// Its place in the strip.
    pub index: usize,
    /// Some bounces; nothing for what emits.
    pub selection: Option<Selection>,
    /// Whether lights are drawn: bounces are what arrives on surfaces, so only emission and the sum show emitters.
    pub emits: bool,
    /// Its size, pixels.
    pub size: [u32; 2],
}

/// A small picture that was drawn.
#[derive(Clone)]
pub struct ShownThumbnail {
    /// The picture.
    pub picture: ShownPicture,
    /// By how many stops it is shown brighter than all light.
    pub brighter: f32,
}

/// What draws small pictures, and of what.
pub(super) struct Canvas<'a> {
    pub(super) state: &'a RenderState,
    pub(super) blit: &'a Blit,
    pub(super) renderer: &'a Renderer,
    pub(super) model: &'a Model,
    pub(super) scene: &'a Scene,
    pub(super) backdrop: Option<&'a Backdrop>,
}

/// All of them.
#[derive(Default)]
pub(super) struct Strip {
    cells: Vec<Cell>,
    exposure: Metered,
}

struct Cell {
    target: Target,
    picture: ShownPicture,
    buffer: LightBuffer,
    content: Option<Content>,
    /// What was last to be shown.
    asked: Option<Content>,
    drawn: Option<DrawnThumbnail>,
    /// How many stops brighter this content is shown than all light.
    brighter: Option<(Content, f32)>,
}

impl Cell {
    /// What there is; `None` before anything was drawn.
    fn shown(&self) -> Option<ShownThumbnail> {
        let (Some(_), Some((_, brighter))) = (&self.drawn, self.brighter) else { return None };
        Some(ShownThumbnail { picture: self.picture.clone(), brighter })
    }
}

/// All that a small picture depends on.
#[derive(Clone, PartialEq)]
struct DrawnThumbnail {
    content: Content,
    camera: FlyCamera,
    lamps: Vec<RectLight>,
    look: Look,
}

impl Strip {
    /// A small picture: see [`Stage::thumbnail`](super::Stage::thumbnail). `None` if there is none yet.
    pub(super) fn thumbnail(
        &mut self,
        canvas: &Canvas<'_>,
        showing: &Showing<'_>,
        wanted: &Thumbnail,
    ) -> Result<Option<ShownThumbnail>, RenderError> {
        let session = showing.session;
        if session.is_light_in_motion()
            && let Some(shown) = self.cells.get(wanted.index).and_then(Cell::shown)
        {
            // All of them change with each step of the hand; they are drawn when it rests.
            return Ok(Some(shown));
        }
        let selection = wanted.selection.unwrap_or(Selection::NONE);
        let content = Content::of_mode(session, Side::Current, ViewMode::FalseColor, selection);
        while self.cells.len() <= wanted.index {
            let target = canvas.renderer.target(wanted.size, Samples::One)?;
            let picture = canvas.blit.shown(canvas.state, target.view());
            let buffer = canvas.renderer.light(canvas.model);
            let (asked, drawn) = (None, None);
            self.cells.push(Cell { target, picture, buffer, content: None, asked, drawn, brighter: None });
        }
        let cell = &mut self.cells[wanted.index];
        let is_new = cell.asked.replace(content) != Some(content);
        if is_new && showing.quality == Quality::Live {
            // The large picture has something new to show, and that comes first.
            return Ok(cell.shown());
        }
        let lamps = drawn(&session.lights);
        // That of all light, whichever bounces the large picture shows.
        let all = Content::of_mode(session, Side::Current, ViewMode::FalseColor, Selection::All);
        if showing.view.auto_exposure {
            self.exposure.read(showing, &all, &lamps, wanted.size);
        }
        let base = if showing.view.auto_exposure { self.exposure.stops } else { showing.view.stops };
        let lamps = if wanted.emits { lamps } else { Vec::new() };
        if cell.target.size() != wanted.size {
            cell.target = canvas.renderer.target(wanted.size, Samples::One)?;
            cell.picture = canvas.blit.shown(canvas.state, cell.target.view());
            cell.drawn = None;
        }
        let known = cell.brighter.filter(|(of, _)| *of == content).map(|(_, brighter)| brighter);
        let brighter = match known {
            Some(brighter) => brighter,
            // What emits and the sum have the exposure of the sum.
            None if wanted.emits => 0.0,
            // Read once for each bounce: from elsewhere it is hardly brighter or darker compared with the sum.
            None => {
                let read =
                    stops_for(showing, &content, wanted.size).zip(stops_for(showing, &all, wanted.size));
                read.map_or(0.0, |(own, all)| own - all)
            }
        };
        cell.brighter = Some((content, brighter));
        let look =
            Look::Radiance { stops: base + brighter, tone: showing.view.tone(), white: showing.view.white };
        let drawn = DrawnThumbnail { content, camera: session.camera, lamps, look };
        let is_current = match (&cell.drawn, showing.quality) {
            (None, _) => false,
            (Some(old), Quality::Live) => old.content == drawn.content || !content.is_finished(),
            (Some(old), Quality::Still) => *old == drawn,
        };
        if is_current {
            return Ok(cell.shown());
        }
        if cell.content != Some(content) {
            let values = content.values(session).unwrap_or_default();
            let lighting = VertexLighting::new(canvas.scene, &values)?;
            canvas.renderer.set_light(&cell.buffer, canvas.scene, &lighting)?;
            cell.content = Some(content);
        }
        let frame = Frame {
            model: canvas.model,
            camera: &session.camera.camera(),
            light: Lit::One((&cell.buffer).into()),
            rect_lights: &drawn.lamps,
            look,
            relief: Relief::default(),
            ripple: None,
            wireframe: false,
            grid: false,
            overlay: None,
            sky: canvas.scene.sky().mean(),
            backdrop: canvas.backdrop,
        };
        canvas.renderer.draw(&cell.target, &frame);
        cell.drawn = Some(drawn);
        Ok(cell.shown())
    }
}
