//! Light on normal maps.

use crate::agreement::assert_same;
use crate::common::{Subject, irradiance, radiance, renderer, share_beyond};
use crate::scenes;
use glam::Vec3;
use lumel_basis::{
    Coefficients, Directional, IncidentRadiance, Shading, VertexLighting, spherical_harmonics,
};
use lumel_render_cpu::{NormalMaps, Picture, Relief, Ripple, Rippled, Scale, ToneMapper};
use lumel_render_gpu::{Frame, Lit, Look, Samples};
use lumel_scene::{MaterialId, Scene};

const SIZE: [u32; 2] = [173, 120];

/// Irradiance and coefficients of light from two directions at every vertex, of all colours.
fn directions(scene: &Scene, kind: Directional) -> (Vec<Vec3>, Coefficients) {
    let (mut irradiance, mut coefficients) = (Vec::new(), Vec::new());
    let size = scene.bounds().diagonal();
    for (p, n) in scene.positions().iter().zip(scene.normals()) {
        let wave = |shift: f32| Vec3::new(7.0 * p.y, 9.0 * p.z, 8.0 * p.x).map(|x| (x / size + shift).sin());
        let sources = [(wave(0.0), Vec3::new(1.2, 0.8, 0.3)), (wave(2.0), Vec3::new(0.2, 0.5, 0.9))];
        let sources = sources.map(|(lean, color)| ((*n + 0.6 * lean).normalize(), color));
        irradiance.push(sources.iter().map(|(d, color)| color * d.dot(*n).max(0.0)).sum());
        let harmonics = sources.map(|(d, color)| spherical_harmonics(d).map(|y| color * y));
        coefficients.extend((0..kind.harmonics()).map(|i| harmonics[0][i] + harmonics[1][i]));
    }
    (irradiance, Coefficients::new(kind, coefficients).unwrap())
}

/// What the device and the CPU make of it.
fn compared(subject: &Subject, kind: Directional, ripple: Option<Rippled<'_>>, cases: &[(Relief, Look)]) {
    let Some(renderer) = renderer() else { return };
    let (irradiance, coefficients) = directions(&subject.scene, kind);
    let lighting = VertexLighting::new(&subject.scene, &irradiance).unwrap();
    let lighting = lighting.with_incident(Some(&coefficients)).unwrap();
    let uploaded = subject.on(renderer);
    renderer.set_light(&uploaded.light, &subject.scene, &lighting).unwrap();
    for &(relief, look) in cases {
        let device = uploaded.draw(SIZE, Samples::One, &Frame { relief, ripple, ..uploaded.frame(look) });
        let cpu = subject.traced_with(&lighting, (relief, ripple), SIZE, look);
        assert_same(&device, &cpu, &format!("{} {kind:?} {relief:?} {look:?}", subject.scene.name()));
    }
}

fn relief(maps: NormalMaps, shading: Shading) -> Relief {
    Relief { maps, shading }
}

#[test]
fn light_on_normal_maps_looks_as_on_the_cpu() {
    let colors = Look::FalseColor { range: [0.0, 6.0], scale: Scale::Linear };
    let up = |shading| (relief(NormalMaps::Up, shading), radiance(1.0, ToneMapper::Agx));
    let all = [
        up(Shading::Linear),
        up(Shading::NonLinear),
        up(Shading::Zh3),
        up(Shading::Quadratic),
        (relief(NormalMaps::Down, Shading::NonLinear), irradiance(0.0)),
        (relief(NormalMaps::Up, Shading::Zh3), colors),
        (relief(NormalMaps::Down, Shading::Zh3), Look::Normals),
        (relief(NormalMaps::Off, Shading::Zh3), Look::Normals),
        (relief(NormalMaps::Off, Shading::Zh3), irradiance(0.0)),
    ];
    for subject in [scenes::leather(), scenes::everything()] {
        compared(&subject, Directional::Sh2, None, &all);
        compared(&subject, Directional::Sh1, None, &all[1..5]);
    }
}

