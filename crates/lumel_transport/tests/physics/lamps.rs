//! Lights of every kind, alone and together.

use glam::{DVec3, Vec2, Vec3};
use lumel_scene::{
    DirectionalLight, Light, ObjectMesh, PointLight, RectLight, SceneBuilder, SpotLight, Texture, TextureId,
    TextureRef, Wrap,
};
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::{ceiling_light, grey, lights_only, scene};
use lumel_testkit::{
    AtPoints, Combination, Estimate, Method, ROUNDING, Solver, Stage, Storage, assert_nodes_near,
    form_factor, measure, ratio_bias, replicates,
};
use lumel_transport::{EmitterSampling, Plan, Source};
use std::f64::consts::PI;

/// Irradiance at a point for lights that need no random numbers.
fn lit(light: Light, point: Vec3, normal: Vec3) -> f64 {
    let stage = Stage::new(lights_only(vec![light]));
    let [stored, traced] = Solver::ALL.map(|solver| {
        let transport = stage.points(solver, &[(point, normal)], Plan::default());
        f64::from(measure(&*transport, Source::Emitters(None), 0).field.values()[0].x)
    });
    assert_eq!(stored, traced, "every solver traces shadow rays, {light:?}");
    stored
}

/// `[0, 1]²` in the xy plane, facing up.
fn floor(cells: u32) -> ObjectMesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    quad(corners, [cells; 2], 0)
}

#[test]
fn directional_lights_fall_with_the_cosine() {
    let direction = Vec3::new(0.6, 0.0, -0.8);
    let sun = Light::Directional(DirectionalLight { direction, irradiance: Vec3::splat(5.0) });
    assert!((lit(sun, Vec3::ZERO, Vec3::Z) / 4.0 - 1.0).abs() < ROUNDING);
    assert!((lit(sun, Vec3::ZERO, -Vec3::X) / 3.0 - 1.0).abs() < ROUNDING);
    assert_eq!(lit(sun, Vec3::ZERO, Vec3::X), 0.0, "turned away");
}

#[test]
fn spot_lights_fade_between_their_cones() {
    let point = PointLight { position: Vec3::Z * 2.0, intensity: Vec3::splat(8.0), range: f32::INFINITY };
    let (cos_inner, cos_outer) = (0.95, 0.7);
    let spot = Light::Spot(SpotLight { point, direction: -Vec3::Z, cos_inner, cos_outer });
    for x in [0.0f64, 0.5, 1.0, 1.5, 1.9, 2.2, 5.0] {
        // The origin is pushed up: see `Scene::ray_origin_at`; the scene's triangles have an area of 2 m².
        let height = 2.0 - 16.0 * f64::from(f32::EPSILON) * (x + 2f64.sqrt());
        let squared = x * x + height * height;
        let cos = height / squared.sqrt();
        let share =
            ((cos - f64::from(cos_outer)) / (f64::from(cos_inner) - f64::from(cos_outer))).clamp(0.0, 1.0);
        let truth = 8.0 * share * share * cos / squared;
        let e = lit(spot, Vec3::X * x as f32, Vec3::Z);
        // Where the cone has almost faded, the rounding of a cosine near 0.72 counts 80 times: 6e-8 / (cos - 0.7).
        assert!((e - truth).abs() <= 2e-5 * truth, "x = {x}: {e} {truth}");
    }
}

#[test]
fn point_lights_end_at_their_range() {
    let light =
        |range| Light::Point(PointLight { position: Vec3::Z * 2.0, intensity: Vec3::splat(4.0), range });
    assert!((lit(light(f32::INFINITY), Vec3::ZERO, Vec3::Z) - 1.0).abs() < 1e-4);
    assert_eq!(lit(light(1.9), Vec3::ZERO, Vec3::Z), 0.0);
    // glTF's window at half the range: 1 - (1/2)^4.
    assert!((lit(light(4.0), Vec3::ZERO, Vec3::Z) - 15.0 / 16.0).abs() < 1e-4);
}

#[test]
fn lights_without_area_throw_sharp_shadows_in_every_basis() {
    let screen = quad(
        [[-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]].map(|[x, y]| Vec3::new(x, y, 1.0)),
        [1, 1],
        0,
    );
    let point = PointLight { position: Vec3::new(0.5, 0.5, 3.0), intensity: Vec3::ONE, range: f32::INFINITY };
    let lights = [
        Light::Point(point),
        Light::Spot(SpotLight { point, direction: -Vec3::Z, cos_inner: 0.9, cos_outer: 0.5 }),
        Light::Directional(DirectionalLight { direction: -Vec3::Z, irradiance: Vec3::ONE }),
    ];
    for light in lights {
        for method in Method::ALL {
            let dark = |objects| {
                let stage = Stage::new(scene(objects, vec![grey(0.0, 0.0)], vec![light]));
                let operator = stage.operator(method, Plan { direct_samples: 16, ..Plan::default() });
                let field = measure(&*operator.transport, Source::Emitters(None), 0).field;
                stage
                    .nodes()
                    .iter()
                    .zip(field.values())
                    .filter(|((p, _), _)| p.z < 0.5)
                    .all(|(_, e)| *e == Vec3::ZERO)
            };
            assert!(!dark(vec![floor(2)]), "{method}: nothing is in the way");
            assert!(dark(vec![floor(2), screen.clone()]), "{method}, {light:?}");
        }
    }
}

