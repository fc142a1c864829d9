//! Where the nodes of the scene are.

use super::document::Document;
use super::fault::Fault;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf_json::Node;
use lumel_scene::Warnings;

/// A node of the scene in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    /// Index of the node.
    pub(super) node: usize,
    /// World from node.
    pub(super) world: DAffine3,
}

/// All nodes of the scene, parents before their children, otherwise in the order of the file.
///
/// The whole file's nodes must form trees, those outside the scene included. Depth is limited by memory only.
pub(super) fn place_all(document: &Document, warnings: &mut Warnings) -> Result<Vec<Placed>, Fault> {
    let parents = parents(document)?;
    refuse_cycles(document, &parents)?;
    let all_roots = || (0..parents.len()).filter(|&node| parents[node].is_none()).collect();
    let roots = document.roots.clone().unwrap_or_else(all_roots);
    let mut placed = Vec::new();
    let mut seen = vec![false; parents.len()];
    let mut waiting = Vec::new();
    for root in roots {
        if root >= parents.len() {
            return Err(Fault::absent("scene", "node", root, parents.len()));
        }
        waiting.push((root, DAffine3::IDENTITY));
        while let Some((node, parent)) = waiting.pop() {
            if std::mem::replace(&mut seen[node], true) {
                return Err(Fault::at(document.node_label(node), "it is in the scene twice"));
            }
            let world = parent * local(document, node, warnings)?;
            placed.push(Placed { node, world });
            waiting.extend(children(&document.nodes[node]).rev().map(|child| (child, world)));
        }
    }
    Ok(placed)
}

fn children(node: &Node) -> impl DoubleEndedIterator<Item = usize> + '_ {
    node.children.iter().flatten().map(|child| child.value())
}

fn parents(document: &Document) -> Result<Vec<Option<usize>>, Fault> {
    let mut parents = vec![None; document.nodes.len()];
    for (parent, node) in document.nodes.iter().enumerate() {
        for child in children(node) {
            let Some(slot) = parents.get_mut(child) else {
                return Err(Fault::absent(document.node_label(parent), "node", child, document.nodes.len()));
            };
            if let Some(other) = slot.replace(parent) {
                let (first, second) = (document.node_label(other), document.node_label(parent));
                let problem = format!("it has two parents: {first} and {second}");
                return Err(Fault::at(document.node_label(child), problem));
            }
        }
    }
    Ok(parents)
}

/// With one parent each, nodes form a cycle exactly where going up never ends.
fn refuse_cycles(document: &Document, parents: &[Option<usize>]) -> Result<(), Fault> {
    // The walk in which a node was first met; meeting it again in the same walk closes a circle.
    let mut walk_of = vec![usize::MAX; parents.len()];
    for start in 0..parents.len() {
        let mut next = Some(start);
        while let Some(node) = next {
            if walk_of[node] == start {
                return Err(Fault::at(document.node_label(node), "it is its own ancestor"));
            }
            if walk_of[node] != usize::MAX {
                break;
            }
            walk_of[node] = start;
            next = parents[node];
        }
    }
    Ok(())
}

/// A node's own transform: its matrix, or translation, rotation and scale.
fn local(document: &Document, index: usize, warnings: &mut Warnings) -> Result<DAffine3, Fault> {
    let node = &document.nodes[index];
    let transform = if let Some(matrix) = node.matrix {
        let column = |c: usize| DVec3::new(matrix[c].into(), matrix[c + 1].into(), matrix[c + 2].into());
        if [matrix[3], matrix[7], matrix[11], matrix[15]] != [0.0, 0.0, 0.0, 1.0] {
            warnings.push(
                document.node_label(index),
                "its matrix has a last row other than 0 0 0 1, which is ignored",
            );
        }
        DAffine3 { matrix3: DMat3::from_cols(column(0), column(4), column(8)), translation: column(12) }
    } else {
        let vector = |v: Option<[f32; 3]>, absent| v.map_or(absent, |v| DVec3::from(v.map(f64::from)));
        let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
        // Rounded quaternions are a little off unit length; zero has no direction at all.
        let rotation = match rotation.length() {
            length if length > 0.0 && length.is_finite() => rotation / length,
            _ => {
                warnings.push(document.node_label(index), "its rotation is zero and is ignored");
                DQuat::IDENTITY
            }
        };
        let (scale, translation) = (vector(node.scale, DVec3::ONE), vector(node.translation, DVec3::ZERO));
        DAffine3::from_scale_rotation_translation(scale, rotation, translation)
    };
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(Fault::at(document.node_label(index), "its transform is not a finite number"))
    }
}
