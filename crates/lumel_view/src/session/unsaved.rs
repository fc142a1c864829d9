//! Unsaved work: saving it for the next run, restoring it, discarding it.

use super::{Computed, Session, skies};
use crate::lights::EditLight;
use crate::notice::Level;
use crate::recovery::{LeftBehind, Note, Recovery};
use crate::selection::{Illumination, Selection};
use crate::slots::Slots;
use crate::solver::{Keep, SolveStart};
use lumel::{LightEntry, LightFile, Saved, Solution, SolutionLayer, TargetError};

impl Session {
    /// Whether there is light that the user has not saved.
    pub fn has_unsaved_light(&self) -> bool {
        !self.light.bounces.is_empty() && self.computed.as_ref().is_some_and(|c| !c.saved)
    }

    /// Writes the state to the place for unsaved work after each bounce or round; `None` where there is no such place.
    pub(super) fn keeper(&self) -> Keep {
        let (recovery, note) = (self.recovery.clone()?, self.note()?);
        Some(Box::new(move |checkpoint| {
            let (bounces, refining) = (checkpoint.bounces.len(), checkpoint.refinement.is_some());
            let shots = checkpoint.shot.as_ref().map_or(0, |shot| shot.shots);
            let note = Note { bounces, shots, refining, complete: false, ..note.clone() };
            recovery.write(&note, Some(checkpoint))
        }))
    }

    /// Marks the unsaved work as complete when the solve has finished.
    pub(super) fn note_completion(&self) {
        let complete = self.computed.as_ref().is_some_and(|c| c.complete);
        if let (true, Some(recovery), Some(note)) = (complete, &self.recovery, self.note())
            && recovery.note().is_some()
        {
            // The note that is there only says that the last bounce is missing.
            let _ = recovery.write(&note, None);
        }
    }

    /// Describes the unsaved work; `None` when no scene is open.
    fn note(&self) -> Option<Note> {
        let document = self.document.as_ref()?;
        let request = &document.request;
        let absolute = std::path::Path::new(&request.name).canonicalize();
        Some(Note {
            scene: absolute.map_or_else(|_| request.name.clone(), |p| p.to_string_lossy().into_owned()),
            max_edge: request.options.max_edge,
            subdivide: request.options.subdivide,
            two_sided: request.options.two_sided.clone(),
            paths_anywhere: request.options.paths == lumel::PathPolicy::Anywhere,
            lights: self.lights.iter().map(EditLight::entry).collect(),
            sky: self.sky.entry().filter(|_| self.sky != document.sky),
            albedos: self.albedos.clone(),
            slots: self.slots.entries(),
            settings: self.settings.clone(),
            camera: self.camera,
            bounces: if self.has_unsaved_light() { self.light.bounces.len() } else { 0 },
            shots: self.computed.as_ref().and_then(Computed::shots).unwrap_or(0),
            refining: self.computed.as_ref().is_some_and(|c| c.refinement.is_some()),
            complete: self.computed.as_ref().is_some_and(|c| c.complete),
            process: std::process::id(),
        })
    }

