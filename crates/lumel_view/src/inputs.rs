//! What light is computed from, and what of it has changed since.
//!
//! All that tells light that is out of date compares [`Inputs`]: the status bar, live relighting, the next solve, a
//! running solve, files and recovery.

use lumel::{Light, Scene, Settings};
use std::fmt;
use std::sync::Arc;

/// All that the light of a solve depends on.
#[derive(Clone)]
pub struct Inputs {
    /// The surfaces with their materials, and the sky. Its lights are not compared: see `lights`.
    pub scene: Arc<Scene>,
    /// The lights that shine; `None` for light from a file that belongs to other lights or materials.
    pub lights: Option<Vec<Light>>,
    /// The settings; `None` where a file does not tell.
    pub settings: Option<Settings>,
}

/// In what two [`Inputs`] differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Surfaces.
    pub geometry: bool,
    /// Lights that shine, or the sky.
    pub lights: bool,
    /// Materials.
    pub materials: bool,
    /// Where light is measured.
    pub sites: bool,
    /// Any other setting that bounces depend on, such as the number of samples.
    pub samples: bool,
    /// How many bounces there are to be, and what stands for the rest: the known bounces stay as they are.
    pub bounces: bool,
    /// How the known bounces are read: no ray and no bounce is missing.
    pub reading: bool,
}

impl Inputs {
    /// What is different `now`. What a file does not tell counts as different.
    pub fn changes(&self, now: &Self) -> Changes {
        let same_surfaces = self.scene.has_surfaces_of(&now.scene);
        let settings = self.settings.as_ref().zip(now.settings.as_ref());
        let sites = settings.is_none_or(|(old, new)| old.projection.sampling() != new.projection.sampling());
        let same_bounces = settings.filter(|(old, new)| old.same_bounces_as(new));
        let read_as_now =
            |old: &Settings, new: &Settings| Settings { projection: new.projection, ..old.clone() };
        Changes {
            geometry: !same_surfaces && self.scene.geometry_hash() != now.scene.geometry_hash(),
            lights: self.lights.is_none() || self.lights != now.lights || self.scene.sky() != now.scene.sky(),
            materials: !same_surfaces && self.scene.materials() != now.scene.materials(),
            sites,
            samples: !sites && same_bounces.is_none(),
            bounces: same_bounces.is_some_and(|(old, new)| read_as_now(old, new) != *new),
            reading: same_bounces.is_some_and(|(old, new)| old.projection != new.projection),
        }
    }
}

impl Changes {
    /// Whether anything is different.
    pub fn any(self) -> bool {
        self != Self::default()
    }

    /// Whether there is other light to carry, or other surfaces to carry it.
    pub fn lighting(self) -> bool {
        self.geometry || self.lights || self.materials
    }

    /// Whether any setting is different.
    pub fn settings(self) -> bool {
        self.sites || self.samples || self.bounces || self.reading
    }

    /// Whether the known bounces are no longer those that are asked for.
    pub fn outdates(self) -> bool {
        self.lighting() || self.sites || self.samples
    }
}

/// What has changed, for the start of a sentence: `Lights and settings have changed`.
impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = [
            (self.geometry, "geometry"),
            (self.lights, "lights"),
            (self.materials, "materials"),
            (self.settings(), "settings"),
        ];
        let changed: Vec<&str> = names.into_iter().filter_map(|(is, name)| is.then_some(name)).collect();
        let text = match changed.as_slice() {
            [] => "nothing".to_owned(),
            [one] => (*one).to_owned(),
            [first @ .., last] => format!("{} and {last}", first.join(", ")),
        };
        let (initial, rest) = text.split_at(1);
        write!(
            f,
            "{}{rest} {} changed",
            initial.to_uppercase(),
            if text == "geometry" { "has" } else { "have" }
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lumel::{BounceLimit, OpenOptions, Projection};

    fn inputs() -> Inputs {
        let opened = lumel::open("cornell-box", &OpenOptions::default()).unwrap();
        let scene = Arc::new(opened.builder.build().unwrap().0);
        let lights = Some(scene.lights().to_vec());
        Inputs { scene, lights, settings: Some(Settings::default()) }
    }

    #[test]
    fn each_change_is_told_apart() {
        let old = inputs();
        let none = Changes::default();
        assert_eq!(old.changes(&old), none);
        let mut lights = old.lights.clone().unwrap();
        let Light::Rect(rect) = &mut lights[0] else { panic!("it is a rectangle") };
        rect.center += Vec3::X;
        let moved = Inputs { lights: Some(lights), ..old.clone() };
        assert_eq!(old.changes(&moved), Changes { lights: true, ..none });
        let sky = lumel::Radiance::splat(0.5).into();
        let bright = Inputs { scene: Arc::new(old.scene.under_sky(sky).unwrap()), ..old.clone() };
        assert_eq!(old.changes(&bright), Changes { lights: true, ..none });
        let white = vec![Vec3::ONE; old.scene.materials().len()];
        let painted = Inputs { scene: Arc::new(old.scene.repainted(&white)), ..old.clone() };
        assert_eq!(old.changes(&painted), Changes { materials: true, ..none });
        let with = |settings| Inputs { settings: Some(settings), ..old.clone() };
        let read = |projection| with(Settings { projection, ..Settings::default() });
        let [point, area, least_squares] =
            [Projection::Point, Projection::Area, Projection::LeastSquares].map(read);
        assert_eq!(point.changes(&area), Changes { sites: true, ..none });
        assert_eq!(area.changes(&least_squares), Changes { reading: true, ..none });
        assert!(!area.changes(&least_squares).outdates());
        let seed = with(Settings { seed: 7, ..Settings::default() });
        assert_eq!(old.changes(&seed), Changes { samples: true, ..none });
        let bounces = with(Settings { bounces: BounceLimit::Count(9), ..Settings::default() });
        assert_eq!(old.changes(&bounces), Changes { bounces: true, ..none });
        assert!(!old.changes(&bounces).outdates() && old.changes(&seed).outdates());
    }

    #[test]
    fn what_a_file_does_not_tell_counts_as_changed() {
        let now = inputs();
        let file = Inputs { lights: None, settings: None, ..now.clone() };
        let changes = file.changes(&now);
        assert!(changes.lights && changes.sites && changes.outdates());
        assert!(file.changes(&file).lights, "unknown lights are never the same");
    }

    #[test]
    fn changes_are_told_in_a_sentence() {
        let none = Changes::default();
        assert_eq!(Changes { lights: true, ..none }.to_string(), "Lights have changed");
        let two = Changes { materials: true, samples: true, ..none };
        assert_eq!(two.to_string(), "Materials and settings have changed");
        assert_eq!(Changes { geometry: true, ..none }.to_string(), "Geometry has changed");
    }
}
