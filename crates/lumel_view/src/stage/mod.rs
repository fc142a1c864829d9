//! The picture of the scene: what has to be redrawn, and when.
//!
//! Everything a picture depends on is compared with the last drawing; when nothing differs, nothing is drawn.

mod blit;
mod content;
mod lumels;
mod metered;
mod points;
mod showing;
mod sky;
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
use lumel::{MaterialId, Moment, RectLight, Scene, Sky, VertexLighting};
use lumel_lightmap::Filter;
use lumel_render_cpu::{Relief, Ripple, Rippled, Scale};
use lumel_render_gpu::{
    Frame, Gpu, LightBuffer, Lit, Look, Model, Overlay, RenderError, Renderer, Samples, Target, Values,
};
use lumels::{LumelContent, ShownLumels};
use metered::Metered;
use points::{PointContent, ShownPoints};
use sky::ShownSky;
use std::sync::{Arc, Mutex, PoisonError};
use strip::{Canvas, Strip};

/// The light of which buffer: that of the scene as a whole or left of the divider, and that right of it.
const LEFT: usize = 0;
const RIGHT: usize = 1;

/// The colours of bends of light: from a tenth of what they may be to ten times that.
const BENDS: [f32; 2] = [0.1, 10.0];

/// A software renderer draws at most so many pixels of a picture that changes with every frame. Much fewer would hardly be faster:
/// it shades blocks of 4 x 4 pixels, however small the part of them that a triangle covers.
const LIVE_PIXELS: f64 = 150_000.0;

/// The same where light of scattered points is gathered at each.
const LIVE_PIXELS_OF_POINTS: f64 = 0.25 * LIVE_PIXELS;

/// The size of such a picture in an area of the window: the same shape with fewer pixels.
fn live_size(area: [u32; 2], pixels: f64) -> [u32; 2] {
    let scale = (pixels / area.map(f64::from).iter().product::<f64>()).sqrt().min(1.0);
    area.map(|side| ((f64::from(side) * scale) as u32).max(1))
}

/// All that a picture depends on.
#[derive(Clone, PartialEq)]
struct Drawn {
    /// Of the window's area that it fills, pixels.
    area: [u32; 2],
    size: [u32; 2],
    samples: Samples,
    camera: FlyCamera,
    contents: [Option<Content>; 2],
    lumels: Option<LumelContent>,
    points: Option<PointContent>,
    filter: Filter,
    lamps: Vec<RectLight>,
    look: Look,
    wireframe: bool,
    grid: bool,
    marks: Option<u64>,
    split: Option<(Side, f32)>,
    relief: Relief,
    ripple: Option<(Ripple, Vec<MaterialId>)>,
    sky: Sky,
}

impl Drawn {
    /// Whether it is the same picture with more pixels or smoother edges.
    fn is_finer_than(&self, other: &Self) -> bool {
        (self.size == self.area || self.samples == Samples::Four)
            && *self == Self { samples: self.samples, size: self.size, ..other.clone() }
    }
}

