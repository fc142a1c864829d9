//! Surfaces that emit, found by shadow rays and hemisphere rays together.

use glam::{DVec3, Vec2, Vec3};
use lumel_sample::SamplerKind;
use lumel_scene::{Filter, MaterialId, ObjectMesh, SceneBuilder, Texture, TextureId, TextureRef};
use lumel_testkit::mesh::{Facing, quad, sphere};
use lumel_testkit::scene::{ceiling_light, cube, grey, scene};
use lumel_testkit::{
    AtPoints, Combination, Estimate, ROUNDING, Stage, Storage, assert_nodes_near, form_factor, measure,
    ratio_bias, replicates,
};
use lumel_transport::{EmitterSampling, Plan, Source};
use std::f64::consts::PI;

/// A point on a floor.
const POINT: (Vec3, Vec3) = (Vec3::new(0.2, 0.1, 0.0), Vec3::Z);

fn by_sobol() -> impl Iterator<Item = AtPoints> {
    AtPoints::all().filter(|combination| combination.estimator.sampler == SamplerKind::Sobol)
}

fn square(half: f32, cells: u32, facing_down: bool, height: f32, material: u32) -> ObjectMesh {
    let mut corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    if facing_down {
        corners.reverse();
    }
    quad(corners.map(|[x, y]| Vec3::new(x * half, y * half, height)), [cells; 2], material)
}

/// A floor and above it a panel whose picture has one lit texel of `side * side`; the corners of that.
fn one_texel(side: u32, cells: u32, filter: Filter) -> (SceneBuilder, [DVec3; 4]) {
    let (column, row) = (side * 2 / 3, side / 5);
    let mut texels = vec![[0.0; 3]; (side * side) as usize];
    texels[(row * side + column) as usize] = [1.0; 3];
    let mut picture = Texture::from_floats("spark", side, side, texels).expect("texels");
    picture.filter = filter;
    let mut material = grey(0.0, 1e6);
    material.emission_texture = Some(TextureRef::plain(TextureId(0)));
    let mut panel = square(1.0, cells, true, 1.0, 1);
    panel.uvs = panel.positions.iter().map(|p| Vec2::new(p.x, p.y) * 0.5 + 0.5).collect();
    let builder = scene(vec![square(0.5, 3, false, 0.0, 0), panel], vec![grey(0.0, 0.0), material], vec![]);
    let at = |x: u32, y: u32| {
        let [x, y] = [column + x, row + y].map(|k| 2.0 * f64::from(k) / f64::from(side) - 1.0);
        DVec3::new(x, y, 1.0)
    };
    let corners = [at(0, 0), at(0, 1), at(1, 1), at(1, 0)];
    (SceneBuilder { textures: vec![picture], ..builder }, corners)
}

#[test]
fn one_lit_texel_of_a_million_is_found_by_few_shadow_rays() {
    let cases = [
        (1024, 1, Filter::Linear),
        (32, 1, Filter::Nearest),
        (32, 1, Filter::Linear),
        (64, 5, Filter::Linear),
    ];
    for (side, cells, filter) in cases {
        let (builder, corners) = one_texel(side, cells, filter);
        let stage = Stage::new(builder);
        let truth = 1e6 * form_factor::polygon(&corners, POINT.0.as_dvec3(), DVec3::Z);
        for emitters in [EmitterSampling::Auto, EmitterSampling::Lights] {
            // The table of a large picture takes a while to make, for each replicate.
            let (combinations, replicas) = if side > 100 { (1, 6) } else { (usize::MAX, 32) };
            for combination in by_sobol().take(combinations) {
                let plan = Plan { emitters, ..combination.estimator.plan(64, 64) };
                let transport = stage.points(combination.solver, &[POINT], plan);
                let estimate =
                    Estimate::of_node(&replicates(&*transport, Source::Emitters(None), replicas), 0);
                let what = format!("{side} texels, {filter:?}, {cells} cells, {emitters:?}, {combination}");
                estimate.assert_near(truth, 1e-3 * truth, &what);
                let one = estimate.error * (estimate.count as f64).sqrt();
                assert!(one < 0.5 * truth, "{what}: {one} of {truth}");
            }
        }
    }
}

