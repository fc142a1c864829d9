//! Instances of a mesh at one node: the extension `EXT_mesh_gpu_instancing`.

use super::accessor::{Accessors, Elements};
use super::document::Document;
use super::fault::Fault;
use glam::{DAffine3, DQuat, DVec3};
use serde_json::Value;

const NAME: &str = "EXT_mesh_gpu_instancing";

/// The transforms of a node's instances, relative to the node.
pub(super) struct Instances<'a> {
    /// As messages name them.
    place: String,
    count: usize,
    translation: Option<Elements<'a>>,
    rotation: Option<Elements<'a>>,
    scale: Option<Elements<'a>>,
}

impl<'a> Instances<'a> {
    /// The instances of a node; `None` if it is not instanced.
    pub(super) fn of(
        document: &Document,
        accessors: &Accessors<'a>,
        node: usize,
    ) -> Result<Option<Self>, Fault> {
        let extensions = document.nodes[node].extensions.as_ref();
        let Some(extension) = extensions.and_then(|e| e.others.get(NAME)) else { return Ok(None) };
        let place = format!("{}, {NAME}", document.node_label(node));
        let attributes = extension.get("attributes").and_then(Value::as_object);
        let Some(attributes) = attributes.filter(|attributes| !attributes.is_empty()) else {
            return Err(Fault::at(place, "it has no \"attributes\""));
        };
        let mut instances = Self { place, count: 0, translation: None, rotation: None, scale: None };
        let mut count = None;
        for (name, accessor) in attributes {
            let place = format!("{}, {name}", instances.place);
            let index = accessor.as_u64().and_then(|index| usize::try_from(index).ok());
            let index = index.ok_or_else(|| Fault::at(&place, "it is not the index of an accessor"))?;
            let elements = accessors.elements(index, &place)?;
            let n = elements.count();
            let expected = *count.get_or_insert(n);
            if n != expected {
                let problem = format!("accessor {index} has {n} elements where others have {expected}");
                return Err(Fault::at(place, problem));
            }
            let (slot, width) = match name.as_str() {
                "TRANSLATION" => (&mut instances.translation, 3),
                "ROTATION" => (&mut instances.rotation, 4),
                "SCALE" => (&mut instances.scale, 3),
                _ => continue,
            };
            if elements.width() != width {
                let problem = format!("accessor {index} has {} components, not {width}", elements.width());
                return Err(Fault::at(place, problem));
            }
            *slot = Some(elements);
        }
        instances.count = count.unwrap_or(0);
        // Integers that make a quaternion are fractions, whatever the flag says.
        instances.rotation = instances.rotation.map(Elements::normalized);
        Ok(Some(instances))
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Node from mesh, for each instance.
    pub(super) fn transforms(&self) -> Result<Vec<DAffine3>, Fault> {
        (0..self.count).map(|i| self.transform(i)).collect()
    }

    fn transform(&self, i: usize) -> Result<DAffine3, Fault> {
        let vector = |elements: &Option<Elements<'a>>, absent| {
            elements.map_or(absent, |elements| DVec3::from(elements.vector::<3>(i).map(f64::from)))
        };
        let rotation = self
            .rotation
            .map_or(DQuat::IDENTITY, |elements| DQuat::from_array(elements.vector::<4>(i).map(f64::from)));
        let length = rotation.length();
        let (scale, translation) = (vector(&self.scale, DVec3::ONE), vector(&self.translation, DVec3::ZERO));
        let transform = DAffine3::from_scale_rotation_translation(scale, rotation / length, translation);
        if length > 0.0 && transform.is_finite() {
            return Ok(transform);
        }
        let problem = if length == 0.0 { "has a rotation of zero" } else { "is not a finite transform" };
        Err(Fault::at(&self.place, format_args!("instance {i} {problem}")))
    }
}

#[cfg(test)]
mod tests;
