//! Values on the command line. Every number is finite.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use lumel::{CameraEntry, LightEntry, LightKind, Moment, Shading, spec};
use lumel_render_cpu::{MAX_PIXELS, NormalMaps, Show, ToneMapper};
use std::ops::RangeInclusive;

/// An example of a camera.
const CAMERA_EXAMPLE: &str = "position=0,1,3 target=0,1,0 fov=50";

/// What a picture can show.
pub(crate) fn named_show() -> impl TypedValueParser<Value = Show> {
    let values = [
        ("radiance", "the lit scene as the eye would see it"),
        ("irradiance", "the arriving light, as on white surfaces"),
        ("albedo", "the reflected fraction"),
        ("normals", "the directions surfaces face: red is +x, green +y, blue +z"),
        ("false-color", "luminance of the irradiance in false colour, with a legend"),
    ];
    let moments = Moment::ALL.map(|moment| (moment.name(), moment.text()));
    let values = values.into_iter().chain(moments);
    PossibleValuesParser::new(values.map(|(name, help)| PossibleValue::new(name).help(help)))
        .try_map(|name| name.parse::<Show>())
}

/// Whether normal maps are shown.
pub(crate) fn named_normal_maps() -> impl TypedValueParser<Value = NormalMaps> {
    let values = [
        ("off", "surfaces are as smooth as their meshes"),
        ("up", "as files have them: green points up"),
        ("down", "for files whose green points down"),
    ];
    PossibleValuesParser::new(values.map(|(name, help)| PossibleValue::new(name).help(help)))
        .try_map(|name| name.parse::<NormalMaps>())
}

/// Where green of normal maps points.
pub(crate) fn named_green() -> impl TypedValueParser<Value = NormalMaps> {
    named_normal_maps().try_map(|maps| match maps {
        NormalMaps::Off => Err("expected up or down"),
        NormalMaps::Up | NormalMaps::Down => Ok(maps),
    })
}

/// How light on tilted normals is found.
pub(crate) fn named_shading() -> impl TypedValueParser<Value = Shading> {
    let values = [
        ("l1", "linear in four coefficients: off by about 11 %"),
        ("nonlinear", "a power of a cosine from the same: about 6 %"),
        ("zh3", "a zonal band from the same: about 6 %"),
        ("l2", "nine coefficients: about 3 %; zh3 where there are four"),
    ];
    PossibleValuesParser::new(values.map(|(name, help)| PossibleValue::new(name).help(help)))
        .try_map(|name| name.parse::<Shading>())
}

/// The tone curves.
pub(crate) fn named_tone() -> impl TypedValueParser<Value = ToneMapper> {
    let values = [
        ("none", "linear, clipped at white"),
        ("reinhard", "compresses luminance, keeps hue and saturation"),
        ("aces", "the contrast of film"),
        ("agx", "softer than film, keeps hues longer"),
    ];
    PossibleValuesParser::new(values.map(|(name, help)| PossibleValue::new(name).help(help)))
        .try_map(|name| name.parse::<ToneMapper>())
}

fn finite(text: &str) -> Result<f32, String> {
    spec::number(text).map_err(|error| error.to_string())
}

/// The largest allowed error, zero or more.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    let number: f64 = text.trim().parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if number.is_finite() && number >= 0.0 { Ok(number) } else { Err("it must be zero or more".to_owned()) }
}

/// A number above zero.
pub(crate) fn above_zero(text: &str) -> Result<f32, String> {
    let number = finite(text)?;
    if number > 0.0 { Ok(number) } else { Err("it must be above zero".to_owned()) }
}

/// A length above zero, metres.
pub(crate) fn length(text: &str) -> Result<f32, String> {
    let length = lumel::metres(text).ok_or("it must be a length in metres, or with a unit, such as 10cm")?;
    if length > 0.0 && length.is_finite() { Ok(length) } else { Err("it must be above zero".to_owned()) }
}

/// A name and a number above zero. The name may have an equals sign.
pub(crate) fn named_factor(text: &str) -> Result<(String, f32), String> {
    let (name, number) = text.rsplit_once('=').ok_or_else(|| "it must be NAME=X".to_owned())?;
    Ok((name.to_owned(), above_zero(number)?))
}

/// A whole number in a range.
pub(crate) fn count(range: RangeInclusive<u32>) -> impl Fn(&str) -> Result<u32, String> + Clone {
    move |text| {
        let number = text.trim().parse::<u32>().ok().filter(|n| range.contains(n));
        number.ok_or_else(|| format!("it must be a whole number from {} to {}", range.start(), range.end()))
    }
}

/// A light: a new one, or a layer of a solution.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LightChoice {
    /// A new light.
    New(Box<LightEntry>),
    /// The light of a layer, by its name.
    Layer(String),
}

