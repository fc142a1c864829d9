//! Light at points of a file, kept from what lies behind walls.

use lumel_accel::RayTracer;
use lumel_basis::CloudPoint;
use lumel_export::ScatteredLight;
use lumel_scene::Scene;
use lumel_transport::SurfaceWalks;

/// Points lie on their surface to this share of how far they reach.
const NEAR: f32 = 0.01;

/// The same light where it does not pass what stands on the surfaces, as in the solve that has found it.
///
/// Files hold points without what stands around them: it is looked for once more.
#[must_use]
pub fn gated(light: ScatteredLight, scene: &Scene, tracer: &dyn RayTracer) -> ScatteredLight {
    let walks = SurfaceWalks { scene, tracer };
    let surface = |point: &CloudPoint| walks.surface_at(point.position, point.normal, NEAR * point.radius);
    ScatteredLight { cloud: light.cloud.around_obstacles(&walks, surface), ..light }
}
