//! Values on the command line. Every number is finite.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use glam::Vec3;
use lumel::{Camera, RectLight};
use lumel_render_cpu::{MAX_PIXELS, Show, ToneMapper};
use lumel_scene::Radiance;
use std::ops::RangeInclusive;

use crate::spec::Spec;

/// How a light is written.
const LIGHT_EXAMPLE: &str = "rect center=0,2,0 u=0.5,0,0 v=0,0,0.5 radiance=10,10,10";
/// How a camera is written.
const CAMERA_EXAMPLE: &str = "position=0,1,3 target=0,1,0 fov=50";
/// Vertical field of view where none is given, degrees.
const FOV_DEG: f32 = 60.0;

/// What a picture can show.
pub(crate) fn named_show() -> impl TypedValueParser<Value = Show> {
    let values = [
        ("radiance", "what the eye would see"),
        ("irradiance", "the light that arrives, as on white surfaces"),
        ("albedo", "the share that surfaces reflect"),
        ("normals", "where surfaces look: red is +x, green +y, blue +z"),
        ("false-color", "luminance of the irradiance as colours, with a legend"),
    ];
    PossibleValuesParser::new(values.map(|(name, help)| PossibleValue::new(name).help(help)))
        .try_map(|name| name.parse::<Show>())
}

/// The curves from light to pixels.
pub(crate) fn named_tone() -> impl TypedValueParser<Value = ToneMapper> {
    let values = [
        ("none", "cut off: proportional to light until white"),
        ("reinhard", "compress luminance, keep hue and saturation"),
        ("aces", "contrast of film"),
        ("agx", "softer than film, hues hold longer"),
    ];
    PossibleValuesParser::new(values.map(|(name, help)| PossibleValue::new(name).help(help)))
        .try_map(|name| name.parse::<ToneMapper>())
}

/// A finite number.
pub(crate) fn number(text: &str) -> Result<f32, String> {
    let number: f32 = text.trim().parse().map_err(|_| format!("\"{}\" is not a number", text.trim()))?;
    if number.is_finite() { Ok(number) } else { Err(format!("{} is not a finite number", text.trim())) }
}

/// Three finite numbers: `x,y,z`.
pub(crate) fn vector(text: &str) -> Result<Vec3, String> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<f32>, String>>()?;
    match numbers[..] {
        [x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => Err(format!("three numbers x,y,z are needed, not {}", numbers.len())),
    }
}

/// Three finite numbers of which none is below zero: `r,g,b`.
pub(crate) fn color(text: &str) -> Result<Vec3, String> {
    let color = vector(text)?;
    if color.min_element() < 0.0 {
        return Err("light cannot be negative".to_owned());
    }
    Ok(color)
}

/// A vector with a direction.
pub(crate) fn direction(text: &str) -> Result<Vec3, String> {
    let vector = vector(text)?;
    if vector.try_normalize().is_some() { Ok(vector) } else { Err("it has no direction".to_owned()) }
}

/// A length above zero, metres.
pub(crate) fn length(text: &str) -> Result<f32, String> {
    let length = number(text)?;
    if length > 0.0 { Ok(length) } else { Err("a length must be above zero".to_owned()) }
}

/// The largest error that is allowed: zero or more.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    let number: f64 = text.trim().parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if number.is_finite() && number >= 0.0 { Ok(number) } else { Err("it must be zero or more".to_owned()) }
}

/// A whole number in a range.
pub(crate) fn count(range: RangeInclusive<u32>) -> impl Fn(&str) -> Result<u32, String> + Clone {
    move |text| {
        let number = text.trim().parse::<u32>().ok().filter(|n| range.contains(n));
        number.ok_or_else(|| format!("it must be a whole number from {} to {}", range.start(), range.end()))
    }
}

/// A rectangle light: `rect center=x,y,z u=x,y,z v=x,y,z radiance=r,g,b`.
pub(crate) fn light(text: &str) -> Result<RectLight, String> {
    rect_light(text).map_err(|problem| format!("{problem}\n  hint: for example --light '{LIGHT_EXAMPLE}'"))
}

fn rect_light(text: &str) -> Result<RectLight, String> {
    let text = text.trim();
    let (shape, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    if shape != "rect" {
        return Err(format!("the first word must be the shape of the light, \"rect\", not \"{shape}\""));
    }
    let spec = Spec::parse(rest, &["center", "u", "v", "radiance"])?;
    let light = RectLight {
        center: spec.require("center", vector)?,
        u: spec.require("u", direction)?,
        v: spec.require("v", direction)?,
        radiance: Radiance(spec.require("radiance", color)?),
        texture: None,
    };
    // The tolerance of scenes, see `SceneError::BadLight`.
    if light.u.dot(light.v).abs() > 1e-3 * light.u.length() * light.v.length() {
        return Err("u and v must be at a right angle".to_owned());
    }
    Ok(light)
}

/// A viewpoint: the name of a camera of the scene or where to look from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CameraChoice {
    /// By name.
    Named(String),
    /// `position=x,y,z target=x,y,z fov=deg`.
    Free(Camera),
}

