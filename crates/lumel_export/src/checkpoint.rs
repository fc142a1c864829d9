//! A solve that can be continued.

use crate::lumel_state::{LumelMeta, LumelState};
use crate::members::{
    Kind, SPLITS, check_members, read_flags, read_format, read_meta, read_optional, read_rounds, read_splits,
    read_stacked, stacked, write_splits,
};
use crate::refinement_state::{RefinementMeta, RefinementState};
use crate::solution::is_lighting_of;
use crate::{Array, ArrayData, NpzReader, SceneLabel, Solution, SolutionError, write_npz};
use glam::Vec3;
use lumel_lightmap::LumelLight;
use lumel_scene::Scene;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// The version changes only when the layout does.
const KIND: Kind = Kind {
    format: "lumel-checkpoint",
    version: 1,
    name: "checkpoint",
    remedy: "a bake writes one after every bounce",
};

/// The member of direct light in another basis.
const DIRECT: &str = "direct";

/// The state of a solve: everything its next step reads, by node of its basis.
///
/// For lumel alone, unlike a [`Solution`], which is light at vertices for any reader. As a file it is a NumPy archive of
/// `valid` (nodes), `bounces` (bounces, nodes, 3), optionally `tail`, `standard_error`, `reflected` and `unshot` (nodes, 3), `direct` (nodes of
/// another basis, 3) and `rounds` (rounds, nodes), `splits` (edges, 2) if the scene was refined, of what is known of the light at the lumels of an atlas if that is measured, of how far the
/// mesh is refined as long as it is, and of `meta.json`.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Where it comes from.
    pub meta: CheckpointMeta,
    /// Whether each node could be measured.
    pub valid: Vec<bool>,
    /// `bounces[k][node]`: irradiance that arrived after `k` reflections, W·m⁻².
    pub bounces: Vec<Vec<Vec3>>,
    /// What shots have brought, where light is shot.
    pub shot: Option<SavedShots>,
    /// Estimate of the light that was not computed, W·m⁻².
    pub tail: Option<Vec<Vec3>>,
    /// Direct light in another basis, by its nodes, W·m⁻², where it is measured there, too.
    pub direct: Option<Vec<Vec3>>,
    /// Standard error of the sum, W·m⁻², where replicates tell.
    pub standard_error: Option<Vec<Vec3>>,
    /// The nodes that each round of a target error measures.
    pub rounds: Vec<Vec<bool>>,
    /// The edges that were split where the scene was [refined](Scene::refined).
    pub splits: Vec<[u32; 2]>,
    /// How far the mesh is refined, as long as it is: then there is no light yet.
    pub refinement: Option<RefinementState>,
}

/// What shots have brought, by node, W·m⁻².
#[derive(Clone, Debug, PartialEq)]
pub struct SavedShots {
    /// All light but the direct.
    pub reflected: Vec<Vec3>,
    /// Light that has arrived but has not been shot.
    pub unshot: Vec<Vec3>,
    /// How many batches of nodes have shot.
    pub shots: u32,
}

/// Where a checkpoint comes from: the member `meta.json` of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CheckpointMeta {
    /// `"lumel-checkpoint"`.
    pub format: String,
    /// Version of the layout.
    pub format_version: u32,
    /// Version of the program that wrote it.
    pub lumel_version: String,
    /// Name of the scene.
    pub scene: String,
    /// Number of its vertices.
    pub vertices: usize,
    /// BLAKE3 of positions, normals and triangles, hexadecimal.
    pub geometry_hash: String,
    /// BLAKE3 of materials, textures, lights and sky, hexadecimal.
    pub lighting_hash: String,
    /// Identity of the basis, hexadecimal.
    pub basis: String,
    /// Settings of the bake.
    pub settings: Value,
    /// How good the last round of a target error was, where there is one.
    #[serde(default)]
    pub accuracy: Value,
    /// How many batches of nodes have shot; filled in on saving.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub shots: u32,
    /// The arrays of the file; filled in on saving.
    #[serde(default)]
    pub arrays: Vec<String>,
    /// Which lumels have light, and how far it is measured; filled in on saving.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lumels: Option<LumelMeta>,
    /// What a refinement does next; filled in on saving.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refinement: Option<RefinementMeta>,
}

fn is_zero(shots: &u32) -> bool {
    *shots == 0
}

impl CheckpointMeta {
    /// That of a solve of a scene in a basis.
    pub fn new(scene: &Scene, basis: String, settings: Value, accuracy: Value) -> Self {
        let hash = scene.hash();
        Self {
            format: KIND.format.to_owned(),
            format_version: KIND.version,
            lumel_version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.name().to_owned(),
            vertices: scene.vertex_count(),
            geometry_hash: hash.geometry.to_hex().to_string(),
            lighting_hash: hash.lighting.to_hex().to_string(),
            basis,
            settings,
            accuracy,
            shots: 0,
            arrays: Vec::new(),
            lumels: None,
            refinement: None,
        }
    }
}

