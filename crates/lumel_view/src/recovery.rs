//! Unsaved work on disk, so that neither closing the window nor a power cut loses it.
//!
//! After each step of a refinement, each bounce or round, and when the window is closed, the state of the solve is written as a checkpoint
//! (`NAME.checkpoint.npz`, which `lumel bake --resume` takes too) with a note of what it belongs to
//! (`NAME.recovery.json`). The next start offers to resume it. Both are removed once the work is saved or discarded.
//! Lumels are not among it: they are measured again from the bounces.
//! Earlier versions wrote a solution in place of the checkpoint; it is still read.
//!
//! Each process that keeps unsaved work locks a file of its own there for as long as it runs (`process-ID.lock`): no
//! other start offers its work.

use crate::camera::FlyCamera;
use crate::document::{OpenRequest, error_text};
use glam::Vec3;
use lumel::{Checkpoint, LightEntry, MaxEdge, OpenOptions, PathPolicy, Settings, SkyEntry, SlotEntry};
use lumel_export::write_atomically;
use serde::{Deserialize, Serialize};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

const NOTE_END: &str = ".recovery.json";
const CHECKPOINT_END: &str = ".checkpoint.npz";
const LOCK_START: &str = "process-";
const LOCK_END: &str = ".lock";

/// What unsaved work belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Note {
    /// The scene: an absolute path, or a built-in.
    pub scene: String,
    /// Longest edge after tessellation.
    pub max_edge: Option<MaxEdge>,
    /// Levels of refinement of a built-in scene.
    pub subdivide: Option<u32>,
    /// What was made two-sided.
    #[serde(default)]
    pub two_sided: Vec<String>,
    /// Whether the scene's files may lie outside its folder.
    pub paths_anywhere: bool,
    /// All lights.
    pub lights: Vec<LightEntry>,
    /// The sky, if it is another one than that of the scene.
    #[serde(default)]
    pub sky: Option<SkyEntry>,
    /// The albedo of each material.
    #[serde(default)]
    pub albedos: Vec<Vec3>,
    /// Numbered states.
    pub slots: Vec<SlotEntry>,
    /// Settings of the solve.
    pub settings: Settings,
    /// The view.
    pub camera: FlyCamera,
    /// Bounces in the checkpoint, direct light included; 0 when there is none.
    pub bounces: usize,
    /// Shots in the checkpoint, after direct light.
    #[serde(default)]
    pub shots: u32,
    /// Whether its checkpoint is a mesh that is still being refined.
    #[serde(default)]
    pub refining: bool,
    /// Whether the solve was finished.
    pub complete: bool,
    /// Process that wrote it: while it runs, the work is not lost.
    pub process: u32,
}

/// Unsaved work that another process left behind.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftBehind {
    /// Where it is.
    pub place: Recovery,
    /// What it belongs to.
    pub note: Note,
}

/// The place of one session's unsaved work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recovery {
    folder: PathBuf,
    name: String,
}

impl Recovery {
    /// A place for this process that is not taken.
    pub fn of_this_process(folder: &Path) -> Self {
        let id = std::process::id();
        // Numbers of processes come again: what another one left behind under this one is not to be replaced.
        let name = |n: u32| if n == 0 { format!("unsaved-{id}") } else { format!("unsaved-{id}-{n}") };
        let place = |n| Self { folder: folder.to_owned(), name: name(n) };
        let taken = |place: &Self| place.file(NOTE_END).exists() || place.checkpoint().exists();
        (0..u32::MAX).map(place).find(|place| !taken(place)).unwrap_or_else(|| place(0))
    }

    /// Another place in the same folder: what is in this one stays for a later start.
    pub fn another(&self) -> Self {
        Self::of_this_process(&self.folder)
    }

