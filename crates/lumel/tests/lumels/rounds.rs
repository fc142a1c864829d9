//! Samples that come in rounds and parts: bits, checkpoints, where they go, and rays that are kept.

use crate::{Placed, built, irradiance, lumels, measured, room, settings, solved, tessellated};
use glam::Vec3;
use lumel::{
    Baker, BounceLimit, Checkpoint, Control, LumelLight, LumelParts, LumelState, Memory, Saved, Settings,
    Silent, SolveState, TargetError,
};
use lumel_scene::{Light, RectLight};
use std::sync::Arc;

#[test]
fn lumels_have_the_same_bits_on_any_number_of_threads_and_in_any_memory() {
    let in_memory = |memory: u64, n_threads| {
        let settings =
            Settings { memory: Memory(memory), direct_samples: 8, indirect_samples: 16, ..settings() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| {
            let lumels = lumels(&built(room()), 8.0);
            let plenty = Settings { memory: Memory(1 << 30), ..settings.clone() };
            let (baker, state) = solved(&tessellated(&room(), 0.3), plenty);
            let baker = baker.relit(Arc::clone(baker.scene()), settings);
            baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap()
        })
    };
    let whole = in_memory(1 << 30, 2);
    assert!(whole == in_memory(1 << 30, 1));
    assert!(whole == in_memory(100_000, 2), "in parts");
}

#[test]
fn stopped_lumels_continue_from_their_checkpoint_with_the_same_bits() {
    let settings = Settings { memory: Memory(40_000), direct_samples: 8, indirect_samples: 16, ..settings() };
    let lumels = lumels(&built(room()), 8.0);
    let (baker, state) = solved(&tessellated(&room(), 0.3), settings);
    let whole = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
    let (folder, identity) = (tempfile::tempdir().unwrap(), lumels.identity().to_string());
    let path = folder.path().join("a.checkpoint.npz");
    let (mut light, mut n_stops) = (baker.no_light_at_lumels(&state, &lumels), 0);
    loop {
        // Every third part, as if the program had been killed and started again.
        let (control, mut n_parts) = (Control::default(), 0);
        let continued = baker.continue_lumels(&state, &lumels, &mut light, &control, &mut |light| {
            n_parts += 1;
            if n_parts == 3 {
                let saved = LumelState { identity: &identity, light };
                baker.checkpoint(&state).save_with(Some(saved), &path).unwrap();
                control.cancel();
            }
        });
        if continued.is_ok() {
            break;
        }
        n_stops += 1;
        assert_eq!(Checkpoint::load_lumels(&path, "lumels of another atlas").unwrap(), None);
        light = Checkpoint::load_lumels(&path, &identity).unwrap().unwrap();
        assert!(matches!(Saved::load(&path), Ok(Saved::Checkpoint(_))));
    }
    assert!(n_stops > 1 && light == whole, "{n_stops} stops");
}

#[test]
fn more_samples_go_where_light_is_noisy_until_a_target_is_reached() {
    let (lumels, plain) = measured(&Placed::as_given(room()), 0.3, 12.0, settings());
    let samples = |light: &LumelLight| light.halves[0].samples.clone();
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    let (few, most) = (mean(&samples(&plain)), samples(&plain).into_iter().fold(0.0, f32::max));
    assert!((1.6..2.4).contains(&few) && most == 4.0, "{few} {most}");
    let fine = tessellated(&room(), 0.3);
    let (baker, state) = solved(&fine, settings());
    let aiming = |error: &str| {
        let target_error = TargetError::At(error.parse().unwrap());
        let baker = baker.relit(Arc::clone(&fine), Settings { target_error, ..settings() });
        let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
        (baker.accuracy_at_lumels(&lumels, &light), light)
    };
    let (accuracy, light) = aiming("4%");
    assert!(accuracy.share.unwrap() >= 0.95 && accuracy.percentile_95 <= 0.04, "{accuracy:?}");
    // What the halves say is no less than what many more samples show.
    let (_, reference) = aiming("1%");
    let floor = 0.1 * mean(&irradiance(&reference).map(|e| e.x).collect::<Vec<f32>>());
    let off = |(a, b): (Vec3, Vec3)| ((a.x - b.x) / b.x.max(floor)).abs();
    let mut errors: Vec<f32> = irradiance(&light).zip(irradiance(&reference)).map(off).collect();
    errors.sort_by(f32::total_cmp);
    let [median, worst] = [0.5, 0.95].map(|share| errors[(share * errors.len() as f32) as usize]);
    println!("median {median}, 95 % below {worst}");
    assert!(worst < 0.04 && median > 0.001, "{median} {worst}");
}

#[test]
fn rays_that_are_kept_measure_other_light_with_the_same_bits() {
    let scene = built(room());
    let lumels = lumels(&scene, 9.0);
    let settings =
        Settings { bounces: BounceLimit::Count(2), direct_samples: 8, indirect_samples: 64, ..settings() };
    let baker = Baker::new(Arc::clone(&scene), settings.clone());
    let (mut parts, mut few) = (LumelParts::default(), LumelParts::default());
    (parts.most, parts.kept_bytes) = (200, 1 << 30);
    few.kept_bytes = 1000;
    let mut saved = Vec::new();
    for shift in [0.0, 0.1] {
        let moved = |light: &Light| match *light {
            Light::Rect(rect) => Light::Rect(RectLight { center: rect.center + Vec3::X * shift, ..rect }),
            light => light,
        };
        let relit = Arc::new(scene.relit(scene.lights().iter().map(moved).collect()).unwrap());
        let (baker, mut state) = (baker.relit(relit, settings.clone()), SolveState::new());
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        let whole = Control::default();
        let expected = baker.light_at_lumels(&state, &lumels, &whole).unwrap();
        for parts in [&mut parts, &mut few] {
            let (control, mut light) = (Control::default(), baker.no_light_at_lumels(&state, &lumels));
            baker.continue_lumel_parts(&state, &lumels, &mut light, parts, &control, &mut |_| {}).unwrap();
            assert!(light == expected, "{shift}");
            saved.push(whole.rays() - control.rays());
        }
    }
    // A ray takes 8 bytes, and every lumel has some.
    let kept = parts.bytes() / 8;
    assert!(saved[..2] == [0, 0] && saved[3] == 0 && few.bytes() == 0, "{saved:?}");
    assert!(saved[2] >= kept && kept > 8 * lumels.coverage.len() as u64, "{saved:?} {kept}");
}
