//! The laws of bases.

use super::{Law, Violation, built, check, check_identity};
use crate::quadrature::triangle_points;
use crate::statistics::Estimate;
use crate::surface_points::{points_on_triangles, unit_4d};
use glam::{DVec3, Vec3};
use lumel_basis::{Basis, Field, NodeId, NodeWeights};
use lumel_scene::{Barycentrics, Scene, SceneBuilder, SurfacePoint, TriId};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::Arc;

/// Random points per triangle at which functions are compared.
const POINTS: u32 = 4;

/// Estimates of each integral, where they are no sums of a few terms.
const REPLICATES: u32 = 64;

/// Rounding of a handful of operations in f32 on numbers up to one.
const ROUNDING: f64 = 1e-6;

/// Sums of hundreds of terms in f32, relative: areas are stored in f32.
const ROUNDING_OF_AREAS: f64 = 1e-5;

/// Fails with the name of `what` unless a basis keeps all laws on a scene.
#[track_caller]
pub fn assert_basis_laws(
    builder: &SceneBuilder,
    make: &dyn Fn(Arc<Scene>) -> Box<dyn Basis>,
    what: impl Display,
) {
    if let Err(violation) = basis_laws(builder, make) {
        panic!("{what}: {violation}");
    }
}

/// Checks all laws of the basis that `make` makes on a scene.
///
/// # Errors
/// The first law that is not kept.
pub fn basis_laws(
    builder: &SceneBuilder,
    make: &dyn Fn(Arc<Scene>) -> Box<dyn Basis>,
) -> Result<(), Violation> {
    let scene = built(builder);
    let basis = &*make(Arc::clone(&scene));
    let ones = ones(basis);
    for at in corners_and_points(&scene) {
        weights(basis, &ones, at)?;
    }
    corner_nodes(&scene, basis)?;
    linear_functions(&scene, basis)?;
    node_areas(&scene, basis, &ones)?;
    adjacency(basis)?;
    extrapolation(basis)?;
    check_identity(builder, &|scene| make(scene).identity())
}

fn corners_and_points(scene: &Scene) -> impl Iterator<Item = SurfacePoint> {
    let corners = (0..scene.triangle_count() as u32)
        .flat_map(|tri| Barycentrics::CORNERS.map(|bary| SurfacePoint { tri: TriId(tri), bary }));
    corners.chain(points_on_triangles(scene, POINTS, 1))
}

/// The coefficients of a constant.
fn ones(basis: &dyn Basis) -> Field {
    let mut ones = Field::from_values(vec![Vec3::ONE; basis.node_count()]);
    if let Some(hierarchy) = basis.hierarchy() {
        hierarchy.analyze(&mut ones, None);
    }
    ones
}

fn weights(basis: &dyn Basis, ones: &Field, at: SurfacePoint) -> Result<(), Violation> {
    let mut weights = NodeWeights::default();
    basis.weights_at(at, &mut weights);
    let exists = |(node, weight): (NodeId, f32)| node.index() < basis.node_count() && weight.is_finite();
    check(weights.iter().all(exists), Law::Weights, || format!("{weights:?} at {at:?}"))?;
    let sum: f64 = weights.iter().map(|(node, w)| f64::from(w) * f64::from(ones.node(node).0.x)).sum();
    check((sum - 1.0).abs() < ROUNDING, Law::PartitionOfUnity, || format!("the sum is {sum} at {at:?}"))
}

fn corner_nodes(scene: &Scene, basis: &dyn Basis) -> Result<(), Violation> {
    let Some(corner_nodes) = basis.corner_nodes() else { return Ok(()) };
    let (n, all) = (corner_nodes.len(), scene.triangle_count());
    check(n == all, Law::CornerNodes, || format!("of {n} triangles, there are {all}"))?;
    for at in corners_and_points(scene) {
        let mut difference: BTreeMap<NodeId, f64> = BTreeMap::new();
        let corners = corner_nodes[at.tri.index()].into_iter().zip(at.bary.weights());
        corners.for_each(|(node, weight)| *difference.entry(node).or_default() += f64::from(weight));
        let mut weights = NodeWeights::default();
        basis.weights_at(at, &mut weights);
        weights.iter().for_each(|(node, weight)| *difference.entry(node).or_default() -= f64::from(weight));
        let agrees = difference.values().all(|d| d.abs() < ROUNDING);
        check(agrees, Law::CornerNodes, || format!("differ from the weights by {difference:?} at {at:?}"))?;
    }
    Ok(())
}

/// Gives the nodes at corners the values of linear functions there and compares them in between.
fn linear_functions(scene: &Scene, basis: &dyn Basis) -> Result<(), Violation> {
    let Some(corner_nodes) = basis.corner_nodes() else { return Ok(()) };
    let mut field = Field::zeros(basis.node_count());
    for (tri, nodes) in (0..).map(TriId).zip(corner_nodes) {
        for (node, position) in nodes.iter().zip(scene.triangle_positions(tri)) {
            field.coefficients_mut(*node)[0] = position;
        }
    }
    let bounds = scene.bounds();
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    let mut scratch = NodeWeights::default();
    for at in points_on_triangles(scene, POINTS, 2) {
        let [found, position] = [field.at(basis, at, &mut scratch).0, scene.position(at)].map(Vec3::as_dvec3);
        let near = found.distance(position) < 4.0 * ROUNDING * f64::from(largest);
        check(near, Law::LinearFunctions, || format!("{found} in place of {position}"))?;
    }
    Ok(())
}

