//! Light that was measured at lumels, and the same light as the solve knows it.

use crate::lightmap::COMPLEMENT;
use crate::solved::Part;
use crate::surface::Surface;
use crate::{LumelLight, SolvedLight};
use glam::{Vec2, Vec3};
use lumel_scene::luminance;
use lumel_uv::{Atlas, Coverage};
use rayon::prelude::*;

/// How much of the noise of what was measured may look like light that the solve has missed: more is no chance. In a lumel by itself,
/// and in the few around it.
const CHANCE: [f32; 2] = [200.0, 2.5];

/// How far around a lumel it is decided how much is kept: all but the first in turn.
const REACHES: [i64; 3] = [1, 2, 4];

impl LumelLight {
    /// The same light with less noise: direct light and bounces are moved towards what the solve says, as far as that
    /// helps.
    ///
    /// The solve has measured light by many rays for each of its nodes, but knows nothing of what lies between them; samples of a
    /// lumel see that, and are few. Around each lumel, the mean square of the difference of both is that of what the solve has
    /// missed, b², and of the noise of what was measured, v. The mean square error is least where a share b² / (b² + v) of the
    /// difference is kept (after James and Stein). The halves of the samples tell both: their noise is independent, so that
    /// the product of their differences is b² on average. More is kept where a lumel or those close by have more than
    /// chance allows, such as along a contact shadow, and where few lumels tell.
    ///
    /// With more samples, v falls and light becomes what was measured. Bounces keep their proportions.
    pub(crate) fn shrunk(&self, atlas: &Atlas, coverage: &Coverage, solved: &SolvedLight) -> Self {
        let mut shrunk = self.clone();
        let is_known = |place: usize| self.halves.iter().all(|half| half.samples[place] > 0.0);
        let surface = Surface::new(atlas, coverage, is_known);
        let known = Part::ALL.into_iter().filter_map(|part| Some((part, solved.part(part)?)));
        for (part, solved) in known.filter(|(part, _)| !part.of(&self.sources).is_empty()) {
            let missed_and_noise = |place: usize| {
                let solved = luminance(solved[place]);
                let [a, b] = [0, 1].map(|half| self.part_of_half(part, half, place) - solved);
                Vec2::new(a * b, (0.5 * (a - b) / COMPLEMENT).powi(2))
            };
            let single: Vec<Vec2> =
                surface.places().par_iter().map(|&place| missed_and_noise(place)).collect();
            let close = surface.means(&single, REACHES[0]);
            let wide = REACHES[1..].iter().fold(close.clone(), |means, &reach| surface.means(&means, reach));
            for (index, &place) in surface.places().iter().enumerate() {
                let ([near, noise], [missed, usual]) = (close[index].to_array(), wide[index].to_array());
                let own = single[index].x;
                let by_chance = CHANCE.map(|chance| chance * noise);
                let missed = missed.max(near - by_chance[1]).max(own - by_chance[0]).max(0.0);
                // Where there is little noise, that of others is none of its own.
                let noise = noise.min(usual);
                let kept = if noise > 0.0 { missed / (missed + noise) } else { 1.0 };
                let share = (1.0 - kept) * surface.trust(index, &REACHES);
                shrunk.move_part((part, place), solved[place], share);
            }
        }
        shrunk
    }

    /// The luminance of a part of the light, as half of the samples say.
    pub(crate) fn part_of_half(&self, part: Part, half: usize, place: usize) -> f32 {
        let half = &self.halves[half];
        match part {
            Part::Direct => half.totals[place] - half.bounced[place],
            Part::Bounces => half.bounced[place],
        }
    }

    /// Moves a part of the light of a lumel by a share of the way to what the solve says.
    fn move_part(&mut self, (part, place): (Part, usize), solved: Vec3, share: f32) {
        for half in 0..2 {
            let change = (luminance(solved) - self.part_of_half(part, half, place)) * share;
            let half = &mut self.halves[half];
            half.totals[place] += change;
            if let Part::Bounces = part {
                half.bounced[place] += change;
            }
        }
        let sources = part.of_mut(&mut self.sources);
        let measured: Vec3 = sources.iter().map(|source| source[place]).sum();
        let moved = (measured + (solved - measured) * share).max(Vec3::ZERO);
        let is_lit = measured.cmpgt(Vec3::ZERO);
        let factor = Vec3::select(is_lit, moved / measured, Vec3::ONE);
        sources.iter_mut().for_each(|source| source[place] *= factor);
        sources[0][place] += Vec3::select(is_lit, Vec3::ZERO, moved);
    }
}
