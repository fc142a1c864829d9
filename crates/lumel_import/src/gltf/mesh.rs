//! Meshes where their nodes place them.

use super::accessor::Accessors;
use super::document::Document;
use super::fault::Fault;
use super::instances::Instances;
use super::materials::Materials;
use super::morph::Morph;
use super::nodes::{Nodes, Placed};
use super::part::{Part, Source};
use super::pose::{Pose, Transform};
use super::skin::Skin;
use glam::DAffine3;
use lumel_scene::{ObjectMesh, Warnings};
use std::rc::Rc;

/// The largest number of triangles of a file. Many nodes may instance one mesh, so a few kilobytes can describe any
/// number.
const MAX_TRIANGLES: u64 = 1 << 27;

/// Each primitive counts as this many additional triangles: it takes time even if it has none.
const PRIMITIVE_COST: u64 = 64;

/// Each instance of an instanced node counts as this many additional triangles: it is an object of its own.
const INSTANCE_COST: u64 = 256;

/// Places meshes at their nodes.
pub(super) struct MeshReader<'a> {
    document: &'a Document,
    accessors: Accessors<'a>,
    materials: Materials<'a>,
    /// Skins that have been used.
    skins: Vec<Option<Rc<Skin>>>,
}

/// Where the objects of a node stand.
enum Stand {
    /// One object for each transform, world from mesh.
    Rigid(Vec<DAffine3>),
    /// One object where the joints put it; primitives without joints stand at the node.
    Skinned(Rc<Skin>, DAffine3),
}

impl<'a> MeshReader<'a> {
    pub(super) fn new(document: &'a Document, accessors: Accessors<'a>, materials: Materials<'a>) -> Self {
        let skins = vec![None; document.skins.len()];
        Self { document, accessors, materials, skins }
    }

