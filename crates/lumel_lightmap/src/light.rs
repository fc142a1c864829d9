//! Light at lumels that is measured round by round.

use crate::surface::Surface;
use glam::Vec3;
use lumel_scene::luminance;
use lumel_uv::{Atlas, Coverage};
use rayon::prelude::*;
use std::ops::Range;

/// The median of how far a normally distributed number lies from its mean, in standard deviations.
const MEDIAN: f64 = 0.6745;

/// Light at each lumel of a [`Coverage`], source by source: direct light, each bounce and, maybe, the tail of all further ones.
///
/// It is the mean of two halves of the samples, which tell how noisy it is. Samples come in rounds: the first measures all
/// lumels, each further one doubles the samples of some. A round is measured part by part, in the order of lumels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LumelLight {
    /// Irradiance by source and lumel, W·m⁻²; zero where nothing was measured.
    pub sources: Vec<Vec<Vec3>>,
    /// Whether the last source is the tail.
    pub has_tail: bool,
    /// By half.
    pub halves: [Half; 2],
    /// The round that is under way, from 0.
    pub round: u32,
    /// The lumels that it measures.
    pub active: Vec<bool>,
    /// Lumels before this one have been measured in it.
    pub done: u32,
    /// All light by direction, where that is measured.
    pub directional: DirectionalLight,
}

/// Where the light of each lumel comes from: measured once, after all rounds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DirectionalLight {
    /// Coefficients of harmonics, W·m⁻², by harmonic and lumel; empty where they are not measured.
    pub harmonics: Vec<Vec<Vec3>>,
    /// Lumels before this one have been measured.
    pub done: u32,
}

/// What is known of each lumel from half of the samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Half {
    /// Samples so far, as a multiple of those in the first round; 0 where the lumel sees nothing but the inside of geometry.
    pub samples: Vec<f32>,
    /// The luminance of all light, W·m⁻².
    pub totals: Vec<f32>,
    /// That of all bounces.
    pub bounced: Vec<f32>,
}

/// Light that half of the samples of a round say some lumels have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartLight {
    /// Whether each was seen.
    pub known: Vec<bool>,
    /// Irradiance by source and lumel, W·m⁻².
    pub sources: Vec<Vec<Vec3>>,
}

impl LumelLight {
    /// Nothing yet: all lumels are to be measured.
    pub fn new(n_lumels: usize, n_sources: usize, has_tail: bool) -> Self {
        let none = || vec![0.0; n_lumels];
        let half = Half { samples: none(), totals: none(), bounced: none() };
        Self {
            sources: vec![vec![Vec3::ZERO; n_lumels]; n_sources],
            has_tail,
            halves: [half.clone(), half],
            round: 0,
            active: vec![true; n_lumels],
            done: 0,
            directional: DirectionalLight::default(),
        }
    }

