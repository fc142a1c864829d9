//! Skies as they are edited, and as project files have them.

use glam::Vec3;
use lumel::{GradientEntry, Project, Radiance, Sky, SkyEntry, SkyGradient, SkyImageEntry};
use std::path::{Path, PathBuf};

/// The formats of images of the sky that are offered, by extension. HDR and EXR hold radiance.
pub(crate) const SKY_FORMATS: [&str; 5] = ["hdr", "exr", "png", "jpg", "jpeg"];

/// A sky as it is edited.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EditSky {
    /// What shines.
    pub sky: Sky,
    /// The file of its image, if it is one.
    pub file: Option<PathBuf>,
}

impl From<Sky> for EditSky {
    /// A sky that needs no file.
    fn from(sky: Sky) -> Self {
        Self { sky, file: None }
    }
}

impl EditSky {
    /// That of a scene, which may be that of a project.
    pub(crate) fn of(sky: &Sky, project: Option<(&Path, &Project)>) -> Self {
        let file = project.and_then(|(path, project)| {
            let image = project.sky.as_ref()?.file()?;
            std::path::absolute(path.parent()?.join(image)).ok()
        });
        Self { sky: sky.clone(), file: file.filter(|_| sky.image().is_some()) }
    }

    /// It in a project file, where its image lies there; `None` for an image of no file.
    pub(crate) fn entry(&self) -> Option<SkyEntry> {
        match &self.sky {
            Sky::Uniform(radiance) => Some(SkyEntry::Color(radiance.0)),
            Sky::Gradient(SkyGradient { zenith, horizon, ground }) => {
                Some(SkyEntry::Gradient(GradientEntry {
                    zenith: zenith.0,
                    horizon: horizon.0,
                    ground: Some(ground.0),
                }))
            }
            Sky::Image(image) => Some(SkyEntry::Image(SkyImageEntry {
                image: self.file.clone()?,
                rotation: image.rotation().to_degrees(),
                strength: image.strength(),
            })),
        }
    }
}

/// What kind of sky there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SkyKind {
    /// No light from outside.
    Black,
    /// The same from everywhere.
    Uniform,
    /// Changing with the height above the horizon.
    Gradient,
    /// An image of all directions.
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
            Self::Image => "Image",
        }
    }

    /// A sky of this kind that is as bright as another one; `None` for images, which are in files.
    pub(crate) fn sky(self, like: &Sky) -> Option<Sky> {
        let mean = if like.is_zero() { CLEAR } else { like.mean() };
        match self {
            Self::Black => Some(Radiance::ZERO.into()),
            Self::Uniform => Some(mean.into()),
            Self::Gradient => Some(gradient(mean).into()),
            Self::Image => None,
        }
    }
}

/// A clear sky: what is used where there is none.
pub(crate) fn clear() -> Sky {
    gradient(CLEAR).into()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_keep_the_mean_and_survive_files() {
        let given = Sky::from(Radiance(Vec3::new(1.0, 2.0, 3.0)));
        for kind in [SkyKind::Uniform, SkyKind::Gradient] {
            let sky = kind.sky(&given).unwrap();
            assert_eq!(SkyKind::of(&sky), kind);
            assert!((sky.mean().0 - given.mean().0).length() < 1e-5, "{sky:?}");
            let entry = EditSky::from(sky.clone()).entry().unwrap();
            assert_eq!(entry.load(None, &mut Default::default()).unwrap(), sky);
        }
        let black = SkyKind::Black.sky(&given).unwrap();
        assert!(black.is_zero() && !SkyKind::Gradient.sky(&black).unwrap().is_zero());
    }
}
