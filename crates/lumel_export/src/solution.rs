//! The result of a bake: light at the vertices of a scene.

use crate::error::SceneLabel;
use crate::members::{
    Kind, SPLITS, check_members, coefficients_array, read_coefficients, read_flags, read_meta, read_numbers,
    read_optional, read_positions, read_splits, read_stacked, read_vectors, stacked, write_splits,
};
use crate::solution_points::SolutionPoints;
use crate::{Array, ArrayData, LightmapSolution, NpzReader, ReadError, SolutionError, write_npz};
use glam::{DVec3, Vec3};
use lumel_basis::{Coefficients, VertexLighting};
use lumel_scene::Scene;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// The member of light by direction, and that of the layers.
const SH: &str = "sh";
const LAYERS_SH: &str = "layers_sh";
const COEFFICIENTS: &str = "(vertex, harmonic, rgb) coefficients of the radiance L that arrives, integrals of L Y over directions, W/m^2, \
                            in real spherical harmonics in world space: Y00, Y1-1 (y), Y10 (z), Y11 (x), Y2-2 .. Y22";

/// The version changes only when the layout does.
pub(crate) const KIND: Kind =
    Kind { format: "lumel-solution", version: 1, name: "solution", remedy: "make one with a bake" };

/// Irradiance at the vertices of a scene, W·m⁻² (lux where the scene's lights are photometric), linear Rec. 709.
///
/// As a file it is a NumPy archive of the arrays `positions`, `normals`, `irradiance`, `tail` and `standard_error`
/// (n, 3), `bounces` (bounces, n, 3), `layers` (layers, n, 3) and `valid` (n), and of `meta.json`, which has the names of
/// the layers. `tail`, `standard_error`, `layers`, `occlusion` (n) and `splits` (edges, 2) may be absent, and so may the light by
/// direction, `sh` (n, harmonics, 3) and `layers_sh` (layers, n, harmonics, 3): coefficients `∫ L Y dω` of the radiance that
/// arrives in real spherical harmonics in world space, W·m⁻², in the order of [`Harmonics`](lumel_basis::Harmonics). Where points carried
/// the light, there are the arrays of [`SolutionPoints`], too.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Where it comes from.
    pub meta: SolutionMeta,
    /// Positions of the vertices in world space, metres.
    pub positions: Vec<DVec3>,
    /// Unit normals of the vertices, on the lit side.
    pub normals: Vec<Vec3>,
    /// All light that arrives: the sum of the bounces and the tail.
    pub irradiance: Vec<Vec3>,
    /// `bounces[k][vertex]`: light that arrives after `k` reflections; `bounces[0]` is direct light.
    pub bounces: Vec<Vec<Vec3>>,
    /// What no bounce contains: an estimate of those that were not computed, or if light was [shot](SolutionMeta::is_shot), all but
    /// the direct. Part of `irradiance`.
    pub tail: Option<Vec<Vec3>>,
    /// Whether the vertex was measured itself. Others, such as those inside a wall, were filled in from neighbours.
    pub valid: Vec<bool>,
    /// Standard error of `irradiance` from the sampling at each vertex, where it was measured.
    pub standard_error: Option<Vec<Vec3>>,
    /// The parts of `irradiance` that single lights or groups of them cause; they add up to it. Often there are none.
    pub layers: Vec<SolutionLayer>,
    /// `irradiance` by direction, if it was asked for: coefficients at each vertex.
    pub directional: Option<Coefficients>,
    /// Share of an even sky that each vertex sees past what is near, from 0 to 1, if it was asked for.
    pub occlusion: Option<Vec<f32>>,
    /// Where the scene was [refined](Scene::refined): the edges in whose middles the last vertices lie. What opens the scene for
    /// this light needs them.
    pub splits: Vec<[u32; 2]>,
    /// The points that carried the light, where these were not the vertices.
    pub points: Option<SolutionPoints>,
}

