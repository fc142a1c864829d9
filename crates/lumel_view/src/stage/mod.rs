//! The picture of the scene: what has to be redrawn, and when.
//!
//! Everything a picture depends on is compared with the last drawing; when nothing differs, nothing is drawn.

mod blit;
mod content;
mod metered;
mod showing;
mod strip;

pub use blit::ShownPicture;
pub use content::Side;
pub use showing::{Marks, Quality, Showing, Split};
pub use strip::{ShownThumbnail, Thumbnail};

use crate::camera::FlyCamera;
use crate::lights::drawn;
use crate::prefs::{ViewMode, ViewPrefs};
use crate::session::Session;
use crate::values;
use blit::Blit;
use content::Content;
use eframe::egui_wgpu::RenderState;
use lumel::{RectLight, Scene, VertexLighting};
use lumel_render_cpu::Scale;
use lumel_render_gpu::{
    Frame, Gpu, Hidden, LightBuffer, Lit, Look, Model, Overlay, RenderError, Renderer, Samples, Target,
};
use metered::Metered;
use std::sync::{Arc, Mutex, PoisonError};
use strip::{Canvas, Strip};

/// The light of which buffer: that of the scene as a whole or left of the divider, and that right of it.
const LEFT: usize = 0;
const RIGHT: usize = 1;

/// All that a picture depends on.
#[derive(Clone, PartialEq)]
struct Drawn {
    size: [u32; 2],
    samples: Samples,
    camera: FlyCamera,
    contents: [Option<Content>; 2],
    lamps: Vec<RectLight>,
    look: Look,
    wireframe: bool,
    marks: Option<u64>,
    split: Option<f32>,
}

/// The scene on the device.
struct LoadedModel {
    /// The generation of the document that it is of.
    document: u64,
    /// The generation of the albedos that its materials have.
    paint: u64,
    model: Arc<Model>,
}

/// What is drawn into, and shown in the window.
struct ShownTarget {
    target: Target,
    shown: ShownPicture,
}

/// Marks on the device.
struct DrawnMarks {
    generation: u64,
    overlay: Overlay,
}

/// The range of false colours that was read off some content.
struct AutomaticRange {
    of: Content,
    scale: Scale,
    range: [f32; 2],
}

/// The renderer with what it shows.
pub struct Stage {
    state: RenderState,
    renderer: Renderer,
    model: Option<LoadedModel>,
    buffers: Vec<LightBuffer>,
    contents: [Option<Content>; 2],
    target: Option<ShownTarget>,
    blit: Blit,
    drawn: Option<Drawn>,
    overlay: Option<DrawnMarks>,
    strip: Strip,
    exposure: Metered,
    range: Option<AutomaticRange>,
    problems: Arc<Mutex<Vec<String>>>,
    /// Pictures drawn so far, for tests and benchmarks.
    pub pictures: u64,
}

impl Stage {
    /// A stage on the window's device.
    pub fn new(state: RenderState) -> Self {
        let problems: Arc<Mutex<Vec<String>>> = Arc::default();
        let reported = Arc::clone(&problems);
        // Otherwise wgpu panics, and unsaved work goes with the window.
        state.device.on_uncaptured_error(Arc::new(move |error| {
            reported.lock().unwrap_or_else(PoisonError::into_inner).push(error.to_string());
        }));
        let blit = Blit::new(&state);
        let gpu = Gpu::new(&state.adapter, state.device.clone(), state.queue.clone());
        Self {
            renderer: Renderer::new(Arc::new(gpu)),
            state,
            model: None,
            buffers: Vec::new(),
            contents: [None; 2],
            target: None,
            blit,
            drawn: None,
            overlay: None,
            strip: Strip::default(),
            exposure: Metered::default(),
            range: None,
            problems,
            pictures: 0,
        }
    }

