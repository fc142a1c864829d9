//! Light by direction at lumels.

use crate::{built, lumels, room, settings, solved, tessellated};
use glam::Vec3;
use lumel::{
    BounceLimit, Checkpoint, Control, Directional, Lightmap, LightmapLayer, LumelParts, LumelState,
    SceneBuilder, Settings,
};
use lumel_scene::Radiance;
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::{grey, scene};

fn few() -> Settings {
    Settings {
        bounces: BounceLimit::Count(2),
        direct_samples: 16,
        indirect_samples: 64,
        directional: Directional::Sh1,
        ..settings()
    }
}

#[test]
fn under_an_even_sky_lumels_have_the_coefficients_of_a_hemisphere() {
    let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
    let builder = SceneBuilder {
        sky: Radiance::splat(1.0).into(),
        ..scene(vec![quad(corners, [1, 1], 0)], vec![grey(0.5, 0.0)], Vec::new())
    };
    let scene = built(builder);
    let lumels = lumels(&scene, 8.0);
    let (baker, state) = solved(&scene, few());
    let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
    let expected = [1.772_453_9, 1.534_990_1, 0.0, 0.0];
    assert_eq!(light.directional.harmonics.len(), expected.len());
    for (harmonic, expected) in light.directional.harmonics.iter().zip(expected) {
        // A ray has a standard deviation of 0.7 at most, a lumel 8 of them, and there are 64 lumels: four standard errors of
        // independent rays.
        let mean = harmonic.iter().map(|value| value.x).sum::<f32>() / light.len() as f32;
        assert!((mean - expected).abs() < 0.125 && light.len() >= 64, "{mean} {expected}");
        assert!(harmonic.iter().all(|value| (value.x - expected).abs() < 1.0));
    }
}

#[test]
fn irradiance_keeps_its_bits_and_coefficients_come_in_any_parts() {
    let scene = built(room());
    let lumels = lumels(&scene, 8.0);
    let (baker, state) = solved(&tessellated(&room(), 0.3), few().carrying());
    let with = |directional| baker.relit(baker.scene().clone(), Settings { directional, ..few() });
    let plain = with(Directional::Off).light_at_lumels(&state, &lumels, &Control::default()).unwrap();
    let baker = with(Directional::Sh1);
    let whole = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
    assert!(whole.sources == plain.sources && whole.halves == plain.halves);
    assert!(plain.directional.harmonics.is_empty() && whole.directional.done as usize == whole.len());
    // In parts, stopped in the midst of them, and continued from a file.
    let mut parts = LumelParts::default();
    parts.most = 100;
    let (mut light, control) = (baker.no_light_at_lumels(&state, &lumels), Control::default());
    let mut stop = |light: &lumel::LumelLight| {
        if light.directional.done > 300 {
            control.cancel();
        }
    };
    baker.continue_lumel_parts(&state, &lumels, &mut light, &mut parts, &control, &mut stop).unwrap_err();
    let (folder, identity) = (tempfile::tempdir().unwrap(), lumels.identity().to_string());
    let path = folder.path().join("a.checkpoint.npz");
    let saved = LumelState { identity: &identity, light: &light };
    baker.checkpoint(&state).save_with(Some(saved), &path).unwrap();
    let mut loaded = Checkpoint::load_lumels(&path, &identity).unwrap().unwrap();
    assert!(loaded == light && loaded.directional.done < loaded.len() as u32);
    baker.continue_lumels(&state, &lumels, &mut loaded, &Control::default(), &mut |_| {}).unwrap();
    assert!(loaded == whole);
    // Another kind is measured from the beginning.
    let baker = with(Directional::Sh2);
    baker.continue_lumels(&state, &lumels, &mut loaded, &Control::default(), &mut |_| {}).unwrap();
    assert_eq!(loaded.directional.harmonics.len(), 9);
    assert!(loaded.directional.harmonics[..4] == whole.directional.harmonics);
    let known = baker.solved_at_lumels(&state, &lumels);
    let lightmap = Lightmap::finished(&scene, &lumels.atlas, &lumels.coverage, &whole, Some(&known), None);
    let plain = Lightmap::finished(&scene, &lumels.atlas, &lumels.coverage, &plain, Some(&known), None);
    let names: Vec<&str> = lightmap.layers.iter().map(|layer| layer.name.as_str()).collect();
    assert_eq!(
        names,
        ["irradiance", "direct", "bounce 1", "bounce 2", "sh0", "sh1", "sh2", "sh3", "noisy", "error"]
    );
    for layer in &plain.layers {
        let same = lightmap.layers.iter().find(|other| other.name == layer.name).unwrap();
        assert_eq!(same.values, layer.values, "{}", layer.name);
    }
    // Directions are signed, and the lamp shines from above.
    let of =
        |harmonic| &lightmap.layers.iter().find(|layer| layer.harmonic() == Some(harmonic)).unwrap().values;
    assert!(of(2).iter().any(|value| value.x < -0.1) && of(0).iter().all(|value| value.x >= 0.0));
    assert_eq!(LightmapLayer::of_harmonic(3), "sh3");
}
