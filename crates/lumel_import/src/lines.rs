//! The lines of a text file: any encoding, any line ending, continued lines joined.

use crate::ImportError;
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

/// The longest line that is read, with its continuations; longer ones are binary data or hostile.
const MAX_LINE: usize = 1 << 24;

/// Reads a text file line by line.
///
/// A byte order mark is skipped, UTF-16 with or without one is turned into UTF-8, and a line that ends in a backslash is continued by
/// the next one, unless it is a comment.
pub(crate) struct Lines {
    reader: Box<dyn BufRead>,
    path: PathBuf,
    next_line: usize,
    text: Vec<u8>,
}

/// One line, without its end.
pub(crate) struct Line<'a> {
    /// Where it starts, counted from 1.
    pub(crate) number: usize,
    /// Its text.
    pub(crate) text: &'a [u8],
}

impl Lines {
    /// Opens a file.
    ///
    /// # Errors
    /// It cannot be read.
    pub(crate) fn open(path: &Path) -> Result<Self, ImportError> {
        let file = File::open(path).map_err(ImportError::io(path))?;
        Self::new(path, BufReader::with_capacity(1 << 16, file), 1)
    }

    /// The rest of a file that has been read up to line `first`.
    ///
    /// # Errors
    /// It cannot be read.
    pub(crate) fn new(
        path: &Path,
        mut reader: impl BufRead + 'static,
        first: usize,
    ) -> Result<Self, ImportError> {
        let mut start = Vec::new();
        reader.by_ref().take(4).read_to_end(&mut start).map_err(ImportError::io(path))?;
        let reader: Box<dyn BufRead> = match start.as_slice() {
            [0xef, 0xbb, 0xbf, rest @ ..] => Box::new(Cursor::new(rest.to_vec()).chain(reader)),
            [0xff, 0xfe, rest @ ..] => utf_16(path, rest, reader, u16::from_le_bytes)?,
            [0xfe, 0xff, rest @ ..] => utf_16(path, rest, reader, u16::from_be_bytes)?,
            // Without a mark, letters of ASCII beside zeros tell.
            [1..=0x7f, 0, 1..=0x7f, 0] => utf_16(path, &start, reader, u16::from_le_bytes)?,
            [0, 1..=0x7f, 0, 1..=0x7f] => utf_16(path, &start, reader, u16::from_be_bytes)?,
            _ => Box::new(Cursor::new(start).chain(reader)),
        };
        Ok(Self { reader, path: path.to_owned(), next_line: first, text: Vec::new() })
    }

    /// The next line; `None` at the end of the file.
    ///
    /// # Errors
    /// The file cannot be read, or the line is absurdly long.
    pub(crate) fn next_line(&mut self) -> Result<Option<Line<'_>>, ImportError> {
        self.text.clear();
        let number = self.next_line;
        let mut is_comment = false;
        loop {
            let room = (MAX_LINE - self.text.len()) as u64 + 1;
            let mut reader = self.reader.by_ref().take(room);
            let read = reader.read_until(b'\n', &mut self.text).map_err(ImportError::io(&self.path))?;
            if self.text.len() > MAX_LINE {
                let message = format!("the line is longer than {MAX_LINE} bytes; is this a text file?");
                return Err(ImportError::at_line(&self.path, number, message));
            }
            if read == 0 {
                break;
            }
            if self.next_line == number {
                is_comment = self.text.trim_ascii_start().starts_with(b"#");
            }
            self.next_line += 1;
            while let [.., b'\n' | b'\r'] = self.text.as_slice() {
                self.text.pop();
            }
            if is_comment || !self.text.ends_with(b"\\") {
                return Ok(Some(Line { number, text: &self.text }));
            }
            self.text.pop();
            self.text.push(b' ');
        }
        Ok((!self.text.is_empty()).then_some(Line { number, text: &self.text }))
    }
}

/// The rest of a file in UTF-16 as UTF-8.
fn utf_16(
    path: &Path,
    start: &[u8],
    mut reader: impl BufRead,
    unit: fn([u8; 2]) -> u16,
) -> Result<Box<dyn BufRead>, ImportError> {
    let mut bytes = start.to_vec();
    reader.read_to_end(&mut bytes).map_err(ImportError::io(path))?;
    let units = bytes.as_chunks::<2>().0.iter().map(|pair| unit(*pair));
    let text: String = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    Ok(Box::new(Cursor::new(text)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Vec<(usize, String)> {
        let mut lines = Lines::new(Path::new("test.obj"), Cursor::new(bytes.to_vec()), 1).unwrap();
        let mut all = Vec::new();
        while let Some(line) = lines.next_line().unwrap() {
            all.push((line.number, String::from_utf8_lossy(line.text).into_owned()));
        }
        all
    }

    fn expect(lines: &[(usize, &str)]) -> Vec<(usize, String)> {
        lines.iter().map(|(number, text)| (*number, (*text).to_owned())).collect()
    }

    #[test]
    fn every_line_has_its_number_whatever_ends_it() {
        assert_eq!(read(b"a\nb\r\n\nc"), expect(&[(1, "a"), (2, "b"), (3, ""), (4, "c")]));
        assert_eq!(read(b""), []);
        assert_eq!(read(b"\xef\xbb\xbfa\n"), expect(&[(1, "a")]));
        assert_eq!(read(b"a\xff\n"), expect(&[(1, "a\u{fffd}")]));
    }

    #[test]
    fn a_backslash_continues_a_line_but_not_a_comment() {
        assert_eq!(read(b"f 1 \\\n2\\\r\n3\nx"), expect(&[(1, "f 1  2 3"), (4, "x")]));
        assert_eq!(read(b"# C:\\\nv"), expect(&[(1, "# C:\\"), (2, "v")]));
        assert_eq!(read(b"a\\"), expect(&[(1, "a ")]));
    }

    #[test]
    fn utf_16_is_read_in_both_byte_orders() {
        let units = || "v 1\nö".encode_utf16();
        let little: Vec<u8> = [0xff, 0xfe].into_iter().chain(units().flat_map(u16::to_le_bytes)).collect();
        let big: Vec<u8> = [0xfe, 0xff].into_iter().chain(units().flat_map(u16::to_be_bytes)).collect();
        for bytes in [&little, &big, &little[2..], &big[2..]] {
            assert_eq!(read(bytes), expect(&[(1, "v 1"), (2, "ö")]));
        }
        assert_eq!(read(&[0xff, 0xfe]), []);
        assert_eq!(read(&[0xff]), expect(&[(1, "\u{fffd}")]));
    }

    #[test]
    fn endless_lines_are_refused() {
        for endless in [b"x".as_slice(), b"\\\n"] {
            let bytes = endless.repeat(MAX_LINE + 10);
            let mut lines = Lines::new(Path::new("zero.obj"), Cursor::new(bytes), 1).unwrap();
            let error = lines.next_line().err().unwrap().to_string();
            assert!(error.starts_with("zero.obj:1: the line is longer"), "{error}");
        }
    }
}
