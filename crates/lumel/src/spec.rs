//! Lights, skies and cameras written as text: `key=value` words, as on the command line. Every number is finite.

use crate::CameraEntry;
use crate::light_entry::{LightEntry, LightKind};
use crate::sky_entry::{self, SkyEntry};
use glam::{DVec3, Vec2, Vec3};
use std::str::FromStr;

/// Vertical field of view of a camera without one, degrees.
const FOV_DEG: f32 = 60.0;
/// What is wrong with a text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SpecError(String);

impl SpecError {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }
}

/// A light: its [kind](LightKind), then words `key=value` in any order, with the keys of [`LightEntry`] that the kind has,
/// and `name=text` if needed.
///
/// ```
/// let spec = lumel::spec::light("rect center=0,2,0 direction=0,-1,0 size=1,1 radiance=10,10,10 name=ceiling")?;
/// assert_eq!(spec.name.as_deref(), Some("ceiling"));
/// let lumel::Light::Rect(rect) = spec.light()? else { panic!("it is a rectangle") };
/// assert_eq!((rect.area(), rect.normal()), (1.0, Some(-lumel::Vec3::Y)));
/// # Ok::<(), lumel::spec::SpecError>(())
/// ```
///
/// # Errors
/// Another kind, an unknown, missing or repeated key, and a value of the wrong kind.
pub fn light(text: &str) -> Result<LightEntry, SpecError> {
    let text = text.trim();
    let (kind, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    let Some(kind) = LightKind::ALL.into_iter().find(|known| known.name() == kind) else {
        let kinds = LightKind::ALL.map(LightKind::name).join(", ");
        return problem(format!(
            "the first word must be the kind of the light, one of {kinds}, not \"{kind}\""
        ));
    };
    let words = Words::parse(rest, &[kind.keys(), &["name"]].concat())?;
    let entry = LightEntry {
        kind,
        name: words.optional("name", word)?,
        center: words.optional("center", place)?,
        position: words.optional("position", place)?,
        u: words.optional("u", direction)?,
        v: words.optional("v", direction)?,
        size: words.optional("size", size)?,
        direction: words.optional("direction", direction)?,
        toward: words.optional("toward", place)?,
        radius: words.optional("radius", number)?,
        inner: words.optional("inner", number)?,
        outer: words.optional("outer", number)?,
        angle: words.optional("angle", number)?,
        radiance: words.optional("radiance", color)?,
        intensity: words.optional("intensity", color)?,
        irradiance: words.optional("irradiance", color)?,
        range: words.optional("range", number)?,
        ..LightEntry::default()
    };
    entry.light().map(|_| entry)
}

/// A sky: `r,g,b` or one number for all, `gradient zenith=r,g,b horizon=r,g,b ground=r,g,b` with the last optional, or the path of an
/// equirectangular image, which may be followed by `rotation=degrees` and `strength=factor`.
///
/// # Errors
/// Any other text.
pub fn sky(text: &str) -> Result<SkyEntry, SpecError> {
    sky_entry::parse(text)
}

/// A camera: `position=x,y,z target=x,y,z fov=deg up=x,y,z`, in any order, the last two optional.
///
/// # Errors
/// An unknown, missing or repeated key, a value of the wrong kind, a target that is the position, and a field of view
/// outside 0 to 179 degrees.
pub fn camera(text: &str) -> Result<CameraEntry, SpecError> {
    let words = Words::parse(text, &["position", "target", "fov", "up"])?;
    let position = words.require("position", place)?;
    let target = words.require("target", place)?;
    let fov_deg = words.optional("fov", number)?.unwrap_or(FOV_DEG);
    let up = words.optional("up", direction)?.unwrap_or(Vec3::Y);
    if position == target {
        return problem("position and target are the same point");
    }
    if !(fov_deg > 0.0 && fov_deg < 179.0) {
        return problem(format!("fov is {fov_deg} degrees; it must be between 0 and 179"));
    }
    Ok(CameraEntry { name: "command line".to_owned(), position, target, up, fov_deg })
}

/// A finite number.
///
/// # Errors
/// Any other text.
pub fn number(text: &str) -> Result<f32, SpecError> {
    finite(text, |number: &f32| number.is_finite())
}

fn finite<F: FromStr>(text: &str, is_finite: impl Fn(&F) -> bool) -> Result<F, SpecError> {
    let text = text.trim();
    match text.parse() {
        Ok(number) if is_finite(&number) => Ok(number),
        Ok(_) => problem(format!("{text} is not a finite number")),
        Err(_) => problem(format!("\"{text}\" is not a number")),
    }
}

/// Three finite numbers: `x,y,z`.
///
/// # Errors
/// Any other text.
pub fn vector(text: &str) -> Result<Vec3, SpecError> {
    three(text, number).map(Vec3::from)
}

/// Three finite numbers that name a place in world space: `x,y,z`.
///
/// # Errors
/// Any other text; numbers beyond single precision are not finite.
pub fn place(text: &str) -> Result<DVec3, SpecError> {
    three(text, |text| finite(text, |number: &f64| (*number as f32).is_finite())).map(DVec3::from)
}

fn three<T: Copy>(text: &str, number: impl Fn(&str) -> Result<T, SpecError>) -> Result<[T; 3], SpecError> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<T>, SpecError>>()?;
    match numbers[..] {
        [x, y, z] => Ok([x, y, z]),
        _ => problem(format!("three numbers x,y,z are needed, not {}", numbers.len())),
    }
}

