//! Noise whose size is known, taken out.

use crate::Lightmap;
use crate::surface::Surface;
use glam::Vec3;
use lumel_scene::luminance;
use lumel_uv::Coverage;
use rayon::prelude::*;

/// Times that lumels are mixed, at distances of 1, 2, 4 and 8.
const PASSES: u32 = 4;

/// Differences in light well beyond this many standard errors are taken for light, not for noise.
const ERRORS: f32 = 2.0;

impl Lightmap {
    /// Mixes the light of each lumel with that around it on its chart, as far as the difference may be noise.
    ///
    /// `errors` has the standard error of the luminance of the first layer by lumel of all pages, W·m⁻². Where it is 0 or no
    /// number, a lumel changes only by the noise of others. A constant keeps its bits. The first layer decides how all layers
    /// are mixed, so that they still add up. Biased: what changes by less than the noise gets smoother.
    ///
    /// After Dammertz, Sewtz, Hanika, Lensch, *Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering*,
    /// 2010; here errors shrink from pass to pass.
    ///
    /// # Panics
    /// If there are fewer errors than lumels.
    pub fn denoise(&mut self, coverage: &Coverage, errors: &[f32]) {
        let valid = |place: usize| self.valid[coverage.lumels()[place] as usize];
        let surface = Surface::new(&self.atlas, coverage, valid);
        let variance = |lumel: usize| Some(errors[lumel].powi(2)).filter(|variance| variance.is_finite());
        let light = |lumel: usize| self.layers.iter().map(move |layer| layer.values[lumel]);
        let mut noisy = Noisy {
            light: surface.lumels().flat_map(light).collect(),
            variances: surface.lumels().map(|lumel| variance(lumel).unwrap_or_default()).collect(),
            n_layers: self.layers.len(),
        };
        for pass in 0..PASSES {
            noisy = noisy.mixed(&surface, 1 << pass);
        }
        for (lumel, light) in surface.lumels().zip(noisy.light.chunks(noisy.n_layers)) {
            let layers = self.layers.iter_mut().zip(light);
            layers.for_each(|(layer, &value)| layer.values[lumel] = value);
        }
    }
}

/// Light that is not known exactly.
struct Noisy {
    /// By place, all layers.
    light: Vec<Vec3>,
    /// Of the luminance of the first layer, by place.
    variances: Vec<f32>,
    n_layers: usize,
}

impl Noisy {
    /// Each place mixed with those around it, by how likely they have the same light.
    fn mixed(&self, surface: &Surface<'_>, reach: i64) -> Self {
        let mut mixed =
            Self { light: self.light.clone(), variances: self.variances.clone(), n_layers: self.n_layers };
        let outputs = mixed.light.par_chunks_mut(self.n_layers).zip(&mut mixed.variances);
        outputs.enumerate().for_each(|(place, (light, variance))| {
            let (mut sum, mut squares) = (0.0, 0.0);
            surface.around(place, reach, |near, weight| {
                let weight = weight * self.likeness(place, near);
                sum += weight;
                squares += weight * weight * self.variances[near];
                // Differences, so that what is equal stays itself.
                for (layer, light) in light.iter_mut().enumerate() {
                    *light += (self.layer(near, layer) - self.layer(place, layer)) * weight;
                }
            });
            // At least the weight of the place itself.
            for (layer, light) in light.iter_mut().enumerate() {
                let before = self.layer(place, layer);
                *light = before + (*light - before) / sum;
            }
            *variance = squares / (sum * sum);
        });
        mixed
    }

    fn layer(&self, place: usize, layer: usize) -> Vec3 {
        self.light[place * self.n_layers + layer]
    }

    /// 1 if two places have the same light, less the more their difference exceeds what errors make.
    fn likeness(&self, a: usize, b: usize) -> f32 {
        let difference = (luminance(self.layer(a, 0)) - luminance(self.layer(b, 0))).abs();
        let error = (2.0 * self.variances[a].min(self.variances[b])).sqrt();
        if difference == 0.0 { 1.0 } else { (-difference / (ERRORS * error)).exp() }
    }
}
