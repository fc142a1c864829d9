//! Files that only one process at a time writes.

use crate::atomic::{PREFIX, folder_of, follow_links};
use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// The ending of temporary files, and that of the files whose locks stand for outputs.
pub(crate) const TEMPORARY: &str = ".tmp";
const LOCK: &str = ".lock";

/// How often a lock is tried whose file another process has just removed.
const TRIES: usize = 8;

/// Files that are younger may be about to be locked.
const YOUTH: Duration = Duration::from_secs(60);

/// The right to write a file, until it is dropped or the process ends, however it does.
///
/// It is the lock of a hidden file `.lumel-*.lock` beside it, which is removed when it is given back.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    /// Open, and so locked.
    _file: File,
}

/// Another process writes the file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("another run of lumel{} is writing this file: {}", .process.map(|id| format!(" (process {id})")).unwrap_or_default(), .path.display())]
pub struct LockError {
    /// The file.
    pub path: PathBuf,
    /// The number of the process, where it is known.
    pub process: Option<u32>,
}

impl Lock {
    /// Takes the lock of a file that is to be written. `None` where the file system knows no locks.
    ///
    /// # Errors
    /// [`LockError`] if another process has it.
    pub fn take(output: &Path) -> Result<Option<Self>, LockError> {
        let target = follow_links(output);
        let mut name = OsString::from(PREFIX);
        name.push(target.file_name().unwrap_or_default());
        name.push(LOCK);
        let path = folder_of(&target).join(name);
        for _ in 0..TRIES {
            let options = File::options().read(true).write(true).create(true).truncate(false).open(&path);
            let Ok(mut file) = options else { return Ok(None) };
            match file.try_lock() {
                Ok(()) if is_at(&file, &path) => {
                    // It is there for messages only.
                    let _ = file.set_len(0).and_then(|()| write!(file, "{}", std::process::id()));
                    return Ok(Some(Self { path, _file: file }));
                }
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let process = owner(&mut file);
                    return Err(LockError { path: output.to_owned(), process });
                }
                Err(TryLockError::Error(_)) => return Ok(None),
            }
        }
        Ok(None)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Left over, it is locked by no one, and removed some day.
        let _ = fs::remove_file(&self.path);
    }
}

/// The process that has written its number into a locked file.
fn owner(file: &mut File) -> Option<u32> {
    let mut text = String::new();
    file.rewind().ok()?;
    file.take(16).read_to_string(&mut text).ok()?;
    text.parse().ok()
}

/// Removes what killed processes have left in a folder: temporary files, and files of locks, that nobody has locked.
///
/// What cannot be removed stays.
pub fn remove_strays(folder: &Path) {
    let now = SystemTime::now();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.as_encoded_bytes();
        let is_ours = name.starts_with(PREFIX.as_bytes())
            && [TEMPORARY, LOCK].iter().any(|ending| name.ends_with(ending.as_bytes()));
        let is_old = || {
            let modified = entry.metadata().ok().filter(fs::Metadata::is_file)?.modified().ok()?;
            now.duration_since(modified).ok().filter(|age| *age >= YOUTH)
        };
        if !is_ours || is_old().is_none() {
            continue;
        }
        let path = entry.path();
        if let Ok(file) = File::options().write(true).open(&path)
            && file.try_lock().is_ok()
            && is_at(&file, &path)
        {
            // Another process may have been faster.
            let _ = fs::remove_file(path);
        }
    }
}

/// Whether an open file is still the one of its name.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let known = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    file.metadata().ok().map(known) == fs::metadata(path).ok().map(known)
}

/// Open files keep their names there.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_written_by_one_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.npz", "b.npz"].map(|name| folder.path().join(name));
        let first = Lock::take(&a).unwrap().unwrap();
        let error = Lock::take(&a).unwrap_err();
        assert_eq!((&error.path, error.process), (&a, Some(std::process::id())));
        assert!(error.to_string().contains(&format!("(process {}) is writing", std::process::id())));
        let other = Lock::take(&b).unwrap();
        drop(first);
        drop((Lock::take(&a).unwrap().unwrap(), other));
        assert_eq!(names(folder.path()), [""; 0]);
    }

    #[test]
    #[cfg(unix)]
    fn a_link_is_locked_as_the_file_it_leads_to() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link.npz");
        std::os::unix::fs::symlink("a.npz", &link).unwrap();
        let _first = Lock::take(&folder.path().join("a.npz")).unwrap().unwrap();
        assert!(Lock::take(&link).is_err());
    }

    #[test]
    fn what_killed_processes_leave_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let long_ago = SystemTime::now() - 2 * YOUTH;
        let make = |name: &str, age| {
            let file = File::create(path(name)).unwrap();
            file.set_modified(age).unwrap();
            file
        };
        let kept = [".lumel-young.tmp", ".lumel-held.tmp", ".lumel-held.lock", "mine.tmp", ".lumel-notes"];
        let ages = [SystemTime::now(), long_ago, long_ago, long_ago, long_ago];
        let files: Vec<File> = kept.iter().zip(ages).map(|(name, age)| make(name, age)).collect();
        files[1].try_lock().unwrap();
        files[2].try_lock().unwrap();
        for stray in [".lumel-x.tmp", ".lumel-a.npz.lock"] {
            drop(make(stray, long_ago));
        }
        remove_strays(folder.path());
        let mut kept = kept;
        kept.sort_unstable();
        assert_eq!(names(folder.path()), kept);
        remove_strays(&path("missing"));
    }
}
