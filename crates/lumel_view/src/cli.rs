//! The command line of `lumel-view`.

use crate::document::OpenRequest;
use clap::Parser;
use lumel::{MaxEdge, OpenOptions, PathPolicy};
use lumel_export::SolutionMeta;
use std::path::PathBuf;

/// Watch light arrive in a scene.
///
/// Opens a window to fly through a mesh, place lights and solve for the light in the background. F1 shows all keys.
/// With --screenshot a picture is drawn without a window. Exit codes: 0 done; 2 failed.
#[derive(Debug, Parser)]
#[command(name = "lumel-view", version, max_term_width = 100, after_help = EXAMPLES)]
pub struct Cli {
    /// A mesh (.obj, .gltf, .glb, .ply), a project (.toml) or a built-in scene, such as cornell-box.
    pub scene: Option<String>,

    /// Split edges longer than this: a length in metres or with a unit, such as 10cm, auto (the default for files) or off.
    #[arg(long, value_name = "L|auto|off")]
    pub max_edge: Option<MaxEdge>,

    /// Refine a built-in scene this many times.
    #[arg(long, value_name = "LEVELS")]
    pub subdivide: Option<u32>,

    /// Light both sides of the faces of the material or object NAME; "all" for all. May be repeated.
    #[arg(long, value_name = "NAME")]
    pub two_sided: Vec<String>,

    /// Let scene files refer to files outside their folder.
    #[arg(long)]
    pub allow_outside_paths: bool,

    /// Threads that solve; all by default.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub threads: usize,

    /// Draw a picture into this PNG file instead of opening a window.
    #[arg(long, value_name = "FILE", requires = "scene")]
    pub screenshot: Option<PathBuf>,

    /// What the picture shows.
    #[command(flatten)]
    pub picture: ScreenshotArgs,
}

/// What a picture without a window shows.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "With --screenshot")]
pub struct ScreenshotArgs {
    /// The light: a solution of `lumel bake` or of this program.
    #[arg(long, value_name = "FILE", requires = "screenshot")]
    pub solution: Option<PathBuf>,

    /// One bounce of it; 0 is direct light.
    #[arg(long, value_name = "N", requires = "solution")]
    pub bounce: Option<u32>,

    /// A camera of the scene, by its name.
    #[arg(long, value_name = "NAME", requires = "screenshot")]
    pub camera: Option<String>,

    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size, requires = "screenshot")]
    pub size: [u32; 2],

    /// Exposure in stops; read off the picture by default.
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, requires = "screenshot", value_parser = stops)]
    pub exposure: Option<f32>,
}

const EXAMPLES: &str = "\
Examples:
  lumel-view cornell-box
  lumel-view room.glb --max-edge 0.1
  lumel-view cornell-box --screenshot cornell.png --solution cornell.npz --size 800x600";

impl Cli {
    /// The scene to open first.
    pub fn request(&self) -> Option<OpenRequest> {
        let paths = if self.allow_outside_paths { PathPolicy::Anywhere } else { PathPolicy::default() };
        let solution = self.picture.solution.as_deref();
        let options = OpenOptions {
            paths,
            max_edge: self.max_edge,
            vertex_budget: solution.and_then(|file| SolutionMeta::load(file).ok()?.vertex_budget),
            adaptive: None,
            subdivide: self.subdivide,
            two_sided: self.two_sided.clone(),
            keeps_whole: false,
        };
        self.scene.clone().map(|name| OpenRequest { name, options })
    }
}

fn stops(text: &str) -> Result<f32, String> {
    let value: f32 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value.abs() <= 100.0 { Ok(value) } else { Err("must lie between -100 and 100".to_owned()) }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let parse = |part: &str| part.parse().ok().filter(|n| (1..=16_384).contains(n));
    text.split_once('x')
        .and_then(|(width, height)| Some([parse(width)?, parse(height)?]))
        .ok_or_else(|| "must be width x height in pixels, such as 1280x720, each from 1 to 16384".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn sizes_are_checked() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for bad in ["640", "0x10", "10x", "99999x1", "-1x5"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn pictures_need_a_scene_and_their_options_a_picture() {
        assert!(Cli::try_parse_from(["lumel-view", "--screenshot", "a.png"]).is_err());
        assert!(Cli::try_parse_from(["lumel-view", "cornell-box", "--bounce", "1"]).is_err());
        assert!(
            Cli::try_parse_from(["lumel-view", "cornell-box", "--screenshot", "a.png", "--exposure", "-2"])
                .is_ok()
        );
        assert!(Cli::try_parse_from(["lumel-view"]).is_ok());
    }
}
