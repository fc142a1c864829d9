//! Options that several commands have.

use crate::console::Messages;
use crate::parse;
use clap::{Args, ValueEnum};
use glam::Vec3;
use lumel::{
    BasisKind, BounceLimit, EmitterSampling, LightSampling, Memory, OpenOptions, PathPolicy, Preset,
    RectLight, SamplerKind, SettingsPatch, Share, SolverKind, Tail, TargetError,
};

/// The largest number of samples per receiver.
const MAX_SAMPLES: u32 = 1 << 24;
/// The largest number of threads; machines with more cores than that are not built.
const MAX_THREADS: u32 = 1024;

/// Which scene, and what to change about it.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// A mesh file (.obj, .gltf, .glb, .ply), a project file (.lumel.toml) or a built-in scene.
    #[arg(value_name = "SCENE", long_help = scene_help())]
    pub(crate) scene: String,

    /// A rectangle light 'rect center=x,y,z u=x,y,z v=x,y,z radiance=r,g,b', any number of times.
    ///
    /// u and v are half of its edges, metres, at a right angle; light leaves on the u × v side. radiance is in
    /// W/(m² sr). The lights given here replace those of the scene or project; emissive surfaces and sky stay.
    #[arg(long = "light", value_name = "LIGHT", value_parser = parse::light, help_heading = "Scene")]
    pub(crate) lights: Vec<RectLight>,

    /// Radiance from outside the scene in all directions, W/(m² sr); replaces that of the scene.
    #[arg(long, value_name = "R,G,B", value_parser = parse::color, help_heading = "Scene")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) sky: Option<Vec3>,

    /// Split edges longer than this, metres: light is stored in vertices, and so details need them.
    #[arg(long, value_name = "L", value_parser = parse::length, help_heading = "Scene")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) max_edge: Option<f32>,

    /// Halve the edges of a built-in scene this often, 0 to 5.
    #[arg(long, value_name = "N", help_heading = "Scene")]
    #[arg(value_parser = parse::count(0..=lumel_builtin::MAX_SUBDIVIDE), allow_negative_numbers = true)]
    pub(crate) subdivide: Option<u32>,

    /// Let scene and project files refer to files outside their folder.
    #[arg(long, help_heading = "Scene")]
    pub(crate) allow_outside_paths: bool,
}

