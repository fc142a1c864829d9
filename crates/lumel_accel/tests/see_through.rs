//! Rays through surfaces that let light through.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use glam::{Vec2, Vec3};
use lumel_accel::{Bundle, Bvh, Hit, InstructionSet, Layer, Ray, RayTracer, SeeThrough, tracer_of};
use lumel_sample::{Dim, Sampler, StreamKey};
use lumel_scene::{
    AlphaMode, Encoding, Face, Material, MaterialId, ObjectMesh, Scene, SceneBuilder, Smoothing, Texture,
    TextureId, TextureRef, Transparency, TriId,
};

/// A square of two triangles that share the diagonal through its middle, facing +y.
fn card(center: Vec3, half: f32, material: u32) -> ObjectMesh {
    let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
    let face = |vertices| Face { vertices, material: MaterialId(material), smoothing: Smoothing::default() };
    ObjectMesh {
        name: "card".into(),
        positions: corners.map(|[x, z]| center + Vec3::new(x, 0.0, z) * half).to_vec(),
        uvs: corners.map(|[x, z]| Vec2::new(x, z) * 0.5 + 0.5).to_vec(),
        faces: vec![face([0, 1, 2]), face([0, 2, 3])],
        ..ObjectMesh::default()
    }
}

fn material(transparency: Transparency) -> Material {
    Material { transparency, ..Material::default() }
}

fn scene(objects: Vec<ObjectMesh>, materials: Vec<Material>) -> Scene {
    // The left half is there.
    let rgba = vec![[255, 255, 255, 255], [255, 255, 255, 0]];
    let textures = vec![Texture::from_bytes("half", 2, 1, rgba, Encoding::Srgb).unwrap()];
    SceneBuilder { objects, materials, textures, ..SceneBuilder::new("cards") }.build().unwrap().0
}

/// Something of everything: opaque, half there, masked by a texture, tinted glass; some cards coincide.
fn stack() -> Scene {
    let mask = Transparency {
        mode: AlphaMode::Mask { cutoff: 0.5 },
        texture: Some(TextureRef::plain(TextureId(0))),
        ..Transparency::default()
    };
    let glass = Transparency { transmission: Vec3::new(0.9, 0.5, 0.1), ..Transparency::default() };
    let kinds = [Transparency::default(), Transparency::blend(0.5), mask, glass];
    let mut objects = Vec::new();
    for level in 0..6_u8 {
        for column in 0..6_u8 {
            let center = Vec3::new(f32::from(column) - 2.5, f32::from(level), 0.3 * f32::from(level));
            objects.push(card(center, 0.7, u32::from((level + column) % 4)));
        }
    }
    objects.extend([card(Vec3::Y * 6.5, 0.5, 1), card(Vec3::Y * 6.5, 0.5, 1), card(Vec3::Y * 6.5, 0.5, 0)]);
    scene(objects, kinds.map(material).to_vec())
}

fn random(seed: u64, n: u32) -> Vec<Vec3> {
    let number = |i, dim| Sampler::Random.sample_2d(StreamKey::new(seed), i, dim);
    (0..n)
        .map(|i| (number(i, Dim::Area), number(i, Dim::Pixel)))
        .map(|([x, y], [z, _])| Vec3::new(x, y, z))
        .collect()
}

fn rays() -> Vec<Ray> {
    let origins = random(1, 1000).into_iter().map(|p| (p * 2.0 - 1.0) * 3.0 + Vec3::Y * 4.0);
    let targets = random(2, 1000).into_iter().map(|p| (p * 2.0 - 1.0) * 3.0 + Vec3::Y * 3.0);
    origins.zip(targets).map(|(origin, target)| Ray::new(origin, target - origin)).collect()
}

