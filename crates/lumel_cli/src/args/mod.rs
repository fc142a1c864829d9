//! The command line. Its doc comments are the help texts and the manual.

mod atlas;
mod gltf;
mod settings;
mod shared;
mod unwrap;

use crate::parse::{self, CameraChoice};
pub(crate) use atlas::AtlasArgs;
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use glam::{DVec3, Vec3};
use gltf::GltfArgs;
use lumel::{LightBasis, LightmapEntry, LightmapTarget, OcclusionEntry, Shading, SolutionSelection, spec};
use lumel_render_cpu::{Exposure, MAX_SAMPLES, NormalMaps, Show, ToneMapper};
pub(crate) use settings::SettingsArgs;
pub(crate) use shared::{ProgressMode, RunArgs, SceneArgs, Tessellation, ThreadArgs};
use std::ffi::OsString;
use std::path::PathBuf;
pub(crate) use unwrap::UnwrapArgs;

/// Bakes diffuse global illumination into the vertices of a mesh.
///
/// lumel computes how light bounces between diffuse surfaces and stores the irradiance at every vertex, bounce by
/// bounce, in W/m² (in lux if the lights of the scene are photometric). Metres, +Y up, linear Rec. 709.
///
/// Results are written to standard output, messages to standard error. Exit codes: 0 done; 1 done, but with warnings
/// under --strict or a difference above --max-error; 2 failed; 130 cancelled.
#[derive(Debug, Parser)]
#[command(name = "lumel", version, max_term_width = 100, args_override_self = true, after_help = EXAMPLES)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXAMPLES: &str = "\
Examples:
  lumel bake cornell-box -o cornell.npz -o cornell.glb -o cornell.png
  lumel render cornell-box --solution cornell.npz -o bounce1.png --bounce 1
  lumel unwrap room.glb -o room-unwrapped.glb -o atlas.png
  lumel info room.glb
  lumel compare a.npz b.npz";

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Bake(BakeArgs),
    Render(RenderArgs),
    Measure(MeasureArgs),
    Unwrap(UnwrapArgs),
    Info(InfoArgs),
    Compare(CompareArgs),
    /// Open the viewer: fly through a scene, move lights and watch the light arrive
    ///
    /// Runs lumel-view from the folder of lumel, or else from the path, with all arguments that follow; `lumel view
    /// --help` prints its help.
    #[command(disable_help_flag = true, after_help = "Example:\n  lumel view atrium")]
    View {
        /// A scene and options for lumel-view.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Print a shell completion script
    #[command(
        after_help = "Example:\n  lumel completions bash > ~/.local/share/bash-completion/completions/lumel"
    )]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Print the manual page, or write one page per command
    #[command(after_help = "Example:\n  lumel man | man -l -")]
    Man {
        /// Folder for lumel.1, lumel-bake.1 and so on; if omitted, lumel.1 is printed.
        dir: Option<PathBuf>,
    },
}

/// Compute the light in a scene and write it to files.
///
/// Direct light comes first, then one bounce after another, up to the requested number or until the remainder is
/// negligible. The same scene and settings give the same bits on any number of threads.
///
/// After each bounce, and of a lightmap after each part of the lumels, the state is saved as NAME.checkpoint.npz next to
/// the first output; the file is removed when the bake is done. After Ctrl-C or a crash, continue with --resume.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel bake cornell-box -o cornell.glb -o cornell.png
  lumel bake room.lumel.toml --projection area -o room.npz -o room.glb
  lumel bake room.glb --max-edge 0.1 \\
      --light 'rect center=0,2.4,0 u=0.5,0,0 v=0,0,0.5 radiance=9,9,8'
  lumel bake room.lumel.toml --resume room.checkpoint.npz")]
