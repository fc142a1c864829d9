//! The state of a bake on disk, so that hours of work survive a crash.

use crate::console::Console;
use crate::failure;
use crate::outputs::folder_of;
use lumel::{Baker, LumelState, RefinementState, SolveState};
use lumel_export::SolutionError;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The checkpoint of a bake.
pub(crate) struct Checkpoint {
    path: PathBuf,
    console: Arc<Console>,
    on_disk: Mutex<OnDisk>,
}

/// What is known about the file.
#[derive(Default)]
struct OnDisk {
    /// Whether it exists and contains all finished bounces.
    current: bool,
    /// Whether this bake wrote it or resumed from it.
    ours: bool,
    /// Whether it was reported that it cannot be written.
    failure_told: bool,
}

/// The checkpoint of a bake whose first output is this.
pub(crate) fn path_for(first_output: &Path) -> PathBuf {
    let mut name = first_output.file_stem().unwrap_or_default().to_owned();
    name.push(".checkpoint.npz");
    first_output.with_file_name(name)
}

impl Checkpoint {
    /// A checkpoint that has not been written yet.
    pub(crate) fn new(path: PathBuf, console: &Arc<Console>) -> Self {
        Self { path, console: Arc::clone(console), on_disk: Mutex::default() }
    }

    /// The file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The bake resumes from this file, which may be the checkpoint itself.
    pub(crate) fn resumed_from(&self, file: &Path) {
        let same = file.canonicalize().ok().zip(self.path.canonicalize().ok()).is_some_and(|(a, b)| a == b);
        if same {
            self.lock().ours = true;
            self.lock().current = true;
        }
    }

    /// Saves the finished bounces, and the light at lumels that is gathered from them if there is some. If that fails, for
    /// example on a full disk, the bake continues without a checkpoint.
    pub(crate) fn save(&self, baker: &Baker, state: &SolveState, lumels: Option<LumelState<'_>>) {
        self.note(baker.checkpoint(state).save_with(lumels, &self.path));
    }

    /// Saves how far the mesh of a baker's scene is refined, likewise.
    pub(crate) fn save_refinement(&self, baker: &Baker, state: RefinementState) {
        self.note(baker.checkpoint_of_refinement(state).save(&self.path));
    }

    fn note(&self, result: Result<(), SolutionError>) {
        let mut on_disk = self.lock();
        on_disk.current = result.is_ok();
        on_disk.ours |= result.is_ok();
        if let Err(error) = result
            && !std::mem::replace(&mut on_disk.failure_told, true)
        {
            let problem = failure::text(&error.into());
            self.console.warning(&format!("no checkpoint; the bake continues without one: {problem}"));
        }
    }

    /// More is finished than is on disk.
    pub(crate) fn outdated(&self) {
        self.lock().current = false;
    }

    /// Saves what is finished unless it is on disk.
    pub(crate) fn update(&self, baker: &Baker, state: &SolveState) {
        if !self.is_current() {
            self.save(baker, state, None);
        }
    }

    /// Whether the last finished bounce is on disk.
    pub(crate) fn is_current(&self) -> bool {
        self.lock().current
    }

    /// Removes the file if it belongs to this bake.
    pub(crate) fn remove(&self) {
        if self.lock().ours
            && let Err(error) = fs::remove_file(&self.path)
        {
            let (path, folder) = (self.path.display(), folder_of(&self.path).display());
            self.console.warning(&format!("cannot remove the checkpoint from {folder} ({error}): {path}"));
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, OnDisk> {
        self.on_disk.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checkpoint_lies_beside_the_first_output() {
        assert_eq!(path_for(Path::new("out/room.v2.glb")), Path::new("out/room.v2.checkpoint.npz"));
        assert_eq!(path_for(Path::new("a.npz")), Path::new("a.checkpoint.npz"));
    }
}
