//! Exposure, and the meter that chooses it.

use crate::rect_light::VisibleLight;
use crate::stats::percentile;
use crate::{Lens, PictureError, Show, View};
use glam::Vec2;
use lumel_scene::{Camera, luminance};
use rayon::prelude::*;
use std::fmt;
use std::str::FromStr;

/// The exposure of a picture: light is multiplied by `2^stops`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposure {
    /// Chosen by [`meter`].
    #[default]
    Auto,
    /// A fixed number of stops.
    Stops(f32),
}

impl Exposure {
    /// The largest number of stops in either direction.
    pub const MAX_STOPS: f32 = 100.0;
}

impl fmt::Display for Exposure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.pad("auto"),
            Self::Stops(stops) => write!(f, "{stops}"),
        }
    }
}

/// The text is not an [`Exposure`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("exposure \"{0}\" is neither \"auto\" nor a number of stops between -100 and 100")]
pub struct BadExposure(String);

impl FromStr for Exposure {
    type Err = BadExposure;

    fn from_str(text: &str) -> Result<Self, BadExposure> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let stops = text.parse::<f32>().ok().filter(|stops| stops.abs() <= Self::MAX_STOPS);
        stops.map(Self::Stops).ok_or_else(|| BadExposure(text.to_owned()))
    }
}

/// Rows of rays that the meter traces.
const METER_ROWS: u32 = 96;

/// Rays per row, whatever the width of the picture.
const MAX_METER_COLUMNS: u32 = 4 * METER_ROWS;

/// The value to which the log-average luminance is brought: middle grey.
const KEY: f64 = 0.18;

/// The percentile of luminance that is brought to [`HIGHLIGHT`] at most.
const HIGHLIGHT_PERCENT: f64 = 95.0;

/// Two stops above white.
const HIGHLIGHT: f64 = 4.0;

/// Luminances are raised to at least this fraction of the highlight, so that gaps and shadows do not brighten the
/// picture.
const DARKEST: f64 = 1e-3;

/// The exposure of a view, in stops, rounded to hundredths so that it can be repeated by hand.
///
/// The meter looks through its own grid of rays, 96 rows of cell centres, and so reads the same for every size, number
/// of samples and quantity shown. It reads the light that surfaces reflect: lamps, glowing surfaces and the sky may be as
/// bright as they like. Where nothing reflects, or most of what is seen glows, it reads all light. Of the luminances above
/// zero, with `h` their 95th percentile and `g = exp(mean(ln(max(Y, h/1000))))`, the exposure is
/// `log2(min(0.18/g, 4/h))`: surfaces are middle grey on average, and 95 % of them are within the two stops above white
/// that tone curves bring back. Doubling the light lowers the reading by one stop. If nothing is lit, it is 0.
///
/// The geometric mean follows Reinhard et al., *Photographic Tone Reproduction for Digital Images*, 2002.
///
/// # Errors
/// [`PictureError::Camera`].
pub fn meter(view: &View<'_>, camera: &Camera, aspect: f32) -> Result<f32, PictureError> {
    let lens = Lens::new(camera, aspect)?;
    let columns = ((METER_ROWS as f32 * aspect) as u32).clamp(1, MAX_METER_COLUMNS);
    let lights = VisibleLight::all_of(view.scene);
    let ray = |i: u32| {
        let cell = Vec2::new((i % columns) as f32, (i / columns) as f32) + Vec2::splat(0.5);
        lens.ray(cell / Vec2::new(columns as f32, METER_ROWS as f32))
    };
    let cells = || (0..columns * METER_ROWS).into_par_iter();
    let seen = |i| {
        let at = view.surface(ray(i))?;
        Some([view.reflected(at), view.scene.emission(at)].map(|light| luminance(light.0)))
    };
    let seen: Vec<[f32; 2]> = cells().filter_map(seen).collect();
    let glowing = seen.iter().filter(|[reflected, emitted]| emitted > reflected).count();
    if 2 * glowing <= seen.len() && seen.iter().any(|[reflected, _]| *reflected > 0.0) {
        return Ok(stops_for(seen.iter().map(|[reflected, _]| *reflected).collect()));
    }
    let arriving = |i| Show::Radiance.sample(view, &lights, ray(i)).map_or(0.0, luminance);
    Ok(stops_for(cells().map(arriving).collect()))
}

fn stops_for(mut luminances: Vec<f32>) -> f32 {
    luminances.retain(|y| y.is_finite() && *y > 0.0);
    let Some(highlight) = percentile(&mut luminances, HIGHLIGHT_PERCENT).map(f64::from) else { return 0.0 };
    let sum: f64 = luminances.iter().map(|y| f64::from(*y).max(DARKEST * highlight).log2()).sum();
    let stops = (KEY.log2() - sum / luminances.len() as f64).min((HIGHLIGHT / highlight).log2());
    let limit = f64::from(Exposure::MAX_STOPS);
    ((stops * 100.0).round() / 100.0).clamp(-limit, limit) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_light_becomes_middle_grey() {
        assert_eq!(stops_for(vec![0.18; 50]), 0.0);
        assert_eq!(stops_for(vec![0.72; 50]), -2.0);
    }

    #[test]
    fn twice_the_light_is_one_stop_less() {
        let light: Vec<f32> = (1..500).map(|i| 0.37 / i as f32).collect();
        let hundredths =
            |factor: f32| (100.0 * stops_for(light.iter().map(|y| factor * y).collect())).round() as i32;
        assert_eq!(hundredths(2.0), hundredths(1.0) - 100);
        assert_eq!(hundredths(0.125), hundredths(1.0) + 300);
    }

    #[test]
    fn highlights_are_kept_and_darkness_does_not_count() {
        // A tenth of the picture at 100: it would clip at the key's exposure.
        let mut light = vec![0.1; 90];
        light.extend([100.0; 10]);
        assert_eq!(stops_for(light), -4.64);
        // A hundredth may clip.
        let mut light = vec![0.18; 990];
        light.extend([0.5; 10]);
        assert!((stops_for(light) - -0.01).abs() < 0.02);
        let mut light = vec![0.18; 10];
        light.extend([0.0, -1.0, f32::NAN, f32::INFINITY]);
        assert_eq!(stops_for(light), 0.0);
        assert_eq!(stops_for(vec![0.0; 4]), 0.0);
        assert_eq!(stops_for(vec![]), 0.0);
        assert!(stops_for(vec![f32::MIN_POSITIVE; 9]) <= 100.0 && stops_for(vec![f32::MAX; 9]) >= -100.0);
    }

    #[test]
    fn texts_round_trip() {
        for exposure in [Exposure::Auto, Exposure::Stops(-1.37), Exposure::Stops(0.0)] {
            assert_eq!(exposure.to_string().parse(), Ok(exposure));
        }
        assert_eq!("+2".parse(), Ok(Exposure::Stops(2.0)));
        for bad in ["", "Auto", "nan", "inf", "1e9", "2 stops"] {
            assert!(bad.parse::<Exposure>().is_err(), "{bad}");
        }
    }
}
