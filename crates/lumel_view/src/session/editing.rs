//! Changing lights, albedos, views and slots.

use super::Session;
use super::edit::Edit;
use crate::lights::{EditLight, default_name};
use crate::notice::Level;
use crate::sky;
use crate::slots::Slot;
use glam::Vec3;
use lumel::{LightKind, RectLight};
use lumel_scene::Radiance;

/// Half-edge of a new light, as a share of the scene's diagonal.
const NEW_LIGHT: f32 = 0.05;

/// Radiance of a new light times the square of the diagonal over its area: bright enough for any size of scene.
const NEW_POWER: f32 = 0.15;

/// Irradiance from a new sun, W·m⁻²: twice what a new sky brings.
const SUNSHINE: Vec3 = Vec3::new(5.0, 5.0, 4.5);

/// Where a new sun shines: down, from a side.
const NEW_SUN: Vec3 = Vec3::new(-1.0, -2.0, -1.0);

impl Session {
    pub(super) fn edit(&self) -> Edit {
        Edit {
            lights: self.lights.clone(),
            sky: self.sky.clone(),
            albedos: self.albedos.clone(),
            active: self.active,
            slots: self.slots.clone(),
        }
    }

    fn put(&mut self, edit: Edit) {
        (self.lights, self.active, self.slots) = (edit.lights, edit.active, edit.slots);
        (self.albedos, self.sky) = (edit.albedos, edit.sky);
    }

    /// The active light.
    pub fn active_light(&mut self) -> Option<&mut EditLight> {
        self.lights.get_mut(self.active)
    }

    /// Sets the albedo of all materials of a name.
    pub fn repaint(&mut self, material: &str, albedo: Vec3) {
        let Some(document) = &self.document else { return };
        for (old, _) in
            self.albedos.iter_mut().zip(document.scene.materials()).filter(|(_, m)| m.name == material)
        {
            *old = albedo;
        }
    }

    /// Puts the active light where the camera is, facing where it looks; makes one if there is none.
    pub fn place_light(&mut self) {
        if self.lights.is_empty() {
            self.add_light();
            return;
        }
        let (position, axes) = self.camera_axes();
        if let Some(light) = self.active_light() {
            light.place(position, axes);
            light.on = true;
            let text = format!("Placed {} at the camera", light.name);
            self.notices.push(Level::Info, text);
        }
    }

    fn camera_axes(&self) -> (Vec3, [Vec3; 3]) {
        let camera = &self.camera;
        (camera.position, [camera.right(), camera.up(), camera.forward()])
    }

    /// Adds a rectangle where the camera is and makes it the active light.
    pub fn add_light(&mut self) {
        self.add_light_of(LightKind::Rect);
    }

    /// Adds a light where the camera is, a sun above the scene, and makes it the active one.
    pub fn add_light_of(&mut self, kind: LightKind) {
        let Some(document) = &self.document else {
            self.notices.push(Level::Warning, "Open a scene first");
            return;
        };
        let half = NEW_LIGHT * document.diagonal();
        let radiance =
            self.lights.get(self.active).filter(|light| light.kind() == LightKind::Rect).map_or_else(
                || Radiance::splat(NEW_POWER / (4.0 * NEW_LIGHT * NEW_LIGHT)),
                |light| light.rect.radiance,
            );
        let rect =
            RectLight { center: Vec3::ZERO, u: Vec3::X * half, v: Vec3::Y * half, radiance, texture: None };
        let mut light = EditLight::new(self.unused_name(), rect);
        let (position, axes) = self.camera_axes();
        light.place(position, axes);
        light.rect.radiance.0 = match kind {
            LightKind::Rect | LightKind::Disk => radiance.0,
            // As bright as the rectangle.
            LightKind::Point | LightKind::Spot => radiance.0 * rect.area(),
            LightKind::Sun => SUNSHINE,
        };
        light.set_kind(kind);
        let place = if kind == LightKind::Sun {
            let bounds = document.scene.bounds();
            light.rect.center = bounds.center().with_y(bounds.max.y + 0.2 * document.diagonal());
            light.aim_at(light.rect.center + NEW_SUN);
            "above the scene"
        } else {
            "at the camera"
        };
        let text = format!("Placed {} {place}", light.name);
        self.lights.push(light);
        self.active = self.lights.len() - 1;
        self.notices.push(Level::Info, text);
    }

