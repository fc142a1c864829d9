//! Atomic file writing.

use crate::ExportError;
use crate::lock::TEMPORARY;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// The beginning of the names of files that are there while others are written.
pub(crate) const PREFIX: &str = ".lumel-";

/// Links followed before a path counts as a loop; the limit of Linux.
const MAX_LINKS: usize = 40;

/// Writes a temporary file beside the target and renames it once everything is on disk.
///
/// Readers of `path` see either the old or the new content, never a part, even after a crash or a power failure. A new
/// file gets default permissions; a replaced file keeps its own. A symbolic link is kept and the file it points to is
/// replaced. A process killed while writing leaves a hidden `.lumel-*.tmp` beside the file, which
/// [`remove_strays`](crate::remove_strays) removes.
///
/// # Errors
/// [`ExportError`] names the file and the remedy. The temporary file is removed and the old content kept.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), ExportError> {
    let target = follow_links(path);
    let old = check_replaceable(path, &target)?;
    replace(&target, old, write).map_err(|error| ExportError::io(path, error))
}

fn replace(
    target: &Path,
    old: Option<fs::Metadata>,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let folder = folder_of(target);
    let (file, temporary) = create_temporary(folder)?.into_parts();
    // Tells it apart from those that killed processes leave; where there are no locks, those stay.
    let _ = file.try_lock();
    let mut out = BufWriter::with_capacity(1 << 18, file);
    write(&mut out)?;
    let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Some(old) = old {
        // On a file system without permissions, the result is kept all the same.
        let _ = file.set_permissions(old.permissions());
    }
    file.sync_all()?;
    // Windows cannot rename a file that is open.
    drop(file);
    temporary.persist(target)?;
    sync_folder(folder)
}

/// Checks that `target` is a file or does not exist; returns the metadata of the file.
fn check_replaceable(path: &Path, target: &Path) -> Result<Option<fs::Metadata>, ExportError> {
    // The text is checked too: "folder/" and "folder/." would otherwise be shortened to the name of a file.
    let names_folder = path.as_os_str().to_string_lossy().ends_with(['/', std::path::MAIN_SEPARATOR]);
    let path = path.to_owned();
    match fs::metadata(target) {
        Ok(old) if old.is_dir() => Err(ExportError::NotAFile { path, what: "a folder" }),
        Ok(old) if !old.is_file() => Err(ExportError::NotAFile { path, what: "a device or pipe" }),
        Ok(old) if old.permissions().readonly() => Err(ExportError::WriteProtected { path }),
        Ok(old) => Ok(Some(old)),
        Err(_) if names_folder || target.file_name().is_none() => Err(ExportError::NoFileName { path }),
        Err(_) if target.is_symlink() => Err(ExportError::NotAFile { path, what: "a circular link" }),
        // No old file, or none that is accessible: creating the new one reports the reason.
        Err(_) => Ok(None),
    }
}

/// The file that a path refers to, whether it exists or not.
pub(crate) fn follow_links(path: &Path) -> PathBuf {
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(next) = fs::read_link(&target) else { break };
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    target
}

/// The folder of a file; the current folder for a bare name.
pub(crate) fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn create_temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(TEMPORARY);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The default of every program; the system applies the umask.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Makes a rename survive a power failure.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        // Fails for folders that cannot be listed and on file systems without support.
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::PermissionDenied | io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        result => result,
    }
}

