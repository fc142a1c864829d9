//! The elements of a text PLY.
//!
//! The reader of the library refuses `.5`, `2.`, `nan` and elements that span several lines.

use crate::ImportError;
use crate::lines::Lines;
use crate::text::{float, quoted};
use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};
use std::path::Path;
use std::str::FromStr;

/// Words of a file from some line on.
pub(super) struct Words<'a> {
    path: &'a Path,
    lines: Lines,
    /// The current line, and how much of it has been used.
    text: Vec<u8>,
    used: usize,
    line: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(path: &'a Path, lines: Lines) -> Self {
        Self { path, lines, text: Vec::new(), used: 0, line: 0 }
    }

    /// All elements of one kind.
    ///
    /// # Errors
    /// Words that are not numbers of the declared type, or the end of the file.
    pub(super) fn elements<E: PropertyAccess>(&mut self, def: &ElementDef) -> Result<Vec<E>, ImportError> {
        let mut elements = Vec::new();
        for number in 0..def.count {
            let mut element = E::new();
            for property in def.properties.values() {
                let value = self.property(&property.data_type).map_err(|problem| match problem {
                    Problem::Import(error) => error,
                    Problem::Word(message) => {
                        let name = &property.name;
                        let message = format!("{} {number}, property {name}: {message}", def.name);
                        ImportError::at_line(self.path, self.line, message)
                    }
                })?;
                if element.set_property(&property.name, value) == PropertyAccessResult::UnsupportedType {
                    let message =
                        format!("{} {number}: property {} has the wrong type", def.name, property.name);
                    return Err(ImportError::at_line(self.path, self.line, message));
                }
            }
            elements.push(element);
        }
        Ok(elements)
    }

    fn property(&mut self, kind: &PropertyType) -> Result<Property, Problem> {
        match kind {
            PropertyType::Scalar(scalar) => {
                let word = self.word()?;
                Ok(match scalar {
                    ScalarType::Char => Property::Char(parse(word)?),
                    ScalarType::UChar => Property::UChar(parse(word)?),
                    ScalarType::Short => Property::Short(parse(word)?),
                    ScalarType::UShort => Property::UShort(parse(word)?),
                    ScalarType::Int => Property::Int(parse(word)?),
                    ScalarType::UInt => Property::UInt(parse(word)?),
                    ScalarType::Float | ScalarType::Double => {
                        // What is written has the digits that it has, whatever type is declared.
                        Property::Double(float(word).ok_or_else(|| not_a_number(word))?)
                    }
                })
            }
            PropertyType::List(_, scalar) => {
                let count = parse(self.word()?)?;
                Ok(match scalar {
                    ScalarType::UInt => Property::ListUInt(self.list(count, parse)?),
                    ScalarType::Float | ScalarType::Double => Property::ListFloat(
                        self.list(count, |word| float(word).ok_or_else(|| not_a_number(word)))?,
                    ),
                    _ => Property::ListInt(self.list(count, parse)?),
                })
            }
        }
    }

    /// Grows with the data, not with the declared count.
    fn list<T>(
        &mut self,
        count: u64,
        parse: impl Fn(&[u8]) -> Result<T, Problem>,
    ) -> Result<Vec<T>, Problem> {
        (0..count).map(|_| parse(self.word()?)).collect()
    }

    fn word(&mut self) -> Result<&[u8], Problem> {
        let is_blank = |byte: &u8| byte.is_ascii_whitespace();
        loop {
            if let Some(start) = self.text[self.used..].iter().position(|byte| !is_blank(byte)) {
                let word = &self.text[self.used + start..];
                let word = &word[..word.iter().position(is_blank).unwrap_or(word.len())];
                self.used += start + word.len();
                return Ok(word);
            }
            let Some(line) = self.lines.next_line().map_err(Problem::Import)? else {
                return Err(Problem::Word("the file ends too early".to_owned()));
            };
            self.line = line.number;
            self.used = 0;
            self.text.clear();
            self.text.extend_from_slice(line.text);
        }
    }
}

enum Problem {
    Import(ImportError),
    Word(String),
}

fn not_a_number(word: &[u8]) -> Problem {
    Problem::Word(format!("{} is not a number of the declared type", quoted(word)))
}

fn parse<T: FromStr>(word: &[u8]) -> Result<T, Problem> {
    std::str::from_utf8(word).ok().and_then(|text| text.parse().ok()).ok_or_else(|| not_a_number(word))
}
