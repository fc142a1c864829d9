//! The command line. Its doc comments are the help texts and the manual.

mod settings;
mod shared;

use crate::parse::{self, CameraChoice};
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use glam::Vec3;
use lumel::{SolutionSelection, spec};
use lumel_render_cpu::{Exposure, MAX_SAMPLES, Show, ToneMapper};
pub(crate) use settings::SettingsArgs;
pub(crate) use shared::{ProgressMode, RunArgs, SceneArgs, ThreadArgs};
use std::ffi::OsString;
use std::path::PathBuf;

/// Bakes diffuse global illumination into the vertices of a mesh.
///
/// lumel computes how light bounces between diffuse surfaces and stores the irradiance that arrives at every vertex,
/// bounce by bounce, in W/m² (lux where a scene's lights are photometric). Metres, +Y up, linear Rec. 709.
///
/// Results go to the standard output, messages to the standard error stream. Exit codes: 0 done; 1 done, but with
/// warnings under --strict or a difference above --max-error; 2 failed; 130 cancelled.
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
  lumel info room.glb
  lumel compare a.npz b.npz";

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Bake(BakeArgs),
    Render(RenderArgs),
    Measure(MeasureArgs),
    Info(InfoArgs),
    Compare(CompareArgs),
    /// Open the viewer: fly through a scene, move lights and watch the light arrive
    ///
    /// Runs the program lumel-view that lies beside lumel, else the one on the path, with all that follows;
    /// `lumel view --help` is its help.
    #[command(disable_help_flag = true, after_help = "Example:\n  lumel view atrium")]
    View {
        /// A scene and options of lumel-view.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Print a script that completes lumel's command lines in a shell
    #[command(
        after_help = "Example:\n  lumel completions bash > ~/.local/share/bash-completion/completions/lumel"
    )]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Print the manual page, or write one for each command
    #[command(after_help = "Example:\n  lumel man | man -l -")]
    Man {
        /// Folder for the pages lumel.1, lumel-bake.1 and so on; without it lumel.1 is printed.
        dir: Option<PathBuf>,
    },
}

/// Compute the light in a scene and write it to files.
///
/// Direct light comes first, then one bounce after the other until there are enough or the rest is negligible.
/// Equal scenes and settings give the same bits on any number of threads.
///
/// After each bounce the state is kept in NAME.checkpoint.npz beside the first output, which is removed when all is
/// done. After Ctrl-C, or worse, go on with --resume.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel bake cornell-box -o cornell.glb -o cornell.png
  lumel bake room.lumel.toml --basis vertex-area -o room.npz -o room.glb
  lumel bake room.glb --max-edge 0.1 \\
      --light 'rect center=0,2.4,0 u=0.5,0,0 v=0,0,0.5 radiance=9,9,8'
  lumel bake room.lumel.toml --resume room.checkpoint.npz")]
pub(crate) struct BakeArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// A file to write, any number of times; its extension tells the format.
    ///
    /// .npz: all bounces as NumPy arrays, for every other command. .glb, .ply: the lit mesh. .obj: the lit mesh in
    /// colours only, with NAME.mtl and NAME_textures beside it. .rad: irradiance over π per vertex. .png: a picture,
    /// as `lumel render` draws it by default.
    ///
    /// Without any, NAME.npz is written into the current folder, where NAME is that of the scene. Existing files are
    /// replaced, but only by whole ones.
    #[arg(short, long = "output", value_name = "FILE")]
    pub(crate) outputs: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) settings: SettingsArgs,

    /// Go on from a checkpoint or solution with the same scene, lights and settings.
    ///
    /// Only --bounces, --remainder and --tail may differ. The result has the same bits as that of a bake that was
    /// never interrupted.
    #[arg(long, value_name = "FILE.npz", help_heading = "Run")]
    pub(crate) resume: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) run: RunArgs,

    /// Print the summary as one JSON object.
    #[arg(long, help_heading = "Run")]
    pub(crate) json: bool,
}