pub(crate) struct BakeArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// A file to write; its extension selects the format. May be repeated.
    ///
    /// .npz: all bounces as NumPy arrays, which the other commands read. .glb, .ply: the lit mesh. .obj: the lit mesh
    /// with colours only, and next to it NAME.mtl and NAME_textures. .rad: irradiance divided by π per vertex. .png: an
    /// image, as `lumel render` draws it by default.
    ///
    /// By default, NAME.npz is written to the current folder, where NAME is the name of the scene. An existing file is
    /// replaced only when the new one is complete.
    #[arg(short, long = "output", value_name = "FILE")]
    pub(crate) outputs: Vec<PathBuf>,

    /// Where light is stored. [default: vertex]
    #[arg(long, value_enum, value_name = "BASIS")]
    pub(crate) basis: Option<Basis>,

    /// Where green of the scene's normal maps points: up or down. It is up in the .glb files and .png images that are written.
    #[arg(long, value_name = "WAY", default_value = "up", value_parser = parse::named_green())]
    #[arg(hide_possible_values = true, help_heading = "Normal maps")]
    pub(crate) normal_maps: NormalMaps,

    /// What a .glb file with a lightmap is made for. [default: any]
    #[arg(long, value_enum, value_name = "TARGET", help_heading = "Atlas")]
    pub(crate) target: Option<Target>,

    #[command(flatten)]
    pub(crate) gltf: GltfArgs,

    /// What a .png file of a lightmap holds.
    #[arg(long, value_enum, value_name = "WHAT", default_value_t = Png::Picture, help_heading = "Atlas")]
    pub(crate) png: Png,

    /// Whether noise is taken off a lightmap where its standard error says that it is noise. [default: on, with --preset
    /// production off]
    ///
    /// The error comes from two halves of the samples. .exr files have it as "error", and the light with its noise as "noisy".
    #[arg(long, value_enum, value_name = "SWITCH", help_heading = "Atlas")]
    pub(crate) denoise: Option<Switch>,

    /// Also compute ambient occlusion: the share of an even sky that surfaces see, of which what is nearer than so many metres
    /// hides a part.
    ///
    /// It becomes the array "occlusion" of .npz files, a layer of .exr files, and the occlusion texture of .glb files with
    /// --target occlusion.
    #[arg(long = "ao", value_name = "METRES", value_parser = parse::length, help_heading = "Ambient occlusion")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) ao_distance: Option<f32>,

    /// How fast hiding falls with the distance: 1 evenly, 2 faster, 0 not before the end. [default: 1]
    #[arg(long, value_name = "POWER", value_parser = parse::tolerance)]
    #[arg(allow_negative_numbers = true, help_heading = "Ambient occlusion")]
    pub(crate) ao_falloff: Option<f64>,

    #[command(flatten)]
    pub(crate) atlas: AtlasArgs,

    #[command(flatten)]
    pub(crate) settings: SettingsArgs,

    /// Continue from a checkpoint or solution of the same scene, lights and settings.
    ///
    /// Only --bounces, --remainder, --tail, --layers and --directional may differ. The result has the same bits as an uninterrupted bake.
    ///
    /// With a target error, --bounces and --tail may differ, too: the samples of all finished rounds are used again, and
    /// errors are computed again for the new sum. A bake from the start may choose other vertices for its rounds.
    #[arg(long, value_name = "FILE.npz", help_heading = "Run")]
    pub(crate) resume: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) run: RunArgs,

    /// Print the summary as one JSON object.
    #[arg(long, help_heading = "Run")]
    pub(crate) json: bool,
}

/// Where a bake stores light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Basis {
    /// At the vertices of the mesh, whose long edges are split.
    #[value(alias = "vertex-area")]
    Vertex,
    /// On points that are scattered over the surfaces, see --point-spacing; in the end it is read at the vertices.
    Points,
    /// In lumels, the texels of a lightmap: the mesh stays as it is.
    Lightmap,
}

impl BakeArgs {
    /// What they say of the lightmap.
    pub(crate) fn lightmap(&self) -> LightmapEntry {
        LightmapEntry {
            denoise: self.denoise.map(|switch| switch == Switch::On),
            target: self.target.map(LightmapTarget::from),
            ..self.atlas.entry()
        }
    }

    /// What they say of ambient occlusion.
    pub(crate) fn occlusion(&self) -> OcclusionEntry {
        OcclusionEntry { distance: self.ao_distance, falloff: self.ao_falloff.map(|falloff| falloff as f32) }
    }
}

impl From<LightBasis> for Basis {
    fn from(basis: LightBasis) -> Self {
        match basis {
            LightBasis::Vertex => Self::Vertex,
            LightBasis::Points => Self::Points,
            LightBasis::Lightmap => Self::Lightmap,
        }
    }
}

/// On or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Switch {
    /// Yes.
    On,
    /// No.
    Off,
}

/// What a PNG file of a bake with a lightmap holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Png {
    /// A picture of the lit scene.
    Picture,
    /// The pages, 16 bits: linear irradiance over a power of two, which a text of the file has.
    #[value(name = "16")]
    Sixteen,
    /// The pages, 8 bits, dithered.
    #[value(name = "8")]
    Eight,
}

/// What a GLB file with a lightmap is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Target {
    /// three.js, by the extension MOZ_lightmap: irradiance, apart from albedo.
    Three,
    /// Any viewer: reflected light, as emission of black surfaces.
    Any,
    /// Any program that lights the scene itself: ambient occlusion, see --ao.
    Occlusion,
}