    /// What the device has complained of since the last call.
    pub fn take_problems(&self) -> Vec<String> {
        std::mem::take(&mut self.problems.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        self.renderer.gpu()
    }

    /// The exposure in use, stops.
    pub fn stops(&self, view: &ViewPrefs) -> f32 {
        if view.auto_exposure { self.exposure.stops } else { view.stops }
    }

    /// The range of false colours in use; `None` where there are none.
    pub fn range(&self) -> Option<[f32; 2]> {
        match self.drawn.as_ref()?.look {
            Look::FalseColor { range, .. } => Some(range),
            _ => None,
        }
    }

    /// Draws the picture if anything has changed. Returns the picture to show, once there is one.
    ///
    /// # Errors
    /// A scene or a size that the device cannot hold.
    pub fn show(
        &mut self,
        showing: &Showing<'_>,
        size: [u32; 2],
    ) -> Result<Option<ShownPicture>, RenderError> {
        let Some(document) = &showing.session.document else { return Ok(None) };
        self.load(showing.session, &document.scene)?;
        let drawn = self.wanted(showing, size)?;
        if self.drawn.as_ref() == Some(&drawn) {
            return Ok(self.target.as_ref().map(|target| target.shown.clone()));
        }
        self.fit_target(size, drawn.samples)?;
        self.fit_overlay(showing.marks);
        let (Some(LoadedModel { model, .. }), Some(ShownTarget { target, shown })) =
            (&self.model, &self.target)
        else {
            return Ok(None);
        };
        let light = match drawn.split {
            Some(at) => {
                let [left, right] = [LEFT, RIGHT].map(|side| (&self.buffers[side]).into());
                Lit::Split { left, right, at }
            }
            None => Lit::One((&self.buffers[LEFT]).into()),
        };
        let frame = Frame {
            model,
            camera: &showing.session.camera.camera(),
            light,
            rect_lights: &drawn.lamps,
            look: drawn.look,
            wireframe: drawn.wireframe,
            grid: false,
            overlay: self.overlay.as_ref().map(|marks| &marks.overlay),
            sky: document.scene.sky().mean(),
        };
        self.renderer.draw(target, &frame);
        self.pictures += 1;
        self.drawn = Some(drawn);
        Ok(Some(shown.clone()))
    }

    /// A small picture, drawn again if what it shows has changed.
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
    ) -> Result<Option<ShownThumbnail>, RenderError> {
        let Some(document) = &showing.session.document else { return Ok(None) };
        self.load(showing.session, &document.scene)?;
        let Some(LoadedModel { model, .. }) = &self.model else { return Ok(None) };
        let canvas = Canvas { state: &self.state, renderer: &self.renderer, model, scene: &document.scene };
        self.strip.thumbnail(&canvas, showing, wanted).map(Some)
    }

    /// The picture as it was drawn last.
    ///
    /// # Errors
    /// When there is none, or the device fails.
    pub fn picture(&self) -> Result<lumel_render_cpu::Picture, String> {
        let ShownTarget { target, .. } = self.target.as_ref().ok_or("there is no picture yet")?;
        self.renderer.read(target).map_err(|e| crate::document::error_text(&e))
    }

    fn load(&mut self, session: &Session, scene: &Scene) -> Result<(), RenderError> {
        let (document, paint) = (session.document_generation, session.paint_generation);
        if let Some(loaded) = self.model.as_mut().filter(|loaded| loaded.document == document) {
            if loaded.paint != paint {
                self.renderer.repaint(&loaded.model, scene);
                loaded.paint = paint;
            }
            return Ok(());
        }
        self.model = None;
        self.strip = Strip::default();
        let model = self.renderer.upload(scene)?;
        self.buffers = (0..2).map(|_| self.renderer.light(&model)).collect();
        (self.contents, self.drawn, self.range) = ([None; 2], None, None);
        self.exposure = Metered::default();
        self.model = Some(LoadedModel { document, paint, model: Arc::new(model) });
        Ok(())
    }

