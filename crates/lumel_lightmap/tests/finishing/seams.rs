use crate::{Stage, moved, noise, of, pair, settings, stages};
use glam::{Vec3, Vec3Swizzles as _};
use lumel_lightmap::{Dilation, Seams};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::scene;
use lumel_uv::UnwrapSettings;

/// The jumps before and after seams are closed, and the mean change of a lumel.
fn closed(stage: &Stage, values: Vec<Vec3>) -> [f64; 3] {
    let mut lightmap = stage.lightmap(values.clone(), |_| true);
    let dilation = Dilation::new(&stage.atlas, &stage.coverage, &lightmap.valid);
    let seams = Seams::new(&stage.scene, &stage.atlas, &dilation);
    let before = seams.jump(&values);
    lightmap.finish(&stage.scene, &stage.coverage);
    let after = &lightmap.layers[0].values;
    let changes =
        stage.coverage.lumels().iter().map(|&lumel| {
            f64::from((values[lumel as usize] - after[lumel as usize]).abs().element_sum()) / 3.0
        });
    [before, seams.jump(after), changes.sum::<f64>() / stage.coverage.len() as f64]
}

#[test]
fn jumps_fall_to_a_tenth_or_less() {
    let finer = UnwrapSettings { factors: vec![1.0, 2.3], ..settings(256) };
    let mut all = stages();
    all.push(("two densities", Stage::new(moved(of(pair())), &finer)));
    for (name, stage) in all.into_iter().filter(|(name, _)| !name.starts_with("room")) {
        let light =
            |tri: TriId, _| Vec3::ONE + Vec3::splat(if stage.atlas.chart(tri) % 3 == 0 { 1.0 } else { 0.0 });
        let [before, after, change] = closed(&stage, stage.measured(light));
        println!("{name}: jump {before:.4} to {after:.4}, {:.0} times, change {change:.4}", before / after);
        assert!(before > 0.3 && after < 0.1 * before, "{name}: {before} to {after}");
        assert!(change < 0.15, "{name}: only lumels at the seams change, by {change}");
    }
}

#[test]
fn jumps_of_noise_fall_too() {
    for (name, stage) in stages().into_iter().filter(|(name, _)| !name.starts_with("room")) {
        let mut values = stage.measured(|_, _| Vec3::ONE);
        values.iter_mut().enumerate().for_each(|(i, value)| *value *= 0.5 + noise(i));
        let [before, after, _] = closed(&stage, values);
        println!("{name}: jump {before:.4} to {after:.4}, {:.1} times", before / after);
        assert!(after < 0.1 * before, "{name}: {before} to {after}");
    }
}

#[test]
fn what_reads_both_sides_of_an_edge_gets_nearly_the_same() {
    let stage = Stage::new(moved(of(pair())), &settings(64));
    assert_eq!(stage.atlas.charts().len(), 2);
    let mut lightmap =
        stage.lightmap(stage.measured(|tri, _| Vec3::splat(stage.atlas.chart(tri) as f32)), |_| true);
    lightmap.finish(&stage.scene, &stage.coverage);
    // All vertices that two objects have in one place.
    let mut n_pairs = 0;
    let corner = |tri: TriId, k: usize| SurfacePoint { tri, bary: Barycentrics::CORNERS[k] };
    let corners: Vec<_> = (0..4).flat_map(|tri| (0..3).map(move |k| corner(TriId(tri), k))).collect();
    for (i, &a) in corners.iter().enumerate() {
        for &b in corners[i..].iter().filter(|b| stage.atlas.chart(b.tri) != stage.atlas.chart(a.tri)) {
            if stage.scene.position(a) == stage.scene.position(b) {
                let [a, b] = [a, b].map(|at| lightmap.at(0, at).0.x);
                // Both are ends of the seam, where it weighs least.
                assert!((a - b).abs() < 0.15 && (a - 0.5).abs() < 0.1, "{a} {b}");
                n_pairs += 1;
            }
        }
    }
    assert!(n_pairs >= 2);
}

fn seams_of(stage: &Stage) -> Seams {
    let lightmap = stage.lightmap(vec![Vec3::ZERO; stage.atlas.lumel_count()], |_| true);
    let dilation = Dilation::new(&stage.atlas, &stage.coverage, &lightmap.valid);
    Seams::new(&stage.scene, &stage.atlas, &dilation)
}

