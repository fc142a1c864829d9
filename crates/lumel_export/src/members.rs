//! What saved light is made of: members of archives that must be well formed.

use crate::{Array, ArrayData, NpzReader, NpzWriter, ReadError, SolutionError};
use glam::{DVec3, Vec3};
use lumel_basis::{Coefficients, Directional};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::io;

/// A kind of archive, as its `meta.json` names it.
pub(crate) struct Kind {
    /// The name in `format`.
    pub(crate) format: &'static str,
    /// The version that this program reads and writes.
    pub(crate) version: u32,
    /// What users call it.
    pub(crate) name: &'static str,
    /// How to get one.
    pub(crate) remedy: &'static str,
}

/// The first things a reader must know; the rest may differ in other versions.
#[derive(Deserialize)]
struct FormatOnly {
    format: String,
    format_version: u32,
}

/// Names the kind of an archive: the `format` in its `meta.json`.
pub(crate) fn read_format(npz: &mut NpzReader) -> Option<String> {
    let json = npz.bytes("meta.json").ok()?;
    serde_json::from_slice::<FormatOnly>(&json).ok().map(|known| known.format)
}

/// Reads the `meta.json` of a kind of archive.
pub(crate) fn read_meta<T: DeserializeOwned>(npz: &mut NpzReader, kind: &Kind) -> Result<T, SolutionError> {
    let Kind { format: wanted, version, name, remedy } = kind;
    let path = npz.path().to_owned();
    let format = |problem: String| SolutionError::Format { path: path.clone(), problem };
    let json = npz.bytes("meta.json").map_err(|error| match error {
        ReadError::Missing { .. } => {
            format(format!("this archive is not a lumel {name}: it has no meta.json; {remedy}"))
        }
        error => error.into(),
    })?;
    let known: FormatOnly = serde_json::from_slice(&json)
        .map_err(|error| format(format!("this archive is not a lumel {name}: its meta.json has {error}")))?;
    if known.format != *wanted {
        return Err(format(format!("this archive holds a \"{}\", not a \"{wanted}\"", known.format)));
    }
    if known.format_version != *version {
        return Err(format(format!(
            "this {name} has format {}, this version of lumel reads format {version}; \
             use the version that wrote it or bake again",
            known.format_version
        )));
    }
    serde_json::from_slice(&json)
        .map_err(|error| format(format!("the meta.json of this {name} is incomplete: {error}")))
}

/// Checks that an archive has the arrays that its `meta.json` lists: names of members have no checksum.
pub(crate) fn check_members<'a>(
    npz: &NpzReader,
    arrays: impl IntoIterator<Item = &'a String>,
) -> Result<(), SolutionError> {
    match arrays.into_iter().find(|array| !npz.has_array(array)) {
        Some(array) => Err(ReadError::Missing { path: npz.path().to_owned(), member: array.clone() }.into()),
        None => Ok(()),
    }
}

pub(crate) fn read_optional(npz: &mut NpzReader, name: &str) -> Result<Option<Vec<Vec3>>, SolutionError> {
    if npz.has_array(name) { read_vectors(npz, name).map(Some) } else { Ok(None) }
}

pub(crate) fn read_vectors(npz: &mut NpzReader, name: &str) -> Result<Vec<Vec3>, SolutionError> {
    let array = npz.array(name)?;
    match (array.shape.as_slice(), &array.data) {
        ([_, 3], ArrayData::F32(values)) => Ok(vectors(values)),
        _ => Err(wrong_shape(npz, name, "(n, 3) of <f4", &array)),
    }
}

/// Positions, which have double precision where single does not hold them.
pub(crate) fn read_positions(npz: &mut NpzReader, name: &str) -> Result<Vec<DVec3>, SolutionError> {
    let array = npz.array(name)?;
    match (array.shape.as_slice(), &array.data) {
        ([_, 3], ArrayData::F32(values)) => Ok(vectors(values).iter().map(|v| v.as_dvec3()).collect()),
        ([_, 3], ArrayData::F64(values)) => Ok(values.chunks_exact(3).map(DVec3::from_slice).collect()),
        _ => Err(wrong_shape(npz, name, "(n, 3) of <f4 or <f8", &array)),
    }
}

/// Parts of the light, over `n` vertices or nodes each, as one array.
pub(crate) fn stacked(parts: &[impl AsRef<[Vec3]>], n: usize) -> Array {
    let values = parts.iter().flat_map(AsRef::as_ref).flat_map(|v| v.to_array()).collect();
    Array { shape: vec![parts.len(), n, 3], data: ArrayData::F32(values) }
}

/// Parts of the light, over `n` vertices or nodes each: bounces or layers.
pub(crate) fn read_stacked(
    npz: &mut NpzReader,
    name: &str,
    n: usize,
) -> Result<Vec<Vec<Vec3>>, SolutionError> {
    let array = npz.array(name)?;
    match (array.shape.as_slice(), &array.data) {
        // A scene has vertices, so a size bounds the number of parts.
        ([_, vertices, 3], ArrayData::F32(values)) if *vertices == n && n > 0 => {
            Ok(values.chunks(3 * n).map(vectors).collect())
        }
        ([0, ..], _) => Ok(Vec::new()),
        _ => Err(wrong_shape(npz, name, &format!("({name}, {n}, 3) of <f4"), &array)),
    }
}

