//! Light at lumels, after a solve.

use super::published::{Ending, Phase, Shared, lock};
use super::task::Solved;
use crate::layout::Layout;
use crate::lumel_light::LumelIllumination;
use lumel::{Control, Lightmap, LumelLight, Lumels, TransportError};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time between two looks at lumels that are being measured, at least.
const PERIOD: Duration = Duration::from_millis(490);

/// Measures the light of a solve at the lumels of a layout, and publishes what is known of it meanwhile.
pub(super) fn measure(
    solved: &Solved,
    layout: &Arc<Layout>,
    denoises: bool,
    control: &Control,
    shared: &Shared,
) -> Ending {
    shared.publish_phase(Phase::Lumels { round: 0, percent: 0 });
    let Lumels { scene, atlas, coverage } = &layout.lumels;
    let Solved { baker, state } = solved;
    let mut light = baker.no_light_at_lumels(state, &layout.lumels);
    let mut next = Instant::now();
    let mut publish = |so_far: &LumelLight| {
        let LumelLight { round, done, .. } = *so_far;
        let percent = (100 * u64::from(done) / (so_far.len() as u64).max(1)) as u32;
        shared.publish_phase(Phase::Lumels { round, percent });
        if Instant::now() >= next {
            let known = LumelIllumination::measured(Arc::clone(layout), so_far.clone());
            shared.publish_light(|published| published.lumels = Some(known));
            next = Instant::now() + PERIOD;
        }
    };
    let measured = {
        let mut parts = lock(&layout.parts);
        // The solve keeps rays too.
        parts.kept_bytes = baker.settings().memory.0 / 2;
        baker.continue_lumel_parts(state, &layout.lumels, &mut light, &mut parts, control, &mut publish)
    };
    match measured {
        Ok(()) => {}
        Err(TransportError::Cancelled) => return Ending::Stopped,
        Err(error) => return Ending::Failed(error.to_string()),
    }
    shared.publish_phase(Phase::Finishing);
    let known = denoises.then(|| baker.solved_at_lumels(state, &layout.lumels));
    let lightmap = Lightmap::finished(scene, atlas, coverage, &light, known.as_ref(), None);
    let all = LumelIllumination::finished(Arc::clone(layout), lightmap);
    shared.publish_light(|published| published.lumels = Some(all));
    Ending::Done
}
