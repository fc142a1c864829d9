//! Irradiance by lumel.

use crate::{Dilation, Filter, LumelLight, LumelLighting, Seams, SolvedLight};
use glam::Vec3;
use lumel_basis::Moment;
use lumel_scene::{Irradiance, Scene, SurfacePoint};
use lumel_uv::{Atlas, Coverage};
use std::borrow::Cow;
use std::sync::Arc;

/// Halves of a sequence of samples complement each other: light is so much more exact than their difference says. Measured: 1.4
/// to 1.7 times in the Cornell box, 1.2 times in the atrium.
pub(crate) const COMPLEMENT: f32 = 1.3;

/// Light on the lumels of an atlas.
#[derive(Clone, Debug)]
pub struct Lightmap {
    /// Where the light of each surface is.
    pub atlas: Arc<Atlas>,
    /// By lumel of all pages: whether it was measured, outside geometry.
    pub valid: Vec<bool>,
    /// At least one: the first is all light.
    pub layers: Vec<LightmapLayer>,
}

/// A part of the light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightmapLayer {
    /// What it is: "irradiance", "direct", "bounce 1".
    pub name: String,
    /// Irradiance by lumel of all pages, W·m⁻², linear Rec. 709.
    pub values: Vec<Vec3>,
}

impl LightmapLayer {
    /// The name of the layer of ambient occlusion, 1 where nothing is near.
    pub const OCCLUSION: &str = "occlusion";

    /// The name of the layer of a coefficient of harmonics, W·m⁻², by its place among them; it may be negative.
    ///
    /// # Panics
    /// If there is no such harmonic.
    pub fn of_harmonic(harmonic: usize) -> String {
        Moment::ALL[1 + harmonic].name().to_owned()
    }

    /// The place of a coefficient among harmonics, if this is the layer of one.
    pub fn harmonic(&self) -> Option<usize> {
        Moment::ALL.into_iter().find(|moment| self.name == moment.name())?.harmonic()
    }

    /// The name of the layer of light after so many reflections.
    pub fn of_bounce(bounce: usize) -> String {
        if bounce == 0 { "direct".to_owned() } else { format!("bounce {bounce}") }
    }
}

impl Lightmap {
    /// What was measured, with seams closed and the light of lumels that were not measured taken from their neighbours; less its
    /// noise if what the `solved` light is at the same lumels is given, of which nothing needs to be known.
    ///
    /// The layers are "irradiance", "direct", "bounce 1" and so on, "tail" if there is one, the coefficients "sh0", "sh1" and so on of
    /// light by direction, from which the same noise is taken, "noisy" if noise was taken off, which
    /// has all light with it, "error", the standard error of all light, and [`OCCLUSION`](LightmapLayer::OCCLUSION) if `openness`
    /// is given, which is treated like light.
    ///
    /// # Panics
    /// If the light is not that of the lumels of the coverage.
    pub fn finished(
        scene: &Scene,
        atlas: &Arc<Atlas>,
        coverage: &Coverage,
        light: &LumelLight,
        solved: Option<&SolvedLight>,
        openness: Option<&LumelLight>,
    ) -> Self {
        let mut lightmap = Self::calmed(atlas, coverage, light, solved);
        lightmap.layers[0].name = "irradiance".to_owned();
        let n_lumels = atlas.lumel_count();
        let on_pages = |name: &str, values: Vec<Vec3>| LightmapLayer {
            name: name.to_owned(),
            values: on_pages(coverage, &values, n_lumels),
        };
        if solved.is_some() {
            let all = (0..light.len()).map(|place| light.irradiance(place)).collect();
            lightmap.layers.push(on_pages("noisy", all));
        }
        let errors = light.noise(atlas, coverage).into_iter().map(Vec3::splat).collect();
        lightmap.layers.push(on_pages("error", errors));
        if let Some(openness) = openness {
            let nothing = SolvedLight::default();
            let solved = solved.map(|_| &nothing);
            let values = Self::calmed(atlas, coverage, openness, solved).layers.swap_remove(0).values;
            lightmap.layers.push(LightmapLayer { name: LightmapLayer::OCCLUSION.to_owned(), values });
        }
        lightmap.finish(scene, coverage);
        lightmap
    }

    /// All light and its parts, less their noise if that is wanted.
    fn calmed(
        atlas: &Arc<Atlas>,
        coverage: &Coverage,
        light: &LumelLight,
        solved: Option<&SolvedLight>,
    ) -> Self {
        let n_lumels = atlas.lumel_count();
        let light = match solved {
            Some(solved) => {
                let shrunk = light.shrunk(atlas, coverage, solved);
                let sources = shrunk.with_fireflies_spread(light, atlas, coverage, solved);
                Cow::Owned(LumelLight { sources, ..shrunk })
            }
            None => Cow::Borrowed(light),
        };
        let all: Vec<Vec3> = (0..light.len()).map(|place| light.irradiance(place)).collect();
        let n_bounces = light.bounces().len();
        let part = |k: usize| if k < n_bounces { LightmapLayer::of_bounce(k) } else { "tail".to_owned() };
        let parts = light.sources.iter().enumerate().map(|(k, source)| (part(k), source));
        let harmonics = light.directional.harmonics.iter().enumerate();
        let harmonics = harmonics.map(|(k, values)| (LightmapLayer::of_harmonic(k), values));
        let layers = std::iter::once((String::new(), &all)).chain(parts).chain(harmonics);
        let layers = layers
            .map(|(name, values)| LightmapLayer { name, values: on_pages(coverage, values, n_lumels) })
            .collect();
        let valid: Vec<bool> = (0..light.len()).map(|place| light.is_valid(place)).collect();
        let valid = on_pages(coverage, &valid, n_lumels);
        let mut lightmap = Self { atlas: Arc::clone(atlas), valid, layers };
        if solved.is_some() {
            let errors: Vec<f32> =
                light.noise(atlas, coverage).iter().map(|error| error / COMPLEMENT).collect();
            lightmap.denoise(coverage, &on_pages(coverage, &errors, n_lumels));
        }
        lightmap
    }

    /// The light of a layer, read bilinearly.
    ///
    /// # Panics
    /// If there is no such layer.
    pub fn lighting(&self, layer: usize) -> LumelLighting<'_> {
        let values = &self.layers[layer].values;
        LumelLighting { atlas: &self.atlas, values, filter: Filter::default() }
    }

    /// The light at a surface point, read bilinearly.
    ///
    /// # Panics
    /// If there is no such layer, or no such triangle in the atlas.
    pub fn at(&self, layer: usize, at: SurfacePoint) -> Irradiance {
        self.lighting(layer).at(at)
    }

    /// Closes the seams of all layers, and gives light to all lumels that were not measured.
    pub fn finish(&mut self, scene: &Scene, coverage: &Coverage) {
        let dilation = Dilation::new(&self.atlas, coverage, &self.valid);
        let seams = Seams::new(scene, &self.atlas, &dilation);
        for layer in &mut self.layers {
            let may_be_negative = layer.harmonic().is_some();
            seams.close(&mut layer.values, if may_be_negative { Vec3::NEG_INFINITY } else { Vec3::ZERO });
            dilation.fill(&mut layer.values);
        }
    }
}

/// Values of the lumels of a coverage among all lumels of the pages; zero elsewhere.
fn on_pages<T: Copy + Default>(coverage: &Coverage, values: &[T], n_lumels: usize) -> Vec<T> {
    let mut all = vec![T::default(); n_lumels];
    for (&lumel, &value) in coverage.lumels().iter().zip(values) {
        all[lumel as usize] = value;
    }
    all
}
