//! Light over all surfaces against known answers, by every projection and solver, wherever a scene lies.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::{DVec3, EulerRot, Quat, Vec3};
use lumel::{
    Baker, BounceLimit, Control, Light, Projection, Scene, SceneBuilder, Settings, Silent, SolveState,
    SolverKind, Tail, measure_points,
};
use lumel_basis::{Lighting, PointReceivers, VertexLighting};
use lumel_scene::{Barycentrics, Radiance, SurfacePoint, TriId};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{ceiling_light, grey, placed, reordered, scene};
use lumel_testkit::{Estimate, Reference, form_factor};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

const PROJECTIONS: [Projection; 3] = [Projection::Point, Projection::Area, Projection::LeastSquares];

fn settings(projection: Projection, solver: SolverKind) -> Settings {
    Settings {
        projection,
        solver,
        bounces: BounceLimit::Count(0),
        direct_samples: 128,
        indirect_samples: 256,
        ..Settings::default()
    }
}

fn built(builder: SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.build().unwrap().0)
}

fn solved(scene: &Arc<Scene>, settings: Settings) -> Vec<Vec3> {
    let (baker, mut state) = (Baker::new(Arc::clone(scene), settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    baker.light_at_vertices(&state)
}

/// Every projection with every solver.
fn ways() -> impl Iterator<Item = (Projection, SolverKind)> {
    let solvers = [SolverKind::Cached, SolverKind::Neumann];
    PROJECTIONS.into_iter().flat_map(move |projection| solvers.map(|solver| (projection, solver)))
}

/// A scene as given, moved, turned about all axes, with faces in another order, and all at once.
fn placements(builder: &SceneBuilder) -> [(&'static str, SceneBuilder, Quat, Vec3); 4] {
    let (turn, shift) = (Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.3), Vec3::new(20.0, -14.0, 8.0));
    let place = |turn, shift| placed(builder.clone(), turn, shift);
    [
        ("as given", builder.clone(), Quat::IDENTITY, Vec3::ZERO),
        ("moved", place(Quat::IDENTITY, shift), Quat::IDENTITY, shift),
        ("reordered", reordered(builder.clone()), Quat::IDENTITY, Vec3::ZERO),
        ("turned, moved, reordered", reordered(place(turn, shift)), turn, shift),
    ]
}

/// A lamp of one square metre over a floor of 2 m.
const LAMP: RectLamp = RectLamp { height: 0.6, half: 0.25, radiance: 2.0 };

struct RectLamp {
    height: f32,
    half: f32,
    radiance: f32,
}

impl RectLamp {
    fn light(&self) -> Light {
        let (center, edge) = (Vec3::new(0.0, 0.0, self.height), 2.0 * self.half);
        Light::Rect(ceiling_light(center, edge, edge, self.radiance))
    }

    /// What arrives at a point with a normal, if nothing is in the way.
    fn irradiance(&self, point: DVec3, normal: DVec3) -> f64 {
        let corner = |x: f32, y: f32| Vec3::new(x * self.half, y * self.half, self.height).as_dvec3();
        // Counter-clockwise seen from below.
        let corners = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
        PI * f64::from(self.radiance) * form_factor::polygon(&corners, point, normal)
    }
}

fn floor(cells: u32) -> lumel_scene::ObjectMesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    quad(corners, [cells, cells], 0)
}

#[test]
fn light_of_a_lamp_over_a_floor_is_its_closed_form_everywhere() {
    let builder = scene(vec![floor(12)], vec![grey(0.0, 0.0)], vec![LAMP.light()]);
    for (place, builder, turn, shift) in placements(&builder) {
        let scene = built(builder);
        let (back, shift) = (turn.as_dquat().inverse(), shift.as_dvec3() - scene.origin());
        let truth = |point: DVec3, normal: DVec3| LAMP.irradiance(back * (point - shift), back * normal);
        let reference = Reference::known(&scene, 4000, 1, truth);
        for (projection, solver) in ways() {
            let values = solved(&scene, settings(projection, solver));
            let error = reference.error_of(&VertexLighting::new(&scene, &values).unwrap());
            println!("{place}, {projection:?}, {solver:?}: {:.4}, bias {:+.5}", error.rms, error.bias);
            // What linear functions on this mesh can tell: means blur, points cut off peaks. No noise is left.
            let (rms, bias) = match projection {
                Projection::Point => (0.024, 0.003),
                Projection::Area => (0.045, 0.001),
                Projection::LeastSquares => (0.028, 0.001),
            };
            assert!(error.rms < rms, "{place}, {projection:?}, {solver:?}: {error:?}");
            assert!(
                error.bias.abs() < bias + 2.0 * error.bias_error,
                "{place}, {projection:?}, {solver:?}: {error:?}"
            );
        }
    }
}

#[test]
fn irradiance_in_the_varying_sphere_is_two_everywhere() {
    let given = lumel::open("sphere", &lumel::OpenOptions::default()).unwrap().builder;
    // Of many faces, all there is at once says as much as each by itself.
    for (place, builder, ..) in placements(&given).into_iter().step_by(3) {
        let scene = built(builder);
        let reference = Reference::known(&scene, 4000, 1, |_, _| 2.0);
        for (projection, solver) in ways() {
            let bounces = BounceLimit::Count(12);
            let (direct_samples, indirect_samples) = (64, 64);
            let base = settings(projection, solver);
            let settings =
                Settings { bounces, direct_samples, indirect_samples, tail: Tail::Geometric, ..base };
            let values = solved(&scene, settings);
            let error = reference.error_of(&VertexLighting::new(&scene, &values).unwrap());
            println!("{place}, {projection:?}, {solver:?}: {:.4}, bias {:+.5}", error.rms, error.bias);
            assert!(
                error.rms < 0.02 && error.bias.abs() < 0.01,
                "{place}, {projection:?}, {solver:?}: {error:?}"
            );
        }
    }
}

#[test]
fn a_face_whose_corners_are_all_hidden_is_lit() {
    // A floor of one cell with a post on each corner, under a sky.
    let posts = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].into_iter().flat_map(|[x, y]| {
        let center = Vec3::new(x, y, 0.2);
        cuboid(
            center - Vec3::new(0.2, 0.2, 0.3),
            center + Vec3::new(0.2, 0.2, 0.3),
            2,
            Facing::Outward,
            [0; 6],
        )
    });
    let objects: Vec<_> = std::iter::once(floor(1)).chain(posts).collect();
    let n_floor_corners = 4;
    let sky = Radiance::splat(1.0).into();
    let builder = SceneBuilder { sky, ..scene(objects, vec![grey(0.0, 0.0)], vec![]) };
    for (place, builder, turn, shift) in placements(&builder) {
        let scene = built(builder);
        let (middle, up) = (scene.to_local(shift.as_dvec3()), turn * Vec3::Z);
        for (projection, solver) in ways().filter(|(projection, _)| *projection != Projection::Point) {
            let values = solved(&scene, settings(projection, solver));
            let lighting = VertexLighting::new(&scene, &values).unwrap();
            let mut n_found = 0;
            for tri in (0..scene.triangle_count() as u32).map(TriId) {
                let at = SurfacePoint { tri, bary: Barycentrics { u: 0.5, v: 0.0 } };
                let corners = scene.triangle_positions(tri);
                let is_floor = corners.iter().all(|p| (*p - middle).dot(up).abs() < 1e-3)
                    && scene.geometric_normal(tri).dot(up) > 0.9;
                if is_floor {
                    n_found += 1;
                    let light = f64::from(lighting.irradiance(at, up).0.x);
                    // Posts hide some of the sky: less than a quarter.
                    assert!(light > 0.75 * PI && light < PI, "{place}, {projection:?}, {solver:?}: {light}");
                }
            }
            assert_eq!(n_found, n_floor_corners / 2, "{place}");
        }
    }
}

