//! Continuing a bake that was stopped.

use crate::{Baker, Method, Projection, Settings, assembly};
use glam::Vec3;
use lumel_basis::{Basis, Field, LeastSquares};
use lumel_export::{
    Checkpoint, CheckpointMeta, RefinementState, Saved, SavedShots, Solution, SolutionError, SolutionPoints,
};
use lumel_solve::{Accuracy, Errors, PowerLog, ShotLight, SolveState};
use serde_json::Value;

/// Why saved light cannot be continued.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// It belongs to a different scene.
    #[error(transparent)]
    Scene(#[from] SolutionError),
    /// It is light in another basis, or of another version of this one.
    #[error("the checkpoint holds light in another basis; bake the scene again")]
    Basis,
    /// The scene is lit differently.
    #[error("the solution was computed with other materials or lights; bake the scene again")]
    Lighting,
    /// The settings would give other bounces.
    #[error("the solution was computed with other settings ({differences}); use the same or bake again")]
    Settings {
        /// Which settings differ, and how.
        differences: String,
    },
    /// Its samples are not known.
    #[error("a solution does not tell the rounds of a target error; continue its checkpoint or bake again")]
    TargetError,
}

impl Baker {
    /// All that is needed to continue from a state.
    pub fn checkpoint(&self, state: &SolveState) -> Checkpoint {
        let values = |field: &Field| field.values().to_vec();
        let settings = serde_json::to_value(self.settings()).unwrap_or_default();
        let accuracy = state.errors.as_ref().map(|errors| serde_json::to_value(errors.accuracy));
        let accuracy = accuracy.and_then(Result::ok).unwrap_or_default();
        Checkpoint {
            meta: CheckpointMeta::new(self.scene(), self.basis().identity().to_string(), settings, accuracy),
            valid: state.valid.clone(),
            bounces: state.bounces.iter().map(values).collect(),
            shot: state.shot.as_ref().map(|shot| SavedShots {
                reflected: values(&shot.reflected),
                unshot: values(&shot.unshot),
                shots: shot.shots,
            }),
            tail: state.tail.as_ref().map(values),
            direct: state.read_direct.as_ref().map(values),
            standard_error: state.errors.as_ref().map(|errors| values(&errors.standard_error)),
            rounds: state.rounds.clone(),
            splits: self.splits().to_vec(),
            refinement: None,
        }
    }

    /// All that is needed to [go on](Self::adapted_from) with a refinement of this baker's scene.
    pub fn checkpoint_of_refinement(&self, state: RefinementState) -> Checkpoint {
        Checkpoint { refinement: Some(state), ..self.checkpoint(&SolveState::new()) }
    }

    /// The refinement that was under way when this was saved; `None` if there is light already.
    ///
    /// # Errors
    /// When it is of a different scene, other lights or other settings.
    pub fn resume_refinement(&self, saved: &Saved) -> Result<Option<RefinementState>, ResumeError> {
        let Saved::Checkpoint(checkpoint) = saved else { return Ok(None) };
        let Some(refinement) = &checkpoint.refinement else { return Ok(None) };
        self.check_origin(checkpoint)?;
        Ok(Some(refinement.clone()))
    }

    /// Whether a checkpoint was computed on this scene, under these lights and with these settings.
    fn check_origin(&self, checkpoint: &Checkpoint) -> Result<(), ResumeError> {
        checkpoint.check_belongs_to(self.scene())?;
        if checkpoint.meta.basis != self.basis().identity().to_string() {
            return Err(ResumeError::Basis);
        }
        if !checkpoint.has_lighting_of(self.scene()) {
            return Err(ResumeError::Lighting);
        }
        self.check_settings(&checkpoint.meta.settings).map(drop)
    }

    /// The edges that were split where the scene was refined.
    pub(crate) fn splits(&self) -> &[[u32; 2]] {
        self.scene().refinement().map_or(&[], |refinement| refinement.splits())
    }

    /// The state from which to continue what was saved: a checkpoint, or a solution with its bounces.
    ///
    /// Bounces beyond those that these settings ask for are left out, so that the result does not depend on how far
    /// the saved solve went. A solve with a target error measures the samples of its rounds once more; only checkpoints
    /// tell them. If it is to have other bounces or another tail, the samples of all finished rounds are used for these,
    /// and it has the bits of a solve with the same rounds. One from the start may choose other nodes for its rounds. Where light
    /// is shot, only checkpoints tell what is unshot; a solution is continued from its direct light.
    ///
    /// # Errors
    /// When it is of a different scene, other lights or other settings.
    pub fn resume(&self, saved: &Saved) -> Result<SolveState, ResumeError> {
        match saved {
            Saved::Checkpoint(checkpoint) => self.resume_checkpoint(checkpoint),
            Saved::Solution(solution) => self.resume_solution(solution),
        }
    }

    fn resume_checkpoint(&self, checkpoint: &Checkpoint) -> Result<SolveState, ResumeError> {
        let meta = &checkpoint.meta;
        self.check_origin(checkpoint)?;
        let is_at_vertices = |direct: &Vec<Vec3>| direct.len() == self.surfaces().vertices.node_count();
        let is_whole = checkpoint.direct.as_ref().is_none_or(is_at_vertices);
        if checkpoint.node_count() != self.basis().node_count() || !is_whole {
            return Err(ResumeError::Basis);
        }
        let field = |values: &Vec<Vec3>| Field::from_values(values.clone());
        let accuracy: Option<Accuracy> = serde_json::from_value(meta.accuracy.clone()).ok();
        let errors = checkpoint.standard_error.as_ref().map(field).zip(accuracy);
        let bounces = checkpoint.bounces.iter().map(field).collect();
        Ok(self.continued(SolveState {
            shot: checkpoint.shot.as_ref().map(|shot| ShotLight {
                reflected: field(&shot.reflected),
                unshot: field(&shot.unshot),
                shots: shot.shots,
            }),
            tail: checkpoint.tail.as_ref().map(field),
            read_direct: checkpoint.direct.as_ref().map(field),
            errors: errors.map(|(standard_error, accuracy)| Errors { standard_error, accuracy }),
            rounds: checkpoint.rounds.clone(),
            ..self.state(checkpoint.valid.clone(), bounces)
        }))
    }

