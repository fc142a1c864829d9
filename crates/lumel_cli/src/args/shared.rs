//! Options that several commands have.

use crate::args::Basis;
use crate::console::Messages;
use crate::parse::{self, LightChoice};
use clap::{Args, ValueEnum};
use lumel::{LightKind, MaxEdge, OpenOptions, PathPolicy, SkyEntry, spec};
use std::path::PathBuf;

/// The largest number of threads; machines with more cores than that are not built.
const MAX_THREADS: u32 = 1024;

/// Which scene, and what to change about it.
#[derive(Clone, Debug, Args)]
pub(crate) struct SceneArgs {
    /// A mesh file (.obj, .gltf, .glb, .ply), a project file (.lumel.toml) or a built-in scene.
    #[arg(value_name = "SCENE", long_help = scene_help())]
    pub(crate) scene: PathBuf,

    /// A light: its kind, then key=value words, such as 'sun direction=-1,-2,-1 irradiance=5,5,5'. May be repeated.
    #[arg(long = "light", value_name = "LIGHT", value_parser = parse::light, help_heading = "Scene")]
    #[arg(long_help = light_help())]
    pub(crate) lights: Vec<LightChoice>,

    /// Light from outside the scene: a colour R,G,B, a gradient or an image; replaces the sky of the scene.
    ///
    /// R,G,B is the radiance from all directions, W/(m² sr); one number stands for all three.
    ///
    /// 'gradient zenith=R,G,B horizon=R,G,B ground=R,G,B' changes linearly with the sine of the elevation; +Y is up. The
    /// ground is as the horizon by default.
    ///
    /// 'FILE rotation=DEG strength=X' is an equirectangular image, HDR or EXR, whose middle is the direction -Z. It is turned
    /// counter-clockwise about +Y, seen from above, and multiplied by X; both are optional. Bright texels, such as a sun,
    /// are sampled as lights are.
    #[arg(long, value_name = "SKY", value_parser = spec::sky, help_heading = "Scene")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) sky: Option<SkyEntry>,

    /// Light both sides of the faces of the material or object NAME; "all" for all. May be repeated.
    ///
    /// Faces are black from behind unless their file says that they have two sides. OBJ and PLY cannot say it: there, sheets
    /// have two sides, and boxes, rooms and whatever emits one; "none" leaves them all with one. Use this where faces are
    /// wound the wrong way round, or for thin walls and leaves. In project files: two_sided.
    #[arg(long, value_name = "NAME", help_heading = "Scene")]
    pub(crate) two_sided: Vec<String>,

    /// Split edges longer than this: a length in metres or with a unit, such as 10cm, auto or off.
    ///
    /// Light is stored at vertices: fine shadows need short edges. auto, the default for files without --adaptive, suits the scene: a 64th of
    /// its diameter, longer around the part where most of the triangles are, and longer where it would add more vertices
    /// than the preset allows: about 50,000 for draft, 200,000 for medium, 500,000 for production. A solution says how
    /// many it was baked with. Built-in scenes stay as they are. `lumel info` says what auto would choose.
    #[arg(long, value_name = "L|auto|off", help_heading = "Scene")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) max_edge: Option<MaxEdge>,

    /// Halve the edges of a built-in scene this many times, 0 to 5.
    #[arg(long, value_name = "N", help_heading = "Scene")]
    #[arg(value_parser = parse::count(0..=lumel_builtin::MAX_SUBDIVIDE), allow_negative_numbers = true)]
    pub(crate) subdivide: Option<u32>,

    /// Allow scene and project files to refer to files outside their folder.
    #[arg(long, help_heading = "Scene")]
    pub(crate) allow_outside_paths: bool,
}

fn light_help() -> String {
    let mut help = "A light: its kind, then key=value words in any order. May be repeated. These lights replace those of \
        the scene or project; emissive surfaces and the sky remain.\n"
        .to_owned();
    for kind in LightKind::ALL {
        help += &format!("\n- '{}'", kind.example());
    }
    help + "\n\nLengths are in metres, angles in degrees. A light faces a direction=X,Y,Z or the point toward=X,Y,Z. A rect \
        may have u=X,Y,Z and v=X,Y,Z, half of each edge, instead of its size=W,H; it then emits towards u × v. radiance \
        is in W/(m² sr), intensity in W/sr, irradiance in W/m² on a surface that faces the sun; one number stands for R,G,B. A point with a radius is \
        a sphere, whose intensity is that from afar. A spot fades from inner to outer, angles from its axis (default 0 \
        and 45). range, optional for a point and a spot, is where it ends. angle is the diameter of the sun (default \
        0.53; 0 for sharp shadows). name=TEXT, without spaces, is optional."
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

/// What decides how finely a scene is tessellated, beside what its own options say.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tessellation {
    /// How many vertices lengths that suit the scene may add, about; otherwise those of the preset.
    pub(crate) vertex_budget: Option<u32>,
    /// Whether the mesh is to follow light; otherwise what a project says.
    pub(crate) adaptive: Option<bool>,
    /// The edges that were split to follow light.
    pub(crate) splits: Vec<[u32; 2]>,
}

impl Tessellation {
    /// The same for light on this basis, if one is asked for: with points, it is these that follow light, not the mesh.
    pub(crate) fn on(self, basis: Option<Basis>) -> Self {
        let adaptive = if basis == Some(Basis::Points) { Some(false) } else { self.adaptive };
        Self { adaptive, ..self }
    }
}

impl SceneArgs {
    /// How to open the scene.
    pub(crate) fn open_options(&self, tessellation: &Tessellation) -> OpenOptions {
        let paths = if self.allow_outside_paths { PathPolicy::Anywhere } else { PathPolicy::WithinFolder };
        OpenOptions {
            paths,
            max_edge: self.max_edge,
            vertex_budget: tessellation.vertex_budget,
            adaptive: tessellation.adaptive,
            subdivide: self.subdivide,
            two_sided: self.two_sided.clone(),
            keeps_whole: false,
        }
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
