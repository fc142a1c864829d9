//! The light on the surfaces: what it was computed from, and by what.

use crate::inputs::Inputs;
use crate::selection::Illumination;
use crate::solver::Solved;
use lumel::setting::{PROJECTION, Setting as _};
use lumel::{Accuracy, RefinementState, Settings, Solution, TargetError, counted};
use std::sync::Arc;

/// What the light on the surfaces was computed from.
#[derive(Clone)]
pub struct Computed {
    /// What it was computed from.
    pub inputs: Inputs,
    /// Whether all bounces that the settings ask for are there.
    pub complete: bool,
    /// Whether it is in a file of the user's.
    pub saved: bool,
    /// What computed it, when that was this session.
    pub solved: Option<Arc<Solved>>,
    /// What goes on with a mesh whose refinement was stopped.
    pub refinement: Option<Box<RefinementState>>,
    /// The file it was read from.
    pub file: Option<Arc<Solution>>,
    /// What to call it.
    pub origin: Option<String>,
    /// How long the solve took, when it was done here, seconds.
    pub seconds: Option<f64>,
}

impl Computed {
    /// Light of which this session has computed a part.
    pub(super) fn unfinished(inputs: Inputs) -> Self {
        let (solved, refinement, file, origin, seconds) = (None, None, None, None, None);
        Self { inputs, complete: false, saved: false, solved, refinement, file, origin, seconds }
    }

    /// The settings; `None` where a file does not tell.
    pub fn settings(&self) -> Option<&Settings> {
        self.inputs.settings.as_ref()
    }

    /// What a solve with a target error has reached.
    pub fn accuracy(&self) -> Option<Accuracy> {
        Some(self.solved.as_ref()?.state.errors.as_ref()?.accuracy)
    }

    /// How many batches of vertices have shot, where light was shot by this session.
    pub fn shots(&self) -> Option<u32> {
        Some(self.solved.as_ref()?.state.shot.as_ref()?.shots)
    }

    /// What it is, in a few words.
    pub fn label(&self, light: &Illumination) -> String {
        let bounces = counted(light.bounce_count().saturating_sub(1), "bounce", "bounces");
        if let Some(origin) = &self.origin {
            return origin.clone();
        }
        let Some(s) = self.settings() else { return bounces };
        let rays = match s.target_error {
            TargetError::Off => format!("{}+{}", s.direct_samples, s.indirect_samples),
            TargetError::At(_) => "adaptive".to_owned(),
        };
        let found = self.shots().map_or(bounces, |n| counted(n as usize, "shot", "shots"));
        format!("{} {rays} rays, {found}, {}", s.sampler, PROJECTION.text(s))
    }
}