    /// Unsaved work that other processes left behind, the newest first.
    pub fn left_behind(folder: &Path) -> Vec<LeftBehind> {
        let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
        let running = other_processes(folder);
        let mut found: Vec<_> = entries
            .flatten()
            .filter_map(|entry| {
                let file = entry.file_name().to_string_lossy().into_owned();
                let name = file.strip_suffix(NOTE_END)?.to_owned();
                let place = Self { folder: folder.to_owned(), name };
                let note = place.note()?;
                let modified = entry.metadata().and_then(|m| m.modified()).ok();
                (!running.contains(&note.process)).then_some((modified, LeftBehind { place, note }))
            })
            .collect();
        found.sort_by_key(|(modified, _)| std::cmp::Reverse(*modified));
        found.into_iter().map(|(_, found)| found).collect()
    }

    fn file(&self, end: &str) -> PathBuf {
        self.folder.join(format!("{}{end}", self.name))
    }

    /// The checkpoint.
    pub fn checkpoint(&self) -> PathBuf {
        self.file(CHECKPOINT_END)
    }

    /// The note; `None` when there is none or it is damaged.
    pub fn note(&self) -> Option<Note> {
        serde_json::from_slice(&fs::read(self.file(NOTE_END)).ok()?).ok()
    }

    /// Writes the work: first the checkpoint, or none to keep that which is there, then the note that names it.
    ///
    /// # Errors
    /// What went wrong, with the file.
    pub fn write(&self, note: &Note, checkpoint: Option<&Checkpoint>) -> Result<(), String> {
        let in_folder = |e: io::Error| format!("{e}: {}", self.folder.display());
        fs::create_dir_all(&self.folder).map_err(in_folder)?;
        lock(&self.folder).map_err(in_folder)?;
        if let Some(checkpoint) = checkpoint {
            checkpoint.save(&self.checkpoint()).map_err(|e| error_text(&e))?;
        }
        let text = serde_json::to_vec_pretty(note).map_err(|e| e.to_string())?;
        write_atomically(&self.file(NOTE_END), |out| out.write_all(&text)).map_err(|e| error_text(&e))
    }

    /// Removes both files, if they are there.
    pub fn remove(&self) {
        // The note first: a checkpoint without one is not offered. What cannot be removed is offered again.
        let _ = fs::remove_file(self.file(NOTE_END));
        let _ = fs::remove_file(self.checkpoint());
    }
}

impl Note {
    /// How to open its scene.
    pub fn request(&self) -> OpenRequest {
        let paths = if self.paths_anywhere { PathPolicy::Anywhere } else { PathPolicy::default() };
        OpenRequest {
            name: self.scene.clone(),
            options: OpenOptions {
                paths,
                max_edge: self.max_edge,
                vertex_budget: None,
                adaptive: None,
                subdivide: self.subdivide,
                two_sided: self.two_sided.clone(),
                keeps_whole: false,
            },
        }
    }

    /// What it is, for a question.
    pub fn summary(&self) -> String {
        let work = match (self.bounces, self.complete) {
            (0, _) if self.refining => "a mesh that is being refined".to_owned(),
            (0, _) => "lights, materials and slots".to_owned(),
            (n, true) => format!("a finished solve with {}", found(n, self.shots)),
            (n, false) => format!("a solve stopped after {}", found(n, self.shots)),
        };
        format!("{}: {work}", self.request().title())
    }
}

/// Direct light and so many bounces or shots after it.
fn found(n: usize, shots: u32) -> String {
    match n {
        _ if shots > 0 => format!("{shots} shots"),
        1 => "direct light".to_owned(),
        2 => "1 bounce".to_owned(),
        n => format!("{} bounces", n - 1),
    }
}

/// The file that a process locks while it runs.
fn lock_file(folder: &Path, process: u32) -> PathBuf {
    folder.join(format!("{LOCK_START}{process}{LOCK_END}"))
}

/// Locks the file of this process in a folder, until the process ends; does nothing if that was done before.
///
/// A file system without locks is no error: work there is offered while its process runs.
fn lock(folder: &Path) -> io::Result<()> {
    static LOCKS: Mutex<Vec<(PathBuf, File)>> = Mutex::new(Vec::new());
    let mut locks = LOCKS.lock().unwrap_or_else(PoisonError::into_inner);
    if !locks.iter().any(|(locked, _)| locked == folder) {
        let file = File::create(lock_file(folder, std::process::id()))?;
        let _ = file.try_lock();
        locks.push((folder.to_owned(), file));
    }
    Ok(())
}