    /// Lights the scene from a clear sky.
    pub fn use_sky(&mut self) {
        self.sky = sky::clear().into();
    }

    /// Turns the active light towards a point.
    pub fn aim_light(&mut self, at: Vec3) {
        let Some(light) = self.active_light() else {
            self.notices.push(Level::Warning, "There is no light to aim");
            return;
        };
        light.aim_at(at);
        let text = format!("Aimed {}", light.name);
        self.notices.push(Level::Info, text);
    }

    fn unused_name(&self) -> String {
        let taken = |name: &String| self.lights.iter().any(|light| light.name == *name);
        (0..).map(default_name).find(|name| !taken(name)).unwrap_or_default()
    }

    /// Removes the active light.
    pub fn remove_light(&mut self) {
        if self.active < self.lights.len() {
            let light = self.lights.remove(self.active);
            self.active = self.active.min(self.lights.len().saturating_sub(1));
            self.notices.push(Level::Info, format!("Removed {}; undo with Ctrl+Z", light.name));
        }
    }

    /// Hides the active light or shows it again; a hidden light does not shine.
    pub fn toggle_light(&mut self) {
        if let Some(light) = self.active_light() {
            light.on = !light.on;
        }
    }

    /// Makes the next light the active one.
    pub fn next_light(&mut self) {
        if !self.lights.is_empty() {
            self.active = (self.active + 1) % self.lights.len();
        }
    }

    /// Keeps camera, lights and settings under a digit.
    pub fn save_slot(&mut self, digit: u8) {
        if self.document.is_none() {
            return;
        }
        let slot = Slot { camera: self.camera, lights: self.lights.clone(), settings: self.settings.clone() };
        self.slots.set(digit, Some(slot));
        self.notices.push(Level::Info, format!("Saved camera, lights and settings to slot {digit}"));
    }

    /// Recalls camera, lights and settings.
    pub fn recall_slot(&mut self, digit: u8) {
        let Some(slot) = self.slots.get(digit).cloned() else {
            self.notices.push(Level::Warning, format!("Slot {digit} is empty: save to it with Alt+{digit}"));
            return;
        };
        // Slots of a project file name the images of textures; lights that are there have them.
        let textures: Vec<_> =
            self.lights.iter().filter_map(|l| Some((l.texture_path.clone()?, l.rect.texture?))).collect();
        self.camera = slot.camera;
        self.lights = slot.lights;
        for light in self.lights.iter_mut().filter(|light| light.rect.texture.is_none()) {
            let known = textures.iter().find(|(path, _)| Some(path) == light.texture_path.as_ref());
            light.rect.texture = known.map(|(_, texture)| *texture);
        }
        self.active = self.active.min(self.lights.len().saturating_sub(1));
        self.settings = slot.settings;
        self.notices.push(Level::Info, format!("Recalled slot {digit}"));
    }

    /// Undoes the last change of lights, albedos or slots.
    pub fn undo(&mut self) {
        self.history.commit(&self.edit());
        match self.history.undo() {
            Some(edit) => self.put(edit),
            None => self.notices.push(Level::Info, "Nothing to undo"),
        }
    }

    /// Redoes the last undone change.
    pub fn redo(&mut self) {
        match self.history.redo() {
            Some(edit) => self.put(edit),
            None => self.notices.push(Level::Info, "Nothing to redo"),
        }
    }

    /// Whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Whether there is something to redo.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Whether lights or slots differ from what was opened or saved.
    pub fn has_unsaved_edits(&self) -> bool {
        self.document.is_some() && self.edit() != self.saved_edit
    }

    pub(super) fn edits_are_saved(&mut self) {
        self.saved_edit = self.edit();
    }

    /// Shows the scene from where it was opened.
    pub fn reset_camera(&mut self) {
        if let Some(document) = &self.document {
            self.camera = document.home;
        }
    }
}
