//! Noise whose size is known, taken out.

use crate::Lightmap;
use crate::surface::Surface;
use glam::{Vec3, Vec4};
use lumel_scene::luminance;
use lumel_uv::Coverage;
use rayon::prelude::*;

/// Times that lumels are mixed, at distances of 1, 2, 4 and 8.
const PASSES: u32 = 4;

/// Differences in light well beyond this many standard errors are taken for light, not for noise.
const ERRORS: f32 = 4.0;

/// Noise of this share of the light around is left alone the more the smaller it is: a step of 8 bits is five times as much.
const UNSEEN: f32 = 0.003;

/// Light darker than this share of the mean is compared with it, where noise is relative.
const DARK: f32 = 0.1;

/// How far around a lumel it is decided how much of the mixed light is taken.
const REACHES: [i64; 2] = [1, 2];

/// How far lumels are moved to see what of that remains, in standard errors.
const STIR: f32 = 0.1;

impl Lightmap {
    /// Mixes the light of each lumel with that around it on its chart, as far as the difference may be noise, and as far as that
    /// helps.
    ///
    /// `errors` has the standard error of the luminance of the first layer by lumel of all pages, W·m⁻². Where it is 0 or no
    /// number, a lumel changes only by the noise of others. A constant keeps its bits. The first layer decides how all layers
    /// are mixed, so that they still add up. Biased: what changes by less than the noise gets smoother.
    ///
    /// After Dammertz, Sewtz, Hanika, Lensch, *Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering*,
    /// 2010; here errors shrink from pass to pass. How much of the mixed light is taken is decided where it is by Stein's
    /// unbiased estimate of its error: the filter is run once more on light that was stirred, after Ramani, Blu, Unser,
    /// *Monte-Carlo SURE*, 2008.
    ///
    /// # Panics
    /// If there are fewer errors than lumels.
    pub fn denoise(&mut self, coverage: &Coverage, errors: &[f32]) {
        let valid = |place: usize| self.valid[coverage.lumels()[place] as usize];
        let surface = Surface::new(&self.atlas, coverage, valid);
        let error = |lumel: usize| Some(errors[lumel]).filter(|error| error.is_finite()).unwrap_or_default();
        let errors: Vec<f32> = surface.lumels().map(error).collect();
        let light = |lumel: usize| self.layers.iter().map(move |layer| layer.values[lumel]);
        let variances: Vec<f32> = errors.iter().map(|error| error.powi(2)).collect();
        let noisy = Noisy {
            light: surface.lumels().flat_map(light).collect(),
            variances: variances.clone(),
            n_layers: self.layers.len(),
        };
        let stirs: Vec<f32> =
            errors.iter().enumerate().map(|(place, error)| STIR * error * sign(place)).collect();
        let stirred = Noisy {
            light: stirs.iter().enumerate().map(|(place, stir)| noisy.layer(place, 0) + *stir).collect(),
            variances,
            n_layers: 1,
        };
        let (mixed, stirred) = (noisy.mixed_all(&surface), stirred.mixed_all(&surface));
        // What of the noise of a lumel stays in its mixed light.
        let kept = |place: usize| (stirred.brightness(place) - mixed.brightness(place)) / stirs[place];
        let benefit = |place: usize| {
            let noise = errors[place].powi(2);
            let removed = if stirs[place] == 0.0 { 0.0 } else { noise * (1.0 - kept(place)) };
            let change = (mixed.brightness(place) - noisy.brightness(place)).powi(2);
            Vec4::new(removed, change, noise, noisy.brightness(place))
        };
        let mut benefits: Vec<Vec4> = (0..errors.len()).into_par_iter().map(benefit).collect();
        let mean = benefits.iter().map(|benefit| f64::from(benefit.w)).sum::<f64>() / errors.len() as f64;
        for reach in REACHES {
            benefits = surface.means(&benefits, reach);
        }
        for (place, lumel) in surface.lumels().enumerate() {
            let share = share(benefits[place], mean as f32) * surface.trust(place, &REACHES);
            for (index, layer) in self.layers.iter_mut().enumerate() {
                let value = &mut layer.values[lumel];
                *value += (mixed.layer(place, index) - *value) * share;
            }
        }
    }
}

/// The share of mixed light with which the mean square error around a lumel is least, by Stein's estimate: how much of the variance
/// of the noise mixing takes out, over the mean square of what it changes. Less where noise is not seen.
fn share(benefit: Vec4, mean: f32) -> f32 {
    let [removed, change, noise, light] = benefit.to_array();
    if removed <= 0.0 || change <= 0.0 || noise <= 0.0 {
        return 0.0;
    }
    let unseen = (UNSEEN * light.max(DARK * mean)).powi(2);
    (removed / change).min(1.0) * noise / (noise + unseen)
}

/// 1 or −1, as if by chance.
fn sign(place: usize) -> f32 {
    let mixed = (place as u32 ^ 0x5bd1_e995).wrapping_mul(0x9e37_79b9);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x85eb_ca6b);
    if (mixed ^ mixed >> 13) & 1 == 0 { 1.0 } else { -1.0 }
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
    /// Mixed in all passes.
    fn mixed_all(&self, surface: &Surface<'_>) -> Self {
        let first = self.mixed(surface, 1);
        (1..PASSES).fold(first, |noisy, pass| noisy.mixed(surface, 1 << pass))
    }

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

    /// The luminance of the first layer.
    fn brightness(&self, place: usize) -> f32 {
        luminance(self.layer(place, 0))
    }

    /// 1 if two places have the same light, less the more their difference exceeds what errors make.
    fn likeness(&self, a: usize, b: usize) -> f32 {
        let difference = (self.brightness(a) - self.brightness(b)).abs();
        let error = (2.0 * self.variances[a].min(self.variances[b])).sqrt();
        if difference == 0.0 { 1.0 } else { (-difference / (ERRORS * error)).exp() }
    }
}
