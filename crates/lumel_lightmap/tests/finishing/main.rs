//! What holds for the light of an atlas after it is finished.

#![allow(clippy::unwrap_used, reason = "helpers of tests are no tests to Clippy")]

mod denoising;
mod dilation;
mod fireflies;
mod reading;
mod seams;
mod shrinking;

use glam::{DVec3, Quat, Vec3};
use lumel_lightmap::{Lightmap, LightmapLayer};
use lumel_scene::{Barycentrics, ObjectMesh, Scene, SceneBuilder, SurfacePoint, TriId};
use lumel_testkit::mesh::{Facing, cuboid, quad, sphere};
use lumel_testkit::scene::{grey, placed, scene, two_sided};
use lumel_uv::{Atlas, Coverage, Density, Pace, UnwrapSettings, unwrap};
use std::sync::Arc;

/// A scene with places for its light.
struct Stage {
    scene: Scene,
    atlas: Arc<Atlas>,
    coverage: Coverage,
}

impl Stage {
    fn new(builder: SceneBuilder, settings: &UnwrapSettings) -> Self {
        let scene = builder.build().unwrap().0;
        let atlas = unwrap(&scene, settings, &|| Pace::Go).unwrap().atlas;
        Self { scene, coverage: Coverage::new(&atlas), atlas: Arc::new(atlas) }
    }

    /// Lumels that are read are valid, if `valid` finds them so.
    fn lightmap(&self, values: Vec<Vec3>, valid: impl Fn(usize) -> bool) -> Lightmap {
        let mut is_valid = vec![false; values.len()];
        for &lumel in self.coverage.lumels() {
            is_valid[lumel as usize] = valid(lumel as usize);
        }
        let layers = vec![LightmapLayer { name: "irradiance".into(), values }];
        Lightmap { atlas: Arc::clone(&self.atlas), valid: is_valid, layers }
    }

    /// Light by lumel that is read; what is not measured is far too bright.
    fn measured(&self, light: impl Fn(TriId, DVec3) -> Vec3) -> Vec<Vec3> {
        let mut values = vec![Vec3::splat(1e6); self.atlas.lumel_count()];
        for (place, &lumel) in self.coverage.lumels().iter().enumerate() {
            let tri = self.coverage.shares(place)[0].tri;
            values[lumel as usize] = light(tri, self.center(lumel as usize, tri));
        }
        values
    }

    /// The centre of a lumel, in the plane of a triangle of its chart.
    fn center(&self, lumel: usize, tri: TriId) -> DVec3 {
        let (_, [x, y]) = self.atlas.column_and_row(lumel);
        let at = glam::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let [a, b, c] = self.atlas.corners(tri).map(|corner| corner.as_dvec2());
        let whole = (b - a).perp_dot(c - a);
        let [u, v] = [(b - at).perp_dot(c - at), (c - at).perp_dot(a - at)].map(|area| area / whole);
        let [pa, pb, pc] = self.scene.triangle_positions(tri).map(|p| p.as_dvec3());
        pa * u + pb * v + pc * (1.0 - u - v)
    }

    /// Points all over all triangles, with their ends.
    fn points(&self) -> impl Iterator<Item = SurfacePoint> {
        let bary = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.5, 0.5], [0.2, 0.3], [0.05, 0.9], [0.7, 0.1]];
        let tris = (0..self.scene.triangle_count() as u32).map(TriId);
        tris.flat_map(move |tri| bary.map(|[u, v]| SurfacePoint { tri, bary: Barycentrics { u, v } }))
    }
}

fn settings(page_size: u32) -> UnwrapSettings {
    UnwrapSettings { density: Density::PerMetre(12.0), page_size, ..UnwrapSettings::default() }
}

/// Two squares of one metre, side by side: two objects that share an edge.
fn pair() -> Vec<ObjectMesh> {
    let square = |x: f32| {
        let corners = [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        quad(corners, [1, 1], 0)
    };
    vec![square(0.0), square(1.0)]
}

fn of(objects: Vec<ObjectMesh>) -> SceneBuilder {
    scene(objects, vec![grey(0.5, 0.0)], Vec::new())
}

/// Turned, scaled and moved, which leaves no number round.
fn moved(mut builder: SceneBuilder) -> SceneBuilder {
    builder.objects.iter_mut().flat_map(|object| &mut object.positions).for_each(|p| *p *= 1.7);
    placed(builder, Quat::from_rotation_arc(Vec3::Z, Vec3::new(0.6, 0.48, 0.64)), Vec3::new(3.3, -7.1, 5.9))
}

/// Scenes with creases, smooth surfaces, two sides and several pages.
fn stages() -> Vec<(&'static str, Stage)> {
    let room = || of(cuboid(Vec3::ZERO, Vec3::new(2.0, 1.5, 1.0), 2, Facing::Inward, [0; 6]));
    let ball = of(vec![sphere(Vec3::ZERO, 1.0, 3, Facing::Outward, 0)]);
    let sheet = scene(pair(), vec![two_sided(grey(0.5, 0.0))], Vec::new());
    vec![
        ("pair", Stage::new(of(pair()), &settings(256))),
        ("moved pair", Stage::new(moved(of(pair())), &settings(256))),
        ("room on several pages", Stage::new(moved(room()), &settings(64))),
        ("ball", Stage::new(ball, &settings(256))),
        ("sheet", Stage::new(moved(sheet), &settings(256))),
    ]
}

/// Numbers in 0..1 that look random.
fn noise(i: usize) -> f32 {
    let mixed = (i as u32).wrapping_mul(0x9e37_79b9) ^ ((i as u32).wrapping_mul(0x85eb_ca6b) >> 13);
    (mixed.wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1 << 24) as f32
}
