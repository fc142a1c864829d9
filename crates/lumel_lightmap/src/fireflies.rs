//! Light that few samples happened to find.

use crate::LumelLight;
use crate::surface::Surface;
use glam::Vec3;
use lumel_scene::luminance;
use lumel_uv::{Atlas, Coverage};
use rayon::prelude::*;

/// What exceeds the light around by more than this many standard errors is no noise of the usual kind.
const ERRORS: f32 = 3.0;

/// What is to be seen: so many times as bright as what is bright around.
const BRIGHTER: f32 = 1.25;

/// What both halves of the samples found alike is no chance: the fainter one has this part of the excess.
const BY_BOTH: f32 = 0.8;

/// With so many fireflies around, both halves may have found alike by chance, too.
const MANY: usize = 3;

/// The share of the lumels around that may be brighter than what is taken for bright there: fireflies may be neighbours. As many
/// are lit around the tip of a corner of light.
const BRIGHT: f32 = 0.35;

/// With fewer lumels around, nothing is known of what is usual there.
const MIN_AROUND: usize = 8;

/// Times that light is spread, over distances of 1, 2, 4 and 8: a bell, nine lumels wide to each side.
const PASSES: u32 = 4;

/// Light by place of a surface, all sources side by side.
type Light = Vec<Vec3>;

/// How a lumel compares with those around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Found {
    /// It has what others have.
    Usual,
    /// It is brighter, as both halves of the samples say.
    Spot,
    /// It is brighter, as one half says more than the other.
    Firefly,
}

impl LumelLight {
    /// All sources of light, without fireflies: lumels that are brighter than most around because one half of their samples found
    /// something small and bright more often than the other half, and than most around, did.
    ///
    /// What such a lumel has more than those around it has been found in place of all of them: it is spread over the chart,
    /// so that power stays. Small spots of light that both halves see alike are left alone, unless fireflies are many.
    /// Biased: it blurs light of which too little is known to place it.
    pub(crate) fn with_fireflies_spread(&self, atlas: &Atlas, coverage: &Coverage) -> Vec<Vec<Vec3>> {
        let is_known = |place: usize| self.halves.iter().all(|half| half.samples[place] > 0.0);
        let surface = Surface::new(atlas, coverage, is_known);
        let is_firefly = self.fireflies(&surface, &self.noise(atlas, coverage));
        let mut sources = self.sources.clone();
        if !is_firefly.contains(&true) {
            return sources;
        }
        let mut more: Light = vec![Vec3::ZERO; surface.places().len() * sources.len()];
        for (index, &place) in surface.places().iter().enumerate().filter(|(index, _)| is_firefly[*index]) {
            let around: Vec<usize> = around(&surface, index).filter(|&near| !is_firefly[near]).collect();
            for (source, more) in self.sources.iter().zip(&mut more[index * sources.len()..]) {
                let sum: Vec3 = around.iter().map(|&near| source[surface.places()[near]]).sum();
                *more = (source[place] - sum / around.len().max(1) as f32).max(Vec3::ZERO);
            }
        }
        let spread = (0..PASSES).fold(more.clone(), |light, pass| spread(&surface, &light, 1 << pass));
        for (index, &place) in surface.places().iter().enumerate() {
            for (k, source) in sources.iter_mut().enumerate() {
                let at = index * self.sources.len() + k;
                source[place] += spread[at] - more[at];
            }
        }
        sources
    }

    /// By index in the places of a surface.
    fn fireflies(&self, surface: &Surface<'_>, noise: &[f32]) -> Vec<bool> {
        let all: Vec<f32> = surface.places().iter().map(|&place| luminance(self.irradiance(place))).collect();
        let n = surface.places().len();
        let found: Vec<Found> =
            (0..n).into_par_iter().map(|index| self.found(surface, index, &all, noise)).collect();
        let is_firefly = |index: usize| match found[index] {
            Found::Usual => false,
            Found::Firefly => true,
            Found::Spot => {
                around(surface, index).filter(|&near| found[near] == Found::Firefly).count() >= MANY
            }
        };
        (0..n).into_par_iter().map(is_firefly).collect()
    }

    fn found(&self, surface: &Surface<'_>, index: usize, all: &[f32], noise: &[f32]) -> Found {
        let place = surface.places()[index];
        let mut around: Vec<f32> = around(surface, index).map(|near| all[near]).collect();
        if around.len() < MIN_AROUND {
            return Found::Usual;
        }
        let brighter = (BRIGHT * around.len() as f32) as usize;
        let bright = *around.select_nth_unstable_by(brighter, |a, b| b.total_cmp(a)).1;
        let less = self.halves.iter().map(|half| half.totals[place]).fold(f32::INFINITY, f32::min);
        if all[index] <= (BRIGHTER * bright).max(bright + ERRORS * noise[place]) {
            Found::Usual
        } else if less - bright < BY_BOTH * (all[index] - bright) {
            Found::Firefly
        } else {
            Found::Spot
        }
    }
}

/// The indices of those around one on its chart, up to two lumels away.
fn around(surface: &Surface<'_>, index: usize) -> impl Iterator<Item = usize> {
    let mut around = Vec::with_capacity(24);
    surface.around(index, 1, |near, _| {
        if near != index {
            around.push(near);
        }
    });
    around.into_iter()
}

/// Light mixed with that around it; what each place gives adds up to what it had.
fn spread(surface: &Surface<'_>, light: &Light, reach: i64) -> Light {
    let n = surface.places().len();
    let n_sources = light.len() / n;
    let all_weights = |index: usize| {
        let mut all = 0.0;
        surface.around(index, reach, |_, weight| all += weight);
        all
    };
    let all_weights: Vec<f32> = (0..n).into_par_iter().map(all_weights).collect();
    let mut spread = vec![Vec3::ZERO; light.len()];
    spread.par_chunks_mut(n_sources).enumerate().for_each(|(index, sums)| {
        surface.around(index, reach, |near, weight| {
            let share = weight / all_weights[near];
            for (sum, light) in sums.iter_mut().zip(&light[near * n_sources..]) {
                *sum += *light * share;
            }
        });
    });
    spread
}
