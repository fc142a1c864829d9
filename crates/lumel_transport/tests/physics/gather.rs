//! One bounce: the hemisphere form against form factors.

use glam::Vec3;
use lumel_sample::SamplerKind;
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{backdrop, cube, grey, scene};
use lumel_testkit::{
    AtPoints, Estimate, Method, ROUNDING, Solver, Stage, Storage, assert_nodes_near, form_factor, measure,
    ratio_bias, replicates,
};
use lumel_transport::{EmitterSampling, Plan, Source};
use std::f64::consts::PI;

/// A point on the floor of the unit cube.
const POINT: (Vec3, Vec3) = (Vec3::new(0.3, 0.2, 0.0), Vec3::Z);

/// Form factors from there to the walls x = 0, x = 1, y = 0, y = 1 and z = 1.
const FACTORS: [f64; 5] = [0.247926066985, 0.112114871733, 0.334417689676, 0.098892003783, 0.206649367823];

/// Radiances of these walls.
const RADIANCES: [f64; 5] = [0.1, 0.9, 0.3, 0.6, 1.0];
const IRRADIANCE: f64 = 1.545682021;

/// The origin is pushed 1.5e-5 up; the form factor of the nearest wall, 0.2 away, changes by 1e-4 of itself.
const ORIGIN_SHIFT: f64 = 1e-4;

/// The index of the wall with this inward normal among the five, if it is one of them.
fn wall(normal: Vec3) -> Option<usize> {
    [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, -Vec3::Z].iter().position(|n| n.dot(normal) > 0.9)
}

/// Every solver with every sampler: what matters for the gather at a point.
pub(crate) fn gathers() -> impl Iterator<Item = (Solver, SamplerKind)> {
    Solver::ALL.into_iter().flat_map(|solver| SamplerKind::ALL.map(|sampler| (solver, sampler)))
}

fn plan(sampler: SamplerKind, samples: u32) -> Plan {
    Plan { sampler, indirect_samples: samples, direct_samples: samples, ..Plan::default() }
}

#[test]
fn each_wall_of_a_cube_is_seen_by_its_form_factor() {
    assert!((FACTORS.iter().sum::<f64>() - 1.0).abs() < 1e-11);
    let stage = Stage::new(cube(2, [(); 6].map(|()| grey(0.5, 0.0))));
    for (n, factor) in FACTORS.into_iter().enumerate() {
        // Irradiance 2 on one wall of albedo 0.5: its radiosity is one.
        let source = stage.field(|_, normal| if wall(normal) == Some(n) { 2.0 } else { 0.0 });
        for (solver, sampler) in gathers() {
            let transport = stage.points(solver, &[POINT], plan(sampler, 64));
            let fields = replicates(&*transport, Source::Field(&source), 64);
            let label = format!("wall {n}, {solver}, {sampler}");
            Estimate::of_node(&fields, 0).assert_near(factor, ORIGIN_SHIFT * factor, label);
        }
    }
}

#[test]
fn reflected_light_of_a_cube_with_constant_walls_is_the_sum_over_its_walls() {
    let albedos = [0.2, 0.4, 0.5, 0.7, 0.9, 0.9];
    // Materials: -x, +x, -y, +y, -z, +z; the floor stays dark.
    let stage = Stage::new(cube(2, albedos.map(|albedo| grey(albedo, 0.0))));
    let albedo_of = [0.2f32, 0.4, 0.5, 0.7, 0.9];
    let source = stage.field(|_, n| wall(n).map_or(0.0, |w| (RADIANCES[w] * PI) as f32 / albedo_of[w]));
    for (solver, sampler) in gathers() {
        let transport = stage.points(solver, &[POINT], plan(sampler, 64));
        let fields = replicates(&*transport, Source::Field(&source), 64);
        let label = format!("{solver}, {sampler}");
        Estimate::of_node(&fields, 0).assert_near(IRRADIANCE, ORIGIN_SHIFT * IRRADIANCE, label);
    }
}

#[test]
fn emissive_walls_light_the_same_by_rays_and_as_lights() {
    let glow = |w: usize| grey(0.0, (RADIANCES[w] * PI) as f32);
    let stage = Stage::new(cube(1, [glow(0), glow(1), glow(2), glow(3), grey(0.0, 0.0), glow(4)]));
    for emitters in [EmitterSampling::Auto, EmitterSampling::Rays, EmitterSampling::Lights] {
        for combination in AtPoints::all() {
            let plan = Plan { emitters, ..combination.estimator.plan(64, 64) };
            let transport = stage.points(combination.solver, &[POINT], plan);
            let fields = replicates(&*transport, Source::Emitters(None), 64);
            let label = format!("{emitters:?}, {combination}");
            Estimate::of_node(&fields, 0).assert_near(IRRADIANCE, ORIGIN_SHIFT * IRRADIANCE, label);
        }
    }
}