    /// What is to be drawn, with the light in its buffers.
    fn wanted(&mut self, showing: &Showing<'_>, size: [u32; 2]) -> Result<Drawn, RenderError> {
        let (session, view) = (showing.session, showing.view);
        let left = Content::new(session, Side::Current, view.mode, view.selection);
        self.fill(LEFT, &left, session)?;
        let split = showing.split.filter(|_| left.is_light());
        let right = split.map(|split| Content::new(session, split.right, view.mode, split.selection));
        if let Some(right) = &right {
            self.fill(RIGHT, right, session)?;
        }
        let lamps = drawn(&session.lights);
        let look = self.look(showing, &left, &lamps, size);
        let live = showing.quality == Quality::Live && self.gpu().is_software();
        Ok(Drawn {
            size,
            samples: if view.antialias && !live { Samples::Four } else { Samples::One },
            camera: session.camera,
            contents: [Some(left), right],
            lamps,
            look,
            wireframe: view.wireframe,
            marks: showing.marks.map(|marks| marks.generation),
            split: split.map(|split| split.at),
        })
    }

    fn fill(&mut self, buffer: usize, content: &Content, session: &Session) -> Result<(), RenderError> {
        if self.contents[buffer] == Some(*content) {
            return Ok(());
        }
        let (Some(document), Some(values)) = (&session.document, content.values(session)) else {
            return Ok(());
        };
        let lighting = VertexLighting::new(&document.scene, &values)?;
        self.renderer.set_light(&self.buffers[buffer], &document.scene, &lighting)?;
        self.contents[buffer] = Some(*content);
        Ok(())
    }

    fn look(&mut self, showing: &Showing<'_>, left: &Content, lamps: &[RectLight], size: [u32; 2]) -> Look {
        let view = showing.view;
        let (tone, white) = (view.tone(), view.white);
        match view.mode {
            ViewMode::Final if left.is_preview() => Look::Radiance { stops: 0.0, tone, white },
            ViewMode::Irradiance if left.is_preview() => Look::Irradiance { stops: 0.0, tone, white },
            ViewMode::Final | ViewMode::Irradiance => {
                if view.auto_exposure {
                    // One exposure for all bounces would leave the later ones black: what is shown is what is metered.
                    self.exposure.read(showing, left, lamps, size);
                }
                let stops = self.stops(view);
                if view.mode == ViewMode::Final {
                    Look::Radiance { stops, tone, white }
                } else {
                    Look::Irradiance { stops, tone, white }
                }
            }
            ViewMode::Albedo => Look::Albedo,
            ViewMode::Normals => Look::Normals,
            ViewMode::Validity => Look::Plain,
            ViewMode::StandardError if showing.session.light.standard_error.is_none() => Look::Plain,
            ViewMode::FalseColor | ViewMode::StandardError | ViewMode::TriangleSize => {
                Look::FalseColor { range: self.range_of(showing, left), scale: view.scale() }
            }
        }
    }

    fn range_of(&mut self, showing: &Showing<'_>, left: &Content) -> [f32; 2] {
        let view = showing.view;
        if !view.auto_range && view.mode == ViewMode::FalseColor {
            return view.range;
        }
        let scale = view.scale();
        if let Some(known) = self.range.as_ref().filter(|known| known.of == *left && known.scale == scale) {
            return known.range;
        }
        let values = left.values(showing.session).unwrap_or_default();
        let range = values::automatic_range(&values, scale);
        self.range = Some(AutomaticRange { of: *left, scale, range });
        range
    }

    fn fit_target(&mut self, size: [u32; 2], samples: Samples) -> Result<(), RenderError> {
        if self.target.as_ref().is_some_and(|t| t.target.size() == size && t.target.samples() == samples) {
            return Ok(());
        }
        let target = self.renderer.target(size, samples)?;
        let shown = self.blit.shown(&self.state, target.view());
        self.target = Some(ShownTarget { target, shown });
        Ok(())
    }

    fn fit_overlay(&mut self, marks: Option<&Marks>) {
        let Some(marks) = marks else {
            self.overlay = None;
            return;
        };
        if self.overlay.as_ref().is_none_or(|drawn| drawn.generation != marks.generation) {
            let overlay =
                Overlay::new(self.renderer.gpu(), &marks.points, &marks.lines).with_hidden(Hidden::Faint);
            self.overlay = Some(DrawnMarks { generation: marks.generation, overlay });
        }
    }
}
