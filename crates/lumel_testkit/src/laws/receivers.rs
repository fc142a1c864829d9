//! The laws of receivers.

use super::{Law, Violation, built, check, check_identity};
use crate::surface_points::unit_4d;
use lumel_basis::{CENTER, ElementId, NodeId, NodeWeights, Receivers, Sampling, Site};
use lumel_sample::uniform_triangle;
use lumel_scene::{Scene, SceneBuilder};
use std::fmt::Display;
use std::sync::Arc;

/// Random places per element.
const PLACES: u32 = 8;

/// Rounding of the dot products of unit vectors.
const ROUNDING: f32 = 1e-5;

/// Fails with the name of `what` unless receivers keep all laws on a scene.
#[track_caller]
pub fn assert_receiver_laws(
    builder: &SceneBuilder,
    make: &dyn Fn(Arc<Scene>) -> Box<dyn Receivers>,
    what: impl Display,
) {
    if let Err(violation) = receiver_laws(builder, make) {
        panic!("{what}: {violation}");
    }
}

/// Checks all laws of the receivers that `make` makes on a scene.
///
/// # Errors
/// The first law that is not kept.
pub fn receiver_laws(
    builder: &SceneBuilder,
    make: &dyn Fn(Arc<Scene>) -> Box<dyn Receivers>,
) -> Result<(), Violation> {
    let scene = built(builder);
    let receivers = &*make(Arc::clone(&scene));
    let mut measured = vec![false; receivers.node_count()];
    for element in (0..receivers.element_count() as u32).map(ElementId) {
        let mut nodes = Vec::new();
        receivers.nodes_of(element, &mut nodes);
        let exist = nodes.iter().all(|node| node.index() < measured.len());
        check(exist, Law::NodesOf, || format!("{element:?} counts towards {nodes:?} of {}", measured.len()))?;
        nodes.iter().for_each(|node| measured[node.index()] = true);
        let central = site(&scene, receivers, element, CENTER, &nodes)?;
        for place in 0..PLACES {
            let [x, y, ..] = unit_4d(4, element.0 * PLACES + place);
            let site = site(&scene, receivers, element, [x, y], &nodes)?;
            let at_one_point = site.origin == central.origin && site.frame == central.frame;
            let as_said = receivers.sampling() == Sampling::Area || at_one_point;
            check(as_said, Law::Sites, || format!("{element:?} is no point"))?;
        }
    }
    let unmeasured = measured.iter().position(|measured| !measured);
    check(unmeasured.is_none(), Law::NodesOf, || format!("no element counts towards node {unmeasured:?}"))?;
    check_identity(builder, &|scene| make(scene).identity())
}

/// The site of an element at `u`, if all is as it should be.
fn site(
    scene: &Scene,
    receivers: &dyn Receivers,
    element: ElementId,
    u: [f32; 2],
    nodes: &[NodeId],
) -> Result<Site, Violation> {
    let mut towards = NodeWeights::default();
    let site = receivers.site(element, u);
    receivers.towards(element, u, &mut towards);
    let covered = towards.iter().all(|(node, _)| nodes.contains(&node));
    check(covered, Law::NodesOf, || format!("{element:?} has {nodes:?}, but counts towards {towards:?}"))?;
    let sound = towards.iter().all(|(_, weight)| weight.is_finite() && weight >= 0.0);
    let sound = sound && towards.iter().any(|(_, weight)| weight > 0.0);
    check(sound, Law::Weights, || format!("{element:?} at {u:?} counts towards {towards:?}"))?;
    if let Some((corners, area)) = receivers.corners(element) {
        let [a, b] = uniform_triangle(u);
        let expected = corners.into_iter().zip([a, b, 1.0 - a - b].map(|weight| weight * area));
        let agree = towards.iter().eq(expected.clone());
        let found = || {
            format!("{element:?} counts towards {towards:?}, by corners {:?}", expected.collect::<Vec<_>>())
        };
        check(agree, Law::CornerNodes, found)?;
    }
    let frame = site.frame;
    let unit =
        [frame.tangent, frame.bitangent, frame.normal].iter().all(|v| (v.length() - 1.0).abs() < ROUNDING);
    let orthogonal = (frame.tangent.cross(frame.bitangent) - frame.normal).length() < ROUNDING;
    let skips_a_triangle = site.skip.is_none_or(|tri| tri.index() < scene.traced_count());
    let sound = site.origin.is_finite() && unit && orthogonal && skips_a_triangle;
    check(sound, Law::Sites, || format!("{element:?} at {u:?} has {site:?}"))?;
    Ok(site)
}