/// Other processes that keep work in a folder and still run. Removes the lock files of those that do not.
fn other_processes(folder: &Path) -> Vec<u32> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut running = Vec::new();
    for entry in entries {
        let file = entry.file_name().to_string_lossy().into_owned();
        let process = file.strip_prefix(LOCK_START).and_then(|rest| rest.strip_suffix(LOCK_END));
        let Some(process) = process.and_then(|process| process.parse().ok()) else { continue };
        let Ok(lock) = File::open(entry.path()) else { continue };
        if process == std::process::id() {
            continue;
        }
        if matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) {
            running.push(process);
        } else {
            // One that cannot be removed does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
    running
}

#[cfg(test)]
mod tests {
    use super::*;

    fn note() -> Note {
        Note {
            scene: "cornell-box".into(),
            max_edge: Some(MaxEdge::Length(0.1)),
            subdivide: None,
            two_sided: Vec::new(),
            paths_anywhere: false,
            lights: Vec::new(),
            sky: None,
            albedos: Vec::new(),
            slots: Vec::new(),
            settings: Settings::default(),
            camera: FlyCamera::default(),
            bounces: 3,
            shots: 0,
            refining: false,
            complete: false,
            // No process has this number.
            process: u32::MAX,
        }
    }

    #[test]
    fn work_is_found_again_until_it_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Recovery::left_behind(folder.path()), []);
        let recovery = Recovery { folder: folder.path().join("deeper"), name: "unsaved-1".into() };
        recovery.write(&note(), None).unwrap();
        let found = Recovery::left_behind(&folder.path().join("deeper"));
        assert_eq!(found, [LeftBehind { place: recovery.clone(), note: note() }]);
        assert_eq!(found[0].note.request().options.max_edge, Some(MaxEdge::Length(0.1)));
        assert_eq!(found[0].note.summary(), "cornell-box: a solve stopped after 2 bounces");
        let shot = Note { bounces: 1, shots: 7, ..note() };
        assert_eq!(shot.summary(), "cornell-box: a solve stopped after 7 shots");
        recovery.remove();
        assert_eq!(Recovery::left_behind(&folder.path().join("deeper")), []);
    }

    #[test]
    fn work_left_behind_under_the_number_of_this_process_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let first = Recovery::of_this_process(folder.path());
        assert_eq!(first, Recovery::of_this_process(folder.path()), "nothing is there yet");
        first.write(&note(), None).unwrap();
        let second = Recovery::of_this_process(folder.path());
        assert_ne!(first, second);
        second.remove();
        assert_eq!(Recovery::left_behind(folder.path()), [LeftBehind { place: first, note: note() }]);
    }

    #[test]
    fn work_of_a_running_process_and_damaged_notes_are_not_offered() {
        let folder = tempfile::tempdir().unwrap();
        let recovery = Recovery { folder: folder.path().to_owned(), name: "unsaved-2".into() };
        // What the other process holds.
        let path = lock_file(folder.path(), note().process);
        let lock = File::create(&path).unwrap();
        lock.lock().unwrap();
        recovery.write(&note(), None).unwrap();
        fs::write(folder.path().join("x.recovery.json"), "{\"scene\": 3").unwrap();
        assert_eq!(Recovery::left_behind(folder.path()), []);
        // It ends.
        drop(lock);
        assert_eq!(Recovery::left_behind(folder.path()), [LeftBehind { place: recovery, note: note() }]);
        assert!(!path.exists());
    }

    #[test]
    fn work_of_this_process_is_locked_for_others() {
        let folder = tempfile::tempdir().unwrap();
        let recovery = Recovery::of_this_process(folder.path());
        recovery.write(&note(), None).unwrap();
        let seen_by_others = File::open(lock_file(folder.path(), std::process::id())).unwrap();
        assert!(matches!(seen_by_others.try_lock(), Err(TryLockError::WouldBlock)));
    }
}
