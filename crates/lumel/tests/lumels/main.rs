//! Light on the lumels of an atlas against known answers, wherever a scene lies.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

mod closed_forms;
mod denoising;
mod directional;
mod leaks;
mod lines;
mod refining;
mod rooms;
mod rounds;

use glam::{DVec3, EulerRot, Quat, Vec3};
use lumel::{
    Baker, BounceLimit, Control, LumelLight, Lumels, Scene, SceneBuilder, Settings, Silent, SolveState,
};
use lumel_scene::{Radiance, RectLight, SurfacePoint, TriId};
use lumel_testkit::mesh::{Facing, cuboid};
use lumel_testkit::scene::{grey, placed, reordered, scaled, scene};
use lumel_uv::{Density, Pace, UnwrapSettings, unwrap};
use std::sync::Arc;

fn settings() -> Settings {
    Settings { bounces: BounceLimit::All, direct_samples: 64, indirect_samples: 64, ..Settings::default() }
}

fn built(builder: SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.build().unwrap().0)
}

fn lumels(scene: &Arc<Scene>, per_metre: f32) -> Lumels {
    let settings = UnwrapSettings { density: Density::PerMetre(per_metre), ..UnwrapSettings::default() };
    Lumels::new(Arc::clone(scene), unwrap(scene, &settings, &|| Pace::Go).unwrap().atlas)
}

/// Long edges split.
fn tessellated(builder: &SceneBuilder, max_edge: f32) -> Arc<Scene> {
    let mut fine = builder.clone();
    fine.tessellate(max_edge).unwrap();
    built(fine)
}

fn solved(scene: &Arc<Scene>, settings: Settings) -> (Baker, SolveState) {
    let (baker, mut state) = (Baker::new(Arc::clone(scene), settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    (baker, state)
}

/// Light at the lumels of a scene as given that is carried on the vertices of its tessellation. Lengths are those of the scene
/// as given.
fn measured(scene: &Placed, max_edge: f32, per_metre: f32, settings: Settings) -> (Lumels, LumelLight) {
    let lumels = scene.lumels(per_metre);
    let (baker, state) = solved(&tessellated(&scene.builder, max_edge * scene.scale), settings);
    let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
    (lumels, light)
}

fn irradiance(light: &LumelLight) -> impl Iterator<Item = Vec3> {
    (0..light.len()).map(|lumel| light.irradiance(lumel))
}

/// A scene as it is given or somewhere else, in the same light.
#[derive(Clone)]
struct Placed {
    place: &'static str,
    builder: SceneBuilder,
    turn: Quat,
    shift: Vec3,
    scale: f32,
}

impl Placed {
    fn as_given(builder: SceneBuilder) -> Self {
        Self { place: "as given", builder, turn: Quat::IDENTITY, shift: Vec3::ZERO, scale: 1.0 }
    }

    fn lumels(&self, per_metre: f32) -> Lumels {
        lumels(&built(self.builder.clone()), per_metre / self.scale)
    }

    /// Where a point of the built scene would be in the scene as given.
    fn home(&self, scene: &Scene, point: Vec3) -> DVec3 {
        let moved = scene.origin() - self.builder.origin - self.shift.as_dvec3();
        self.turn.as_dquat().inverse() * (point.as_dvec3() + moved) / f64::from(self.scale)
    }

    /// What the normal of a triangle of the built scene would be there.
    fn normal(&self, scene: &Scene, tri: TriId) -> DVec3 {
        self.turn.as_dquat().inverse() * scene.geometric_normal(tri).as_dvec3()
    }
}

/// The point of the surfaces where, in the scene as given, this point would have this normal; `None` if there is none.
fn surface_point(placed: &Placed, scene: &Scene, point: DVec3, normal: DVec3) -> Option<SurfacePoint> {
    let at = |tri: TriId| {
        let corners = scene.triangle_positions(tri).map(|corner| placed.home(scene, corner));
        let area = |k: usize| (corners[(k + 1) % 3] - point).cross(corners[(k + 2) % 3] - point).dot(normal);
        let [u, v, w] = [0, 1, 2].map(area);
        let inside = u.min(v).min(w) >= 0.0 && (point - corners[0]).dot(normal).abs() < 1e-3;
        let faces = placed.normal(scene, tri).dot(normal) > 0.99;
        let bary = [u, v].map(|part| (part / (u + v + w)) as f32).into();
        (inside && faces).then_some(SurfacePoint { tri, bary })
    };
    (0..scene.triangle_count() as u32).map(TriId).find_map(at)
}

/// The scene as given, in another order, turned, far away, larger and smaller.
fn placements(builder: &SceneBuilder) -> [Placed; 6] {
    let turn = Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.3);
    let given = || Placed::as_given(builder.clone());
    let moved = |place, turn, shift| {
        let builder = placed(builder.clone(), turn, shift);
        Placed { place, builder, turn, shift, ..given() }
    };
    let sized = |place, scale| Placed { place, builder: scaled(builder.clone(), scale), scale, ..given() };
    let mut far = moved("far away", Quat::IDENTITY, Vec3::new(1000.0, -700.0, 400.0));
    far.builder.origin = DVec3::new(-4e6, 1e6, 2e6);
    [
        given(),
        Placed { place: "reordered", builder: reordered(builder.clone()), ..given() },
        moved("turned and moved", turn, Vec3::new(300.0, -140.0, 80.0)),
        far,
        sized("a town", 700.0),
        sized("a toy", 0.003),
    ]
}

/// A room of twelve triangles with a lamp and a block that stands on its floor.
fn room() -> SceneBuilder {
    let mut meshes = cuboid(Vec3::ZERO, Vec3::new(3.0, 2.0, 3.0), 1, Facing::Inward, [0; 6]);
    meshes.extend(cuboid(Vec3::new(0.7, 0.0, 0.8), Vec3::new(1.4, 1.1, 1.7), 1, Facing::Outward, [0; 6]));
    let (u, v) = (Vec3::X * 0.3, Vec3::Z * 0.3);
    let lamp = RectLight {
        center: Vec3::new(1.9, 1.999, 1.4),
        u,
        v,
        radiance: Radiance::splat(20.0),
        texture: None,
    };
    scene(meshes, vec![grey(0.6, 0.0)], vec![lamp.into()])
}
