use super::*;
use crate::polygon::unit_irradiance;
use lumel_sample::{Dim, Sampler, StreamKey, uniform_sphere};

type Corners = [DVec3; 3];

fn random(i: u32) -> [f64; 4] {
    Sampler::Random.sample_4d(StreamKey::new(5), i, Dim::Area).map(f64::from)
}

fn direction(u: f64, v: f64) -> DVec3 {
    uniform_sphere([u as f32, v as f32]).as_dvec3()
}

/// Triangles of any orientation spread over a cube of a given size, with power.
fn spread(n: u32, scale: f64) -> Vec<(Corners, f64)> {
    let light = |i: u32| {
        let [x, y, z, power] = random(3 * i);
        let [s, t, size, _] = random(3 * i + 1);
        let [p, q, ..] = random(3 * i + 2);
        let center = DVec3::new(x, y, z);
        let size = 0.02 + 0.1 * size;
        let corners = [center, center + direction(s, t) * size, center + direction(p, q) * size];
        // Corners as a scene stores them.
        (corners.map(|corner| (corner * scale).as_vec3().as_dvec3()), power)
    };
    (0..n).map(light).collect()
}

fn tree(lights: &[(Corners, f64)]) -> Option<LightTree> {
    let extents = lights.iter().enumerate();
    LightTree::new(extents.filter_map(|(i, (c, power))| Some((i, Extent::flat(c, *power)?))).collect())
}

fn receiver(i: u32, scale: f64) -> (DVec3, DVec3) {
    let [x, y, z, _] = random(100_000 + 2 * i);
    let [u, v, ..] = random(100_001 + 2 * i);
    let point = (DVec3::new(x, y, z) * 2.0 - 0.5) * scale;
    (point.as_vec3().as_dvec3(), direction(u, v))
}

fn unblocked(corners: &Corners, (point, normal): (DVec3, DVec3)) -> f64 {
    unit_irradiance(&corners.map(DVec3::as_vec3), point.as_vec3(), normal.as_vec3())
}

/// The probability of each light.
fn probabilities(tree: &LightTree, (point, normal): (DVec3, DVec3), n: usize) -> Vec<f64> {
    let mut all = vec![0.0; n];
    let start = if tree.nodes[0].bound.importance(point, normal) > 0.0 { 1.0 } else { 0.0 };
    let mut open = vec![(0, start)];
    while let Some((at, probability)) = open.pop() {
        match tree.nodes[at].below {
            Below::Light(light) => all[light] += probability,
            Below::Pair { second } => {
                let first = tree.share_of_first(at + 1, second, point, normal);
                open.extend([(at + 1, probability * first), (second, probability * (1.0 - first))]);
            }
        }
    }
    all
}

#[test]
fn probabilities_sum_to_one_and_leave_out_no_light_that_shines() {
    for scale in [1e-6, 1.0, 1e6] {
        let lights = spread(200, scale);
        let tree = tree(&lights).expect("lights");
        for i in 0..1000 {
            let at = receiver(i, scale);
            let chances = probabilities(&tree, at, lights.len());
            let sum: f64 = chances.iter().sum();
            let shining = lights.iter().any(|(corners, _)| unblocked(corners, at) > 0.0);
            assert!((sum - 1.0).abs() < 1e-6 || (sum == 0.0 && !shining), "{i}: {sum}");
            for ((corners, _), chance) in lights.iter().zip(chances) {
                assert!(chance > 0.0 || unblocked(corners, at) == 0.0, "receiver {i}, scale {scale}");
            }
        }
    }
}

#[test]
fn a_choice_has_the_probability_that_it_says() {
    let lights = spread(40, 1.0);
    let tree = tree(&lights).expect("lights");
    let at = receiver(3, 1.0);
    let chances = probabilities(&tree, at, lights.len());
    const STEPS: u32 = 1 << 14;
    let mut counts = vec![0.0; lights.len()];
    for i in 0..STEPS {
        let choice = tree.choose(at.0, at.1, (i as f32 + 0.5) / STEPS as f32).expect("a light in reach");
        assert!((choice.probability - chances[choice.light]).abs() < 1e-12);
        assert!((tree.probability(choice.light, at.0, at.1) - choice.probability).abs() < 1e-12);
        assert!((0.0..1.0).contains(&choice.rest));
        counts[choice.light] += 1.0 / f64::from(STEPS);
    }
    for (count, chance) in counts.iter().zip(&chances) {
        // Each light is chosen by one interval.
        assert!((count - chance).abs() <= 1.0 / f64::from(STEPS) + 1e-9);
    }
}

