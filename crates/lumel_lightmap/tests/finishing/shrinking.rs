use crate::Stage;
use crate::denoising::{fine, normal};
use glam::{DVec3, Vec3};
use lumel_lightmap::{Lightmap, LumelLight, PartLight, SolvedLight};

/// Light of a place.
type Light<'a> = &'a dyn Fn(DVec3) -> f32;

/// Noise of each half of the samples, relative to the light.
const NOISE: f32 = 0.2;

/// Of which the first half has each part of the light: direct, and two bounces.
const PARTS: [f32; 3] = [0.5, 0.3, 0.2];

/// The same light by place, as a lumel may have it.
fn at_places(stage: &Stage, light: Light<'_>) -> Vec<f32> {
    let values = stage.measured(|_, at| Vec3::splat(light(at)));
    stage.coverage.lumels().iter().map(|&lumel| values[lumel as usize].x).collect()
}

/// Light with noise.
fn measured(truth: &[f32], noise: f32) -> LumelLight {
    let n = truth.len();
    let half = |half: usize| {
        let part = |k: usize| {
            let noise = |place: usize| 1.0 + noise * normal(6 * place + 3 * half + k);
            (0..n).map(|place| Vec3::splat(PARTS[k] * truth[place] * noise(place))).collect()
        };
        PartLight { known: vec![true; n], sources: (0..3).map(part).collect() }
    };
    let mut light = LumelLight::new(n, 3, false);
    light.add(0..n, &[half(0), half(1)]);
    light
}

/// What a solve says of light.
fn said(light: &[f32]) -> SolvedLight {
    let of = |share: f32| light.iter().map(|value| Vec3::splat(share * value)).collect();
    SolvedLight { direct: of(PARTS[0]), bounces: of(PARTS[1] + PARTS[2]) }
}

fn finished(stage: &Stage, light: &LumelLight, solved: &SolvedLight) -> Lightmap {
    Lightmap::finished(&stage.scene, &stage.atlas, &stage.coverage, light, Some(solved), None)
}

/// The root of the mean squared error of all light.
fn error(stage: &Stage, truth: &[f32], light: &LumelLight, solved: &SolvedLight) -> f64 {
    let lightmap = finished(stage, light, solved);
    let squares = truth
        .iter()
        .zip(stage.coverage.lumels())
        .map(|(truth, &lumel)| f64::from(lightmap.layers[0].values[lumel as usize].x - truth).powi(2));
    (squares.sum::<f64>() / truth.len() as f64).sqrt()
}

#[test]
fn what_a_solve_knows_takes_off_noise_and_what_it_does_not_know_stays() {
    let stage = fine();
    let from = stage.scene.bounds().center().as_dvec3();
    let across = move |at: DVec3| (at - from).dot(DVec3::new(0.3, -0.7, 0.4).normalize());
    let smooth = move |at: DVec3| 2.0 + (9.0 * across(at)).sin() as f32;
    // A line three lumels wide, as light under a skirting board.
    let line = move |at: DVec3| smooth(at) * if across(at).abs() < 0.024 { 0.3 } else { 1.0 };
    let cases: [(&str, Light<'_>, Light<'_>, f64); 5] = [
        ("the same", &smooth, &smooth, 0.6),
        ("2 % more", &smooth, &|at| 1.02 * smooth(at), 0.7),
        ("half more", &smooth, &|at| 1.5 * smooth(at), 1.1),
        ("a line", &line, &smooth, 0.9),
        ("nothing", &smooth, &|_| 0.0, 1.1),
    ];
    for (name, truth, solved, most) in cases {
        let [truth, solved] = [truth, solved].map(|light| at_places(&stage, light));
        let light = measured(&truth, NOISE);
        let [with, without] =
            [said(&solved), SolvedLight::default()].map(|solved| error(&stage, &truth, &light, &solved));
        println!("{name}: an error of {with:.4}, without the solve {without:.4}");
        assert!(with < most * without, "{name}: {with} {without}");
    }
    let [truth, solved] = [&line as Light<'_>, &smooth].map(|light| at_places(&stage, light));
    let lightmap = finished(&stage, &measured(&truth, NOISE), &said(&solved));
    let (mut was, mut is) = (0.0, 0.0);
    for ((truth, solved), &lumel) in truth.iter().zip(&solved).zip(stage.coverage.lumels()) {
        let [all, parts @ ..] = [0, 1, 2, 3].map(|layer| lightmap.layers[layer].values[lumel as usize].x);
        assert!((all - parts.iter().sum::<f32>()).abs() < 1e-5 * all, "{all} {parts:?}");
        if solved != truth {
            (was, is) = (was + truth, is + all);
        }
    }
    println!("the line has {:.3} of its light", is / was);
    assert!((is / was - 1.0f32).abs() < 0.1);
}

#[test]
fn light_without_noise_keeps_its_bits_whatever_a_solve_says() {
    let stage = fine();
    let truth: Vec<f32> = (0..stage.coverage.len()).map(|place| 1.0 + (place % 7) as f32).collect();
    let exact = measured(&truth, 0.0);
    let [with, without] = [said(&vec![2.0; truth.len()]), SolvedLight::default()]
        .map(|solved| finished(&stage, &exact, &solved).layers);
    assert!(with == without);
}