/// Three finite numbers, none of them negative: `r,g,b`, or one for all.
///
/// # Errors
/// Any other text.
pub fn color(text: &str) -> Result<Vec3, SpecError> {
    let color = if text.contains(',') { vector(text)? } else { Vec3::splat(number(text)?) };
    if color.min_element() < 0.0 { problem("light cannot be negative") } else { Ok(color) }
}

/// Width and height: `w,h`, or one number for both.
fn size(text: &str) -> Result<Vec2, SpecError> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<f32>, SpecError>>()?;
    match numbers[..] {
        [side] => Ok(Vec2::splat(side)),
        [width, height] => Ok(Vec2::new(width, height)),
        _ => problem(format!("two numbers w,h are needed, not {}", numbers.len())),
    }
}

/// A word, which is not empty.
fn word(text: &str) -> Result<String, SpecError> {
    if text.is_empty() { problem("it is empty") } else { Ok(text.to_owned()) }
}

/// A vector that has a direction; it need not be a unit vector.
///
/// # Errors
/// Any other text, zero included.
pub fn direction(text: &str) -> Result<Vec3, SpecError> {
    let vector = vector(text)?;
    if vector.try_normalize().is_some() { Ok(vector) } else { problem("it has no direction") }
}

fn problem<T>(message: impl Into<String>) -> Result<T, SpecError> {
    Err(SpecError(message.into()))
}

/// Words of the form `key=value`, each key once.
pub(crate) struct Words<'a> {
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Words<'a> {
    /// Splits a text into words with known keys.
    pub(crate) fn parse(text: &'a str, keys: &[&str]) -> Result<Self, SpecError> {
        let mut pairs: Vec<(&str, &str)> = Vec::new();
        for word in text.split_whitespace() {
            let Some((key, value)) = word.split_once('=') else {
                return problem(format!(
                    "\"{word}\" is not of the form key=value; write numbers without spaces between them"
                ));
            };
            if !keys.contains(&key) {
                return problem(format!("there is no key \"{key}\"; the keys are {}", keys.join(", ")));
            }
            if pairs.iter().any(|(known, _)| *known == key) {
                return problem(format!("{key} is given twice"));
            }
            pairs.push((key, value));
        }
        Ok(Self { pairs })
    }

    /// The value of a key that must be there.
    pub(crate) fn require<T>(
        &self,
        key: &str,
        parse: fn(&str) -> Result<T, SpecError>,
    ) -> Result<T, SpecError> {
        self.optional(key, parse)?.ok_or_else(|| SpecError(format!("{key} is missing")))
    }

    /// The value of a key that may be absent.
    pub(crate) fn optional<T>(
        &self,
        key: &str,
        parse: fn(&str) -> Result<T, SpecError>,
    ) -> Result<Option<T>, SpecError> {
        let value = self.pairs.iter().find(|(known, _)| *known == key);
        value.map(|(_, value)| parse(value).map_err(|error| SpecError(format!("{key}: {error}")))).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::Light;

    const LIGHT: &str = "rect center=0,2,0 u=0.5,0,0 v=0,0,0.5 radiance=10,10,10";

    #[test]
    fn vectors_are_three_finite_numbers() {
        assert_eq!(vector("1, -2,.5e1"), Ok(Vec3::new(1.0, -2.0, 5.0)));
        for bad in ["", "1,2", "1,2,3,4", "1,2,x", "1,nan,2", "inf,0,0", "1e99,0,0"] {
            assert!(vector(bad).is_err(), "{bad}");
        }
        assert!(color("1,1,-0.1").is_err() && direction("0,0,0").is_err());
    }

    #[test]
    fn lights_say_which_key_is_wrong() {
        let good = light(LIGHT).unwrap();
        assert_eq!(good.center, Some(DVec3::new(0.0, 2.0, 0.0)));
        let Light::Rect(rect) = good.light().unwrap() else { panic!("it is a rectangle") };
        assert_eq!(rect.area(), 1.0);
        let named = light(&format!("{LIGHT} name=left")).unwrap();
        assert_eq!((good.name, named.name.as_deref()), (None, Some("left")));
        let problem = |text: &str| light(text).unwrap_err().to_string();
        assert!(problem("tube center=0,0,0").contains("\"tube\""));
        assert!(
            problem("rect center=0,0 u=1,0,0 v=0,0,1 radiance=1,1,1").starts_with("center: three numbers")
        );
        assert!(problem("rect center=0,0,0 u=1,0,0 v=0,0,1").starts_with("radiance is missing"));
        assert!(problem("rect centre=0,0,0").starts_with("there is no key \"centre\""));
        assert!(problem("rect u=1,0,0 u=1,0,0").starts_with("u is given twice"));
        assert!(problem(&format!("{LIGHT} name=")).starts_with("name: it is empty"));
        assert!(problem("rect center=0, 0,0").contains("without spaces"));
        assert!(problem("rect center=0,0,0 u=1,0,0 v=1,0,1 radiance=1,1,1").starts_with("u and v must"));
        assert!(problem("rect center=0,0,0 u=1,0,0 v=0,0,1 radiance=-1,1,1").starts_with("radiance: light"));
    }

    #[test]
    fn cameras_need_a_position_and_a_target_apart_from_it() {
        let view = camera("position=0,1,3 target=0,1,0 fov=50").unwrap().camera();
        assert_eq!((view.forward, view.up), (Vec3::new(0.0, 0.0, -3.0), Vec3::Y));
        for bad in ["position=0,0,0", "position=0,0,0 target=0,0,0", "position=0,0,0 target=1,0,0 fov=180"] {
            assert!(camera(bad).is_err(), "{bad}");
        }
    }
}