impl Checkpoint {
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.valid.len()
    }

    /// Checks that this is light on the scene's geometry; its materials and lights may have changed since.
    ///
    /// # Errors
    /// [`SolutionError::OtherScene`] names both scenes.
    pub fn check_belongs_to(&self, scene: &Scene) -> Result<(), SolutionError> {
        self.check_scene(scene, None)
    }

    fn check_scene(&self, scene: &Scene, file: Option<&Path>) -> Result<(), SolutionError> {
        let CheckpointMeta { scene: name, vertices, geometry_hash, .. } = self.meta.clone();
        SceneLabel { name, vertices, geometry_hash }.check_is(scene, file)
    }

    /// Whether the scene's materials, lights and sky are those of the bake.
    pub fn has_lighting_of(&self, scene: &Scene) -> bool {
        is_lighting_of(&self.meta.lighting_hash, scene)
    }

    /// Writes the checkpoint, atomically.
    ///
    /// # Errors
    /// Arrays that do not cover the same nodes with finite numbers, and all that writing meets.
    pub fn save(&self, path: &Path) -> Result<(), SolutionError> {
        self.save_with(None, path)
    }

    /// Writes the checkpoint and, if it is given, the light at lumels that is gathered from it, atomically.
    ///
    /// # Errors
    /// As [`save`](Self::save).
    pub fn save_with(&self, lumels: Option<LumelState<'_>>, path: &Path) -> Result<(), SolutionError> {
        self.validate()?;
        let vectors = self.vector_arrays();
        let names = ["valid", "bounces"].into_iter().chain(vectors.iter().map(|(name, _)| *name));
        let names = names.chain(self.direct.as_ref().map(|_| DIRECT));
        let names = names.chain((!self.rounds.is_empty()).then_some("rounds"));
        let names = names.chain((!self.splits.is_empty()).then_some(SPLITS));
        let arrays = names.map(str::to_owned).collect();
        let shots = self.shot.as_ref().map_or(0, |shot| shot.shots);
        let refinement = self.refinement.as_ref().map(RefinementState::meta);
        let lumel_meta = lumels.map(|lumels| lumels.meta());
        let meta = CheckpointMeta { arrays, shots, lumels: lumel_meta, refinement, ..self.meta.clone() };
        write_npz(path, |npz| {
            npz.bytes("meta.json", &serde_json::to_vec_pretty(&meta)?)?;
            npz.array("valid", &Array::list(ArrayData::Bool(self.valid.clone())))?;
            npz.array("bounces", &stacked(&self.bounces, self.node_count()))?;
            for (name, array) in &vectors {
                npz.array(name, &Array::from_vectors(array))?;
            }
            if let Some(direct) = &self.direct {
                npz.array(DIRECT, &Array::from_vectors(direct))?;
            }
            if !self.rounds.is_empty() {
                let shape = vec![self.rounds.len(), self.node_count()];
                let data = ArrayData::Bool(self.rounds.concat());
                npz.array("rounds", &Array { shape, data })?;
            }
            write_splits(npz, &self.splits)?;
            self.refinement.as_ref().map_or(Ok(()), |refinement| refinement.write(npz))?;
            lumels.map_or(Ok(()), |lumels| lumels.write(npz))
        })?;
        Ok(())
    }

    fn vector_arrays(&self) -> Vec<(&'static str, &[Vec3])> {
        let all = [("tail", &self.tail), ("standard_error", &self.standard_error)];
        let shot =
            self.shot.iter().flat_map(|shot| [("reflected", &*shot.reflected), ("unshot", &*shot.unshot)]);
        all.into_iter().filter_map(|(name, array)| Some((name, array.as_deref()?))).chain(shot).collect()
    }

    fn validate(&self) -> Result<(), SolutionError> {
        let bounces = self.bounces.iter().enumerate().map(|(k, b)| (format!("bounces[{k}]"), b.as_slice()));
        let others = self.vector_arrays().into_iter().map(|(name, array)| (name.to_owned(), array));
        for (array, values) in bounces.chain(others) {
            self.check_length(&array, values.len())?;
            check_finite(array, values)?;
        }
        self.direct.as_ref().map_or(Ok(()), |direct| check_finite(DIRECT.to_owned(), direct))?;
        self.rounds.iter().try_for_each(|round| self.check_length("rounds", round.len()))
    }

    fn check_length(&self, array: &str, count: usize) -> Result<(), SolutionError> {
        let vertices = self.node_count();
        if count == vertices {
            return Ok(());
        }
        Err(SolutionError::Length { array: array.to_owned(), count, vertices })
    }

    /// Reads a checkpoint.
    ///
    /// # Errors
    /// A file that is no checkpoint, of a newer format, or damaged.
    pub fn load(path: &Path) -> Result<Self, SolutionError> {
        Self::read(&mut NpzReader::open(path)?)
    }

    /// Reads the light at the lumels of an identity; `None` where the file has none: light at other lumels, or a solution.
    ///
    /// # Errors
    /// A file that is damaged.
    pub fn load_lumels(path: &Path, identity: &str) -> Result<Option<LumelLight>, SolutionError> {
        let mut npz = NpzReader::open(path)?;
        if read_format(&mut npz).as_deref() != Some(KIND.format) {
            return Ok(None);
        }
        let meta: CheckpointMeta = read_meta(&mut npz, &KIND)?;
        meta.lumels.filter(|lumels| lumels.is_of(identity)).map(|lumels| lumels.read(&mut npz)).transpose()
    }

    fn read(npz: &mut NpzReader) -> Result<Self, SolutionError> {
        let meta: CheckpointMeta = read_meta(npz, &KIND)?;
        check_members(npz, &meta.arrays)?;
        let refinement = meta.refinement.map(|refinement| refinement.read(npz)).transpose()?;
        let valid = read_flags(npz, "valid")?;
        let shot = match (read_optional(npz, "reflected")?, read_optional(npz, "unshot")?) {
            (Some(reflected), Some(unshot)) => Some(SavedShots { reflected, unshot, shots: meta.shots }),
            _ => None,
        };
        let checkpoint = Self {
            meta,
            shot,
            bounces: read_stacked(npz, "bounces", valid.len())?,
            tail: read_optional(npz, "tail")?,
            direct: read_optional(npz, DIRECT)?,
            standard_error: read_optional(npz, "standard_error")?,
            splits: read_splits(npz)?,
            rounds: if npz.has_array("rounds") { read_rounds(npz, valid.len())? } else { Vec::new() },
            valid,
            refinement,
        };
        checkpoint.validate()?;
        Ok(checkpoint)
    }
}

