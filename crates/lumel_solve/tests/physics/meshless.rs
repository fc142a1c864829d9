//! Light at scattered points: known answers that no mesh has a part in.

use crate::plan;
use glam::{EulerRot, Quat, Vec3};
use lumel_basis::{Basis, Field, MeshlessBasis, NodeWeights, PointReceivers, reflecting_areas};
use lumel_sample::SamplerKind;
use lumel_scene::{Light, ObjectMesh, Scene, SceneBuilder};
use lumel_solve::{
    Gather, Halves, Integrals, Operator, RefinedLevels, Refinement, Schedule, Shoot, Silent, SolveState,
    Stop, solve,
};
use lumel_testkit::mesh::{Facing, cuboid, equal_area_radius, quad, sphere};
use lumel_testkit::scene::{ceiling_light, cube, grey, placed, scaled, scene, two_sided, varying_sphere};
use lumel_testkit::{Estimate, ROUNDING, Solver, form_factor, measure, random_surface_points, rms, tracer};
use lumel_transport::{CachedTransport, Control, CpuTransport, Plan, Source, SurfaceWalks, Transport};
use std::sync::Arc;

/// A scene with points on its surfaces, and the operator from these to themselves.
struct Points {
    scene: Arc<Scene>,
    basis: Arc<MeshlessBasis>,
    transport: Box<dyn Transport>,
}

impl Points {
    fn new(builder: SceneBuilder, points: u64, solver: Solver, plan: Plan) -> Self {
        Self::with_levels(builder, [points, 1], solver, plan)
    }

    /// With so many points on the finest of some levels.
    fn with_levels(builder: SceneBuilder, [points, levels]: [u64; 2], solver: Solver, plan: Plan) -> Self {
        let scene = Arc::new(builder.build().expect("the test's scene builds").0);
        let spacing = MeshlessBasis::spacing_for(&scene, points);
        let tracer = tracer(&scene);
        let obstacles = SurfaceWalks { scene: &scene, tracer: &*tracer };
        let basis = MeshlessBasis::around_obstacles(Arc::clone(&scene), spacing, levels as u32, &obstacles);
        let basis = Arc::new(basis);
        let receivers = Arc::new(PointReceivers::at_nodes(&basis));
        let traced = CpuTransport::new(Arc::clone(&scene), tracer, Arc::clone(&basis), receivers, plan);
        let transport: Box<dyn Transport> = match solver {
            Solver::Traced => Box::new(traced),
            Solver::Stored => Box::new(CachedTransport::new(traced, None)),
        };
        Self { scene, basis, transport }
    }

    fn operator(&self) -> Operator<'_> {
        Operator::new(&*self.transport, &*self.basis)
    }

    fn integrals(&self) -> Integrals {
        let areas = self.basis.node_areas().to_vec();
        Integrals::new(areas, reflecting_areas(&self.scene, &*self.basis)).of_levels(self.basis.level_count())
    }

    fn solved(&self, stop: Stop) -> SolveState {
        self.solved_by(&Gather { stop })
    }

    fn solved_by(&self, schedule: &dyn Schedule) -> SolveState {
        let (mut state, control) = (SolveState::new(), Control::default());
        solve(self.operator(), &self.integrals(), schedule, &mut state, &control, &Silent)
            .expect("nobody cancels");
        state
    }

    /// All bounces.
    fn converged(&self) -> Field {
        let mut state = self.solved(Stop::Remainder { fraction: 0.02, at_most: 60 });
        state.tail = self.integrals().tail(&state.bounces);
        state.total()
    }

    /// The mean of a field over the points of the finest level.
    fn mean_at_points(&self, field: &Field) -> f64 {
        let nodes = self.basis.nodes_of_level(self.basis.level_count() - 1);
        let values = nodes.clone().map(|node| {
            let at = self.basis.points()[node as usize].at;
            f64::from(field.at(&*self.basis, at, &mut NodeWeights::default()).0.x)
        });
        values.sum::<f64>() / nodes.len() as f64
    }

    /// The mean of a field by area, where `counts` holds of the place.
    fn mean(&self, field: &Field, counts: impl Fn(Vec3) -> bool) -> f64 {
        let nodes = self.basis.points().iter().zip(self.basis.node_areas()).zip(field.values());
        let counted = nodes.filter(|((point, _), _)| counts(point.position));
        let (sum, area) = counted.fold((0.0, 0.0), |(sum, all), ((_, &area), e)| {
            (sum + f64::from(area) * f64::from(e.x), all + f64::from(area))
        });
        sum / area
    }
}

