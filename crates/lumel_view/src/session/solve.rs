//! Starting and stopping solves.

use super::courses::{GoesOn, Rays};
use super::running::{Errand, Running, Then};
use super::{Hand, Session};
use crate::document::Document;
use crate::inputs::Inputs;
use crate::notice::Level;
use crate::solver::{Keep, Phase, SolveJob, SolveStart, Task, Work};
use lumel::{Saved, Scene, Settings, SolveState};
use lumel_basis::Sampling;
use std::sync::Arc;

impl Session {
    /// Whether a solve runs.
    pub fn is_solving(&self) -> bool {
        self.running.as_ref().is_some_and(|r| !r.follows() && r.is_under_way())
    }

    /// What a running job is doing.
    pub fn phase(&self) -> Option<Phase> {
        let asked_for = self.running.as_ref().filter(|r| !r.follows());
        asked_for.map(|r| r.job.glance().1).filter(|phase| !matches!(phase, Phase::Ended(_)))
    }

    /// What has to be done before anything can be solved; `None` where nothing has.
    pub fn obstacle_to_solve(&self) -> Option<&'static str> {
        let Some(document) = &self.document else { return Some("Open a scene first") };
        let text = "This scene has no light source: press Space to add one at the camera";
        (!document.shines(&self.lights)).then_some(text)
    }

    /// Starts a solve: resumes a stopped one, or starts from scratch when lights or settings have changed.
    pub fn solve(&mut self) {
        if self.is_following() {
            self.end_solve();
        }
        if let Some(running) = &mut self.running
            && running.job.ending().is_none()
        {
            if running.job.is_stopping() {
                running.then = Then::GoOn;
            } else {
                self.notices.push(Level::Info, "A solve is already running; press Esc to stop it");
            }
            return;
        }
        let Some(start) = self.start_point() else {
            if self.resume_lumels() {
                return;
            }
            let text = "Already solved for these lights and settings: ask for more bounces or rays, \
                        or change the seed";
            self.notices.push(Level::Info, text);
            return;
        };
        self.start_solve(start);
    }

    /// Starts a solve from scratch, even if the light is up to date.
    pub fn solve_anew(&mut self) {
        self.running = None;
        self.start_solve(self.begin_anew());
    }

    /// Where the next solve begins; `None` when there is nothing left to do.
    fn start_point(&self) -> Option<SolveStart> {
        let Some(computed) = &self.computed else { return Some(self.begin_anew()) };
        let changes = self.changes_since(&computed.inputs);
        if changes.outdates() || self.follows_other_light() && !self.is_solving() {
            return Some(self.begin_anew());
        }
        if computed.complete && !changes.any() {
            return None;
        }
        if computed.refinement.is_some() {
            return Some(SolveStart::Refine(computed.refinement.clone()));
        }
        if !self.resumes(computed, changes) {
            return Some(self.begin_anew());
        }
        Some(match (&computed.solved, &computed.file) {
            (Some(solved), _) => SolveStart::From(Box::new(solved.state.clone())),
            (None, Some(file)) => SolveStart::FromFile(Saved::Solution(Box::new((**file).clone()))),
            (None, None) => self.begin_anew(),
        })
    }

    pub(super) fn start_solve(&mut self, start: SolveStart) {
        if let Some(obstacle) = self.obstacle_to_solve() {
            self.notices.push(Level::Warning, obstacle);
            return;
        }
        let Some(document) = &self.document else { return };
        let scene = match document.relit(&self.lights) {
            Ok(scene) => scene,
            Err(problem) => {
                self.notices.push(Level::Error, format!("Cannot solve: {problem}"));
                return;
            }
        };
        let mut task = task(document, &scene, &self.settings);
        if let SolveStart::Anew = start
            && document.opened.scene().geometry_hash() != scene.geometry_hash()
        {
            // The mesh that is shown was refined.
            match crate::mesh::lit_like(document.opened.scene(), &scene) {
                Ok(scene) => (task.scene, task.baker) = (scene, Arc::clone(&document.opened)),
                Err(problem) => return self.notices.push(Level::Error, format!("Cannot solve: {problem}")),
            }
        }
        task.first_look = true;
        let inputs = self.inputs(&scene, &self.settings);
        let rays = if task.baker.has_rays_of(&self.settings) { Rays::Stored } else { Rays::New };
        let goes_on = if matches!(start, SolveStart::From(_)) { GoesOn::Yes } else { GoesOn::No };
        self.courses.begin(&self.settings, rays, goes_on);
        let keep = self.keeper();
        self.run(inputs, task, Work::Solve(start), keep, Errand::Solve);
    }

    /// Solves for lights or materials that have changed.
    pub(super) fn follow(&mut self, settings: Settings) {
        let Some(document) = &self.document else { return };
        let Ok(scene) = document.relit(&self.lights) else { return };
        let task = task(document, &scene, &settings);
        // What lies inside geometry is known already, where points are measured.
        let solved = self.computed.as_ref().and_then(|computed| computed.solved.as_ref());
        let start = match solved {
            Some(solved) if settings.projection.sampling() == Sampling::Point => {
                let SolveState { basis, ref valid, .. } = solved.state;
                let known = SolveState { basis, valid: valid.clone(), ..SolveState::new() };
                SolveStart::From(Box::new(known))
            }
            _ => SolveStart::Anew,
        };
        // Checkpoints of what takes a moment are not worth a file for each step of a hand.
        let at_rest = settings == self.settings;
        let keep = if at_rest { self.keeper() } else { None };
        let inputs = self.inputs(&scene, &settings);
        self.run(inputs, task, Work::Solve(start), keep, Errand::Follow);
    }

    /// Reads the light again when the settings ask for another reading of the same bounces.
    pub(super) fn follow_reading(&mut self) {
        let Some(computed) = self.computed.as_ref().filter(|_| self.running.is_none()) else { return };
        let (Some(solved), Some(settings)) = (&computed.solved, computed.settings()) else { return };
        let changes = self.changes_since(&computed.inputs);
        let (Some(document), true) = (&self.document, changes.reading && !changes.outdates()) else { return };
        let settings = Settings { projection: self.settings.projection, ..settings.clone() };
        let task = task(document, solved.baker.scene(), &settings);
        let errand = Errand::Read { complete: computed.complete, seconds: computed.seconds };
        let inputs = Inputs { settings: Some(settings), ..computed.inputs.clone() };
        let work = Work::Read(Arc::clone(solved));
        self.run(inputs, task, work, None, errand);
    }

    /// Starts a job; `inputs` is what its light is computed from.
    pub(super) fn run(&mut self, inputs: Inputs, task: Task, work: Work, keep: Keep, errand: Errand) {
        let job = SolveJob::start(task, work, Arc::clone(&self.pool), keep, self.wakes.clone());
        self.running = Some(Running { job, inputs, seen: 0, then: Then::Rest, errand });
    }

    /// Measures the standard error of the light at every vertex.
    pub fn measure_standard_error(&mut self) {
        let computed = self.computed.as_ref().filter(|c| c.complete && !self.is_solving());
        let solved = computed.and_then(|c| Some((c.solved.clone()?, c.inputs.clone())));
        let (Some((solved, inputs)), Some(document)) = (solved, &self.document) else {
            self.notices
                .push(Level::Warning, "Finish the solve first: then the standard error can be measured");
            return;
        };
        let task = task(document, solved.baker.scene(), solved.baker.settings());
        self.run(inputs, task, Work::StandardError(solved), None, Errand::StandardError);
    }

    /// Stops what runs; its finished bounces stay.
    pub fn stop(&mut self) {
        if let Some(running) = &mut self.running {
            running.then = Then::Rest;
            running.job.stop();
        }
    }

    /// Stops what runs, waits for it and takes in what it has done: milliseconds.
    pub(super) fn end_solve(&mut self) {
        self.stop();
        if let Some(running) = &mut self.running {
            running.job.join();
        }
        self.poll_solve(Hand::Busy);
        self.running = None;
    }
}

pub(super) fn task(document: &Document, scene: &Arc<Scene>, settings: &Settings) -> Task {
    // What was stopped while edges were split has left a baker of other triangles.
    let baker = if document.has_baker() { &document.baker } else { &document.opened };
    let (scene, baker) = (Arc::clone(scene), Arc::clone(baker));
    Task { scene, baker, settings: settings.clone(), given: document.given.clone(), first_look: false }
}