#[test]
fn one_lit_texel_lights_a_floor_in_every_combination() {
    let (builder, corners) = one_texel(32, 3, Filter::Linear);
    let stage = Stage::new(builder);
    for combination in Combination::all().filter(|c| c.estimator.sampler == SamplerKind::Sobol) {
        let operator = stage.operator(combination.method, combination.estimator.plan(64, 64));
        let lit = |p, n: DVec3| if n.z < 0.0 { 0.0 } else { 1e6 * form_factor::polygon(&corners, p, n) };
        let expected = stage.expected(&operator, &lit);
        let fields = replicates(&*operator.transport, Source::Emitters(None), 32);
        let is_ratio = combination.method.storage == Storage::VertexArea;
        let bound = if is_ratio { ratio_bias(32, 0.3) } else { 1e-3 };
        assert_nodes_near(&fields, &expected, bound, combination);
    }
}

#[test]
fn a_glowing_square_of_many_triangles_lights_like_the_polygon_even_from_close_by() {
    for height in [1.0, 0.01] {
        let glowing = square(1.0, 5, true, height, 1);
        let materials = vec![grey(0.0, 0.0), grey(0.0, 1.0)];
        let stage = Stage::new(scene(vec![square(2.0, 1, false, 0.0, 0), glowing], materials, vec![]));
        let rect = ceiling_light(Vec3::Z * height, 2.0, 2.0, 1.0);
        let corners = rect.corners().map(|corner| corner.as_dvec3());
        let points = [POINT, (Vec3::new(0.99, 0.3, 0.0), Vec3::Z), (Vec3::new(1.1, 0.3, 0.0), -Vec3::X)];
        for combination in by_sobol() {
            let transport = stage.points(combination.solver, &points, combination.estimator.plan(64, 64));
            let fields = replicates(&*transport, Source::Emitters(None), 64);
            for (i, (point, normal)) in points.into_iter().enumerate() {
                let truth = form_factor::polygon(&corners, point.as_dvec3(), normal.as_dvec3());
                let what = format!("{height} m, point {i}, {combination}");
                Estimate::of_node(&fields, i).assert_near(truth, 1e-3 * truth + 1e-6, what);
            }
        }
    }
}

#[test]
fn shadow_rays_lower_the_noise_of_surfaces_that_emit_over_a_third_of_the_scene() {
    // Rectangles that nothing is in front of have none.
    let mut dome = sphere(Vec3::ZERO, 1.0, 2, Facing::Inward, 0);
    dome.faces.iter_mut().step_by(3).for_each(|face| face.material = MaterialId(1));
    let stage = Stage::new(scene(vec![dome], vec![grey(0.0, 0.0), grey(0.0, PI as f32)], vec![]));
    let noise = |direct_samples: u32| {
        let plan = Plan { direct_samples, indirect_samples: 64, ..Plan::default() };
        let transport = stage.points(lumel_testkit::Solver::Stored, &[(Vec3::splat(0.3), Vec3::Y)], plan);
        Estimate::of_node(&replicates(&*transport, Source::Emitters(None), 64), 0).error
    };
    let [few, many] = [16, 256].map(noise);
    assert!(many < 0.5 * few, "{many} {few}");
}

#[test]
fn a_closed_cube_that_emits_everywhere_has_no_noise() {
    let stage = Stage::new(cube(3, [(); 6].map(|()| grey(0.5, 2.0))));
    for combination in AtPoints::all() {
        let points = [(Vec3::splat(0.3), Vec3::Y), (Vec3::new(1e-3, 0.5, 0.5), Vec3::X)];
        let transport = stage.points(combination.solver, &points, combination.estimator.plan(4, 4));
        for value in measure(&*transport, Source::Emitters(None), 0).field.values() {
            assert!((f64::from(value.x) / 2.0 - 1.0).abs() < ROUNDING, "{combination}: {value}");
        }
    }
}
