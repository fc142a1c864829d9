//! The size of a picture and the number of its samples.

use crate::PictureError;
use crate::limits::{MAX_PIXELS, MAX_SAMPLES};

/// Size and number of samples per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Rays per pixel, averaged: Sobol points over the pixel's square, the centre if there is only one. Powers of
    /// two are distributed best.
    pub samples_per_pixel: u32,
}

impl Resolution {
    /// A size with 16 samples per pixel.
    pub const fn new(width: u32, height: u32) -> Self {
        Self { width, height, samples_per_pixel: 16 }
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        (f64::from(self.width) / f64::from(self.height)) as f32
    }

    pub(crate) fn check(&self) -> Result<(), PictureError> {
        check_size(u64::from(self.width), u64::from(self.height))?;
        if self.samples_per_pixel == 0 || self.samples_per_pixel > MAX_SAMPLES {
            return Err(PictureError::Samples(self.samples_per_pixel));
        }
        Ok(())
    }
}

impl Default for Resolution {
    fn default() -> Self {
        Self::new(1280, 720)
    }
}

pub(crate) fn check_size(width: u64, height: u64) -> Result<(), PictureError> {
    match width.checked_mul(height) {
        Some(1..=MAX_PIXELS) => Ok(()),
        _ => Err(PictureError::Size { width, height }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_sizes_and_counts_are_refused() {
        let with = |width, height, samples_per_pixel| Resolution { width, height, samples_per_pixel }.check();
        assert_eq!(with(7680, 4320, 16), Ok(()));
        assert_eq!(with(1, 1, 1), Ok(()));
        for (width, height) in [(0, 5), (5, 0), (u32::MAX, u32::MAX), (1 << 16, 1 << 16), (1 << 25, 2)] {
            assert!(matches!(with(width, height, 1), Err(PictureError::Size { .. })), "{width} {height}");
        }
        assert_eq!(with(4, 4, 0), Err(PictureError::Samples(0)));
        assert_eq!(with(4, 4, u32::MAX), Err(PictureError::Samples(u32::MAX)));
    }
}
