//! When an edge is split.

use glam::Vec3;

/// What was measured at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Probe {
    /// Irradiance, luminance, W·m⁻².
    pub(crate) light: f64,
    /// Of `light`: the square of its standard error.
    pub(crate) variance: f64,
    /// Which lights it sees, a bit each.
    pub(crate) visible: u32,
    /// Irradiance, W·m⁻², for looking at.
    pub(crate) irradiance: Vec3,
}

/// Which edges are split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Criterion {
    /// How far light may be from a linear function along an edge of [usual](USUAL) length, relative to the light there.
    pub(crate) error: f64,
    /// Light that is darker than this is taken for as bright, W·m⁻².
    pub(crate) floor: f64,
}

/// Longer edges are split in any case, as a share of the diameter of the scene: between fewer probes, a small bright patch would
/// be missed. A little more than a 16th, so that rounding does not split diagonals that were halved four times once again.
pub(crate) const LONGEST: f64 = 1.0 / 15.9;

/// Triangles with longer edges are probed within, too.
pub(crate) const PROBED_WITHIN: f64 = 1.0 / 32.0;

/// The error is meant for edges of this length. Longer ones may hide less and shorter ones more, so that all edges contribute
/// alike to the mean square error over the surfaces.
const USUAL: f64 = 1.0 / 64.0;

/// Edges that a light appears or disappears along are split until they are this short.
const SHADOW: f64 = 1.0 / 32.0;

/// Edges of the given mesh that are shorter are split only with others: there are many where a mesh has small parts, and hardly any
/// hides much.
pub(crate) const PROBED: f64 = 1.0 / 128.0;

/// Edges up to this length are not split at all.
pub(crate) const SHORTEST: f64 = 1.0 / 512.0;

/// What light must differ by, in standard errors of the difference: less may be noise.
const SIGNIFICANT: f64 = 3.0;

impl Probe {
    /// Darkness.
    pub(crate) const NONE: Self = Self { light: 0.0, variance: 0.0, visible: 0, irradiance: Vec3::ZERO };
}

impl Criterion {
    /// By how much light in the middle of an edge differs from the mean of its ends, over what it may: more than 1 is too
    /// much.
    ///
    /// For light with the second derivative f″ along an edge of length l, that is l² f″ / 8: the error of a linear function
    /// in the middle.
    pub(crate) fn excess(&self, middle: &Probe, ends: [&Probe; 2], length: f64) -> f64 {
        let [a, b] = ends;
        let between = 0.5 * (a.light + b.light);
        let noise = middle.variance + 0.25 * (a.variance + b.variance);
        self.over((middle.light - between).abs(), between, noise, length)
    }

    /// The same for a point within a triangle, between whose corners light is linear with these weights.
    pub(crate) fn excess_within(
        &self,
        inside: &Probe,
        corners: [&Probe; 3],
        weights: [f32; 3],
        length: f64,
    ) -> f64 {
        let weighted = |value: fn(&Probe) -> f64, power: i32| -> f64 {
            corners
                .iter()
                .zip(weights)
                .map(|(corner, weight)| value(corner) * f64::from(weight).powi(power))
                .sum()
        };
        let between = weighted(|probe| probe.light, 1);
        let noise = inside.variance + weighted(|probe| probe.variance, 2);
        self.over((inside.light - between).abs(), between, noise, length)
    }

    fn over(&self, difference: f64, light: f64, variance: f64, length: f64) -> f64 {
        let tolerance = self.error * light.max(self.floor) * USUAL / length;
        difference / tolerance.max(SIGNIFICANT * variance.sqrt()).max(f64::MIN_POSITIVE)
    }

    /// Whether a light is seen from some of the points of an edge and not from others, and the edge is too long for that.
    pub(crate) fn is_shadow_edge(&self, middle: &Probe, ends: [&Probe; 2], length: f64) -> bool {
        length > SHADOW && ends.iter().any(|end| end.visible != middle.visible)
    }
}
