//! Project files: a scene with its lights, cameras and settings.

use crate::camera_entry::CameraEntry;
use crate::light_entry::LightEntry;
use crate::lightmap_entry::{LightBasis, LightmapEntry};
use crate::max_edge::MaxEdge;
use crate::occlusion_entry::OcclusionEntry;
use crate::setting;
use crate::settings::{PointSpacing, SettingsError, SettingsPatch};
use crate::sky_entry::SkyEntry;
use glam::{DVec3, Vec3};
use lumel_export::{ExportError, write_atomically};
use serde::{Deserialize, Serialize};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The largest number of a slot: each digit key has one.
const MAX_SLOT: u8 = 9;

/// The content of a `NAME.lumel.toml`.
///
/// ```
/// let text = r#"
///     builtin = "cornell-box"       # or: scene = "room.glb", relative to this file
///     max_edge = 0.05               # metres, or "auto" or "off"
///
///     [[light]]
///     center = [0.0, 1.9, 0.0]
///     u = [0.2, 0.0, 0.0]
///     v = [0.0, 0.0, -0.2]
///     radiance = [10.0, 9.0, 8.0]
///
///     [[camera]]
///     name = "door"
///     position = [0.0, 1.0, 3.0]
///     target = [0.0, 1.0, 0.0]
///     fov_deg = 50.0
///
///     [bake]
///     preset = "draft"
///     bounces = "all"
/// "#;
/// let project: lumel::Project = text.parse().unwrap();
/// assert_eq!(project.lights.len(), 1);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Project {
    /// The mesh file, relative to the project file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<PathBuf>,
    /// The built-in scene, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub builtin: Option<String>,
    /// Levels of refinement of a built-in scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub subdivide: Option<u32>,
    /// Longest edge after tessellation: metres, `"auto"` or `"off"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_edge: Option<MaxEdge>,
    /// Where a bake stores light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub basis: Option<LightBasis>,
    /// Names of materials or objects that have two sides, whatever the mesh file says; `"all"` or `"*"` for all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub two_sided: Vec<String>,
    /// Light from outside the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sky: Option<SkyEntry>,
    /// Objects that differ from those of the mesh file.
    #[serde(default, rename = "object", skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectEntry>,
    /// Materials that differ from those of the mesh file.
    #[serde(default, rename = "material", skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialEntry>,
    /// Lights; if there are any, they replace those of the mesh file.
    #[serde(default, rename = "light", skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<LightEntry>,
    /// Viewpoints, before those of the mesh file.
    #[serde(default, rename = "camera", skip_serializing_if = "Vec::is_empty")]
    pub cameras: Vec<CameraEntry>,
    /// Settings of the bake.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bake: SettingsPatch,
    /// How a lightmap is laid out, finished and written.
    #[serde(default, skip_serializing_if = "is_default")]
    pub lightmap: LightmapEntry,
    /// Ambient occlusion, which is computed besides light.
    #[serde(default, skip_serializing_if = "is_default")]
    pub ambient_occlusion: OcclusionEntry,
    /// Views with their own lights and settings, which editors keep under a number; bakes ignore them.
    #[serde(default, rename = "slot", skip_serializing_if = "Vec::is_empty")]
    pub slots: Vec<SlotEntry>,
}

/// The albedo of a material in a project file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialEntry {
    /// The name of the material; the entry applies to all materials of that name.
    pub name: String,
    /// Linear, 0 to 1; multiplies the texture, if there is one.
    pub albedo: Vec3,
}

/// How fine the lumels of an object are, in a project file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectEntry {
    /// The name of the object; the entry applies to all objects of that name.
    pub name: String,
    /// What multiplies the density of its lumels.
    pub density_factor: f32,
}

/// A numbered view in a project file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlotEntry {
    /// 0 to 9; no two slots share one.
    pub number: u8,
    /// The viewpoint; it needs no name.
    pub camera: CameraEntry,
    /// The lights instead of those of the project, with their textures.
    #[serde(default, rename = "light", skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<LightEntry>,
    /// Settings instead of those of the project.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bake: SettingsPatch,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Why a project file cannot be used or written.
#[derive(Debug, thiserror::Error)]
pub enum ProjectError {
    /// It cannot be read.
    #[error("cannot read project file {}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: std::io::Error,
    },
    /// Its content is not valid.
    #[error("{}: {message}", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] ExportError),
}

