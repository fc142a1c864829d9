use crate::denoising::{fine, normal};
use crate::{Stage, noise};
use glam::Vec3;
use lumel_lightmap::{Lightmap, LumelLight, PartLight, SolvedLight};
use lumel_scene::luminance;

/// What all lumels have, W·m⁻².
const USUAL: f32 = 2.0;
/// What some have more, in which colour.
const MORE: f32 = 60.0;
const COLOR: Vec3 = Vec3::new(1.0, 0.5, 0.0);

/// Which share of that a half of the samples finds at a place.
type Finds<'a> = &'a dyn Fn(usize, usize) -> f32;

/// Light from two sources with a little noise, and more of the second where a half of the samples finds it, by place.
fn light(stage: &Stage, finds: Finds<'_>) -> LumelLight {
    let n = stage.coverage.len();
    let half = |half: usize| {
        let noisy = |place: usize| Vec3::splat(0.5 * USUAL + 0.02 * normal(2 * place + half));
        let more = |place: usize| MORE * finds(half, place);
        let sources =
            [Vec3::ZERO, COLOR].map(|color| (0..n).map(|place| noisy(place) + color * more(place)).collect());
        PartLight { known: vec![true; n], sources: sources.to_vec() }
    };
    let mut light = LumelLight::new(n, 2, false);
    light.add(0..n, &[half(0), half(1)]);
    light
}

fn finished(stage: &Stage, light: &LumelLight, denoises: bool) -> Lightmap {
    finished_by(stage, light, denoises.then_some(&SolvedLight::default()))
}

fn finished_by(stage: &Stage, light: &LumelLight, solved: Option<&SolvedLight>) -> Lightmap {
    Lightmap::finished(&stage.scene, &stage.atlas, &stage.coverage, light, solved, None)
}

/// One lumel of a hundred.
fn is_rare(place: usize) -> bool {
    noise(7 * place + 3) < 0.01
}

/// Of each lumel that was measured.
fn all_light<'a>(stage: &'a Stage, lightmap: &'a Lightmap) -> impl Iterator<Item = f32> + 'a {
    stage.coverage.lumels().iter().map(|&lumel| luminance(lightmap.layers[0].values[lumel as usize]))
}

#[test]
fn what_halves_of_the_samples_found_by_chance_is_spread_and_keeps_its_power() {
    let stage = fine();
    let rare = |half: usize, place: usize| f32::from(half == 0 && is_rare(place));
    let dense = |half: usize, place: usize| f32::from(noise(7 * place + 3 + 100_003 * half) < 0.1);
    let finds: [(&str, Finds<'_>); 2] = [("rare", &rare), ("dense", &dense)];
    for (name, finds) in finds {
        let light = light(&stage, finds);
        let [noisy, clean] = [false, true].map(|denoises| finished(&stage, &light, denoises));
        let [before, after] =
            [&noisy, &clean].map(|lightmap| all_light(&stage, lightmap).collect::<Vec<f32>>());
        let sum = |values: &[f32]| values.iter().map(|value| f64::from(*value)).sum::<f64>();
        let mean = (sum(&before) / before.len() as f64) as f32;
        // The share of lumels that are to be seen.
        let bright = |values: &[f32]| {
            values.iter().filter(|value| **value > 2.0 * mean).count() as f64 / values.len() as f64
        };
        println!("{name}: {} of the lumels are bright, then {}", bright(&before), bright(&after));
        assert!(
            bright(&before) > 0.008 && bright(&after) < 0.05 * bright(&before),
            "{name}: {}",
            bright(&after)
        );
        let power = sum(&after) / sum(&before);
        assert!((power - 1.0).abs() < 2e-3, "{name}: {power}");
        // As all parts of the light are.
        for &lumel in stage.coverage.lumels() {
            let [all, direct, bounce] = [0, 1, 2].map(|layer| clean.layers[layer].values[lumel as usize]);
            assert!((all - direct - bounce).abs().max_element() < 1e-4 && direct.min_element() > 0.0);
        }
    }
}

/// How far the light of rare lumels is from so much of what they have more, relative to it: nine of ten are nearer.
fn off(stage: &Stage, lightmap: &Lightmap, share: f32) -> f32 {
    let expected = USUAL + share * MORE * luminance(COLOR);
    let spots = all_light(stage, lightmap).enumerate().filter(|(place, _)| is_rare(*place));
    let mut off: Vec<f32> = spots.map(|(_, found)| (found / expected - 1.0).abs()).collect();
    off.sort_by(f32::total_cmp);
    // Closing seams takes from the few that lie there.
    assert!(off.len() > 100);
    off[off.len() * 9 / 10]
}

#[test]
fn small_spots_that_both_halves_see_stay() {
    let stage = fine();
    for fainter in [1.0, 0.5] {
        let finds = |half, place| if is_rare(place) { [1.0, fainter][half] } else { 0.0 };
        let lightmap = finished(&stage, &light(&stage, &finds), true);
        let off = off(&stage, &lightmap, 0.5 + 0.5 * fainter);
        assert!(off < 0.01, "{fainter}: {off}");
    }
}

#[test]
fn small_spots_that_the_solve_knows_stay() {
    let stage = fine();
    let light = light(&stage, &|half, place| f32::from(half == 0 && is_rare(place)));
    // Elsewhere it is far off, so that light is not moved towards it.
    let says = |spot: Vec3| {
        let bounces = |place| if is_rare(place) { 0.5 * USUAL + spot } else { Vec3::splat(0.5 * MORE) };
        let bounces = (0..stage.coverage.len()).map(bounces).collect();
        finished_by(&stage, &light, Some(&SolvedLight { bounces, ..SolvedLight::default() }))
    };
    assert!(off(&stage, &says(0.5 * MORE * COLOR), 0.5) < 0.03);
    assert!(off(&stage, &says(Vec3::ZERO), 0.0) < 0.5);
}