/// The faces of the Cornell box around each of its corners: the triangles of each wall that touch it.
fn corner_faces(scene: &Scene) -> BTreeMap<[i32; 6], Vec<TriId>> {
    let bounds = scene.bounds();
    // The walls as they were measured are not quite square to each other.
    let side = |x: f32, min: f32, max: f32| i32::from(max - x < 0.012) - i32::from(x - min < 0.012);
    let mut faces: BTreeMap<_, Vec<TriId>> = BTreeMap::new();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let normal = scene.geometric_normal(tri).round().as_ivec3().to_array();
        for p in scene.triangle_positions(tri) {
            let corner = [0, 1, 2].map(|k| side(p[k], bounds.min[k], bounds.max[k]));
            if !corner.contains(&0) {
                let [a, b, c] = corner;
                let [x, y, z] = normal;
                faces.entry([a, b, c, x, y, z]).or_default().push(tri);
            }
        }
    }
    faces
}

#[test]
fn corners_of_the_cornell_box_are_not_darker_than_a_converged_solve_says() {
    let opened = || lumel::open("cornell-box", &lumel::OpenOptions::default()).unwrap().builder;
    let scene = built(opened());
    let faces = corner_faces(&scene);
    assert_eq!(faces.len(), 20, "the front is open");
    // Points in the middles of nine parts of each triangle.
    let thirds: Vec<Barycentrics> = (0..3)
        .flat_map(|i| (0..3 - i).flat_map(move |j| [(i, j, 1.0), (i, j, 2.0)]))
        .filter(|(i, j, up)| *up < 1.5 || i + j < 2)
        .map(|(i, j, up)| Barycentrics { u: (i as f32 + up / 3.0) / 3.0, v: (j as f32 + up / 3.0) / 3.0 })
        .collect();
    assert_eq!(thirds.len(), 9);
    let places: Vec<Vec<SurfacePoint>> = faces
        .values()
        .map(|tris| {
            tris.iter().flat_map(|&tri| thirds.iter().map(move |&bary| SurfacePoint { tri, bary })).collect()
        })
        .collect();
    let sites = places.iter().flatten().map(|at| (*at, scene.geometric_normal(at.tri)));
    let points = PointReceivers::on_surfaces(&scene, sites).unwrap();
    let settings = |projection, seed| Settings {
        bounces: BounceLimit::Count(3),
        indirect_samples: 1024,
        seed,
        ..settings(projection, SolverKind::Cached)
    };
    let (baker, mut state) =
        (Baker::new(Arc::clone(&scene), settings(Projection::LeastSquares, 9)), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    // What is gathered is smooth: points see all of the room.
    let many =
        Settings { direct_samples: 512, indirect_samples: 4096, ..settings(Projection::LeastSquares, 9) };
    let truth =
        measure_points(&baker.relit(Arc::clone(&scene), many), &state, &points, &Control::default()).unwrap();
    let solves: Vec<Vec<Vec3>> =
        (0..6).map(|seed| solved(&scene, settings(Projection::LeastSquares, seed))).collect();
    let (mut at, mut worst) = (0, 0.0_f64);
    for (face, places) in faces.keys().zip(&places) {
        let here = at..at + places.len();
        at = here.end;
        let mean =
            |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>() / places.len() as f64;
        let expected = mean(&mut truth.irradiance[here].iter().map(|e| e.x));
        let of = |values: &Vec<Vec3>| {
            let lighting = VertexLighting::new(&scene, values).unwrap();
            mean(&mut places.iter().map(|at| lighting.irradiance(*at, Vec3::Z).0.x))
        };
        let found = Estimate::new(solves.iter().map(of));
        let (off, error) = (found.mean / expected - 1.0, found.error / expected);
        println!("{face:?}: {expected:.4}, {off:+.4} ± {error:.4}");
        worst = worst.min(off + 2.0 * error);
    }
    assert!(worst > -0.02, "darker by {worst}");
}