/// Draw a scene in the light of a solution.
///
/// Give the scene with the same --max-edge and --subdivide as for the bake: the solution must fit its vertices.
/// Materials and lights may have changed since; you are warned if they have.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel render cornell-box --solution cornell.npz -o cornell.png
  lumel render cornell-box --solution cornell.npz -o direct.png --bounce 0
  lumel render room.glb --solution room.npz -o lux.png --show false-color --range 0,500
  lumel render room.glb --solution room.npz -o door.png \\
      --camera 'position=0,1.6,3 target=0,1,0 fov=60'")]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// The light: an .npz file of `lumel bake`, or a .rad file.
    ///
    /// Needed unless albedo or normals are shown.
    #[arg(long, value_name = "FILE", required_unless_present = "show")]
    pub(crate) solution: Option<PathBuf>,

    /// The picture to write, a .png file.
    #[arg(short, long, value_name = "IMAGE.png")]
    pub(crate) output: PathBuf,

    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "960x720", value_parser = parse::size)]
    pub(crate) size: [u32; 2],

    /// Rays per pixel; powers of two are spread best.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = parse::count(1..=MAX_SAMPLES))]
    #[arg(allow_negative_numbers = true)]
    pub(crate) samples: u32,

    /// Where to look from: a camera of the scene by name, or 'position=x,y,z target=x,y,z fov=deg'.
    ///
    /// Positions are in metres, fov is the vertical field of view in degrees (default 60); up=x,y,z may be added
    /// (default 0,1,0). Without --camera: the scene's first camera, or one that suits the scene.
    #[arg(long, value_name = "NAME|VIEW", value_parser = parse::camera)]
    pub(crate) camera: Option<CameraChoice>,

    /// Which light: after K reflections (0 is direct light), or the sum of all.
    #[arg(long, value_name = "K|sum", default_value = "sum", value_parser = parse_bounce)]
    pub(crate) bounce: SolutionSelection,

    /// What to show.
    #[arg(long, value_name = "WHAT", default_value = "radiance", value_parser = parse::named_show())]
    pub(crate) show: Show,

    /// Exposure in stops (EV): light is multiplied by 2^EV; auto meters the scene. Of radiance and irradiance.
    #[arg(long, value_name = "EV|auto", default_value = "auto", allow_negative_numbers = true)]
    pub(crate) exposure: Exposure,

    /// How light brighter than the screen is shown. Of radiance and irradiance.
    #[arg(long, value_name = "CURVE", default_value = "agx", value_parser = parse::named_tone())]
    pub(crate) tone: ToneMapper,

    /// Irradiance at both ends of the false colours, W/m²; the range of what is seen by default.
    #[arg(long, value_name = "LO,HI", value_parser = parse::range, allow_hyphen_values = true)]
    pub(crate) range: Option<[f32; 2]>,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Exit with 1 if there are warnings.
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Measure the irradiance at points.
///
/// The bounces are solved at the vertices, or taken from --solution; each point then gathers them afresh, without
/// interpolating between vertices. The standard error tells the noise of that gather.
///
/// Prints a table; --json or -o give all bounces.
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

    /// A point, metres; on a surface or above it. Give a --normal for each.
    #[arg(long = "point", value_name = "X,Y,Z", value_parser = spec::vector, allow_hyphen_values = true)]
    #[arg(help_heading = "Points", required_unless_present = "points_file")]
    pub(crate) points: Vec<Vec3>,

    /// The direction a point looks in, of any length; the first is that of the first point.
    #[arg(long = "normal", value_name = "X,Y,Z", value_parser = spec::direction, allow_hyphen_values = true)]
    #[arg(help_heading = "Points", requires = "points")]
    pub(crate) normals: Vec<Vec3>,

    /// Points from a file with the arrays `points` and `normals`, both (n, 3).
    #[arg(long = "points", id = "points_file", value_name = "FILE.npz", help_heading = "Points")]
    #[arg(conflicts_with_all = ["points", "normals"])]
    pub(crate) points_file: Option<PathBuf>,

    /// Write `points`, `normals`, `irradiance`, `bounces`, `standard_error` and `bounce_errors` to this file.
    #[arg(short, long, value_name = "FILE.npz")]
    pub(crate) output: Option<PathBuf>,

    /// Take the bounces and settings of this solution instead of solving.
    #[arg(long, value_name = "FILE.npz")]
    #[arg(conflicts_with_all = ["basis", "bounces", "remainder", "tail", "preset", "emitters", "no_emissive"])]
    pub(crate) solution: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) settings: SettingsArgs,

    #[command(flatten)]
    pub(crate) run: RunArgs,

    /// Print all numbers as one JSON object.
    #[arg(long, help_heading = "Run")]
    pub(crate) json: bool,
}

/// Say what is in a scene.
///
/// Sizes, materials, lights and cameras, and in warnings everything that had to be left out.
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

    /// Exit with 1 if there are warnings.
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Say how much two solutions differ.
///
/// Bounce by bounce and in sum. RMSE is the root of the mean squared difference over vertices and channels, W/m²; the relative RMSE is that over
/// the root of the mean square of B. Mean ratio is the mean of A over that of B. Percentiles are those of |A − B|
/// over the mean of B. Every vertex counts the same; those that lie inside geometry in A or B do not count.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel compare quick.npz reference.npz
  lumel compare quick.npz reference.npz --max-error 0.02
  lumel compare other-program.rad reference.npz --json")]
pub(crate) struct CompareArgs {
    /// A solution: .npz of `lumel bake`, or .rad.
    #[arg(value_name = "A")]
    pub(crate) a: PathBuf,

    /// What it is compared with, of the same scene.
    #[arg(value_name = "B")]
    pub(crate) b: PathBuf,

    /// Exit with 1 if the relative RMSE of the sum is above this: 0.01 is one percent.
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
