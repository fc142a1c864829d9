//! Lumels and vertices as both get finer.

use crate::{Placed, room, settings, solved, tessellated};
use glam::DVec3;
use lumel::{BounceLimit, Control, Lighting, Settings, VertexLighting};
use lumel_lightmap::{Lightmap, LumelLighting};
use lumel_scene::SurfacePoint;
use lumel_testkit::random_surface_points;

/// How far light at lumels is from light at vertices over all surfaces, relative to it: root mean square, without noise.
fn distance(edge: f32) -> f64 {
    let placed = Placed::as_given(room());
    let (lumels, fine) = (placed.lumels(1.0 / edge), tessellated(&placed.builder, edge));
    let refined = lumels.atlas.refined(&lumels.scene, &fine);
    // What the block stands on is hidden.
    let seen = |at: &SurfacePoint| {
        let point = fine.position(*at);
        point.y > 1e-3 || !(0.7..1.4).contains(&point.x) || !(0.8..1.7).contains(&point.z)
    };
    let points: Vec<_> = random_surface_points(&fine, 4000, 5).into_iter().filter(seen).collect();
    let differences = [1, 2].map(|seed| {
        let samples = Settings {
            seed,
            bounces: BounceLimit::Count(2),
            direct_samples: 64,
            indirect_samples: 128,
            ..settings()
        };
        let (baker, state) = solved(&fine, samples);
        let at_vertices = baker.light_at_vertices(&state);
        let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
        let map = Lightmap::finished(&lumels.scene, &lumels.atlas, &lumels.coverage, &light, None, None);
        let at_lumels = LumelLighting { atlas: &refined, ..map.lighting(0) };
        let at_vertices = VertexLighting::new(&fine, &at_vertices).unwrap();
        let read = |light: &dyn Lighting, at: &SurfacePoint| {
            light.irradiance(*at, fine.geometric_normal(at.tri)).0.as_dvec3()
        };
        let pair =
            |at: &SurfacePoint| (read(&at_lumels, at) - read(&at_vertices, at), read(&at_vertices, at));
        points.iter().map(pair).collect::<Vec<(DVec3, DVec3)>>()
    });
    // Independent samples: what both bakes differ by is no noise.
    let pairs = || differences[0].iter().zip(&differences[1]);
    let common: f64 = pairs().map(|(a, b)| a.0.dot(b.0)).sum();
    let power: f64 = pairs().map(|(a, b)| a.1.dot(b.1)).sum();
    (common.max(0.0) / power).sqrt()
}

#[test]
fn lumels_and_vertices_agree_the_better_the_finer_both_are() {
    let distances = [0.4, 0.2, 0.1].map(distance);
    for pair in distances.windows(2) {
        assert!(pair[1] < 0.75 * pair[0], "{distances:?}");
    }
    assert!(distances[2] < 0.015, "{distances:?}");
}
