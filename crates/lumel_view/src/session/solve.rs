//! Starting, stopping and following solves.

use super::{Hand, Session};
use crate::document::Document;
use crate::lights::{EditLight, shining};
use crate::notice::Level;
use crate::recovery::{Note, Recovery};
use crate::selection::Light;
use crate::solver::{Ending, Job, Keep, Phase, Solved, Start, Task, Work};
use lumel::{
    Accuracy, Baker, BasisKind, LightEntry, LightFile, RectLight, Scene, Settings, Solution, SolveState,
    TargetError,
};
use std::sync::Arc;

/// What the light on the surfaces was computed from.
#[derive(Clone)]
pub struct Computed {
    /// The scene with the lights that shone.
    pub scene: Arc<Scene>,
    /// The lights that shone, as far as they can be edited; `None` for light from a file for other lights.
    pub lights: Option<Vec<RectLight>>,
    /// The settings; `None` where a file does not tell.
    pub settings: Option<Settings>,
    /// Whether all bounces that the settings ask for are there.
    pub complete: bool,
    /// Whether it is in a file of the user's.
    pub saved: bool,
    /// What computed it, when that was this session.
    pub solved: Option<Arc<Solved>>,
    /// The file it was read from.
    pub file: Option<Arc<Solution>>,
    /// What to call it.
    pub origin: Option<String>,
    /// How long the solve took, when it was done here.
    pub seconds: Option<f64>,
}

impl Computed {
    /// What a solve with a target error has reached.
    pub fn accuracy(&self) -> Option<Accuracy> {
        Some(self.solved.as_ref()?.state.errors.as_ref()?.accuracy)
    }

    /// What it is, in a few words.
    pub fn label(&self, light: &Light) -> String {
        let bounces = light.bounce_count().saturating_sub(1);
        match (&self.settings, &self.origin) {
            (_, Some(origin)) => origin.clone(),
            (Some(s), None) if s.target_error != TargetError::Off => {
                format!("{} rays as far as needed, {bounces} bounces", s.sampler)
            }
            (Some(s), None) => {
                format!("{} {}+{} rays, {bounces} bounces", s.sampler, s.direct_samples, s.indirect_samples)
            }
            (None, None) => format!("{bounces} bounces"),
        }
    }
}

/// A job and what it was started for.
pub(super) struct Running {
    pub(super) job: Job,
    scene: Arc<Scene>,
    lights: Vec<RectLight>,
    seen: u64,
    then: Then,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Asked for.
    Solve,
    /// After a change of lights, by itself: shown when it is done.
    Follow,
    StandardError,
}

impl Running {
    pub(super) fn kind(&self) -> Kind {
        self.kind
    }

    pub(super) fn settings(&self) -> &Settings {
        self.job.settings()
    }

    pub(super) fn stop(&self) {
        self.job.stop();
    }

    pub(super) fn is_under_way(&self) -> bool {
        self.job.ending().is_none()
    }
}

/// What to do when a job that was asked to stop has stopped.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Then {
    Rest,
    Restart,
    GoOn,
}

impl Session {
    /// Whether a solve runs.
    pub fn is_solving(&self) -> bool {
        self.running.as_ref().is_some_and(|r| r.kind != Kind::Follow && r.is_under_way())
    }

    /// What a running job is doing.
    pub fn phase(&self) -> Option<Phase> {
        let asked_for = self.running.as_ref().filter(|r| r.kind != Kind::Follow);
        asked_for.map(|r| r.job.glance().1).filter(|phase| !matches!(phase, Phase::Ended(_)))
    }

    /// What the light was computed from.
    pub fn computed(&self) -> Option<&Computed> {
        self.computed.as_ref()
    }

    /// Whether lights or settings have changed since the light was computed.
    pub fn is_stale(&self) -> bool {
        let Some(computed) = self.computed.as_ref().filter(|_| !self.is_solving()) else { return false };
        if self.follows(computed) {
            return false;
        }
        !self.is_lit_as(computed)
            || computed.settings.as_ref().is_some_and(|s| !s.same_bounces_as(&self.settings))
    }