    /// The materials in use.
    pub(super) fn into_materials(self) -> Materials<'a> {
        self.materials
    }

    /// The mesh at a node, once for each of its instances; none if it has no triangles.
    pub(super) fn objects_at(
        &mut self,
        placed: Placed,
        nodes: &mut Nodes,
        warnings: &mut Warnings,
    ) -> Result<Vec<ObjectMesh>, Fault> {
        let document = self.document;
        let node = &document.nodes[placed.node];
        let Some(index) = node.mesh.map(|mesh| mesh.value()) else { return Ok(Vec::new()) };
        let Some(mesh) = document.meshes.get(index) else {
            let label = document.node_label(placed.node);
            return Err(Fault::absent(label, "mesh", index, document.meshes.len()));
        };
        let mesh_label = document.mesh_label(index);
        let names = [&node.name, &mesh.name].into_iter().flatten();
        let name = names.into_iter().find(|name| !name.is_empty()).unwrap_or(&mesh_label);
        let stand = self.stand(placed, nodes, warnings)?;
        let mut objects = stand.objects(name);
        let density_factor = document.density_factors.get(placed.node).copied().flatten();
        objects.iter_mut().for_each(|object| object.density_factor = density_factor);
        let weights = node.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], Vec::as_slice);
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("{mesh_label}, primitive {number}");
            let source = Source { primitive, accessors: &self.accessors, place: &place };
            let Some(shape) = source.shape(&mesh_label, warnings)? else { continue };
            let material = primitive.material.map(|material| material.value());
            let material = self.materials.get(material, &place, warnings)?;
            let morph = Morph::new(document, index, number, weights, &place)?;
            let part = source.part(shape, material, &morph, warnings)?;
            for (i, object) in objects.iter_mut().enumerate() {
                part.append_to(object, &stand.pose(i, source, &part, warnings)?);
            }
        }
        objects.retain(|object| !object.faces.is_empty());
        Ok(objects)
    }

    fn stand(&mut self, placed: Placed, nodes: &mut Nodes, warnings: &mut Warnings) -> Result<Stand, Fault> {
        let instances = Instances::of(self.document, &self.accessors, placed.node)?;
        let Some(skin) = self.document.nodes[placed.node].skin else {
            let own = instances.map_or_else(|| Ok(vec![DAffine3::IDENTITY]), |all| all.transforms())?;
            return Ok(Stand::Rigid(own.into_iter().map(|own| placed.world * own).collect()));
        };
        let label = self.document.node_label(placed.node);
        if instances.is_some() {
            warnings.push(&label, "its mesh is skinned, so that joints place it: it is shown once");
        }
        let skin = skin.value();
        let known = self.skins.get(skin).and_then(Clone::clone);
        let skin = match known {
            Some(known) => known,
            None => {
                let new = Skin::new(self.document, &self.accessors, nodes, skin, &label, warnings)?;
                Rc::clone(self.skins[skin].insert(Rc::new(new)))
            }
        };
        Ok(Stand::Skinned(skin, placed.world))
    }

    /// Refuses scenes of excessive size before anything is allocated.
    pub(super) fn check_size(&self, placed: &[Placed]) -> Result<(), Fault> {
        let mut costs = vec![None; self.document.meshes.len()];
        let mut total = 0_u64;
        for node in placed.iter().map(|placed| placed.node) {
            let mesh = self.document.nodes[node].mesh.map(|mesh| mesh.value());
            let Some((mesh, cost)) = mesh.and_then(|mesh| Some((mesh, costs.get_mut(mesh)?))) else {
                continue;
            };
            let cost = match *cost {
                Some(cost) => cost,
                None => *cost.insert(self.cost(mesh)?),
            };
            let instances = Instances::of(self.document, &self.accessors, node)?;
            total = total.saturating_add(instances.map_or(cost, |instances| {
                cost.saturating_add(INSTANCE_COST).saturating_mul(instances.count() as u64)
            }));
            if total > MAX_TRIANGLES {
                let problem =
                    format!("with it, the scene has more than the {MAX_TRIANGLES} triangles lumel reads");
                return Err(Fault::at(self.document.node_label(node), problem));
            }
        }
        Ok(())
    }

    fn cost(&self, mesh: usize) -> Result<u64, Fault> {
        let label = self.document.mesh_label(mesh);
        let mut cost = 0_u64;
        for (number, primitive) in self.document.meshes[mesh].primitives.iter().enumerate() {
            let place = format!("{label}, primitive {number}");
            let corners = Source { primitive, accessors: &self.accessors, place: &place }.corners()?;
            let triangles = corners.and_then(|corners| corners.triangle_count());
            cost = cost.saturating_add(PRIMITIVE_COST).saturating_add(triangles.unwrap_or(0) as u64);
        }
        Ok(cost)
    }
}

impl Stand {
    /// Empty objects, numbered if there are several.
    fn objects(&self, name: &str) -> Vec<ObjectMesh> {
        let named = |name: String| ObjectMesh { name, ..ObjectMesh::default() };
        match self {
            Self::Rigid(worlds) if worlds.len() != 1 => {
                (1..=worlds.len()).map(|number| named(format!("{name} #{number}"))).collect()
            }
            _ => vec![named(name.to_owned())],
        }
    }

    /// The pose of a primitive in one of the objects.
    fn pose(
        &self,
        object: usize,
        source: Source<'_, '_>,
        part: &Part<'_>,
        warnings: &mut Warnings,
    ) -> Result<Pose, Fault> {
        let (skin, world) = match self {
            Self::Rigid(worlds) => return Ok(Pose::Rigid(worlds[object].into())),
            Self::Skinned(skin, world) => (skin, *world),
        };
        let Some(influences) = source.influences()? else {
            warnings.push(
                source.place,
                "a node shows it with a skin, but it has no JOINTS_0: the node places it",
            );
            return Ok(Pose::Rigid(world.into()));
        };
        let transforms = skin.transforms(&influences, part.vertices(), source.place, warnings)?;
        Ok(Pose::Skinned(transforms.into_iter().map(Transform::from).collect()))
    }
}

#[cfg(test)]
mod tests;
