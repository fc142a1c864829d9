//! Rooms and balls whose light is known.

use crate::{built, irradiance, measured, placements, room, settings, solved, tessellated};
use glam::Vec3;
use lumel::{
    AmbientOcclusion, BounceLimit, Control, OpenOptions, PointReceivers, Projection, SceneBuilder, Settings,
    Tail, measure_points,
};
use lumel_scene::{Radiance, Sky};
use lumel_testkit::mesh::{Facing, sphere};
use lumel_testkit::scene::{grey, scene};
use std::f32::consts::PI;

#[test]
fn in_closed_rooms_every_lumel_has_the_known_light() {
    for (name, per_metre) in [("furnace", 20.0), ("sphere", 12.0)] {
        let builder = lumel::open(name, &OpenOptions::default()).unwrap().builder;
        for placed in placements(&builder) {
            let place = placed.place;
            let (_, light) =
                measured(&placed, 10.0, per_metre, Settings { tail: Tail::Geometric, ..settings() });
            assert!((0..light.len()).all(|lumel| light.is_valid(lumel)), "{name}, {place}");
            let off = irradiance(&light).map(|e| (e / 2.0 - 1.0).abs().max_element()).fold(0.0, f32::max);
            // The sphere is a polyhedron that is lit unevenly: rays have noise there.
            let most = if name == "furnace" { 0.002 } else { 0.2 };
            assert!(off < most, "{name}, {place}: {off}");
            let mean = irradiance(&light).map(|e| e.x).sum::<f32>() / light.len() as f32;
            assert!((mean / 2.0 - 1.0).abs() < 0.006, "{name}, {place}: {mean}");
        }
    }
}

#[test]
fn lumels_of_a_coarse_room_have_the_light_that_is_measured_at_their_middles() {
    // The others change no more than the first do, and take as long.
    for placed in placements(&room()).into_iter().take(4) {
        let place = placed.place;
        let settings = Settings { direct_samples: 32, indirect_samples: 128, ..settings() };
        let (lumels, light) = measured(&placed, 0.12, 12.0, settings.clone());
        let (baker, state) = solved(&tessellated(&placed.builder, 0.12 * placed.scale), settings);
        let area = |place: usize| lumels.coverage.shares(place).iter().map(|share| share.area).sum::<f32>();
        let whole = |&place: &usize| light.is_valid(place) && area(place) > 0.999;
        let chosen: Vec<usize> = (0..lumels.coverage.len()).filter(whole).step_by(29).collect();
        let middle = |&place: &usize| {
            let (_, [x, y]) = lumels.atlas.column_and_row(lumels.coverage.lumels()[place] as usize);
            let tri = lumels.coverage.shares(place)[0].tri;
            let piece = lumel_uv::Piece::new(&lumels.atlas, tri, [x, y]).unwrap();
            let (at, _) = piece.at([f64::from(x) + 0.5, f64::from(y) + 0.5].into());
            (at, lumels.scene.geometric_normal(tri))
        };
        let points = PointReceivers::on_surfaces(&lumels.scene, chosen.iter().map(middle)).unwrap();
        let expected = measure_points(&baker, &state, &points, &Control::default()).unwrap();
        let found: Vec<f32> = chosen.iter().map(|&place| light.irradiance(place).x).collect();
        let expected: Vec<f32> = expected.irradiance.iter().map(|e| e.x).collect();
        assert!(found.len() > 150);
        let sum = |values: &[f32]| values.iter().sum::<f32>();
        assert!(
            (sum(&found) / sum(&expected) - 1.0).abs() < 0.01,
            "{place}: {} {}",
            sum(&found),
            sum(&expected)
        );
        // Both have a noise of 2 %, and at the edges of shadows the mean over a lumel is not the light in its middle.
        let mut errors: Vec<f32> = found.iter().zip(&expected).map(|(f, e)| (f / e - 1.0).abs()).collect();
        errors.sort_by(f32::total_cmp);
        let [middle, most] = [errors.len() / 2, errors.len() * 9 / 10].map(|i| errors[i]);
        assert!(middle < 0.02 && most < 0.06, "{place}: {middle} {most}");
    }
}

#[test]
fn under_an_even_sky_coarse_balls_are_lit_as_smooth_ones_and_floors_without_end() {
    let ball = sphere(Vec3::ZERO, 1.0, 1, Facing::Outward, 0);
    let builder = SceneBuilder {
        sky: Sky::Uniform(Radiance::splat(1.0)),
        ..scene(vec![ball], vec![grey(0.5, 0.0)], vec![])
    };
    for placed in placements(&builder) {
        let place = placed.place;
        let direct = Settings { bounces: BounceLimit::Count(0), ..settings() };
        let (_, light) = measured(&placed, 0.5, 8.0, direct);
        for (lumel, e) in irradiance(&light).enumerate() {
            assert!((e.x / PI - 1.0).abs() < 0.02, "{place}: {lumel}: {e}");
        }
    }
}

#[test]
fn within_a_ball_the_surroundings_are_as_open_as_they_should_be() {
    // A ray at an angle of cosine c ends 2 c away: over the hemisphere, c is 2/3 on average, and c² 1/2.
    let ball = sphere(Vec3::ZERO, 1.0, 3, Facing::Inward, 0);
    let builder = scene(vec![ball], vec![grey(0.5, 0.0)], vec![]);
    for placed in placements(&builder) {
        let place = placed.place;
        let (scene, lumels) = (built(placed.builder.clone()), placed.lumels(6.0));
        for projection in [Projection::Point, Projection::LeastSquares] {
            let settings = Settings { bounces: BounceLimit::Count(0), projection, ..settings() };
            let (baker, state) = solved(&scene, settings);
            for (distance, falloff, expected) in
                [(2.0, 1.0, 2.0 / 3.0), (2.0, 2.0, 5.0 / 6.0), (0.01, 0.0, 1.0), (f32::INFINITY, 1.0, 0.0)]
            {
                let occlusion = AmbientOcclusion { distance: distance * placed.scale, falloff };
                let control = Control::default();
                let at_vertices = baker.openness_at_vertices(occlusion, &state, &control).unwrap();
                let at_lumels = baker.openness_at_lumels(occlusion, &lumels, &control).unwrap();
                let at_lumels = at_lumels.sources[0].iter().map(|share| share.x).collect();
                for shares in [at_vertices, at_lumels] {
                    let mean = shares.iter().sum::<f32>() / shares.len() as f32;
                    // The ball is a polyhedron, a few parts in a thousand smaller.
                    assert!((mean - expected).abs() < 0.01, "{place}, {projection:?}, {occlusion:?}: {mean}");
                    let off = shares.iter().map(|share| (share - expected).abs()).fold(0.0, f32::max);
                    assert!(off < 0.1, "{place}, {projection:?}, {occlusion:?}: {off}");
                }
            }
        }
    }
}
