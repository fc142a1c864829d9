//! From a [`Look`] to the inputs of the shaders.

use crate::Look;
use crate::layout::Tone;
use crate::pipelines::Curve;
use lumel_render_cpu::{Exposure, Scale, ToneMapper};

/// How linear values become sRGB codes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shown {
    /// Their factor before they are stored in 16 bits.
    pub(crate) exposure: f32,
    pub(crate) curve: Curve,
    pub(crate) tone: Tone,
}

impl Shown {
    pub(crate) fn of(look: &Look) -> Self {
        match *look {
            Look::Radiance { stops, tone, white } | Look::Irradiance { stops, tone, white } => {
                Self::exposed(stops, tone, white)
            }
            Look::Albedo | Look::Plain => Self::as_it_is(Curve::Srgb),
            Look::Normals | Look::Vectors => Self::as_it_is(Curve::None),
            Look::FalseColor { range, scale } => Self::false_color(range, scale),
        }
    }

    fn as_it_is(curve: Curve) -> Self {
        let tone = Tone { white: ToneMapper::DEFAULT_WHITE, low: 0.0, high: 1.0, logarithmic: 0.0 };
        Self { exposure: 1.0, curve, tone }
    }

    fn exposed(stops: f32, tone: ToneMapper, white: f32) -> Self {
        let curve = match tone {
            ToneMapper::None => Curve::Srgb,
            ToneMapper::Reinhard => Curve::Reinhard,
            ToneMapper::Aces => Curve::Aces,
            ToneMapper::Agx => Curve::Agx,
        };
        let stops = if stops.is_nan() { 0.0 } else { stops.clamp(-Exposure::MAX_STOPS, Exposure::MAX_STOPS) };
        let shown = Self { exposure: stops.exp2(), ..Self::as_it_is(curve) };
        if white.is_finite() && white > 0.0 {
            Self { tone: Tone { white, ..shown.tone }, ..shown }
        } else {
            shown
        }
    }

    /// The luminance is scaled to about 1 by a power of two, so that nothing is rounded.
    fn false_color([low, high]: [f32; 2], scale: Scale) -> Self {
        let is_range =
            low < high && low.is_finite() && high.is_finite() && (scale == Scale::Linear || low > 0.0);
        if !is_range {
            // Nothing is bright enough for the second colour.
            let shown = Self::as_it_is(Curve::FalseColor);
            return Self { tone: Tone { high: f32::MAX, ..shown.tone }, ..shown };
        }
        let exposure = (-low.abs().max(high.abs()).log2().ceil()).clamp(-100.0, 100.0).exp2();
        let tone = Tone {
            low: low * exposure,
            high: high * exposure,
            logarithmic: if scale == Scale::Log { 1.0 } else { 0.0 },
            ..Self::as_it_is(Curve::FalseColor).tone
        };
        Self { exposure, curve: Curve::FalseColor, tone }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_that_are_no_numbers_become_sensible_ones() {
        let exposed = |stops, white| Shown::exposed(stops, ToneMapper::Reinhard, white);
        assert_eq!(exposed(f32::NAN, -1.0), exposed(0.0, ToneMapper::DEFAULT_WHITE));
        assert!(exposed(f32::INFINITY, 1.0).exposure.is_finite());
        for range in [[1.0, 1.0], [2.0, 1.0], [f32::NAN, 1.0], [0.0, f32::INFINITY]] {
            assert_eq!(Shown::false_color(range, Scale::Linear).tone.high, f32::MAX, "{range:?}");
        }
        assert_eq!(Shown::false_color([0.0, 1.0], Scale::Log).tone.high, f32::MAX);
    }

    #[test]
    fn ranges_are_brought_to_the_size_of_one() {
        let shown = Shown::false_color([10.0, 1000.0], Scale::Log);
        assert_eq!(
            (shown.exposure, shown.tone.high, shown.tone.logarithmic),
            (1.0 / 1024.0, 1000.0 / 1024.0, 1.0)
        );
        let tiny = Shown::false_color([0.0, 1e-38], Scale::Linear);
        assert!(tiny.exposure.is_finite() && tiny.tone.high > 0.0);
    }
}
