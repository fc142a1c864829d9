//! Layers of single lights: which emitters belong to which.

use crate::settings::Settings;
use lumel_scene::Scene;
use lumel_transport::{Emitter, EmitterMask, EmitterSampling};

/// The name of the sky's layer.
const SKY: &str = "sky";

/// Emitters that share a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LightLayer {
    /// Their name.
    pub name: String,
    /// The emitters.
    pub emitters: Vec<Emitter>,
}

/// The layers of a scene in the order of its lights, then the sky, then emissive materials; each emitter is in one.
///
/// Lights are called by their [names](Scene::light_names), the sky "sky", surfaces by their material, or "material 1",
/// "material 2" and so on by its place where that has no name. Emissive surfaces that the settings ignore have no layer.
pub fn light_layers(scene: &Scene, settings: &Settings) -> Vec<LightLayer> {
    let mut layers: Vec<LightLayer> = Vec::new();
    for emitter in Emitter::all(scene) {
        if settings.emitters == EmitterSampling::Off && matches!(emitter, Emitter::Surfaces(_)) {
            continue;
        }
        let name = name(scene, emitter);
        match layers.iter_mut().find(|layer| layer.name == name) {
            Some(layer) => layer.emitters.push(emitter),
            None => layers.push(LightLayer { name, emitters: vec![emitter] }),
        }
    }
    layers
}

fn name(scene: &Scene, emitter: Emitter) -> String {
    match emitter {
        Emitter::Light(light) => scene.light_names()[light as usize].clone(),
        Emitter::Sky => SKY.to_owned(),
        Emitter::Surfaces(material) => match scene.materials()[material.index()].name.as_str() {
            "" => format!("material {}", material.index() + 1),
            name => name.to_owned(),
        },
    }
}

/// What shines in each layer.
pub(crate) fn masks(scene: &Scene, settings: &Settings) -> Vec<EmitterMask> {
    light_layers(scene, settings).iter().map(|layer| EmitterMask::only(scene, &layer.emitters)).collect()
}
