//! Laws of the sample sequences: nets, prefixes, independence and exact variances.

mod support;

use lumel_sample::{Dim, Sampler, SamplerKind, StreamKey};
use support::{SIGNIFICANCE, chi_squared_p_value, rms_error, stream, upper_gamma};

const DIMS: [Dim; 8] = [
    Dim::Area,
    Dim::Hemisphere,
    Dim::Light(0),
    Dim::Light(1),
    Dim::LightPilot(0),
    Dim::LightSelect,
    Dim::Validity,
    Dim::Pixel,
];

/// Whether every elementary interval of area 2⁻ᵐ holds exactly one of these 2ᵐ points.
fn is_net(points: &[[f32; 2]]) -> bool {
    let m = points.len().ilog2();
    (0..=m).all(|a| {
        let (columns, rows) = (1_usize << a, 1_usize << (m - a));
        let mut hit = vec![false; points.len()];
        points.iter().all(|&[x, y]| {
            let cell = (x * columns as f32) as usize + columns * (y * rows as f32) as usize;
            !std::mem::replace(&mut hit[cell], true)
        })
    })
}

#[test]
fn sobol_prefixes_are_nets() {
    for m in 4..=10 {
        for seed in 0..50 {
            let (stream, n) = stream(SamplerKind::Sobol, 1 << m, seed);
            let points: Vec<_> = (0..n).map(|i| stream.sample_2d(i)).collect();
            assert!(is_net(&points), "m = {m}, seed = {seed}");
        }
    }
}

#[test]
fn consecutive_sobol_blocks_are_nets() {
    for m in 4..=8 {
        let (stream, n) = stream(SamplerKind::Sobol, 1 << m, 3);
        for block in (0..40).chain([(1 << (32 - m)) - 1]) {
            let points: Vec<_> = (0..n).map(|i| stream.sample_2d(block * n + i)).collect();
            assert!(is_net(&points), "m = {m}, block = {block}");
        }
    }
}

#[test]
fn random_points_are_no_net() {
    let (stream, n) = stream(SamplerKind::Random, 16, 0);
    assert!(!is_net(&(0..n).map(|i| stream.sample_2d(i)).collect::<Vec<_>>()));
}

#[test]
fn sobol_points_in_4d_are_stratified_along_every_axis() {
    for m in 4..=10 {
        for seed in 0..20 {
            let (stream, n) = stream(SamplerKind::Sobol, 1 << m, seed);
            let points: Vec<_> = (0..n).map(|i| stream.sample_4d(i)).collect();
            for d in 0..4 {
                let mut cells: Vec<u32> = points.iter().map(|p| (p[d] * n as f32) as u32).collect();
                cells.sort_unstable();
                assert!(cells.into_iter().eq(0..n), "m = {m}, seed = {seed}, dimension {d}");
            }
            assert!(
                is_net(&points.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>()),
                "m = {m}, seed = {seed}"
            );
        }
    }
}

/// 4-D Sobol points are no product of padded 2-D sets: every 4×4×4×4 box gets its point once m reaches 8 + t, t ≤ 3.
#[test]
fn sobol_points_in_4d_fill_all_boxes_evenly() {
    for seed in 0..20 {
        let (stream, n) = stream(SamplerKind::Sobol, 1 << 11, seed);
        let mut counts = [0; 256];
        for i in 0..n {
            let cell = stream.sample_4d(i).iter().fold(0, |cell, x| 4 * cell + (4.0 * x) as usize);
            counts[cell] += 1;
        }
        assert_eq!(counts, [8; 256], "seed = {seed}");
    }
}

#[test]
fn stratified_points_fill_every_cell_once_per_layer() {
    for side in [1_u16, 2, 5, 8, 13] {
        let sampler = Sampler::Stratified { side };
        let stream = sampler.stream(StreamKey::new(9), Dim::Area);
        let n = u32::from(side).pow(2);
        let cell =
            |x: f32, y: f32| (x * f32::from(side)) as u32 + u32::from(side) * (y * f32::from(side)) as u32;
        for layer in 0..5 {
            let range = layer * n..(layer + 1) * n;
            let plain: Vec<u32> =
                range.clone().map(|i| stream.sample_2d(i)).map(|[x, y]| cell(x, y)).collect();
            assert!(plain.into_iter().eq(0..n));
            for pair in [0, 2] {
                let points = range.clone().map(|i| stream.sample_4d(i));
                let mut cells: Vec<u32> = points.map(|p| cell(p[pair], p[pair + 1])).collect();
                cells.sort_unstable();
                assert!(cells.into_iter().eq(0..n), "side {side}, layer {layer}, pair {pair}");
            }
        }
        if side > 2 {
            let order = |layer: u32| -> Vec<u32> {
                (0..n).map(|i| stream.sample_4d(layer * n + i)).map(|p| cell(p[0], p[1])).collect()
            };
            assert_ne!(order(0), order(1), "layers have permutations of their own");
        }
        assert_ne!(stream.sample_2d(0), stream.sample_2d(n), "layers have jitter of their own");
    }
}