#[test]
fn every_node_of_a_cube_gathers_the_opposite_wall_by_its_form_factor() {
    let stage = Stage::new(cube(2, [(); 6].map(|()| grey(0.5, 0.0))));
    let source = stage.field(|_, n| if n.z < -0.9 { 2.0 } else { 0.0 });
    let ceiling = form_factor::facing_down([0.0, 1.0], [0.0, 1.0], 1.0);
    for method in Method::ALL {
        for sampler in SamplerKind::ALL {
            let operator = stage.operator(method, plan(sampler, 64));
            let expected = stage.expected(&operator, &|point, normal| {
                // On walls irradiance is not smooth at the ceiling's edge: their quadrature is not exact.
                if normal.z > 0.9 { form_factor::polygon(&ceiling, point, normal) } else { f64::NAN }
            });
            let fields = replicates(&*operator.transport, Source::Field(&source), 48);
            let bound = if method.storage == Storage::VertexArea { ratio_bias(32, 0.15) } else { 1e-4 };
            assert_nodes_near(&fields, &expected, bound, format!("{method}, {sampler}"));
            let on_ceiling =
                stage.nodes().into_iter().zip(fields[0].values()).filter(|((_, n), _)| n.z < -0.9);
            on_ceiling.for_each(|(_, e)| {
                assert_eq!(*e, Vec3::ZERO, "{method}, {sampler}: a wall does not see itself")
            });
        }
    }
}

/// Measures irradiance from patches of radiosity one in the plane z = 0, blocked by black `screens`.
#[track_caller]
fn assert_reflected(
    patch: lumel_scene::ObjectMesh,
    screens: Vec<lumel_scene::ObjectMesh>,
    point: (Vec3, Vec3),
    truth: f64,
) {
    let mut objects = vec![patch];
    objects.extend(screens);
    let stage = Stage::new(scene(objects, vec![grey(0.5, 0.0), grey(0.0, 0.0)], vec![]));
    let source = stage.field(|_, _| 2.0);
    for (solver, sampler) in gathers() {
        let transport = stage.points(solver, &[point], plan(sampler, 256));
        let fields = replicates(&*transport, Source::Field(&source), 64);
        Estimate::of_node(&fields, 0).assert_near(
            truth,
            ORIGIN_SHIFT * truth,
            format!("{point:?}, {solver}, {sampler}"),
        );
    }
}

fn patch(x: [f32; 2], y: [f32; 2]) -> lumel_scene::ObjectMesh {
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| Vec3::new(x[i], y[j], 0.0));
    quad(corners, [2, 2], 0)
}

#[test]
fn an_evenly_lit_patch_is_a_secondary_source() {
    // CIE 171:2006 5.6 in style: a receiver two metres over the centre, facing down.
    for (side, factor) in [(0.5, 0.019488765), (4.0, 0.554126424), (500.0, 0.999947631)] {
        let half = 0.5 * side;
        let above = (Vec3::Z * 2.0, -Vec3::Z);
        assert_reflected(patch([-half, half], [-half, half]), vec![], above, factor);
    }
    // Facing in over the middle of an edge.
    let sides = [
        (4.0, [0.403837515, 0.317549609, 0.190135882]),
        (500.0, [0.499215798, 0.498431601, 0.496863250]),
        (0.5, [0.071093439, 0.015347449, 0.002317169]),
    ];
    for (side, factors) in sides {
        for (z, factor) in [0.5, 1.0, 2.0].into_iter().zip(factors) {
            let half = 0.5 * side;
            let edge = (Vec3::new(0.0, 0.0, z), Vec3::X);
            assert_reflected(patch([0.0, side], [-half, half]), vec![], edge, factor);
        }
    }
}

#[test]
fn a_screen_hides_part_of_a_secondary_source() {
    // CIE 171:2006 5.7 in style: a wide screen of height 1 stands across the patch at x = 1.
    let known =
        [(0.5, 0.270976794), (1.0, 0.137394598), (1.5, 0.101034043), (2.0, 0.120910363), (2.5, 0.113854412)];
    for (z, factor) in known {
        let corners =
            [[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]].map(|[y, z]| Vec3::new(1.0, 100.0 * y, z));
        let receiver = (Vec3::new(0.0, 0.0, z), Vec3::X);
        assert_reflected(patch([0.0, 4.0], [-2.0, 2.0]), vec![quad(corners, [1, 1], 1)], receiver, factor);
    }
}

