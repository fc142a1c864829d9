//! Tone mapping: from unbounded scene light to 0..=1.

use crate::names::named;
use glam::{Mat3, Vec3};
use lumel_scene::luminance;

/// How light brighter than the display is compressed into its range.
///
/// Input is linear Rec. 709 after exposure, output linear Rec. 709 in 0..=1, to be encoded as sRGB. All but
/// [`Reinhard`](Self::Reinhard) preserve middle grey: 0.18 stays 0.18.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToneMapper {
    /// `clamp(c, 0, 1)` per channel: linear until it clips.
    None,
    /// On luminance `Y`, with white point `w`: `c · (1 + Y/w²) / (1 + Y)`, then clamped. Preserves hue and saturation.
    ///
    /// Reinhard, Stark, Shirley, Ferwerda, *Photographic Tone Reproduction for Digital Images*, 2002, equation 4.
    Reinhard,
    /// `O · f(I · 1.46193 c)` with `f(x) = (x² + 0.0245786 x − 0.000090537) / (0.983729 x² + 0.432951 x + 0.238081)`
    /// per channel, then clamped: filmic contrast; bright colours desaturate to white.
    ///
    /// `f` and the matrices `I`, `O` are Stephen Hill's fit to the ACES reference and output transforms for Rec. 709
    /// (2016, in Matt Pettineo's *BakingLab*); the factor restores middle grey to 0.18. An approximation, not ACES.
    Aces,
    /// A sigmoid of the logarithm of desaturated channels: softer than ACES; hues are preserved longer.
    ///
    /// With `k = (0.0425, 0.0785, 0.0785)` and `s = 1 − Σk`:
    /// 1. inset: `c₁ = s c + (k·c) (1,1,1)`;
    /// 2. `x = clamp((log2(c₁) + 12.47393) / 16.5, 0, 1)` per channel;
    /// 3. with the pivot at middle grey, `x₀ = (log2(0.18) + 12.47393) / 16.5` and `y₀ = 0.18^(1/2.4)`, and
    ///    `d = x − x₀`: `y = y₀ + 2.4 d / (1 + |2.4 d / a|^1.5)^(1/1.5)`, where `a` (one for `d < 0`, one for
    ///    `d > 0`) makes `y(0) = 0` and `y(1) = 1`;
    /// 4. outset, the inverse of the inset: `c₂ = (y − k·y) / s`;
    /// 5. `clamp(c₂, 0, 1)^2.4`.
    ///
    /// Our formulation of the curve and range of Troy Sobotka's *AgX* (2022); `k` is its inset for Rec. 709 primaries
    /// rounded to three places. An approximation, not AgX.
    #[default]
    Agx,
}

named!(ToneMapper, "tone mapper", None = "none", Reinhard = "reinhard", Aces = "aces", Agx = "agx");

impl ToneMapper {
    /// The default white point of [`Reinhard`](Self::Reinhard).
    pub const DEFAULT_WHITE: f32 = 4.0;

    /// Maps exposed linear light to 0..=1; `white` is the luminance that [`Reinhard`](Self::Reinhard) maps to 1.
    ///
    /// NaN becomes zero.
    pub fn map(self, exposed: Vec3, white: f32) -> Vec3 {
        let exposed = finite(exposed);
        clamp_unit(match self {
            Self::None => exposed,
            Self::Reinhard => {
                let y = luminance(exposed).max(0.0);
                exposed * ((1.0 + y / (white * white)) / (1.0 + y))
            }
            Self::Aces => ACES_OUTPUT * (ACES_INPUT * (exposed * ACES_SCALE)).map(aces_curve),
            Self::Agx => agx(exposed),
        })
    }
}

/// Zero for NaN; numbers whose squares would overflow are clamped.
fn finite(c: Vec3) -> Vec3 {
    c.map(|x| if x.is_nan() { 0.0 } else { x.clamp(0.0, 1e15) })
}

fn clamp_unit(c: Vec3) -> Vec3 {
    c.clamp(Vec3::ZERO, Vec3::ONE)
}

/// The published fit maps 0.263147 to 0.18.
const ACES_SCALE: f32 = 1.461_93;

const ACES_INPUT: Mat3 = Mat3::from_cols(
    Vec3::new(0.597_19, 0.076_00, 0.028_40),
    Vec3::new(0.354_58, 0.908_34, 0.133_83),
    Vec3::new(0.048_23, 0.015_66, 0.837_77),
);

const ACES_OUTPUT: Mat3 = Mat3::from_cols(
    Vec3::new(1.604_75, -0.102_08, -0.003_27),
    Vec3::new(-0.531_08, 1.108_13, -0.072_76),
    Vec3::new(-0.073_67, -0.006_05, 1.076_02),
);

fn aces_curve(x: f32) -> f32 {
    (x * (x + 0.024_578_6) - 0.000_090_537) / (x * (0.983_729 * x + 0.432_951) + 0.238_081)
}

const AGX_INSET: Vec3 = Vec3::new(0.042_5, 0.078_5, 0.078_5);
const AGX_KEPT: f32 = 1.0 - (0.042_5 + 0.078_5 + 0.078_5);
const AGX_DARKEST: f32 = -12.473_93;
const AGX_STOPS: f32 = 16.5;
const AGX_SLOPE: f32 = 2.4;
const AGX_POWER: f32 = 1.5;
const AGX_GAMMA: f32 = 2.4;
const MIDDLE_GREY: f32 = 0.18;

fn agx(c: Vec3) -> Vec3 {
    let inset = AGX_KEPT * c + Vec3::splat(AGX_INSET.dot(c));
    let y = inset.map(|x| agx_curve(((x.log2() - AGX_DARKEST) / AGX_STOPS).clamp(0.0, 1.0)));
    let outset = (y - Vec3::splat(AGX_INSET.dot(y))) / AGX_KEPT;
    clamp_unit(outset).map(|x| x.powf(AGX_GAMMA))
}

