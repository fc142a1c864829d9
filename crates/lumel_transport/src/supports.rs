//! Where the nodes of a basis send light from: the triangles around them.

use crate::light_view::Front;
use crate::plan::Plan;
use glam::Vec3;
use lumel_basis::{Basis, Field, NodeId};
use lumel_sample::{Dim, StreamKey};
use lumel_scene::{Barycentrics, Irradiance, Radiance, Scene, SurfacePoint, TriId};
use rayon::prelude::*;

/// The triangles around every node of a basis that is linear over triangles.
#[derive(Debug)]
pub(crate) struct Supports {
    /// Where the triangles of each node end.
    ends: Vec<u32>,
    /// Each with the corner that the node is at.
    corners: Vec<(TriId, u8)>,
}

impl Supports {
    pub(crate) fn new(corner_nodes: &[[NodeId; 3]], n_nodes: usize) -> Self {
        let mut ends = vec![0u32; n_nodes];
        corner_nodes.iter().flatten().for_each(|node| ends[node.index()] += 1);
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        let mut corners = vec![(TriId(0), 0); sum as usize];
        // From the last, which leaves where each begins.
        for (tri, nodes) in corner_nodes.iter().enumerate().rev() {
            for (k, node) in nodes.iter().enumerate().rev() {
                ends[node.index()] -= 1;
                corners[ends[node.index()] as usize] = (TriId(tri as u32), k as u8);
            }
        }
        ends.push(sum);
        ends.remove(0);
        Self { ends, corners }
    }

    fn of(&self, node: NodeId) -> &[(TriId, u8)] {
        let begin = if node.0 == 0 { 0 } else { self.ends[node.index() - 1] };
        &self.corners[begin as usize..self.ends[node.index()] as usize]
    }

    /// What some nodes send of a field, with so many sample points for each. Those that send nothing are left out.
    pub(crate) fn lamps<B: Basis>(
        &self,
        (scene, basis, plan): (&Scene, &B, &Plan),
        (field, nodes): (&Field, &[NodeId]),
        points: u32,
    ) -> Vec<Lamp> {
        let lamp = |&node: &NodeId| {
            let around = self.of(node);
            let &(tri, corner) = around.first()?;
            let center = scene.triangle_positions(tri)[usize::from(corner)];
            let sides: Vec<Side> =
                around.iter().map(|&(tri, corner)| Side::new(scene, tri, corner)).collect();
            let reach = |side: &Side| {
                side.corners.map(|corner| corner.distance(center)).into_iter().fold(0.0, f32::max)
            };
            let area = basis.node_areas()[node.index()];
            let light = field.node(node).0;
            let mut lamp = Lamp {
                node,
                center,
                radius: sides.iter().map(reach).fold(0.0, f32::max),
                area,
                light,
                points: Vec::new(),
                sides,
            };
            lamp.points = lamp.sampled(scene, plan, points);
            (area > 0.0 && light != Vec3::ZERO).then_some(lamp)
        };
        nodes.par_iter().filter_map(lamp).collect()
    }
}

/// A node that shoots, as an area light whose radiosity falls from the node to the edges of its support.
pub(crate) struct Lamp {
    pub(crate) node: NodeId,
    /// The place of the node.
    pub(crate) center: Vec3,
    /// Of a sphere around that which holds its support, metres.
    pub(crate) radius: f32,
    /// The integral of its basis function, m².
    pub(crate) area: f32,
    /// The irradiance that is reflected, at the node.
    light: Vec3,
    points: Vec<LampPoint>,
    pub(crate) sides: Vec<Side>,
}

/// A sample point of a lamp, chosen with the density of its basis function.
struct LampPoint {
    position: Vec3,
    /// Where shadow rays to it end.
    target: Vec3,
    normal: Vec3,
    /// What the lamp as a whole would send straight ahead if all of it sent what is sent here, W·sr⁻¹.
    intensity: Vec3,
}

/// A triangle of a lamp.
pub(crate) struct Side {
    pub(crate) tri: TriId,
    pub(crate) corners: [Vec3; 3],
    /// The corner that the node is at.
    corner: usize,
    pub(crate) normal: Vec3,
    front: Front,
}

impl Side {
    fn new(scene: &Scene, tri: TriId, corner: u8) -> Self {
        let corners = scene.triangle_positions(tri);
        let normal = scene.geometric_normal(tri);
        Self { tri, corners, corner: corner.into(), normal, front: Front::of_polygon(&corners) }
    }

    pub(crate) fn target(&self, point: Vec3) -> Vec3 {
        self.front.before(point)
    }
}

