//! Irradiance on a normal that is tilted from its surface.

use super::{Directional, HARMONICS, Harmonics, IncidentRadiance, spherical_harmonics};
use glam::Vec3;
use lumel_scene::{Irradiance, Radiance, luminance};
use std::fmt;
use std::str::FromStr;

/// How irradiance on a tilted normal is reconstructed from the [light that arrives](IncidentRadiance).
///
/// All are biased: a few coefficients do not tell where light comes from exactly. With light from a few directions and
/// from everywhere, on normals tilted by up to 45°, [`shade`](Self::shade) is off by the root mean square of
///
/// | | of the irradiance that is not tilted |
/// |---|---|
/// | `Linear` | 11 % |
/// | `NonLinear` | 6 % |
/// | `Zh3` | 6 % |
/// | `Quadratic` | 3 % |
///
/// The test `the_errors_of_all_shadings_are_those_that_are_documented` measures them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Shading {
    /// Bands 0 and 1: exact below an even sky, negative behind light that comes from one direction.
    Linear,
    /// The same four coefficients as a power of a cosine, never negative and exact towards light that comes from one
    /// direction (Geomerics). Its mean over all normals is that of the light.
    #[default]
    NonLinear,
    /// Bands 0 and 1, and a zonal band 2 that they suggest, around the direction of most light.
    ///
    /// Roughton, Sloan, Silvennoinen, Iwanicki, Shirley, *ZH3: Quadratic Zonal Harmonics*, 2024.
    Zh3,
    /// Bands 0 to 2; as [`Zh3`](Self::Zh3) where only bands 0 and 1 are known.
    ///
    /// Ramamoorthi, Hanrahan, *An Efficient Representation for Irradiance Environment Maps*, 2001.
    Quadratic,
}

/// The least irradiance on the normal that is not tilted that a ratio is taken to, of the mean over all normals.
///
/// Light of the hemisphere above a surface gives more: ⅜ along the horizon for [`Shading::Quadratic`], and more for the others.
/// Less comes from noise.
const LEAST: f32 = 0.1;

/// The most by which a tilted normal multiplies light.
const MOST: f32 = 4.0;

/// √(5/16π), of the harmonic Y₂₀.
const ZONAL: f32 = 0.315_391_57;

impl Shading {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Linear, Self::NonLinear, Self::Zh3, Self::Quadratic];

    /// The irradiance on a surface whose unit normal is tilted from `flat` to `normal`, of which `measured` arrives
    /// where it is not: `measured · S(normal) / S(flat)`, `S` the [reconstruction](Self::irradiance).
    ///
    /// The same normal has the light that was measured. The ratio is at most 4 and at least 0.
    pub fn shade(
        self,
        measured: Irradiance,
        light: &IncidentRadiance,
        flat: Vec3,
        normal: Vec3,
    ) -> Irradiance {
        let [tilted, base] = [normal, flat].map(|n| self.radiance(light, n));
        // Over all normals, all reconstructions have the mean of band 0.
        let least = LEAST * light.coefficients()[0] * spherical_harmonics(flat)[0];
        let base = base.max(least);
        let lit = base.cmpgt(Vec3::ZERO);
        let ratio = Vec3::select(lit, tilted / base, Vec3::ONE).clamp(Vec3::ZERO, Vec3::splat(MOST));
        Irradiance(measured.0 * ratio)
    }

    /// The irradiance on a unit normal, as reconstructed from the light alone; may be negative unless
    /// [`NonLinear`](Self::NonLinear).
    pub fn irradiance(self, light: &IncidentRadiance, normal: Vec3) -> Irradiance {
        Radiance(self.radiance(light, normal)).cosine_sample()
    }

    /// The radiance that gives this irradiance if it arrives from everywhere.
    fn radiance(self, light: &IncidentRadiance, normal: Vec3) -> Vec3 {
        match self {
            Self::Linear => linear(light, &spherical_harmonics(normal)),
            Self::NonLinear => Vec3::from_array([0, 1, 2].map(|channel| non_linear(light, normal, channel))),
            Self::Zh3 => zonal(light, normal),
            Self::Quadratic if light.kind() == Directional::Sh2 => quadratic(light, normal),
            Self::Quadratic => zonal(light, normal),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Linear => "l1",
            Self::NonLinear => "nonlinear",
            Self::Zh3 => "zh3",
            Self::Quadratic => "l2",
        }
    }
}

/// The sum of `A_l c_lm Y_lm / π` over bands 0 and 1: `A₀ = π`, `A₁ = 2π/3`.
fn linear(light: &IncidentRadiance, at: &Harmonics<f32>) -> Vec3 {
    let [c0, c1, c2, c3, ..] = *light.coefficients();
    c0 * at[0] + (c1 * at[1] + c2 * at[2] + c3 * at[3]) * (2.0 / 3.0)
}

/// The same with band 2: `A₂ = π/4`.
fn quadratic(light: &IncidentRadiance, normal: Vec3) -> Vec3 {
    let at = spherical_harmonics(normal);
    let band = (4..HARMONICS).map(|i| light.coefficients()[i] * at[i]).sum::<Vec3>();
    linear(light, &at) + 0.25 * band
}

/// One channel, as a power of the cosine of half the angle to the light.
fn non_linear(light: &IncidentRadiance, normal: Vec3, channel: usize) -> f32 {
    let y0 = spherical_harmonics(normal)[0];
    let mean = light.coefficients()[0][channel] * y0;
    let vector = light.vector(channel) * (y0 / 3_f32.sqrt());
    let length = vector.length();
    if !(mean > 0.0 && length > 0.0) {
        return mean.max(0.0);
    }
    let share = (length / mean).min(1.0);
    let cosine = (vector.dot(normal) / length).clamp(-1.0, 1.0);
    let (half, power) = (0.5 * (1.0 + cosine), 1.0 + 2.0 * share);
    let ambient = (1.0 - share) / (1.0 + share);
    mean * (ambient + (1.0 - ambient) * (power + 1.0) * half.powf(power))
}

/// Bands 0 and 1, and the zonal band 2 that fits light around the direction of most of it.
fn zonal(light: &IncidentRadiance, normal: Vec3) -> Vec3 {
    let sum = linear(light, &spherical_harmonics(normal));
    let [x, y, z] = [3, 1, 2].map(|i| luminance(light.coefficients()[i]));
    let Some(axis) = Vec3::new(x, y, z).try_normalize() else { return sum };
    let cosine = axis.dot(normal);
    let band = |channel: usize| {
        let whole = light.coefficients()[0][channel];
        if whole <= 0.0 {
            return 0.0;
        }
        let towards = (light.vector(channel).dot(axis) / whole).abs();
        whole * (0.08 * towards + 0.6 * towards * towards)
    };
    let zonal = Vec3::from_array([0, 1, 2].map(band));
    sum + 0.25 * zonal * (ZONAL * (3.0 * cosine * cosine - 1.0))
}

impl fmt::Display for Shading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Shading {
    type Err = UnknownShading;

    fn from_str(name: &str) -> Result<Self, UnknownShading> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| UnknownShading(name.to_owned()))
    }
}

/// The text is not the name of a [`Shading`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown shading \"{0}\": expected one of l1, nonlinear, zh3, l2")]
pub struct UnknownShading(String);

#[cfg(test)]
mod tests;
