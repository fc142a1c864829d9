//! What a solution remembers of its scene: what opens it again.

use crate::args::SceneArgs;
use crate::failure::hinted;
use crate::outputs::folder_of;
use crate::parse::LightChoice;
use lumel::{LightEntry, MaxEdge, SkyEntry};
use lumel_export::SolutionMeta;
use lumel_render_cpu::NormalMaps;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// How a scene was opened, in the `meta.json` of a solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SceneSource {
    scene: Place,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lights: Vec<LightEntry>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sky: Option<SkyEntry>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    two_sided: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    max_edge: Option<MaxEdge>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    subdivide: Option<u32>,
    #[serde(default, skip_serializing_if = "is_off")]
    allow_outside_paths: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    normal_maps: Option<String>,
}

fn is_off(switch: &bool) -> bool {
    !switch
}

/// Where a scene is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Place {
    /// A file; in a solution, relative to its folder.
    File(PathBuf),
    /// A built-in scene.
    Builtin(String),
}

impl SceneSource {
    /// That of a command line. `None` if a path is not to be had as text, or the scene is gone.
    pub(crate) fn of(args: &SceneArgs, normal_maps: NormalMaps) -> Option<Self> {
        let scene = match args.scene.canonicalize() {
            Ok(file) => Place::File(file),
            Err(_) => Place::Builtin(args.scene.to_str()?.to_owned()),
        };
        let mut sky = args.sky.clone();
        if let Some(SkyEntry::Image(image)) = &mut sky {
            image.image = image.image.canonicalize().ok()?;
        }
        Some(Self {
            scene,
            lights: args.lights.iter().filter_map(LightChoice::as_new).cloned().collect(),
            sky,
            two_sided: args.two_sided.clone(),
            max_edge: args.max_edge,
            subdivide: args.subdivide,
            allow_outside_paths: args.allow_outside_paths,
            normal_maps: (normal_maps != NormalMaps::default()).then(|| normal_maps.to_string()),
        })
    }

    /// What a solution that is written there says of it: files are relative to its folder, so that both may move together.
    pub(crate) fn beside(&self, solution: &Path) -> Option<Value> {
        let folder = folder_of(solution).canonicalize().ok()?;
        let mut source = self.clone();
        source.files().for_each(|file| *file = relative(file, &folder));
        serde_json::to_value(source).ok()
    }

    /// That of a solution or a lightmap.
    pub(crate) fn load(solution: &Path) -> anyhow::Result<Self> {
        let meta = SolutionMeta::load_any(solution)?;
        let path = solution.display();
        let hint = || format!("name it: lumel render SCENE --solution {path}");
        let Some(source) = meta.source else {
            return Err(hinted(format!("this solution does not say where its scene is: {path}"), hint()));
        };
        let mut source: Self = serde_json::from_value(source).map_err(|error| {
            hinted(
                format!("this solution says where its scene is in unknown words ({error}): {path}"),
                hint(),
            )
        })?;
        let folder = folder_of(solution);
        source.files().for_each(|file| *file = tidied(&folder.join(&*file)));
        for file in source.files() {
            if !fs::exists(&*file).unwrap_or(false) {
                let message = format!("the scene of {path} is no longer there: {}", file.display());
                return Err(hinted(message, hint().replace("name it", "name its new place")));
            }
        }
        Ok(source)
    }

    /// All files.
    fn files(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let scene = if let Place::File(file) = &mut self.scene { Some(file) } else { None };
        let sky =
            if let Some(SkyEntry::Image(image)) = &mut self.sky { Some(&mut image.image) } else { None };
        scene.into_iter().chain(sky)
    }

    /// Where green of normal maps points, if it is known.
    pub(crate) fn normal_maps(&self) -> Option<NormalMaps> {
        self.normal_maps.as_ref()?.parse().ok()
    }

    /// The scene with what the command line says instead.
    pub(crate) fn overridden_by(self, args: &SceneArgs) -> SceneArgs {
        let Self { scene, lights, sky, two_sided, max_edge, subdivide, allow_outside_paths, .. } = self;
        let mut all = args.lights.clone();
        if all.iter().all(|light| light.as_new().is_none()) {
            all.extend(lights.into_iter().map(|light| LightChoice::New(Box::new(light))));
        }
        SceneArgs {
            scene: match scene {
                Place::File(file) => file,
                Place::Builtin(name) => name.into(),
            },
            lights: all,
            sky: args.sky.clone().or(sky),
            two_sided: if args.two_sided.is_empty() { two_sided } else { args.two_sided.clone() },
            max_edge: args.max_edge.or(max_edge),
            subdivide: args.subdivide.or(subdivide),
            allow_outside_paths: args.allow_outside_paths || allow_outside_paths,
        }
    }
}

/// Whether a scene on the command line is a solution.
pub(crate) fn is_solution(scene: &Path) -> bool {
    scene.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npz"))
}

/// The way from a folder to a file, both canonical; the file itself where there is none.
fn relative(file: &Path, folder: &Path) -> PathBuf {
    let shared = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return file.to_owned();
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(file.components().skip(shared)).collect()
}

/// A path without the folders that it leaves again, where no link can be among them.
fn tidied(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_found_from_the_folder_of_the_solution() {
        for (file, folder, expected) in [
            ("/a/b/room.glb", "/a/b", "room.glb"),
            ("/a/b/room.glb", "/a", "b/room.glb"),
            ("/a/b/room.glb", "/a/c/d", "../../b/room.glb"),
            ("/room.glb", "/tmp", "../room.glb"),
        ] {
            assert_eq!(relative(Path::new(file), Path::new(folder)), Path::new(expected));
        }
        assert_eq!(tidied(Path::new("./room.glb")), Path::new("room.glb"));
    }
}
