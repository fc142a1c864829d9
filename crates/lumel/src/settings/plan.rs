//! What settings ask of the crates below.

use super::bounce_limit::BounceLimit;
use super::table::Settings;
use lumel_solve::Stop;
use lumel_transport::{Plan, SampleRange};

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
            range: SampleRange::First,
        }
    }

    /// When to stop.
    pub fn stop(&self) -> Stop {
        match self.bounces {
            BounceLimit::Count(n) => Stop::Bounces(n),
            BounceLimit::All => Stop::Remainder { fraction: self.remainder, at_most: MAX_BOUNCES },
        }
    }
}