    /// [`resume`](Self::resume) from a solution.
    ///
    /// # Errors
    /// As there, and with a target error.
    pub fn resume_solution(&self, solution: &Solution) -> Result<SolveState, ResumeError> {
        solution.check_belongs_to(self.scene())?;
        if !solution.has_lighting_of(self.scene()) {
            return Err(ResumeError::Lighting);
        }
        let found = self.check_settings(&solution.meta.settings)?;
        if let Method::Replicates { .. } = self.method() {
            return Err(ResumeError::TargetError);
        }
        if self.basis().points().is_some() {
            return self.resume_points(solution);
        }
        let first_vertices = self.surfaces().vertices.first_vertices();
        // What was read as the nearest function is carried as means.
        let unread = (found.projection == Projection::LeastSquares).then(|| self.surfaces().least_squares());
        let at_nodes = |values: &Vec<Vec3>| self.at_nodes(values, unread);
        let valid = first_vertices.iter().map(|&v| solution.valid[v as usize]).collect();
        Ok(self.continued(self.state(valid, solution.bounces.iter().map(at_nodes).collect())))
    }

    /// [`resume`](Self::resume) from the points of a solution.
    fn resume_points(&self, solution: &Solution) -> Result<SolveState, ResumeError> {
        let points = solution.points.as_ref().filter(|points| points.len() == self.basis().node_count());
        let points = points.ok_or(ResumeError::Basis)?;
        let bounces = points.bounces.iter().map(|values| Field::from_values(values.clone())).collect();
        Ok(self.continued(self.state(points.valid.clone(), bounces)))
    }

    /// The light of a file of a solve that was shot, which is done: to be measured, not to be continued.
    ///
    /// # Errors
    /// As [`resume`](Self::resume).
    pub fn shot_light(&self, saved: &Saved) -> Result<SolveState, ResumeError> {
        let state = self.resume(saved)?;
        let Saved::Solution(solution) = saved else { return Ok(state) };
        let mut reflected = Field::zeros(state.node_count());
        match (&solution.tail, &solution.points) {
            (_, Some(SolutionPoints { tail: Some(tail), .. })) => {
                reflected = Field::from_values(tail.clone())
            }
            (Some(tail), None) => reflected = self.at_nodes(tail, self.least_squares()),
            _ => {}
        }
        let unshot = Field::zeros(state.node_count());
        let shot = Some(ShotLight { reflected, unshot, shots: 0 });
        let is_read = self.settings().projection == Projection::LeastSquares;
        let unread = is_read.then(|| self.surfaces().least_squares());
        let direct = self.basis().points().and(solution.bounces.first());
        let read_direct = direct.map(|direct| self.at_nodes(direct, unread));
        Ok(SolveState { shot, read_direct, ..state })
    }

    /// Light at vertices that was read as the nearest function, as it is carried.
    fn at_nodes(&self, values: &[Vec3], unread: Option<&LeastSquares>) -> Field {
        let first_vertices = self.surfaces().vertices.first_vertices();
        let mut field = Field::from_values(first_vertices.iter().map(|&v| values[v as usize]).collect());
        unread.inspect(|least_squares| least_squares.unproject(&mut field));
        field
    }

    /// The state from which a solve with these settings continues a solve of the same bounces, of which it may ask for
    /// more or fewer.
    ///
    /// Bounces beyond those that an uninterrupted solve computes are left out, and so is what is made of all of them. Shots stay,
    /// even if they went further than is asked for: what was sent cannot be taken back. With
    /// a target error, the rounds stay, too; their errors and the tail only if they are those of the bounces asked for.
    pub fn continued(&self, state: SolveState) -> SolveState {
        if let Method::Replicates { .. } = self.method() {
            let mut state = state;
            self.problem().reopen(&mut state);
            return state;
        }
        let wanted = self.problem().schedule.wanted(&state, &PowerLog::of(self.integrals(), &state.bounces));
        let SolveState { basis, valid, mut bounces, shot, read_direct, .. } = state;
        bounces.truncate(wanted.unwrap_or(usize::MAX));
        SolveState { basis, valid, bounces, shot, read_direct, ..SolveState::new() }
    }

    /// A state of these bounces.
    fn state(&self, valid: Vec<bool>, bounces: Vec<Field>) -> SolveState {
        SolveState { basis: Some(self.basis().identity()), valid, bounces, ..SolveState::new() }
    }

    /// The settings from a file, if the bounces that were computed with them are those of this baker.
    fn check_settings(&self, found: &Value) -> Result<Settings, ResumeError> {
        let Some(found) = serde_json::from_value::<Settings>(found.clone()).ok() else {
            let differences = "they are unknown to this version".to_owned();
            return Err(ResumeError::Settings { differences });
        };
        let method = assembly::method(self.scene(), self.order(), &found);
        if found.same_bounces_as(self.settings()) && method == self.method() {
            return Ok(found);
        }
        Err(ResumeError::Settings { differences: self.settings().differences_of_bounces(&found) })
    }
}
