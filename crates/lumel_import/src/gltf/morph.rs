//! Morph targets: differences of attributes, added by weight.
//!
//! Khronos Group, *glTF 2.0 Specification*, 3.7.2.2.

use super::accessor::{Accessors, Elements};
use super::document::{Document, typed};
use super::fault::Fault;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Accessors of the differences of one target, by attribute.
type Target = BTreeMap<String, u32>;

/// The morph targets of a file: by mesh, primitive and target.
#[derive(Debug, Default)]
pub(super) struct MorphTargets(Vec<Vec<Vec<Target>>>);

impl MorphTargets {
    /// Takes them out of the meshes of a document, because the types of the schema know some attributes only.
    pub(super) fn take(root: &mut Map<String, Value>) -> Result<Self, Fault> {
        let meshes = root.get_mut("meshes").and_then(Value::as_array_mut).into_iter().flatten();
        let of_primitive = |place: String, primitive: &mut Value| {
            let targets = primitive.as_object_mut().and_then(|p| p.remove("targets"));
            match targets {
                None | Some(Value::Null) => Ok(Vec::new()),
                Some(targets) => typed(targets, &place),
            }
        };
        let of_mesh = |(number, mesh): (usize, &mut Value)| {
            let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut).into_iter().flatten();
            let place = |i| format!("mesh {number}, primitive {i}, targets");
            primitives.enumerate().map(|(i, primitive)| of_primitive(place(i), primitive)).collect()
        };
        meshes.enumerate().map(of_mesh).collect::<Result<_, _>>().map(Self)
    }

    fn of(&self, mesh: usize, primitive: usize) -> &[Target] {
        self.0.get(mesh).and_then(|mesh| mesh.get(primitive)).map_or(&[], Vec::as_slice)
    }
}

/// The targets of a primitive that count, with their weights.
pub(super) struct Morph<'a> {
    targets: Vec<(f32, &'a Target)>,
}

impl<'a> Morph<'a> {
    /// The morph of a primitive at these weights: those of the node, else of the mesh.
    pub(super) fn new(
        document: &'a Document,
        mesh: usize,
        primitive: usize,
        weights: &[f32],
        place: &str,
    ) -> Result<Self, Fault> {
        if weights.iter().all(|&weight| weight == 0.0) {
            return Ok(Self { targets: Vec::new() });
        }
        let targets = document.targets.of(mesh, primitive);
        if targets.len() != weights.len() {
            let problem = format!("it has {} morph targets for {} weights", targets.len(), weights.len());
            return Err(Fault::at(place, problem));
        }
        if let Some(weight) = weights.iter().find(|weight| !weight.is_finite()) {
            return Err(Fault::at(place, format_args!("a morph target has the weight {weight}")));
        }
        let all = weights.iter().copied().zip(targets);
        Ok(Self { targets: all.filter(|(weight, _)| *weight != 0.0).collect() })
    }

    /// An attribute with its differences.
    pub(super) fn of<'e>(
        &self,
        base: Elements<'e>,
        name: &str,
        accessors: &Accessors<'e>,
        place: &str,
    ) -> Result<Morphed<'e>, Fault> {
        let of_target = |(weight, target): &(f32, &Target)| {
            let accessor = *target.get(name)?;
            let place = format!("{place}, morph target's {name}");
            Some(accessors.elements(accessor as usize, &place).and_then(|elements| {
                let problem = if elements.count() != base.count() {
                    format!("has {} elements for {} vertices", elements.count(), base.count())
                } else if elements.width().min(3) != base.width().min(3) {
                    format!("has {} components", elements.width())
                } else {
                    return Ok((
                        *weight,
                        if base.is_normalized() { elements.normalized() } else { elements },
                    ));
                };
                Err(Fault::at(place, format_args!("accessor {accessor} {problem}")))
            }))
        };
        let differences = self.targets.iter().filter_map(of_target).collect::<Result<_, _>>()?;
        Ok(Morphed { base, differences })
    }
}

/// An attribute to which differences are added.
pub(super) struct Morphed<'a> {
    base: Elements<'a>,
    differences: Vec<(f32, Elements<'a>)>,
}

impl Morphed<'_> {
    /// A vertex's first `N` components. `i` must be less than the number of vertices.
    pub(super) fn vector<const N: usize>(&self, i: usize) -> [f32; N] {
        let mut sum = self.base.vector::<N>(i);
        for (weight, difference) in &self.differences {
            sum.iter_mut().zip(difference.vector::<N>(i)).for_each(|(sum, d)| *sum += weight * d);
        }
        sum
    }

    /// Whether the base has a fourth component.
    pub(super) fn has_fourth(&self) -> bool {
        self.base.width() == 4
    }

    /// A vertex's fourth component, where the base has one.
    pub(super) fn fourth(&self, i: usize) -> f32 {
        let with_fourth = self.differences.iter().filter(|(_, difference)| difference.width() == 4);
        let moved: f32 = with_fourth.map(|(weight, d)| weight * d.vector::<4>(i)[3]).sum();
        self.base.vector::<4>(i)[3] + moved
    }
}

#[cfg(test)]
mod tests;
