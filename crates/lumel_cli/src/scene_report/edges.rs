//! How long edges are.

use glam::Vec3;
use lumel::Scene;
use serde::Serialize;

/// Quantiles of the lengths of edges, metres.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct EdgeReport {
    pub(super) min: f64,
    pub(super) p5: f64,
    pub(super) median: f64,
    pub(super) p95: f64,
    pub(super) max: f64,
}

impl EdgeReport {
    /// Those of a scene; edges that faces share count once.
    pub(super) fn of(scene: &Scene) -> Self {
        let corners = scene.traced_corners();
        // Triangles that no ray meets lie where others do.
        let traced = corners.iter().filter(|corners| corners.iter().all(|corner| corner.is_finite()));
        let mut edges: Vec<[[u32; 3]; 2]> = traced.flat_map(edges_between).collect();
        edges.sort_unstable();
        edges.dedup();
        let point = |bits: [u32; 3]| Vec3::from(bits.map(f32::from_bits)).as_dvec3();
        let mut lengths: Vec<f64> = edges.iter().map(|&[a, b]| point(a).distance(point(b))).collect();
        lengths.sort_unstable_by(f64::total_cmp);
        // A scene has at least one triangle.
        let last = lengths.len().saturating_sub(1) as f64;
        let at = |share: f64| lengths.get((share * last).round() as usize).copied().unwrap_or_default();
        Self { min: at(0.0), p5: at(0.05), median: at(0.5), p95: at(0.95), max: at(1.0) }
    }
}

/// The edges of a triangle by the bits of their ends, the same from either side.
fn edges_between(corners: &[Vec3; 3]) -> [[[u32; 3]; 2]; 3] {
    // Adding zero makes 0 of -0.
    let [a, b, c] = corners.map(|corner| (corner + Vec3::ZERO).to_array().map(f32::to_bits));
    [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])
}
