//! False colours.

use crate::names::named;
use crate::stats::percentile;
use crate::{PictureError, srgb_byte, srgb_from_byte};
use glam::{DVec3, Vec3};
use std::sync::LazyLock;

/// How irradiance becomes colours.
///
/// The luminance `y` of the mean irradiance over the part of a pixel that shows surfaces, W·m⁻², is placed in the
/// range `lo..hi` at `t = (y − lo)/(hi − lo)`, or `t = ln(y/lo)/ln(hi/lo)` on the logarithmic scale. The colour is
/// entry `floor(255 clamp(t, 0, 1) + 0.5)` of [`false_color_map`]. Where surfaces cover only part of a pixel, the
/// colour is multiplied by the coverage in linear light: the background is black.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FalseColor {
    /// Smallest and largest luminance, W·m⁻². By default, the 1st to the 99th percentile of the pixels that show
    /// surfaces, at most four decades on the logarithmic scale.
    pub range: Option<[f32; 2]>,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Whether a legend is drawn into the picture.
    pub legend: Legend,
}

/// How the range of false colours is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Scale {
    /// Equal differences, equal steps.
    #[default]
    Linear,
    /// Equal ratios, equal steps.
    Log,
}

named!(Scale, "scale", Linear = "linear", Log = "log");

/// Whether the picture has a legend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Legend {
    /// A colour bar with values at the right edge, if the picture is large enough.
    #[default]
    Drawn,
    /// None: every pixel shows the scene.
    Hidden,
}

named!(Legend, "legend", Drawn = "drawn", Hidden = "hidden");

/// The widest automatic logarithmic range.
const MAX_LOG_SPAN: f32 = 1e4;

/// Automatic ranges narrower than this fraction of their end are widened: the light is uniform up to rounding.
const NARROWEST: f32 = 1e-3;

impl FalseColor {
    pub(crate) fn check(&self) -> Result<(), PictureError> {
        let Some([lo, hi]) = self.range else { return Ok(()) };
        let expected = match self.scale {
            Scale::Linear if lo < hi && lo.is_finite() && hi.is_finite() => return Ok(()),
            Scale::Log if 0.0 < lo && lo < hi && hi.is_finite() => return Ok(()),
            Scale::Linear => "two numbers, the larger one last",
            Scale::Log => "two numbers above zero, the larger one last",
        };
        let value = format!("{lo} to {hi}");
        Err(PictureError::Setting { what: "the range of false colours", expected, value })
    }

    /// The range for these luminances: the one that was set, otherwise one that covers most of them.
    pub fn range_for(&self, mut luminances: Vec<f32>) -> [f32; 2] {
        if let Some(range) = self.range {
            return range;
        }
        luminances.retain(|y| y.is_finite());
        let lo = percentile(&mut luminances, 1.0).unwrap_or(0.0).max(0.0);
        let hi = percentile(&mut luminances, 99.0).unwrap_or(0.0).max(0.0);
        let (lo, hi) = match hi {
            0.0 => (0.0, 1.0),
            // Keeps both ends and their difference finite.
            _ if hi > f32::MAX / 4.0 => (lo.min(f32::MAX / 8.0), f32::MAX / 4.0),
            _ if hi - lo <= NARROWEST * hi => (0.5 * hi, 1.5 * hi),
            _ => (lo, hi),
        };
        match self.scale {
            Scale::Linear => [lo, hi],
            Scale::Log => [lo.max(hi / MAX_LOG_SPAN), hi],
        }
    }

    /// The same for values of both signs: zero is in the middle.
    pub fn signed_range_for(&self, mut values: Vec<f32>) -> [f32; 2] {
        values.iter_mut().for_each(|value| *value = value.abs());
        let [_, most] = Self { scale: Scale::Linear, ..*self }.range_for(values);
        self.range.unwrap_or([-most, most])
    }
}

impl Scale {
    /// Where a value lies in a range: 0 at its start, 1 at its end.
    pub fn position(self, value: f32, [lo, hi]: [f32; 2]) -> f32 {
        match self {
            Self::Linear => (value - lo) / (hi - lo),
            Self::Log => (value.max(0.0) / lo).ln() / (hi / lo).ln(),
        }
    }
}

/// The colour of a position in the range, 0..=1; positions outside get the colours of the ends.
pub fn false_color(t: f32) -> [u8; 3] {
    // A cast of what is not a number is 0.
    false_color_map()[(255.0 * t.clamp(0.0, 1.0) + 0.5) as usize]
}

/// A pixel covered to the fraction `coverage` by surfaces with the colour of `t`; the rest is black.
pub(crate) fn covered(t: f32, coverage: f32) -> [u8; 3] {
    let color = false_color(t);
    if coverage >= 1.0 { color } else { color.map(|byte| srgb_byte(srgb_from_byte(byte) * coverage)) }
}

/// The 256 colours of the map, sRGB: from dark violet over blue and green to bright yellow.
///
/// A curve through Oklab with increasing lightness: with `s` in 0..=1, `L = 0.25 + 0.68 s`, chroma
/// `0.12 − 0.15 s + 0.2 s²` and hue `300° − 195° s`. The colours are equidistant along the curve, so that equal steps
/// in value look equal.
///
/// Ottosson, *A perceptual color space for image processing*, 2020.
pub fn false_color_map() -> &'static [[u8; 3]; 256] {
    static MAP: LazyLock<[[u8; 3]; 256]> = LazyLock::new(make_map);
    &MAP
}

fn curve(s: f64) -> DVec3 {
    let chroma = 0.12 - 0.15 * s + 0.2 * s * s;
    let (sin, cos) = (300.0 - 195.0 * s).to_radians().sin_cos();
    DVec3::new(0.25 + 0.68 * s, chroma * cos, chroma * sin)
}

