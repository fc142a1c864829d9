//! Taking in what a running job publishes, and how it ends.

use super::running::{Errand, Then};
use super::{Computed, Hand, Session};
use crate::lumel_light::LumelIllumination;
use crate::mesh::{Given, Mesh};
use crate::notice::Level;
use crate::solver::{Ending, Phase};
use lumel::{Control, Directional, TargetError};
use std::sync::Arc;

impl Session {
    pub(super) fn poll_solve(&mut self, hand: Hand) {
        let Some(running) = &mut self.running else { return };
        let (generation, phase) = running.job.glance();
        let shown_whole = running.follows() && phase != Phase::Ended(Ending::Done);
        if generation != running.seen && !shown_whole {
            running.seen = generation;
            let published = running.job.published();
            let mut taken = true;
            match running.errand {
                // The old light stays in sight until there is some of the new.
                Errand::Solve | Errand::Follow | Errand::Read { .. } if published.light.is_empty() => {
                    taken = false
                }
                Errand::Solve | Errand::Follow | Errand::Read { .. } => {
                    let before = self.light.directional.take().or(self.light.directional_before.take());
                    let measures = running.settings().directional != Directional::Off;
                    self.light = published.light;
                    self.light.directional_before = before.filter(|_| measures);
                    self.stats = published.stats;
                    self.unshot = published.unshot;
                    if running.errand == Errand::Solve {
                        self.courses.follow(&published.course);
                    }
                    self.take_mesh(published.mesh.as_deref(), &phase);
                }
                Errand::StandardError => self.light.standard_error = published.light.standard_error,
                Errand::Lumels => return self.poll_lumels(published.lumels, phase),
            }
            self.light_generation += u64::from(taken);
        }
        match phase {
            Phase::Ended(ending) => self.finish(ending),
            _ if hand == Hand::Free => self.heed_changes(),
            _ => {}
        }
    }

    /// Shows the triangles that light which was taken in is on, and notes what that is computed from.
    fn take_mesh(&mut self, mesh: Option<&Mesh>, phase: &Phase) {
        if let Some(mesh) = mesh {
            self.show_mesh(mesh);
        }
        let (Some(running), Some(document)) = (&mut self.running, &self.document) else { return };
        // What was painted meanwhile is a change.
        if let Some(mesh) = mesh.filter(|mesh| !mesh.is_of(&running.inputs.scene)) {
            let unpainted = mesh.scene.materials() != document.scene.materials();
            running.inputs.scene = Arc::clone(if unpainted { &mesh.scene } else { &document.scene });
        }
        let inputs = running.inputs.clone();
        if let Phase::Refining { .. } = phase {
            self.refined_for = None;
        }
        self.computed = Some(Computed::unfinished(inputs.clone()));
        self.note_refined_for(Some(inputs));
    }

    /// The same for the light of lumels, beside which that of vertices stays.
    fn poll_lumels(&mut self, light: Option<LumelIllumination>, phase: Phase) {
        self.take_lumels(light);
        if let Phase::Ended(ending) = phase {
            self.finish(ending);
        }
    }

    /// Reacts to changes during a solve: different lights or samples restart it, a different number of bounces
    /// continues it.
    fn heed_changes(&mut self) {
        let asked_for = self.running.as_ref().filter(|r| r.errand == Errand::Solve && !r.job.is_stopping());
        let Some(running) = asked_for else { return };
        let changes = self.changes_since(&running.inputs);
        let (then, text) = if !changes.any() {
            return;
        } else if changes.outdates() || self.settings.target_error != TargetError::Off {
            (Then::Restart, format!("{changes}: solving again"))
        } else {
            let what = if changes.bounces { "number of bounces" } else { "projection" };
            (Then::GoOn, format!("Continuing with the new {what}"))
        };
        let Some(running) = &mut self.running else { return };
        running.then = then;
        running.job.stop();
        self.notices.push(Level::Info, text);
    }

