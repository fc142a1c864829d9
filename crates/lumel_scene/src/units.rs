//! Radiometric quantities as types, so that a factor of pi cannot be lost between them.
//!
//! Every quantity holds three linear Rec. 709 channels. lumel computes linearly, so a scene given in photometric
//! units (candela, lux, nits) comes out in photometric units (lux): read "watt" as "lumen" throughout.

use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::f32::consts::PI;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, Sub};

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[repr(transparent)]
        #[serde(transparent)]
        pub struct $name(pub Vec3);

        impl $name {
            /// Zero in every channel.
            pub const ZERO: Self = Self(Vec3::ZERO);

            /// The same value in every channel.
            pub const fn splat(value: f32) -> Self {
                Self(Vec3::splat(value))
            }

            /// Whether every channel is zero.
            pub fn is_zero(self) -> bool {
                self.0 == Vec3::ZERO
            }
        }

        impl Add for $name {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }
        impl AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                self.0 += other.0;
            }
        }
        impl Sub for $name {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }
        impl Mul<f32> for $name {
            type Output = Self;
            fn mul(self, factor: f32) -> Self {
                Self(self.0 * factor)
            }
        }
        impl Sum for $name {
            fn sum<I: Iterator<Item = Self>>(items: I) -> Self {
                items.fold(Self::ZERO, Self::add)
            }
        }
    };
}

quantity!(
    /// Irradiance E, arriving on a surface: W·m⁻².
    Irradiance
);
quantity!(
    /// Radiosity B, leaving a surface into its hemisphere: W·m⁻².
    Radiosity
);
quantity!(
    /// Radiance L, along a ray: W·m⁻²·sr⁻¹.
    Radiance
);
quantity!(
    /// Diffuse albedo ρ, the reflected share of irradiance: 0..=1, no unit.
    Albedo
);

impl Irradiance {
    /// What a diffuse surface of this albedo sends back: `B = ρE`.
    #[inline]
    pub fn reflected(self, albedo: Albedo) -> Radiosity {
        Radiosity(self.0 * albedo.0)
    }
}

impl Radiosity {
    /// The radiance of a diffuse surface: `L = B/π`.
    #[inline]
    pub fn radiance(self) -> Radiance {
        Radiance(self.0 / PI)
    }

    /// The irradiance that one cosine-distributed ray measures when it meets a surface of this radiosity.
    ///
    /// The π of the diffuse surface cancels that of the density, so the numbers are equal.
    #[inline]
    pub fn cosine_sample(self) -> Irradiance {
        Irradiance(self.0)
    }
}

impl Radiance {
    /// The radiosity of a diffuse surface of this radiance: `B = πL`.
    ///
    /// It is also the irradiance below a hemisphere of this radiance, and so what one cosine-distributed ray
    /// measures: the density's `cos θ/π` cancels the cosine of the integral and leaves π.
    #[inline]
    pub fn radiosity(self) -> Radiosity {
        Radiosity(self.0 * PI)
    }

    /// The irradiance that one cosine-distributed ray measures when it sees this radiance: `πL`.
    #[inline]
    pub fn cosine_sample(self) -> Irradiance {
        self.radiosity().cosine_sample()
    }

    /// Power of a one-sided diffuse emitter of this radiance: `Φ = πLA`, W.
    pub fn power(self, area: f32) -> Vec3 {
        self.radiosity().0 * area
    }

    /// The radiance of a one-sided diffuse emitter of this power (W) and area (m²): `L = Φ/(πA)`.
    pub fn from_power(power: Vec3, area: f32) -> Self {
        Radiosity(power / area).radiance()
    }
}

/// Area of a disk: m² of a radius in metres. With the sine of an angle it is the projected solid angle of the cone
/// around a surface's normal.
pub(crate) fn disk_area(radius: f32) -> f32 {
    PI * radius * radius
}

/// Luminance of a linear Rec. 709 colour, the Y of CIE 1931, in the unit of its channels.
#[inline]
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.212_639, 0.715_169, 0.072_192))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiosity_is_pi_times_radiance() {
        let radiance = Radiance(Vec3::new(1.0, 2.0, 0.5));
        assert_eq!(radiance.radiosity().0, Vec3::new(PI, 2.0 * PI, 0.5 * PI));
        assert!((radiance.radiosity().radiance().0 - radiance.0).length() < 1e-6);
    }

    #[test]
    fn power_and_radiance_of_an_emitter_are_inverse() {
        let power = Vec3::new(60.0, 40.0, 25.0);
        assert!((Radiance::from_power(power, 0.3).power(0.3) - power).length() < 1e-4);
    }

    #[test]
    fn luminance_of_white_is_one() {
        assert!((luminance(Vec3::ONE) - 1.0).abs() < 1e-6);
    }
}
