//! World transforms of nodes.

use super::document::Document;
use super::fault::Fault;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf_json::Node;
use lumel_scene::Warnings;

/// A node of the scene, relative to its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    /// Index of the node.
    pub(super) node: usize,
    /// World from node.
    pub(super) world: DAffine3,
    /// Whether its mesh and its light are shown: KHR_node_visibility hides a node and all below it.
    pub(super) visible: bool,
}

/// Where the nodes of a file stand.
pub(super) struct Nodes {
    /// The nodes of the scene, parents before their children, otherwise in the order of the file.
    pub(super) placed: Vec<Placed>,
    parents: Vec<Option<usize>>,
    /// World from what stands in no node.
    root: DAffine3,
    /// World from node, where it is known.
    worlds: Vec<Option<DAffine3>>,
}

impl Nodes {
    /// World from node, whether it is in the scene or not.
    pub(super) fn world(
        &mut self,
        document: &Document,
        node: usize,
        warnings: &mut Warnings,
    ) -> Result<DAffine3, Fault> {
        let (mut world, mut chain) = (self.root, Vec::new());
        let mut next = Some(node);
        while let Some(node) = next {
            if let Some(known) = self.worlds[node] {
                world = known;
                break;
            }
            chain.push(node);
            next = self.parents[node];
        }
        for node in chain.into_iter().rev() {
            world *= local(document, node, warnings)?;
            self.worlds[node] = Some(world);
        }
        Ok(world)
    }
}

/// Places all nodes of the scene relative to its origin.
///
/// The whole file's nodes must form trees, those outside the scene included. Depth is limited by memory only.
pub(super) fn place_all(document: &Document, origin: DVec3, warnings: &mut Warnings) -> Result<Nodes, Fault> {
    let parents = parents(document)?;
    refuse_cycles(document, &parents)?;
    let all_roots = || (0..parents.len()).filter(|&node| parents[node].is_none()).collect();
    let roots = document.roots.clone().unwrap_or_else(all_roots);
    let mut placed = Vec::new();
    let mut worlds = vec![None; parents.len()];
    let mut waiting = Vec::new();
    let from_world = DAffine3::from_translation(DVec3::ZERO - origin);
    for root in roots {
        if root >= parents.len() {
            return Err(Fault::absent("scene", "node", root, parents.len()));
        }
        waiting.push((root, from_world, true));
        while let Some((node, parent, visible)) = waiting.pop() {
            if worlds[node].is_some() {
                return Err(Fault::at(document.node_label(node), "it is in the scene twice"));
            }
            let world = parent * local(document, node, warnings)?;
            worlds[node] = Some(world);
            let visible = visible && !hides(&document.nodes[node]);
            placed.push(Placed { node, world, visible });
            waiting.extend(children(&document.nodes[node]).rev().map(|child| (child, world, visible)));
        }
    }
    Ok(Nodes { placed, parents, root: from_world, worlds })
}

