//! What the denoiser makes of the samples of each preset, and of many.

use crate::{Case, lumels_of, settings, solved};
use glam::Vec3;
use lumel::{Control, Lightmap, Lumels, MaxEdge, Preset, Settings};
use lumel_scene::luminance;
use lumel_uv::Density;
use std::sync::Arc;

/// Lumels of a scene: few, so that light changes much from one to the next.
const LUMELS: u32 = 1 << 14;

/// Samples, as a multiple of those of medium.
const MANY: u32 = 16;

/// Darker lumels are compared with this share of the mean light.
const DARK: f64 = 0.1;

/// Prints errors at the lumels against an independent bake of many samples, without the worst 2 % of the lumels.
pub(crate) fn measure(case: &Case) -> Result<(), String> {
    let whole = case.open(MaxEdge::Off, Preset::Medium)?;
    let fine = case.open(MaxEdge::Auto, Preset::Medium)?;
    let lumels = lumels_of(&whole, Density::Budget(LUMELS));
    let (baker, state) = solved(&fine, &settings(Preset::Medium));
    let medium = settings(Preset::Medium);
    let many = Settings {
        direct_samples: MANY * medium.direct_samples,
        indirect_samples: MANY * medium.indirect_samples,
        ..medium
    };
    let solved = baker.solved_at_lumels(&state, &lumels);
    let bake = |samples: &Settings, seed| {
        let baker = baker.relit(Arc::clone(&fine), Settings { seed, ..samples.clone() });
        let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
        let Lumels { scene, atlas, coverage } = &lumels;
        [None, Some(&solved)].map(|solved| {
            let map = Lightmap::finished(scene, atlas, coverage, &light, solved, None);
            let value = |(place, &lumel): (usize, &u32)| {
                if light.is_valid(place) { map.layers[0].values[lumel as usize] } else { Vec3::NAN }
            };
            coverage.lumels().iter().enumerate().map(value).collect::<Vec<Vec3>>()
        })
    };
    let [known, _] = bake(&many, 99);
    let valid = || known.iter().filter(|value| value.is_finite());
    let n = valid().count() as f64;
    let mean = valid().map(|&value| f64::from(luminance(value))).sum::<f64>() / n;
    let power = valid().map(|value| f64::from(value.length_squared())).sum::<f64>() / n;
    let presets = [Preset::Draft, Preset::Medium, Preset::Production];
    let rungs = presets.map(|preset| (format!("{preset:?}"), settings(preset)));
    for (name, samples) in rungs.into_iter().chain([(format!("{MANY} x Medium"), many)]) {
        let [noisy, denoised] = bake(&samples, 7);
        let error = |values: &[Vec3]| {
            let squares = values.iter().zip(&known).map(|(a, b)| f64::from(a.distance_squared(*b)));
            let mut squares: Vec<f64> = squares.filter(|square| square.is_finite()).collect();
            squares.sort_by(f64::total_cmp);
            squares.truncate(squares.len() * 98 / 100);
            100.0 * (squares.iter().sum::<f64>() / squares.len() as f64 / power).sqrt()
        };
        let change = |(a, b): (&Vec3, &Vec3)| {
            let (a, b) = (f64::from(luminance(*a)), f64::from(luminance(*b)));
            100.0 * (b - a).abs() / a.max(DARK * mean)
        };
        let changes = noisy.iter().zip(&denoised).map(change);
        let mut changes: Vec<f64> = changes.filter(|change| change.is_finite()).collect();
        changes.sort_by(f64::total_cmp);
        let [before, after] = [&noisy, &denoised].map(|values| error(values));
        let [half, most] = [50, 95].map(|percent| changes[changes.len() * percent / 100]);
        println!(
            "  {name:<12} error {before:6.3} %, denoised {after:6.3} %; half change by less than {half:5.2} %, 95 % by {most:5.2} %"
        );
    }
    Ok(())
}
