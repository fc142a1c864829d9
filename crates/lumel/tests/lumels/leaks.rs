//! What surfaces hide stays hidden.

use crate::{Placed, irradiance, measured, placements, settings};
use glam::Vec3;
use lumel::{Lightmap, Lumels, SceneBuilder, SolvedLight};
use lumel_scene::{DirectionalLight, Light, PointLight, Radiance, Sky};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::random_surface_points;
use lumel_testkit::scene::{grey, scene};
use std::f32::consts::PI;

#[test]
fn no_light_from_outside_reaches_the_lumels_of_a_closed_box() {
    for placed in placements(&scene(
        cuboid(Vec3::splat(-1.0), Vec3::splat(1.0), 1, Facing::Inward, [0; 6]),
        vec![grey(0.5, 0.0)],
        vec![Light::Point(PointLight {
            position: Vec3::new(0.0, 3.0, 0.0),
            intensity: Vec3::splat(100.0),
            range: f32::INFINITY,
        })],
    )) {
        let place = placed.place;
        let lit = SceneBuilder { sky: Sky::Uniform(Radiance::splat(5.0)), ..placed.builder };
        let lit = Placed { builder: lit, ..placed };
        let (_, light) = measured(&lit, 0.3, 14.0, settings());
        assert!((0..light.len()).all(|lumel| light.is_valid(lumel)), "{place}");
        let brightest = irradiance(&light).map(|e| e.max_element()).fold(0.0, f32::max);
        assert_eq!(brightest, 0.0, "{place}");
    }
}

#[test]
fn what_lies_under_a_block_is_no_light_of_the_floor() {
    let floor =
        quad([[0.0, 0.0], [0.0, 2.0], [2.0, 2.0], [2.0, 0.0]].map(|[x, z]| Vec3::new(x, 0.0, z)), [1; 2], 0);
    let mut meshes = vec![floor];
    meshes.extend(cuboid(Vec3::new(0.5, -0.2, 0.5), Vec3::new(1.5, 0.6, 1.5), 1, Facing::Outward, [0; 6]));
    let builder = SceneBuilder {
        sky: Sky::Uniform(Radiance::splat(1.0)),
        ..scene(meshes, vec![grey(0.5, 0.0)], vec![])
    };
    let (lumels, light) = measured(&Placed::as_given(builder), 0.1, 16.0, settings());
    let mut n_hidden = 0;
    for (place, e) in irradiance(&light).enumerate() {
        let valid = light.is_valid(place);
        let share = lumels.coverage.shares(place)[0];
        if lumels.scene.object_id(share.tri).index() != 0 {
            continue;
        }
        // Next to the block, light is still a good part of that of the open sky.
        n_hidden += usize::from(!valid);
        assert!(!valid || e.x > 0.3 * PI, "{place}: {e}");
    }
    // A square of 16 x 16 lumels, but for those at its rim.
    assert!((14 * 14..=18 * 18).contains(&n_hidden), "{n_hidden}");
}

#[test]
fn no_light_passes_walls_and_a_floor_far_thinner_than_a_lumel() {
    const THICKNESS: f32 = 0.005;
    let (min, max) = (Vec3::ZERO, Vec3::new(3.0, 2.0, 3.0));
    let mut meshes = cuboid(min, max, 1, Facing::Inward, [0; 6]);
    meshes.extend(cuboid(min - THICKNESS, max + THICKNESS, 1, Facing::Outward, [0; 6]));
    let sun = DirectionalLight { direction: Vec3::new(-0.48, -0.8, -0.36), irradiance: Vec3::splat(50.0) };
    let builder = SceneBuilder {
        sky: Sky::Uniform(Radiance::splat(5.0)),
        ..scene(meshes, vec![grey(0.5, 0.0)], vec![Light::Directional(sun)])
    };
    for placed in placements(&builder) {
        let (Lumels { scene, atlas, coverage }, light) = measured(&placed, 0.3, 7.0, settings());
        let map = Lightmap::finished(&scene, &atlas, &coverage, &light, Some(&SolvedLight::default()), None);
        let half = f64::from(0.5 * THICKNESS);
        for at in random_surface_points(&scene, 4000, 3) {
            let (point, e) = (placed.home(&scene, scene.position(at)), map.at(0, at).0);
            if point.cmpge(min.as_dvec3() - half).all() && point.cmple(max.as_dvec3() + half).all() {
                assert_eq!(e, Vec3::ZERO, "{}, {point}", placed.place);
            } else {
                // The sky alone is three times as bright as this.
                assert!(e.x > 5.0, "{}, {point}: {e}", placed.place);
            }
        }
    }
}
