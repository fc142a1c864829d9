//! How normal maps and ripples are shown.

use lumel::{Scene, Shading};
use lumel_render_cpu::{NormalMaps, Relief, Ripple};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How normal maps and ripples are shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReliefPrefs {
    /// Whether they are.
    pub on: bool,
    /// The name of the [`Shading`] of tilted normals.
    pub shading: String,
    /// Whether green of normal maps points down.
    pub green_down: bool,
    /// Length of the longest waves of a ripple, of the scene's diagonal.
    pub wave_length: f32,
    /// Their steepest slope.
    pub slope: f32,
    /// How fast they run, radians per second.
    pub speed: f32,
}

/// What is offered of [`ReliefPrefs::wave_length`].
pub const WAVE_LENGTHS: [f32; 2] = [0.005, 0.5];

/// What is offered of [`ReliefPrefs::slope`].
pub const SLOPES: [f32; 2] = [0.0, 1.0];

/// What is offered of [`ReliefPrefs::speed`].
pub const SPEEDS: [f32; 2] = [0.0, 10.0];

impl Default for ReliefPrefs {
    fn default() -> Self {
        Self {
            on: true,
            shading: Shading::default().to_string(),
            green_down: false,
            wave_length: 0.08,
            slope: 0.35,
            speed: 2.0,
        }
    }
}

impl ReliefPrefs {
    /// What was kept, with what makes no sense made good.
    #[must_use]
    pub fn mended(self) -> Self {
        let default = Self::default();
        let within =
            |x: f32, [lo, hi]: [f32; 2], default: f32| if (lo..=hi).contains(&x) { x } else { default };
        Self {
            wave_length: within(self.wave_length, WAVE_LENGTHS, default.wave_length),
            slope: within(self.slope, SLOPES, default.slope),
            speed: within(self.speed, SPEEDS, default.speed),
            ..self
        }
    }

    /// How light on tilted normals is found.
    pub fn shading(&self) -> Shading {
        self.shading.parse().unwrap_or_default()
    }

    /// Which normals are shown, and how light on them is found.
    pub fn relief(&self) -> Relief {
        let maps = match self {
            Self { on: false, .. } => NormalMaps::Off,
            Self { green_down: true, .. } => NormalMaps::Down,
            Self { green_down: false, .. } => NormalMaps::Up,
        };
        Relief { maps, shading: self.shading() }
    }

    /// A scene whose normal maps have green up.
    pub fn with_green_up(&self, scene: &Arc<Scene>) -> Arc<Scene> {
        if self.green_down { Arc::new(scene.with_green_flipped()) } else { Arc::clone(scene) }
    }

    /// The waves over a scene once they have run so far, radians.
    pub fn ripple(&self, scene: &Scene, phase: f32) -> Ripple {
        let length = scene.bounds().diagonal() * self.wave_length / 360_f32.to_radians();
        Ripple { length: length.max(f32::MIN_POSITIVE), slope: self.slope, phase }
    }
}

/// Whether any surface of a scene has a normal map.
pub fn has_normal_maps(scene: &Scene) -> bool {
    scene.materials().iter().any(|material| material.normal_texture.is_some())
}

/// What is to be done where light is not known by direction.
pub const UNKNOWN: &str =
    "Where light comes from is not known. Choose L1 or L2 as \"Directional\" under Solve, and solve.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preferences_say_which_normals_are_shown() {
        let prefs = ReliefPrefs { shading: "l2".into(), ..ReliefPrefs::default() };
        assert_eq!(prefs.relief(), Relief { maps: NormalMaps::Up, shading: Shading::Quadratic });
        let down = ReliefPrefs { green_down: true, shading: "?".into(), ..prefs.clone() };
        assert_eq!(down.relief(), Relief { maps: NormalMaps::Down, shading: Shading::default() });
        assert_eq!(ReliefPrefs { on: false, ..down }.relief().maps, NormalMaps::Off);
        let bad = ReliefPrefs { slope: f32::NAN, speed: 99.0, wave_length: 0.0, ..prefs.clone() };
        assert_eq!(bad.mended(), prefs);
    }
}
