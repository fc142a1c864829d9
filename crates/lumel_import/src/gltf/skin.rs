//! Skins: joints that carry the vertices of a mesh.
//!
//! Khronos Group, *glTF 2.0 Specification*, 3.7.3. The node of a skinned mesh does not place it; its joints do.

use super::accessor::{Accessors, Elements};
use super::document::{Document, label};
use super::fault::Fault;
use super::nodes::Nodes;
use glam::{DAffine3, DMat3, DVec3};
use lumel_scene::Warnings;

/// A skin at rest.
pub(super) struct Skin {
    /// As messages name it.
    label: String,
    /// World from mesh, as each joint has it.
    joints: Vec<DAffine3>,
}

/// Joints and weights of a primitive's vertices, in sets of four.
pub(super) struct Influences<'a>(Vec<[Elements<'a>; 2]>);

impl Skin {
    /// The skin that `user`, a node, asks for.
    pub(super) fn new(
        document: &Document,
        accessors: &Accessors<'_>,
        nodes: &mut Nodes,
        index: usize,
        user: &str,
        warnings: &mut Warnings,
    ) -> Result<Self, Fault> {
        let Some(skin) = document.skins.get(index) else {
            return Err(Fault::absent(user, "skin", index, document.skins.len()));
        };
        let label = label("skin", index, skin.name.as_deref());
        if skin.joints.is_empty() {
            return Err(Fault::at(label, "it has no joints"));
        }
        let inverse = skin.inverse_bind_matrices.map(|accessor| {
            let place = format!("{label}, inverseBindMatrices");
            let elements = accessors.elements(accessor.value(), &place)?;
            let problem = if elements.width() != 16 {
                format!("accessor {accessor} has {} components where a matrix has 16", elements.width())
            } else if elements.count() < skin.joints.len() {
                format!("accessor {accessor} has {} for {} joints", elements.count(), skin.joints.len())
            } else {
                return Ok(elements);
            };
            Err(Fault::at(place, problem))
        });
        let inverse = inverse.transpose()?;
        let mut joints = Vec::with_capacity(skin.joints.len());
        for (number, joint) in skin.joints.iter().map(|joint| joint.value()).enumerate() {
            if joint >= document.nodes.len() {
                return Err(Fault::absent(&label, "node", joint, document.nodes.len()));
            }
            let bind = inverse.map_or(DAffine3::IDENTITY, |elements| affine(elements.vector(number)));
            let transform = nodes.world(document, joint, warnings)? * bind;
            if !transform.is_finite() {
                let problem = format!("the transform of joint {number} is not a finite number");
                return Err(Fault::at(&label, problem));
            }
            joints.push(transform);
        }
        Ok(Self { label, joints })
    }

    /// World from mesh for each of these vertices of a primitive: the mean of its joints, by weight.
    pub(super) fn transforms(
        &self,
        influences: &Influences<'_>,
        vertices: &[u32],
        place: &str,
        warnings: &mut Warnings,
    ) -> Result<Vec<DAffine3>, Fault> {
        let mut n_loose = 0_usize;
        let mut blend = |&vertex: &u32| {
            let (mut sum, mut total) = (DAffine3::from_mat3(DMat3::ZERO), 0.0);
            // Rounding leaves weights just below zero.
            for (joint, weight) in
                influences.of(vertex as usize).filter(|(_, weight)| *weight > 0.0 || weight.is_nan())
            {
                if !weight.is_finite() {
                    return Err(Fault::at(place, format_args!("vertex {vertex} has the weight {weight}")));
                }
                let transform = self.joint(joint, vertex, place)?;
                sum.matrix3 += transform.matrix3 * weight;
                sum.translation += transform.translation * weight;
                total += weight;
            }
            if total > 0.0 {
                return Ok(DAffine3 { matrix3: sum.matrix3 / total, translation: sum.translation / total });
            }
            n_loose += 1;
            influences
                .of(vertex as usize)
                .next()
                .map_or(Ok(self.joints[0]), |(joint, _)| self.joint(joint, vertex, place))
        };
        let transforms = vertices.iter().map(&mut blend).collect();
        if n_loose > 0 {
            warnings.push(place, format!("{n_loose} vertices without weights follow their first joint"));
        }
        transforms
    }

    fn joint(&self, joint: u32, vertex: u32, place: &str) -> Result<DAffine3, Fault> {
        self.joints.get(joint as usize).copied().ok_or_else(|| {
            let (n, skin) = (self.joints.len(), &self.label);
            Fault::at(place, format_args!("vertex {vertex} refers to joint {joint} of {n} in {skin}"))
        })
    }
}

impl<'a> Influences<'a> {
    /// Those in these sets of `JOINTS_n` and `WEIGHTS_n`, which have been checked for count and width.
    pub(super) fn new(sets: Vec<[Elements<'a>; 2]>) -> Self {
        Self(sets.into_iter().map(|[joints, weights]| [joints, weights.normalized()]).collect())
    }

    fn of(&self, vertex: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.0.iter().flat_map(move |[joints, weights]| {
            let weights = weights.vector::<4>(vertex).map(f64::from);
            joints.indices::<4>(vertex).into_iter().zip(weights)
        })
    }
}

/// A matrix stored column by column; its last row, 0 0 0 1, is not looked at.
fn affine(m: [f32; 16]) -> DAffine3 {
    let column = |c: usize| DVec3::new(m[c].into(), m[c + 1].into(), m[c + 2].into());
    DAffine3 { matrix3: DMat3::from_cols(column(0), column(4), column(8)), translation: column(12) }
}

#[cfg(test)]
mod tests;