#[test]
fn rays_end_in_one_place_however_they_are_traced_and_with_all_instructions() {
    let scene = stack();
    let reference = SeeThrough::build(&scene).with_instructions(InstructionSet::Portable).unwrap();
    let rays = rays();
    let segments: Vec<Ray> = rays.iter().map(|ray| Ray { t_max: 1.0, ..*ray }).collect();
    let hits: Vec<Option<Hit>> = rays.iter().map(|ray| reference.closest_hit(ray)).collect();
    let passed: Vec<Vec3> = segments.iter().map(|ray| reference.transmittance(ray)).collect();
    assert!(hits.iter().flatten().filter(|hit| scene.is_transparent(hit.at.tri)).count() > 100);
    assert!(passed.iter().filter(|p| p.x > 0.0 && p.x < 1.0).count() > 100);
    for set in InstructionSet::available() {
        let tracer = SeeThrough::build(&scene).with_instructions(set).unwrap();
        let (mut found, mut shares) = (vec![None; rays.len()], vec![Vec3::ZERO; rays.len()]);
        tracer.closest_hits_of(&rays, &mut found);
        tracer.transmittances_of(&segments, &mut shares);
        assert_eq!((&found, &shares), (&hits, &passed), "{set}");
        let mut blocked = vec![false; rays.len()];
        tracer.occlusions_of(&segments, &mut blocked);
        assert!(blocked.iter().zip(&passed).all(|(blocked, passed)| *blocked == (*passed == Vec3::ZERO)));
        // From one origin.
        let origin = rays[0].origin;
        let directions: Vec<Vec3> = rays.iter().map(|ray| ray.direction).collect();
        let bundle = Bundle { origin, directions: &directions, t_max: 1.5, skip: None };
        tracer.closest_hits(&bundle, &mut found);
        tracer.transmittances(&bundle, &mut shares);
        tracer.occlusions(&bundle, &mut blocked);
        for i in 0..directions.len() {
            assert_eq!(found[i], reference.closest_hit(&bundle.ray(i)), "{set}");
            assert_eq!(shares[i], reference.transmittance(&bundle.ray(i)), "{set}");
            assert_eq!(blocked[i], shares[i] == Vec3::ZERO, "{set}");
        }
    }
}

#[test]
fn segments_multiply_all_that_they_cross_and_layers_are_in_order() {
    let scene = stack();
    let tracer = tracer_of(&scene);
    let mut layers: Vec<Layer> = Vec::new();
    let mut n_layers = 0;
    for ray in rays().iter().map(|ray| Ray { t_max: 1.0, ..*ray }) {
        tracer.layers(&ray, &mut layers);
        n_layers += layers.len();
        assert!(layers.is_sorted_by_key(|layer| (layer.hit.t, layer.hit.at.tri)));
        // Each triangle by itself.
        let alone = |tri: TriId| Bvh::from_corners(vec![scene.triangle_positions(tri)]).closest_hit(&ray);
        let mut expected = Vec3::ONE;
        for tri in (0..scene.traced_count() as u32).map(TriId) {
            if let Some(hit) = alone(tri) {
                expected *= scene.transmittance(lumel_scene::SurfacePoint { tri, ..hit.at });
            }
        }
        let product: Vec3 = layers.iter().map(|layer| layer.transmittance).product();
        assert!((product - expected).abs().max_element() < 1e-6, "{product} {expected}");
        assert!((tracer.transmittance(&ray) - expected).abs().max_element() < 1e-6);
        let through = layers.split_last().map_or(&[][..], |(_, before)| before);
        assert!(
            through.iter().all(|layer| layer.transmittance != Vec3::ZERO),
            "nothing lies behind the last"
        );
    }
    assert!(n_layers > 500);
}

/// What passes a stack of half-transparent cards with a height each, straight down through a point.
fn passed_down(heights: &[f32], [x, z]: [f32; 2]) -> Vec3 {
    let cards = heights.iter().map(|&y| card(Vec3::Y * y, 1.0, 0)).collect();
    let scene = scene(cards, vec![material(Transparency::blend(0.5))]);
    let (above, below) = (Vec3::new(x, 3.0, z), Vec3::new(x, -3.0, z));
    let tracer = tracer_of(&scene);
    let passed = tracer.transmittance(&Ray::between(above, below));
    assert_eq!(tracer.transmittance(&Ray::between(below, above)), passed);
    passed
}