/// The scene on the device.
struct LoadedModel {
    /// The generation of the document that it is of.
    document: u64,
    /// The generation of its triangles.
    mesh: u64,
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
    lumels: Option<LumelContent>,
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
    lumels: Option<ShownLumels>,
    points: Option<ShownPoints>,
    target: Option<ShownTarget>,
    blit: Blit,
    drawn: Option<Drawn>,
    overlay: Option<DrawnMarks>,
    sky: ShownSky,
    strip: Strip,
    exposure: Metered,
    range: Option<AutomaticRange>,
    problems: Arc<Mutex<Vec<String>>>,
    /// Pictures drawn so far, for tests and benchmarks.
    pub pictures: u64,
    /// Tiles of lumels uploaded so far, likewise.
    pub tiles: u64,
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
            lumels: None,
            points: None,
            target: None,
            blit,
            drawn: None,
            overlay: None,
            sky: ShownSky::default(),
            strip: Strip::default(),
            exposure: Metered::default(),
            range: None,
            problems,
            pictures: 0,
            tiles: 0,
        }
    }

    /// What the device has complained of since the last call.
    pub fn take_problems(&self) -> Vec<String> {
        std::mem::take(&mut self.problems.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn report(&self, problem: String) {
        self.problems.lock().unwrap_or_else(PoisonError::into_inner).push(problem);
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

    /// Bytes that the directions of light on lumels take on the device, if those are shown.
    pub fn bytes_of_directions(&self) -> Option<u64> {
        self.lumels.as_ref().and_then(ShownLumels::bytes_of_directions)
    }

    /// Draws the picture if anything has changed. Returns the picture to show, once there is one.
    ///
    /// # Errors
    /// A scene or a size that the device cannot hold.
    pub fn show(
        &mut self,
        showing: &Showing<'_>,
        area: [u32; 2],
    ) -> Result<Option<ShownPicture>, RenderError> {
        let Some(document) = &showing.session.document else { return Ok(None) };
        self.load(showing.session, &document.scene)?;
        let drawn = self.wanted(showing, area)?;
        // What is there is not drawn again to be worse.
        let is_better = |last: &Drawn| {
            (showing.view.antialias || last.samples == drawn.samples) && last.is_finer_than(&drawn)
        };
        if self.drawn.as_ref().is_some_and(|last| *last == drawn || is_better(last)) {
            return Ok(self.target.as_ref().map(|target| target.shown.clone()));
        }
        self.fit_target(drawn.size, drawn.samples)?;
        self.fit_overlay(showing.marks);
        if let Err(problem) = self.sky.fill(&self.renderer, &drawn.sky) {
            self.report(problem.to_string());
        }
        let (Some(LoadedModel { model, .. }), Some(ShownTarget { target, shown })) =
            (&self.model, &self.target)
        else {
            return Ok(None);
        };
        let vertices = &self.buffers[LEFT];
        let lumels = self.lumels.as_ref().filter(|_| drawn.lumels.is_some());
        let points = drawn.points.zip(self.points.as_ref().and_then(ShownPoints::buffer));
        let left = match (lumels, points) {
            (Some(shown), _) => Values::Lumels { lumels: &shown.buffer, filter: drawn.filter, vertices },
            (None, Some((PointContent { finest, .. }, points))) => {
                Values::Points { points, finest, vertices }
            }
            (None, None) => Values::Vertices(vertices),
        };
        let light = match drawn.split {
            Some((Side::Smooth, at)) => Lit::Smooth { light: left, at },
            Some((_, at)) => Lit::Split { left, right: Values::Vertices(&self.buffers[RIGHT]), at },
            None => Lit::One(left),
        };
        let frame = Frame {
            model,
            camera: &showing.session.camera.camera(),
            light,
            rect_lights: &drawn.lamps,
            look: drawn.look,
            relief: drawn.relief,
            ripple: drawn.ripple.as_ref().map(|(ripple, materials)| Rippled { ripple: *ripple, materials }),
            wireframe: drawn.wireframe,
            grid: drawn.grid,
            overlay: self.overlay.as_ref().map(|marks| &marks.overlay),
            sky: drawn.sky.mean(),
            backdrop: self.sky.backdrop(),
        };
        self.renderer.draw(target, &frame);
        self.pictures += 1;
        self.drawn = Some(drawn);
        Ok(Some(shown.clone()))
    }

    /// A small picture, drawn again if what it shows has changed.
    ///
    /// While something moves or a solve runs, only new content is drawn, and not in the first frame that asks for it: the
    /// processor's time belongs to the large picture and to the solve. `None` if nothing was drawn yet.
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
        let Self { state, blit, renderer, model, strip, sky, .. } = self;
        let Some(LoadedModel { model, .. }) = model else { return Ok(None) };
        let canvas =
            Canvas { state, blit, renderer, model, scene: &document.scene, backdrop: sky.backdrop() };
        strip.thumbnail(&canvas, showing, wanted)
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
        let (document, mesh) = (session.document_generation, session.mesh_generation);
        let paint = session.paint_generation;
        let layout = session.layout();
        let has_layout = |lumels: &Option<ShownLumels>| match layout {
            Some(layout) => lumels.as_ref().is_some_and(|lumels| Arc::ptr_eq(lumels.layout(), layout)),
            None => true,
        };
        let is_there = |loaded: &&mut LoadedModel| {
            loaded.document == document && loaded.mesh == mesh && has_layout(&self.lumels)
        };
        if let Some(loaded) = self.model.as_mut().filter(is_there) {
            if loaded.paint != paint {
                self.renderer.repaint(&loaded.model, scene);
                loaded.paint = paint;
            }
            return Ok(());
        }
        (self.model, self.lumels) = (None, None);
        self.strip = Strip::default();
        let model = match layout {
            Some(layout) => {
                self.lumels = Some(ShownLumels::new(&self.renderer, layout)?);
                self.renderer.upload_with_atlas(scene, &layout.refined)?
            }
            None => self.renderer.upload(scene)?,
        };
        self.buffers = (0..2).map(|_| self.renderer.light(&model)).collect();
        (self.contents, self.drawn, self.range) = ([None; 2], None, None);
        self.exposure = Metered::default();
        self.model = Some(LoadedModel { document, mesh, paint, model: Arc::new(model) });
        Ok(())
    }

    /// What is to be drawn, with the light in its buffers.
    fn wanted(&mut self, showing: &Showing<'_>, area: [u32; 2]) -> Result<Drawn, RenderError> {
        let (session, view) = (showing.session, showing.view);
        let left = Content::new(session, Side::Current, view, view.selection);
        let points = self.fill_points(session, view, &left);
        self.fill(LEFT, &left.beside(points.as_ref()), session)?;
        let split = showing.split.filter(|split| match split.right {
            Side::Smooth => left.is_light() || view.mode == ViewMode::Normals,
            Side::Current | Side::Kept(_) => left.is_light(),
        });
        let other = split.filter(|split| split.right != Side::Smooth);
        let right = other.map(|split| Content::new(session, split.right, view, split.selection));
        if let Some(right) = &right {
            self.fill(RIGHT, right, session)?;
        }
        let lumels = LumelContent::new(session, view.mode, view.selection);
        if let (Some(content), Some(shown)) = (&lumels, &mut self.lumels) {
            self.tiles += shown.fill(&self.renderer, session, content);
            shown.fill_directions(&self.renderer, session, content, view.relief.on);
        }
        let is_smooth = lumels.as_ref().is_some_and(LumelContent::is_smooth);
        let lamps = drawn(&session.lights);
        let look = self.look(showing, (&left, lumels.as_ref()), &lamps, area);
        let live = showing.quality == Quality::Live && self.gpu().is_software();
        let live_pixels = if points.is_some() { LIVE_PIXELS_OF_POINTS } else { LIVE_PIXELS };
        Ok(Drawn {
            area,
            size: if live { live_size(area, live_pixels) } else { area },
            samples: if view.antialias && !live { Samples::Four } else { Samples::One },
            camera: session.camera,
            contents: [Some(left), right],
            lumels,
            points,
            filter: if is_smooth { view.filter.into() } else { Filter::Nearest },
            lamps,
            look,
            wireframe: view.wireframe,
            grid: view.grid && session.layout().is_some(),
            marks: showing.marks.map(|marks| marks.generation),
            split: split.map(|split| (split.right, split.at)),
            relief: view.relief.relief(),
            ripple: showing.ripple.map(|ripple| (ripple, session.rippled_materials())),
            sky: session.sky.sky.clone(),
        })
    }

    /// What is shown of light at scattered points, with that light in their buffer.
    fn fill_points(&mut self, session: &Session, view: &ViewPrefs, left: &Content) -> Option<PointContent> {
        let content = PointContent::new(session, view).filter(|_| left.is_light())?;
        let light = session.light.points.as_ref()?;
        if let Err(problem) = ShownPoints::fill(&mut self.points, &self.renderer, light, &content) {
            self.report(problem);
        }
        self.points.as_ref()?.buffer().map(|_| content)
    }

    fn fill(&mut self, buffer: usize, content: &Content, session: &Session) -> Result<(), RenderError> {
        if self.contents[buffer] == Some(*content) {
            return Ok(());
        }
        let (Some(document), Some(values)) = (&session.document, content.values(session)) else {
            return Ok(());
        };
        let directional = content.directional(session);
        let lighting =
            VertexLighting::new(&document.scene, &values)?.with_incident(directional.as_deref())?;
        self.renderer.set_light(&self.buffers[buffer], &document.scene, &lighting)?;
        self.contents[buffer] = Some(*content);
        Ok(())
    }

    fn look(
        &mut self,
        showing: &Showing<'_>,
        (left, lumels): (&Content, Option<&LumelContent>),
        lamps: &[RectLight],
        size: [u32; 2],
    ) -> Look {
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
            ViewMode::Validity | ViewMode::Chequerboard | ViewMode::Charts | ViewMode::Seams => Look::Plain,
            ViewMode::StandardError if lumels.is_none() && showing.session.light.standard_error.is_none() => {
                Look::Plain
            }
            ViewMode::Bends if showing.session.document.as_ref().is_none_or(|d| d.indicator.is_none()) => {
                Look::Plain
            }
            ViewMode::Unshot if showing.session.unshot().is_none() => Look::Plain,
            ViewMode::LumelDensity if lumels.is_none() => Look::Plain,
            ViewMode::Moment(moment) if !left.knows(moment, showing.session) => Look::Plain,
            ViewMode::Moment(Moment::Direction) => Look::Vectors,
            ViewMode::FalseColor
            | ViewMode::StandardError
            | ViewMode::Unshot
            | ViewMode::TriangleSize
            | ViewMode::Bends
            | ViewMode::LumelDensity
            | ViewMode::Moment(_) => {
                // That of light is the same, wherever it is stored.
                let lumels = lumels.filter(|_| view.mode != ViewMode::FalseColor);
                Look::FalseColor { range: self.range_of(showing, left, lumels), scale: view.scale() }
            }
        }
    }

    fn range_of(&mut self, showing: &Showing<'_>, left: &Content, lumels: Option<&LumelContent>) -> [f32; 2] {
        let view = showing.view;
        if !view.auto_range && view.mode == ViewMode::FalseColor {
            return view.range;
        }
        if let (ViewMode::LumelDensity, Some(layout)) = (view.mode, showing.session.layout()) {
            let density = layout.lumels.atlas.density();
            return [0.5 * density, 2.0 * density];
        }
        if view.mode == ViewMode::Bends {
            return BENDS;
        }
        let scale = view.scale();
        let lumels = lumels.copied();
        let is_known =
            |known: &&AutomaticRange| known.of == *left && known.lumels == lumels && known.scale == scale;
        if let Some(known) = self.range.as_ref().filter(is_known) {
            return known.range;
        }
        let values = match self.lumels.as_ref().filter(|_| lumels.is_some()) {
            Some(shown) => shown.known(),
            None => left.values(showing.session).unwrap_or_default(),
        };
        let range = match view.mode {
            ViewMode::Moment(_) => values::signed_range(&values),
            _ => values::automatic_range(&values, scale),
        };
        self.range = Some(AutomaticRange { of: *left, lumels, scale, range });
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
                Overlay::new(self.renderer.gpu(), &marks.points, &marks.lines).with_hidden(marks.hidden);
            self.overlay = Some(DrawnMarks { generation: marks.generation, overlay });
        }
    }
}
