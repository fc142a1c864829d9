//! Archives of arrays, and the solutions and checkpoints in them.

use crate::folder::with_files;
use lumel::Solution;
use lumel_export::{Checkpoint, CheckpointMeta, NpzReader, write_npz};

/// An archive as it is, or, as checksums are more than a fuzzer can guess, its members in the form
/// `NAME\nCONTENT\n==\n`, which are put into an archive.
pub(crate) fn npz(input: &[u8]) {
    if input.starts_with(b"PK") {
        with_files(&[("a.npz", input)], |path| {
            read_members(path);
            read_solution(path);
            read_checkpoint(path);
        });
        return;
    }
    with_files(&[("a.npz", b"")], |path| {
        let written = write_npz(path, |npz| {
            members(input).into_iter().try_for_each(|(name, content)| npz.bytes(&name, content))
        });
        if written.is_ok() {
            read_members(path);
            read_solution(path);
            read_checkpoint(path);
        }
    });
}

/// Names and contents.
fn members(input: &[u8]) -> Vec<(String, &[u8])> {
    let separator = b"\n==\n";
    let mut members = Vec::new();
    let mut rest = input;
    while !rest.is_empty() {
        let end = rest.windows(separator.len()).position(|window| window == separator);
        let (member, after) = match end {
            Some(end) => (&rest[..end], &rest[end + separator.len()..]),
            None => (rest, &rest[rest.len()..]),
        };
        let name = member.iter().position(|&byte| byte == b'\n').unwrap_or(member.len());
        let content = member.get(name + 1..).unwrap_or_default();
        members.push((String::from_utf8_lossy(&member[..name]).into_owned(), content));
        rest = after;
    }
    members
}

fn read_members(path: &std::path::Path) {
    let Ok(mut npz) = NpzReader::open(path) else { return };
    for name in npz.names() {
        if npz.has_array(&name) {
            if let Ok(array) = npz.array(&name) {
                assert_eq!(array.shape.iter().product::<usize>(), array.data.len());
            }
        } else if let Err(error) = npz.bytes(&name) {
            assert!(!error.to_string().is_empty());
        }
    }
}

/// A solution that can be read is written and read again as it is.
fn read_solution(path: &std::path::Path) {
    let Ok(solution) = Solution::load(path) else { return };
    with_files(&[("b.npz", b"")], |path| {
        solution.save(path).expect("a valid solution can be written");
        let again = Solution::load(path).expect("a written solution can be read");
        // Saving fills in what each array holds, and may only add to the rest.
        let arrays = again.meta.arrays.clone();
        let meta = lumel_export::SolutionMeta { arrays, ..solution.meta.clone() };
        assert_eq!(again, Solution { meta, ..solution });
    });
}

/// A checkpoint that can be read is written and read again as it is.
fn read_checkpoint(path: &std::path::Path) {
    let Ok(checkpoint) = Checkpoint::load(path) else { return };
    with_files(&[("b.npz", b"")], |path| {
        checkpoint.save(path).expect("a valid checkpoint can be written");
        let again = Checkpoint::load(path).expect("a written checkpoint can be read");
        let arrays = again.meta.arrays.clone();
        let meta = CheckpointMeta { arrays, ..checkpoint.meta.clone() };
        assert_eq!(again, Checkpoint { meta, ..checkpoint });
    });
}
