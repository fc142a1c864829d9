//! What to draw.

use crate::{Backdrop, LightBuffer, LumelBuffer, Model, Overlay, PointBuffer};
use lumel_lightmap::Filter;
use lumel_render_cpu::{Relief, Rippled, Scale, ToneMapper};
use lumel_scene::{Camera, Radiance, RectLight};

/// Everything that a picture depends on.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// The surfaces.
    pub model: &'a Model,
    /// The camera. One without a view shows the background only.
    pub camera: &'a Camera,
    /// The light on the surfaces. Light of another model shows the background only.
    pub light: Lit<'a>,
    /// The rectangle lights that are on; textures are those of the model. Only [`Look::Radiance`] shows them.
    pub rect_lights: &'a [RectLight],
    /// What is shown and how.
    pub look: Look,
    /// Which normals are shown, and how light that is known by direction is found on them.
    pub relief: Relief,
    /// Waves over some of the surfaces.
    pub ripple: Option<Rippled<'a>>,
    /// Whether triangle edges are drawn over the picture, if [`Gpu::draws_wireframes`](crate::Gpu).
    pub wireframe: bool,
    /// Whether borders of lumels are drawn over the picture, if the model has an atlas.
    pub grid: bool,
    /// Dots and lines over the picture.
    pub overlay: Option<&'a Overlay>,
    /// The background of [`Look::Radiance`], W·m⁻²·sr⁻¹; otherwise it is black.
    pub sky: Radiance,
    /// What is drawn over that background, where the sky is not the same everywhere.
    pub backdrop: Option<&'a Backdrop>,
}

/// The light on the surfaces.
#[derive(Clone, Copy)]
pub enum Lit<'a> {
    /// The same everywhere in the picture.
    One(Values<'a>),
    /// Two, compared at a divider.
    Split {
        /// Left of the divider.
        left: Values<'a>,
        /// Right of it.
        right: Values<'a>,
        /// Position of the divider, 0..=1 of the width; rounded to whole pixels.
        at: f32,
    },
    /// The same left and right of a divider, right of it on surfaces as smooth as their meshes.
    Smooth {
        /// On both sides.
        light: Values<'a>,
        /// Position of the divider, as that of [`Lit::Split`].
        at: f32,
    },
}

/// Where the values of a model's surfaces are.
#[derive(Clone, Copy)]
pub enum Values<'a> {
    /// At its vertices.
    Vertices(&'a LightBuffer),
    /// On the lumels of the atlas that it was uploaded with. A model without one shows the vertices.
    Lumels {
        /// The lumels.
        lumels: &'a LumelBuffer,
        /// How they are read.
        filter: Filter,
        /// What shows where they are not known.
        vertices: &'a LightBuffer,
    },
    /// At scattered points: each pixel gathers those around its place.
    ///
    /// Normal maps and what shows no light do without the points.
    Points {
        /// The points.
        points: &'a PointBuffer,
        /// The finest level that is read; `u32::MAX` for all.
        finest: u32,
        /// What is added to it.
        vertices: &'a LightBuffer,
    },
}

impl<'a> From<&'a LightBuffer> for Values<'a> {
    fn from(vertices: &'a LightBuffer) -> Self {
        Self::Vertices(vertices)
    }
}

/// What is shown, by the formulas of [`lumel_render_cpu`]; the names are those of [`Show`](lumel_render_cpu::Show).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// Radiance at the camera: emission, reflected light, rectangle lights and sky.
    Radiance {
        /// Light is multiplied by `2^stops`; -100..=100.
        stops: f32,
        /// How bright light is compressed.
        tone: ToneMapper,
        /// The luminance that [`ToneMapper::Reinhard`] maps to white.
        white: f32,
    },
    /// Irradiance, shown as on white surfaces.
    Irradiance {
        /// Light is multiplied by `2^stops`; -100..=100.
        stops: f32,
        /// How bright light is compressed.
        tone: ToneMapper,
        /// The luminance that [`ToneMapper::Reinhard`] maps to white.
        white: f32,
    },
    /// The fraction of light that surfaces reflect.
    Albedo,
    /// Shading normals, with normal maps.
    Normals,
    /// Luminance of the irradiance, in the colours of [`lumel_render_cpu::false_color_map`].
    FalseColor {
        /// Smallest and largest luminance, W·m⁻². An empty range shows the first colour everywhere.
        range: [f32; 2],
        /// How the range is divided.
        scale: Scale,
    },
    /// The values as vectors, at most as long as 1, in the colours of [`Look::Normals`].
    Vectors,
    /// The values as linear colours, shaded by a headlight to reveal shapes.
    ///
    /// With shading normal `n` and unit vector `v` to the camera, a colour is multiplied by `0.35 + 0.65 |n·v|`. There
    /// is no exposure: this is for diagnostics whose values are colours.
    Plain,
}
