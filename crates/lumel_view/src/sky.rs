//! Skies as they are edited, and as project files have them.

use glam::Vec3;
use lumel::{GradientEntry, Radiance, Sky, SkyEntry, SkyGradient};

/// What kind of sky there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SkyKind {
    /// No light from outside.
    Black,
    /// The same from everywhere.
    Uniform,
    /// Changing with the height above the horizon.
    Gradient,
    /// An image of the scene that is open.
    Image,
}

impl SkyKind {
    /// That of a sky.
    pub(crate) fn of(sky: &Sky) -> Self {
        match sky {
            Sky::Uniform(radiance) if radiance.is_zero() => Self::Black,
            Sky::Uniform(_) => Self::Uniform,
            Sky::Gradient(_) => Self::Gradient,
            Sky::Image(_) => Self::Image,
        }
    }

    /// Its name.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Black => "None",
            Self::Uniform => "Uniform",
            Self::Gradient => "Gradient",
            Self::Image => "Image of the scene",
        }
    }

    /// A sky of this kind that is as bright as another one; `given` is that of the scene.
    pub(crate) fn sky(self, like: &Sky, given: &Sky) -> Sky {
        let mean = if like.is_zero() { CLEAR } else { like.mean() };
        match self {
            Self::Black => Radiance::ZERO.into(),
            Self::Uniform => mean.into(),
            Self::Gradient => gradient(mean).into(),
            Self::Image => given.clone(),
        }
    }
}

/// Mean radiance of the sky that is used where none is, W·m⁻²·sr⁻¹.
const CLEAR: Radiance = Radiance(Vec3::new(0.5, 0.7, 1.0));

/// A clear sky of this mean, brighter towards the horizon, above dark ground.
fn gradient(mean: Radiance) -> SkyGradient {
    let zenith = Vec3::new(0.8, 0.9, 1.0);
    let sky =
        SkyGradient { zenith: Radiance(zenith), horizon: Radiance::splat(1.3), ground: Radiance::splat(0.2) };
    let own = Sky::from(sky).mean().0;
    let [zenith, horizon, ground] =
        [sky.zenith, sky.horizon, sky.ground].map(|part| Radiance(part.0 * mean.0 / own));
    SkyGradient { zenith, horizon, ground }
}

/// A sky for a project file; `None` for an image, whose file is known to the project that names it.
pub(crate) fn entry_of(sky: &Sky) -> Option<SkyEntry> {
    match sky {
        Sky::Uniform(radiance) => Some(SkyEntry::Color(radiance.0)),
        Sky::Gradient(SkyGradient { zenith, horizon, ground }) => Some(SkyEntry::Gradient(GradientEntry {
            zenith: zenith.0,
            horizon: horizon.0,
            ground: Some(ground.0),
        })),
        Sky::Image(_) => None,
    }
}

/// The sky that [`entry_of`] has written.
pub(crate) fn of_entry(entry: &SkyEntry) -> Option<Sky> {
    entry.file().is_none().then(|| entry.load(None, &mut Default::default()).ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_keep_the_mean_and_survive_files() {
        let given = Sky::from(Radiance(Vec3::new(1.0, 2.0, 3.0)));
        for kind in [SkyKind::Uniform, SkyKind::Gradient] {
            let sky = kind.sky(&given, &given);
            assert_eq!(SkyKind::of(&sky), kind);
            assert!((sky.mean().0 - given.mean().0).length() < 1e-5, "{sky:?}");
            assert_eq!(of_entry(&entry_of(&sky).unwrap()), Some(sky));
        }
        let black = SkyKind::Black.sky(&given, &given);
        assert!(black.is_zero() && !SkyKind::Gradient.sky(&black, &black).is_zero());
    }
}
