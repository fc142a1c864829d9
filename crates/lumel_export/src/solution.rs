//! The result of a bake: light at the vertices of a scene.

use crate::error::SceneLabel;
use crate::{Array, ArrayData, NpzReader, ReadError, SolutionError, write_npz};
use glam::Vec3;
use lumel_scene::Scene;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Names the format in `meta.json`.
const FORMAT: &str = "lumel-solution";
/// Changes only when the layout does.
const FORMAT_VERSION: u32 = 1;

/// Irradiance at the vertices of a scene, W·m⁻² (lux where the scene's lights are photometric), linear Rec. 709.
///
/// As a file it is a NumPy archive of the arrays `positions`, `normals`, `irradiance`, `tail` and `standard_error`
/// (n, 3), `bounces` (bounces, n, 3) and `valid` (n), and of `meta.json`. `tail` and `standard_error` may be absent.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Where it comes from.
    pub meta: SolutionMeta,
    /// Positions of the vertices, metres.
    pub positions: Vec<Vec3>,
    /// Unit normals of the vertices, on the lit side.
    pub normals: Vec<Vec3>,
    /// All light that arrives: the sum of the bounces and the tail.
    pub irradiance: Vec<Vec3>,
    /// `bounces[k][vertex]`: light that arrives after `k` reflections; `bounces[0]` is direct light.
    pub bounces: Vec<Vec<Vec3>>,
    /// Estimate of all bounces that were not computed; part of `irradiance`.
    pub tail: Option<Vec<Vec3>>,
    /// Whether the vertex was measured itself. Others, such as those inside a wall, were filled in from neighbours.
    pub valid: Vec<bool>,
    /// Standard error of `irradiance` from the sampling at each vertex, where it was measured.
    pub standard_error: Option<Vec<Vec3>>,
}

/// Where a solution comes from: the member `meta.json` of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolutionMeta {
    /// `"lumel-solution"`.
    pub format: String,
    /// Version of the layout.
    pub format_version: u32,
    /// Version of the program that wrote it.
    pub lumel_version: String,
    /// Name of the scene.
    pub scene: String,
    /// BLAKE3 of positions, normals and triangles, hexadecimal.
    pub geometry_hash: String,
    /// BLAKE3 of materials, textures, lights and sky, hexadecimal.
    pub lighting_hash: String,
    /// Settings of the bake.
    pub settings: Value,
    /// False for a bake that was stopped before it was done.
    pub complete: bool,
    /// What each array holds, and in which unit; filled in on saving.
    #[serde(default)]
    pub arrays: BTreeMap<String, String>,
    /// Times, ray counts, errors. Times make files of equal light differ.
    #[serde(default)]
    pub statistics: Value,
}

/// A part of a solution's light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SolutionSelection {
    /// All light.
    #[default]
    Sum,
    /// Light after so many reflections; 0 is direct light.
    Bounce(usize),
}

impl SolutionMeta {
    /// A complete solution of a scene, without statistics.
    pub fn new(scene: &Scene, settings: Value) -> Self {
        let hash = scene.hash();
        Self {
            format: FORMAT.to_owned(),
            format_version: FORMAT_VERSION,
            lumel_version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.name().to_owned(),
            geometry_hash: hash.geometry.to_hex().to_string(),
            lighting_hash: hash.lighting.to_hex().to_string(),
            settings,
            complete: true,
            arrays: BTreeMap::new(),
            statistics: Value::Null,
        }
    }
}

impl Solution {
    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// All light that arrives at each vertex, W·m⁻².
    pub fn sum(&self) -> &[Vec3] {
        &self.irradiance
    }

    /// Light that arrives at each vertex after `k` reflections, W·m⁻²; `None` if that was not computed.
    pub fn bounce(&self, k: usize) -> Option<&[Vec3]> {
        self.bounces.get(k).map(Vec::as_slice)
    }

    /// The chosen part of the light at each vertex, W·m⁻².
    ///
    /// # Errors
    /// A bounce that was not computed.
    pub fn select(&self, selection: SolutionSelection) -> Result<&[Vec3], SolutionError> {
        match selection {
            SolutionSelection::Sum => Ok(self.sum()),
            SolutionSelection::Bounce(wanted) => {
                self.bounce(wanted).ok_or(SolutionError::NoSuchBounce { wanted, count: self.bounces.len() })
            }
        }
    }