    /// Checks that all parts are of the same lumels, and all light finite.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn check(&self) -> Result<(), String> {
        let n = self.len();
        let halves = self.halves.iter().flat_map(|half| [&half.samples, &half.totals, &half.bounced]);
        if halves.clone().any(|values| values.len() != n)
            || self.sources.iter().chain(&self.directional.harmonics).any(|source| source.len() != n)
        {
            return Err(format!("has {n} lumels, but other parts of the light have not"));
        }
        let done = self.done.max(self.directional.done);
        if done as usize > n {
            return Err(format!("has {n} lumels, of which {done} are done"));
        }
        let finite = halves.flatten().all(|value| value.is_finite());
        let light = self.sources.iter().chain(&self.directional.harmonics);
        if !finite || !light.flatten().all(|value| value.is_finite()) {
            return Err("has light that is no finite number".to_owned());
        }
        Ok(())
    }

    /// Whether it is light from as many sources at as many lumels.
    pub fn is_like(&self, other: &Self) -> bool {
        (self.len(), self.sources.len(), self.has_tail) == (other.len(), other.sources.len(), other.has_tail)
    }

    /// Number of lumels.
    pub fn len(&self) -> usize {
        self.active.len()
    }

    /// Whether there are no lumels.
    pub fn is_empty(&self) -> bool {
        self.active.is_empty()
    }

    /// Whether a lumel sees anything but the inside of geometry, as far as it has been measured.
    pub fn is_valid(&self, lumel: usize) -> bool {
        self.halves.iter().any(|half| half.samples[lumel] > 0.0)
    }

    /// Direct light and each bounce, W·m⁻² by lumel.
    pub fn bounces(&self) -> &[Vec<Vec3>] {
        &self.sources[..self.sources.len() - usize::from(self.has_tail)]
    }

    /// The light of all bounces after those, if the solve has estimated it, W·m⁻² by lumel.
    pub fn tail(&self) -> Option<&[Vec3]> {
        self.sources.last().filter(|_| self.has_tail).map(Vec::as_slice)
    }

    /// All light, W·m⁻².
    pub fn irradiance(&self, lumel: usize) -> Vec3 {
        self.sources.iter().map(|source| source[lumel]).sum()
    }

    /// Lumels that the round measures and has not yet measured.
    pub fn left(&self) -> usize {
        self.active[self.done as usize..].iter().filter(|active| **active).count()
    }

    /// The next lumels of the round: a range with at most so many of them. `None` if all are done.
    pub fn next_part(&self, most: usize) -> Option<Range<usize>> {
        let first = self.done as usize;
        let mut wanted = (first..self.len()).filter(|&lumel| self.active[lumel]);
        let begin = wanted.next()?;
        let last = wanted.take(most.max(1) - 1).last().unwrap_or(begin);
        Some(first..last + 1)
    }

    /// Adds what both halves say of a part: light at the lumels of a range, of which those that are not active do not count.
    ///
    /// # Panics
    /// If the parts are of other lumels or sources.
    pub fn add(&mut self, range: Range<usize>, parts: &[PartLight; 2]) {
        let samples = self.samples_of_round() as f32;
        for (half, part) in parts.iter().enumerate() {
            for (lumel, known) in range.clone().zip(&part.known) {
                if *known && self.active[lumel] {
                    self.add_lumel((half, lumel), lumel - range.start, samples, part);
                }
            }
        }
        self.done = range.end as u32;
    }

    fn add_lumel(&mut self, (half, lumel): (usize, usize), place: usize, samples: f32, part: &PartLight) {
        let before: f32 = self.halves.iter().map(|half| half.samples[lumel]).sum();
        let (mut direct, mut bounced) = (0.0, 0.0);
        for (k, (source, new)) in self.sources.iter_mut().zip(&part.sources).enumerate() {
            let (mean, new) = (&mut source[lumel], new[place]);
            // Differences, so that what is equal stays itself.
            *mean += (new - *mean) * (samples / (before + samples));
            *if k == 0 { &mut direct } else { &mut bounced } += luminance(new);
        }
        let half = &mut self.halves[half];
        half.samples[lumel] += samples;
        let share = samples / half.samples[lumel];
        let means = [(&mut half.totals[lumel], direct + bounced), (&mut half.bounced[lumel], bounced)];
        means.into_iter().for_each(|(mean, new)| *mean += (new - *mean) * share);
    }

    /// Begins to measure light by direction in so many harmonics, unless that has begun.
    pub fn begin_directional(&mut self, harmonics: usize) {
        if self.directional.harmonics.len() != harmonics {
            let dark = vec![Vec3::ZERO; self.len()];
            self.directional = DirectionalLight { harmonics: vec![dark; harmonics], done: 0 };
        }
    }

    /// The next lumels to be measured by direction: at most so many. `None` if all are done.
    pub fn next_directional_part(&self, most: usize) -> Option<Range<usize>> {
        let begin = self.directional.done as usize;
        (begin < self.len()).then(|| begin..self.len().min(begin + most.max(1)))
    }

    /// Adds the coefficients of the lumels of a range, lumel by lumel.
    ///
    /// # Panics
    /// If there are not as many as the range has lumels.
    pub fn add_directional<'a>(
        &mut self,
        range: Range<usize>,
        coefficients: impl ExactSizeIterator<Item = &'a [Vec3]>,
    ) {
        assert_eq!(coefficients.len(), range.len(), "coefficients of each lumel");
        self.directional.done = range.end as u32;
        for (lumel, coefficients) in range.zip(coefficients) {
            for (harmonic, value) in self.directional.harmonics.iter_mut().zip(coefficients) {
                harmonic[lumel] = *value;
            }
        }
    }

    /// The samples of each half of the round, as a multiple of those of the first: with all before, they double.
    pub fn samples_of_round(&self) -> u32 {
        1 << self.round.saturating_sub(1)
    }

    /// Begins the next round, which measures some of the lumels.
    ///
    /// # Panics
    /// If there is not one flag for each lumel.
    pub fn begin_round(&mut self, active: Vec<bool>) {
        assert_eq!(active.len(), self.len(), "a flag for each lumel");
        (self.round, self.active, self.done) = (self.round + 1, active, 0);
    }

    /// How far each lumel's light may be off: the standard error of the luminance of all light, W·m⁻².
    ///
    /// It is half of how far the two halves of the samples differ, of which a single one says little: those around it on its
    /// chart say it together. The median does, so that a hard edge of light, which few lumels lie on, is not taken for noise.
    pub fn noise(&self, atlas: &Atlas, coverage: &Coverage) -> Vec<f32> {
        self.pooled(atlas, coverage, |near| {
            let mut differences: Vec<f64> = near.iter().map(|&place| self.half_difference(place)).collect();
            let middle = differences.len() / 2;
            *differences.select_nth_unstable_by(middle, f64::total_cmp).1 / MEDIAN
        })
    }

    /// The same by the mean of the squares around each, which finds edges of light, where more samples help most; relative to the
    /// light around the lumel, or to this share of the mean light where that is more.
    ///
    /// The light of a lumel alone would not do: those that came out too dark by chance would be measured again, those too bright
    /// would not, and all together would be too bright.
    pub fn relative_errors(&self, atlas: &Atlas, coverage: &Coverage, floor: f64) -> Vec<f32> {
        let light: Vec<f64> = (0..self.len()).map(|lumel| luminance(self.irradiance(lumel)).into()).collect();
        let all: f64 = light.iter().sum();
        let valid = (0..self.len()).filter(|&lumel| self.is_valid(lumel)).count().max(1);
        let floor = floor * all / valid as f64;
        self.pooled(atlas, coverage, |near| {
            let n = near.len() as f64;
            let squares: f64 = near.iter().map(|&place| self.half_difference(place).powi(2)).sum();
            let around: f64 = near.iter().map(|&place| light[place]).sum();
            let error = (squares / n).sqrt();
            if error > 0.0 { error / (around / n).max(floor) } else { 0.0 }
        })
    }

    /// Half of how far the halves of the samples of a lumel differ.
    fn half_difference(&self, place: usize) -> f64 {
        let [a, b] = &self.halves;
        0.5 * (f64::from(a.totals[place]) - f64::from(b.totals[place])).abs()
    }

    /// What `pool` makes of the places around each lumel, itself among them; 0 where there are no two halves.
    fn pooled(&self, atlas: &Atlas, coverage: &Coverage, pool: impl Fn(&[usize]) -> f64 + Sync) -> Vec<f32> {
        let [a, b] = &self.halves;
        let has_both = |place: usize| a.samples[place] > 0.0 && b.samples[place] > 0.0;
        let surface = Surface::new(atlas, coverage, has_both);
        let mut errors = vec![0.0; self.len()];
        let pooled = |index: usize| {
            let mut near = Vec::with_capacity(25);
            surface.around(index, 1, |index, _| near.push(surface.places()[index]));
            pool(&near) as f32
        };
        let found: Vec<f32> = (0..surface.places().len()).into_par_iter().map(pooled).collect();
        surface.places().iter().zip(found).for_each(|(&place, error)| errors[place] = error);
        errors
    }
}