impl LightChoice {
    /// The new light.
    pub(crate) fn as_new(&self) -> Option<&LightEntry> {
        match self {
            Self::New(spec) => Some(spec),
            Self::Layer(_) => None,
        }
    }

    /// The name of the layer.
    pub(crate) fn as_layer(&self) -> Option<&str> {
        match self {
            Self::New(_) => None,
            Self::Layer(name) => Some(name),
        }
    }
}

/// A light: see [`spec::light`].
pub(crate) fn light(text: &str) -> Result<LightChoice, String> {
    spec::light(text).map(Box::new).map(LightChoice::New).map_err(|error| {
        let named = LightKind::ALL.into_iter().find(|kind| text.trim_start().starts_with(kind.name()));
        let example = named.unwrap_or_default().example();
        format!("{error}\n  hint: for example --light '{example}'")
    })
}

/// A light, or the name of a layer.
pub(crate) fn light_or_layer(text: &str) -> Result<LightChoice, String> {
    if text.contains('=') { light(text) } else { Ok(LightChoice::Layer(text.to_owned())) }
}

/// A viewpoint: a camera of the scene by name, or an explicit camera.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CameraChoice {
    /// Chosen to suit the scene.
    Auto,
    /// By name.
    Named(String),
    /// `position=x,y,z target=x,y,z fov=deg`.
    Free(CameraEntry),
}

/// `auto`, the name of a camera, or `position=x,y,z target=x,y,z fov=deg up=x,y,z` with the last two optional.
pub(crate) fn camera(text: &str) -> Result<CameraChoice, String> {
    if text == "auto" {
        return Ok(CameraChoice::Auto);
    }
    if !text.contains('=') {
        return Ok(CameraChoice::Named(text.to_owned()));
    }
    spec::camera(text)
        .map(CameraChoice::Free)
        .map_err(|error| format!("{error}\n  hint: for example --camera '{CAMERA_EXAMPLE}'"))
}

/// A size in pixels: `WIDTHxHEIGHT`.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let [width, height]: [u32; 2] =
        sides.ok_or_else(|| "the size must be WIDTHxHEIGHT, for example 1280x720".to_owned())?;
    match u64::from(width) * u64::from(height) {
        1..=MAX_PIXELS => Ok([width, height]),
        0 => Err("an image needs at least one pixel".to_owned()),
        _ => Err(format!("the limit is {MAX_PIXELS} pixels")),
    }
}

/// A range: `lo,hi`.
pub(crate) fn range(text: &str) -> Result<[f32; 2], String> {
    let numbers = text.split(',').map(finite).collect::<Result<Vec<f32>, String>>()?;
    match numbers[..] {
        [lo, hi] if lo < hi => Ok([lo, hi]),
        [_, _] => Err("the second number must be the larger".to_owned()),
        _ => Err("two numbers lo,hi are required".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn bad_lights_are_answered_with_an_example_that_is_right() {
        assert!(LightKind::ALL.into_iter().all(|kind| light(kind.example()).is_ok()));
        assert!(light("spot").unwrap_err().contains("--light 'spot position="));
        assert!(light("rect").unwrap_err().contains("--light 'rect center="));
    }

    #[test]
    fn a_light_without_an_equals_sign_is_a_layer() {
        assert_eq!(light_or_layer("light 1"), Ok(LightChoice::Layer("light 1".to_owned())));
        assert!(light_or_layer(LightKind::Sun.example()).unwrap().as_new().is_some());
        assert!(light_or_layer("rect center=1").is_err());
    }

    #[test]
    fn cameras_are_names_or_places() {
        assert_eq!(camera("auto"), Ok(CameraChoice::Auto));
        assert_eq!(camera("front door"), Ok(CameraChoice::Named("front door".into())));
        let CameraChoice::Free(free) = camera(CAMERA_EXAMPLE).unwrap() else { panic!("not a name") };
        assert_eq!(free.camera().forward, Vec3::new(0.0, 0.0, -3.0));
        assert!(camera("position=0,0,0").unwrap_err().contains("hint:"));
    }

    #[test]
    fn sizes_and_counts_have_limits() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for bad in ["640", "0x5", "x", "-1x4", "99999x99999", "4294967295x4294967295", "640x480x3"] {
            assert!(size(bad).is_err(), "{bad}");
        }
        assert_eq!(count(1..=8)("8"), Ok(8));
        assert!(count(1..=8)("0").is_err() && count(1..=8)("9").is_err() && count(1..=8)("1.5").is_err());
        assert!(range("1,0").is_err() && range("0,1") == Ok([0.0, 1.0]));
        assert!(tolerance("nan").is_err() && tolerance("-1").is_err() && tolerance("1e-3") == Ok(1e-3));
    }
}