    /// Checks that all arrays cover the same vertices with finite numbers.
    ///
    /// # Errors
    /// The first array that does not.
    pub fn validate(&self) -> Result<(), SolutionError> {
        self.check_vectors("positions", &self.positions)?;
        self.check_vectors("normals", &self.normals)?;
        self.check_vectors("irradiance", &self.irradiance)?;
        for (k, bounce) in self.bounces.iter().enumerate() {
            self.check_vectors(&format!("bounces[{k}]"), bounce)?;
        }
        for (name, array) in self.optional_arrays() {
            self.check_vectors(name, array)?;
        }
        self.check_length("valid", self.valid.len())
    }

    /// The arrays that not every solution has, by their names.
    fn optional_arrays(&self) -> impl Iterator<Item = (&'static str, &Vec<Vec3>)> {
        let all = [("tail", &self.tail), ("standard_error", &self.standard_error)];
        all.into_iter().filter_map(|(name, array)| Some((name, array.as_ref()?)))
    }

    fn check_vectors(&self, array: &str, values: &[Vec3]) -> Result<(), SolutionError> {
        self.check_length(array, values.len())?;
        values
            .iter()
            .position(|value| !value.is_finite())
            .map_or(Ok(()), |vertex| Err(SolutionError::NotFinite { array: array.to_owned(), vertex }))
    }

    fn check_length(&self, array: &str, count: usize) -> Result<(), SolutionError> {
        let vertices = self.positions.len();
        if count == vertices {
            return Ok(());
        }
        Err(SolutionError::Length { array: array.to_owned(), count, vertices })
    }

    /// Checks that this is light on the scene's geometry; its materials and lights may have changed since.
    ///
    /// # Errors
    /// [`SolutionError::OtherScene`] names both scenes.
    pub fn check_belongs_to(&self, scene: &Scene) -> Result<(), SolutionError> {
        self.check_scene(scene, None)
    }

    fn check_scene(&self, scene: &Scene, file: Option<&Path>) -> Result<(), SolutionError> {
        let geometry_hash = scene.geometry_hash().to_hex().to_string();
        if self.meta.geometry_hash == geometry_hash && self.vertex_count() == scene.vertex_count() {
            return Ok(());
        }
        Err(SolutionError::OtherScene {
            file: file.map(Path::to_owned),
            theirs: Box::new(SceneLabel {
                name: self.meta.scene.clone(),
                vertices: self.vertex_count(),
                geometry_hash: self.meta.geometry_hash.clone(),
            }),
            ours: Box::new(SceneLabel {
                name: scene.name().to_owned(),
                vertices: scene.vertex_count(),
                geometry_hash,
            }),
        })
    }

    /// Whether the scene's materials, lights and sky are those of the bake.
    pub fn has_lighting_of(&self, scene: &Scene) -> bool {
        self.meta.lighting_hash == scene.hash().lighting.to_hex().as_str()
    }

    /// Writes the solution, atomically.
    ///
    /// # Errors
    /// As [`Self::validate`], and all that writing meets.
    pub fn save(&self, path: &Path) -> Result<(), SolutionError> {
        self.validate()?;
        let meta = SolutionMeta { arrays: self.descriptions(), ..self.meta.clone() };
        write_npz(path, |npz| {
            npz.bytes("meta.json", &serde_json::to_vec_pretty(&meta)?)?;
            npz.array("positions", &Array::from_vectors(&self.positions))?;
            npz.array("normals", &Array::from_vectors(&self.normals))?;
            npz.array("irradiance", &Array::from_vectors(&self.irradiance))?;
            npz.array("bounces", &self.bounces_array())?;
            for (name, array) in self.optional_arrays() {
                npz.array(name, &Array::from_vectors(array))?;
            }
            npz.array("valid", &Array::list(ArrayData::Bool(self.valid.clone())))
        })?;
        Ok(())
    }

    fn bounces_array(&self) -> Array {
        let values = self.bounces.iter().flatten().flat_map(|v| v.to_array()).collect();
        Array { shape: vec![self.bounces.len(), self.vertex_count(), 3], data: ArrayData::F32(values) }
    }

    fn descriptions(&self) -> BTreeMap<String, String> {
        let mut all = vec![
            ("positions", "(vertex, xyz) position, metres, +Y up"),
            ("normals", "(vertex, xyz) unit normal on the lit side"),
            (
                "irradiance",
                "(vertex, rgb) all arriving light, W/m^2 (lux if the lights are photometric), linear Rec. 709",
            ),
            ("bounces", "(bounce, vertex, rgb) part of the irradiance after 0, 1, 2.. reflections"),
            ("valid", "(vertex) true where light was measured, false where it was filled in from neighbours"),
        ];
        if self.tail.is_some() {
            all.push(("tail", "(vertex, rgb) estimated part of the irradiance of all further bounces"));
        }
        if self.standard_error.is_some() {
            all.push((
                "standard_error",
                "(vertex, rgb) standard error of the irradiance from the samples at the vertex",
            ));
        }
        all.into_iter().map(|(name, meaning)| (name.to_owned(), meaning.to_owned())).collect()
    }