/// Irradiance of radiance one from a rectangle that faces down.
fn rect_truth(rect: &RectLight, point: DVec3, normal: DVec3) -> f64 {
    PI * form_factor::polygon(&rect.corners().map(|p| p.as_dvec3()), point, normal)
}

#[test]
fn several_lights_add_up_in_every_combination() {
    // Large and close, so that it matters where on each of them samples lie.
    let rects = [
        ceiling_light(Vec3::new(-0.3, 0.4, 0.4), 0.8, 1.2, 1.0),
        ceiling_light(Vec3::new(1.2, 0.9, 0.5), 1.0, 0.7, 3.0),
        ceiling_light(Vec3::new(0.5, 0.2, 0.3), 0.3, 0.3, 2.0),
    ];
    let stage = Stage::new(scene(vec![floor(2)], vec![grey(0.0, 0.0)], rects.map(Light::Rect).into()));
    for combination in Combination::all() {
        let operator = stage.operator(combination.method, combination.estimator.plan(128, 1));
        let truth =
            |p: DVec3, n: DVec3| rects.iter().map(|r| f64::from(r.radiance.0.x) * rect_truth(r, p, n)).sum();
        let expected = stage.expected(&operator, &truth);
        let fields = replicates(&*operator.transport, Source::Emitters(None), 48);
        let bound =
            if combination.method.storage == Storage::VertexArea { ratio_bias(64, 0.3) } else { 1e-4 };
        assert_nodes_near(&fields, &expected, bound, combination);
    }
}

#[test]
fn sky_and_lights_add_up_in_every_combination() {
    let rect = ceiling_light(Vec3::new(0.2, 0.4, 0.4), 0.8, 1.2, 1.0);
    let mut builder = scene(vec![floor(2)], vec![grey(0.0, 0.0)], vec![Light::Rect(rect)]);
    builder.sky = lumel_scene::Radiance::splat(0.5).into();
    let stage = Stage::new(builder);
    for combination in Combination::all() {
        let operator = stage.operator(combination.method, combination.estimator.plan(128, 16));
        let expected = stage.expected(&operator, &|p, n| 0.5 * PI + rect_truth(&rect, p, n));
        let fields = replicates(&*operator.transport, Source::Emitters(None), 32);
        let bound =
            if combination.method.storage == Storage::VertexArea { ratio_bias(64, 0.3) } else { 1e-4 };
        assert_nodes_near(&fields, &expected, bound, combination);
    }
}

#[test]
fn many_lights_are_chosen_without_bias() {
    // Nine that shine, of very different power, and one that does not.
    let rect = |i: u32| {
        let (x, y) = ((i % 3) as f32 * 0.5, (i / 3) as f32 * 0.5);
        ceiling_light(Vec3::new(x, y, 0.7), 0.2, 0.3, (i * i) as f32)
    };
    let rects: Vec<RectLight> = (0..10).map(rect).collect();
    let lights = rects.iter().copied().map(Light::Rect).collect();
    let stage = Stage::new(scene(vec![floor(2)], vec![grey(0.0, 0.0)], lights));
    for combination in Combination::all() {
        let operator = stage.operator(combination.method, combination.estimator.plan(128, 1));
        let truth =
            |p: DVec3, n: DVec3| rects.iter().map(|r| f64::from(r.radiance.0.x) * rect_truth(r, p, n)).sum();
        let expected = stage.expected(&operator, &truth);
        let fields = replicates(&*operator.transport, Source::Emitters(None), 48);
        let bound =
            if combination.method.storage == Storage::VertexArea { ratio_bias(64, 0.3) } else { 1e-4 };
        assert_nodes_near(&fields, &expected, bound, combination);
    }
}

/// Four by four texels, some black, without any symmetry.
fn picture() -> Texture {
    let texels = [0.0, 0.0, 3.0, 1.0, 0.2, 0.0, 0.0, 5.0, 1.0, 0.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.5];
    let mut texture =
        Texture::from_floats("picture", 4, 4, texels.map(|t| [t; 3]).into()).expect("sixteen texels");
    (texture.wrap_u, texture.wrap_v) = (Wrap::Clamp, Wrap::Clamp);
    texture
}

/// Irradiance from a rectangle whose radiance is a picture, cut into constant pieces.
///
/// The image's right is +u, its top +v. Pieces of 1/64 leave an error of some 1e-4 with 16 of them to a texel.
fn picture_truth(rect: &RectLight, picture: &Texture, point: DVec3, normal: DVec3) -> f64 {
    truth_in_pieces(rect, picture, point, normal, 64)
}

