//! Options for the atlas of a lightmap.

use crate::parse;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use lumel::{LightmapEntry, UvChoice};
use lumel_uv::MAX_PAGE;

/// How a scene is unwrapped.
#[derive(Debug, Args)]
pub(crate) struct AtlasArgs {
    /// Lumels per metre; replaces --lumels.
    #[arg(long, value_name = "N", value_parser = parse::above_zero, allow_negative_numbers = true)]
    #[arg(help_heading = "Atlas", conflicts_with = "lumels")]
    pub(crate) density: Option<f32>,

    /// As fine as this many lumels on all pages together allow. [default: 1048576; for bakes 65536 with --preset draft, 262144
    /// with medium]
    #[arg(long, value_name = "N", value_parser = parse::count(1..=1 << 30), allow_negative_numbers = true)]
    #[arg(help_heading = "Atlas")]
    pub(crate) lumels: Option<u32>,

    /// What multiplies the density of the objects NAME. May be repeated.
    ///
    /// Project files say it by [[object]], glTF files by a number "lumel_density_factor" in the extras of a node.
    #[arg(long, value_name = "NAME=X", value_parser = parse::named_factor, help_heading = "Atlas")]
    pub(crate) density_factor: Vec<(String, f32)>,

    /// The largest width and height of a page, lumels, a multiple of 4; what does not fit is on further pages. [default: 2048]
    #[arg(long, value_name = "N", value_parser = parse::count(64..=MAX_PAGE))]
    #[arg(help_heading = "Atlas", allow_negative_numbers = true)]
    pub(crate) atlas_size: Option<u32>,

    /// Lumels whose centres are nearer to a chart than half of this are its own: 2 for bilinear, 3 for bicubic reading. [default:
    /// 2]
    ///
    /// Charts are at least one lumel less than this apart. Ask for one more where another program wants free lumels between
    /// them.
    #[arg(long, value_name = "N", value_parser = parse::count(0..=16))]
    #[arg(help_heading = "Atlas", allow_negative_numbers = true)]
    pub(crate) gutter: Option<u32>,

    /// Charts share no block of N by N lumels: 1, or 4 for formats that compress blocks. [default: 1]
    #[arg(long, value_name = "N", value_parser = align(), help_heading = "Atlas")]
    pub(crate) align: Option<u32>,

    /// What becomes of lightmap coordinates that the file has as TEXCOORD_1.
    ///
    /// They are kept if they lie in the square from 0 to 1 without overlaps, with the gutter between charts at the density that
    /// is asked for. An object is then put on a page as one piece, and so is each instance; if all objects together fill one
    /// square, it is the page. What is not kept is named. [default: keep]
    #[arg(long, value_enum, value_name = "CHOICE", help_heading = "Atlas")]
    pub(crate) uv: Option<Uv>,

    /// After this many seconds, objects that are left get simple charts, and are named. [default: 300]
    #[arg(long, value_name = "SECONDS", value_parser = parse::count(0..=1_000_000))]
    #[arg(help_heading = "Run", allow_negative_numbers = true)]
    pub(crate) time_limit: Option<u32>,
}

fn align() -> impl TypedValueParser<Value = u32> {
    PossibleValuesParser::new(["1", "4"]).try_map(|text| text.parse())
}

impl AtlasArgs {
    /// What they say.
    pub(crate) fn entry(&self) -> LightmapEntry {
        let Self { density, lumels, atlas_size, gutter, align, uv, time_limit, .. } = *self;
        let uv = uv.map(UvChoice::from);
        let usual = LightmapEntry::default();
        LightmapEntry { density, lumels, atlas_size, gutter, align, uv, time_limit, ..usual }
    }
}

/// What becomes of lightmap coordinates that a file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Uv {
    /// They are kept where they can be used.
    Keep,
    /// All objects get new ones.
    New,
}

impl From<Uv> for UvChoice {
    fn from(uv: Uv) -> Self {
        match uv {
            Uv::Keep => Self::Keep,
            Uv::New => Self::New,
        }
    }
}
