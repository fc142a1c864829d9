//! Light on whole surfaces: form factors between areas, and flux.

use glam::Vec3;
use lumel_basis::{Basis, Field};
use lumel_scene::{Light, Radiance, RectLight};
use lumel_testkit::mesh::{Facing, cuboid, equal_area_radius, quad, sphere};
use lumel_testkit::scene::{ceiling_light, grey, scene};
use lumel_testkit::{
    Combination, Estimate, Method, Operator, Stage, Storage, assert_nodes_near, form_factor, measure,
    ratio_bias, replicates,
};
use lumel_transport::{EmitterSampling, LightSampling, Plan, Source};
use std::f64::consts::PI;

/// A rectangle of radiosity one that shines on the floor `[0, width] × [0, depth]`.
struct Pair {
    width: f32,
    depth: f32,
    light: RectLight,
    factor: f64,
    touches: bool,
}

impl Pair {
    fn opposed(width: f32, depth: f32) -> Self {
        let center = Vec3::new(0.5 * width, 0.5 * depth, 1.0);
        let light = ceiling_light(center, width, depth, (1.0 / PI) as f32);
        let factor = form_factor::parallel_rectangles(width.into(), depth.into(), 1.0);
        Self { width, depth, light, factor, touches: false }
    }

    /// The light stands on the edge x = 0 of the floor.
    fn perpendicular(width: f32, height: f32) -> Self {
        let light = RectLight {
            center: Vec3::new(0.0, 0.5, 0.5 * height),
            u: Vec3::Y * 0.5,
            v: Vec3::Z * (0.5 * height),
            radiance: Radiance::splat((1.0 / PI) as f32),
            texture: None,
        };
        let factor = form_factor::perpendicular_rectangles(width.into(), height.into(), 1.0);
        Self { width, depth: 1.0, light, factor, touches: true }
    }