fn check_finite(array: String, values: &[Vec3]) -> Result<(), SolutionError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(vertex) => Err(SolutionError::NotFinite { array, vertex }),
    }
}

/// What a solve can be continued from.
#[derive(Clone, Debug, PartialEq)]
pub enum Saved {
    /// The state of a solve.
    Checkpoint(Box<Checkpoint>),
    /// Light at vertices: a finished bake, or a checkpoint as earlier versions wrote it.
    Solution(Box<Solution>),
}

impl Saved {
    /// Reads either kind.
    ///
    /// # Errors
    /// As [`Checkpoint::load`] and [`Solution::load`].
    pub fn load(path: &Path) -> Result<Self, SolutionError> {
        let mut npz = NpzReader::open(path)?;
        if read_format(&mut npz).as_deref() == Some(KIND.format) {
            return Ok(Self::Checkpoint(Box::new(Checkpoint::read(&mut npz)?)));
        }
        Ok(Self::Solution(Box::new(Solution::load(path)?)))
    }

    /// The edges that a scene needs to be [refined](Scene::refined) by for this light; none if it was not refined.
    ///
    /// # Errors
    /// A file that cannot be read, or is damaged.
    pub fn load_splits(path: &Path) -> Result<Vec<[u32; 2]>, SolutionError> {
        read_splits(&mut NpzReader::open(path)?)
    }

    /// Settings of the bake.
    pub fn settings(&self) -> &Value {
        match self {
            Self::Checkpoint(checkpoint) => &checkpoint.meta.settings,
            Self::Solution(solution) => &solution.meta.settings,
        }
    }

    /// Whether it is a mesh that is still being refined, without light.
    pub fn is_refinement(&self) -> bool {
        matches!(self, Self::Checkpoint(checkpoint) if checkpoint.refinement.is_some())
    }

    /// The edges that a scene is [refined](Scene::refined) by for this light; none if it was not refined.
    pub fn splits(&self) -> &[[u32; 2]] {
        match self {
            Self::Checkpoint(checkpoint) => &checkpoint.splits,
            Self::Solution(solution) => &solution.splits,
        }
    }

    /// How many bounces it holds, direct light included.
    pub fn bounce_count(&self) -> usize {
        match self {
            Self::Checkpoint(checkpoint) => checkpoint.bounces.len(),
            Self::Solution(solution) => solution.bounces.len(),
        }
    }

    /// Whether it holds an estimate of all further bounces.
    pub fn has_tail(&self) -> bool {
        match self {
            Self::Checkpoint(checkpoint) => checkpoint.tail.is_some(),
            Self::Solution(solution) => solution.tail.is_some(),
        }
    }

