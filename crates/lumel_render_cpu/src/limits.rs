//! How large a picture may be.

/// The largest number of pixels of a picture: 8K UHD (7680 × 4320) fits.
pub const MAX_PIXELS: u64 = 1 << 25;

/// The largest number of samples per pixel.
pub const MAX_SAMPLES: u32 = 1 << 16;
