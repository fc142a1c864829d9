use crate::{Stage, moved, of, pair, settings, stages};
use glam::{DVec3, Vec3};
use lumel_basis::{Directional, Lighting};
use lumel_lightmap::{Filter, LightmapLayer, LumelLighting};
use lumel_uv::UnwrapSettings;

/// Linear in space, positive around our scenes.
fn linear(at: DVec3) -> Vec3 {
    let one = 4.0 + at.dot(DVec3::new(0.31, -0.17, 0.23));
    DVec3::new(one, 2.0 * one, 9.0 - one).as_vec3()
}

#[test]
fn light_that_is_linear_in_space_is_read_exactly_on_flat_charts() {
    for (name, stage) in stages().into_iter().filter(|(name, _)| *name != "ball") {
        let mut lightmap = stage.lightmap(stage.measured(|_, at| linear(at)), |_| true);
        lightmap.finish(&stage.scene, &stage.coverage);
        for at in stage.points() {
            let (read, is) = (lightmap.at(0, at).0, linear(stage.scene.position(at).as_dvec3()));
            assert!((read - is).abs().max_element() < 1e-5 * is.max_element(), "{name}: {read} {is}");
        }
    }
}

#[test]
fn a_constant_stays_itself_to_the_bit() {
    let constant = Vec3::new(0.1, 2.7, 311.3);
    for (name, stage) in stages() {
        let mut lightmap = stage.lightmap(stage.measured(|_, _| constant), |_| true);
        lightmap.finish(&stage.scene, &stage.coverage);
        assert!(lightmap.layers[0].values.iter().all(|value| *value == constant), "{name}");
        for at in stage.points() {
            assert!((lightmap.at(0, at).0 - constant).abs().cmple(constant * 1e-6).all(), "{name}");
        }
    }
}

#[test]
fn all_layers_are_finished_and_still_add_up() {
    let stage = Stage::new(moved(of(pair())), &settings(256));
    let parts = [stage.measured(|_, at| linear(at)), stage.measured(|tri, _| Vec3::splat(tri.0 as f32))];
    let sum = parts[0].iter().zip(&parts[1]).map(|(&a, &b)| a + b).collect();
    let mut lightmap = stage.lightmap(sum, |lumel| lumel % 5 != 0);
    for (name, values) in ["direct", "bounce 1"].into_iter().zip(parts) {
        lightmap.layers.push(lumel_lightmap::LightmapLayer { name: name.into(), values });
    }
    lightmap.finish(&stage.scene, &stage.coverage);
    let [all, direct, bounce] = [0, 1, 2].map(|layer: usize| &lightmap.layers[layer].values);
    for ((&all, &direct), &bounce) in all.iter().zip(direct).zip(bounce) {
        assert!((all - direct - bounce).abs().max_element() < 1e-5, "{all} {direct} {bounce}");
    }
}

#[test]
fn results_have_the_same_bits_on_any_number_of_threads() {
    for (name, stage) in stages() {
        let measured = stage.measured(|tri, at| linear(at) + Vec3::splat((tri.0 % 3) as f32));
        let finished = |threads: usize| {
            let mut lightmap = stage.lightmap(measured.clone(), |lumel| lumel % 7 > 1);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| lightmap.finish(&stage.scene, &stage.coverage));
            lightmap.layers
        };
        assert!(finished(1) == finished(3), "{name}");
    }
}

#[test]
fn filters_read_what_they_say() {
    let stage = Stage::new(moved(of(pair())), &UnwrapSettings { gutter: 3, ..settings(256) });
    let mut lightmap = stage.lightmap(stage.measured(|_, at| linear(at)), |_| true);
    lightmap.finish(&stage.scene, &stage.coverage);
    let (atlas, values) = (&*stage.atlas, &*lightmap.layers[0].values);
    let read = |filter, at| LumelLighting { atlas, values, filter }.at(at).0;
    let mut inside = 0;
    for at in stage.points() {
        let is = linear(stage.scene.position(at).as_dvec3());
        let near = |value: Vec3, lumels: f32| (value - is).abs().max_element() < lumels * 2.0 * 0.4 / 12.0;
        assert!(
            near(read(Filter::Nearest, at), 1.0) && values.contains(&read(Filter::Nearest, at)),
            "{at:?}"
        );
        assert!(near(read(Filter::Bicubic, at), 1.0), "{at:?}");
        assert_eq!(read(Filter::Bilinear, at), lightmap.at(0, at).0);
        // Lumels beyond the chart are not linear.
        if at.bary.weights().iter().all(|weight| *weight > 0.17) {
            assert!((read(Filter::Bicubic, at) - is).abs().max_element() < 1e-5 * is.max_element(), "{at:?}");
            inside += 1;
        }
    }
    assert!(inside > 0);
}

#[test]
fn light_by_direction_is_read_as_irradiance_is() {
    let stage = Stage::new(moved(of(pair())), &settings(256));
    let mut lightmap = stage.lightmap(stage.measured(|_, at| linear(at)), |_| true);
    let values = lightmap.layers[0].values.clone();
    let harmonic = |k: usize| LightmapLayer {
        name: LightmapLayer::of_harmonic(k),
        values: values.iter().map(|value| *value * (1.0 - 0.5 * k as f32)).collect(),
    };
    let at = stage.points().nth(5).unwrap();
    assert_eq!(lightmap.by_direction(0).incident(at), None);
    // Their names count, not their order.
    lightmap.layers.extend([2, 0, 3, 1].map(harmonic));
    let (lighting, irradiance) = (lightmap.by_direction(0), lightmap.at(0, at));
    let light = lighting.incident(at).unwrap();
    assert_eq!((lighting.irradiance(at, Vec3::Y), light.kind()), (irradiance, Directional::Sh1));
    for (k, c) in light.coefficients()[..4].iter().enumerate() {
        assert!((*c - irradiance.0 * (1.0 - 0.5 * k as f32)).length() < 1e-4, "{k}: {c}");
    }
    assert_eq!(lightmap.by_direction(1).incident(at), None, "only all light is known by direction");
}