impl Lamp {
    /// Points that do not depend on what the node sends: shots are one linear operator.
    fn sampled(&self, scene: &Scene, plan: &Plan, points: u32) -> Vec<LampPoint> {
        let areas: Vec<f32> = self.sides.iter().map(|side| scene.area(side.tri)).collect();
        let all: f32 = areas.iter().sum();
        let stream =
            plan.stream(points, StreamKey::new(plan.seed).element(self.node.0).bounce(1), Dim::LightSelect);
        let point = |number: u32| {
            let [mut x, y] = stream.sample_2d(number);
            x *= all;
            let mut chosen = 0;
            while chosen + 1 < areas.len() && x >= areas[chosen] {
                x -= areas[chosen];
                chosen += 1;
            }
            let side = &self.sides[chosen];
            let x = (x / areas[chosen].max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            let bary = hat_triangle([x, y], side.corner);
            let at = SurfacePoint { tri: side.tri, bary };
            let position = scene.position(at);
            let intensity = self.radiance(scene, at).0 * self.area;
            LampPoint { position, target: side.target(position), normal: side.normal, intensity }
        };
        (0..points).map(point).collect()
    }

    /// What arrives at a place with this normal from sample point `number`, which stands for all of the lamp, and where the
    /// shadow ray ends; `None` for what lies behind one or the other.
    #[inline]
    pub(crate) fn far(&self, number: u32, place: Vec3, normal: Vec3) -> Option<(Vec3, Vec3)> {
        let point = &self.points[number as usize % self.points.len()];
        let to_lamp = point.position - place;
        let squared = to_lamp.length_squared();
        // Both cosines times the distance.
        let (cos, cos_lamp) = (normal.dot(to_lamp), -point.normal.dot(to_lamp));
        let is_seen = cos > 0.0 && cos_lamp > 0.0;
        is_seen.then(|| (point.target, point.intensity * (cos * cos_lamp / (squared * squared))))
    }

    /// The radiance at a point of the lamp, before the basis function.
    fn radiance(&self, scene: &Scene, at: SurfacePoint) -> Radiance {
        // Of what is there at all.
        let opacity = if scene.is_transparent(at.tri) { scene.opacity(at) } else { 1.0 };
        Irradiance(self.light * opacity).reflected(scene.albedo(at)).radiance()
    }

    /// The radiance at a point of a triangle of the lamp.
    pub(crate) fn radiance_on(&self, scene: &Scene, side: &Side, bary: Barycentrics) -> Vec3 {
        self.radiance(scene, SurfacePoint { tri: side.tri, bary }).0 * bary.weights()[side.corner]
    }
}

/// A point of a triangle with a density in proportion to the barycentric coordinate λ of one corner.
///
/// Of a uniform number, `½ − sin(asin(1 − 2x)/3)` is the inverse of the share `3λ² − 2λ³` of that density below λ; along lines
/// of equal λ the density is even.
fn hat_triangle([x, y]: [f32; 2], corner: usize) -> Barycentrics {
    let own = (0.5 - ((1.0 - 2.0 * x).asin() / 3.0).sin()).clamp(0.0, 1.0);
    let rest = 1.0 - own;
    let mut weights = [0.0; 3];
    weights[corner] = own;
    weights[(corner + 1) % 3] = rest * y;
    weights[(corner + 2) % 3] = rest * (1.0 - y);
    Barycentrics { u: weights[0], v: weights[1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_the_density_of_the_hat() {
        // Of that density the mean of λ is a half, and of its square 3/10.
        let n = 64;
        let unit = |i: u32| (i as f32 + 0.5) / n as f32;
        for corner in 0..3 {
            let (mut mean, mut square, mut beside) = (0.0, 0.0, 0.0);
            for (x, y) in (0..n).flat_map(|i| (0..n).map(move |j| (unit(i), unit(j)))) {
                let weights = hat_triangle([x, y], corner).weights();
                assert!(weights.iter().all(|weight| (-1e-6..=1.0).contains(weight)), "{weights:?}");
                mean += weights[corner] / (n * n) as f32;
                square += weights[corner].powi(2) / (n * n) as f32;
                beside += weights[(corner + 1) % 3] / (n * n) as f32;
            }
            assert!((mean - 0.5).abs() < 1e-3 && (square - 0.3).abs() < 1e-3, "{mean} {square}");
            assert!((beside - 0.25).abs() < 1e-3, "{beside}");
        }
    }

    #[test]
    fn every_node_has_the_triangles_around_it() {
        let triangles = [[2, 0, 1], [1, 3, 2]].map(|nodes: [u32; 3]| nodes.map(NodeId));
        let supports = Supports::new(&triangles, 5);
        let of = |node| supports.of(NodeId(node)).iter().map(|(tri, k)| (tri.0, *k)).collect::<Vec<_>>();
        assert_eq!((of(0), of(3), of(4)), (vec![(0, 1)], vec![(1, 1)], vec![]));
        assert_eq!((of(1), of(2)), (vec![(0, 2), (1, 0)], vec![(0, 0), (1, 2)]));
    }
}
