//! Denoised light against light from many more samples.

use crate::{Placed, room, settings, solved, tessellated};
use lumel::{BounceLimit, Control, Lightmap, LumelLight, Settings};
use lumel_scene::luminance;
use lumel_testkit::rms;

#[test]
fn less_noise_is_left_of_few_samples_and_many_hardly_change() {
    let placed = Placed::as_given(room());
    let (lumels, fine) = (placed.lumels(12.0), tessellated(&placed.builder, 0.2));
    let of = |direct_samples, indirect_samples, seed| {
        let bounces = BounceLimit::Count(1);
        Settings { bounces, direct_samples, indirect_samples, seed, ..settings() }
    };
    let (baker, state) = solved(&fine, of(64, 256, 0));
    let bake = |settings| {
        let baker = baker.relit(fine.clone(), settings);
        baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap()
    };
    let read = |light: &LumelLight, denoises| -> Vec<f64> {
        let map = Lightmap::finished(&lumels.scene, &lumels.atlas, &lumels.coverage, light, denoises, &[]);
        let lumels = lumels.coverage.lumels().iter().enumerate().filter(|(place, _)| light.is_valid(*place));
        lumels.map(|(_, &lumel)| luminance(map.layers[0].values[lumel as usize]).into()).collect()
    };
    let known = read(&bake(of(128, 512, 9)), false);
    for (name, settings, most) in [("draft", of(16, 64, 1), 0.75), ("medium", of(64, 256, 1), 0.97)] {
        let light = bake(settings);
        let [noisy, denoised] = [false, true].map(|denoises| {
            rms(read(&light, denoises).iter().zip(&known).map(|(found, known)| found - known))
        });
        println!("{name}: {noisy:.4} to {denoised:.4}");
        assert!(denoised < most * noisy, "{name}: {noisy} to {denoised}");
    }
    let many = bake(of(512, 1024, 1));
    let changes = read(&many, false).into_iter().zip(read(&many, true));
    let mut changes: Vec<f64> = changes.map(|(before, after)| (after / before - 1.0).abs()).collect();
    changes.sort_by(f64::total_cmp);
    println!("many: {}", changes[changes.len() / 2]);
    assert!(changes[changes.len() / 2] < 0.002);
}