    /// Whether lights and materials are those that light was computed for.
    pub(super) fn is_lit_as(&self, computed: &Computed) -> bool {
        computed.lights.as_ref().is_some_and(|lights| self.is_lit_by(&computed.scene, lights))
    }

    /// Whether what runs solves for the lights and materials that there are now.
    pub(super) fn is_running_for_now(&self) -> bool {
        self.running.as_ref().is_some_and(|running| self.is_lit_by(&running.scene, &running.lights))
    }

    fn is_lit_by(&self, scene: &Scene, lights: &[RectLight]) -> bool {
        *lights == shining(&self.lights)
            && self.document.as_ref().is_some_and(|document| document.has_materials_of(scene))
    }

    /// Solves for the light: goes on where a solve was stopped, or begins anew when lights or settings have changed.
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
                self.notices.push(Level::Info, "A solve is running already; Esc stops it");
            }
            return;
        }
        let Some(start) = self.start_point() else {
            let text = "This is solved already with these lights and settings: ask for more bounces or rays, \
                        or another seed";
            self.notices.push(Level::Info, text);
            return;
        };
        self.start_solve(start);
    }

    /// Solves from the beginning, whatever there is.
    pub fn solve_anew(&mut self) {
        self.running = None;
        self.start_solve(Start::Anew);
    }

    /// Whether the next solve goes on where one was stopped; one with a target error does not keep its rays.
    pub fn can_go_on(&self) -> bool {
        self.settings.target_error == TargetError::Off
            && !self.light.is_empty()
            && !self.is_stale()
            && self.computed.as_ref().is_some_and(|computed| !computed.complete)
    }

    /// Where the next solve begins; `None` when there is nothing left to do.
    fn start_point(&self) -> Option<Start> {
        let Some(computed) = &self.computed else { return Some(Start::Anew) };
        let same_bounces = computed.settings.as_ref().is_some_and(|s| s.same_bounces_as(&self.settings));
        if !(self.is_lit_as(computed) && same_bounces) {
            return Some(Start::Anew);
        }
        if computed.complete && computed.settings.as_ref() == Some(&self.settings) {
            return None;
        }
        if self.settings.target_error != TargetError::Off {
            return Some(Start::Anew);
        }
        match (&computed.solved, &computed.file) {
            (Some(solved), _) => Some(Start::From(self.wanted(&solved.state))),
            (None, Some(file)) => Some(Start::FromFile(Box::new((**file).clone()))),
            (None, None) => Some(Start::Anew),
        }
    }

    /// A state without the bounces that are no longer asked for.
    fn wanted(&self, state: &SolveState) -> SolveState {
        let mut state = state.clone();
        state.tail = None;
        if let lumel::BounceLimit::Count(n) = self.settings.bounces {
            state.bounces.truncate(n as usize + 1);
        }
        state
    }

    fn start_solve(&mut self, start: Start) {
        let Some(document) = &self.document else {
            self.notices.push(Level::Warning, "Open a scene first");
            return;
        };
        if !document.shines(&self.lights) {
            let text = "Nothing shines in this scene: press Space to put a light where you are";
            self.notices.push(Level::Warning, text);
            return;
        }
        let scene = match document.relit(&self.lights) {
            Ok(scene) => scene,
            Err(problem) => {
                self.notices.push(Level::Error, format!("Cannot solve: {problem}"));
                return;
            }
        };
        let task = task(document, &scene, &self.settings);
        let keep = self.keeper();
        self.run(task, Work::Solve(start), keep, Kind::Solve);
    }

    /// Solves for lights or materials that have changed.
    pub(super) fn follow(&mut self, settings: Settings) {
        let Some(document) = &self.document else { return };
        let Ok(scene) = document.relit(&self.lights) else { return };
        let task = task(document, &scene, &settings);
        // What lies inside geometry is known already, where points are measured.
        let solved = self.computed.as_ref().and_then(|computed| computed.solved.as_ref());
        let valid = match solved {
            Some(solved) if settings.basis == BasisKind::Vertex => solved.state.valid.clone(),
            _ => Vec::new(),
        };
        let start = Start::From(SolveState { valid, ..SolveState::new() });
        // Checkpoints of what takes a moment are not worth a file for each step of a hand.
        let at_rest = settings == self.settings;
        let keep = if at_rest { self.keeper() } else { Box::new(|_: &Baker, _: &SolveState| Ok(())) };
        self.run(task, Work::Solve(start), keep, Kind::Follow);
    }

    fn run(&mut self, task: Task, work: Work, keep: Keep, kind: Kind) {
        let scene = Arc::clone(&task.scene);
        let job = Job::start(task, work, Arc::clone(&self.pool), keep, self.wakes.clone());
        let lights = shining(&self.lights);
        self.running = Some(Running { job, scene, lights, seen: 0, then: Then::Rest, kind });
    }

    /// Measures the standard error of the light at every vertex.
    pub fn measure_standard_error(&mut self) {
        let solved = self.computed.as_ref().filter(|c| c.complete).and_then(|c| c.solved.clone());
        let (Some(solved), Some(document), false) = (solved, &self.document, self.is_solving()) else {
            self.notices
                .push(Level::Warning, "Solve to the end first: then the standard error can be measured");
            return;
        };
        let task = task(document, solved.baker.scene(), solved.baker.settings());
        self.run(task, Work::StandardError(solved), Box::new(|_, _| Ok(())), Kind::StandardError);
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

    pub(super) fn poll_solve(&mut self, hand: Hand) {
        let Some(running) = &mut self.running else { return };
        let (generation, phase) = running.job.glance();
        let shown_whole = running.kind == Kind::Follow && phase != Phase::Ended(Ending::Done);
        if generation != running.seen && !shown_whole {
            running.seen = generation;
            let published = running.job.published();
            match running.kind {
                // The old light stays in sight until there is some of the new.
                Kind::Solve | Kind::Follow if published.light.is_empty() => {}
                Kind::Solve | Kind::Follow => {
                    self.light = published.light;
                    self.stats = published.stats;
                    self.computed = Some(Computed {
                        scene: Arc::clone(&running.scene),
                        lights: Some(running.lights.clone()),
                        settings: Some(running.job.settings().clone()),
                        complete: false,
                        saved: false,
                        solved: None,
                        file: None,
                        origin: None,
                        seconds: None,
                    });
                }
                Kind::StandardError => self.light.standard_error = published.light.standard_error,
            }
            self.light_generation += 1;
        }
        match phase {
            Phase::Ended(ending) => self.finish(ending),
            _ if hand == Hand::Free => self.heed_changes(),
            _ => {}
        }
    }

    /// What a change of lights or settings in mid-solve does: other lights or samples begin anew, another number of
    /// bounces goes on.
    fn heed_changes(&mut self) {
        let Some(running) = self.running.as_ref().filter(|r| r.kind == Kind::Solve && !r.job.is_stopping())
        else {
            return;
        };
        let before = running.job.settings();
        let same_bounces = before.same_bounces_as(&self.settings) && before.target_error == TargetError::Off;
        let (then, text) = if !self.is_lit_by(&running.scene, &running.lights) {
            (Then::Restart, "Lights or materials have changed: solving anew")
        } else if *before == self.settings {
            return;
        } else if same_bounces {
            (Then::GoOn, "Going on with another number of bounces")
        } else {
            (Then::Restart, "The settings have changed: solving anew")
        };
        let Some(running) = &mut self.running else { return };
        running.then = then;
        running.job.stop();
        self.notices.push(Level::Info, text);
    }

    fn finish(&mut self, ending: Ending) {
        let Some(mut running) = self.running.take() else { return };
        running.job.join();
        let problem = running.job.published().checkpoint_problem;
        if let Some(problem) = problem {
            let text = format!("No checkpoint was written, save the solution yourself: {problem}");
            self.notices.push(Level::Warning, text);
        }
        if running.kind == Kind::StandardError {
            return self.finish_standard_error(&ending);
        }
        if running.kind == Kind::Follow && ending != Ending::Done {
            if let Ending::Failed(problem) = ending {
                self.live = false;
                self.notices.push(Level::Error, format!("The light no longer follows: {problem}"));
            }
            return;
        }
        let done = ending == Ending::Done;
        if let (Some(solved), Some(document)) = (running.job.solved(), &mut self.document) {
            // With it come the rays that it has stored: the next solve needs no new ones for other lights.
            document.baker = Arc::clone(&solved.baker);
        }
        if let (Some(solved), Some(computed)) = (running.job.solved(), &mut self.computed) {
            computed.complete = done;
            computed.seconds = Some(running.job.seconds());
            computed.solved = Some(solved);
        }
        if running.kind == Kind::Follow {
            return self.note_completion();
        }
        match (ending, running.then) {
            (Ending::Failed(problem), _) => {
                if self.light.is_empty() {
                    // What could not be gone on with may still be of use, to another version or with the old mesh.
                    self.leave_place();
                }
                self.notices.push(Level::Error, format!("The solve failed: {problem}"))
            }
            (_, Then::Restart) => self.start_solve(Start::Anew),
            (_, Then::GoOn) => self.solve(),
            (Ending::Done, Then::Rest) => {
                let seconds = running.job.seconds();
                let bounces = self.light.bounce_count().saturating_sub(1);
                let text = format!("Solved: direct light and {bounces} bounces in {seconds:.1} s");
                self.notices.push(Level::Info, text);
                self.warn_of_dark_faces();
            }
            (Ending::Stopped, Then::Rest) => {
                let text = match self.light.bounces.len() {
                    0 => "Stopped before there was any light",
                    _ if !self.can_go_on() => "Stopped; the light is that of the last finished round",
                    _ => "Stopped; Enter goes on after the last finished bounce",
                };
                self.notices.push(Level::Info, text);
            }
        }
        self.note_completion();
    }

    /// Keeps unsaved work somewhere else from now on.
    fn leave_place(&mut self) {
        self.recovery = self.recovery.as_ref().map(Recovery::another);
    }

    fn finish_standard_error(&mut self, ending: &Ending) {
        match ending {
            Ending::Done => {
                self.notices.push(Level::Info, "The standard error is known; see it under Display");
            }
            Ending::Stopped => self.notices.push(Level::Info, "Stopped; the standard error is not known"),
            Ending::Failed(problem) => {
                self.notices.push(Level::Error, format!("The standard error cannot be measured: {problem}"));
            }
        }
    }

    fn warn_of_dark_faces(&mut self) {
        let Some(solved) = self.computed.as_ref().and_then(|c| c.solved.clone()) else { return };
        let dark = solved.baker.dark_faces(&solved.state);
        if dark > 0 {
            let text = format!(
                "{dark} visible triangles stay dark because all their vertices lie inside geometry: open the scene \
                 with a smaller longest edge"
            );
            self.notices.push(Level::Warning, text);
        }
    }

    /// Whether there is light that is in no file of the user's.
    pub fn has_unsaved_light(&self) -> bool {
        !self.light.bounces.is_empty() && self.computed.as_ref().is_some_and(|c| !c.saved)
    }

    /// Writes the bounces to the place for unsaved work after each; does nothing where there is no such place.
    fn keeper(&self) -> Keep {
        let (Some(recovery), Some(note)) = (self.recovery.clone(), self.note()) else {
            return Box::new(|_, _| Ok(()));
        };
        Box::new(move |baker, state| {
            let mut solution = baker.solution(state);
            solution.meta.complete = false;
            let note = Note { bounces: state.bounces.len(), complete: false, ..note.clone() };
            recovery.write(&note, Some(&solution))
        })
    }

    /// Tells the place for unsaved work that the solve is done.
    fn note_completion(&self) {
        let complete = self.computed.as_ref().is_some_and(|c| c.complete);
        if let (true, Some(recovery), Some(note)) = (complete, &self.recovery, self.note())
            && recovery.note().is_some()
        {
            // The note that is there only says that the last bounce is missing.
            let _ = recovery.write(&note, None);
        }
    }

    /// What unsaved work belongs to; `None` when nothing is open.
    pub(super) fn note(&self) -> Option<Note> {
        let document = self.document.as_ref()?;
        let request = &document.request;
        let absolute = std::path::Path::new(&request.name).canonicalize();
        Some(Note {
            scene: absolute.map_or_else(|_| request.name.clone(), |p| p.to_string_lossy().into_owned()),
            max_edge: request.options.max_edge,
            subdivide: request.options.subdivide,
            paths_anywhere: request.options.paths == lumel::PathPolicy::Anywhere,
            lights: self.lights.iter().map(EditLight::entry).collect(),
            albedos: self.albedos.clone(),
            slots: self.slots.entries(),
            settings: self.settings.clone(),
            camera: self.camera,
            bounces: if self.has_unsaved_light() { self.light.bounces.len() } else { 0 },
            complete: self.computed.as_ref().is_some_and(|c| c.complete),
            process: std::process::id(),
        })
    }

    /// Goes on with unsaved work in the scene that was opened for it.
    pub(super) fn restore_into_document(&mut self, recovery: Recovery, left: Note) {
        let textures: Vec<_> = self.lights.iter().map(|light| light.rect.texture).collect();
        let entry = |(i, entry): (usize, &LightEntry)| {
            EditLight::from_entry(
                i,
                entry,
                textures.get(i).copied().flatten().filter(|_| entry.texture.is_some()),
            )
        };
        self.lights = left.lights.iter().enumerate().map(entry).collect();
        if left.albedos.len() == self.albedos.len() {
            self.albedos.clone_from(&left.albedos);
            self.paint();
        }
        self.slots = crate::slots::Slots::from_entries(&left.slots);
        self.settings = left.settings.clone();
        self.camera = left.camera;
        // What was left behind is this session's now; what the solve goes on with is kept in its place.
        self.recovery = Some(recovery.clone());
        if let Some(note) = self.note() {
            // The note that is there says the same, but for the process.
            let _ = recovery.write(&Note { bounces: left.bounces, complete: left.complete, ..note }, None);
        }
        if left.bounces > 0 {
            match Solution::load(&recovery.checkpoint()) {
                Ok(solution) if left.settings.target_error != TargetError::Off => {
                    // Its rays are not kept, so it cannot be gone on with.
                    let text = format!("Restored {}; Enter begins anew", left.summary());
                    self.notices.push(Level::Info, text);
                    self.show_light(
                        LightFile::Solution(Box::new(solution)),
                        "unsaved solution".into(),
                        false,
                    );
                }
                Ok(solution) => {
                    self.notices.push(Level::Info, format!("Restored {}", left.summary()));
                    self.start_solve(Start::FromFile(Box::new(solution)));
                }
                Err(problem) => {
                    let text = format!("The unsaved solution cannot be read: {problem}");
                    self.notices.push(Level::Error, text);
                    self.leave_place();
                }
            }
        } else {
            self.notices.push(Level::Info, format!("Restored {}", left.summary()));
        }
    }

    /// The solution of the light there is, without a bounce that is being measured.
    pub fn solution(&self) -> Option<Solution> {
        let (document, computed) = (self.document.as_ref()?, self.computed.as_ref()?);
        let scene = &document.scene;
        let light = Light { current: None, ..self.light.clone() };
        let n = scene.vertex_count();
        let settings =
            computed.settings.as_ref().and_then(|s| serde_json::to_value(s).ok()).unwrap_or_default();
        let mut meta = match &computed.file {
            Some(file) => file.meta.clone(),
            None => lumel_export::SolutionMeta::new(&computed.scene, settings),
        };
        meta.complete = computed.complete;
        let valid = if light.valid.len() == n { light.valid.to_vec() } else { vec![true; n] };
        Some(Solution {
            meta,
            positions: scene.positions().to_vec(),
            normals: scene.normals().to_vec(),
            irradiance: light.select(crate::selection::Selection::All, n),
            bounces: light.bounces.iter().map(|b| b.to_vec()).collect(),
            tail: light.tail.as_ref().map(|t| t.to_vec()),
            valid,
            standard_error: light.standard_error.as_ref().map(|e| e.to_vec()),
        })
    }
}

fn task(document: &Document, scene: &Arc<Scene>, settings: &Settings) -> Task {
    Task {
        scene: Arc::clone(scene),
        baker: Arc::clone(&document.baker),
        neighbours: Arc::clone(&document.neighbours),
        areas: Arc::clone(&document.areas),
        settings: settings.clone(),
    }
}
