//! Slots: camera, lights and settings under a digit.

use crate::camera::FlyCamera;
use crate::lights::EditLight;
use lumel::{CameraEntry, Settings, SettingsPatch, SlotEntry};

/// What a slot holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    /// The view.
    pub camera: FlyCamera,
    /// All lights.
    pub lights: Vec<EditLight>,
    /// The settings of the solve.
    pub settings: Settings,
}

/// The states under 0 to 9.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slots([Option<Slot>; 10]);

impl Slots {
    /// The state under a digit.
    pub fn get(&self, digit: u8) -> Option<&Slot> {
        self.0.get(usize::from(digit)).and_then(Option::as_ref)
    }

    /// Fills or clears a slot.
    pub fn set(&mut self, digit: u8, slot: Option<Slot>) {
        if let Some(place) = self.0.get_mut(usize::from(digit)) {
            *place = slot;
        }
    }

    /// The digits that have a state.
    pub fn digits(&self) -> impl Iterator<Item = u8> + '_ {
        (0..10).filter(|&digit| self.get(digit).is_some())
    }

    /// From a project file. Lights keep their names.
    pub fn from_entries(entries: &[SlotEntry]) -> Self {
        let mut slots = Self::default();
        for entry in entries {
            let Some(camera) = FlyCamera::from_camera(&entry.camera.camera()) else { continue };
            let lights =
                entry.lights.iter().enumerate().map(|(i, l)| EditLight::from_entry(i, l, None)).collect();
            slots.set(entry.number, Some(Slot { camera, lights, settings: entry.bake.settings() }));
        }
        slots
    }

    /// The entries of a project file.
    pub fn entries(&self) -> Vec<SlotEntry> {
        let entry = |number: u8| {
            let slot = self.get(number)?;
            Some(SlotEntry {
                number,
                camera: CameraEntry::from(&slot.camera.camera()),
                lights: slot.lights.iter().map(EditLight::entry).collect(),
                bake: SettingsPatch::complete(&slot.settings),
            })
        };
        (0..10).filter_map(entry).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn slots_survive_project_files() {
        let camera = FlyCamera {
            position: Vec3::new(1.0, 2.0, 3.0),
            yaw_deg: 40.0,
            pitch_deg: -10.0,
            roll_deg: 5.0,
            fov_deg: 50.0,
        };
        let settings = Settings { seed: 7, ..Settings::default() };
        let mut slots = Slots::default();
        slots.set(3, Some(Slot { camera, lights: Vec::new(), settings: settings.clone() }));
        slots.set(12, None);
        assert_eq!(slots.digits().collect::<Vec<_>>(), [3]);
        let back = Slots::from_entries(&slots.entries());
        let slot = back.get(3).unwrap();
        assert_eq!(slot.settings, settings);
        assert!((slot.camera.position - camera.position).length() < 1e-5);
        assert!((slot.camera.yaw_deg - 40.0).abs() < 1e-3 && (slot.camera.roll_deg - 5.0).abs() < 1e-3);
        assert_eq!(back.get(4), None);
    }
}