#[test]
fn every_coordinate_lies_in_the_unit_interval() {
    for kind in SamplerKind::ALL {
        for seed in 0..20 {
            let (stream, _) = stream(kind, 1024, seed);
            let first = 0..3000;
            let last = u32::MAX - 3000..=u32::MAX;
            for i in first.chain(last) {
                let coordinates = stream.sample_2d(i).into_iter().chain(stream.sample_4d(i));
                for x in coordinates {
                    assert!((0.0..1.0).contains(&x), "{kind}, index {i}: {x}");
                }
            }
        }
    }
}

#[test]
fn samplers_are_pure_functions_and_streams_only_a_shortcut() {
    for kind in SamplerKind::ALL {
        let sampler = kind.for_count(64);
        let key = StreamKey::new(1).element(2).bounce(3).pass(4);
        let stream = sampler.stream(key, Dim::Light(5));
        let forwards: Vec<_> = (0..200).map(|i| (stream.sample_2d(i), stream.sample_4d(i))).collect();
        for i in (0..200).rev() {
            let again = (sampler.sample_2d(key, i, Dim::Light(5)), sampler.sample_4d(key, i, Dim::Light(5)));
            assert_eq!(again, forwards[i as usize], "{kind}");
        }
    }
}

/// All samplers but the stratified one are progressive: a longer run begins with the shorter one.
#[test]
fn longer_runs_begin_with_shorter_ones() {
    for kind in [SamplerKind::Random, SamplerKind::Halton, SamplerKind::Sobol] {
        assert_eq!(kind.for_count(16), kind.for_count(4096), "{kind}");
    }
}

/// Each single point is uniform over keys: the condition for unbiased means.
#[test]
fn every_single_point_is_uniform_over_keys() {
    let n = 25_600;
    for kind in [SamplerKind::Random, SamplerKind::Halton, SamplerKind::Sobol] {
        for index in [0, 1, 7, 1000] {
            let mut observed = vec![0; 256];
            for seed in 0..n {
                let p = stream(kind, 1024, seed).0.sample_4d(index);
                observed[p.iter().fold(0, |cell, x| 4 * cell + (4.0 * x) as usize)] += 1;
            }
            let p_value = chi_squared_p_value(&observed, &[100.0; 256]);
            assert!(p_value > SIGNIFICANCE, "{kind}, index {index}: p = {p_value:.1e}");
        }
    }
}

/// Correlation coefficient of x between two streams of 4096 points each.
fn correlation(a: impl Fn(u32) -> f32, b: impl Fn(u32) -> f32) -> f64 {
    let products = (0..4096).map(|i| (f64::from(a(i)) - 0.5) * (f64::from(b(i)) - 0.5));
    12.0 * products.sum::<f64>() / 4096.0
}

/// For independent streams the coefficient has σ = 1/√4096 = 0.0156. 200 pairs per sampler: 5σ = 0.078 is not reached.
/// Toroidal shifts of one Halton sequence are correlated by construction and are left out.
#[test]
fn streams_of_other_elements_bounces_passes_and_purposes_are_decorrelated() {
    for kind in [SamplerKind::Random, SamplerKind::Sobol] {
        let sampler = kind.for_count(4096);
        let root = StreamKey::new(11);
        let mut streams = Vec::new();
        for key in [root, root.element(0), root.element(1), root.bounce(0), root.bounce(1), root.pass(0)] {
            streams.push(sampler.stream(key, Dim::Area));
        }
        for dim in DIMS {
            streams.push(sampler.stream(root.element(5).bounce(1), dim));
        }
        for (i, a) in streams.iter().enumerate() {
            for b in &streams[..i] {
                for d in 0..4 {
                    let r = correlation(|i| a.sample_4d(i)[d], |i| b.sample_4d(i)[d]);
                    assert!(r.abs() < 0.078, "{kind}, dimension {d}: r = {r:.3}");
                }
            }
        }
    }
}

