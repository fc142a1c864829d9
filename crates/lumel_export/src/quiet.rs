//! A writer whose errors are kept for later.

use std::cell::Cell;
use std::io::{self, Seek, SeekFrom, Write};

/// Writes until something fails, and then only counts.
///
/// The ZIP library finishes an archive when it is dropped, and prints what fails then. It never sees a failure here.
pub(crate) struct Quiet<'a, W> {
    out: W,
    failure: &'a Cell<Option<io::Error>>,
    failed: bool,
    position: u64,
    end: u64,
}

impl<'a, W: Write + Seek> Quiet<'a, W> {
    /// A writer that leaves its first error in `failure`.
    pub(crate) fn new(out: W, failure: &'a Cell<Option<io::Error>>) -> Self {
        Self { out, failure, failed: false, position: 0, end: 0 }
    }

    /// What a call returned, or `otherwise` from the first error on.
    fn kept<T>(&mut self, call: impl FnOnce(&mut W) -> io::Result<T>, otherwise: T) -> io::Result<T> {
        if self.failed {
            return Ok(otherwise);
        }
        match call(&mut self.out) {
            Err(error) if error.kind() != io::ErrorKind::Interrupted => {
                self.failure.set(Some(error));
                self.failed = true;
                Ok(otherwise)
            }
            result => result,
        }
    }
}

impl<W: Write + Seek> Write for Quiet<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.kept(|out| out.write(bytes), bytes.len())?;
        self.position += written as u64;
        self.end = self.end.max(self.position);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.kept(Write::flush, ())
    }
}

impl<W: Write + Seek> Seek for Quiet<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let counted = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(by) => self.position.checked_add_signed(by),
            SeekFrom::End(by) => self.end.checked_add_signed(by),
        };
        self.position = self.kept(|out| out.seek(to), counted.unwrap_or(0))?;
        Ok(self.position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// A disk with room for so many bytes.
    struct Small(Cursor<Vec<u8>>, usize);

    impl Write for Small {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let room = self.1 - self.0.get_ref().len();
            if room == 0 {
                Err(io::ErrorKind::StorageFull.into())
            } else {
                self.0.write(&bytes[..room.min(bytes.len())])
            }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Seek for Small {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0.seek(to)
        }
    }

    #[test]
    fn what_fails_is_kept_and_nothing_fails_after_it() {
        let failure = Cell::new(None);
        let mut out = Quiet::new(Small(Cursor::default(), 5), &failure);
        out.write_all(b"1234").unwrap();
        assert!(failure.take().is_none());
        out.write_all(b"567890").unwrap();
        assert_eq!(failure.take().unwrap().kind(), io::ErrorKind::StorageFull);
        assert_eq!(out.stream_position().unwrap(), 10);
        assert_eq!(out.seek(SeekFrom::Start(3)).unwrap(), 3);
        out.write_all(b"x").unwrap();
        assert_eq!(out.seek(SeekFrom::End(-1)).unwrap(), 9);
        assert!(failure.take().is_none(), "it is told once");
        assert_eq!(out.out.0.get_ref(), b"12345");
    }
}