    /// Reads a solution.
    ///
    /// # Errors
    /// A file that is no solution, of a newer format, or damaged; see also [`Self::validate`].
    pub fn load(path: &Path) -> Result<Self, SolutionError> {
        let mut npz = NpzReader::open(path)?;
        let meta = read_meta(&mut npz)?;
        // The names of members have no checksum, and the tail may be absent: those listed must all be there.
        for array in meta.arrays.keys() {
            if !npz.has_array(array) {
                let path = path.to_owned();
                return Err(ReadError::Missing { path, member: array.clone() }.into());
            }
        }
        let positions = read_vectors(&mut npz, "positions")?;
        let tail = read_optional(&mut npz, "tail")?;
        let standard_error = read_optional(&mut npz, "standard_error")?;
        let solution = Self {
            meta,
            normals: read_vectors(&mut npz, "normals")?,
            irradiance: read_vectors(&mut npz, "irradiance")?,
            bounces: read_bounces(&mut npz, positions.len())?,
            tail,
            valid: read_flags(&mut npz, "valid")?,
            standard_error,
            positions,
        };
        solution.validate()?;
        Ok(solution)
    }

    /// Reads the solution of a scene; errors about another scene name the file.
    ///
    /// # Errors
    /// As [`Self::load`] and [`Self::check_belongs_to`].
    pub fn load_for(path: &Path, scene: &Scene) -> Result<Self, SolutionError> {
        let solution = Self::load(path)?;
        solution.check_scene(scene, Some(path))?;
        Ok(solution)
    }
}

/// The first things a reader must know; the rest may differ in other versions.
#[derive(Deserialize)]
struct FormatOnly {
    format: String,
    format_version: u32,
}

fn read_meta(npz: &mut NpzReader) -> Result<SolutionMeta, SolutionError> {
    let path = npz.path().to_owned();
    let format = |problem: String| SolutionError::Format { path: path.clone(), problem };
    let json = npz.bytes("meta.json").map_err(|error| match error {
        ReadError::Missing { .. } => {
            format("this archive is not a lumel solution: it has no meta.json; make one with a bake".into())
        }
        error => error.into(),
    })?;
    let known: FormatOnly = serde_json::from_slice(&json).map_err(|error| {
        format(format!("this archive is not a lumel solution: its meta.json has {error}"))
    })?;
    if known.format != FORMAT {
        return Err(format(format!("this archive holds a \"{}\", not a \"{FORMAT}\"", known.format)));
    }
    if known.format_version != FORMAT_VERSION {
        return Err(format(format!(
            "this solution has format {}, this version of lumel reads format {FORMAT_VERSION}; \
             use the version that wrote it or bake again",
            known.format_version
        )));
    }
    serde_json::from_slice(&json)
        .map_err(|error| format(format!("the meta.json of this solution is incomplete: {error}")))
}

fn read_optional(npz: &mut NpzReader, name: &str) -> Result<Option<Vec<Vec3>>, SolutionError> {
    if npz.has_array(name) { read_vectors(npz, name).map(Some) } else { Ok(None) }
}

fn read_vectors(npz: &mut NpzReader, name: &str) -> Result<Vec<Vec3>, SolutionError> {
    let array = npz.array(name)?;
    match (array.shape.as_slice(), &array.data) {
        ([_, 3], ArrayData::F32(values)) => Ok(vectors(values)),
        _ => Err(wrong_shape(npz, name, "(n, 3) of <f4", &array)),
    }
}

fn read_bounces(npz: &mut NpzReader, n: usize) -> Result<Vec<Vec<Vec3>>, SolutionError> {
    let array = npz.array("bounces")?;
    match (array.shape.as_slice(), &array.data) {
        // A scene has vertices, so a size bounds the number of bounces.
        ([_, vertices, 3], ArrayData::F32(values)) if *vertices == n && n > 0 => {
            Ok(values.chunks(3 * n).map(vectors).collect())
        }
        ([0, ..], _) => Ok(Vec::new()),
        _ => Err(wrong_shape(npz, "bounces", &format!("(bounces, {n}, 3) of <f4"), &array)),
    }
}

fn read_flags(npz: &mut NpzReader, name: &str) -> Result<Vec<bool>, SolutionError> {
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

fn wrong_shape(npz: &NpzReader, name: &str, wanted: &str, array: &Array) -> SolutionError {
    let problem = format!("has the shape {:?} of {}, not {wanted}", array.shape, array.data.descr());
    ReadError::BadMember { path: npz.path().to_owned(), member: name.to_owned(), problem }.into()
}