fn scene_help() -> String {
    let mut help = "A mesh file (.obj, .gltf, .glb, .ply), a project file (.lumel.toml) or a built-in scene.\n\n\
        A project file names a scene, its lights, cameras and bake settings. Built-in scenes, unless there is a file \
        of that name:"
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

/// Settings of the solve.
#[derive(Debug, Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct SettingsArgs {
    /// Settings to start from. Project files and the options here go before it. [default: medium]
    #[arg(long, value_name = "NAME", value_parser = parse::named::<Preset>(&[
        ("draft", "2 bounces, 16 direct and 64 indirect samples: to see where the light goes"),
        ("medium", "4 bounces, 64 direct and 256 indirect samples: clean enough to look at"),
        ("production", "all bounces, 256 direct and 1024 indirect samples: to ship"),
    ]))]
    pub(crate) preset: Option<Preset>,

    /// Where light is measured. [default: vertex]
    #[arg(long, value_name = "BASIS", value_parser = parse::named::<BasisKind>(&[
        ("vertex", "at the vertices; those inside geometry take the light of their neighbours"),
        ("vertex-area", "over the triangles around each vertex: for vertices in corners and inside walls"),
    ]))]
    pub(crate) basis: Option<BasisKind>,

    /// Number of reflections after the direct light, or all: until the rest is negligible. [default: by preset]
    #[arg(long, value_name = "N|all", value_parser = parse::bounces, allow_negative_numbers = true)]
    pub(crate) bounces: Option<BounceLimit>,

    /// With --bounces all: the share of all light that may be missing. [default: 0.001]
    #[arg(long, value_name = "SHARE", value_parser = parse::share, allow_negative_numbers = true)]
    pub(crate) remainder: Option<f32>,

    /// What to add for the bounces that are not computed. [default: off]
    #[arg(long, value_name = "KIND", value_parser = parse::named::<Tail>(&[
        ("off", "nothing"),
        ("geometric", "the last bounce times the sum of a geometric series: an estimate"),
    ]))]
    pub(crate) tail: Option<Tail>,

    /// Shadow rays per vertex and light. [default: by preset]
    #[arg(long, value_name = "N", value_parser = parse::count(1..=MAX_SAMPLES), allow_negative_numbers = true)]
    pub(crate) direct_samples: Option<u32>,

    /// Rays into the hemisphere per vertex and bounce. [default: by preset]
    #[arg(long, value_name = "N", value_parser = parse::count(1..=MAX_SAMPLES), allow_negative_numbers = true)]
    pub(crate) indirect_samples: Option<u32>,

    /// Where sample points come from. [default: sobol]
    #[arg(long, value_name = "NAME", value_parser = parse::named::<SamplerKind>(&[
        ("sobol", "scrambled Sobol points: least noise, best for powers of two"),
        ("halton", "shifted Halton points: good for any number"),
        ("stratified", "one point in each cell of a grid; the number is rounded up to a square"),
        ("random", "independent points: most noise"),
    ]))]
    pub(crate) sampler: Option<SamplerKind>,

    /// How lights with an area are sampled. [default: analytic]
    #[arg(long, value_name = "KIND", value_parser = parse::named::<LightSampling>(&[
        ("analytic", "closed form of the unblocked light minus what is blocked: noise only in half-shadow"),
        ("area", "points uniform over the light: the textbook estimator"),
    ]))]
    pub(crate) light_sampling: Option<LightSampling>,

    /// Let only lights and sky shine, not emissive surfaces.
    #[arg(long)]
    pub(crate) no_emissive: bool,

    /// How bounces are computed. [default: cached]
    #[arg(long, value_name = "KIND", value_parser = parse::named::<SolverKind>(&[
        ("cached", "trace rays once, store them, and apply them bounce after bounce"),
        ("neumann", "trace rays of its own for every bounce: slower, and no memory for rays"),
    ]))]
    pub(crate) solver: Option<SolverKind>,

    /// Memory for stored rays, such as 500MB or 2GiB. Where it is too little for all, fewer are stored and all light is
    /// gathered once more at the end. [default: 2GiB]
    #[arg(long, value_name = "SIZE")]
    pub(crate) memory: Option<Memory>,

    /// Add samples until values are known to this, such as 1% or 0.01: half their 95 % interval, relative. [default: off]
    ///
    /// Eight independent solves share the samples; their spread gives the standard error of every value, which is kept
    /// in the solution. Vertices where it is too large get more samples, up to 64 times as many as at first and as
    /// many rays as --memory allows. Values darker than a tenth of the mean are compared with that.
    #[arg(long, value_name = "SHARE|off")]
    pub(crate) target_error: Option<TargetError>,

    /// With --target-error: the share of values that must be known so well. [default: 95%]
    #[arg(long, value_name = "SHARE")]
    pub(crate) target_share: Option<Share>,

    /// Changes all random choices. [default: 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
}

impl SettingsArgs {
    /// The settings that were given.
    pub(crate) fn patch(&self) -> SettingsPatch {
        SettingsPatch {
            preset: self.preset,
            basis: self.basis,
            bounces: self.bounces,
            remainder: self.remainder,
            tail: self.tail,
            direct_samples: self.direct_samples,
            indirect_samples: self.indirect_samples,
            sampler: self.sampler,
            light_sampling: self.light_sampling,
            emitters: self.no_emissive.then_some(EmitterSampling::Off),
            solver: self.solver,
            memory: self.memory,
            target_error: self.target_error,
            target_share: self.target_share,
            seed: self.seed,
        }
    }
}

/// How many threads.
#[derive(Debug, Args)]
pub(crate) struct ThreadArgs {
    /// Number of threads; the result does not depend on it. [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse::count(1..=MAX_THREADS), help_heading = "Run")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) threads: Option<u32>,
}

/// How to run.
#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// How progress is shown on the standard error stream.
    #[arg(long, value_name = "HOW", value_enum, default_value_t = ProgressMode::Auto, help_heading = "Run")]
    pub(crate) progress: ProgressMode,

    /// Exit with 1 if there are warnings.
    #[arg(long, help_heading = "Run")]
    pub(crate) strict: bool,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressMode {
    /// A bar on a terminal, else plain lines
    Auto,
    /// A line of text every few seconds
    Plain,
    /// One JSON object a line; warnings and errors too
    Json,
    /// Nothing but warnings and errors
    None,
}

impl ProgressMode {
    /// How messages are written beside it.
    pub(crate) fn messages(self) -> Messages {
        if self == Self::Json { Messages::Json } else { Messages::Text }
    }
}
