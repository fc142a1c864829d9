//! Noise whose size is known, taken out.

use crate::Lightmap;
use crate::charts::charts;
use crate::nearest::NONE;
use glam::Vec3;
use lumel_scene::luminance;
use lumel_uv::{Atlas, Coverage};
use rayon::prelude::*;

/// Times that lumels are mixed, at distances of 1, 2, 4 and 8.
const PASSES: u32 = 4;

/// Differences in light well beyond this many standard errors are taken for light, not for noise.
const ERRORS: f32 = 2.0;

/// A cubic B-spline at whole numbers, which weighs neighbours along each axis.
const SPLINE: [f32; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];

/// The median of how far a normally distributed number lies from its mean, in standard deviations.
const MEDIAN: f32 = 0.6745;

impl Lightmap {
    /// The standard error of each lumel from differences of one pair of estimates each, halved: what those around it on its chart
    /// say together.
    ///
    /// It is the median, so that a hard edge of light, which few lumels lie on, counts as light and not as noise.
    ///
    /// # Panics
    /// If there are fewer errors than lumels.
    pub fn pooled(&self, coverage: &Coverage, errors: &[f32]) -> Vec<f32> {
        let surface = Surface::new(&self.atlas, coverage, &self.valid);
        let lumels = &surface.lumels;
        let pooled = |place: usize| {
            let mut near = Vec::with_capacity(SPLINE.len() * SPLINE.len());
            surface.around(place, 1, |place, _| near.push(errors[lumels[place] as usize]));
            let middle = near.len() / 2;
            *near.select_nth_unstable_by(middle, f32::total_cmp).1 / MEDIAN
        };
        let found: Vec<f32> = (0..lumels.len()).into_par_iter().map(pooled).collect();
        let mut all = errors.to_vec();
        lumels.iter().zip(found).for_each(|(&lumel, error)| all[lumel as usize] = error);
        all
    }

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
        let n_layers = self.layers.len();
        let surface = Surface::new(&self.atlas, coverage, &self.valid);
        let lumels = &surface.lumels;
        let variance =
            |lumel: u32| Some(errors[lumel as usize].powi(2)).filter(|variance| variance.is_finite());
        let light = |lumel: u32| self.layers.iter().map(move |layer| layer.values[lumel as usize]);
        let mut noisy = Noisy {
            light: lumels.iter().flat_map(|&lumel| light(lumel)).collect(),
            variances: lumels.iter().map(|&lumel| variance(lumel).unwrap_or_default()).collect(),
            n_layers,
        };
        for pass in 0..PASSES {
            noisy = noisy.mixed(&surface, 1 << pass);
        }
        for (&lumel, light) in lumels.iter().zip(noisy.light.chunks(n_layers)) {
            self.layers
                .iter_mut()
                .zip(light)
                .for_each(|(layer, &value)| layer.values[lumel as usize] = value);
        }
    }
}

/// Which valid lumels are near each other on a chart.
struct Surface<'a> {
    atlas: &'a Atlas,
    /// Those that are valid.
    lumels: Vec<u32>,
    /// By lumel of all pages: its chart, and its place in `lumels` or `NONE`.
    charts: Vec<u32>,
    places: Vec<u32>,
}

impl<'a> Surface<'a> {
    fn new(atlas: &'a Atlas, coverage: &Coverage, valid: &[bool]) -> Self {
        let lumels: Vec<u32> =
            coverage.lumels().iter().copied().filter(|&lumel| valid[lumel as usize]).collect();
        let charts = charts(atlas, coverage);
        let mut places = vec![NONE; charts.len()];
        lumels.iter().enumerate().for_each(|(place, &lumel)| places[lumel as usize] = place as u32);
        Self { atlas, lumels, charts, places }
    }

    /// Calls `add(place, weight)` for those around a lumel, `reach` and twice `reach` away.
    fn around(&self, place: usize, reach: i64, mut add: impl FnMut(usize, f32)) {
        let lumel = self.lumels[place] as usize;
        let (page, [x, y]) = self.atlas.column_and_row(lumel);
        let [width, height] = self.atlas.pages()[page].map(i64::from);
        let first = self.atlas.first_lumel(page);
        for (j, down) in SPLINE.iter().enumerate() {
            let y = i64::from(y) + (j as i64 - 2) * reach;
            for (i, along) in SPLINE.iter().enumerate().filter(|_| (0..height).contains(&y)) {
                let x = i64::from(x) + (i as i64 - 2) * reach;
                if !(0..width).contains(&x) {
                    continue;
                }
                let near = first + (y * width + x) as usize;
                if self.charts[near] == self.charts[lumel] && self.places[near] != NONE {
                    add(self.places[near] as usize, down * along);
                }
            }
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
