//! Where the lumels of the open scene lie.

use crate::document::{Document, OpenRequest, error_text};
use glam::Vec3;
use lumel::{LumelParts, Lumels, MaxEdge, OpenOptions, Preset, Scene};
use lumel_lightmap::{Dilation, Seams};
use lumel_uv::{Atlas, Density, Pace, Report, UnwrapSettings, Unwrapped, unwrap};
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// After this, objects that are left get simple charts.
const PATIENCE: Duration = Duration::from_secs(120);

/// Lumels that stay free between charts: bicubic reading needs so many.
const GUTTER: u32 = 3;

/// Lumels that are measured together: few, so that the picture changes often.
const PART: usize = 1 << 13;

/// Where light is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LightBasis {
    /// At the vertices.
    #[default]
    Vertices,
    /// At the vertices, and then on the lumels of a lightmap.
    Lightmap,
}

/// How many lumels there are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum LumelCount {
    /// About so many on all pages together.
    Budget(u32),
    /// Lumels per metre.
    PerMetre(f32),
}

/// What a lightmap is to be like.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LumelSettings {
    /// Whether there is to be one.
    pub basis: LightBasis,
    /// How fine it is.
    pub count: LumelCount,
    /// The largest width and height of a page, lumels.
    pub page_size: u32,
    /// Whether noise is taken off.
    pub denoises: bool,
}

/// The offered budgets and densities.
pub const BUDGETS: [u32; 2] = [1 << 10, 1 << 24];
/// Lumels per metre.
pub const DENSITIES: [f32; 2] = [0.01, 10_000.0];
/// Sides of pages.
pub const PAGE_SIZES: [u32; 6] = [256, 512, 1024, 2048, 4096, 8192];

impl Default for LumelSettings {
    fn default() -> Self {
        Self {
            basis: LightBasis::default(),
            count: LumelCount::Budget(Preset::default().lumel_budget()),
            page_size: 2048,
            denoises: true,
        }
    }
}

impl LumelSettings {
    /// What was kept, with what makes no sense made good.
    #[must_use]
    pub fn mended(self) -> Self {
        let default = Self::default();
        let count = match self.count {
            LumelCount::Budget(n) => LumelCount::Budget(n.clamp(BUDGETS[0], BUDGETS[1])),
            LumelCount::PerMetre(density) if density.is_finite() => {
                LumelCount::PerMetre(density.clamp(DENSITIES[0], DENSITIES[1]))
            }
            LumelCount::PerMetre(_) => default.count,
        };
        let page_size = if PAGE_SIZES.contains(&self.page_size) { self.page_size } else { default.page_size };
        Self { count, page_size, ..self }
    }
}

/// What decides a layout: equal ones need no new one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayoutKey {
    /// The generation of the document.
    pub document: u64,
    /// How fine it is.
    pub count: LumelCount,
    /// The largest side of a page.
    pub page_size: u32,
    /// The generation of the triangles that it is shown on.
    pub mesh: u64,
}

impl LayoutKey {
    /// Whether the lumels are the same, on whatever triangles they are shown.
    pub fn has_lumels_of(&self, other: &Self) -> bool {
        *self == Self { mesh: self.mesh, ..*other }
    }
}

/// Where the lumels of a scene lie.
#[derive(Debug)]
pub struct Layout {
    /// What it was made for.
    pub key: LayoutKey,
    /// The lumels of the scene as it is in its files, with no edge split.
    pub lumels: Lumels,
    /// The same places for the triangles of the open scene.
    pub refined: Atlas,
    /// Which lumels are read along seams.
    pub along_seams: Arc<[u32]>,
    /// How it went.
    pub report: Arc<Report>,
    /// The rays of its lumels, once they were traced, as far as they are kept.
    pub parts: Mutex<LumelParts>,
}

fn no_parts() -> LumelParts {
    let mut parts = LumelParts::default();
    parts.most = PART;
    parts
}

impl Layout {
    /// Unwraps the scene of a request as it is in its files; `open` is the same scene with long edges split.
    ///
    /// # Errors
    /// A file that cannot be read or has changed, and [`AtomicBool`] `stop`.
    pub fn new(
        request: &OpenRequest,
        open: &Scene,
        key: LayoutKey,
        stop: &AtomicBool,
    ) -> Result<Self, String> {
        let options = OpenOptions { max_edge: Some(MaxEdge::Off), ..request.options.clone() };
        let opened = lumel::open(&request.name, &options).map_err(|e| error_text(&e))?;
        let whole = Arc::new(opened.builder.build().map_err(|e| error_text(&e))?.0);
        let same =
            whole.object_names() == open.object_names() && whole.materials().len() == open.materials().len();
        if !same {
            return Err(format!("the file has changed; reload the scene: {}", request.name));
        }
        let settings = UnwrapSettings {
            density: match key.count {
                LumelCount::Budget(lumels) => Density::Budget(lumels),
                LumelCount::PerMetre(density) => Density::PerMetre(density),
            },
            page_size: key.page_size,
            gutter: GUTTER,
            ..UnwrapSettings::default()
        };
        let begun = Instant::now();
        let pace = || match () {
            () if stop.load(Ordering::Relaxed) => Pace::Stop,
            () if begun.elapsed() > PATIENCE => Pace::Hurry,
            () => Pace::Go,
        };
        let Unwrapped { atlas, report } = unwrap(&whole, &settings, &pace).map_err(|e| error_text(&e))?;
        let refined = atlas.refined(&whole, open);
        let lumels = Lumels::new(whole, atlas);
        let mut valid = vec![false; lumels.atlas.lumel_count()];
        lumels.coverage.lumels().iter().for_each(|&lumel| valid[lumel as usize] = true);
        let dilation = Dilation::new(&lumels.atlas, &lumels.coverage, &valid);
        let along_seams = Seams::new(&lumels.scene, &lumels.atlas, &dilation).lumels().collect();
        let report = Arc::new(report);
        Ok(Self { key, lumels, refined, along_seams, report, parts: Mutex::new(no_parts()) })
    }

    /// The same lumels on other triangles of the open scene.
    #[must_use]
    pub fn on(&self, open: &Scene, key: LayoutKey) -> Self {
        let refined = self.lumels.atlas.refined(&self.lumels.scene, open);
        let (lumels, along_seams, report) =
            (self.lumels.clone(), Arc::clone(&self.along_seams), Arc::clone(&self.report));
        // Rays end on the triangles that were.
        Self { key, lumels, refined, along_seams, report, parts: Mutex::new(no_parts()) }
    }

    /// The scene as it is in its files, with the albedos that the open one has.
    pub fn scene_like(&self, document: &Document) -> Scene {
        let albedos: Vec<Vec3> = document.scene.materials().iter().map(|material| material.albedo).collect();
        self.lumels.scene.repainted(&albedos)
    }

    /// What it is, in a few words.
    pub fn summary(&self) -> String {
        let atlas = &self.lumels.atlas;
        let pages = match atlas.pages() {
            [[width, height]] => format!("a page of {width} × {height}"),
            pages => format!("{} pages", pages.len()),
        };
        let charts = crate::values::grouped(atlas.charts().len());
        format!(
            "{} lumels on {pages}, {} per metre, {charts} charts, {:.0} % used",
            crate::values::grouped(self.lumels.coverage.len()),
            crate::values::significant(atlas.density()),
            100.0 * self.report.utilization
        )
    }
}