/// Mean and variance of the unblocked light by single choices, and the truth.
fn estimate(
    lights: &[(Corners, f64)],
    choose: impl Fn(f32) -> Option<(usize, f64)>,
    at: (DVec3, DVec3),
) -> [f64; 3] {
    const N: u32 = 20_000;
    // Power over area is radiance.
    let light = |i: usize| {
        let [a, b, c] = lights[i].0;
        unblocked(&lights[i].0, at) * lights[i].1 / (0.5 * (b - a).cross(c - a).length())
    };
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..N {
        let value = choose(random(500_000 + i)[0] as f32).map_or(0.0, |(l, p)| light(l) / p);
        sum += value;
        squares += value * value;
    }
    let mean = sum / f64::from(N);
    [mean, squares / f64::from(N) - mean * mean, (0..lights.len()).map(light).sum()]
}

#[test]
fn the_mean_is_the_sum_over_all_lights_and_varies_far_less_than_by_power() {
    let lights = spread(200, 1.0);
    let tree = tree(&lights).expect("lights");
    let powers: Vec<f32> = lights.iter().map(|(_, power)| *power as f32).collect();
    let by_power = lumel_sample::PiecewiseConstant1D::new(&powers).expect("power");
    let (mut tree_variance, mut power_variance) = (0.0, 0.0);
    for i in 0..20 {
        let at = receiver(i, 1.0);
        let by_tree = |u| tree.choose(at.0, at.1, u).map(|c| (c.light, c.probability));
        let [mean, variance, truth] = estimate(&lights, by_tree, at);
        let tolerance = 4.0 * (variance / 20_000.0).sqrt() + 1e-6 * truth;
        assert!((mean - truth).abs() <= tolerance, "receiver {i}: {mean}, not {truth}");
        let simple = |u| Some(by_power.sample(u)).map(|(l, _, p)| (l, f64::from(p)));
        let [_, simple_variance, _] = estimate(&lights, simple, at);
        tree_variance += variance / (truth * truth).max(1e-12);
        power_variance += simple_variance / (truth * truth).max(1e-12);
    }
    // It is 0.21 times as much; without regard to distance it would be 0.35.
    assert!(tree_variance < 0.28 * power_variance, "{tree_variance} against {power_variance}");
}

/// A small triangle at a place that faces a direction.
fn facing(at: DVec3, normal: DVec3) -> Corners {
    let u = normal.any_orthonormal_vector();
    [at, at + 1e-3 * u, at + 1e-3 * normal.cross(u)]
}

#[test]
fn small_lights_are_chosen_by_both_cosines_distance_and_power() {
    let share_of_first = |first: (Corners, f64), normal: DVec3| {
        let other = (facing(DVec3::new(0.0, 0.0, 10.0), -DVec3::Z), 1.0);
        let tree = tree(&[first, other]).expect("lights");
        probabilities(&tree, (DVec3::ZERO, normal), 2)[0]
    };
    // Each is half as important as the other light: 60 degrees away from the receiver, or seen under 60 degrees from the
    // receiver's normal; farther away, or weaker.
    let up = DVec3::new(0.0, 0.0, 10.0);
    let cos_30 = 0.75f64.sqrt();
    let aside = DVec3::new(cos_30, 0.0, 0.5);
    let weaker = [
        (facing(up, DVec3::new(cos_30, 0.0, -0.5)), 1.0),
        (facing(10.0 * aside, -aside), 1.0),
        (facing(up * 2f64.sqrt(), -DVec3::Z), 1.0),
        (facing(up, -DVec3::Z), 0.5),
    ];
    for (i, light) in weaker.into_iter().enumerate() {
        let share = share_of_first(light, DVec3::Z);
        // Their size bounds angles to a ten-thousandth.
        assert!((share - 1.0 / 3.0).abs() < 1e-3, "{i}: {share}");
    }
    let turned_away = (facing(up, DVec3::Z), 1.0);
    assert_eq!(share_of_first(turned_away, DVec3::Z), 0.0);
}

#[test]
fn one_light_is_always_chosen() {
    let lights = [([DVec3::ZERO, DVec3::X, DVec3::Y], 1.0)];
    let tree = tree(&lights).expect("a light");
    let choice = tree.choose(DVec3::Z, -DVec3::Z, 0.7).expect("in reach");
    assert_eq!((choice.light, choice.probability), (0, 1.0));
    assert_eq!(tree.choose(-DVec3::Z, DVec3::Z, 0.7), None);
}

#[test]
fn coincident_lights_share_the_chances() {
    let lights = vec![([DVec3::ZERO, DVec3::X, DVec3::Y], 1.0); 100];
    let tree = tree(&lights).expect("lights");
    let chances = probabilities(&tree, (DVec3::Z, -DVec3::Z), 100);
    assert!(chances.iter().all(|c| (c - 0.01).abs() < 1e-12));
}

#[test]
fn lights_without_area_or_power_are_left_out() {
    let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
    let lights = [(line, 1.0), ([DVec3::ZERO, DVec3::X, DVec3::Y], 0.0)];
    assert!(tree(&lights).is_none());
}