#[test]
fn ripples_look_as_on_the_cpu_and_are_on_some_materials_only() {
    let subject = scenes::everything();
    let ripple = Ripple { length: 0.05, slope: 0.5, phase: 3.0 };
    // Of the floor, which has no normal map, and of the ball, which has one.
    let materials = [MaterialId(2), MaterialId(3)];
    let up = |look| (relief(NormalMaps::Up, Shading::default()), look);
    let cases = [up(radiance(0.5, ToneMapper::Agx)), up(irradiance(0.0)), up(Look::Normals)];
    compared(&subject, Directional::Sh1, Some(Rippled { ripple, materials: &materials }), &cases);
    let Some(renderer) = renderer() else { return };
    let uploaded = subject.on(renderer);
    let show = |materials| {
        let frame = Frame { ripple: Some(Rippled { ripple, materials }), ..uploaded.frame(Look::Normals) };
        uploaded.draw(SIZE, Samples::One, &frame)
    };
    let [none, floor, both] = [&[][..], &materials[..1], &materials[..]].map(show);
    assert_eq!(none, uploaded.show(SIZE, Samples::One, Look::Normals));
    assert!(share_beyond(&none, &floor, 8) > 0.1 && share_beyond(&floor, &both, 8) > 0.01);
}

#[test]
fn normal_maps_show_only_where_light_is_known_by_direction() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::leather();
    let (values, coefficients) = directions(&subject.scene, Directional::Sh1);
    let scalar = VertexLighting::new(&subject.scene, &values).unwrap();
    let directional = scalar.with_incident(Some(&coefficients)).unwrap();
    let uploaded = subject.on(renderer);
    let show = |maps, light: &VertexLighting<'_>| {
        renderer.set_light(&uploaded.light, &subject.scene, light).unwrap();
        let frame = Frame { relief: relief(maps, Shading::default()), ..uploaded.frame(irradiance(0.0)) };
        uploaded.draw(SIZE, Samples::One, &frame)
    };
    let [flat, bumpy] = [&scalar, &directional].map(|light| show(NormalMaps::Up, light));
    assert!(share_beyond(&flat, &bumpy, 8) > 0.3);
    assert_eq!(show(NormalMaps::Off, &directional), flat);
    assert_eq!(show(NormalMaps::Up, &scalar), flat, "what was known before is forgotten");
}

#[test]
fn vectors_look_as_the_dominant_direction_does_on_the_cpu() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let (values, coefficients) = directions(&subject.scene, Directional::Sh1);
    let lighting = VertexLighting::new(&subject.scene, &values).unwrap();
    let lighting = lighting.with_incident(Some(&coefficients)).unwrap();
    let uploaded = subject.on(renderer);
    let places = 0..coefficients.len();
    let vectors: Vec<Vec3> =
        places.map(|v| IncidentRadiance::new(coefficients.of(v)).unwrap().dominant()).collect();
    let shown = VertexLighting::new(&subject.scene, &vectors).unwrap();
    renderer.set_light(&uploaded.light, &subject.scene, &shown).unwrap();
    let device = uploaded.show(SIZE, Samples::One, Look::Vectors);
    // Between vertices, vectors are interpolated here and coefficients there.
    let cpu = subject.traced_under(&lighting, SIZE, Look::Vectors);
    let share = share_beyond(&device, &cpu, 12);
    assert!(
        share < 0.02 && share_beyond(&device, &uploaded.show(SIZE, Samples::One, Look::Normals), 30) > 0.2,
        "{share}"
    );
}

#[test]
fn right_of_a_divider_surfaces_are_smooth() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::leather();
    let (values, coefficients) = directions(&subject.scene, Directional::Sh1);
    let lighting = VertexLighting::new(&subject.scene, &values).unwrap();
    let lighting = lighting.with_incident(Some(&coefficients)).unwrap();
    let uploaded = subject.on(renderer);
    renderer.set_light(&uploaded.light, &subject.scene, &lighting).unwrap();
    for look in [irradiance(0.0), Look::Normals] {
        let show = |light, maps| {
            let relief = relief(maps, Shading::default());
            uploaded.draw(SIZE, Samples::One, &Frame { light, relief, ..uploaded.frame(look) })
        };
        let light = (&uploaded.light).into();
        let [tilted, smooth] = [NormalMaps::Up, NormalMaps::Off].map(|maps| show(Lit::One(light), maps));
        let both = show(Lit::Smooth { light, at: 0.5 }, NormalMaps::Up);
        let middle = (0.5 * SIZE[0] as f32).round() as u32;
        let all = |columns: std::ops::Range<u32>, other: &Picture| {
            columns
                .flat_map(|x| (0..SIZE[1]).map(move |y| (x, y)))
                .all(|(x, y)| both.pixel(x, y) == other.pixel(x, y))
        };
        assert!(all(0..middle, &tilted) && all(middle..SIZE[0], &smooth) && tilted != smooth);
    }
}