impl From<LightmapTarget> for Target {
    fn from(target: LightmapTarget) -> Self {
        match target {
            LightmapTarget::Three => Self::Three,
            LightmapTarget::Any => Self::Any,
            LightmapTarget::Occlusion => Self::Occlusion,
        }
    }
}

impl From<Target> for LightmapTarget {
    fn from(target: Target) -> Self {
        match target {
            Target::Three => Self::Three,
            Target::Any => Self::Any,
            Target::Occlusion => Self::Occlusion,
        }
    }
}

/// What `--light` means to `lumel render`.
const LIGHT_OR_LAYER: &str = "\
Show only the light of the layer NAME, which a bake with --layers lights stores: the name of a light, \"sky\", or the \
name of an emissive material. `lumel info` lists them.

Lights as for `lumel bake`, 'sun direction=x,y,z ...', say that the solution was baked with them.";

/// Render an image of a scene lit by a solution.
///
/// A solution alone is enough: it remembers where its scene is, and how it was opened. Of a scene that is named, use the same
/// --max-edge and --subdivide as for the bake: the solution must match the vertices. Materials and lights may have changed
/// since the bake; lumel warns if they have.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel render cornell.npz -o cornell.png
  lumel render cornell.npz -o direct.png --bounce 0
  lumel render room.glb --solution room.npz -o lux.png --show false-color --range 0,500
  lumel render room.glb --solution room.npz -o door.png \\
      --camera 'position=0,1.6,3 target=0,1,0 fov=60'")]
#[command(mut_arg("scene", |scene| scene.value_name("SCENE|SOLUTION.npz")))]
#[command(mut_arg("lights", |light| {
    light
        .value_name("LIGHT|NAME")
        .value_parser(parse::light_or_layer)
        .help("Show only the light of the layer NAME, from a bake with --layers lights; or a light of the bake")
        .long_help(LIGHT_OR_LAYER)
}))]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// The light: an .npz file from `lumel bake`, or a .rad file.
    ///
    /// Required unless albedo or normals are shown, or a solution stands in the place of the scene.
    #[arg(long, value_name = "FILE")]
    pub(crate) solution: Option<PathBuf>,

    /// The image to write, a .png file. [default: NAME.png in the current folder]
    #[arg(short, long, value_name = "IMAGE.png")]
    pub(crate) output: Option<PathBuf>,

    /// Size of the image in pixels.
    #[arg(long, value_name = "WxH", default_value = "960x720", value_parser = parse::size)]
    pub(crate) size: [u32; 2],

    /// Rays per pixel; powers of two are distributed best.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = parse::count(1..=MAX_SAMPLES))]
    #[arg(allow_negative_numbers = true)]
    pub(crate) samples: u32,

    /// The camera: a camera of the scene by name, 'position=x,y,z target=x,y,z fov=deg', or auto.
    ///
    /// Positions are in metres; fov is the vertical field of view in degrees (default 60); up=x,y,z is optional
    /// (default 0,1,0). auto suits the scene, whatever cameras it has: it looks across a room, and has all of an object
    /// in the picture. Without --camera: the first camera of the scene, or else auto.
    #[arg(long, value_name = "NAME|VIEW|auto", value_parser = parse::camera)]
    pub(crate) camera: Option<CameraChoice>,

    /// The bounce to show: the light after K reflections (0: direct light), or the sum of all.
    #[arg(long, value_name = "K|sum", default_value = "sum", value_parser = parse_bounce)]
    pub(crate) bounce: SolutionSelection,

    /// The quantity to show.
    #[arg(long, value_name = "WHAT", default_value = "radiance", value_parser = parse::named_show())]
    pub(crate) show: Show,

    /// Whether normal maps are shown. Light tilts with them where the solution knows its directions. [default: up]
    #[arg(long, value_name = "WHICH", value_parser = parse::named_normal_maps())]
    pub(crate) normal_maps: Option<NormalMaps>,

    /// How light on tilted normals is found, where the solution knows its directions.
    #[arg(long, value_name = "HOW", default_value = "nonlinear", value_parser = parse::named_shading())]
    pub(crate) shading: Shading,

    /// Exposure in stops (EV): light is multiplied by 2^EV; auto meters the scene. For radiance and irradiance.
    #[arg(long, value_name = "EV|auto", default_value = "auto", allow_negative_numbers = true)]
    pub(crate) exposure: Exposure,

    /// The tone curve for light brighter than the screen. For radiance and irradiance.
    #[arg(long, value_name = "CURVE", default_value = "agx", value_parser = parse::named_tone())]
    pub(crate) tone: ToneMapper,

    /// Irradiance at both ends of the false-colour scale, W/m². [default: the range in view]
    #[arg(long, value_name = "LO,HI", value_parser = parse::range, allow_hyphen_values = true)]
    pub(crate) range: Option<[f32; 2]>,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Exit with code 1 if there are warnings.
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Measure the irradiance at points.
///
/// The bounces are solved at the vertices or read from --solution; each point then gathers light with its own rays,
/// without interpolation between vertices. The standard error is the noise of this gather.
///
/// Prints a table; use --json or -o for all bounces.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel measure cornell-box --point 0.278,0,0.28 --normal 0,1,0
  lumel measure room.glb --solution room.npz --points desks.npz -o desks-light.npz
  lumel measure furnace --no-emissive --bounces 0 --point 0,-0.5,0 --normal 0,1,0 \\
      --light 'rect center=0,0.4,0 u=0.2,0,0 v=0,0,0.2 radiance=9,9,9'")]
