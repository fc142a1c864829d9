//! From linear values to the bytes of a picture.

use crate::srgb::unit_byte;
use crate::{Exposure, FalseColor, PictureError, Show, ToneMapper, srgb_byte};
use glam::Vec3;

/// How linear values become a picture. The formulas are at [`Show`], [`ToneMapper`] and [`FalseColor`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Display {
    /// What is shown.
    pub show: Show,
    /// How bright, for radiance and irradiance.
    pub exposure: Exposure,
    /// How bright light is compressed, for radiance and irradiance.
    pub tone: ToneMapper,
    /// The luminance after exposure that [`ToneMapper::Reinhard`] maps to white.
    pub white: f32,
    /// Range, scale and legend of false colours.
    pub false_color: FalseColor,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            show: Show::default(),
            exposure: Exposure::default(),
            tone: ToneMapper::default(),
            white: ToneMapper::DEFAULT_WHITE,
            false_color: FalseColor::default(),
        }
    }
}

impl Display {
    /// The default display of a quantity.
    pub fn of(show: Show) -> Self {
        Self { show, ..Self::default() }
    }

    /// The pixel of linear light, `srgb(tone(2^stops · c))`: for radiance, and for irradiance over π.
    pub fn light_pixel(&self, stops: f32, light: Vec3) -> [u8; 3] {
        self.tone.map(light * stops.exp2(), self.white).to_array().map(srgb_byte)
    }

    pub(crate) fn check(&self) -> Result<(), PictureError> {
        let refuse = |what, expected, value: String| Err(PictureError::Setting { what, expected, value });
        if let Exposure::Stops(stops) = self.exposure
            && !(-Exposure::MAX_STOPS..=Exposure::MAX_STOPS).contains(&stops)
        {
            return refuse("the exposure", "between -100 and 100 stops", stops.to_string());
        }
        if !(self.white.is_finite() && self.white > 0.0) {
            return refuse("the white point", "a number above zero", self.white.to_string());
        }
        self.false_color.check()
    }
}

/// The pixel of an albedo: sRGB without exposure.
pub(crate) fn albedo_pixel(albedo: Vec3) -> [u8; 3] {
    albedo.to_array().map(srgb_byte)
}

/// The pixel of a normal already mapped to 0..=1: no transfer curve, so that it can be decoded.
pub(crate) fn normal_pixel(encoded: Vec3) -> [u8; 3] {
    encoded.to_array().map(unit_byte)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_stop_doubles_light_before_the_tone_mapper() {
        let display = Display { tone: ToneMapper::None, ..Display::default() };
        assert_eq!(display.light_pixel(1.0, Vec3::splat(0.25)), [188; 3]);
        assert_eq!(display.light_pixel(-1.0, Vec3::splat(0.36)), [118; 3]);
    }

    #[test]
    fn settings_that_are_no_numbers_are_refused() {
        let ok = Display::default();
        assert_eq!(ok.check(), Ok(()));
        for bad in [
            Display { exposure: Exposure::Stops(f32::NAN), ..ok },
            Display { exposure: Exposure::Stops(1000.0), ..ok },
            Display { white: 0.0, ..ok },
            Display { white: f32::INFINITY, ..ok },
        ] {
            assert!(matches!(bad.check(), Err(PictureError::Setting { .. })), "{bad:?}");
        }
    }
}
