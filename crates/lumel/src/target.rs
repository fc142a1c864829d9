//! Stopping at an error: its samples, and the operators of replicates.

use crate::direct_at_vertices::DirectAtVertices;
use crate::settings::{Settings, TargetError};
use lumel_basis::{Basis, Receivers};
use lumel_sample::SamplerKind;
use lumel_solve::{REPLICATES, Replicates, Round, Target};
use lumel_transport::{CachedTransport, Plan, Rows, Transport};

/// Fewer samples than this say little about what a replicate sees, and the bias of stored rays is 1.5 % over their number.
const MIN_SAMPLES: u32 = 16;

/// A node gets this many doublings of its first samples at most: 64 times as many.
const DOUBLINGS: u32 = 6;

/// What the shadow rays of each replicate are more or less than the mean.
///
/// An edge parallel to a light's cuts off `s N` of `N` evenly spread points, rounded up or down. Eight replicates of the
/// same `N` would often all round to the same side, agree, and be wrong by far more than their spread; with as many
/// different `N` they do not.
const OFFSETS: [i32; REPLICATES] = [-4, -3, -2, -1, 1, 2, 3, 4];

/// The target of the settings.
pub(crate) fn target(settings: &Settings) -> Option<Target> {
    let TargetError::At(error) = settings.target_error else { return None };
    Some(Target {
        error: error.get().into(),
        share: settings.target_share.get().into(),
        rounds: DOUBLINGS + 1,
        memory: settings.memory.0,
    })
}

/// A replicate's part of all samples.
fn part(samples: u32) -> u32 {
    samples.div_ceil(REPLICATES as u32).max(MIN_SAMPLES)
}

/// The rays of each replicate in the first round: an eighth of those of the settings, or less where what this stores,
/// `bytes(rays)` of a replicate, does not fit.
pub(crate) fn first_rays(settings: &Settings, bytes: impl Fn(u32) -> u64) -> u32 {
    let mut rays = part(settings.indirect_samples);
    while rays > MIN_SAMPLES && REPLICATES as u64 * bytes(rays) > settings.memory.0 {
        rays = (rays / 2).max(MIN_SAMPLES);
    }
    rays
}

/// The samples of each replicate in the first round, with so many rays.
pub(crate) fn first_plan(settings: &Settings, rays: u32) -> Plan {
    Plan { direct_samples: part(settings.direct_samples), indirect_samples: rays, ..settings.plan() }
}

/// Operators of replicates on stored rays.
pub(crate) struct StoredReplicates<B, R> {
    /// Traces nothing itself.
    pub(crate) like: CachedTransport<B, R>,
    pub(crate) first: Plan,
    /// Whether light is shot.
    pub(crate) shoots: bool,
    /// Direct light at the vertices, where it is measured there.
    pub(crate) direct: Option<DirectAtVertices>,
}

impl<B, R> StoredReplicates<B, R> {
    fn plan(&self, round: Round) -> Plan {
        let offset = OFFSETS[round.replicate as usize % REPLICATES];
        let direct = self.first.direct_samples.saturating_add_signed(offset);
        // As many samples as all before continue their sequence, and are spread evenly with them.
        let continues = round.number > 0 && self.first.sampler != SamplerKind::Stratified;
        Plan {
            direct_samples: direct.saturating_mul(round.times),
            indirect_samples: self.first.indirect_samples.saturating_mul(round.times),
            seed: seed_of(self.first.seed, round.replicate, if continues { 0 } else { round.number }),
            portion: u32::from(continues),
            ..self.first
        }
    }
}

impl<B: Basis + 'static, R: Receivers + 'static> Replicates for StoredReplicates<B, R> {
    fn operator(&self, round: Round, nodes: &[bool]) -> Box<dyn Transport> {
        Box::new(self.like.with_samples(self.plan(round), nodes))
    }

    fn direct(&self, round: Round) -> Option<Box<dyn Transport>> {
        self.direct.as_ref().map(|direct| direct.operator(self.plan(round)).transport)
    }

    fn bytes(&self, round: Round, nodes: &[bool]) -> u64 {
        let plan = self.plan(round);
        let columns = if self.shoots { Rows::column_bytes_for(self.like.rays_with(&plan, nodes)) } else { 0 };
        self.like.memory_with(&plan, nodes) + columns
    }
}

/// Seeds that differ in all bits for neighbouring numbers: the finalizer of SplitMix64 (Steele, Lea, Flood 2014).
fn seed_of(seed: u64, replicate: u32, round: u32) -> u64 {
    let number = u64::from(round) << 32 | u64::from(replicate + 1);
    let mut x = seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replicates_share_the_samples_of_the_settings_and_get_fewer_rays_where_memory_is_short() {
        let settings = Settings { direct_samples: 64, indirect_samples: 1024, ..Settings::default() };
        let rays = |bytes: u64| first_rays(&settings, |rays| u64::from(rays) * bytes);
        let first = first_plan(&settings, rays(1));
        assert_eq!((first.direct_samples, first.indirect_samples), (MIN_SAMPLES, 128));
        let limit = settings.memory.0;
        assert_eq!(rays(limit / (8 * 64)), 64);
        assert_eq!(rays(limit), MIN_SAMPLES);
    }

    #[test]
    fn every_replicate_and_round_has_a_seed_of_its_own() {
        let mut seeds: Vec<u64> = (0..2)
            .flat_map(|seed| (0..8).flat_map(move |r| (0..7).map(move |k| seed_of(seed, r, k))))
            .collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 2 * 8 * 7);
    }
}
