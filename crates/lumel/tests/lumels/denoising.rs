//! Denoised light against light from many more samples.

use crate::{Placed, built, lumels, room, settings, solved, tessellated};
use glam::Vec3;
use lumel::{
    AmbientOcclusion, Baker, BounceLimit, Control, Lightmap, LightmapLayer, LumelLight, Lumels, Settings,
    SolvedLight,
};
use lumel_scene::luminance;
use lumel_testkit::mesh::{Facing, sphere};
use lumel_testkit::rms;
use lumel_testkit::scene::{grey, scene};
use std::sync::Arc;

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
    let of_solve = baker.solved_at_lumels(&state, &lumels);
    let read = |light: &LumelLight, denoises: bool| -> Vec<f64> {
        let solved = denoises.then_some(&of_solve);
        let map = Lightmap::finished(&lumels.scene, &lumels.atlas, &lumels.coverage, light, solved, None);
        let lumels = lumels.coverage.lumels().iter().enumerate().filter(|(place, _)| light.is_valid(*place));
        lumels.map(|(_, &lumel)| luminance(map.layers[0].values[lumel as usize]).into()).collect()
    };
    let known = read(&bake(of(128, 512, 9)), false);
    for (name, settings, most) in [("draft", of(16, 64, 1), 0.45), ("medium", of(64, 256, 1), 0.8)] {
        let light = bake(settings);
        let [noisy, denoised] = [false, true].map(|denoises| {
            rms(read(&light, denoises).iter().zip(&known).map(|(found, known)| found - known))
        });
        println!("{name}: {noisy:.4} to {denoised:.4}");
        assert!(denoised < most * noisy, "{name}: {noisy} to {denoised}");
    }
    let many = bake(of(1024, 4096, 1));
    let changes = read(&many, false).into_iter().zip(read(&many, true));
    let mut changes: Vec<f64> = changes.map(|(before, after)| (after / before - 1.0).abs()).collect();
    changes.sort_by(f64::total_cmp);
    println!("many: {}", changes[changes.len() / 2]);
    assert!(changes[changes.len() / 2] < 0.002);
}

#[test]
fn the_noise_of_openness_is_taken_off_as_that_of_light() {
    let ball = sphere(Vec3::ZERO, 1.0, 3, Facing::Inward, 0);
    let scene = built(scene(vec![ball], vec![grey(0.5, 0.0)], vec![]));
    let lumels = lumels(&scene, 12.0);
    let Lumels { scene, atlas, coverage } = &lumels;
    let settings = Settings { indirect_samples: 16, ..settings() };
    let baker = Baker::new(Arc::clone(scene), settings);
    let occlusion = AmbientOcclusion { distance: 2.0, falloff: 1.0 };
    let openness = baker.openness_at_lumels(occlusion, &lumels, &Control::default()).unwrap();
    let nothing = SolvedLight::default();
    let [noisy, calm] = [None, Some(&nothing)].map(|known| {
        let lightmap = Lightmap::finished(scene, atlas, coverage, &openness, known, Some(&openness));
        let layer = lightmap.layers.iter().find(|layer| layer.name == LightmapLayer::OCCLUSION).unwrap();
        let off = |lumel: &u32| (layer.values[*lumel as usize].x - 2.0 / 3.0).powi(2);
        (coverage.lumels().iter().map(off).sum::<f32>() / coverage.len() as f32).sqrt()
    });
    println!("off by {noisy}, without noise by {calm}");
    assert!(noisy > 0.02 && calm < 0.5 * noisy, "{noisy} {calm}");
}
