//! Formats and sample counts of attachments.

/// Exposed linear light; coverage in the fourth channel.
pub(crate) const HDR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Near over distance: floats are densest around zero, at infinity.
pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Position and normal of what a pixel shows.
pub(crate) const PLACES: [wgpu::TextureFormat; 2] =
    [wgpu::TextureFormat::Rgba32Float, wgpu::TextureFormat::Rgba16Float];

/// Light of scattered points there, not exposed.
pub(crate) const POINT_LIGHT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// sRGB codes, in a format that does not decode them.
pub(crate) const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Samples per pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Samples {
    /// One, at the centre: the fastest.
    One,
    /// Four: smooth edges.
    #[default]
    Four,
}

impl Samples {
    /// As a number.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
        }
    }
}