pub(crate) struct MeasureArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// A point, metres, on a surface or above it. Each needs a --normal. May be repeated.
    #[arg(long = "point", value_name = "X,Y,Z", value_parser = spec::place, allow_hyphen_values = true)]
    #[arg(help_heading = "Points", required_unless_present = "points_file")]
    pub(crate) points: Vec<DVec3>,

    /// The normal at a point, of any length; given in the order of the points.
    #[arg(long = "normal", value_name = "X,Y,Z", value_parser = spec::direction, allow_hyphen_values = true)]
    #[arg(help_heading = "Points", requires = "points")]
    pub(crate) normals: Vec<Vec3>,

    /// A file of points, with the arrays `points` and `normals`, both (n, 3).
    #[arg(long = "points", id = "points_file", value_name = "FILE.npz", help_heading = "Points")]
    #[arg(conflicts_with_all = ["points", "normals"])]
    pub(crate) points_file: Option<PathBuf>,

    /// A file to write `points`, `normals`, `irradiance`, `bounces`, `standard_error` and `bounce_errors` to.
    #[arg(short, long, value_name = "FILE.npz")]
    pub(crate) output: Option<PathBuf>,

    /// Use the bounces and settings of this solution instead of solving.
    #[arg(long, value_name = "FILE.npz")]
    #[arg(conflicts_with_all = ["projection", "bounces", "remainder", "tail", "preset", "emitters", "no_emissive"])]
    pub(crate) solution: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) settings: SettingsArgs,

    #[command(flatten)]
    pub(crate) run: RunArgs,

    /// Print all results as one JSON object.
    #[arg(long, help_heading = "Run")]
    pub(crate) json: bool,
}

/// Describe the contents of a scene.
///
/// Prints sizes, materials, lights and cameras, and warns about everything that was left out.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel info cornell-box
  lumel info room.glb --json")]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Print one JSON object.
    #[arg(long)]
    pub(crate) json: bool,

    /// Exit with code 1 if there are warnings.
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Compare two solutions.
///
/// Prints the differences for each bounce and for the sum. RMSE: the root mean square difference over vertices and
/// channels, W/m². Relative RMSE: RMSE divided by the root mean square of B. Mean ratio: the mean of A divided by the
/// mean of B. Percentiles: of |A − B| divided by the mean of B. All vertices have equal weight; vertices that lie inside
/// geometry in A or B are excluded.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel compare quick.npz reference.npz
  lumel compare quick.npz reference.npz --max-error 0.02
  lumel compare other-program.rad reference.npz --json")]
pub(crate) struct CompareArgs {
    /// A solution: an .npz file from `lumel bake`, or a .rad file.
    #[arg(value_name = "A")]
    pub(crate) a: PathBuf,

    /// The solution to compare it with, of the same scene.
    #[arg(value_name = "B")]
    pub(crate) b: PathBuf,

    /// Exit with code 1 if the relative RMSE of the sum is above this; 0.01 is one percent.
    #[arg(long, value_name = "X", value_parser = parse::tolerance, allow_negative_numbers = true)]
    pub(crate) max_error: Option<f64>,

    /// Print one JSON object.
    #[arg(long)]
    pub(crate) json: bool,
}

fn parse_bounce(text: &str) -> Result<SolutionSelection, String> {
    match text {
        "sum" => Ok(SolutionSelection::Sum),
        k => k
            .parse()
            .map(SolutionSelection::Bounce)
            .map_err(|_| "it must be the number of a bounce or \"sum\"".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_option_is_explained() {
        for command in Cli::command().get_subcommands() {
            for argument in command.get_arguments() {
                assert!(argument.get_help().is_some(), "{} {}", command.get_name(), argument.get_id());
            }
        }
    }
}
