//! What an unwrap can be asked for.

use crate::UvError;
use lumel_scene::{ObjectId, Scene};

/// The largest side of a page, lumels: what graphics devices take.
pub const MAX_PAGE: u32 = 16384;

/// How an atlas is made.
#[derive(Clone, Debug, PartialEq)]
pub struct UnwrapSettings {
    /// How fine lumels are.
    pub density: Density,
    /// What multiplies the density of each object; objects beyond the end of the list have
    /// [what the scene says](lumel_scene::Scene::density_factors).
    pub factors: Vec<f32>,
    /// The largest width and height of a page, lumels. What does not fit is on further pages.
    pub page_size: u32,
    /// Lumels whose centres are nearer to a chart than half of this are its own: 2 if light is read bilinearly, 3 if
    /// bicubically.
    pub gutter: u32,
    /// Charts share no block of this many lumels: 1, or 4 for formats that compress blocks.
    pub align: u32,
    /// What becomes of the layouts that files give.
    pub given: GivenUvs,
}

/// What becomes of the [lightmap coordinates](lumel_scene::ObjectMesh::lightmap_uvs) that objects have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GivenUvs {
    /// An object keeps its own if they can be used: in the square from 0 to 1, without overlaps, with the gutter between
    /// charts. It is put on a page as one piece, and so is each of its instances. If all objects together fill one square
    /// like that, it is the page.
    #[default]
    Keep,
    /// All objects get new ones.
    Ignore,
}

/// How fine lumels are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Lumels per metre.
    PerMetre(f32),
    /// As fine as this many lumels on all pages together allow.
    Budget(u32),
}

impl Default for UnwrapSettings {
    /// A million lumels on pages of up to 2048, for bilinear reading.
    fn default() -> Self {
        Self {
            density: Density::Budget(1 << 20),
            factors: Vec::new(),
            page_size: 2048,
            gutter: 2,
            align: 1,
            given: GivenUvs::Keep,
        }
    }
}

impl UnwrapSettings {
    /// What multiplies the density of an object.
    pub(crate) fn factor(&self, scene: &Scene, object: ObjectId) -> f64 {
        let factor = self.factors.get(object.index()).or(scene.density_factors().get(object.index()));
        factor.map_or(1.0, |&factor| f64::from(factor))
    }

    /// Checks that all settings are within their bounds.
    ///
    /// # Errors
    /// [`UvError::Setting`] for the first that is not.
    pub fn check(&self) -> Result<(), UvError> {
        let refuse = |setting, value: f64, expected| Err(UvError::Setting { setting, value, expected });
        let is_positive = |x: f32| x > 0.0 && x.is_finite();
        match self.density {
            Density::PerMetre(density) if !is_positive(density) => {
                return refuse("density", f64::from(density), "above 0");
            }
            Density::Budget(0) => return refuse("number of lumels", 0.0, "above 0"),
            _ => {}
        }
        if let Some(&factor) = self.factors.iter().find(|&&factor| !is_positive(factor)) {
            return refuse("density factor", f64::from(factor), "above 0");
        }
        if self.gutter > 16 {
            return refuse("gutter", f64::from(self.gutter), "0 to 16");
        }
        if !matches!(self.align, 1 | 4) {
            return refuse("alignment", f64::from(self.align), "1 or 4");
        }
        if !(64..=MAX_PAGE).contains(&self.page_size) || !self.page_size.is_multiple_of(4) {
            return refuse("page size", f64::from(self.page_size), "a multiple of 4 from 64 to 16384");
        }
        Ok(())
    }
}

/// What a caller that watches the clock says when it is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// There is time.
    Go,
    /// Time is up: end quickly. Objects that are not unwrapped yet get the simple charts, and the report names them.
    Hurry,
    /// Stop; there is no result.
    Stop,
}
