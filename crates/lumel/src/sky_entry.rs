//! Skies as texts describe them: in project files and on the command line.

use crate::spec::{self, SpecError, Words};
use glam::Vec3;
use lumel_import::{TextureError, load_sky};
use lumel_scene::{Radiance, Sky, SkyGradient, SkyImage, Warnings};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The sky in a project file, or on the command line: a colour, a gradient or an image.
///
/// ```
/// let text = "builtin = \"atrium\"\nsky = { image = \"noon.hdr\", rotation = 90.0, strength = 2.0 }";
/// let project: lumel::Project = text.parse().unwrap();
/// assert_eq!(project.sky, lumel::spec::sky("noon.hdr rotation=90 strength=2").ok());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a sky must be [r, g, b], { zenith, horizon } with ground if it differs, or { image } with rotation \
                 (degrees) and strength if needed"
)]
pub enum SkyEntry {
    /// Radiance from all directions, W·m⁻²·sr⁻¹.
    Color(Vec3),
    /// Radiance that changes with the elevation.
    Gradient(GradientEntry),
    /// An equirectangular image.
    Image(SkyImageEntry),
}

/// A gradient of the sky, W·m⁻²·sr⁻¹.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradientEntry {
    /// From straight above.
    pub zenith: Vec3,
    /// From the horizon.
    pub horizon: Vec3,
    /// From straight below; that of the horizon by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<Vec3>,
}

/// An image of the sky.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkyImageEntry {
    /// The file, relative to the project file; HDR and EXR hold radiance, W·m⁻²·sr⁻¹.
    pub image: PathBuf,
    /// How far it is turned, degrees counter-clockwise about +Y seen from above.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rotation: f32,
    /// What multiplies its radiance.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub strength: f32,
}

fn is_zero(value: &f32) -> bool {
    *value == 0.0
}

fn is_one(value: &f32) -> bool {
    *value == 1.0
}

fn one() -> f32 {
    1.0
}

impl From<Vec3> for SkyEntry {
    fn from(radiance: Vec3) -> Self {
        Self::Color(radiance)
    }
}

impl SkyEntry {
    /// What is wrong with its numbers.
    pub(crate) fn problem(&self) -> Option<&'static str> {
        let bad = |color: &Vec3| !color.is_finite() || color.min_element() < 0.0;
        let is_bad = match self {
            Self::Color(color) => bad(color),
            Self::Gradient(GradientEntry { zenith, horizon, ground }) => {
                bad(zenith) || bad(horizon) || ground.as_ref().is_some_and(bad)
            }
            Self::Image(SkyImageEntry { rotation, strength, .. }) => {
                if !rotation.is_finite() {
                    return Some("the rotation of the sky must be finite");
                }
                if !(strength.is_finite() && *strength >= 0.0) {
                    return Some("the strength of the sky must be finite and not negative");
                }
                false
            }
        };
        is_bad.then_some("the radiance of the sky must be finite and not negative")
    }

    /// The file that it refers to.
    pub fn file(&self) -> Option<&Path> {
        if let Self::Image(entry) = self { Some(&entry.image) } else { None }
    }

    /// The sky. `file` is where the image lies, if there is one; warnings about it are added.
    ///
    /// # Errors
    /// An image that cannot be read.
    pub fn load(&self, file: Option<&Path>, warnings: &mut Warnings) -> Result<Sky, TextureError> {
        Ok(match self {
            Self::Color(color) => Radiance(*color).into(),
            Self::Gradient(GradientEntry { zenith, horizon, ground }) => SkyGradient {
                zenith: Radiance(*zenith),
                horizon: Radiance(*horizon),
                ground: Radiance(ground.unwrap_or(*horizon)),
            }
            .into(),
            Self::Image(SkyImageEntry { image, rotation, strength }) => {
                let texture = load_sky(file.unwrap_or(image), warnings)?;
                SkyImage::new(texture, rotation.to_radians(), *strength).into()
            }
        })
    }
}