fn make_map() -> [[u8; 3]; 256] {
    const STEPS: usize = 1 << 14;
    let at = |i: usize| curve(i as f64 / STEPS as f64);
    let mut lengths = vec![0.0; STEPS + 1];
    for i in 0..STEPS {
        lengths[i + 1] = lengths[i] + at(i).distance(at(i + 1));
    }
    std::array::from_fn(|k| {
        let wanted = lengths[STEPS] * k as f64 / 255.0;
        let i = lengths.partition_point(|length| *length < wanted).min(STEPS);
        linear_from_oklab(at(i)).to_array().map(srgb_byte)
    })
}

fn linear_from_oklab(lab: DVec3) -> Vec3 {
    let l = lab.x + 0.396_337_777_4 * lab.y + 0.215_803_757_3 * lab.z;
    let m = lab.x - 0.105_561_345_8 * lab.y - 0.063_854_172_8 * lab.z;
    let s = lab.x - 0.089_484_177_5 * lab.y - 1.291_485_548_0 * lab.z;
    let lms = DVec3::new(l * l * l, m * m * m, s * s * s);
    let rgb = DVec3::new(
        lms.dot(DVec3::new(4.076_741_662_1, -3.307_711_591_3, 0.230_969_929_2)),
        lms.dot(DVec3::new(-1.268_438_004_6, 2.609_757_401_1, -0.341_319_396_5)),
        lms.dot(DVec3::new(-0.004_196_086_3, -0.703_418_614_7, 1.707_614_701_0)),
    );
    rgb.as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::luminance;

    #[test]
    fn every_colour_can_be_shown_and_is_brighter_than_the_last() {
        for i in 0..=1000 {
            let rgb = linear_from_oklab(curve(f64::from(i) / 1000.0));
            assert!(rgb.min_element() > -1e-3 && rgb.max_element() < 1.0, "{i}: {rgb}");
        }
        let y = |color: &[u8; 3]| luminance(Vec3::from_array(color.map(srgb_from_byte)));
        // Bytes are too coarse to tell neighbours.
        assert!(false_color_map().windows(4).all(|w| y(&w[0]) < y(&w[3])));
    }

    #[test]
    fn oklab_white_and_grey_are_neutral() {
        let white = linear_from_oklab(DVec3::new(1.0, 0.0, 0.0));
        assert!((white - Vec3::ONE).abs().max_element() < 1e-6, "{white}");
        let grey = linear_from_oklab(DVec3::new(0.5, 0.0, 0.0));
        assert!((grey - Vec3::splat(0.125)).abs().max_element() < 1e-6, "{grey}");
    }

    #[test]
    fn the_ends_of_the_range_have_the_ends_of_the_map() {
        let map = false_color_map();
        assert_eq!(
            [-3.0, 0.0, 1.0, 2.0, f32::NAN].map(false_color),
            [map[0], map[0], map[255], map[255], map[0]]
        );
        assert_eq!(covered(0.5, 1.0), map[128]);
        assert_eq!(covered(0.5, 0.0), [0; 3]);
    }

    #[test]
    fn positions_are_linear_or_logarithmic() {
        assert_eq!(Scale::Linear.position(3.0, [1.0, 5.0]), 0.5);
        assert!((Scale::Log.position(10.0, [1.0, 1000.0]) - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(false_color(Scale::Log.position(0.0, [1.0, 10.0])), false_color_map()[0]);
    }

    #[test]
    fn automatic_ranges_are_percentiles_and_never_empty() {
        let range = |scale, values| FalseColor { scale, ..FalseColor::default() }.range_for(values);
        let ramp: Vec<f32> = (0..1000).map(|i| i as f32).collect();
        assert_eq!(range(Scale::Linear, ramp.clone()), [9.0, 989.0]);
        assert_eq!(range(Scale::Log, ramp), [9.0, 989.0]);
        assert_eq!(range(Scale::Log, vec![0.0, 1.0]), [1e-4, 1.0]);
        assert_eq!(range(Scale::Linear, vec![2.0; 9]), [1.0, 3.0]);
        for scale in [Scale::Linear, Scale::Log] {
            for values in [vec![], vec![0.0; 5], vec![f32::NAN, -1.0], vec![f32::MAX; 5]] {
                let false_color = FalseColor { scale, ..FalseColor::default() };
                let range = Some(false_color.range_for(values));
                assert_eq!(FalseColor { range, ..false_color }.check(), Ok(()));
            }
        }
    }

    #[test]
    fn values_of_both_signs_have_zero_in_the_middle() {
        let settings = FalseColor::default();
        let ramp: Vec<f32> = (0..1000).map(|i| -(i as f32)).collect();
        assert_eq!(settings.signed_range_for(ramp), [-989.0, 989.0]);
        assert_eq!(settings.signed_range_for(vec![]), [-1.0, 1.0]);
        let range = Some([-2.0, 3.0]);
        assert_eq!(FalseColor { range, ..settings }.signed_range_for(vec![7.0]), [-2.0, 3.0]);
    }

    #[test]
    fn ranges_that_are_none_are_refused() {
        let check = |scale, range| FalseColor { scale, range: Some(range), ..FalseColor::default() }.check();
        assert_eq!(check(Scale::Linear, [-1.0, 1.0]), Ok(()));
        assert!(check(Scale::Log, [0.0, 1.0]).is_err());
        for range in [[1.0, 1.0], [2.0, 1.0], [f32::NAN, 1.0], [0.5, f32::INFINITY]] {
            assert!(check(Scale::Linear, range).is_err() && check(Scale::Log, range).is_err(), "{range:?}");
        }
    }
}