fn truth_in_pieces(rect: &RectLight, picture: &Texture, point: DVec3, normal: DVec3, pieces: u32) -> f64 {
    let cell = |i: u32, j: u32| {
        let at = |di: u32, dj: u32| rect.point([i + di, j + dj].map(|k| k as f32 / pieces as f32)).as_dvec3();
        let corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
        let [s, t] = [i, j].map(|k| (k as f32 + 0.5) / pieces as f32);
        let radiance = f64::from(rect.radiance.0.x * picture.sample(Vec2::new(s, 1.0 - t)).x);
        if radiance == 0.0 { 0.0 } else { radiance * PI * form_factor::polygon(&corners, point, normal) }
    };
    (0..pieces * pieces).map(|k| cell(k % pieces, k / pieces)).sum()
}

#[test]
fn a_textured_light_equals_the_sum_of_its_constant_pieces() {
    let rect =
        RectLight { texture: Some(TextureId(0)), ..ceiling_light(Vec3::new(0.3, 0.6, 0.5), 1.0, 1.5, 2.0) };
    let points =
        [(Vec3::ZERO, Vec3::Z), (Vec3::new(1.0, 0.5, 0.0), Vec3::Z), (Vec3::new(0.0, 1.0, 0.1), Vec3::X)];
    let lights = vec![Light::Rect(rect)];
    let stage = Stage::new(SceneBuilder { textures: vec![picture()], ..lights_only(lights) });
    for combination in AtPoints::all() {
        let transport = stage.points(combination.solver, &points, combination.estimator.plan(256, 1));
        let fields = replicates(&*transport, Source::Emitters(None), 64);
        for (i, (point, normal)) in points.into_iter().enumerate() {
            let truth = picture_truth(&rect, &picture(), point.as_dvec3(), normal.as_dvec3());
            Estimate::of_node(&fields, i).assert_near(
                truth,
                1e-3 * truth,
                format!("point {i}, {combination}"),
            );
        }
    }
}

#[test]
fn a_textured_mesh_light_equals_the_textured_rectangle() {
    let rect = ceiling_light(Vec3::new(0.5, 0.5, 0.5), 1.0, 1.0, 1.0);
    let mut material = grey(0.0, PI as f32);
    material.emission_texture = Some(TextureRef::plain(TextureId(0)));
    let panel = quad(rect.corners(), [1, 1], 1);
    let builder = scene(vec![floor(1), panel], vec![grey(0.0, 0.0), material], vec![]);
    let stage = Stage::new(SceneBuilder { textures: vec![picture()], ..builder });
    let point = (Vec3::new(0.2, 0.1, 0.0), Vec3::Z);
    let truth = picture_truth(&rect, &picture(), point.0.as_dvec3(), DVec3::Z);
    for emitters in [EmitterSampling::Auto, EmitterSampling::Rays, EmitterSampling::Lights] {
        for combination in AtPoints::all() {
            let plan = Plan { emitters, ..combination.estimator.plan(256, 256) };
            let transport = stage.points(combination.solver, &[point], plan);
            let fields = replicates(&*transport, Source::Emitters(None), 64);
            Estimate::of_node(&fields, 0).assert_near(
                truth,
                1e-3 * truth,
                format!("{emitters:?}, {combination}"),
            );
        }
    }
}

#[test]
fn textured_triangles_are_chosen_without_bias_though_a_texel_hides_between_their_corners() {
    const SIDE: usize = 24;
    let mut texels = vec![[0.0; 3]; SIDE * SIDE];
    // A triangle is eight texels wide. None of its corners and not its middle show that it shines.
    for (x, y) in [(4, 1), (12, 9), (20, 17), (4, 17)] {
        texels[(SIDE - 1 - y) * SIDE + x] = [40.0; 3];
    }
    // Others do.
    texels[8 * SIDE + 16] = [10.0; 3];
    let mut picture = Texture::from_floats("sparks", SIDE as u32, SIDE as u32, texels).expect("texels");
    (picture.wrap_u, picture.wrap_v) = (Wrap::Clamp, Wrap::Clamp);
    let rect = ceiling_light(Vec3::new(0.5, 0.5, 0.5), 1.0, 1.0, 1.0);
    let mut material = grey(0.0, PI as f32);
    material.emission_texture = Some(TextureRef::plain(TextureId(0)));
    let panel = quad(rect.corners(), [3, 3], 1);
    let builder = scene(vec![floor(1), panel], vec![grey(0.0, 0.0), material], vec![]);
    let stage = Stage::new(SceneBuilder { textures: vec![picture.clone()], ..builder });
    let point = (Vec3::new(0.2, 0.1, 0.0), Vec3::Z);
    let truth = truth_in_pieces(&rect, &picture, point.0.as_dvec3(), DVec3::Z, 16 * SIDE as u32);
    // Lights are sampled alone, the same with every solver.
    for combination in AtPoints::all().filter(|c| c.solver == Solver::Stored) {
        let plan = Plan { emitters: EmitterSampling::Lights, ..combination.estimator.plan(4096, 1) };
        let transport = stage.points(combination.solver, &[point], plan);
        let fields = replicates(&*transport, Source::Emitters(None), 64);
        Estimate::of_node(&fields, 0).assert_near(truth, 1e-3 * truth, combination);
    }
}
