//! The cameras and lights of a GLB file.

use super::binary::Binary;
use super::{add_node, mesh_node};
use glam::{Mat3, Quat, Vec3};
use lumel_scene::{Bounds, Camera, Light, PointLight, RectLight, Scene, SpotLight};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;
use std::io::{self, Write};

pub(super) const PUNCTUAL: &str = "KHR_lights_punctual";

/// How far rectangles lie in front of where they are, over the root of their area: those in the plane of a ceiling are seen.
const LIFT: f32 = 1e-3;

/// What is nearer to a camera than this share of the diagonal of the scene is not shown.
const NEAREST: f32 = 1e-3;

/// The least difference between the cones of a spot, radians: the format wants one.
const LEAST_PENUMBRA: f64 = 1e-6;

/// Where the lights are in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LampPlace {
    /// Among the surfaces.
    Scene,
    /// Those that are no surfaces are in a scene of their own: the surfaces show their light, and would be lit twice.
    Apart,
    /// Among the surfaces, but for rectangles, which are left out: surfaces have places in an atlas here.
    Unseen,
}

/// The rectangle lights that are surfaces, with their names.
pub(super) fn rectangles(scene: &Scene, place: LampPlace) -> impl Iterator<Item = (&str, &RectLight)> {
    named(scene).filter_map(move |(name, light)| match light {
        Light::Rect(rect) if place != LampPlace::Unseen && shines(light) && rect.normal().is_some() => {
            Some((name, rect))
        }
        _ => None,
    })
}

fn named(scene: &Scene) -> impl Iterator<Item = (&str, &Light)> {
    scene.light_names().iter().map(String::as_str).zip(scene.lights())
}

/// Rectangle lights as surfaces.
pub(super) struct Quads<'a> {
    scene: &'a Scene,
    lights: Vec<(&'a str, &'a RectLight)>,
}

/// Corners of one, texture coordinates of them, and its two triangles. The image's right is along the first half-edge.
const UVS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
const INDICES: [u32; 6] = [0, 1, 2, 0, 2, 3];

impl<'a> Quads<'a> {
    pub(super) fn of(scene: &'a Scene, place: LampPlace) -> Self {
        Self { scene, lights: rectangles(scene, place).collect() }
    }

    /// Adds a mesh and a node for each, of these materials.
    pub(super) fn add_to(&self, document: &mut Value, binary: &mut Binary, materials: &[usize]) {
        if self.lights.is_empty() {
            return;
        }
        let n = self.lights.len() as u64;
        let indices =
            binary.add_view(4 * INDICES.len() as u64, json!({ "target": super::primitive::INDICES }));
        let indices = binary.add_accessor(json!({
            "bufferView": indices, "componentType": super::primitive::U32, "type": "SCALAR", "count": INDICES.len(),
        }));
        let mut vertices = |width: u64| {
            let view = json!({ "target": super::primitive::VERTICES, "byteStride": 4 * width });
            binary.add_view(4 * n * 4 * width, view)
        };
        let views = [("POSITION", 3), ("NORMAL", 3), ("TEXCOORD_0", 2)]
            .map(|(name, width)| (name, width, vertices(width)));
        for (place, ((name, light), material)) in self.lights.iter().zip(materials).enumerate() {
            let mut attributes = json!({});
            for (attribute, width, view) in views {
                let accessor = binary.add_accessor(json!({
                    "bufferView": view, "byteOffset": place as u64 * 4 * 4 * width,
                    "componentType": super::primitive::F32, "type": format!("VEC{width}"), "count": 4,
                }));
                if attribute == "POSITION" {
                    let bounds = Bounds::around(corners(light));
                    binary.accessors[accessor]["min"] = json!(bounds.min.to_array());
                    binary.accessors[accessor]["max"] = json!(bounds.max.to_array());
                }
                attributes[attribute] = json!(accessor);
            }
            let primitive = json!({ "attributes": attributes, "indices": indices, "material": material });
            let Some(meshes) = document["meshes"].as_array_mut() else { return };
            meshes.push(json!({ "name": name, "primitives": [primitive] }));
            let mesh = meshes.len() - 1;
            add_node(document, 0, mesh_node(name, mesh, self.scene.origin()));
        }
    }

    /// Writes the numbers in the order of [`Self::add_to`].
    pub(super) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        if self.lights.is_empty() {
            return Ok(());
        }
        INDICES.iter().try_for_each(|index| out.write_all(&index.to_le_bytes()))?;
        let mut floats = |values: &[f32]| values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()));
        for (_, light) in &self.lights {
            corners(light).iter().try_for_each(|corner| floats(&corner.to_array()))?;
        }
        for (_, light) in &self.lights {
            let normal = light.normal().unwrap_or(Vec3::Y).to_array();
            UVS.iter().try_for_each(|_| floats(&normal))?;
        }
        self.lights.iter().try_for_each(|_| floats(UVS.as_flattened()))
    }
}

/// The corners of a rectangle, a little in front of it.
fn corners(light: &RectLight) -> [Vec3; 4] {
    let lift = light.normal().unwrap_or(Vec3::ZERO) * (LIFT * light.area().sqrt());
    light.corners().map(|corner| corner + lift)
}

