use crate::{Stage, moved, noise, of, pair, settings, stages};
use glam::{DVec3, Vec3};
use lumel_lightmap::{LightmapLayer, LumelLight, PartLight};
use lumel_scene::luminance;
use lumel_uv::{Density, UnwrapSettings};

/// Light by place.
type Light<'a> = &'a dyn Fn(DVec3) -> f32;

/// A number of the standard normal distribution.
pub(crate) fn normal(i: usize) -> f32 {
    let radius = (-2.0 * noise(2 * i + 1).max(1e-9).ln()).sqrt();
    radius * (std::f32::consts::TAU * noise(2 * i + 2)).cos()
}

/// Two charts of 109 by 109 lumels.
pub(crate) fn fine() -> Stage {
    Stage::new(moved(of(pair())), &UnwrapSettings { density: Density::PerMetre(64.0), ..settings(512) })
}

/// What is left of the noise, in parts of it, by lumel; the change of the mean; and the median change of a lumel, relative.
fn left(stage: &Stage, light: impl Fn(DVec3) -> f32, relative: f32) -> (f64, f64, f32) {
    let clean = stage.measured(|_, at| Vec3::splat(light(at)));
    let errors: Vec<f32> = clean.iter().map(|value| luminance(*value) * relative).collect();
    let noisy: Vec<Vec3> =
        clean.iter().enumerate().map(|(i, &value)| value * (1.0 + relative * normal(i))).collect();
    let mut lightmap = stage.lightmap(noisy.clone(), |_| true);
    lightmap.denoise(&stage.coverage, &errors);
    let (mut squares, mut is, mut was) = (0.0, 0.0, 0.0);
    let mut changes = Vec::with_capacity(stage.coverage.len());
    for &lumel in stage.coverage.lumels() {
        let (value, clean) = (lightmap.layers[0].values[lumel as usize].x, clean[lumel as usize].x);
        squares += f64::from((value - clean) / (clean * relative)).powi(2);
        (is, was) = (is + f64::from(value), was + f64::from(clean));
        changes.push((value / noisy[lumel as usize].x - 1.0).abs());
    }
    let median = *changes.select_nth_unstable_by(stage.coverage.len() / 2, f32::total_cmp).1;
    ((squares / stage.coverage.len() as f64).sqrt(), is / was - 1.0, median)
}

