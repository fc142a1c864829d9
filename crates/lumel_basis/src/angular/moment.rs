//! What can be looked at of light by direction.

use super::{Directional, HARMONICS, IncidentRadiance};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// One thing that is known of the light that arrives at a point: where most of it comes from, or a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Moment {
    /// The [dominant direction](IncidentRadiance::dominant).
    Direction,
    /// The coefficient of band 0.
    Sh0,
    /// That of band 1 along y.
    Sh1,
    /// That of band 1 along z.
    Sh2,
    /// That of band 1 along x.
    Sh3,
    /// That of band 2 with xy.
    Sh4,
    /// That of band 2 with yz.
    Sh5,
    /// That of band 2 with 3z² − 1.
    Sh6,
    /// That of band 2 with xz.
    Sh7,
    /// That of band 2 with x² − y².
    Sh8,
}

impl Moment {
    /// Every one; the coefficients are in the order of [`Harmonics`](super::Harmonics).
    pub const ALL: [Self; 1 + HARMONICS] = [
        Self::Direction,
        Self::Sh0,
        Self::Sh1,
        Self::Sh2,
        Self::Sh3,
        Self::Sh4,
        Self::Sh5,
        Self::Sh6,
        Self::Sh7,
        Self::Sh8,
    ];

    /// Its name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direction => "direction",
            Self::Sh0 => "sh0",
            Self::Sh1 => "sh1",
            Self::Sh2 => "sh2",
            Self::Sh3 => "sh3",
            Self::Sh4 => "sh4",
            Self::Sh5 => "sh5",
            Self::Sh6 => "sh6",
            Self::Sh7 => "sh7",
            Self::Sh8 => "sh8",
        }
    }

    /// What it is.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Direction => "where most light comes from, grey where it comes from everywhere",
            Self::Sh0 => "light from everywhere: band 0",
            Self::Sh1 => "light along y: band 1",
            Self::Sh2 => "light along z: band 1",
            Self::Sh3 => "light along x: band 1",
            Self::Sh4 => "light by xy: band 2",
            Self::Sh5 => "light by yz: band 2",
            Self::Sh6 => "light by 3z² - 1: band 2",
            Self::Sh7 => "light by xz: band 2",
            Self::Sh8 => "light by x² - y²: band 2",
        }
    }

    /// The place of its coefficient among harmonics, if it is one.
    pub const fn harmonic(self) -> Option<usize> {
        (self as usize).checked_sub(1)
    }

    /// The coefficient of a harmonic, if there is such a one.
    pub fn of_harmonic(harmonic: usize) -> Option<Self> {
        Self::ALL.into_iter().find(|moment| moment.harmonic() == Some(harmonic))
    }

    /// Whether light of a kind has it.
    pub fn is_in(self, kind: Directional) -> bool {
        self.harmonic().unwrap_or(0) < kind.harmonics()
    }

    /// It of some light: a vector in world space, or a coefficient by channel, W·m⁻².
    pub fn of(self, light: &IncidentRadiance) -> Vec3 {
        match self.harmonic() {
            Some(harmonic) => light.coefficients()[harmonic],
            None => light.dominant(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_light_has_a_direction_and_its_coefficients() {
        let known = |kind| Moment::ALL.into_iter().filter(|moment| moment.is_in(kind)).count();
        assert_eq!(Directional::ALL.map(known), [0, 5, 10]);
        for (k, moment) in Moment::ALL.into_iter().enumerate() {
            assert_eq!(moment.harmonic().map_or(0, |harmonic| harmonic + 1), k);
            assert_eq!(moment.harmonic().and_then(Moment::of_harmonic).unwrap_or(Moment::Direction), moment);
        }
        assert_eq!(Moment::of_harmonic(HARMONICS), None);
    }

    #[test]
    fn moments_are_those_of_the_light() {
        let coefficients: Vec<Vec3> = (1..=9).map(|i| Vec3::new(i as f32, 2.0, 1.0)).collect();
        let light = IncidentRadiance::new(&coefficients).unwrap();
        assert_eq!(Moment::Sh5.of(&light), coefficients[5]);
        assert_eq!(Moment::Direction.of(&light), light.dominant());
    }
}