#[test]
fn albedo_zero_sends_nothing_on() {
    let stage = Stage::new(cube(2, [(); 6].map(|()| grey(0.0, 0.0))));
    let source = stage.field(|_, _| 1000.0);
    for method in Method::ALL {
        let operator = stage.operator(method, plan(SamplerKind::Sobol, 16));
        let field = measure(&*operator.transport, Source::Field(&source), 0).field;
        assert!(field.values().iter().all(|e| *e == Vec3::ZERO), "{method}");
    }
}

#[test]
fn the_back_of_a_one_sided_wall_is_black_and_both_sides_of_a_two_sided_one_shine() {
    let wall =
        quad([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(|[x, y]| Vec3::new(x, y, 1.0)), [1, 1], 1);
    let above = (Vec3::new(0.5, 0.5, 2.0), -Vec3::Z);
    let below = (Vec3::new(0.5, 0.5, 0.0), Vec3::Z);
    let factor = 4.0 * form_factor::element_to_parallel_rectangle(0.5, 0.5, 1.0);
    for (material, shining) in
        [(grey(0.5, 0.0), [0.0, factor]), (lumel_testkit::scene::two_sided(grey(0.5, 0.0)), [factor; 2])]
    {
        let stage = Stage::new(scene(vec![backdrop(), wall.clone()], vec![grey(0.0, 0.0), material], vec![]));
        let source = stage.field(|_, _| 2.0);
        for solver in Solver::ALL {
            let transport = stage.points(solver, &[above, below], plan(SamplerKind::Sobol, 256));
            let fields = replicates(&*transport, Source::Field(&source), 32);
            for (side, truth) in shining.into_iter().enumerate() {
                let label = format!("side {side}, {solver}");
                Estimate::of_node(&fields, side).assert_near(truth, ORIGIN_SHIFT * truth, label);
            }
        }
    }
}

#[test]
fn corners_of_a_room_see_the_whole_room() {
    // With all walls alike a ray that leaves the room or starts outside is missing at once.
    let (min, max) = (Vec3::new(-1.3, 0.2, -0.7), Vec3::new(0.9, 1.1, 2.5));
    let stage = Stage::new(scene(cuboid(min, max, 2, Facing::Inward, [0; 6]), vec![grey(0.5, 0.0)], vec![]));
    let source = stage.field(|_, _| 2.0);
    for method in Method::ALL {
        for sampler in SamplerKind::ALL {
            let operator = stage.operator(method, plan(sampler, 256));
            let field = measure(&*operator.transport, Source::Field(&source), 0).field;
            for (node, e) in field.values().iter().enumerate() {
                let off = f64::from(e.x) - 1.0;
                assert!(off.abs() < ROUNDING, "{method}, {sampler}, node {node}: off by {off:e}");
            }
        }
    }
}

#[test]
fn the_back_of_a_one_sided_wall_is_black_for_every_basis() {
    // Half of what a small floor sees is the emissive ceiling of radiosity one, part of it behind a one-sided screen
    // that shows its back: counted as darkness, not as unknown.
    let rectangle = |x: [f32; 2], y: [f32; 2], z, material| {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| Vec3::new(x[i], y[j], z));
        quad(corners, [1, 1], material)
    };
    let floor = rectangle([-0.1, 0.1], [-0.1, 0.1], 0.0, 1);
    let screen = rectangle([0.0, 1.0], [-1.0, 1.0], 0.5, 1);
    let ceiling = rectangle([8.0, -8.0], [-8.0, 8.0], 1.0, 0);
    let stage = Stage::new(scene(vec![floor, screen, ceiling], vec![grey(0.5, 0.0), grey(0.0, 0.0)], vec![]));
    let source = stage.field(|_, n| if n.z < 0.0 { 2.0 } else { 0.0 });
    let [lit, hidden] = [([-8.0, 8.0], [-8.0, 8.0], 1.0), ([0.0, 1.0], [-1.0, 1.0], 0.5)]
        .map(|(x, y, z)| form_factor::facing_down(x, y, z));
    for method in Method::ALL {
        for sampler in SamplerKind::ALL {
            let operator = stage.operator(method, plan(sampler, 64));
            let expected = stage.expected(&operator, &|p, n| {
                if p.z > 0.1 {
                    f64::NAN
                } else {
                    form_factor::polygon(&lit, p, n) - form_factor::polygon(&hidden, p, n)
                }
            });
            // A third of the hemisphere is the screen's back. Of the origins there that are asked, one in fifty
            // counts as inside by chance: 0.7 % of all samples, all of them dark.
            let bound =
                if method.storage == Storage::VertexArea { ratio_bias(32, 0.15) + 7e-3 } else { 1e-4 };
            let fields = replicates(&*operator.transport, Source::Field(&source), 48);
            assert_nodes_near(&fields, &expected, bound, format!("{method}, {sampler}"));
        }
    }
}
