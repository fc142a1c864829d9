//! Options of `lumel unwrap`.

use super::{AtlasArgs, SceneArgs, ThreadArgs};
use crate::parse;
use clap::Args;
use lumel_render_cpu::NormalMaps;
use std::path::PathBuf;

/// Lay out a scene for a lightmap.
///
/// Every lit triangle gets lumels of its own on the pages of an atlas: surfaces are cut where they crease, flattened and
/// packed, each instance and each side of two-sided surfaces apart. The result is checked; an object whose charts
/// overlap gets simpler ones and is named. The mesh stays as it is in its file: edges are split only with --max-edge.
///
/// The same scene and settings give the same atlas on any number of threads and any processor.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lumel unwrap room.glb -o room-unwrapped.glb -o atlas.png
  lumel unwrap room.glb --density 50 --atlas-size 4096 -o room-unwrapped.glb
  lumel unwrap room.glb --density-factor 'Table=2' --density-factor 'Garden=0.1' --json")]
pub(crate) struct UnwrapArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// A file to write; its extension selects the format. May be repeated.
    ///
    /// .glb: the scene with its places in the atlas as TEXCOORD_1, with cameras and all lights but areas. .png: a picture of the
    /// atlas; of several pages, NAME-0.png, NAME-1.png and so on. Without -o only the summary is printed.
    #[arg(short, long = "output", value_name = "FILE")]
    pub(crate) outputs: Vec<PathBuf>,

    /// Where green of the scene's normal maps points: up or down. It is up in the .glb files and .png images that are written.
    #[arg(long, value_name = "WAY", default_value = "up", value_parser = parse::named_green())]
    #[arg(hide_possible_values = true, help_heading = "Normal maps")]
    pub(crate) normal_maps: NormalMaps,

    #[command(flatten)]
    pub(crate) atlas: AtlasArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Print the report as one JSON object, with all objects.
    #[arg(long, help_heading = "Run")]
    pub(crate) json: bool,

    /// Exit with code 1 if there are warnings.
    #[arg(long, help_heading = "Run")]
    pub(crate) strict: bool,
}
