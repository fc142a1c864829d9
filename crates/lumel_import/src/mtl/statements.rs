//! The statements of an MTL file.

use super::map::MapStatement;
use crate::ImportError;
use crate::lines::Lines;
use crate::tally::Tally;
use crate::text::{decode, floats, split_keyword};
use glam::Vec3;
use lumel_scene::Warnings;
use std::path::Path;

/// A material as its library describes it. `None` stands for statements it does not have.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMaterial {
    pub(super) name: String,
    /// `Kd`.
    pub(super) albedo: Option<Vec3>,
    /// `map_Kd`.
    pub(super) albedo_map: Option<MapStatement>,
    /// `Ke`.
    pub(super) emission: Option<Vec3>,
    /// `map_Ke`.
    pub(super) emission_map: Option<MapStatement>,
    /// `norm`.
    pub(super) normal_map: Option<MapStatement>,
    /// `map_bump` or `bump`: heights, or a normal map after all.
    pub(super) bump_map: Option<MapStatement>,
    /// Whether it has a `disp`.
    pub(super) is_displaced: bool,
    /// `d`, or one minus `Tr` where there is only that.
    pub(super) opacity: Option<f32>,
    /// `map_d`.
    pub(super) opacity_map: Option<MapStatement>,
    /// `Tf`: the share of light that passes.
    pub(super) filter: Option<Vec3>,
    /// `illum`.
    pub(super) illumination: Option<u8>,
}

/// Reads the materials of a library in order; several may have the same name.
///
/// # Errors
/// The file cannot be read. Problems in its content are warnings.
pub(super) fn read(path: &Path, warnings: &mut Warnings) -> Result<Vec<MtlMaterial>, ImportError> {
    let mut lines = Lines::open(path)?;
    let mut reader = Reader::default();
    while let Some(line) = lines.next_line()? {
        if let Err(problem) = reader.statement(line.text) {
            reader.problems.note(problem.kind(), || format!("line {}{}", line.number, problem.detail()));
        }
    }
    reader.problems.report(path, warnings);
    Ok(reader.materials)
}

/// Why a statement is skipped.
enum Problem {
    NotANumber(String),
    TooFewNumbers,
    UnsupportedColor,
    NoFileName,
    OutsideMaterial,
}

impl Problem {
    fn kind(&self) -> &'static str {
        match self {
            Self::NotANumber(_) => "statements skipped: a number is expected",
            Self::TooFewNumbers => "statements skipped: colours are one or three numbers",
            Self::UnsupportedColor => "colours skipped: spectral and xyz colours are not supported; use RGB",
            Self::NoFileName => "maps skipped: no file is named",
            Self::OutsideMaterial => "statements skipped: they come before the first newmtl",
        }
    }

    fn detail(&self) -> String {
        if let Self::NotANumber(message) = self { format!(", where {message}") } else { String::new() }
    }
}

#[derive(Default)]
struct Reader {
    materials: Vec<MtlMaterial>,
    problems: Tally,
}

impl Reader {
    fn statement(&mut self, text: &[u8]) -> Result<(), Problem> {
        let (keyword, arguments) = split_keyword(text);
        let keyword = keyword.to_ascii_lowercase();
        if keyword == b"newmtl" {
            self.materials.push(MtlMaterial { name: decode(arguments), ..MtlMaterial::default() });
            return Ok(());
        }
        let mut nowhere = MtlMaterial::default();
        let outside = self.materials.is_empty();
        let material = self.materials.last_mut().unwrap_or(&mut nowhere);
        let handled = material.statement(&keyword, arguments)?;
        if handled && outside { Err(Problem::OutsideMaterial) } else { Ok(()) }
    }
}

impl MtlMaterial {
    /// Applies a statement; `false` if it is unknown.
    fn statement(&mut self, keyword: &[u8], arguments: &[u8]) -> Result<bool, Problem> {
        match keyword {
            b"kd" => self.albedo = Some(color(arguments)?),
            b"ke" => self.emission = Some(color(arguments)?),
            b"map_kd" => self.albedo_map = Some(map(arguments)?),
            b"map_ke" => self.emission_map = Some(map(arguments)?),
            b"norm" | b"map_norm" => self.normal_map = Some(map(arguments)?),
            b"map_bump" | b"bump" => self.bump_map = Some(map(arguments)?),
            b"disp" | b"map_disp" => self.is_displaced = true,
            b"map_d" => self.opacity_map = Some(map(arguments)?),
            b"tf" => self.filter = Some(color(arguments)?),
            b"d" => {
                // The option makes opacity depend on the angle.
                let (option, value) = split_keyword(arguments);
                self.opacity = Some(number(if option == b"-halo" { value } else { arguments })?);
            }
            b"tr" => self.opacity = self.opacity.or(Some(1.0 - number(arguments)?)),
            b"illum" => self.illumination = Some(number(arguments)? as u8),
            _ => return Ok(false),
        }
        Ok(true)
    }
}

fn number(arguments: &[u8]) -> Result<f32, Problem> {
    match floats::<1>(arguments).map_err(Problem::NotANumber)? {
        ([value], 1) => Ok(value),
        _ => Err(Problem::NotANumber("there is none".to_owned())),
    }
}

/// `r g b`, or `r` alone for grey.
fn color(arguments: &[u8]) -> Result<Vec3, Problem> {
    if matches!(split_keyword(arguments).0, b"spectral" | b"xyz") {
        return Err(Problem::UnsupportedColor);
    }
    match floats::<3>(arguments).map_err(Problem::NotANumber)? {
        (rgb, 3) => Ok(Vec3::from_array(rgb)),
        ([grey, ..], 1) => Ok(Vec3::splat(grey)),
        _ => Err(Problem::TooFewNumbers),
    }
}

fn map(arguments: &[u8]) -> Result<MapStatement, Problem> {
    MapStatement::parse(&decode(arguments)).ok_or(Problem::NoFileName)
}
