//! The statements of an OBJ file as flat arrays.

use crate::ImportError;
use crate::lines::{Line, Lines};
use crate::tally::Tally;
use crate::text::{decode, doubles, floats, quoted, split_keyword, words};
use glam::{DVec3, Vec2, Vec3};
use lumel_scene::Smoothing;
use std::collections::HashMap;
use std::path::Path;

const FREE_FORMS: &str = "free-form curves or surfaces skipped; export them as polygons";
/// How the first comment of files that lumel has written begins.
const OWN: &[u8] = b"lumel ";
const BAD_SMOOTHING: &str = "smoothing groups taken as off: neither \"off\" nor a number";

/// What one OBJ file says, with indices made absolute but not yet checked against the arrays' ends: faces may come
/// before the vertices they use.
#[derive(Debug, Default)]
pub(super) struct ObjFile {
    /// In world space.
    pub(super) positions: Vec<DVec3>,
    /// Colours as stored; empty if no vertex has one, else one per position, white where there is none.
    pub(super) colors: Vec<Vec3>,
    /// Texture coordinates with `v` up, as stored.
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    /// Corners of all faces, one face after the other.
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<ObjFace>,
    /// Runs of faces that share object, group, material and smoothing.
    pub(super) sections: Vec<Section>,
    /// Names of objects and groups.
    pub(super) names: Names,
    pub(super) materials: Names,
    /// The arguments of `mtllib` statements, each with its line.
    pub(super) libraries: Vec<(usize, Vec<u8>)>,
    /// Whether colours were left out because lumel has baked them, as a comment at the beginning says.
    pub(super) has_baked_colors: bool,
    /// Whether any `s` occurs.
    pub(super) has_smoothing: bool,
    /// What was skipped.
    pub(super) skipped: Tally,
}

/// A corner of a face: indices from 0, [`Corner::NONE`] for those it does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

impl Corner {
    pub(super) const NONE: u32 = u32::MAX;
}

/// A face: its line and the end of its corners, which start where the previous face's end.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjFace {
    pub(super) line: usize,
    pub(super) corners_end: usize,
}

/// The state that `o`, `g`, `usemtl` and `s` set.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Section {
    pub(super) object: Option<u32>,
    pub(super) group: Option<u32>,
    /// Index into the materials.
    pub(super) material: Option<u32>,
    /// `None` before the first `s`.
    pub(super) smoothing: Option<Smoothing>,
    /// Its first face.
    pub(super) first_face: usize,
}

/// Names, each with an index.
#[derive(Debug, Default)]
pub(super) struct Names {
    names: Vec<String>,
    indices: HashMap<String, u32>,
}

impl Names {
    fn index(&mut self, name: String) -> u32 {
        let next = self.names.len() as u32;
        *self.indices.entry(name).or_insert_with_key(|name| {
            self.names.push(name.clone());
            next
        })
    }

    pub(super) fn name(&self, index: u32) -> &str {
        &self.names[index as usize]
    }

    pub(super) fn len(&self) -> u32 {
        self.names.len() as u32
    }

    pub(super) fn into_names(self) -> Vec<String> {
        self.names
    }
}

/// Reads the statements of a file.
pub(super) fn read(path: &Path) -> Result<ObjFile, ImportError> {
    let mut lines = Lines::open(path)?;
    let mut reader = Reader::default();
    while let Some(line) = lines.next_line()? {
        reader.statement(&line).map_err(|message| ImportError::at_line(path, line.number, message))?;
    }
    Ok(reader.file)
}

#[derive(Default)]
struct Reader {
    file: ObjFile,
    state: Section,
    /// Whether `state` has changed since the last section began.
    changed: bool,
    /// Whether lumel has written the file.
    is_own: bool,
}

impl Reader {
    fn statement(&mut self, line: &Line<'_>) -> Result<(), String> {
        let (keyword, arguments) = split_keyword(line.text);
        match keyword {
            b"v" => self.position(arguments)?,
            b"vt" => {
                let (values, count) = floats::<2>(arguments)?;
                at_least(1, count, "texture coordinate")?;
                self.file.uvs.push(Vec2::from_array(values));
            }
            b"vn" => {
                let (values, count) = floats::<3>(arguments)?;
                at_least(3, count, "normal")?;
                self.file.normals.push(Vec3::from_array(values));
            }
            b"f" | b"fo" => self.face(line.number, arguments)?,
            b"o" => self.state.object = Some(self.file.names.index(decode(arguments))),
            b"g" => self.state.group = Some(self.file.names.index(decode(arguments))),
            b"usemtl" => self.state.material = Some(self.file.materials.index(decode(arguments))),
            b"s" => {
                let smoothing = smoothing(arguments);
                if smoothing.is_none() {
                    self.file.skipped.note(BAD_SMOOTHING, || format!("line {}", line.number));
                }
                self.state.smoothing = Some(smoothing.unwrap_or(Smoothing::Flat));
                self.file.has_smoothing = true;
            }
            b"#" if self.file.positions.is_empty() => self.is_own |= arguments.starts_with(OWN),
            b"mtllib" => self.file.libraries.push((line.number, arguments.to_owned())),
            b"curv" | b"curv2" | b"surf" => {
                self.file.skipped.note(FREE_FORMS, || format!("line {}", line.number));
            }
            _ => {}
        }
        self.changed |= matches!(keyword, b"o" | b"g" | b"usemtl" | b"s");
        Ok(())
    }