/// Windows offers no way to do this; its file systems log renames.
#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_as_a_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_atomically(&path, |out| out.write_all(b"a long first version")).unwrap();
        write_atomically(&path, |out| out.write_all(b"second")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_full_disk_leaves_the_old_content_and_nothing_partial() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        let error = write_atomically(&path, |out| {
            out.write_all(&[7; 1 << 20])?;
            Err(io::ErrorKind::StorageFull.into())
        })
        .unwrap_err();
        assert!(matches!(error, ExportError::DiskFull { .. }));
        let message = error.to_string();
        assert!(message.starts_with("the disk is full; free some space") && message.contains("a.txt"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_missing_folder_and_a_folder_as_target_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let nothing = |_: &mut BufWriter<File>| Ok(());
        let missing = folder.path().join("missing/a.txt");
        let error = write_atomically(&missing, nothing).unwrap_err();
        assert!(matches!(error, ExportError::NoFolder { .. }), "{error}");
        assert!(error.to_string().contains("missing"));
        for inside in ["", ".", "new/", "..", "new/.."] {
            let error = write_atomically(&folder.path().join(inside), nothing).unwrap_err();
            assert!(
                matches!(error, ExportError::NotAFile { .. } | ExportError::NoFileName { .. }),
                "{inside}: {error}"
            );
        }
        assert!(matches!(write_atomically(Path::new(""), nothing), Err(ExportError::NoFileName { .. })));
        assert_eq!(names(folder.path()), [""; 0]);
    }

    #[test]
    fn a_write_protected_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        let error = write_atomically(&path, |out| out.write_all(b"new")).unwrap_err();
        assert!(matches!(error, ExportError::WriteProtected { .. }));
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn a_bare_name_is_in_the_current_folder() {
        assert_eq!(folder_of(Path::new("out.npz")), Path::new("."));
        assert_eq!(folder_of(Path::new("results/out.npz")), Path::new("results"));
        assert_eq!(folder_of(Path::new("/out.npz")), Path::new("/"));
    }

    #[cfg(unix)]
    mod unix {
        use super::*;
        use std::os::unix::fs::PermissionsExt;

        fn mode(path: &Path) -> u32 {
            fs::metadata(path).unwrap().permissions().mode() & 0o777
        }

        #[test]
        fn new_files_have_the_usual_permissions_and_replaced_ones_keep_theirs() {
            let folder = tempfile::tempdir().unwrap();
            let (usual, path) = (folder.path().join("usual"), folder.path().join("a.txt"));
            fs::write(&usual, "").unwrap();
            write_atomically(&path, |out| out.write_all(b"new")).unwrap();
            assert_eq!(mode(&path), mode(&usual));
            fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
            write_atomically(&path, |out| out.write_all(b"newer")).unwrap();
            assert_eq!(mode(&path), 0o640);
        }

        #[test]
        fn a_link_stays_a_link() {
            let folder = tempfile::tempdir().unwrap();
            let (link, file) = (folder.path().join("link"), folder.path().join("sub/file"));
            fs::create_dir(folder.path().join("sub")).unwrap();
            std::os::unix::fs::symlink("sub/file", &link).unwrap();
            for text in ["first", "second"] {
                write_atomically(&link, |out| out.write_all(text.as_bytes())).unwrap();
                assert_eq!(fs::read_to_string(&file).unwrap(), text);
                assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            }
            let to_folder = folder.path().join("to_folder");
            std::os::unix::fs::symlink("sub", &to_folder).unwrap();
            let error = write_atomically(&to_folder, |_| Ok(())).unwrap_err();
            assert!(matches!(error, ExportError::NotAFile { what: "a folder", .. }));
        }

        #[test]
        fn a_loop_of_links_is_an_error() {
            let folder = tempfile::tempdir().unwrap();
            let link = folder.path().join("loop");
            std::os::unix::fs::symlink("loop", &link).unwrap();
            let error = write_atomically(&link, |out| out.write_all(b"x")).unwrap_err();
            assert!(matches!(error, ExportError::NotAFile { what: "a circular link", .. }));
        }

        #[test]
        fn devices_and_pipes_are_not_replaced() {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("socket");
            // Stands for them all: a broken check must not cost anyone the real `/dev/null`.
            let _socket = std::os::unix::net::UnixListener::bind(&path).unwrap();
            let error = write_atomically(&path, |_| Ok(())).unwrap_err();
            assert!(matches!(error, ExportError::NotAFile { what: "a device or pipe", .. }));
            assert!(!fs::metadata(&path).unwrap().is_file());
        }

        #[test]
        fn a_folder_without_permission_is_named() {
            let folder = tempfile::tempdir().unwrap();
            fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o555)).unwrap();
            let path = folder.path().join("a.txt");
            match write_atomically(&path, |out| out.write_all(b"new")) {
                // The administrator may write anywhere.
                Ok(()) => assert_eq!(fs::read(&path).unwrap(), b"new"),
                Err(error) => {
                    assert!(matches!(error, ExportError::NoPermission { .. }));
                    assert!(error.to_string().contains("no permission to write here"));
                }
            }
            fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o755)).unwrap();
        }
    }
}