/// A sky: `r,g,b` or one number for all, or `gradient zenith=r,g,b horizon=r,g,b ground=r,g,b` with the last optional, or the path of an image,
/// which may be followed by `rotation=degrees` and `strength=factor`.
pub(crate) fn parse(text: &str) -> Result<SkyEntry, SpecError> {
    let text = text.trim();
    if let Some(words) = text.strip_prefix("gradient").filter(|rest| rest.starts_with([' ', '\t'])) {
        let words = Words::parse(words, &["zenith", "horizon", "ground"])?;
        return Ok(SkyEntry::Gradient(GradientEntry {
            zenith: words.require("zenith", spec::color)?,
            horizon: words.require("horizon", spec::color)?,
            ground: words.optional("ground", spec::color)?,
        }));
    }
    if is_color(text) {
        return spec::color(text).map(SkyEntry::Color);
    }
    let (path, words) = split_options(text);
    if path.is_empty() {
        return Err(SpecError::new("a colour r,g,b, a gradient or the path of an image is needed"));
    }
    let words = Words::parse(words, &["rotation", "strength"])?;
    let entry = SkyEntry::Image(SkyImageEntry {
        image: path.into(),
        rotation: words.optional("rotation", spec::number)?.unwrap_or(0.0),
        strength: words.optional("strength", spec::number)?.unwrap_or(1.0),
    });
    entry.problem().map_or(Ok(entry), |problem| Err(SpecError::new(problem)))
}

/// Whether a text is meant as numbers: its first part is one, and no file ends like that.
fn is_color(text: &str) -> bool {
    let first = text.split(',').next().unwrap_or_default().trim();
    Path::new(text).extension().is_none_or(|e| e.to_string_lossy().starts_with(|c: char| c.is_ascii_digit()))
        && first.parse::<f32>().is_ok()
}

/// A path, and the words `key=value` behind it.
fn split_options(text: &str) -> (&str, &str) {
    let mut path = text;
    loop {
        let (before, last) = path.rsplit_once(char::is_whitespace).unwrap_or(("", path));
        if !["rotation=", "strength="].iter().any(|key| last.starts_with(key)) {
            break;
        }
        path = before.trim_end();
    }
    (path, &text[path.len()..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skies_are_colours_gradients_or_files() {
        let color = parse("0.1, 0.2,3").unwrap();
        assert_eq!(color, SkyEntry::Color(Vec3::new(0.1, 0.2, 3.0)));
        assert_eq!(parse("0.5"), Ok(SkyEntry::Color(Vec3::splat(0.5))));
        let SkyEntry::Gradient(gradient) = parse("gradient zenith=1,2,3 horizon=4,5,6").unwrap() else {
            panic!("it is a gradient")
        };
        assert_eq!((gradient.horizon, gradient.ground), (Vec3::new(4.0, 5.0, 6.0), None));
        for (text, path, rotation, strength) in [
            ("noon.hdr", "noon.hdr", 0.0, 1.0),
            ("my skies/noon 2.exr strength=3 rotation=-90", "my skies/noon 2.exr", -90.0, 3.0),
            ("1,2.hdr", "1,2.hdr", 0.0, 1.0),
        ] {
            let entry = SkyImageEntry { image: path.into(), rotation, strength };
            assert_eq!(parse(text), Ok(SkyEntry::Image(entry)), "{text}");
        }
    }

    #[test]
    fn bad_skies_say_what_is_wrong() {
        for (text, problem) in [
            ("1,1", "three numbers"),
            ("nan,0,0", "nan is not a finite number"),
            ("-1,0,0", "light cannot be negative"),
            ("", "a colour r,g,b, a gradient or the path"),
            ("gradient zenith=1,1,1", "horizon is missing"),
            ("gradient zenith=1,1,1 horizon=1,1,1 top=1,1,1", "there is no key \"top\""),
            ("a.hdr strength=-1", "the strength of the sky must be"),
            ("a.hdr rotation=x", "rotation: \"x\" is not a number"),
            ("rotation=5", "a colour r,g,b"),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.starts_with(problem), "{text}: {error}");
        }
    }
}