#[test]
fn noise_falls_and_power_stays() {
    let stage = fine();
    let from = stage.scene.bounds().center().as_dvec3();
    let along = DVec3::new(0.3, -0.7, 0.4);
    let step = |at: DVec3| if (at - from).dot(along) > 0.1 { 1.0 } else { 0.2 };
    let gradient = |at: DVec3| 2.0 + 0.5 * (at - from).dot(along) as f32;
    let pool = |at: DVec3| 0.1 + 2.0 / (1.0 + 5.0 * (at - from).length_squared() as f32).powf(1.5);
    for relative in [0.02, 0.1, 0.2] {
        let lights: [(&str, Light<'_>, f64); 4] = [
            ("constant", &|_| 3.0, 0.2),
            ("gradient", &gradient, 0.3),
            ("step", &step, 0.25),
            ("pool", &pool, 0.6),
        ];
        for (name, light, most) in lights {
            let (left, power, _) = left(&stage, light, relative);
            println!("{name}, {relative}: {left:.3} of the noise is left, power {:+.2} %", 100.0 * power);
            assert!(left < most, "{name}, {relative}: {left} of the noise is left");
            assert!(power.abs() < 0.005, "{name}, {relative}: power changes by {power}");
        }
    }
}

#[test]
fn light_never_gets_worse_and_hardly_changes_where_noise_is_not_seen() {
    let stage = fine();
    let from = stage.scene.bounds().center().as_dvec3();
    let along = DVec3::new(0.3, -0.7, 0.4);
    let waves = |steps: f64| move |at: DVec3| 1.0 + 0.8 * (steps * (at - from).dot(along)).sin() as f32;
    let spots = |at: DVec3| {
        let near = (at * 9.0 - (at * 9.0).round()).length_squared();
        0.1 + (-20.0 * near).exp() as f32
    };
    for relative in [0.002, 0.01, 0.05] {
        let (long, short) = (waves(12.0), waves(60.0));
        let lights: [(&str, Light<'_>); 4] =
            [("constant", &|_| 3.0), ("long waves", &long), ("short waves", &short), ("spots", &spots)];
        for (name, light) in lights {
            let (left, _, change) = left(&stage, light, relative);
            println!("{name}, {relative}: {left:.3} of the noise is left, changes by {change:.5}");
            assert!(left < 1.03, "{name}, {relative}: {left} of the noise");
            assert!(relative > 0.002 || change < 0.001, "{name}: changes by {change}");
        }
    }
}

#[test]
fn a_constant_and_what_is_known_exactly_keep_their_bits() {
    for (name, stage) in stages() {
        let constant = stage.measured(|_, _| Vec3::new(0.1, 0.7, 33.3));
        let varied = stage.measured(|tri, at| Vec3::splat(tri.0 as f32 + at.x.abs() as f32));
        let n = constant.len();
        for (values, error) in [(constant, 0.5), (varied.clone(), 0.0), (varied, f32::NAN)] {
            let mut lightmap = stage.lightmap(values.clone(), |_| true);
            lightmap.denoise(&stage.coverage, &vec![error; n]);
            assert!(lightmap.layers[0].values == values, "{name}, {error}");
        }
    }
}

#[test]
fn edges_far_above_the_noise_stay_and_charts_never_mix() {
    let stage = fine();
    let edge = stage.scene.bounds().center().as_dvec3();
    let value = |at: DVec3| if (at - edge).dot(DVec3::new(0.3, -0.7, 0.4)) > 0.1 { 1.0 } else { 0.5 };
    let clean = stage.measured(|tri, at| Vec3::splat(value(at) + 0.3 * stage.atlas.chart(tri) as f32));
    let mut lightmap = stage.lightmap(clean.clone(), |_| true);
    lightmap.denoise(&stage.coverage, &vec![0.01; clean.len()]);
    for &lumel in stage.coverage.lumels() {
        let (is, was) = (lightmap.layers[0].values[lumel as usize].x, clean[lumel as usize].x);
        assert!((is - was).abs() < 1e-5, "{is} {was}");
    }
    // As little as the errors: within a chart this would be mixed.
    let clean = stage.measured(|tri, _| Vec3::splat(1.0 + stage.atlas.chart(tri) as f32));
    let mut lightmap = stage.lightmap(clean.clone(), |_| true);
    lightmap.denoise(&stage.coverage, &vec![10.0; clean.len()]);
    assert!(lightmap.layers[0].values == clean);
}

#[test]
fn hidden_lumels_are_not_read() {
    let stage = fine();
    let values = stage.measured(|_, at| if at.y > -6.5 { Vec3::ONE } else { Vec3::NAN });
    let mut lightmap = stage.lightmap(values.clone(), |lumel| values[lumel].x == 1.0);
    assert!(stage.coverage.lumels().iter().any(|&lumel| !lightmap.valid[lumel as usize]));
    lightmap.denoise(&stage.coverage, &vec![1.0; values.len()]);
    let valid = stage.coverage.lumels().iter().filter(|&&lumel| values[lumel as usize].x == 1.0);
    valid.for_each(|&lumel| assert_eq!(lightmap.layers[0].values[lumel as usize], Vec3::ONE));
}

#[test]
fn layers_still_add_up_and_threads_do_not_matter() {
    let stage = fine();
    let layer = |salt: usize| -> Vec<Vec3> {
        (0..stage.atlas.lumel_count()).map(|i| Vec3::new(1.0, 0.5, 2.0) * noise(i + salt)).collect()
    };
    let [direct, bounce] = [layer(0), layer(1 << 20)];
    let sum = direct.iter().zip(&bounce).map(|(&a, &b)| a + b).collect();
    let mut lightmap = stage.lightmap(sum, |lumel| lumel % 9 > 0);
    for (name, values) in [("direct", direct), ("bounce 1", bounce)] {
        lightmap.layers.push(LightmapLayer { name: name.into(), values });
    }
    let denoised = |threads: usize| {
        let mut lightmap = lightmap.clone();
        let errors = vec![0.3; lightmap.valid.len()];
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| lightmap.denoise(&stage.coverage, &errors));
        lightmap.layers
    };
    let layers = denoised(1);
    assert!(layers == denoised(3));
    assert!(layers[1] != lightmap.layers[1], "noise falls in all layers");
    for lumel in 0..stage.atlas.lumel_count() {
        let [all, direct, bounce] = [0, 1, 2].map(|layer: usize| layers[layer].values[lumel]);
        assert!((all - direct - bounce).abs().max_element() < 1e-5);
    }
}

#[test]
fn neighbours_together_know_the_error_and_an_edge_is_none() {
    let stage = fine();
    let edge = stage.scene.bounds().center().as_dvec3();
    // What two halves of the samples differ by: noise of 0.1 everywhere, and of 5 in lumels that an edge of light cuts.
    let is_cut = |at: DVec3| (at - edge).dot(DVec3::new(0.3, -0.7, 0.4)).abs() < 0.005;
    let places = stage.measured(|_, at| if is_cut(at) { Vec3::splat(5.0) } else { Vec3::splat(0.1) });
    let error = |(place, &lumel): (usize, &u32)| places[lumel as usize].x * normal(3 * place);
    let errors: Vec<f32> = stage.coverage.lumels().iter().enumerate().map(error).collect();
    let mut light = LumelLight::new(errors.len(), 1, false);
    let half = |sign: f32| PartLight {
        known: vec![true; errors.len()],
        sources: vec![errors.iter().map(|error| Vec3::splat(9.0 + sign * error)).collect()],
    };
    light.add(0..errors.len(), &[half(1.0), half(-1.0)]);
    let found = light.noise(&stage.atlas, &stage.coverage);
    let mean = found.iter().sum::<f32>() / found.len() as f32;
    assert!((mean / 0.1 - 1.0).abs() < 0.1, "{mean}");
    // A median of 25 has a standard deviation of a quarter of itself.
    assert!(
        found.iter().all(|error| (0.0..0.3).contains(error)),
        "{:?}",
        found.iter().copied().fold(0.0, f32::max)
    );
}
