//! What files know of reflections.

use crate::{Filter, UvTransform, Wrap};
use std::fmt;
use std::sync::Arc;

/// How a surface reflects beside diffusely, as glTF has it. No light is computed with it: files that are written keep it.
#[derive(Clone, Debug, PartialEq)]
pub struct Gloss {
    /// The share of metal, 0..=1; multiplies the blue of the texture when there is one.
    pub metallic: f32,
    /// 0 for a mirror, 1 for a dull surface; multiplies the green of the texture when there is one.
    pub roughness: f32,
    /// Both over the surface.
    pub texture: Option<GlossTexture>,
}

impl Default for Gloss {
    /// A dull surface.
    fn default() -> Self {
        Self { metallic: 0.0, roughness: 1.0, texture: None }
    }
}

/// An image that is kept as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct GlossTexture {
    /// The image; uses of one share it.
    pub image: Arc<EncodedImage>,
    /// How the mesh's coordinates map to it.
    pub transform: UvTransform,
    /// What is beside it.
    pub wrap: [Wrap; 2],
    /// How it is enlarged.
    pub filter: Filter,
}

/// The bytes of a file of an image.
#[derive(Clone, PartialEq, Eq)]
pub struct EncodedImage {
    /// Its name.
    pub name: String,
    /// `image/png` or `image/jpeg`.
    pub mime_type: &'static str,
    /// The file.
    pub bytes: Vec<u8>,
}

impl fmt::Debug for EncodedImage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}, {} bytes of {}", self.name, self.bytes.len(), self.mime_type)
    }
}