    /// `x y z`, `x y z w`, `x y z r g b` or `x y z w r g b`; weights matter to free-form surfaces only.
    fn position(&mut self, arguments: &[u8]) -> Result<(), String> {
        let (values, count) = doubles::<7>(arguments)?;
        at_least(3, count, "vertex")?;
        let [x, y, z, rest @ ..] = values;
        let color = match (count, rest) {
            (6, [r, g, b, _]) | (7, [_, r, g, b]) => Some(DVec3::new(r, g, b).as_vec3()),
            _ => None,
        };
        let file = &mut self.file;
        file.has_baked_colors |= self.is_own && color.is_some();
        let color = color.filter(|_| !self.is_own);
        if color.is_some() || !file.colors.is_empty() {
            file.colors.resize(file.positions.len(), Vec3::ONE);
            file.colors.push(color.unwrap_or(Vec3::ONE));
        }
        file.positions.push(DVec3::new(x, y, z));
        Ok(())
    }

    fn face(&mut self, line: usize, arguments: &[u8]) -> Result<(), String> {
        if self.changed || self.file.sections.is_empty() {
            self.file.sections.push(Section { first_face: self.file.faces.len(), ..self.state });
            self.changed = false;
        }
        for word in words(arguments) {
            let corner = self.corner(word).map_err(|message| match self.part_name() {
                Some(part) => format!("{message}, object \"{part}\""),
                None => message,
            })?;
            self.file.corners.push(corner);
        }
        self.file.faces.push(ObjFace { line, corners_end: self.file.corners.len() });
        Ok(())
    }

    fn part_name(&self) -> Option<&str> {
        self.state.object.or(self.state.group).map(|index| self.file.names.name(index))
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`, also with slashes left over at the end.
    fn corner(&self, word: &[u8]) -> Result<Corner, String> {
        let mut fields = word.split(|&byte| byte == b'/');
        let mut next = |what, count: usize| match fields.next() {
            None | Some(b"") => Ok(Corner::NONE),
            Some(field) => absolute_index(field, what, count),
        };
        let position = next("vertex", self.file.positions.len())?;
        let uv = next("texture coordinate", self.file.uvs.len())?;
        let normal = next("normal", self.file.normals.len())?;
        if position == Corner::NONE || fields.next().is_some() {
            return Err(format!("face corner {} is not of the form v/vt/vn", quoted(word)));
        }
        Ok(Corner { position, uv, normal })
    }
}

fn at_least(needed: usize, count: usize, what: &str) -> Result<(), String> {
    if count < needed { Err(format!("{what} has {count} of {needed} numbers")) } else { Ok(()) }
}

/// An index from 0: positive ones count from the first, negative ones back from the last read so far.
fn absolute_index(field: &[u8], what: &str, count: usize) -> Result<u32, String> {
    let number = std::str::from_utf8(field).ok().and_then(|text| text.parse::<i64>().ok());
    let number = number.ok_or_else(|| format!("face refers to {what} {}, not a number", quoted(field)))?;
    let index = match number {
        1.. => number.checked_sub(1),
        0 => None,
        _ => (count as i64).checked_add(number),
    };
    let index = index.and_then(|index| u32::try_from(index).ok()).filter(|&index| index != Corner::NONE);
    index.ok_or_else(|| match number {
        0 => format!("face refers to {what} 0; indices start at 1"),
        _ => format!("face refers to {what} {number} of {count}"),
    })
}

/// The smoothing group that an `s` statement begins; `None` if it is invalid.
fn smoothing(arguments: &[u8]) -> Option<Smoothing> {
    match words(arguments).next() {
        None | Some(b"off" | b"null") => Some(Smoothing::Flat),
        Some(b"on") => Some(Smoothing::Group(1)),
        Some(word) => match std::str::from_utf8(word).ok()?.parse().ok()? {
            0 => Some(Smoothing::Flat),
            group => Some(Smoothing::Group(group)),
        },
    }
}