impl std::str::FromStr for Project {
    type Err = toml::de::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        toml::from_str(text)
    }
}

impl Project {
    /// Whether a path is that of a project file: it ends with `.toml`.
    pub fn is_file_name(path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
    }

    /// Reads a project file.
    ///
    /// # Errors
    /// A file that cannot be read or is not a valid project; the message shows the line.
    pub fn read(path: &Path) -> Result<Self, ProjectError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ProjectError::Read { path: path.to_owned(), source })?;
        let invalid = |message: String| ProjectError::Invalid { path: path.to_owned(), message };
        let project: Self = text.parse().map_err(|error| invalid(fault(&text, &error)))?;
        project.problem().map_or(Ok(project), |problem| Err(invalid(problem)))
    }

    /// Writes a project file: completely or not at all, with the same bytes for the same project. It reads back unchanged.
    ///
    /// Comments and the layout of an older file at `path` are lost.
    ///
    /// # Errors
    /// A project that [`Self::read`] would refuse, or a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), ProjectError> {
        let invalid = |message: String| ProjectError::Invalid { path: path.to_owned(), message };
        if let Some(problem) = self.problem() {
            return Err(invalid(problem));
        }
        let text = toml::to_string(self).map_err(|error| invalid(error.to_string()))?;
        Ok(write_atomically(path, |out| out.write_all(text.as_bytes()))?)
    }

    /// What it sets of a bake: that of `bake`, with points if they are its basis.
    pub fn settings(&self) -> SettingsPatch {
        let mut settings = self.bake.clone();
        if self.basis == Some(LightBasis::Points) {
            settings.point_spacing.get_or_insert(PointSpacing::Auto);
        }
        settings
    }

    /// The project with its lights and views elsewhere: in the coordinates of a scene, whose
    /// [origin](lumel_scene::SceneBuilder::origin) files do not know, or back in world space.
    #[must_use]
    pub fn moved(&self, by: DVec3) -> Self {
        let lights = |lights: &[LightEntry]| lights.iter().map(|light| light.moved(by)).collect();
        let slot = |slot: &SlotEntry| SlotEntry {
            camera: slot.camera.moved(by),
            lights: lights(&slot.lights),
            ..slot.clone()
        };
        Self {
            lights: lights(&self.lights),
            cameras: self.cameras.iter().map(|camera| camera.moved(by)).collect(),
            slots: self.slots.iter().map(slot).collect(),
            ..self.clone()
        }
    }

    /// What is wrong although the types allow it.
    fn problem(&self) -> Option<String> {
        let patches = self.slots.iter().map(|slot| &slot.bake).chain([&self.bake]);
        if let Some(error) = patches.map(SettingsPatch::validate).find_map(Result::err) {
            return Some(error.to_string());
        }
        if let Some(problem) = self.sky.as_ref().and_then(SkyEntry::problem) {
            return Some(problem.to_owned());
        }
        let lights = self.lights.iter().chain(self.slots.iter().flat_map(|slot| &slot.lights));
        for (i, light) in lights.enumerate() {
            if let Err(error) = light.light() {
                let name = light.name.clone().unwrap_or_else(|| format!("light {}", i + 1));
                return Some(format!("light \"{name}\": {error}"));
            }
        }
        if self.scene.is_some() == self.builtin.is_some() {
            return Some("name either a mesh file by `scene` or a built-in scene by `builtin`".into());
        }
        if self.cameras.iter().any(|camera| camera.name.is_empty()) {
            return Some("every `[[camera]]` needs a `name`".into());
        }
        let possible = |albedo: Vec3| albedo.is_finite() && albedo.clamp(Vec3::ZERO, Vec3::ONE) == albedo;
        if let Some(entry) = self.materials.iter().find(|entry| !possible(entry.albedo)) {
            return Some(format!("the albedo of material \"{}\" must lie between 0 and 1", entry.name));
        }
        if let Some(problem) = self.lightmap.problem() {
            return Some(problem);
        }
        if let Some(problem) = self.ambient_occlusion.problem() {
            return Some(problem.to_owned());
        }
        let is_factor = |factor: f32| factor > 0.0 && factor.is_finite();
        if let Some(entry) = self.objects.iter().find(|entry| !is_factor(entry.density_factor)) {
            return Some(format!("the density factor of object \"{}\" must be above 0", entry.name));
        }
        let numbers: Vec<u8> = self.slots.iter().map(|slot| slot.number).collect();
        if let Some(number) = numbers.iter().find(|&&number| number > MAX_SLOT) {
            return Some(format!("there is no slot {number}: slots have numbers from 0 to {MAX_SLOT}"));
        }
        let twice = numbers.iter().enumerate().find(|(i, number)| numbers[..*i].contains(number));
        twice.map(|(_, number)| format!("there is more than one slot {number}"))
    }
}