    /// Whether it is of a bake that was done.
    pub fn is_complete(&self) -> bool {
        matches!(self, Self::Solution(solution) if solution.meta.complete)
    }

    /// Reads either kind for a scene; errors about a different scene name the file.
    ///
    /// # Errors
    /// As [`Self::load`], and [`SolutionError::OtherScene`].
    pub fn load_for(path: &Path, scene: &Scene) -> Result<Self, SolutionError> {
        let saved = Self::load(path)?;
        match &saved {
            Self::Checkpoint(checkpoint) => checkpoint.check_scene(scene, Some(path))?,
            Self::Solution(solution) => solution.check_scene(scene, Some(path))?,
        }
        Ok(saved)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

    use super::*;
    use crate::{NextRefinement, SavedProbe};

    fn scene() -> Scene {
        lumel_builtin::scene("furnace", 0).unwrap().build().unwrap().0
    }

    fn checkpoint() -> Checkpoint {
        let scene = scene();
        let meta = CheckpointMeta::new(&scene, "ab".into(), Value::Null, serde_json::json!({"share": 0.5}));
        let field = |x: f32| (0..4).map(|i| Vec3::splat(x + i as f32)).collect::<Vec<_>>();
        Checkpoint {
            meta,
            valid: vec![true, true, false, true],
            bounces: vec![field(1.0), field(0.5)],
            shot: Some(SavedShots { reflected: field(2.0), unshot: field(3.0), shots: 7 }),
            tail: Some(field(0.25)),
            // Another basis has other nodes.
            direct: Some(field(4.0)[..3].to_vec()),
            standard_error: Some(field(0.0)),
            rounds: vec![vec![true; 4], vec![false, true, false, false]],
            splits: vec![[0, 2], [4, 1]],
            refinement: None,
        }
    }

    #[test]
    fn what_is_saved_is_what_is_loaded() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint.npz");
        let bare = Checkpoint {
            shot: None,
            tail: None,
            direct: None,
            standard_error: None,
            rounds: Vec::new(),
            splits: Vec::new(),
            ..checkpoint()
        };
        let probe = SavedProbe {
            corners: [0, 4, 4],
            light: 0.1,
            variance: 1e-9,
            visible: 5,
            irradiance: Vec3::new(0.1, 0.2, 0.3),
        };
        let refining = Checkpoint {
            valid: Vec::new(),
            bounces: Vec::new(),
            refinement: Some(RefinementState {
                next: NextRefinement::Bounce(2),
                splits: vec![[0, 1], [2, 4]],
                floor: Some(0.1),
                probes: vec![probe; 3],
            }),
            ..bare.clone()
        };
        for saved in [checkpoint(), bare, refining] {
            saved.save(&path).unwrap();
            let mut loaded = Checkpoint::load(&path).unwrap();
            assert!(!std::mem::take(&mut loaded.meta.arrays).is_empty());
            loaded.meta.shots = 0;
            assert_eq!(loaded.meta.refinement.take(), saved.refinement.as_ref().map(RefinementState::meta));
            assert_eq!(loaded, saved);
            assert!(matches!(Saved::load(&path), Ok(Saved::Checkpoint(_))));
        }
    }

    #[test]
    fn arrays_that_do_not_fit_together_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npz");
        let mut short = checkpoint();
        short.rounds[1].pop();
        let error = short.save(&path).unwrap_err().to_string();
        assert!(error.contains("rounds"), "{error}");
        let mut infinite = checkpoint();
        infinite.bounces[1][2].y = f32::INFINITY;
        let error = infinite.save(&path).unwrap_err().to_string();
        assert!(error.contains("bounces[1]"), "{error}");
        let mut infinite = checkpoint();
        infinite.direct = Some(vec![Vec3::NAN]);
        let error = infinite.save(&path).unwrap_err().to_string();
        assert!(error.contains("direct"), "{error}");
    }

    #[test]
    fn other_materials_keep_the_geometry_but_not_the_lighting() {
        let (scene, checkpoint) = (scene(), checkpoint());
        assert!(checkpoint.has_lighting_of(&scene));
        let painted = scene.repainted(&vec![Vec3::splat(0.125); scene.materials().len()]);
        checkpoint.check_belongs_to(&painted).unwrap();
        assert!(!checkpoint.has_lighting_of(&painted));
    }

    #[test]
    fn a_checkpoint_is_not_taken_for_a_solution() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npz");
        checkpoint().save(&path).unwrap();
        let error = Solution::load(&path).unwrap_err().to_string();
        assert!(error.contains("lumel-checkpoint"), "{error}");
    }
}
