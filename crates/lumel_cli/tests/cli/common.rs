//! Running the program.

use assert_cmd::Command;
use lumel_export::Solution;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The program itself.
pub(crate) const LUMEL: &str = env!("CARGO_BIN_EXE_lumel");

/// Settings under which a bake of the furnace takes a few hundredths of a second.
pub(crate) const TINY: [&str; 6] = ["--preset", "draft", "--direct-samples", "4", "--indirect-samples", "8"];

/// A folder of its own to run in.
pub(crate) struct Place(TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn folder(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    }

    /// All files that are here, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program, about to be run here with these words.
    pub(crate) fn lumel(&self, line: &str) -> Command {
        let mut command = Command::new(LUMEL);
        command.current_dir(self.0.path()).args(line.split_whitespace());
        command
    }

    /// Bakes the furnace with tiny settings, and more words.
    pub(crate) fn bake_furnace(&self, line: &str) -> Run {
        run(self.lumel("bake furnace").args(TINY).args(line.split_whitespace()))
    }

    pub(crate) fn solution(&self, name: &str) -> Solution {
        Solution::load(&self.path(name)).unwrap()
    }
}

/// What a run left behind.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    /// The run, which must have ended well.
    #[track_caller]
    pub(crate) fn done(self) -> Self {
        assert_eq!(self.code, 0, "{}{}", self.stdout, self.stderr);
        self
    }

    /// The run, which must have failed in words that contain these.
    #[track_caller]
    pub(crate) fn failed(self, words: &str) -> Self {
        assert_eq!(self.code, 2, "{}{}", self.stdout, self.stderr);
        assert!(self.stderr.contains("error:"), "{}", self.stderr);
        assert!(self.stderr.contains(words), "no \"{words}\" in: {}", self.stderr);
        assert!(!self.stderr.contains("bug in lumel"), "{}", self.stderr);
        self
    }
}

pub(crate) fn run(command: &mut Command) -> Run {
    let output = command.output().unwrap();
    Run {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Whether two solutions are the same light, bit by bit.
#[track_caller]
pub(crate) fn assert_same_light(a: &Solution, b: &Solution) {
    assert_eq!(a.bounces.len(), b.bounces.len());
    assert!(a.bounces == b.bounces, "bounces differ");
    assert!(a.irradiance == b.irradiance && a.tail == b.tail && a.valid == b.valid, "sums differ");
}
