//! Options that several commands have.

use crate::console::Messages;
use crate::parse::{self, LightChoice};
use clap::{Args, ValueEnum};
use glam::Vec3;
use lumel::{OpenOptions, PathPolicy, spec};

/// The largest number of threads; machines with more cores than that are not built.
const MAX_THREADS: u32 = 1024;

/// Which scene, and what to change about it.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// A mesh file (.obj, .gltf, .glb, .ply), a project file (.lumel.toml) or a built-in scene.
    #[arg(value_name = "SCENE", long_help = scene_help())]
    pub(crate) scene: String,

    /// A rectangle light: 'rect center=x,y,z u=x,y,z v=x,y,z radiance=r,g,b'. May be repeated.
    ///
    /// u and v are half of each edge, metres, and perpendicular; the light emits towards u × v. radiance is in
    /// W/(m² sr); name=TEXT, without spaces, is optional. These lights replace those of the scene or project; emissive
    /// surfaces and the sky remain.
    #[arg(long = "light", value_name = "LIGHT", value_parser = parse::light, help_heading = "Scene")]
    pub(crate) lights: Vec<LightChoice>,

    /// Radiance that arrives from outside the scene from all directions, W/(m² sr); replaces the sky of the scene.
    #[arg(long, value_name = "R,G,B", value_parser = spec::color, help_heading = "Scene")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) sky: Option<Vec3>,

    /// Split edges longer than this, metres. Light is stored at vertices: fine shadows need short edges.
    #[arg(long, value_name = "L", value_parser = parse::length, help_heading = "Scene")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) max_edge: Option<f32>,

    /// Halve the edges of a built-in scene this many times, 0 to 5.
    #[arg(long, value_name = "N", help_heading = "Scene")]
    #[arg(value_parser = parse::count(0..=lumel_builtin::MAX_SUBDIVIDE), allow_negative_numbers = true)]
    pub(crate) subdivide: Option<u32>,

    /// Allow scene and project files to refer to files outside their folder.
    #[arg(long, help_heading = "Scene")]
    pub(crate) allow_outside_paths: bool,
}

fn scene_help() -> String {
    let mut help = "A mesh file (.obj, .gltf, .glb, .ply), a project file (.lumel.toml) or a built-in scene.\n\n\
        A project file specifies a scene, its lights, cameras and bake settings. Built-in scenes (a file of the same \
        name takes precedence):"
        .to_owned();
    for name in lumel_builtin::NAMES {
        let about = lumel_builtin::describe(name).unwrap_or_default();
        help += &format!("\n- {name}: {about}");
    }
    help
}

impl SceneArgs {
    /// How to open the scene.
    pub(crate) fn open_options(&self) -> OpenOptions {
        let paths = if self.allow_outside_paths { PathPolicy::Anywhere } else { PathPolicy::WithinFolder };
        OpenOptions { paths, max_edge: self.max_edge, subdivide: self.subdivide }
    }
}

/// How many threads.
#[derive(Debug, Args)]
pub(crate) struct ThreadArgs {
    /// Number of threads; does not affect the result. [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse::count(1..=MAX_THREADS), help_heading = "Run")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) threads: Option<u32>,
}

/// How to run.
#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// How progress is shown on standard error.
    #[arg(long, value_name = "HOW", value_enum, default_value_t = ProgressMode::Auto, help_heading = "Run")]
    pub(crate) progress: ProgressMode,

    /// Exit with code 1 if there are warnings.
    #[arg(long, help_heading = "Run")]
    pub(crate) strict: bool,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressMode {
    /// A bar on a terminal, plain lines elsewhere
    Auto,
    /// A line of text every few seconds
    Plain,
    /// One JSON object per line, also for warnings and errors
    Json,
    /// Only warnings and errors
    None,
}

impl ProgressMode {
    /// How messages are written in this mode.
    pub(crate) fn messages(self) -> Messages {
        if self == Self::Json { Messages::Json } else { Messages::Text }
    }
}