/// The part of a solution's light that a light, or all that share a name, cause.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionLayer {
    /// The name of the light, the emissive material or the sky; no two layers share one.
    pub name: String,
    /// Their part of the irradiance at each vertex, W·m⁻².
    pub irradiance: Vec<Vec3>,
    /// The same by direction, if it was asked for.
    pub directional: Option<Coefficients>,
}

/// Where a solution comes from: the member `meta.json` of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolutionMeta {
    /// `"lumel-solution"`, or `"lumel-lightmap"` for light at lumels.
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
    /// How many vertices tessellation might add, about, where it chose the lengths of edges that suit the scene: what
    /// opens the scene for this light needs the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertex_budget: Option<u32>,
    /// How the scene was opened, in the words of the program that did it: what opens it again for this light.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<Value>,
    /// False for a bake that was stopped before it was done.
    pub complete: bool,
    /// What each array holds, and in which unit; filled in on saving.
    #[serde(default)]
    pub arrays: BTreeMap<String, String>,
    /// The names of the layers, in their order; filled in on saving.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<String>,
    /// Times, ray counts, errors. Times make files of equal light differ.
    #[serde(default)]
    pub statistics: Value,
}

/// A part of a solution's light.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SolutionSelection {
    /// All light.
    #[default]
    Sum,
    /// Light after so many reflections; 0 is direct light.
    Bounce(usize),
    /// The light of the layer of this name.
    Layer(String),
}

impl SolutionMeta {
    /// A complete solution of a scene, without statistics.
    pub fn new(scene: &Scene, settings: Value) -> Self {
        Self::of_kind(&KIND, scene, settings)
    }

    pub(crate) fn of_kind(kind: &Kind, scene: &Scene, settings: Value) -> Self {
        let hash = scene.hash();
        Self {
            format: kind.format.to_owned(),
            format_version: kind.version,
            lumel_version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.name().to_owned(),
            geometry_hash: hash.geometry.to_hex().to_string(),
            lighting_hash: hash.lighting.to_hex().to_string(),
            settings,
            vertex_budget: None,
            source: None,
            complete: true,
            arrays: BTreeMap::new(),
            layers: Vec::new(),
            statistics: Value::Null,
        }
    }

    /// Whether its light was shot: then there is direct light, and all light, but no further bounces.
    pub fn is_shot(&self) -> bool {
        self.settings.get("schedule").and_then(Value::as_str) == Some("shoot")
    }

    /// Why there is no such bounce, where there are `count`.
    pub(crate) fn no_bounce(&self, wanted: usize, count: usize) -> SolutionError {
        if self.is_shot() {
            SolutionError::Shot { wanted }
        } else {
            SolutionError::NoSuchBounce { wanted, count }
        }
    }

    /// Reads where a solution comes from and leaves its light.
    ///
    /// # Errors
    /// A file that is no solution, of a newer format, or damaged.
    pub fn load(path: &Path) -> Result<Self, SolutionError> {
        read_meta(&mut NpzReader::open(path)?, &KIND)
    }