/// Integrates weights: exactly for linear ones, else by independent random points.
fn node_areas(scene: &Scene, basis: &dyn Basis, ones: &Field) -> Result<(), Violation> {
    let areas = basis.node_areas();
    let n = basis.node_count();
    check(areas.len() == n, Law::NodeAreas, || format!("{} for {n} nodes", areas.len()))?;
    let of_one = areas.iter().zip(ones.values()).map(|(a, one)| f64::from(*a) * f64::from(one.x));
    let (sum, whole) = (of_one.sum::<f64>(), area(scene));
    let near = (sum / whole - 1.0).abs() < ROUNDING_OF_AREAS;
    check(near, Law::NodeAreas, || format!("the sum is {sum}, the surfaces have {whole}"))?;
    let estimates: Vec<Estimate> = if basis.corner_nodes().is_some() {
        let points = (0..scene.triangle_count() as u32).flat_map(|tri| {
            let bary = |[u, v]: [f64; 2]| Barycentrics { u: u as f32, v: v as f32 };
            triangle_points(1)
                .map(move |(uv, share)| (SurfacePoint { tri: TriId(tri), bary: bary(uv) }, share))
        });
        let exact = |mean: f64| Estimate { mean, error: 0.0, count: 2 };
        integrals(scene, basis, points).into_iter().map(exact).collect()
    } else {
        let replicate = |r: u32| {
            let points = points_on_triangles(scene, 1, 100 + u64::from(r)).map(|at| (at, 1.0));
            integrals(scene, basis, points)
        };
        let replicates: Vec<Vec<f64>> = (0..REPLICATES).map(replicate).collect();
        (0..n).map(|node| Estimate::new(replicates.iter().map(|areas| areas[node]))).collect()
    };
    for (node, (area, estimate)) in areas.iter().zip(estimates).enumerate() {
        let (area, integral) = (f64::from(*area), estimate.mean);
        let tolerance = estimate.tolerance(n) + ROUNDING_OF_AREAS * area.abs();
        let near = (area - integral).abs() <= tolerance;
        let found = || format!("{area} at node {node}, the integral is {integral} up to {tolerance}");
        check(near, Law::NodeAreas, found)?;
    }
    Ok(())
}

/// The integral of each basis function by points with their shares of the triangle's area.
fn integrals(
    scene: &Scene,
    basis: &dyn Basis,
    points: impl Iterator<Item = (SurfacePoint, f64)>,
) -> Vec<f64> {
    let mut sums = vec![0.0; basis.node_count()];
    let mut weights = NodeWeights::default();
    for (at, share) in points {
        weights.clear();
        basis.weights_at(at, &mut weights);
        let area = share * f64::from(scene.area(at.tri));
        weights.iter().for_each(|(node, weight)| sums[node.index()] += f64::from(weight) * area);
    }
    sums
}

/// The area of all surfaces, from the corners.
fn area(scene: &Scene) -> f64 {
    let triangle = |tri| {
        let [a, b, c] = scene.triangle_positions(TriId(tri)).map(Vec3::as_dvec3);
        0.5 * DVec3::cross(b - a, c - a).length()
    };
    (0..scene.triangle_count() as u32).map(triangle).sum()
}

fn adjacency(basis: &dyn Basis) -> Result<(), Violation> {
    let (adjacency, n) = (basis.adjacency(), basis.node_count());
    let count = adjacency.node_count();
    check(count == n, Law::Adjacency, || format!("of {count} nodes, there are {n}"))?;
    for node in (0..n as u32).map(NodeId) {
        for (neighbour, weight) in adjacency.neighbours(node) {
            let back = |(other, same): (NodeId, f64)| other == node && same == weight;
            let symmetric = neighbour.index() < n && adjacency.neighbours(neighbour).any(back);
            check(symmetric, Law::Adjacency, || {
                format!("{node:?} has {neighbour:?}, but not the other way")
            })?;
        }
    }
    for nodes in basis.corner_nodes().into_iter().flatten() {
        for (a, b) in nodes.iter().flat_map(|a| nodes.iter().map(move |b| (*a, *b))).filter(|(a, b)| a != b) {
            let adjacent = adjacency.neighbours(a).any(|(node, _)| node == b);
            check(adjacent, Law::Adjacency, || format!("{a:?} and {b:?} share a triangle"))?;
        }
    }
    Ok(())
}

fn extrapolation(basis: &dyn Basis) -> Result<(), Violation> {
    let (constant, unknown) = (Vec3::new(0.3, 2.0, 70.0), Vec3::splat(-9.0));
    let is_known = |node: usize| unit_4d(3, node as u32)[0] < 0.25;
    let known: Vec<bool> = (0..basis.node_count()).map(is_known).collect();
    let values = known.iter().map(|known| if *known { constant } else { unknown }).collect();
    let mut field = Field::from_values(values);
    let filled = basis.adjacency().extrapolate(&mut field, &known);
    for (node, (value, filled)) in field.values().iter().zip(filled).enumerate() {
        let expected = if filled { constant } else { unknown };
        let near = (*value - expected).abs().max_element() < 70.0 * ROUNDING as f32;
        check(near, Law::Extrapolation, || format!("{value} at node {node}, expected {expected}"))?;
    }
    Ok(())
}