#[test]
fn creases_stay_as_they_are() {
    for (name, stage) in stages() {
        assert_eq!(seams_of(&stage).is_empty(), name.starts_with("room"), "{name}");
    }
    // Hinges of 5° and of 12°.
    for (degrees, is_smooth) in [(5.0_f32, true), (12.0, false)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut objects = pair();
        objects[1].positions.iter_mut().for_each(|p| {
            *p = Vec3::new(1.0, 0.0, 0.0) + (p.x - 1.0) * Vec3::new(cos, 0.0, sin) + p.yyy() * Vec3::Y
        });
        let stage = Stage::new(of(objects), &settings(256));
        assert_eq!(!seams_of(&stage).is_empty(), is_smooth, "{degrees}");
    }
}

#[test]
fn surfaces_on_the_same_side_of_an_edge_are_no_neighbours() {
    let mut objects = pair();
    // The right one now lies over the left one, and is narrower.
    objects[1].positions.iter_mut().for_each(|p| p.x = 0.5 * (p.x - 1.0));
    assert!(seams_of(&Stage::new(of(objects), &settings(256))).is_empty());
}

#[test]
fn the_two_sides_of_a_sheet_never_mix() {
    let (_, stage) = stages().remove(4);
    let is_back = |scene: &Scene, tri: TriId| tri.index() >= scene.traced_count();
    let light = |tri: TriId, _| Vec3::splat(if is_back(&stage.scene, tri) { 5.0 } else { 1.0 });
    let mut lightmap = stage.lightmap(stage.measured(light), |_| true);
    lightmap.finish(&stage.scene, &stage.coverage);
    for at in stage.points() {
        assert!((lightmap.at(0, at).0 - light(at.tri, Default::default())).abs().max_element() < 1e-5);
    }
}

#[test]
fn lumels_inside_geometry_have_no_say_at_seams() {
    let stage = Stage::new(of(pair()), &settings(256));
    let is_hidden = |tri: TriId, y: f64| stage.atlas.chart(tri) == 0 && y < 0.4;
    let values = stage.measured(|tri, at| Vec3::splat(if is_hidden(tri, at.y) { -1e9 } else { 3.0 }));
    let mut lightmap = stage.lightmap(values.clone(), |lumel| values[lumel].x > 0.0);
    assert!(lightmap.valid.iter().zip(&values).any(|(valid, value)| !valid && value.x < 0.0));
    lightmap.finish(&stage.scene, &stage.coverage);
    assert!(lightmap.layers[0].values.iter().all(|value| *value == Vec3::splat(3.0)));
}

#[test]
fn no_light_becomes_negative() {
    let stage = Stage::new(of(pair()), &settings(256));
    let dark = |tri: TriId, at: glam::DVec3| Vec3::splat(if tri.0 < 2 { 0.0 } else { 100.0 * at.y as f32 });
    let mut lightmap = stage.lightmap(stage.measured(dark), |lumel| lumel % 3 > 0);
    lightmap.layers[0].values.iter_mut().for_each(|value| *value = value.max(Vec3::ZERO));
    lightmap.finish(&stage.scene, &stage.coverage);
    assert!(lightmap.layers[0].values.iter().all(|value| value.min_element() >= 0.0));
}

#[test]
fn many_triangles_around_one_edge_and_triangles_without_area_are_no_seams() {
    let mut fan = quad([Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y], [1, 1], 0);
    let face = fan.faces[0];
    fan.normals = vec![Vec3::Z; 4];
    for i in 0..40 {
        let n = fan.positions.len() as u32;
        let up = Vec3::new(i as f32, 1.0, 0.3);
        fan.positions.extend([Vec3::ZERO, Vec3::X, up]);
        fan.normals.extend([Vec3::Z; 3]);
        fan.uvs.extend([glam::Vec2::ZERO; 3]);
        let vertices = if i % 2 == 0 { [n, n + 1, n + 2] } else { [n + 1, n, n + 2] };
        fan.faces.push(lumel_scene::Face { vertices, ..face });
    }
    let stage =
        Stage::new(scene(vec![fan], vec![lumel_scene::Material::default()], Vec::new()), &settings(256));
    let mut lightmap = stage.lightmap(stage.measured(|_, _| Vec3::ONE), |_| true);
    lightmap.finish(&stage.scene, &stage.coverage);
    assert!(lightmap.layers[0].values.iter().all(|value| *value == Vec3::ONE));
}