    /// The same of a solution or a lightmap.
    ///
    /// # Errors
    /// A file that is neither, of a newer format, or damaged.
    pub fn load_any(path: &Path) -> Result<Self, SolutionError> {
        if LightmapSolution::is_file(path) { LightmapSolution::load_meta(path) } else { Self::load(path) }
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

    /// Light at each vertex that a layer causes, W·m⁻²; `None` if there is no layer of this name.
    pub fn layer(&self, name: &str) -> Option<&[Vec3]> {
        self.layers.iter().find(|layer| layer.name == name).map(|layer| layer.irradiance.as_slice())
    }

    /// The chosen part of the light at each vertex, W·m⁻².
    ///
    /// # Errors
    /// A bounce or a layer that was not computed.
    pub fn select(&self, selection: &SolutionSelection) -> Result<&[Vec3], SolutionError> {
        match *selection {
            SolutionSelection::Sum => Ok(self.sum()),
            SolutionSelection::Bounce(wanted) => {
                self.bounce(wanted).ok_or_else(|| self.meta.no_bounce(wanted, self.bounces.len()))
            }
            SolutionSelection::Layer(ref wanted) => self.layer(wanted).ok_or_else(|| {
                let names = self.layers.iter().map(|layer| layer.name.clone()).collect();
                SolutionError::NoSuchLayer { wanted: wanted.clone(), names }
            }),
        }
    }

    /// The chosen part of the light by direction; `None` if it is not known, and for single bounces.
    pub fn select_directional(&self, selection: &SolutionSelection) -> Option<&Coefficients> {
        match selection {
            SolutionSelection::Sum => self.directional.as_ref(),
            SolutionSelection::Bounce(_) => None,
            SolutionSelection::Layer(wanted) => {
                self.layers.iter().find(|layer| layer.name == *wanted)?.directional.as_ref()
            }
        }
    }

    /// The chosen part of the light on a scene: what pictures and mesh files read.
    ///
    /// # Errors
    /// A solution of a different scene, and a bounce that was not computed.
    pub fn lighting<'a>(
        &'a self,
        scene: &'a Scene,
        selection: &SolutionSelection,
    ) -> Result<VertexLighting<'a>, SolutionError> {
        self.check_belongs_to(scene)?;
        let lighting = VertexLighting::new(scene, self.select(selection)?)?;
        Ok(lighting.with_incident(self.select_directional(selection))?)
    }

    /// Checks that all arrays cover the same vertices with finite numbers.
    ///
    /// # Errors
    /// The first array that does not.
    pub fn validate(&self) -> Result<(), SolutionError> {
        if let Some(vertex) = self.positions.iter().position(|position| !position.is_finite()) {
            return Err(SolutionError::NotFinite { array: "positions".to_owned(), vertex });
        }
        self.check_vectors("normals", &self.normals)?;
        self.check_vectors("irradiance", &self.irradiance)?;
        for (k, bounce) in self.bounces.iter().enumerate() {
            self.check_vectors(&format!("bounces[{k}]"), bounce)?;
        }
        for (name, array) in self.optional_arrays() {
            self.check_vectors(name, array)?;
        }
        for SolutionLayer { name, irradiance, directional } in &self.layers {
            self.check_vectors(&format!("layers[{name}]"), irradiance)?;
            self.check_coefficients(&format!("{LAYERS_SH}[{name}]"), directional.as_ref())?;
        }
        self.check_coefficients(SH, self.directional.as_ref())?;
        if let Some(occlusion) = &self.occlusion {
            self.check_length("occlusion", occlusion.len())?;
            if let Some(vertex) = occlusion.iter().position(|share| !share.is_finite()) {
                return Err(SolutionError::NotFinite { array: "occlusion".to_owned(), vertex });
            }
        }
        self.points.as_ref().map_or(Ok(()), SolutionPoints::validate)?;
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

    fn check_coefficients(
        &self,
        array: &str,
        coefficients: Option<&Coefficients>,
    ) -> Result<(), SolutionError> {
        let Some(coefficients) = coefficients else { return Ok(()) };
        self.check_length(array, coefficients.len())?;
        let is_bad = |vertex: &usize| coefficients.of(*vertex).iter().any(|value| !value.is_finite());
        (0..self.vertex_count())
            .find(is_bad)
            .map_or(Ok(()), |vertex| Err(SolutionError::NotFinite { array: array.to_owned(), vertex }))
    }

    fn check_length(&self, array: &str, count: usize) -> Result<(), SolutionError> {
        let vertices = self.positions.len();
        if count == vertices {
            return Ok(());
        }
        Err(SolutionError::Length { array: array.to_owned(), count, vertices })
    }

    /// Whether every layer is known by direction.
    fn has_layers_by_direction(&self) -> bool {
        !self.layers.is_empty() && self.layers.iter().all(|layer| layer.directional.is_some())
    }

    /// Checks that this is light on the scene's geometry; its materials and lights may have changed since.
    ///
    /// # Errors
    /// [`SolutionError::OtherScene`] names both scenes.
    pub fn check_belongs_to(&self, scene: &Scene) -> Result<(), SolutionError> {
        self.check_scene(scene, None)
    }

    pub(crate) fn check_scene(&self, scene: &Scene, file: Option<&Path>) -> Result<(), SolutionError> {
        let theirs = SceneLabel {
            name: self.meta.scene.clone(),
            vertices: self.vertex_count(),
            geometry_hash: self.meta.geometry_hash.clone(),
        };
        theirs.check_is(scene, file)
    }

    /// Whether the scene's materials, lights and sky are those of the bake.
    pub fn has_lighting_of(&self, scene: &Scene) -> bool {
        is_lighting_of(&self.meta.lighting_hash, scene)
    }

    /// Writes the solution, atomically.
    ///
    /// # Errors
    /// As [`Self::validate`], and all that writing meets.
    pub fn save(&self, path: &Path) -> Result<(), SolutionError> {
        self.save_from(self.meta.source.clone(), path)
    }

    /// The same, with another [source](SolutionMeta::source).
    ///
    /// # Errors
    /// As [`Self::save`].
    pub fn save_from(&self, source: Option<Value>, path: &Path) -> Result<(), SolutionError> {
        self.validate()?;
        let layers = self.layers.iter().map(|layer| layer.name.clone()).collect();
        let meta = SolutionMeta { arrays: self.descriptions(), layers, source, ..self.meta.clone() };
        write_npz(path, |npz| {
            npz.bytes("meta.json", &serde_json::to_vec_pretty(&meta)?)?;
            npz.array("positions", &Array::from_positions(&self.positions))?;
            npz.array("normals", &Array::from_vectors(&self.normals))?;
            npz.array("irradiance", &Array::from_vectors(&self.irradiance))?;
            npz.array("bounces", &stacked(&self.bounces, self.vertex_count()))?;
            for (name, array) in self.optional_arrays() {
                npz.array(name, &Array::from_vectors(array))?;
            }
            if !self.layers.is_empty() {
                let layers: Vec<_> = self.layers.iter().map(|layer| &layer.irradiance).collect();
                npz.array("layers", &stacked(&layers, self.vertex_count()))?;
            }
            if let Some(coefficients) = &self.directional {
                npz.array(SH, &coefficients_array(&[coefficients], None))?;
            }
            if self.has_layers_by_direction() {
                let all: Vec<_> = self.layers.iter().filter_map(|layer| layer.directional.as_ref()).collect();
                npz.array(LAYERS_SH, &coefficients_array(&all, Some(all.len())))?;
            }
            if let Some(occlusion) = &self.occlusion {
                npz.array("occlusion", &Array::list(ArrayData::F32(occlusion.clone())))?;
            }
            write_splits(npz, &self.splits)?;
            self.points.as_ref().map_or(Ok(()), |points| points.write(npz))?;
            npz.array("valid", &Array::list(ArrayData::Bool(self.valid.clone())))
        })?;
        Ok(())
    }

    fn descriptions(&self) -> BTreeMap<String, String> {
        let mut all = vec![
            ("positions", "(vertex, xyz) position in world space, metres, +Y up"),
            ("normals", "(vertex, xyz) unit normal on the lit side"),
            (
                "irradiance",
                "(vertex, rgb) all arriving light, W/m^2 (lux if the lights are photometric), linear Rec. 709",
            ),
            ("bounces", "(bounce, vertex, rgb) part of the irradiance after 0, 1, 2.. reflections"),
            ("valid", "(vertex) true where light was measured, false where it was filled in from neighbours"),
        ];
        if self.tail.is_some() {
            let tail = if self.meta.is_shot() {
                "(vertex, rgb) all light but the direct: it was shot, which tells no bounces apart"
            } else {
                "(vertex, rgb) estimated part of the irradiance of all further bounces"
            };
            all.push(("tail", tail));
        }
        if self.standard_error.is_some() {
            all.push((
                "standard_error",
                "(vertex, rgb) standard error of the irradiance from the samples at the vertex",
            ));
        }
        if self.occlusion.is_some() {
            all.push(("occlusion", "(vertex) share of an even sky that is seen past what is near, 0 to 1"));
        }
        if self.directional.is_some() {
            all.push((SH, COEFFICIENTS));
        }
        if self.has_layers_by_direction() {
            all.push((
                LAYERS_SH,
                "(layer, vertex, harmonic, rgb) the part of sh that each of the named layers causes",
            ));
        }
        if !self.splits.is_empty() {
            all.push((
                SPLITS,
                "(edge, end) the vertices between which, in the middle, one of the last vertices lies",
            ));
        }
        if !self.layers.is_empty() {
            all.push((
                "layers",
                "(layer, vertex, rgb) part of the irradiance that each of the named layers causes",
            ));
        }
        all.extend(self.points.iter().flat_map(SolutionPoints::descriptions));
        all.into_iter().map(|(name, meaning)| (name.to_owned(), meaning.to_owned())).collect()
    }

    /// Reads a solution.
    ///
    /// # Errors
    /// A file that is no solution, of a newer format, or damaged; see also [`Self::validate`].
    pub fn load(path: &Path) -> Result<Self, SolutionError> {
        let mut npz = NpzReader::open(path)?;
        let meta: SolutionMeta = read_meta(&mut npz, &KIND)?;
        check_members(&npz, meta.arrays.keys())?;
        let positions = read_positions(&mut npz, "positions")?;
        let tail = read_optional(&mut npz, "tail")?;
        let standard_error = read_optional(&mut npz, "standard_error")?;
        let layers = read_layers(&mut npz, &meta.layers, positions.len())?;
        let directional = read_coefficients(&mut npz, SH, None, positions.len())?.pop();
        let solution = Self {
            meta: SolutionMeta { layers: Vec::new(), ..meta },
            normals: read_vectors(&mut npz, "normals")?,
            irradiance: read_vectors(&mut npz, "irradiance")?,
            bounces: read_stacked(&mut npz, "bounces", positions.len())?,
            tail,
            valid: read_flags(&mut npz, "valid")?,
            standard_error,
            layers,
            directional,
            occlusion: if npz.has_array("occlusion") {
                Some(read_numbers(&mut npz, "occlusion")?)
            } else {
                None
            },
            splits: read_splits(&mut npz)?,
            points: SolutionPoints::read(&mut npz)?,
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

/// Whether this is the hash of a scene's materials, lights and sky, hexadecimal.
pub(crate) fn is_lighting_of(hash: &str, scene: &Scene) -> bool {
    hash == scene.hash().lighting.to_hex().as_str()
}

fn read_layers(npz: &mut NpzReader, names: &[String], n: usize) -> Result<Vec<SolutionLayer>, SolutionError> {
    if names.is_empty() {
        return Ok(Vec::new());
    }
    let layers = read_stacked(npz, "layers", n)?;
    if layers.len() != names.len() {
        let problem = format!("has {} layers, but meta.json names {}", layers.len(), names.len());
        let (path, member) = (npz.path().to_owned(), "layers".to_owned());
        return Err(ReadError::BadMember { path, member, problem }.into());
    }
    let by_direction = read_coefficients(npz, LAYERS_SH, Some(names.len()), n)?;
    let mut by_direction = by_direction.into_iter();
    let layer = |(name, irradiance): (&String, _)| SolutionLayer {
        name: name.clone(),
        irradiance,
        directional: by_direction.next(),
    };
    Ok(names.iter().zip(layers).map(layer).collect())
}
