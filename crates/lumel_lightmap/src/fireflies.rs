//! Light that few samples happened to find.

use crate::solved::Part;
use crate::surface::Surface;
use crate::{LumelLight, SolvedLight};
use glam::Vec3;
use lumel_scene::luminance;
use lumel_uv::{Atlas, Coverage};
use rayon::prelude::*;

/// What exceeds the light around by more than this many standard errors is no noise of the usual kind.
const ERRORS: f32 = 3.0;

/// What is to be seen: this share of all light that is bright around.
const SEEN: f32 = 0.25;

/// What both halves of the samples found is no chance: the fainter one has this part of the excess.
const BY_BOTH: f32 = 0.2;

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
    /// All sources of light, without fireflies: lumels that are brighter than those around and than the solve says because one half of
    /// their samples found something small and bright that the other half did not find.
    ///
    /// What such a lumel has more has been found in place of all of them: it is spread over the chart,
    /// so that power stays. Small spots of light that both halves see are left alone, unless fireflies are many.
    /// Biased: it blurs light of which too little is known to place it.
    pub(crate) fn with_fireflies_spread(
        &self,
        atlas: &Atlas,
        coverage: &Coverage,
        solved: &SolvedLight,
    ) -> Vec<Vec<Vec3>> {
        let mut sources = self.sources.clone();
        let is_known = |place: usize| self.halves.iter().all(|half| half.samples[place] > 0.0);
        let surface = Surface::new(atlas, coverage, is_known);
        let noise = self.noise(atlas, coverage);
        for part in Part::ALL {
            let is_firefly = self.fireflies(part, &surface, &noise, solved.part(part));
            if is_firefly.contains(&true) {
                spread_fireflies(part.of_mut(&mut sources), &surface, &is_firefly);
            }
        }
        sources
    }

    /// Those of a part of the light, by index in the places of a surface.
    fn fireflies(
        &self,
        part: Part,
        surface: &Surface<'_>,
        noise: &[f32],
        solved: Option<&[Vec3]>,
    ) -> Vec<bool> {
        let places = surface.places();
        let light = |place: &usize| {
            let of_part: Vec3 = part.of(&self.sources).iter().map(|source| source[*place]).sum();
            [luminance(of_part), luminance(self.irradiance(*place))]
        };
        let light: Vec<[f32; 2]> = places.iter().map(light).collect();
        let found = |index: usize| {
            let place = places[index];
            let mut around: Vec<usize> = around(surface, index).collect();
            if around.len() < MIN_AROUND {
                return Found::Usual;
            }
            // What is bright around, of the part and of all light.
            let [bright, bright_of_all] = [0, 1].map(|k| {
                let brighter = (BRIGHT * around.len() as f32) as usize;
                let by_light = |a: &usize, b: &usize| light[*b][k].total_cmp(&light[*a][k]);
                light[*around.select_nth_unstable_by(brighter, by_light).1][k]
            });
            let usual = bright.max(solved.map_or(0.0, |solved| luminance(solved[place])));
            let more = light[index][0] - usual;
            let less = [0, 1].map(|half| self.part_of_half(part, half, place));
            let found_by_both = less[0].min(less[1]) - usual;
            if more <= (SEEN * bright_of_all.max(usual)).max(ERRORS * noise[place]) {
                Found::Usual
            } else if found_by_both < BY_BOTH * more {
                Found::Firefly
            } else {
                Found::Spot
            }
        };
        let found: Vec<Found> = (0..places.len()).into_par_iter().map(found).collect();
        let is_firefly = |index: usize| match found[index] {
            Found::Usual => false,
            Found::Firefly => true,
            Found::Spot => {
                around(surface, index).filter(|&near| found[near] == Found::Firefly).count() >= MANY
            }
        };
        (0..places.len()).into_par_iter().map(is_firefly).collect()
    }
}

/// Spreads what fireflies have more than those around them over their charts.
fn spread_fireflies(sources: &mut [Vec<Vec3>], surface: &Surface<'_>, is_firefly: &[bool]) {
    let (places, n_sources) = (surface.places(), sources.len());
    let mut more: Light = vec![Vec3::ZERO; places.len() * n_sources];
    for (index, &place) in places.iter().enumerate().filter(|(index, _)| is_firefly[*index]) {
        let around: Vec<usize> = around(surface, index).filter(|&near| !is_firefly[near]).collect();
        for (source, more) in sources.iter().zip(&mut more[index * n_sources..]) {
            let sum: Vec3 = around.iter().map(|&near| source[places[near]]).sum();
            *more = (source[place] - sum / around.len().max(1) as f32).max(Vec3::ZERO);
        }
    }
    let spread = (0..PASSES).fold(more.clone(), |light, pass| spread(surface, &light, 1 << pass));
    for (index, &place) in places.iter().enumerate() {
        for (k, source) in sources.iter_mut().enumerate() {
            source[place] += spread[index * n_sources + k] - more[index * n_sources + k];
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
