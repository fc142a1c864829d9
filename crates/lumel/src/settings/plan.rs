//! What settings ask of the crates below.

use super::bounce_limit::BounceLimit;
use super::point_spacing::PointSpacing;
use super::schedule_kind::ScheduleKind;
use super::table::Settings;
use super::target_error::TargetError;
use lumel_basis::{Directional, Sampling};
use lumel_solve::{Gather, Schedule, Shoot, Stop};
use lumel_transport::Plan;

/// More bounces than this are never computed until the rest is negligible: at the largest albedo allowed, 0.98, the
/// light that is left then is below a thousandth.
const MAX_BOUNCES: u32 = 400;

impl Settings {
    /// The sampling part.
    pub fn plan(&self) -> Plan {
        Plan {
            sampler: self.sampler,
            direct_samples: self.direct_samples,
            indirect_samples: self.indirect_samples,
            seed: self.seed,
            light_sampling: self.light_sampling,
            emitters: self.emitters,
            portion: 0,
        }
    }

    /// How light is measured that is carried from bounce to bounce.
    pub fn sampling(&self) -> Sampling {
        if self.point_spacing == PointSpacing::Off { self.projection.sampling() } else { Sampling::Point }
    }

    /// Those of a solve whose light is only carried, to be gathered by lumels: a target error and light by direction are theirs, and
    /// what they gather is a mean over many nodes of the basis.
    pub fn carrying(&self) -> Self {
        let directional = Directional::Off;
        Self { target_error: TargetError::Off, directional, ..self.clone() }
    }

    /// Whether each bounce is known by itself: shots tell none apart.
    pub fn tells_bounces(&self) -> bool {
        self.schedule == ScheduleKind::Gather
    }

    /// In which order light is transported, and until when.
    pub fn schedule(&self) -> Box<dyn Schedule> {
        match self.schedule {
            ScheduleKind::Gather => Box::new(Gather { stop: self.stop() }),
            ScheduleKind::Shoot => Box::new(Shoot { remainder: self.remainder }),
        }
    }

    /// When to stop gathering.
    pub fn stop(&self) -> Stop {
        match self.bounces {
            BounceLimit::Count(n) => Stop::Bounces(n),
            BounceLimit::All => Stop::Remainder { fraction: self.remainder, at_most: MAX_BOUNCES },
        }
    }
}