    fn finish(&mut self, ending: Ending) {
        let Some(mut running) = self.running.take() else { return };
        running.job.join();
        self.light.directional_before = None;
        let problem = running.job.published().checkpoint_problem;
        if let Some(problem) = problem {
            let text = format!("The checkpoint could not be written; save the solution: {problem}");
            self.notices.push(Level::Warning, text);
        }
        match running.errand {
            Errand::StandardError => return self.finish_standard_error(&ending),
            Errand::Lumels => return self.finish_lumels(&ending, running.job.seconds()),
            Errand::Solve | Errand::Follow | Errand::Read { .. } => {}
        }
        if running.follows() && ending != Ending::Done {
            if let Ending::Failed(problem) = ending {
                self.live = false;
                self.notices.push(Level::Error, format!("Live relighting failed: {problem}"));
            }
            return;
        }
        let done = ending == Ending::Done;
        if let (Some(given), Some(document)) = (running.job.given(), &mut self.document) {
            document.given = Given::Known(given);
        }
        if let (Some(refinement), Some(computed)) = (running.job.refinement(), &mut self.computed) {
            computed.refinement = Some(Box::new(refinement));
        }
        if let (Some(solved), Some(document)) = (running.job.solved(), &mut self.document) {
            // With it come the rays that it has stored: the next solve needs no new ones for other lights.
            document.baker = Arc::clone(&solved.baker);
            if done && running.errand == Errand::Solve {
                for finding in solved.baker.light_findings(&Control::default()).unwrap_or_default() {
                    self.notices.push(Level::Warning, format!("{finding}; {}", finding.remedy()));
                }
            }
        }
        if let (Some(solved), Some(computed)) = (running.job.solved(), &mut self.computed) {
            (computed.complete, computed.seconds) = match running.errand {
                Errand::Read { complete, seconds } => (complete, seconds),
                _ => (done, Some(running.job.seconds())),
            };
            computed.solved = Some(solved);
        }
        if running.follows() {
            return self.note_completion();
        }
        match (ending, running.then) {
            (Ending::Failed(problem), _) => {
                if self.light.is_empty() {
                    // What could not be resumed may still be of use, to another version or with the old mesh.
                    self.leave_place();
                }
                self.notices.push(Level::Error, format!("The solve failed: {problem}"))
            }
            (_, Then::Restart) => self.start_solve(self.begin_anew()),
            (_, Then::GoOn) => self.solve(),
            (Ending::Done, Then::Rest) => {
                let seconds = running.job.seconds();
                let found = self.reflections();
                let text = format!("Solved: direct light and {found} in {seconds:.1} s");
                self.notices.push(Level::Info, text);
                if let Some(limit) = running.job.vertices_missing() {
                    let limit = crate::values::grouped(limit);
                    let text = format!(
                        "The mesh does not follow light everywhere: that takes more than {limit} vertices"
                    );
                    self.notices.push(Level::Warning, text);
                }
                self.warn_of_dark_faces();
            }
            (Ending::Stopped, Then::Rest) => {
                let is_refined = self.computed.as_ref().is_some_and(|c| c.refinement.is_some());
                let text = match self.light.bounces.len() {
                    _ if is_refined => "Stopped; press Enter to refine the mesh further",
                    0 => "Stopped before any light was computed",
                    _ if self.settings.target_error != TargetError::Off => {
                        "Stopped; press Enter to resume after the last finished round"
                    }
                    _ if !self.tells_bounces() => {
                        "Stopped; press Enter to resume after the last finished shot"
                    }
                    _ => "Stopped; press Enter to resume after the last finished bounce",
                };
                self.notices.push(Level::Info, text);
            }
        }
        self.note_completion();
    }

    /// What was found besides direct light, in words.
    fn reflections(&self) -> String {
        match self.computed.as_ref().and_then(Computed::shots) {
            Some(shots) => format!("{shots} shots"),
            None => format!("{} bounces", self.light.bounce_count().saturating_sub(1)),
        }
    }

    fn finish_standard_error(&mut self, ending: &Ending) {
        match ending {
            Ending::Done => {
                self.notices.push(Level::Info, "Measured the standard error; select it under Display");
            }
            Ending::Stopped => self.notices.push(Level::Info, "Stopped; the standard error was not measured"),
            Ending::Failed(problem) => {
                self.notices.push(Level::Error, format!("The standard error cannot be measured: {problem}"));
            }
        }
    }

    fn warn_of_dark_faces(&mut self) {
        let Some(solved) = self.computed.as_ref().and_then(|c| c.solved.clone()) else { return };
        let dark = solved.baker.dark_faces(&solved.state, &Control::default()).unwrap_or(0);
        if dark > 0 {
            let text = format!(
                "{dark} visible triangles stay dark because all their vertices lie inside geometry: solve by \
                 least squares, or reopen the scene with a smaller longest edge"
            );
            self.notices.push(Level::Warning, text);
        }
    }
}
