//! The built-in scenes of the lumel baker, made by code: no files to download and no licence of anyone else.
//!
//! [`NAMES`] lists them. [`scene`] returns a [`SceneBuilder`], still open to changes.
//!
//! ```
//! let (scene, warnings) = lumel_builtin::scene("cornell-box", 0).expect("a known name").build()?;
//! assert!(warnings.is_empty() && scene.vertex_count() > 10_000);
//! # Ok::<(), lumel_scene::SceneError>(())
//! ```

mod analytic;
mod atrium;
mod cornell;
mod leather;
mod noise;
mod painting;
mod shapes;

use lumel_scene::SceneBuilder;

/// The finest level of [`scene`]; higher ones are taken as this one. The atrium then has 67 million triangles.
pub const MAX_SUBDIVIDE: u32 = 5;

struct Entry {
    name: &'static str,
    about: &'static str,
    make: fn(u32) -> SceneBuilder,
}

const SCENES: [Entry; 5] = [
    Entry {
        name: "atrium",
        about: "A court with arcades on two storeys, under the open sky",
        make: atrium::atrium,
    },
    Entry {
        name: "cornell-box",
        about: "The Cornell box as measured, lit neutrally",
        make: cornell::cornell_box,
    },
    Entry {
        name: "cornell-leather",
        about: "The Cornell box with a back wall of tufted leather: albedo and normal maps",
        make: leather::cornell_leather,
    },
    Entry {
        name: "furnace",
        about: "A closed cube of albedo 0.5 whose walls all emit light",
        make: analytic::furnace,
    },
    Entry {
        name: "sphere",
        about: "A sphere from inside, where irradiance is 2 everywhere",
        make: analytic::sphere,
    },
];

/// The names of the built-in scenes.
pub const NAMES: &[&str] = &{
    let mut names = [""; SCENES.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = SCENES[i].name;
        i += 1;
    }
    names
};

/// One line about a built-in scene; `None` for a name that is not one of [`NAMES`].
pub fn describe(name: &str) -> Option<&'static str> {
    find(name).map(|entry| entry.about)
}

/// A built-in scene, its edges halved `subdivide` times; `None` for a name that is not one of [`NAMES`].
///
/// Level 0 is fine enough for light in vertices. Curved surfaces stay as round as their number of triangles allows.
pub fn scene(name: &str, subdivide: u32) -> Option<SceneBuilder> {
    find(name).map(|entry| (entry.make)(subdivide.min(MAX_SUBDIVIDE)))
}

fn find(name: &str) -> Option<&'static Entry> {
    SCENES.iter().find(|entry| entry.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_builds_without_warnings_under_its_name() {
        for name in NAMES {
            let (scene, warnings) = scene(name, 0).unwrap().build().unwrap();
            assert!(warnings.is_empty(), "{name}: {:?}", warnings.iter().next());
            assert_eq!(scene.name(), *name);
            assert!(!scene.cameras().is_empty(), "{name} has a camera");
            assert!(!describe(name).unwrap().contains('\n'), "{name} is described in one line");
        }
    }

    #[test]
    fn unknown_names_are_none() {
        assert!(scene("teapot", 0).is_none() && describe("").is_none());
    }

    #[test]
    fn a_scene_is_the_same_whenever_it_is_made() {
        for name in NAMES {
            let hash = || scene(name, 0).unwrap().build().unwrap().0.hash();
            assert_eq!(hash(), hash(), "{name}");
        }
    }

    #[test]
    fn each_level_has_four_times_the_triangles() {
        for name in NAMES {
            let count =
                |level| scene(name, level).unwrap().objects.iter().map(|o| o.faces.len()).sum::<usize>();
            let ratio = count(1) as f64 / count(0) as f64;
            assert!((3.8..=4.0).contains(&ratio), "{name}: {ratio}");
        }
    }
}
