//! Real spherical harmonics of the first three bands.

use glam::{DMat3, DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// Functions in the bands 0, 1 and 2.
pub const HARMONICS: usize = 9;

/// √(1/4π).
const BAND_0: f32 = 0.282_094_8;
/// √(3/4π).
const BAND_1: f32 = 0.488_602_52;
/// √(15/4π), √(5/16π) and √(15/16π).
const BAND_2: [f32; 3] = [1.092_548_4, 0.315_391_57, 0.546_274_2];

/// Values of the harmonics in one direction, or coefficients of them, in the order of
/// [`Directional::Sh2`]: `Y₀₀, Y₁₋₁, Y₁₀, Y₁₁, Y₂₋₂, Y₂₋₁, Y₂₀, Y₂₁, Y₂₂`.
pub type Harmonics<T> = [T; HARMONICS];

/// The band that a harmonic belongs to, by its place among [`Harmonics`].
pub const fn band_of(harmonic: usize) -> usize {
    harmonic.isqrt()
}

/// Which moments of the light that arrives from different directions are kept beside irradiance.
///
/// They are the coefficients `c_lm = ∫ L Y_lm dω` of incident radiance in world space, W·m⁻², without the cosine of the
/// receiver, over the hemisphere above its surface. They follow irradiance in the channels of a [`Field`](crate::Field), in the
/// order of [`Harmonics`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Directional {
    /// Irradiance alone.
    #[default]
    Off,
    /// The four coefficients of the bands 0 and 1.
    Sh1,
    /// The nine coefficients of the bands 0 to 2.
    Sh2,
}

impl Directional {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Off, Self::Sh1, Self::Sh2];

    /// Coefficients of harmonics per node.
    pub const fn harmonics(self) -> usize {
        match self {
            Self::Off => 0,
            Self::Sh1 => 4,
            Self::Sh2 => HARMONICS,
        }
    }

    /// Channels of a field: irradiance and the coefficients.
    pub const fn channels(self) -> usize {
        1 + self.harmonics()
    }

    /// The kind of a field of so many channels, if there is one.
    pub fn of_channels(channels: usize) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.channels() == channels)
    }
}

/// All harmonics in a direction of unit length.
#[inline]
pub fn spherical_harmonics(Vec3 { x, y, z }: Vec3) -> Harmonics<f32> {
    let [diagonal, axial, difference] = BAND_2;
    [
        BAND_0,
        BAND_1 * y,
        BAND_1 * z,
        BAND_1 * x,
        diagonal * x * y,
        diagonal * y * z,
        axial * (3.0 * z * z - 1.0),
        diagonal * x * z,
        difference * (x * x - y * y),
    ]
}

/// The integrals of all harmonics over some directions, from those of 1, of directions `ω` and of their products `ω ωᵀ`.
pub fn integrals_of_harmonics(solid_angle: f64, first: DVec3, second: DMat3) -> Harmonics<f64> {
    let [band_0, band_1] = [BAND_0, BAND_1].map(f64::from);
    let [diagonal, axial, difference] = BAND_2.map(f64::from);
    [
        band_0 * solid_angle,
        band_1 * first.y,
        band_1 * first.z,
        band_1 * first.x,
        diagonal * second.x_axis.y,
        diagonal * second.y_axis.z,
        axial * (3.0 * second.z_axis.z - solid_angle),
        diagonal * second.x_axis.z,
        difference * (second.x_axis.x - second.y_axis.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_sample::{Dim, Sampler, StreamKey, uniform_sphere};

    #[test]
    fn harmonics_are_orthonormal_on_the_sphere() {
        let n = 1 << 14;
        let stream = Sampler::Sobol.stream(StreamKey::new(3), Dim::Hemisphere);
        let mut products = [[0.0f64; HARMONICS]; HARMONICS];
        for i in 0..n {
            let y = spherical_harmonics(uniform_sphere(stream.sample_2d(i))).map(f64::from);
            for (row, a) in products.iter_mut().zip(y) {
                row.iter_mut().zip(y).for_each(|(sum, b)| *sum += a * b);
            }
        }
        let mean = 4.0 * std::f64::consts::PI / f64::from(n);
        for (i, row) in products.iter().enumerate() {
            for (j, product) in row.iter().enumerate() {
                let expected = f64::from(u8::from(i == j));
                assert!((product * mean - expected).abs() < 2e-4, "{i} {j}: {}", product * mean);
            }
        }
    }

    #[test]
    fn harmonics_of_the_axes_are_where_the_order_says() {
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(spherical_harmonics);
        let near = |a: f32, b: f64| assert!((f64::from(a) - b).abs() < 1e-7, "{a} {b}");
        near(x[0], 0.282_094_791_774);
        for (values, one, other) in [(y, 1, [2, 3]), (z, 2, [1, 3]), (x, 3, [1, 2])] {
            near(values[one], 0.488_602_511_903);
            other.into_iter().for_each(|i| near(values[i], 0.0));
        }
        near(z[6], 2.0 * 0.315_391_565_253);
        near(x[8], 0.546_274_215_296);
        near(y[8], -0.546_274_215_296);
        let diagonal = spherical_harmonics(Vec3::new(1.0, 1.0, 1.0));
        [4, 5, 7].into_iter().for_each(|i| near(diagonal[i], 1.092_548_430_592));
    }

    #[test]
    fn integrals_over_one_direction_are_its_harmonics() {
        let direction = Vec3::new(0.36, -0.48, 0.8);
        let d = direction.as_dvec3();
        let products = DMat3::from_cols(d.x * d, d.y * d, d.z * d);
        let integrals = integrals_of_harmonics(1.0, d, products);
        for (a, b) in integrals.into_iter().zip(spherical_harmonics(direction)) {
            assert!((a - f64::from(b)).abs() < 1e-6, "{a} {b}");
        }
    }

    #[test]
    fn every_kind_is_known_by_its_channels() {
        for kind in Directional::ALL {
            assert_eq!(Directional::of_channels(kind.channels()), Some(kind));
        }
        assert_eq!((Directional::of_channels(4), Directional::of_channels(0)), (None, None));
    }
}