/// Whether a node hides itself and all below it.
fn hides(node: &Node) -> bool {
    let extension = node.extensions.as_ref().and_then(|e| e.others.get("KHR_node_visibility"));
    extension.and_then(|e| e.get("visible")?.as_bool()) == Some(false)
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

/// With one parent each, nodes form a cycle exactly if following parents never ends.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::testing::{Model, text};
    use serde_json::{Value, json};

    fn place(nodes: Value, scenes: Value) -> Result<(Vec<Placed>, Warnings), String> {
        let mut model = Model::empty();
        model.json["nodes"] = nodes;
        model.json["scenes"] = scenes;
        let mut warnings = Warnings::default();
        let json = serde_json::to_vec(&model.json).unwrap();
        let document = Document::parse(&json, &mut warnings).map_err(|fault| fault.to_string())?;
        let nodes = place_all(&document, DVec3::ZERO, &mut warnings).map_err(|fault| fault.to_string())?;
        Ok((nodes.placed, warnings))
    }

    fn order(nodes: Value, scenes: Value) -> Result<Vec<usize>, String> {
        place(nodes, scenes).map(|(placed, _)| placed.iter().map(|p| p.node).collect())
    }

    #[test]
    fn children_follow_their_parents_in_the_order_of_the_file() {
        let nodes = json!([{}, { "children": [3, 0] }, {}, { "children": [4] }, {}]);
        assert_eq!(order(nodes.clone(), json!([])).unwrap(), [1, 3, 4, 0, 2], "all roots without a scene");
        assert_eq!(order(nodes.clone(), json!([{ "nodes": [2] }])).unwrap(), [2]);
        assert_eq!(order(nodes, json!([{}])).unwrap(), [0; 0]);
    }

    #[test]
    fn transforms_apply_from_the_child_outwards() {
        let nodes = json!([
            { "children": [1], "translation": [1, 0, 0], "rotation": [0, 0, 1, 1] },
            { "scale": [2, 3, 4] },
        ]);
        let (placed, _) = place(nodes, json!([])).unwrap();
        let at = |node: usize, p: DVec3| placed[node].world.transform_point3(p);
        // Scaled to (2, 0, 0), turned to (0, 2, 0), moved to (1, 2, 0).
        assert!((at(1, DVec3::X) - DVec3::new(1.0, 2.0, 0.0)).length() < 1e-7);
    }

    #[test]
    fn a_matrix_and_its_parts_mean_the_same() {
        let parts = json!([{ "translation": [1, 2, 3], "scale": [2, 2, -1] }]);
        let matrix = json!([{ "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, 0, 1, 2, 3, 1] }]);
        assert_eq!(place(parts, json!([])).unwrap().0, place(matrix, json!([])).unwrap().0);
    }

    #[test]
    fn cycles_and_second_parents_are_refused_by_name() {
        let cycle = json!([{ "name": "A", "children": [1] }, { "children": [2] }, { "children": [0] }]);
        assert_eq!(order(cycle.clone(), json!([])).unwrap_err(), "node \"A\": it is its own ancestor");
        assert!(order(cycle, json!([{ "nodes": [] }])).is_err(), "outside the scene too");
        let own = json!([{}, { "name": "Self", "children": [1] }]);
        assert_eq!(order(own, json!([])).unwrap_err(), "node \"Self\": it is its own ancestor");
        let tail = json!([{ "children": [1] }, { "children": [1] }]);
        assert_eq!(order(tail, json!([])).unwrap_err(), "node 1: it has two parents: node 0 and node 1");
        let twice = json!([{ "children": [1, 1] }, {}]);
        assert!(order(twice, json!([])).unwrap_err().contains("two parents"));
    }

    #[test]
    fn nodes_that_are_absent_or_shown_twice_are_refused() {
        assert_eq!(
            order(json!([{ "children": [5] }]), json!([])).unwrap_err(),
            "node 0: refers to node 5 of 1"
        );
        assert_eq!(
            order(json!([{}]), json!([{ "nodes": [1] }])).unwrap_err(),
            "scene: refers to node 1 of 1"
        );
        let nodes = json!([{ "children": [1] }, { "name": "Lamp" }]);
        let message = order(nodes.clone(), json!([{ "nodes": [0, 1] }])).unwrap_err();
        assert_eq!(message, "node \"Lamp\": it is in the scene twice");
        assert_eq!(order(nodes, json!([{ "nodes": [1] }])).unwrap(), [1], "part of a tree is fine");
    }

    #[test]
    fn a_hidden_node_hides_all_below_it_but_moves_it_still() {
        let hidden = |visible: Value| json!({ "KHR_node_visibility": { "visible": visible } });
        let nodes = json!([
            { "children": [1, 2], "translation": [1, 0, 0] },
            { "children": [3], "extensions": hidden(json!(false)), "translation": [0, 2, 0] },
            { "extensions": hidden(json!(true)) },
            { "extensions": hidden(json!(true)) },
            { "extensions": { "KHR_node_visibility": {} } },
        ]);
        let (placed, _) = place(nodes, json!([])).unwrap();
        let seen: Vec<_> = placed.iter().map(|p| (p.node, p.visible)).collect();
        assert_eq!(seen, [(0, true), (1, false), (3, false), (2, true), (4, true)]);
        assert_eq!(placed[2].world.translation, DVec3::new(1.0, 2.0, 0.0));
    }

    #[test]
    fn what_hidden_nodes_show_is_left_out_but_for_cameras() {
        let mut model = Model::triangle();
        model.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }));
        let light = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
        model.json["extensions"] = light;
        model.json["extensionsRequired"] = json!(["KHR_node_visibility"]);
        let contents =
            json!({ "mesh": 0, "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } });
        model.push("nodes", contents);
        let mut counts = |visible: bool| {
            let extension = json!({ "KHR_node_visibility": { "visible": visible } });
            model.json["nodes"][0] = json!({ "children": [1], "extensions": extension });
            let scene = model.read().unwrap().scene;
            (scene.objects.len(), scene.lights.len(), scene.cameras.len())
        };
        assert_eq!((counts(true), counts(false)), ((1, 1, 1), (0, 0, 1)));
    }

    #[test]
    fn nodes_outside_the_scene_have_a_place_too() {
        let mut model = Model::empty();
        let moved = |children: Value| json!({ "translation": [1, 0, 0], "children": children });
        model.json["nodes"] = json!([moved(json!([1])), moved(json!([2])), moved(json!([])), {}]);
        model.json["scenes"] = json!([{ "nodes": [3] }]);
        let mut warnings = Warnings::default();
        let json = serde_json::to_vec(&model.json).unwrap();
        let document = Document::parse(&json, &mut warnings).unwrap();
        let mut nodes = place_all(&document, DVec3::ZERO, &mut warnings).unwrap();
        assert_eq!(nodes.placed.len(), 1);
        for node in [2, 0, 1] {
            let world = nodes.world(&document, node, &mut warnings).unwrap();
            assert_eq!(world.translation.x, node as f64 + 1.0);
        }
    }

    #[test]
    fn depth_is_no_problem() {
        let n = 100_000;
        let mut nodes: Vec<_> = (1..n).map(|child| json!({ "children": [child] })).collect();
        nodes.push(json!({}));
        assert_eq!(order(json!(nodes), json!([])).unwrap().len(), n);
    }

    #[test]
    fn odd_transforms_are_mended_with_a_warning_or_refused() {
        let (placed, warnings) = place(json!([{ "rotation": [0, 0, 0, 0] }]), json!([])).unwrap();
        assert_eq!(placed[0].world, DAffine3::IDENTITY);
        assert!(text(&warnings).contains("node 0: its rotation is zero"));
        let (placed, _) = place(json!([{ "rotation": [0, 0, 0, 2] }]), json!([])).unwrap();
        assert_eq!(placed[0].world, DAffine3::IDENTITY, "of any length");
        let projective = json!([{ "matrix": [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }]);
        assert!(text(&place(projective, json!([])).unwrap().1).contains("last row"));
        let huge = place(json!([{ "name": "Far", "scale": [1e300, 1, 1] }]), json!([]));
        assert_eq!(huge.unwrap_err(), "node \"Far\": its transform is not a finite number");
    }
}