/// The name of a camera, or `position=x,y,z target=x,y,z fov=deg up=x,y,z` with the last two optional.
pub(crate) fn camera(text: &str) -> Result<CameraChoice, String> {
    if !text.contains('=') {
        return Ok(CameraChoice::Named(text.to_owned()));
    }
    free_camera(text)
        .map(CameraChoice::Free)
        .map_err(|problem| format!("{problem}\n  hint: for example --camera '{CAMERA_EXAMPLE}'"))
}

fn free_camera(text: &str) -> Result<Camera, String> {
    let spec = Spec::parse(text, &["position", "target", "fov", "up"])?;
    let position = spec.require("position", vector)?;
    let target = spec.require("target", vector)?;
    let fov_deg = spec.optional("fov", number)?.unwrap_or(FOV_DEG);
    let up = spec.optional("up", direction)?.unwrap_or(Vec3::Y);
    if position == target {
        return Err("position and target are the same point".to_owned());
    }
    if !(fov_deg > 0.0 && fov_deg < 179.0) {
        return Err(format!("fov is {fov_deg} degrees; it must be between 0 and 179"));
    }
    let camera = Camera::looking_at("command line", position, target, fov_deg.to_radians());
    Ok(Camera { up, ..camera })
}

/// A size in pixels: `WIDTHxHEIGHT`.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let [width, height]: [u32; 2] =
        sides.ok_or_else(|| "a size is written WIDTHxHEIGHT, such as 1280x720".to_owned())?;
    match u64::from(width) * u64::from(height) {
        1..=MAX_PIXELS => Ok([width, height]),
        0 => Err("a picture needs pixels".to_owned()),
        _ => Err(format!("the limit is {MAX_PIXELS} pixels")),
    }
}

/// A range: `lo,hi`.
pub(crate) fn range(text: &str) -> Result<[f32; 2], String> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<f32>, String>>()?;
    match numbers[..] {
        [lo, hi] if lo < hi => Ok([lo, hi]),
        [_, _] => Err("the second number must be the larger one".to_owned()),
        _ => Err("two numbers lo,hi are needed".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let good = light(LIGHT_EXAMPLE).unwrap();
        assert_eq!((good.center, good.area()), (Vec3::new(0.0, 2.0, 0.0), 1.0));
        let problem = |text: &str| light(text).unwrap_err();
        assert!(problem("disk center=0,0,0").contains("\"disk\""));
        assert!(
            problem("rect center=0,0 u=1,0,0 v=0,0,1 radiance=1,1,1").starts_with("center: three numbers")
        );
        assert!(problem("rect center=0,0,0 u=1,0,0 v=0,0,1").starts_with("radiance is missing"));
        assert!(problem("rect centre=0,0,0").starts_with("there is no key \"centre\""));
        assert!(problem("rect u=1,0,0 u=1,0,0").starts_with("u is given twice"));
        assert!(problem("rect center=0, 0,0").contains("without spaces"));
        assert!(problem("rect center=0,0,0 u=1,0,0 v=1,0,1 radiance=1,1,1").starts_with("u and v must"));
        assert!(problem("rect center=0,0,0 u=1,0,0 v=0,0,1 radiance=-1,1,1").starts_with("radiance: light"));
        assert!(problem("rect").contains("--light 'rect center="));
    }

    #[test]
    fn cameras_are_names_or_places() {
        assert_eq!(camera("front door"), Ok(CameraChoice::Named("front door".into())));
        let CameraChoice::Free(free) = camera(CAMERA_EXAMPLE).unwrap() else { panic!("not a name") };
        assert_eq!(free.forward, Vec3::new(0.0, 0.0, -3.0));
        for bad in ["position=0,0,0", "position=0,0,0 target=0,0,0", "position=0,0,0 target=1,0,0 fov=180"] {
            assert!(camera(bad).unwrap_err().contains("hint:"), "{bad}");
        }
    }

    #[test]
    fn sizes_and_counts_have_limits() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for bad in ["640", "0x5", "x", "-1x4", "99999x99999", "4294967295x4294967295", "640x480x3"] {
            assert!(size(bad).is_err(), "{bad}");
        }
        assert_eq!(count(1..=8)("8"), Ok(8));
        assert!(count(1..=8)("0").is_err() && count(1..=8)("9").is_err() && count(1..=8)("1.5").is_err());
        assert!(length("0").is_err() && length("NaN").is_err());
        assert!(range("1,0").is_err() && range("0,1") == Ok([0.0, 1.0]));
        assert!(tolerance("nan").is_err() && tolerance("-1").is_err() && tolerance("1e-3") == Ok(1e-3));
    }
}
