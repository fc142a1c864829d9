//! What to draw.

use crate::{LightBuffer, Model, Overlay};
use lumel_render_cpu::{Scale, ToneMapper};
use lumel_scene::{Camera, Radiance, RectLight};

/// All that a picture depends on.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// The surfaces.
    pub model: &'a Model,
    /// Where from. A camera without a view shows the background only.
    pub camera: &'a Camera,
    /// The light on the surfaces. Light of another model shows the background only.
    pub light: Lit<'a>,
    /// The lamps that glow now; textures are those of the model. Only [`Look::Radiance`] shows them.
    pub lamps: &'a [RectLight],
    /// What is shown, and how.
    pub look: Look,
    /// Whether the edges of triangles are drawn over the picture, if [`Gpu::draws_wireframes`](crate::Gpu).
    pub wireframe: bool,
    /// Dots and lines over the picture.
    pub overlay: Option<&'a Overlay>,
    /// The background of [`Look::Radiance`], W·m⁻²·sr⁻¹; that of all others is black.
    pub sky: Radiance,
}

/// The light on the surfaces.
#[derive(Clone, Copy)]
pub enum Lit<'a> {
    /// The same everywhere in the picture.
    One(&'a LightBuffer),
    /// One left of a divider and another right of it, for comparing them.
    Split {
        /// Left of the divider.
        left: &'a LightBuffer,
        /// Right of it.
        right: &'a LightBuffer,
        /// Where the divider is, 0..=1 of the width; rounded to whole pixels.
        at: f32,
    },
}

/// What is shown, by the formulas of [`lumel_render_cpu`]; the names are those of [`Show`](lumel_render_cpu::Show).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// What the eye would see: emission, reflected light, lamps and sky.
    Radiance {
        /// Light is multiplied by `2^stops`; -100..=100.
        stops: f32,
        /// What becomes of bright light.
        tone: ToneMapper,
        /// The luminance that [`ToneMapper::Reinhard`] makes white.
        white: f32,
    },
    /// The light that arrives, on white surfaces.
    Irradiance {
        /// Light is multiplied by `2^stops`; -100..=100.
        stops: f32,
        /// What becomes of bright light.
        tone: ToneMapper,
        /// The luminance that [`ToneMapper::Reinhard`] makes white.
        white: f32,
    },
    /// The share that surfaces reflect.
    Albedo,
    /// Where surfaces look, with their normal maps.
    Normals,
    /// Luminance of the light that arrives, in the colours of [`lumel_render_cpu::false_color_map`].
    FalseColor {
        /// Smallest and largest luminance, W·m⁻². A range that is none shows the first colour everywhere.
        range: [f32; 2],
        /// How the range is divided.
        scale: Scale,
    },
    /// The values of the light buffer as linear colours, shaded by a lamp at the eye so that shapes can be read.
    ///
    /// With shading normal `n` and unit vector `v` to the eye a colour is multiplied by `0.35 + 0.65 |n·v|`. There is
    /// no exposure: for diagnostics, whose values are colours already.
    Plain,
}