/// Two padded 2-D sets together fill the 4-D cube like independent points do.
#[test]
fn padded_sets_are_independent() {
    for kind in [SamplerKind::Random, SamplerKind::Sobol] {
        let mut observed = vec![0; 256];
        for element in 0..100 {
            let key = StreamKey::new(4).element(element);
            let area = kind.for_count(256).stream(key, Dim::Area);
            let hemisphere = kind.for_count(256).stream(key, Dim::Hemisphere);
            for i in 0..256 {
                let ([x, y], [z, w]) = (area.sample_2d(i), hemisphere.sample_2d(i));
                observed[[x, y, z, w].iter().fold(0, |cell, x| 4 * cell + (4.0 * x) as usize)] += 1;
            }
        }
        // The strata only lower the statistic of Sobol points, so the p-value can come out high, never low.
        let p_value = chi_squared_p_value(&observed, &[100.0; 256]);
        assert!(p_value > SIGNIFICANCE, "{kind}: p = {p_value:.1e}");
    }
}

/// The relative error of an RMS over 2000 seeds is 1/√4000 = 1.6 % for normal errors; 5σ is 8 %.
#[track_caller]
fn assert_rms(kind: SamplerKind, n: u32, exact_rms: f64, f: impl Fn([f32; 2]) -> f64, mean: f64) {
    let measured = rms_error(2000, mean, |seed| {
        let (stream, n) = stream(kind, n, seed);
        (0..n).map(|i| f(stream.sample_2d(i))).sum::<f64>() / f64::from(n)
    });
    assert!((measured / exact_rms - 1.0).abs() < 0.08, "{kind}, N = {n}: {measured:e}, not {exact_rms:e}");
}

#[test]
fn the_variance_of_scrambled_sobol_points_follows_the_exact_law() {
    for n in [4_u32, 16, 64, 256] {
        let law = 1.0 / (12.0 * f64::from(n).powi(3)).sqrt();
        assert_rms(SamplerKind::Sobol, n, law, |[x, _]| f64::from(x), 0.5);
        assert_rms(SamplerKind::Sobol, n, law, |[_, y]| f64::from(y), 0.5);
        assert_rms(SamplerKind::Sobol, n, law * 2.0_f64.sqrt(), |[x, y]| f64::from(x) + f64::from(y), 1.0);
    }
    // The value given in the literature for 64 points.
    assert!((1.0 / (12.0 * 64.0_f64.powi(3)).sqrt() - 5.6382e-4).abs() < 1e-8);
}

#[test]
fn the_variance_of_jittered_points_follows_the_exact_law() {
    for n in [4_u32, 16, 64, 256] {
        let law = 1.0 / (6.0_f64.sqrt() * f64::from(n));
        assert_rms(SamplerKind::Stratified, n, law, |[x, y]| f64::from(x) + f64::from(y), 1.0);
    }
}

#[test]
fn the_variance_of_random_points_follows_the_exact_law() {
    for n in [4_u32, 16, 64, 256] {
        let law = 1.0 / (12.0 * f64::from(n)).sqrt();
        assert_rms(SamplerKind::Random, n, law, |[x, _]| f64::from(x), 0.5);
        assert_rms(SamplerKind::Random, n, law, |[_, y]| f64::from(y), 0.5);
    }
}

/// Closed forms: Q(1, x) = e⁻ˣ, Q(½, x) = erfc(√x), Q(2, x) = (1 + x) e⁻ˣ.
#[test]
fn the_gamma_function_behind_the_p_values_is_right() {
    for x in [0.1, 1.0, 3.0, 12.0, 50.0] {
        assert!((upper_gamma(1.0, x) / (-x).exp() - 1.0).abs() < 1e-11);
        assert!((upper_gamma(2.0, x) / ((1.0 + x) * (-x).exp()) - 1.0).abs() < 1e-11);
    }
    assert!((upper_gamma(0.5, 1.0) - 0.157_299_207_050_285).abs() < 1e-12);
    assert!((upper_gamma(0.5, 4.0) - 0.004_677_734_981_047).abs() < 1e-12);
    // 95 % quantile of the chi-squared distribution with 10 degrees of freedom.
    assert!((upper_gamma(5.0, 0.5 * 18.307_038_053_275_1) - 0.05).abs() < 1e-12);
    assert!(chi_squared_p_value(&[150, 50], &[100.0, 100.0]) < 1e-6);
}
