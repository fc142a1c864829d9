//! Small pictures of the terms of the series.

use super::metered::stops_for;
use super::{Content, Metered, Quality, Showing, Side, Stage, show_target};
use crate::camera::FlyCamera;
use crate::lights::shining;
use crate::prefs::ViewMode;
use crate::selection::Selection;
use eframe::egui::TextureId;
use lumel::RectLight;
use lumel_render_gpu::{Frame, LightBuffer, Lit, Look, RenderError, Samples, Target};

/// What a small picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thumbnail {
    /// Its place in the strip.
    pub index: usize,
    /// Some bounces; nothing for what emits.
    pub selection: Option<Selection>,
    /// Whether lamps are drawn: bounces are what arrives on surfaces, so only emission and the sum show what glows.
    pub glows: bool,
    /// Its size, pixels.
    pub size: [u32; 2],
}

/// All of them.
#[derive(Default)]
pub(super) struct Strip {
    cells: Vec<Cell>,
    exposure: Metered,
}

struct Cell {
    target: Target,
    texture: TextureId,
    buffer: LightBuffer,
    content: Option<Content>,
    drawn: Option<Drawn>,
    /// How many stops brighter this content is shown than all light.
    brighter: Option<(Content, f32)>,
}

/// All that a small picture depends on.
#[derive(Clone, PartialEq)]
struct Drawn {
    content: Content,
    camera: FlyCamera,
    lamps: Vec<RectLight>,
    look: Look,
}

impl Stage {
    /// A small picture, drawn anew if what it shows has changed, and by how many stops it is brightened.
    ///
    /// While something moves or a solve runs, only new content is drawn: the processor's time belongs to the large
    /// picture and to the solve.
    ///
    /// # Errors
    /// As [`Stage::show`].
    pub fn thumbnail(
        &mut self,
        showing: &Showing<'_>,
        wanted: &Thumbnail,
    ) -> Result<Option<(TextureId, f32)>, RenderError> {
        let session = showing.session;
        let Some(document) = &session.document else { return Ok(None) };
        self.load(session, &document.scene)?;
        if session.is_light_in_motion()
            && let Some(cell) = self.strip.cells.get(wanted.index)
            && let (Some(_), Some((_, brighter))) = (&cell.drawn, cell.brighter)
        {
            // All of them change with each step of the hand; they are drawn when it rests.
            return Ok(Some((cell.texture, brighter)));
        }
        let Some((_, model)) = self.model.clone() else { return Ok(None) };
        let selection = wanted.selection.unwrap_or(Selection::NONE);
        let content = Content::new(session, Side::Current, ViewMode::FalseColor, selection);
        let lamps = shining(&session.lights);
        // That of all light, whichever bounces the large picture shows.
        let all = Content::new(session, Side::Current, ViewMode::FalseColor, Selection::All);
        if showing.view.auto_exposure {
            self.strip.exposure.read(showing, &all, &lamps, wanted.size);
        }
        let base = if showing.view.auto_exposure { self.strip.exposure.stops } else { showing.view.stops };
        let lamps = if wanted.glows { lamps } else { Vec::new() };
        while self.strip.cells.len() <= wanted.index {
            let target = self.renderer.target(wanted.size, Samples::One)?;
            let texture = show_target(&self.state, &target, None);
            let buffer = self.renderer.light(&model);
            self.strip.cells.push(Cell {
                target,
                texture,
                buffer,
                content: None,
                drawn: None,
                brighter: None,
            });
        }
        let cell = &mut self.strip.cells[wanted.index];
        if cell.target.size() != wanted.size {
            cell.target = self.renderer.target(wanted.size, Samples::One)?;
            show_target(&self.state, &cell.target, Some(cell.texture));
            cell.drawn = None;
        }
        let known = cell.brighter.filter(|(of, _)| *of == content).map(|(_, brighter)| brighter);
        let brighter = match known {
            Some(brighter) => brighter,
            // What emits and the sum have the exposure of the sum.
            None if wanted.glows => 0.0,
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
        let drawn = Drawn { content, camera: session.camera, lamps, look };
        let is_current = match (&cell.drawn, showing.quality) {
            (None, _) => false,
            (Some(old), Quality::Live) => old.content == drawn.content || !content.is_finished(),
            (Some(old), Quality::Still) => *old == drawn,
        };
        if is_current {
            return Ok(Some((cell.texture, brighter)));
        }
        if cell.content != Some(content) {
            self.renderer.set_light(&cell.buffer, &content.values(session).unwrap_or_default())?;
            cell.content = Some(content);
        }
        let frame = Frame {
            model: &model,
            camera: &session.camera.camera(),
            light: Lit::One(&cell.buffer),
            lamps: &drawn.lamps,
            look,
            wireframe: false,
            overlay: None,
            sky: document.scene.sky(),
        };
        self.renderer.draw(&cell.target, &frame);
        cell.drawn = Some(drawn);
        Ok(Some((cell.texture, brighter)))
    }
}