/// Adds the cameras and their nodes.
pub(super) fn add_cameras(document: &mut Value, scene: &Scene) {
    let diagonal = (scene.bounds().max - scene.bounds().min).length();
    let nearest = if diagonal > 0.0 { NEAREST * diagonal } else { NEAREST };
    let mut cameras = Vec::new();
    for camera in scene.cameras() {
        let Camera { name, position, fov_y, .. } = camera;
        let Some([right, up, forward]) = camera.axes() else { continue };
        let rotation = Quat::from_mat3(&Mat3::from_cols(right, up, -forward)).normalize();
        let mut node = turned(name, scene, Some(*position), rotation);
        node["camera"] = json!(cameras.len());
        add_node(document, 0, node);
        let perspective = json!({ "yfov": fov_y, "znear": nearest });
        cameras.push(json!({ "name": name, "type": "perspective", "perspective": perspective }));
    }
    if !cameras.is_empty() {
        document["cameras"] = cameras.into();
    }
}

/// A node at a place that looks or shines along its -Z.
fn turned(name: &str, scene: &Scene, position: Option<Vec3>, rotation: Quat) -> Value {
    let mut node = json!({ "name": name, "rotation": rotation.to_array() });
    if let Some(position) = position {
        node["translation"] = json!((position.as_dvec3() + scene.origin()).to_array());
    }
    node
}

/// Adds the lights that the extension knows, and their nodes; whether there are any.
pub(super) fn add_lights(document: &mut Value, scene: &Scene, place: LampPlace) -> bool {
    let lights: Vec<(&str, Punctual)> =
        named(scene).filter_map(|(name, light)| Some((name, Punctual::of(light)?))).collect();
    if lights.is_empty() {
        return false;
    }
    let number = match place {
        LampPlace::Scene | LampPlace::Unseen => 0,
        LampPlace::Apart => {
            if let Some(scenes) = document["scenes"].as_array_mut() {
                scenes.push(json!({ "name": "lights", "nodes": [] }));
            }
            1
        }
    };
    for (index, (name, light)) in lights.iter().enumerate() {
        let rotation = Quat::from_rotation_arc(Vec3::NEG_Z, light.direction).normalize();
        let mut node = turned(name, scene, light.position, rotation);
        node["extensions"] = json!({ PUNCTUAL: { "light": index } });
        add_node(document, number, node);
    }
    let all: Vec<Value> = lights.iter().map(|(name, light)| light.described(name)).collect();
    document["extensions"] = json!({ PUNCTUAL: { "lights": all } });
    true
}

/// The names of lights that the file has no counterpart of.
pub(super) fn left_out(scene: &Scene, place: LampPlace) -> Vec<&str> {
    let is_left_out = |light: &Light| match light {
        Light::Disk(_) => true,
        Light::Rect(_) => place == LampPlace::Unseen,
        _ => false,
    };
    let lights = named(scene).filter(|(_, light)| is_left_out(light) && shines(light));
    let sky = scene.sky().uniform().is_none_or(|radiance| !radiance.is_zero()).then_some("sky");
    lights.map(|(name, _)| name).chain(sky).collect()
}

fn shines(light: &Light) -> bool {
    light.strength() != Vec3::ZERO
}

/// A light as the extension has it.
struct Punctual {
    kind: &'static str,
    position: Option<Vec3>,
    direction: Vec3,
    strength: Vec3,
    range: f32,
    cones: Option<[f64; 2]>,
}

impl Punctual {
    /// `None` for one that has no counterpart, or does not shine.
    fn of(light: &Light) -> Option<Self> {
        let sun = |direction: Vec3| Self {
            kind: "directional",
            position: None,
            direction,
            strength: light.strength(),
            range: f32::INFINITY,
            cones: None,
        };
        let point = |point: &PointLight| Self {
            kind: "point",
            position: Some(point.position),
            strength: point.intensity,
            range: point.range,
            ..sun(Vec3::NEG_Z)
        };
        let found = match light {
            Light::Rect(_) | Light::Disk(_) => return None,
            Light::Directional(light) => sun(light.direction),
            Light::Sun(light) => sun(light.parallel.direction),
            Light::Point(light) => point(light),
            Light::Sphere(sphere) => {
                let (position, intensity) = (sphere.center, sphere.intensity());
                point(&PointLight { position, intensity, range: f32::INFINITY })
            }
            Light::Spot(SpotLight { point: of, direction, cos_inner, cos_outer }) => {
                let outer = f64::from(*cos_outer).acos().min(FRAC_PI_2);
                let inner = f64::from(*cos_inner).acos().min(outer - LEAST_PENUMBRA).max(0.0);
                Self { kind: "spot", direction: *direction, cones: Some([inner, outer]), ..point(of) }
            }
        };
        shines(light).then_some(found)
    }

    fn described(&self, name: &str) -> Value {
        let intensity = self.strength.max_element();
        let color = (self.strength / intensity).to_array();
        let mut json = json!({ "name": name, "type": self.kind, "color": color, "intensity": intensity });
        if self.range.is_finite() {
            json["range"] = json!(self.range);
        }
        if let Some([inner, outer]) = self.cones {
            json["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        }
        json
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones_of_a_hemisphere_are_within_the_range_of_the_format() {
        let point = PointLight { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        let wide = SpotLight { point, direction: Vec3::X, cos_inner: 1.0, cos_outer: -4e-8 };
        let [inner, outer] = Punctual::of(&Light::Spot(wide)).unwrap().cones.unwrap();
        assert!(inner == 0.0 && outer <= FRAC_PI_2, "{inner} {outer}");
    }
}
