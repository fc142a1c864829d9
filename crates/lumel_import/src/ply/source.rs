//! The elements of a PLY file, whatever its encoding.

use super::ascii::Words;
use super::elements::Skipped;
use super::header::check_counts;
use crate::ImportError;
use crate::lines::Lines;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The data after the header.
pub(super) enum Source<'a> {
    Text(Words<'a>),
    Binary { path: &'a Path, reader: Reader<BufReader<File>>, header: Header },
}

impl<'a> Source<'a> {
    /// Opens a file, reads its header and checks that the file is long enough for it.
    pub(super) fn open(path: &'a Path) -> Result<(Header, Self), ImportError> {
        let file = File::open(path).map_err(ImportError::io(path))?;
        let length = file.metadata().map_err(ImportError::io(path))?.len();
        let mut reader = Reader::new(BufReader::with_capacity(1 << 16, file));
        let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(|error| {
            ImportError::Malformed { path: path.to_owned(), line: error.line(), message: message(&error) }
        })?;
        check_counts(path, &header, length)?;
        let source = if header.encoding == Encoding::Ascii {
            let line = reader.line();
            Self::Text(Words::new(path, Lines::new(path, reader.into_inner(), line)?))
        } else {
            Self::Binary { path, reader, header: header.clone() }
        };
        Ok((header, source))
    }

    /// All elements of one kind; must be called in the order of the header.
    pub(super) fn elements<E: PropertyAccess>(&mut self, def: &ElementDef) -> Result<Vec<E>, ImportError> {
        match self {
            Self::Text(words) => words.elements(def),
            Self::Binary { path, reader, header } => Parser::new()
                .read_payload_for_element(reader, def, header)
                .map_err(|error| ImportError::malformed(path, message(&error))),
        }
    }
}

/// The parser's message without its place, the causes in it and the copy of a line, which may be long.
fn message(error: &ParseError) -> String {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default();
    let place = error.line().map(|line| format!("Line {line}: ")).unwrap_or_default();
    first.strip_prefix(&place).unwrap_or(first).trim_end_matches('.').chars().take(300).collect()
}