#[test]
fn every_point_of_a_furnace_sees_the_same_light() {
    let column = cuboid(Vec3::splat(0.3), Vec3::new(0.5, 0.4, 0.9), 1, Facing::Outward, [0; 6]);
    for albedo in [0.2, 0.95] {
        for solver in Solver::ALL {
            for sampler in SamplerKind::ALL {
                let mut builder = cube(1, [(); 6].map(|()| grey(albedo, 1.0)));
                builder.objects.extend(column.clone());
                let points = Points::new(builder, 500, solver, Plan { sampler, ..plan(0, 16) });
                let state = points.solved(Stop::Bounces(3));
                assert!(state.valid.iter().all(|valid| *valid), "{solver}: a point counts as hidden");
                for (bounce, field) in state.bounces.iter().enumerate() {
                    let expected = albedo.powi(bounce as i32);
                    for e in field.values() {
                        let off = f64::from(e.x / expected - 1.0).abs();
                        assert!(off < 2.0 * ROUNDING * (1.0 + bounce as f64), "{solver}, {sampler}: {off:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn irradiance_on_the_varying_sphere_is_two() {
    for (level, solver) in [(2, Solver::Stored), (4, Solver::Traced)] {
        let points = Points::new(varying_sphere(level), 800, solver, plan(3, 64));
        let field = points.converged();
        // What facets leave of the sphere, as at vertices: a quarter for each level.
        let bound = 0.5 * 0.25f64.powi(level as i32);
        let error = points.mean(&field, |_| true) - 2.0;
        assert!(error.abs() < bound + 2e-3, "level {level}: {error}");
        // 64 rays of light that varies by one half bring 1 %, and facets that face past what they stand for.
        let all = rms(field.values().iter().map(|e| f64::from(e.x) - 2.0));
        assert!(all < 0.012 + 2.0 * bound, "level {level}: {all}");
    }
}

#[test]
fn two_concentric_spheres_exchange_what_their_areas_say() {
    // As at vertices: B = 4/3 and 2/3, exactly so for these polyhedra.
    let ball = |r, facing, m| sphere(Vec3::ZERO, equal_area_radius(r, 2), 2, facing, m);
    let objects = vec![ball(0.5, Facing::Outward, 0), ball(1.0, Facing::Inward, 1)];
    let builder = scene(objects, vec![grey(0.5, 1.0), grey(0.8, 0.0)], vec![]);
    let means: Vec<[f64; 2]> = (0..8)
        .map(|seed| {
            let points = Points::new(builder.clone(), 1000, Solver::Stored, plan(seed, 64));
            let field = points.converged();
            [true, false].map(|inner| points.mean(&field, |p| (p.length() < 0.75) == inner))
        })
        .collect();
    let [on_inner, on_outer] = [0, 1].map(|k| Estimate::new(means.iter().map(|m| m[k])));
    // Points stand for the light around them: a mean of random places, though evenly spread ones.
    on_inner.assert_near(2.0 / 3.0, 1e-3, "inner");
    on_outer.assert_near(5.0 / 6.0, 1e-3, "outer");
}

#[test]
fn light_between_squares_is_what_their_form_factors_say() {
    let floor = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
    let above = [Vec3::Z, Vec3::Z + Vec3::Y, Vec3::ONE, Vec3::Z + Vec3::X];
    let beside = [Vec3::ZERO, Vec3::Y, Vec3::Y + Vec3::Z, Vec3::Z];
    let turn = Quat::from_euler(EulerRot::XYZ, 0.3, -1.1, 2.0);
    for (what, other, factor, bound) in [
        ("opposed", above, form_factor::parallel_rectangles(1.0, 1.0, 1.0), 1e-3),
        // Light falls steeply beside the common edge.
        ("at right angles", beside, form_factor::perpendicular_rectangles(1.0, 1.0, 1.0), 4e-3),
    ] {
        let pair = || {
            let objects = vec![quad(floor, [1, 1], 0), quad(other, [1, 1], 1)];
            scene(objects, vec![grey(0.5, 0.0), grey(0.5, 0.0)], vec![])
        };
        for (place, builder) in [
            ("turned and moved", placed(pair(), turn, Vec3::new(300.0, -7.0, 40.0))),
            ("tiny", scaled(pair(), 1e-3)),
            ("huge", scaled(pair(), 1e4)),
        ] {
            for solver in Solver::ALL {
                let points = Points::new(builder.clone(), 1500, solver, plan(1, 128));
                // The floor alone is lit.
                let is_floor = |i: usize| points.scene.material_id(points.basis.points()[i].at.tri).0 == 0;
                let lit = |i| Vec3::splat(f32::from(u8::from(is_floor(i))));
                let field = Field::from_values((0..points.basis.node_count()).map(lit).collect());
                let arrived = measure(&*points.transport, Source::Field(&field), 0).field;
                let areas = points.basis.node_areas();
                let on_other = (0..points.basis.node_count()).filter(|&i| !is_floor(i));
                let (sum, area) = on_other.fold((0.0, 0.0), |(sum, area), i| {
                    let a = f64::from(areas[i]);
                    (sum + a * f64::from(arrived.values()[i].x), area + a)
                });
                let found = sum / area / 0.5;
                assert!((found - factor).abs() < bound, "{what}, {place}, {solver}: {found}, not {factor}");
            }
        }
    }
}

#[test]
fn bounces_that_are_the_same_everywhere_have_coefficients_at_the_coarsest_level_alone() {
    // Within a sphere, all light arrives evenly, but for noise and what facets leave of it.
    for solver in Solver::ALL {
        let points = Points::with_levels(varying_sphere(3), [800, 4], solver, plan(3, 256));
        let state = points.solved(Stop::Bounces(2));
        let integrals = points.integrals();
        let albedo = integrals.mean_albedo();
        assert!((albedo - 0.5).abs() < 0.01, "{albedo}");
        for (bounce, field) in state.bounces.iter().enumerate() {
            let of_level = |level: u32| {
                let nodes = points.basis.nodes_of_level(level);
                rms(nodes.map(|node| f64::from(field.values()[node as usize].x)))
            };
            let even = of_level(0);
            let finer = (1..4).map(of_level).fold(0.0, f64::max);
            assert!(finer < 0.02 * even, "{solver}, bounce {bounce}: {finer} of {even}");
        }
        let mean = integrals.mean(&state.total());
        let series = points.mean_at_points(&state.total());
        assert!((mean / series - 1.0).abs() < 0.01, "{mean} {series}");
    }
}

#[test]
fn levels_find_the_light_that_one_level_finds() {
    let light = Light::Rect(ceiling_light(Vec3::new(0.5, 0.5, 0.95), 0.3, 0.3, 10.0));
    let builder = SceneBuilder { lights: vec![light], ..cube(1, [(); 6].map(|()| grey(0.6, 0.0))) };
    let found = [1, 3].map(|levels| {
        let points = Points::with_levels(builder.clone(), [800, levels], Solver::Stored, plan(2, 256));
        points.integrals().mean(&points.solved(Stop::Bounces(6)).total())
    });
    assert!((found[1] / found[0] - 1.0).abs() < 0.005, "{found:?}");
}

#[test]
fn light_does_not_pass_a_thin_wall() {
    // As at vertices: a wall without thickness divides a black room; it reflects on both sides, and only x > 0.5 is lit.
    let wall = [[-0.1, -0.1], [1.1, -0.1], [1.1, 1.1], [-0.1, 1.1]].map(|[y, z]| Vec3::new(0.5, y, z));
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, 1, Facing::Inward, [0; 6]);
    objects.push(quad(wall, [1, 1], 1));
    let light = Light::Rect(ceiling_light(Vec3::new(0.8, 0.5, 0.9), 0.3, 0.5, 10.0));
    let builder = scene(objects, vec![grey(0.0, 0.0), two_sided(grey(0.9, 0.0))], vec![light]);
    let points = Points::new(builder, 3000, Solver::Stored, plan(2, 64));
    let total = points.solved(Stop::Bounces(4)).total();
    let (mut lit, mut dark) = (0, 0);
    for (point, e) in points.basis.points().iter().zip(total.values()) {
        let (position, normal) = (point.position, point.normal);
        if position.min_element() < 0.0 || position.max_element() > 1.0 {
            continue;
        }
        if position.x > 0.501 || (position.x == 0.5 && normal.x > 0.9) {
            lit += usize::from(e.x > 0.0);
        }
        if position.x < 0.499 || (position.x == 0.5 && normal.x < -0.9) {
            dark += 1;
            assert_eq!(*e, Vec3::ZERO, "at {position}, normal {normal}");
        }
    }
    assert!(lit > 1000 && dark > 1000, "{lit} {dark}");
}

/// Measures some of the points of a hierarchy.
struct SomePoints {
    like: CachedTransport<MeshlessBasis, PointReceivers>,
    direct: CpuTransport<MeshlessBasis, PointReceivers>,
    plan: Plan,
}

impl SomePoints {
    fn new(points: &Points, plan: Plan) -> Self {
        let receivers = Arc::new(PointReceivers::at_nodes(&points.basis));
        let traced = || {
            let (scene, basis) = (Arc::clone(&points.scene), Arc::clone(&points.basis));
            CpuTransport::new(scene, tracer(&points.scene), basis, Arc::clone(&receivers), plan)
        };
        Self { like: CachedTransport::new(traced(), None), direct: traced(), plan }
    }

    /// What refines a hierarchy to an error finds, and which nodes of each level it measures.
    fn solved(&self, points: &Points, error: f64) -> (Field, Vec<f64>) {
        let (basis, control) = (&*points.basis, Control::default());
        let refinement = Refinement { error, max_nodes: usize::MAX };
        let hierarchy = basis.hierarchy().expect("several levels");
        let (mut state, of_all) = (SolveState::new(), points.operator());
        let refined = RefinedLevels::new(of_all, hierarchy, self, refinement, &mut state, &control, &Silent);
        let refined = refined.expect("nobody cancels");
        refined.prepare(basis, &mut state);
        let gather = Gather { stop: Stop::Bounces(6) };
        let operator = refined.operator(of_all);
        solve(operator, &points.integrals(), &gather, &mut state, &control, &Silent).expect("nobody cancels");
        let share = |level: u32| {
            let nodes = basis.nodes_of_level(level);
            let all = nodes.len() as f64;
            nodes.filter(|node| refined.active()[*node as usize]).count() as f64 / all
        };
        (state.total(), (0..basis.level_count()).map(share).collect())
    }
}

impl Halves for SomePoints {
    fn operator(&self, half: u32, nodes: &[bool]) -> Box<dyn Transport> {
        let plan = Plan { portion: half, indirect_samples: self.plan.indirect_samples / 2, ..self.plan };
        Box::new(self.like.with_samples(plan, nodes))
    }

    fn direct(&self) -> Option<&dyn Transport> {
        (!self.direct.needs_hemisphere()).then_some(&self.direct)
    }
}

#[test]
fn where_light_is_even_only_the_coarse_levels_are_measured() {
    let points = Points::with_levels(varying_sphere(4), [800, 4], Solver::Stored, plan(3, 256));
    // Facets leave a percent.
    let (total, shares) = SomePoints::new(&points, plan(3, 256)).solved(&points, 0.05);
    assert_eq!(shares, [1.0, 1.0, 0.0, 0.0]);
    let mean = points.integrals().mean(&total);
    assert!((mean / 2.0 - 1.0).abs() < 0.02, "{mean}, after six bounces of albedo 0.5");
}

#[test]
fn a_hierarchy_that_follows_light_finds_what_all_of_its_points_find() {
    // A light in a corner, close to the walls.
    let light = Light::Rect(ceiling_light(Vec3::new(0.15, 0.15, 0.3), 0.1, 0.1, 100.0));
    let builder = SceneBuilder { lights: vec![light], ..cube(1, [(); 6].map(|()| grey(0.6, 0.0))) };
    let points = Points::with_levels(builder, [3000, 4], Solver::Stored, plan(2, 128));
    let all = points.solved(Stop::Bounces(6)).total();
    let some = SomePoints::new(&points, plan(2, 128));
    let mut weights = NodeWeights::default();
    let mut before = 0.0;
    for (error, off, most) in [(0.2, 0.05, 0.3), (0.05, 0.02, 0.9)] {
        let (total, shares) = some.solved(&points, error);
        let places = random_surface_points(&points.scene, 4000, 9);
        let read = |field: &Field, at, weights: &mut NodeWeights| {
            f64::from(field.at(&*points.basis, at, weights).0.x)
        };
        let pairs: Vec<[f64; 2]> =
            places.into_iter().map(|at| [&total, &all].map(|field| read(field, at, &mut weights))).collect();
        let square = |of: fn(&[f64; 2]) -> f64| pairs.iter().map(|pair| of(pair).powi(2)).sum::<f64>();
        let found = (square(|[some, all]| some - all) / square(|[_, all]| *all)).sqrt();
        let nodes = (0..4).map(|level| points.basis.nodes_of_level(level).len() as f64);
        let share = nodes.clone().zip(&shares).map(|(n, share)| n * share).sum::<f64>() / nodes.sum::<f64>();
        println!("error {error}: {found}, {share} of the nodes, by level {shares:?}");
        assert!(found < off && share < most && share > before, "{error}: {found} {share}");
        before = share;
    }
}

/// A wall across the room at x = 0.5, from the floor to above the ceiling.
fn partition(thickness: f32, cells: u32) -> Vec<ObjectMesh> {
    let [near, far] = [-1.0, 1.0].map(|side| 0.5 + 0.5 * side * thickness);
    cuboid(Vec3::new(near, -0.1, -0.1), Vec3::new(far, 1.1, 1.1), cells, Facing::Outward, [1; 6])
}

#[test]
fn light_does_not_pass_under_a_wall_that_stands_on_the_floor() {
    // One floor for two rooms with nothing in common: light of the one is read nowhere in the other, on any level, however
    // the floor is cut into triangles, for points twice as far apart as the rooms are wide, too.
    for (thickness, cells, points, levels, bound) in [
        (0.02, 1, 1500, 1, 2e-4),
        (0.002, 1, 1500, 3, 2e-4),
        (0.0, 1, 1500, 1, 2e-4),
        (0.02, 13, 400, 2, 2e-4),
        (0.3, 1, 60, 1, 2e-3),
    ] {
        let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, cells, Facing::Inward, [0; 6]);
        let wall = if thickness > 0.0 {
            partition(thickness, 1)
        } else {
            let corners = [[-0.1, -0.1], [1.1, -0.1], [1.1, 1.1], [-0.1, 1.1]];
            vec![quad(corners.map(|[y, z]| Vec3::new(0.5, y, z)), [1, 1], 2)]
        };
        objects.extend(wall);
        let light = Light::Rect(ceiling_light(Vec3::new(0.8, 0.5, 0.9), 0.3, 0.5, 10.0));
        let materials = vec![grey(0.7, 0.0), grey(0.5, 0.0), two_sided(grey(0.5, 0.0))];
        let builder = scene(objects, materials, vec![light]);
        let points = Points::with_levels(builder, [points, levels], Solver::Stored, plan(2, 32));
        let total = points.solved(Stop::Bounces(3)).total();
        let what = format!("{thickness} m, {cells} cells, {levels} levels");
        let (mut dark, mut lit, mut weights) = (Vec::new(), Vec::new(), NodeWeights::default());
        for at in random_surface_points(&points.scene, 20_000, 5) {
            let (position, normal) = (points.scene.position(at), points.scene.geometric_normal(at.tri));
            let is_in_room = position.min_element() >= 0.0 && position.max_element() <= 1.0;
            let is_of_wall = (position.x - 0.5).abs() < 0.5 * thickness + 1e-4;
            if !is_in_room || is_of_wall && normal.x.abs() < 0.5 {
                continue;
            }
            let is_lit = if is_of_wall { normal.x > 0.0 } else { position.x > 0.5 };
            let found = f64::from(total.at(&*points.basis, at, &mut weights).0.x);
            if is_lit {
                lit.push(found)
            } else {
                dark.push(found.abs())
            };
        }
        assert!(dark.len() > 3000 && lit.len() > 3000, "{what}: {} dark, {} lit", dark.len(), lit.len());
        assert!(lit.iter().all(|found| *found > 0.05), "{what}: a dark place in the lit room");
        let [mean_dark, mean_lit] = [dark, lit].map(|found| found.iter().sum::<f64>() / found.len() as f64);
        println!("{what}: {:.1e}", mean_dark / mean_lit);
        // Places at the very foot of the wall may be read from both of its sides.
        assert!(mean_dark < bound * mean_lit, "{what}: {mean_dark} {mean_lit}");
    }
}

#[test]
fn shooting_and_gathering_find_the_same_light() {
    let light = Light::Rect(ceiling_light(Vec3::new(0.5, 0.5, 0.95), 0.3, 0.3, 10.0));
    let builder = || SceneBuilder { lights: vec![light], ..cube(1, [(); 6].map(|()| grey(0.6, 0.0))) };
    for solver in Solver::ALL {
        let points = Points::new(builder(), 200, solver, plan(2, 32));
        let shot = points.solved_by(&Shoot { remainder: 1e-4 });
        let [shot, gathered] = [shot.total(), points.solved(Stop::Bounces(40)).total()];
        let [shot, gathered] = [shot, gathered].map(|field| points.mean(&field, |_| true));
        // What may be missing; rays of their own for every bounce have noise of their own.
        let bound = if solver == Solver::Stored { 2e-4 } else { 2e-3 };
        assert!((shot / gathered - 1.0).abs() < bound, "{solver}: {shot} {gathered}");
    }
}