#[test]
fn a_card_counts_once_also_on_its_diagonal_and_when_it_is_given_twice() {
    for place in [[0.3, 0.1], [0.0, 0.0], [0.5, -0.5], [-0.25, 0.25]] {
        assert_eq!(passed_down(&[0.0], place), Vec3::splat(0.5), "{place:?}");
        assert_eq!(passed_down(&[0.0, 1.0], place), Vec3::splat(0.25), "{place:?}");
        assert_eq!(passed_down(&[0.0, 0.0], place), Vec3::splat(0.5), "{place:?}");
    }
    assert_eq!(passed_down(&[0.0], [1.5, 0.0]), Vec3::ONE);
}

#[test]
fn a_ray_through_a_vertex_of_a_fan_counts_one_of_its_triangles() {
    let mut fan = ObjectMesh { name: "fan".into(), ..ObjectMesh::default() };
    fan.positions.push(Vec3::ZERO);
    let around = [[1.0, 0.0], [0.6, -0.9], [-0.4, -1.0], [-1.0, 0.1], [-0.2, 0.8], [0.7, 0.9]];
    fan.positions.extend(around.map(|[x, z]| Vec3::new(x, 0.0, z)));
    let face = |i: u32| [0, 1 + i, 1 + (i + 1) % 6];
    let material_id = MaterialId(0);
    let face = |i| Face { vertices: face(i), material: material_id, smoothing: Smoothing::default() };
    fan.faces = (0..6).map(face).collect();
    let scene = scene(vec![fan], vec![material(Transparency::blend(0.5))]);
    let tracer = tracer_of(&scene);
    for from in [Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 2.0, -0.5), Vec3::new(-0.25, -1.0, 0.125)] {
        let ray = Ray { t_max: 2.0, ..Ray::new(from, -from) };
        assert_eq!(tracer.transmittance(&ray), Vec3::splat(0.5), "{from}");
    }
}

#[test]
fn a_mask_has_holes_and_what_is_there_is_opaque() {
    let mask = Transparency {
        mode: AlphaMode::Mask { cutoff: 0.5 },
        texture: Some(TextureRef::plain(TextureId(0))),
        ..Transparency::default()
    };
    let scene = scene(vec![card(Vec3::ZERO, 1.0, 0)], vec![material(mask)]);
    let tracer = tracer_of(&scene);
    for (x, there) in [(-0.4, true), (-0.1, true), (0.1, false), (0.4, false)] {
        let ray = Ray::new(Vec3::new(x, 1.0, 0.2), -Vec3::Y);
        assert_eq!((tracer.closest_hit(&ray).is_some(), tracer.occluded(&ray)), (there, there), "{x}");
    }
}

#[test]
fn rays_end_as_often_as_surfaces_are_opaque() {
    let objects = [0.0, 1.0].map(|y| card(Vec3::Y * y, 1.0, 0)).to_vec();
    let scene = scene(objects, vec![material(Transparency::blend(0.25))]);
    let tracer = tracer_of(&scene);
    let n = 10_000;
    let ray = |p: Vec3| Ray::new(Vec3::new(p.x - 0.5, 2.0, p.z - 0.5), -Vec3::Y);
    let ends: Vec<Option<Hit>> = random(3, n).into_iter().map(|p| tracer.closest_hit(&ray(p))).collect();
    let count = |t: Option<f32>| ends.iter().filter(|hit| hit.map(|hit| hit.t) == t).count() as f32;
    for (t, expected) in [(Some(1.0), 0.25), (Some(2.0), 0.75 * 0.25), (None, 0.75 * 0.75)] {
        let share = count(t) / n as f32;
        let sigma = (expected * (1.0 - expected) / n as f32).sqrt();
        assert!((share - expected).abs() < 4.0 * sigma, "{t:?}: {share} {expected}");
    }
}

#[test]
fn without_transparent_triangles_the_tracer_is_the_tree() {
    let opaque = Transparency::blend(1.0);
    let scene = scene(vec![card(Vec3::ZERO, 1.0, 0)], vec![material(opaque)]);
    assert!(!scene.has_transparent() && !tracer_of(&scene).is_see_through());
}