fn agx_curve(x: f32) -> f32 {
    let x0 = (MIDDLE_GREY.log2() - AGX_DARKEST) / AGX_STOPS;
    let y0 = MIDDLE_GREY.powf(1.0 / AGX_GAMMA);
    let (to_end, height) = if x < x0 { (x0, y0) } else { (1.0 - x0, 1.0 - y0) };
    let rise = AGX_SLOPE * (x - x0);
    // The sigmoid reaches `height` at the end of its side when 1 + (r/a)^p = (r/height)^p, with r the rise there.
    let end = AGX_SLOPE * to_end;
    let excess = (end / height).powf(AGX_POWER) - 1.0;
    y0 + rise / (1.0 + excess * (rise.abs() / end).powf(AGX_POWER)).powf(1.0 / AGX_POWER)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(mapper: ToneMapper, x: f32) -> f32 {
        let c = mapper.map(Vec3::splat(x), 4.0);
        // The rows of the published matrices sum to 1 within 1e-5.
        assert!(c.max_element() - c.min_element() < 1e-4, "{mapper} {x}: {c}");
        c.y
    }

    #[test]
    fn black_stays_black_and_the_brightest_is_white() {
        for &mapper in ToneMapper::ALL {
            assert_eq!(mapper.map(Vec3::ZERO, 4.0), Vec3::ZERO, "{mapper}");
            assert!(grey(mapper, 1e6) > 0.999, "{mapper}");
        }
    }

    #[test]
    fn greys_grow_and_stay_in_range() {
        for &mapper in ToneMapper::ALL {
            let mut last = -1.0;
            for i in 0..400 {
                let y = grey(mapper, 2f32.powf(i as f32 * 0.05 - 12.0));
                assert!((0.0..=1.0).contains(&y) && y >= last, "{mapper} {i}");
                last = y;
            }
        }
    }

    #[test]
    fn middle_grey_stays_middle_grey() {
        for mapper in [ToneMapper::None, ToneMapper::Aces, ToneMapper::Agx] {
            assert!((grey(mapper, 0.18) - 0.18).abs() < 2e-5, "{mapper}: {}", grey(mapper, 0.18));
        }
    }

    #[test]
    fn reinhard_turns_its_white_point_into_white_and_keeps_hue() {
        assert!((ToneMapper::Reinhard.map(Vec3::splat(4.0), 4.0).x - 1.0).abs() < 1e-6);
        assert!((grey(ToneMapper::Reinhard, 1.0) - (1.0 + 1.0 / 16.0) / 2.0).abs() < 1e-6);
        let c = ToneMapper::Reinhard.map(Vec3::new(0.4, 0.2, 0.1), 4.0);
        assert!((c.x / c.y - 2.0).abs() < 1e-5 && (c.y / c.z - 2.0).abs() < 1e-5);
    }

    #[test]
    fn aces_follows_the_published_fit() {
        // f(1.46193) by hand: the matrices leave greys alone.
        let x = 1.461_93_f64;
        let y = (x * (x + 0.024_578_6) - 0.000_090_537) / (x * (0.983_729 * x + 0.432_951) + 0.238_081);
        assert!((f64::from(grey(ToneMapper::Aces, 1.0)) - y).abs() < 2e-5);
        assert!((y - 0.730_818).abs() < 1e-6, "{y}");
    }

    #[test]
    fn the_agx_outset_undoes_its_inset() {
        let c = Vec3::new(0.9, 0.3, 0.05);
        let inset = AGX_KEPT * c + Vec3::splat(AGX_INSET.dot(c));
        let back = (inset - Vec3::splat(AGX_INSET.dot(inset))) / AGX_KEPT;
        assert!((back - c).length() < 1e-6);
        // The first row of the published inset, which ours rounds.
        let row = Vec3::new(AGX_KEPT + AGX_INSET.x, AGX_INSET.y, AGX_INSET.z);
        assert!((row - Vec3::new(0.842_48, 0.078_43, 0.079_22)).abs().max_element() < 1e-3, "{row}");
    }

    #[test]
    fn agx_covers_its_sixteen_and_a_half_stops() {
        assert_eq!((agx_curve(0.0).abs() < 1e-6, (agx_curve(1.0) - 1.0).abs() < 1e-6), (true, true));
        assert!((grey(ToneMapper::Agx, 2f32.powf(4.026_07)) - 1.0).abs() < 1e-5);
        // The slope at the pivot, by differences.
        let x0 = (0.18f32.log2() + 12.473_93) / 16.5;
        let slope = (agx_curve(x0 + 0.01) - agx_curve(x0 - 0.01)) / 0.02;
        assert!((slope - 2.4).abs() < 0.02, "{slope}");
    }

    #[test]
    fn colours_that_are_not_numbers_do_not_spread() {
        for &mapper in ToneMapper::ALL {
            let c = mapper.map(Vec3::new(f32::NAN, f32::INFINITY, f32::NEG_INFINITY), 4.0);
            assert!(c.is_finite() && c.min_element() >= 0.0 && c.max_element() <= 1.0, "{mapper} {c}");
        }
    }

    #[test]
    fn names_round_trip() {
        for &mapper in ToneMapper::ALL {
            assert_eq!(mapper.to_string().parse(), Ok(mapper));
        }
        let error = "filmic".parse::<ToneMapper>().unwrap_err().to_string();
        assert_eq!(error, "unknown tone mapper \"filmic\": expected one of none, reinhard, aces, agx");
    }
}
