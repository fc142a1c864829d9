use crate::denoising::{fine, normal};
use crate::{Stage, noise};
use glam::Vec3;
use lumel_lightmap::{Lightmap, LumelLight, PartLight};
use lumel_scene::luminance;

/// What all lumels have, W·m⁻².
const USUAL: f32 = 2.0;
/// What some have more.
const MORE: f32 = 60.0;

/// Light from two sources with a little noise, and more of the second at one lumel of a hundred: in one half or in both.
fn light(stage: &Stage, halves: usize) -> (LumelLight, Vec<bool>) {
    let n = stage.coverage.len();
    let is_bright: Vec<bool> = (0..n).map(|place| noise(7 * place + 3) < 0.01).collect();
    let half = |half: usize| {
        let noisy = |place: usize| Vec3::splat(0.5 * USUAL + 0.02 * normal(2 * place + half));
        let more = |place: usize| if is_bright[place] && half < halves { MORE } else { 0.0 };
        let sources = [Vec3::ZERO, Vec3::new(1.0, 0.5, 0.0)]
            .map(|color| (0..n).map(|place| noisy(place) + color * more(place)).collect());
        PartLight { known: vec![true; n], sources: sources.to_vec() }
    };
    let mut light = LumelLight::new(n, 2, false);
    light.add(0..n, &[half(0), half(1)]);
    (light, is_bright)
}

fn finished(stage: &Stage, light: &LumelLight, denoises: bool) -> Lightmap {
    Lightmap::finished(&stage.scene, &stage.atlas, &stage.coverage, light, denoises, None)
}

/// Of each lumel that was measured.
fn all_light<'a>(stage: &'a Stage, lightmap: &'a Lightmap) -> impl Iterator<Item = f32> + 'a {
    stage.coverage.lumels().iter().map(|&lumel| luminance(lightmap.layers[0].values[lumel as usize]))
}

#[test]
fn what_one_half_of_the_samples_found_in_one_lumel_is_spread_and_keeps_its_power() {
    let stage = fine();
    let (light, is_bright) = light(&stage, 1);
    assert!(is_bright.iter().filter(|bright| **bright).count() > 100);
    let [noisy, clean] = [false, true].map(|denoises| finished(&stage, &light, denoises));
    let [before, after] = [&noisy, &clean].map(|lightmap| all_light(&stage, lightmap).collect::<Vec<f32>>());
    let most = |values: &[f32]| values.iter().copied().fold(0.0, f32::max);
    assert!(most(&before) > 5.0 * USUAL && most(&after) < 1.5 * USUAL, "{} {}", most(&before), most(&after));
    let [before, after] = [before, after].map(|values| values.iter().map(|v| f64::from(*v)).sum::<f64>());
    assert!((after / before - 1.0).abs() < 2e-3, "{before} {after}");
    // As all parts of the light are.
    for &lumel in stage.coverage.lumels() {
        let [all, direct, bounce] = [0, 1, 2].map(|layer| clean.layers[layer].values[lumel as usize]);
        assert!((all - direct - bounce).abs().max_element() < 1e-4 && direct.min_element() > 0.0);
    }
}

#[test]
fn small_spots_that_both_halves_see_stay() {
    let stage = fine();
    let (light, is_bright) = light(&stage, 2);
    let lightmap = finished(&stage, &light, true);
    let expected = USUAL + luminance(Vec3::new(1.0, 0.5, 0.0)) * MORE;
    let spots = all_light(&stage, &lightmap).zip(is_bright).filter(|(_, bright)| *bright);
    let mut off: Vec<f32> = spots.map(|(found, _)| (found / expected - 1.0).abs()).collect();
    off.sort_by(f32::total_cmp);
    // Closing seams takes from the few that lie there.
    assert!(off[off.len() * 9 / 10] < 0.01, "{:?}", &off[off.len() * 9 / 10..]);
}