    fn stage(&self, cells: u32) -> Stage {
        let (w, d) = (self.width, self.depth);
        let corners = [[0.0, 0.0], [w, 0.0], [w, d], [0.0, d]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let floor = quad(corners, [cells; 2], 0);
        Stage::new(scene(vec![floor], vec![grey(0.0, 0.0)], vec![Light::Rect(self.light)]))
    }

    /// What each node should measure, without any discretisation.
    fn expected(&self, stage: &Stage, operator: &Operator) -> Vec<f64> {
        let corners = self.light.corners().map(|p| p.as_dvec3());
        stage.expected(operator, &|point, normal| form_factor::polygon(&corners, point, normal))
    }
}

/// The area average of a field's values.
fn average(operator: &Operator, values: impl IntoIterator<Item = f64>) -> f64 {
    let areas = operator.basis.node_areas();
    let sum: f64 = values.into_iter().zip(areas).map(|(value, &area)| value * f64::from(area)).sum();
    sum / areas.iter().map(|&area| f64::from(area)).sum::<f64>()
}

fn field_average(operator: &Operator, field: &Field) -> f64 {
    average(operator, field.values().iter().map(|e| f64::from(e.x)))
}

#[track_caller]
fn assert_pair(pair: &Pair, known: f64, what: &str) {
    assert!((pair.factor - known).abs() < 1e-11, "{what}: {}", pair.factor);
    let stage = pair.stage(6);
    // On an edge of the light the variance of area sampling is infinite: no number of samples has a standard error.
    let finite = |c: &Combination| !pair.touches || c.estimator.light == LightSampling::Analytic;
    for combination in Combination::all().filter(finite) {
        let operator = stage.operator(combination.method, combination.estimator.plan(64, 1));
        let expected = pair.expected(&stage, &operator);
        let fields = replicates(&*operator.transport, Source::Emitters(None), 32);
        let label = format!("{what}, {combination}");
        let estimate = Estimate::new(fields.iter().map(|field| field_average(&operator, field)));
        let discrete = average(&operator, expected.iter().copied());
        match combination.method.storage {
            // Where light and floor touch, irradiance jumps at the common corners: there only the mean is compared,
            // with what the same points measure without noise.
            Storage::Vertex => estimate.assert_near(discrete, 1e-4 * known, label),
            Storage::VertexArea => estimate.assert_near(known, ratio_bias(96, 0.1) * known, label),
        }
    }
}

#[test]
fn opposed_rectangles_exchange_their_form_factor() {
    assert_pair(&Pair::opposed(1.0, 1.0), 0.199824895698, "1 x 1");
    assert_pair(&Pair::opposed(2.0, 1.0), 0.285875384851, "2 x 1");
    assert_pair(&Pair::opposed(2.0, 2.0), 0.415253283577, "2 x 2");
}

#[test]
fn perpendicular_rectangles_exchange_their_form_factor() {
    assert_pair(&Pair::perpendicular(1.0, 1.0), 0.200043776075, "W = H = 1");
    assert_pair(&Pair::perpendicular(1.0, 2.0), 0.232852602795, "W = 1, H = 2");
    assert_pair(&Pair::perpendicular(2.0, 1.0), 0.116426301398, "W = 2, H = 1");
}

#[test]
fn the_average_over_vertices_converges_with_the_square_of_the_mesh() {
    let pair = Pair::opposed(1.0, 1.0);
    let errors = [4, 8].map(|cells| {
        let stage = pair.stage(cells);
        let plan = Plan { light_sampling: LightSampling::Analytic, ..Plan::default() };
        let operator = stage.operator(Method::VERTEX, plan);
        let field = measure(&*operator.transport, Source::Emitters(None), 0).field;
        (field_average(&operator, &field) - pair.factor).abs()
    });
    let order = (errors[0] / errors[1]).log2();
    assert!((order - 2.0).abs() < 0.3, "{errors:?}");
}

#[test]
fn every_node_of_a_floor_measures_its_own_part_of_the_light() {
    let pair = Pair::opposed(2.0, 1.0);
    let stage = pair.stage(4);
    for combination in Combination::all() {
        let operator = stage.operator(combination.method, combination.estimator.plan(64, 1));
        let expected = pair.expected(&stage, &operator);
        let fields = replicates(&*operator.transport, Source::Emitters(None), 48);
        let bound =
            if combination.method.storage == Storage::VertexArea { ratio_bias(32, 0.15) } else { 1e-4 };
        assert_nodes_near(&fields, &expected, bound, combination);
    }
}

#[test]
fn a_sphere_around_another_receives_all_its_light() {
    let level = 2;
    let radius = |r| equal_area_radius(r, level);
    let inner = sphere(Vec3::ZERO, radius(0.5), level, Facing::Outward, 1);
    let outer = sphere(Vec3::ZERO, radius(1.0), level, Facing::Inward, 0);
    let stage = Stage::new(scene(vec![inner, outer], vec![grey(0.0, 0.0), grey(0.0, 1.0)], vec![]));
    for combination in Combination::all().filter(|c| c.method.storage == Storage::VertexArea) {
        for emitters in [EmitterSampling::Auto, EmitterSampling::Rays, EmitterSampling::Lights] {
            let plan = Plan { emitters, ..combination.estimator.plan(32, 32) };
            let operator = stage.operator(combination.method, plan);
            let areas = operator.basis.node_areas();
            let outside: Vec<bool> = stage.nodes().iter().map(|(p, _)| p.length() > 0.75).collect();
            let flux = |field: &Field| -> f64 {
                let nodes = field.values().iter().zip(areas).zip(&outside);
                nodes.map(|((e, a), out)| if *out { f64::from(e.x * a) } else { 0.0 }).sum()
            };
            let fields = replicates(&*operator.transport, Source::Emitters(None), 12);
            // F from inner to outer is 1, so F from outer to inner is 1/4 and π arrives, the area of the inner.
            let label = format!("{combination}, {emitters:?}");
            Estimate::new(fields.iter().map(flux)).assert_near(PI, ratio_bias(96, 0.1) * PI, label);
            let onto_itself = fields[0]
                .values()
                .iter()
                .zip(&outside)
                .filter(|(_, out)| !**out)
                .all(|(e, _)| *e == Vec3::ZERO);
            assert!(onto_itself, "{combination}, {emitters:?}: a convex body does not see itself");
        }
    }
}

#[test]
fn flux_from_a_ceiling_light_arrives_on_the_walls_by_their_form_factors() {
    // CIE 171:2006 5.4 in style: a square metre in the ceiling of a room of 4 x 4 x 3 m, 1000 lm.
    let (min, max) = (Vec3::new(-2.0, -2.0, 0.0), Vec3::new(2.0, 2.0, 3.0));
    let light = ceiling_light(Vec3::Z * 3.0, 1.0, 1.0, (1000.0 / PI) as f32);
    let room = cuboid(min, max, 4, Facing::Inward, [0; 6]);
    let stage = Stage::new(scene(room, vec![grey(0.0, 0.0)], vec![Light::Rect(light)]));
    let known = [161.915991, 161.915991, 161.915991, 161.915991, 352.336037, 0.0];
    for combination in Combination::all().filter(|c| c.method.storage == Storage::VertexArea) {
        let operator = stage.operator(combination.method, combination.estimator.plan(64, 1));
        let areas = operator.basis.node_areas();
        let nodes = stage.nodes();
        let fields = replicates(&*operator.transport, Source::Emitters(None), 16);
        for (wall, known) in known.into_iter().enumerate() {
            let inward = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z][wall];
            let flux = |field: &Field| -> f64 {
                let on_wall = |i: &usize| nodes[*i].1.dot(inward) > 0.9;
                (0..nodes.len()).filter(on_wall).map(|i| f64::from(field.values()[i].x * areas[i])).sum()
            };
            // Next to the light walls see it change faster within a hat than the floor does.
            let bound = 2.0 * ratio_bias(96, 0.1) * known;
            Estimate::new(fields.iter().map(flux)).assert_near(
                known,
                bound,
                format!("wall {wall}, {combination}"),
            );
        }
    }
}

#[test]
fn a_mesh_light_equals_the_rectangle_it_fills() {
    let rect = ceiling_light(Vec3::new(0.5, 0.5, 1.0), 1.0, 1.0, (1.0 / PI) as f32);
    let [a, b, c, d] = rect.corners();
    let panel = quad([a, b, c, d], [1, 1], 1);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let stage = Stage::new(scene(
        vec![quad(corners, [3, 3], 0), panel],
        vec![grey(0.0, 0.0), grey(0.0, 1.0)],
        vec![],
    ));
    let corners = rect.corners().map(|p| p.as_dvec3());
    for combination in Combination::all() {
        for emitters in [EmitterSampling::Auto, EmitterSampling::Rays, EmitterSampling::Lights] {
            let plan = Plan { emitters, ..combination.estimator.plan(64, 64) };
            let operator = stage.operator(combination.method, plan);
            let expected = stage.expected(&operator, &|p, n| {
                if n.z < 0.0 { 0.0 } else { form_factor::polygon(&corners, p, n) }
            });
            let fields = replicates(&*operator.transport, Source::Emitters(None), 48);
            let bound =
                if combination.method.storage == Storage::VertexArea { ratio_bias(32, 0.15) } else { 1e-4 };
            assert_nodes_near(&fields, &expected, bound, format!("{combination}, {emitters:?}"));
        }
    }
}