/// Coefficients at the same places, as one array (places, harmonics, 3), or with a first axis for several (parts, places, harmonics,
/// 3).
pub(crate) fn coefficients_array(parts: &[&Coefficients], axis: Option<usize>) -> Array {
    let values = parts.iter().flat_map(|part| part.values()).flat_map(|v| v.to_array()).collect();
    let of_part = parts.first().map_or([0, 0], |part| [part.len(), part.kind().harmonics()]);
    let shape = axis.into_iter().chain(of_part).chain([3]).collect();
    Array { shape, data: ArrayData::F32(values) }
}

/// Coefficients at `n` places, of as many parts as the first axis has if there is one; none if the array is missing.
pub(crate) fn read_coefficients(
    npz: &mut NpzReader,
    name: &str,
    axis: Option<usize>,
    n: usize,
) -> Result<Vec<Coefficients>, SolutionError> {
    if !npz.has_array(name) {
        return Ok(Vec::new());
    }
    let array = npz.array(name)?;
    let expected = |harmonics: usize| axis.into_iter().chain([n, harmonics, 3]).collect::<Vec<_>>();
    let kinds = [Directional::Sh1, Directional::Sh2];
    match (kinds.into_iter().find(|kind| array.shape == expected(kind.harmonics())), &array.data) {
        (Some(kind), ArrayData::F32(values)) if n > 0 => {
            let parts = values.chunks(3 * n * kind.harmonics()).map(vectors);
            Ok(parts.filter_map(|values| Coefficients::new(kind, values)).collect())
        }
        _ => {
            let parts = axis.map_or(String::new(), |parts| format!("{parts}, "));
            Err(wrong_shape(npz, name, &format!("({parts}{n}, 4 or 9, 3) of <f4"), &array))
        }
    }
}

/// The member of the edges that were split where a scene was refined.
pub(crate) const SPLITS: &str = "splits";

/// Writes the edges that were split, if there are any.
pub(crate) fn write_splits(npz: &mut NpzWriter<'_>, splits: &[[u32; 2]]) -> io::Result<()> {
    if splits.is_empty() { Ok(()) } else { write_edges(npz, SPLITS, splits) }
}

/// Reads the edges that were split, if there are any.
pub(crate) fn read_splits(npz: &mut NpzReader) -> Result<Vec<[u32; 2]>, SolutionError> {
    if npz.has_array(SPLITS) { read_edges(npz, SPLITS) } else { Ok(Vec::new()) }
}

/// Writes edges by the vertices at their ends.
pub(crate) fn write_edges(npz: &mut NpzWriter<'_>, name: &str, edges: &[[u32; 2]]) -> io::Result<()> {
    let (shape, data) = (vec![edges.len(), 2], ArrayData::U32(edges.as_flattened().to_vec()));
    npz.array(name, &Array { shape, data })
}

pub(crate) fn read_edges(npz: &mut NpzReader, name: &str) -> Result<Vec<[u32; 2]>, SolutionError> {
    let array = npz.array(name)?;
    match (array.shape.as_slice(), &array.data) {
        ([_, 2], ArrayData::U32(ends)) => Ok(ends.chunks_exact(2).map(|ends| [ends[0], ends[1]]).collect()),
        _ => Err(wrong_shape(npz, name, "(n, 2) of <u4", &array)),
    }
}

/// Numbers in any shape, one after the other.
pub(crate) fn read_numbers(npz: &mut NpzReader, name: &str) -> Result<Vec<f32>, SolutionError> {
    let array = npz.array(name)?;
    match array.data {
        ArrayData::F32(values) => Ok(values),
        data => Err(wrong_shape(npz, name, "of <f4", &Array { shape: array.shape, data })),
    }
}

/// Whole numbers in any shape, one after the other.
pub(crate) fn read_whole_numbers(npz: &mut NpzReader, name: &str) -> Result<Vec<u32>, SolutionError> {
    let array = npz.array(name)?;
    match array.data {
        ArrayData::U32(values) => Ok(values),
        data => Err(wrong_shape(npz, name, "of <u4", &Array { shape: array.shape, data })),
    }
}

pub(crate) fn read_flags(npz: &mut NpzReader, name: &str) -> Result<Vec<bool>, SolutionError> {
    let array = npz.array(name)?;
    match (array.shape.as_slice(), &array.data) {
        ([_], ArrayData::Bool(flags)) => Ok(flags.clone()),
        ([_], ArrayData::U8(flags)) => Ok(flags.iter().map(|&flag| flag != 0).collect()),
        _ => Err(wrong_shape(npz, name, "(n) of |b1", &array)),
    }
}

fn vectors(values: &[f32]) -> Vec<Vec3> {
    values.chunks_exact(3).map(Vec3::from_slice).collect()
}

pub(crate) fn wrong_shape(npz: &NpzReader, name: &str, wanted: &str, array: &Array) -> SolutionError {
    let problem = format!("has the shape {:?} of {}, not {wanted}", array.shape, array.data.descr());
    ReadError::BadMember { path: npz.path().to_owned(), member: name.to_owned(), problem }.into()
}

/// The flags of several rounds, over `n` nodes each.
pub(crate) fn read_rounds(npz: &mut NpzReader, n: usize) -> Result<Vec<Vec<bool>>, SolutionError> {
    let array = npz.array("rounds")?;
    match (array.shape.as_slice(), &array.data) {
        ([_, nodes], ArrayData::Bool(flags)) if *nodes == n && n > 0 => {
            Ok(flags.chunks(n).map(<[bool]>::to_vec).collect())
        }
        _ => Err(wrong_shape(npz, "rounds", &format!("(rounds, {n}) of |b1"), &array)),
    }
}