/// What is wrong with a text, in the words of the command line where it is the value of a setting.
fn fault(text: &str, error: &toml::de::Error) -> String {
    let line = error.span().map(|span| 1 + text[..span.start].matches('\n').count());
    let refused = text.parse().ok().and_then(|all: toml::Table| refused_setting(&all));
    if let (Some(line), Some(error)) = (line, refused) {
        return format!("line {line}: {error}");
    }
    let whole = |range: &str| format!("expected a whole number from 0 to {range}");
    let text = error.to_string().replace("expected u32", &whole("4294967295"));
    text.replace("expected u64", &whole("18446744073709551615")).trim_end().to_owned()
}

/// The first setting of a project, or of one of its slots, that cannot have the value that is given.
fn refused_setting(all: &toml::Table) -> Option<SettingsError> {
    let slots = all.get("slot").and_then(toml::Value::as_array).into_iter().flatten();
    let bakes = slots.filter_map(|slot| slot.get("bake")).chain(all.get("bake"));
    bakes.filter_map(toml::Value::as_table).find_map(|bake| {
        setting::ALL.iter().find_map(|setting| {
            let about = setting.about();
            let names = about.former.iter().chain([&about.name]);
            let value = names.filter_map(|name| bake.get(*name)).next()?;
            let text = match value {
                toml::Value::String(text) => text.clone(),
                number => number.to_string(),
            };
            setting.parse(&text).err()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BounceLimit, Preset, Settings, UvChoice};
    use lumel_export::LightmapTarget;

    fn read_text(text: &str) -> Result<Project, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.lumel.toml");
        std::fs::write(&path, text).unwrap();
        Project::read(&path).map_err(|error| error.to_string().replace(&*path.to_string_lossy(), "FILE"))
    }

    fn written(project: &Project) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.lumel.toml");
        project.write(&path).unwrap();
        assert_eq!(Project::read(&path).unwrap(), *project);
        std::fs::read_to_string(path).unwrap()
    }

    fn full() -> Project {
        let light = LightEntry {
            name: Some("window \"left\"".into()),
            center: Some(DVec3::new(0.1, 2.4, -1e-7)),
            u: Some(Vec3::X / 3.0),
            v: Some(Vec3::Z),
            radiance: Some(Vec3::new(10.0, 0.7, 1e6)),
            texture: Some("sky.png".into()),
            off: true,
            constant_power: true,
            ..LightEntry::default()
        };
        let camera = CameraEntry {
            name: "door".into(),
            position: DVec3::ONE,
            target: DVec3::ZERO,
            up: Vec3::Z,
            fov_deg: 35.5,
        };
        let slot = SlotEntry {
            number: 9,
            camera: CameraEntry { name: String::new(), ..camera.clone() },
            lights: vec![light.clone(), LightEntry { name: None, off: false, ..light.clone() }],
            bake: SettingsPatch { bounces: Some(BounceLimit::All), ..SettingsPatch::default() },
        };
        Project {
            scene: Some("room.glb".into()),
            builtin: None,
            subdivide: Some(1),
            max_edge: Some(MaxEdge::Length(0.1)),
            basis: Some(LightBasis::Lightmap),
            two_sided: vec!["*".into()],
            sky: Some(SkyEntry::Color(Vec3::splat(0.3))),
            materials: vec![MaterialEntry { name: "wall".into(), albedo: Vec3::new(0.7, 0.2, 1.0) }],
            objects: vec![ObjectEntry { name: "floor".into(), density_factor: 0.3 }],
            lights: vec![light],
            cameras: vec![camera],
            lightmap: LightmapEntry {
                lumels: Some(1 << 18),
                atlas_size: Some(1024),
                gutter: Some(3),
                align: Some(4),
                uv: Some(UvChoice::New),
                time_limit: Some(60),
                denoise: Some(false),
                target: Some(LightmapTarget::Occlusion),
                density: None,
            },
            ambient_occlusion: OcclusionEntry { distance: Some(0.5), falloff: Some(2.0) },
            bake: SettingsPatch::complete(&Settings { seed: u64::MAX, ..Preset::Production.settings() }),
            slots: vec![slot.clone(), SlotEntry { number: 0, lights: Vec::new(), ..slot }],
        }
    }

    #[test]
    fn a_written_project_reads_back_the_same_in_short_numbers() {
        let text = written(&full());
        assert!(text.starts_with("scene = \"room.glb\"\nsubdivide = 1\nmax_edge = 0.1\n"), "{text}");
        for line in
            ["center = [0.1, 2.4, -0.0000001]", "off = true", "sky = [0.3, 0.3, 0.3]", "[[slot.light]]"]
        {
            assert!(text.lines().any(|l| l == line), "{line} in\n{text}");
        }
        assert_eq!(text, written(&text.parse().unwrap()), "written again, nothing moves");
        let small = Project { builtin: Some("furnace".into()), ..Project::default() };
        assert_eq!(written(&small), "builtin = \"furnace\"\n");
    }

    #[test]
    fn every_number_reads_back_to_the_bit() {
        let mut project = Project { builtin: Some("furnace".into()), ..Project::default() };
        // All exponents, and mantissas that a generator picks.
        let mut bits = 12_345u32;
        let floats: Vec<f32> = (0..30_000)
            .map(|_| {
                bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f32::from_bits(bits ^ (bits >> 15))
            })
            .filter(|f| f.is_finite())
            .chain([f32::MIN_POSITIVE, f32::MAX, 1e-45, -0.0])
            .collect();
        let entry =
            |c: &[f32]| LightEntry { center: Some(Vec3::from_slice(c).as_dvec3()), ..LightEntry::default() };
        project.lights = floats.chunks_exact(3).map(entry).collect();
        let back: Project = toml::to_string(&project).unwrap().parse().unwrap();
        for (a, b) in project.lights.iter().zip(&back.lights) {
            let bits = |entry: &LightEntry| entry.center.unwrap().to_array().map(f64::to_bits);
            assert_eq!(bits(a), bits(b));
        }
        assert_eq!(project.lights.len(), back.lights.len());
    }

    #[test]
    fn slots_need_numbers_of_their_own_from_0_to_9() {
        let slot = |n: u8| {
            format!("[[slot]]\nnumber = {n}\n[slot.camera]\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\n")
        };
        let head = "builtin = \"furnace\"\n";
        let project = read_text(&format!("{head}{}{}", slot(3), slot(0))).unwrap();
        assert_eq!((project.slots[0].number, project.slots[0].camera.fov_deg), (3, 60.0));
        let error = read_text(&format!("{head}{}{}", slot(3), slot(3))).unwrap_err();
        assert_eq!(error, "FILE: there is more than one slot 3");
        let error = read_text(&format!("{head}{}", slot(10))).unwrap_err();
        assert_eq!(error, "FILE: there is no slot 10: slots have numbers from 0 to 9");
        let error =
            read_text(&format!("{head}[[camera]]\nposition = [0, 0, 1]\ntarget = [0, 0, 0]")).unwrap_err();
        assert_eq!(error, "FILE: every `[[camera]]` needs a `name`");
    }

    #[test]
    fn numbers_that_a_setting_cannot_be_are_refused_in_the_words_of_the_command_line() {
        let refused = |line: &str| {
            let error = read_text(&format!("builtin = \"furnace\"\n[bake]\n{line}")).unwrap_err();
            error.strip_prefix("FILE: ").unwrap().to_owned()
        };
        for line in ["bounces = -3", "bounces = 4294967296", "bounces = 1.5"] {
            let value = line.rsplit(' ').next().unwrap();
            let words = "but must be a whole number from 0 to 10000, or all";
            assert_eq!(refused(line), format!("line 3: bounces is \"{value}\" {words}"));
        }
        assert!(refused("seed = -1").contains("seed is \"-1\" but must be a whole number from 0 to 1844"));
        assert!(refused("direct_samples = -4").contains("must be a whole number from 1 to 16777216"));
        assert!(refused("memory = -1").contains("memory is \"-1\" but must be"));
        let error = read_text("builtin = \"furnace\"\nsubdivide = -1").unwrap_err();
        assert!(error.contains("expected a whole number from 0 to 4294967295"), "{error}");
    }

    #[test]
    fn what_cannot_be_read_back_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        let twice = vec![full().slots[0].clone(); 2];
        for project in [Project::default(), Project { slots: twice, ..full() }] {
            let error = project.write(&path).unwrap_err();
            assert!(error.to_string().starts_with(&*path.to_string_lossy()), "{error}");
            assert!(!path.exists());
        }
        let error = full().write(&folder.path().join("missing/a.toml")).unwrap_err().to_string();
        assert!(error.contains("missing"), "{error}");
    }

    #[test]
    fn albedos_outside_0_to_1_are_refused_with_the_name_of_the_material() {
        for albedo in ["[0.1, 1.2, 0.3]", "[-0.1, 0.2, 0.3]", "[nan, 0.2, 0.3]"] {
            let text = format!("builtin = \"furnace\"\n[[material]]\nname = \"wall\"\nalbedo = {albedo}\n");
            let error = read_text(&text).unwrap_err();
            assert_eq!(error, "FILE: the albedo of material \"wall\" must lie between 0 and 1");
        }
    }

    #[test]
    fn every_setting_can_stand_in_a_project_and_is_checked_there() {
        let complete = SettingsPatch::complete(&Settings::default());
        let text =
            written(&Project { builtin: Some("furnace".into()), bake: complete, ..Project::default() });
        for setting in crate::setting::ALL {
            let name = setting.about().name;
            assert!(text.lines().any(|line| line.starts_with(&format!("{name} = "))), "{name} in\n{text}");
            let error = read_text(&format!("builtin = \"furnace\"\n[bake]\n{name} = {{}}\n")).unwrap_err();
            assert!(error.contains(name), "{error}");
        }
        for table in [
            "[bake]",
            "[[slot]]\nnumber = 1\ncamera = { position = [0, 0, 1], target = [0, 0, 0] }\n[slot.bake]",
        ] {
            let error =
                read_text(&format!("builtin = \"furnace\"\n{table}\ndirect_samples = 0\n")).unwrap_err();
            assert_eq!(error, "FILE: direct_samples is 0 but must be a whole number from 1 to 16777216");
        }
    }

    #[test]
    fn lightmaps_that_cannot_be_and_factors_that_are_none_are_refused() {
        let project = |text: &str| read_text(&format!("builtin = \"furnace\"\n{text}\n"));
        let full = "basis = \"lightmap\"\n[lightmap]\ndensity = 12.5\n[[object]]\nname = \"ball\"\ndensity_factor = 2";
        let read = project(full).unwrap();
        assert_eq!((read.basis, read.lightmap.density), (Some(LightBasis::Lightmap), Some(12.5)));
        assert_eq!(read.objects[0].density_factor, 2.0);
        for (text, problem) in [
            ("[lightmap]\ndensity = 1\nlumels = 9", "[lightmap] has both a density and a number of lumels"),
            (
                "[lightmap]\natlas_size = 99",
                "[lightmap]: the page size is 99; it must be a multiple of 4 from 64 to 16384",
            ),
            (
                "[[object]]\nname = \"ball\"\ndensity_factor = 0",
                "the density factor of object \"ball\" must be above 0",
            ),
        ] {
            assert_eq!(project(text).unwrap_err(), format!("FILE: {problem}"));
        }
        for (text, problem) in [
            ("distance = 0", "[ambient_occlusion]: the distance must be above 0"),
            ("distance = 1\nfalloff = -1", "[ambient_occlusion]: the falloff must be 0 or more"),
            ("falloff = 1", "[ambient_occlusion] has a falloff, but no distance"),
        ] {
            let error = project(&format!("[ambient_occlusion]\n{text}")).unwrap_err();
            assert_eq!(error, format!("FILE: {problem}"));
        }
        assert!(project("[lightmap]\ntarget = \"unity\"").unwrap_err().contains("unity"));
        assert!(project("[lightmap]\ngutters = 1").unwrap_err().contains("gutters"));
    }

    #[test]
    fn a_complete_patch_is_its_settings() {
        for settings in Preset::ALL.map(Preset::settings) {
            let patch = SettingsPatch { preset: Some(Preset::Draft), ..SettingsPatch::complete(&settings) };
            assert_eq!(patch.settings(), settings);
        }
        assert_eq!(SettingsPatch::complete(&Settings::default()).preset, None);
    }
}