    /// Restores unsaved work into the scene that was opened for it.
    pub(super) fn restore_into_document(&mut self, LeftBehind { place: recovery, note: left }: LeftBehind) {
        let textures: Vec<_> = self.lights.iter().map(|light| light.rect.texture).collect();
        let entry = |(i, entry): (usize, &LightEntry)| {
            EditLight::from_entry(
                i,
                entry,
                textures.get(i).copied().flatten().filter(|_| entry.texture.is_some()),
            )
        };
        self.lights = left.lights.iter().enumerate().map(entry).collect();
        match left.sky.as_ref().map(skies::read) {
            Some(Ok(sky)) => self.light_from(sky),
            Some(Err(problem)) => self.notices.push(Level::Error, format!("Cannot load the sky: {problem}")),
            None => {}
        }
        if left.albedos.len() == self.albedos.len() {
            self.albedos.clone_from(&left.albedos);
        }
        self.paint();
        self.slots = Slots::from_entries(&left.slots);
        self.settings = left.settings.clone();
        self.camera = left.camera;
        // The files now belong to this session; the resumed solve overwrites them.
        self.recovery = Some(recovery.clone());
        if let Some(note) = self.note() {
            // The note that is there says the same, but for the process.
            let _ = recovery.write(
                &Note {
                    bounces: left.bounces,
                    shots: left.shots,
                    refining: left.refining,
                    complete: left.complete,
                    ..note
                },
                None,
            );
        }
        if left.bounces > 0 || left.refining {
            match Saved::load(&recovery.checkpoint()) {
                Ok(Saved::Solution(solution)) if left.settings.target_error != TargetError::Off => {
                    // Of an earlier version. A solution does not tell the rounds of a target error.
                    let text = format!("Restored {}; press Enter to solve again", left.summary());
                    self.notices.push(Level::Info, text);
                    self.show_light(LightFile::Solution(solution), "unsaved solution".into(), false);
                }
                Ok(saved) => {
                    self.notices.push(Level::Info, format!("Restored {}", left.summary()));
                    self.start_solve(SolveStart::FromFile(saved));
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

    /// Keeps unsaved work in a new place from now on.
    pub(super) fn leave_place(&mut self) {
        self.recovery = self.recovery.as_ref().map(Recovery::another);
    }

    /// Ends the session: stops what runs and keeps unsaved work for the next run.
    pub fn close(&mut self) {
        self.end_solve();
        for task in self.saving.drain(..) {
            // The window is gone; a failure leaves the work to be recovered.
            let _ = task.wait();
        }
        let Some(recovery) = &self.recovery else { return };
        let has_unsaved_mesh = self.computed.as_ref().is_some_and(|c| c.refinement.is_some());
        if !(self.has_unsaved_light() || has_unsaved_mesh || self.has_unsaved_edits()) {
            recovery.remove();
            return;
        }
        let Some(note) = self.note() else { return };
        let computed = self.computed.as_ref().filter(|_| self.has_unsaved_light());
        // Unsaved light that this session did not compute was restored: its file is there.
        let solved = computed.and_then(|computed| computed.solved.as_ref());
        let checkpoint = solved.map(|solved| solved.baker.checkpoint(&solved.state));
        // There is nobody left to tell; the checkpoint of the last bounce is still there.
        let _ = recovery.write(&note, checkpoint.as_ref());
    }

    /// Opens the scene of unsaved work and restores it.
    pub fn restore(&mut self) {
        if let Some(left) = self.left_behind.take() {
            self.open(left.note.request());
            self.restoring = Some(left);
        }
    }

    /// Deletes unsaved work of an earlier run.
    pub fn discard_left_behind(&mut self) {
        if let Some(left) = self.left_behind.take() {
            left.place.remove();
        }
    }

    /// The current solution, without the bounce that is being measured.
    pub fn solution(&self) -> Option<Solution> {
        let (document, computed) = (self.document.as_ref()?, self.computed.as_ref()?);
        let scene = &document.scene;
        // A file holds all light as solved, whatever layers are dimmed in the window.
        let layers = self.light.layers.iter().map(|layer| SolutionLayer {
            name: layer.name.clone(),
            irradiance: layer.values.to_vec(),
            directional: layer.directional.as_deref().cloned(),
        });
        let layers = layers.collect();
        let light = Illumination { current: None, layers: Vec::new(), ..self.light.clone() };
        let n = scene.vertex_count();
        let settings = computed.settings().and_then(|s| serde_json::to_value(s).ok()).unwrap_or_default();
        let mut meta = match &computed.file {
            Some(file) => file.meta.clone(),
            None => lumel_export::SolutionMeta::new(&computed.inputs.scene, settings),
        };
        meta.complete = computed.complete;
        let valid = if light.valid.len() == n { light.valid.to_vec() } else { vec![true; n] };
        Some(Solution {
            meta,
            positions: scene.world_positions().collect(),
            normals: scene.normals().to_vec(),
            irradiance: light.select(Selection::All, n),
            bounces: light.bounces.iter().map(|b| b.to_vec()).collect(),
            tail: light.tail.as_ref().map(|t| t.to_vec()),
            valid,
            standard_error: light.standard_error.as_ref().map(|e| e.to_vec()),
            layers,
            directional: light.directional.as_deref().cloned(),
            occlusion: None,
            splits: scene.refinement().map_or(Vec::new(), |refinement| refinement.splits().to_vec()),
            points: self.light.points.as_ref().map(|points| points.for_solution(scene)),
        })
    }
}
