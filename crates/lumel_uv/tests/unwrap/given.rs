//! Layouts that files give.

use crate::{built, settings, unwrapped};
use glam::{DVec2, Vec2, Vec3};
use lumel_scene::{Material, ObjectMesh, Scene, SceneBuilder, TriId};
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::{grey, scene, two_sided};
use lumel_uv::{Coverage, Density, GivenUvs, Method, UnwrapSettings, Unwrapped, check};

/// Two squares of a metre, and the lower left corners, `v` down, of where they lie on the square: a quarter as wide.
fn panels(name: &str, y: f32, corners: [[f32; 2]; 2]) -> ObjectMesh {
    let mut mesh = ObjectMesh { name: name.into(), ..ObjectMesh::default() };
    for (x, corner) in [0.0, 2.0].into_iter().zip(corners) {
        let at = Vec3::new(x, y, 0.0);
        let part = quad([at, at + Vec3::X, at + Vec3::X + Vec3::Y, at + Vec3::Y], [1, 1], 0);
        let first = mesh.positions.len() as u32;
        mesh.lightmap_uvs.extend(part.positions.iter().map(|p| {
            let local = *p - at;
            Vec2::from(corner) + Vec2::new(local.x, -local.y) * 0.25
        }));
        mesh.positions.extend(part.positions);
        mesh.faces.extend(
            part.faces.into_iter().map(|face| lumel_scene::Face {
                vertices: face.vertices.map(|vertex| vertex + first),
                ..face
            }),
        );
    }
    mesh
}

/// Left and right, a quarter of the square between.
const APART: [[f32; 2]; 2] = [[0.0, 0.25], [0.5, 0.25]];

fn of(objects: Vec<ObjectMesh>, material: Material) -> Scene {
    built(scene(objects, vec![material], Vec::new()))
}

fn at(density: f32) -> UnwrapSettings {
    UnwrapSettings { density: Density::PerMetre(density), ..settings() }
}

/// Scale and offset by which the coordinates of an object become places on its page, if they do.
fn rectangle(scene: &Scene, out: &Unwrapped, tris: std::ops::Range<u32>) -> Option<(DVec2, DVec2)> {
    let corners = tris.flat_map(|tri| {
        let uvs = scene.triangle(TriId(tri)).map(|v| scene.lightmap_uvs()[v as usize].as_dvec2());
        uvs.into_iter().zip(out.atlas.corners(TriId(tri)).map(|c| c.as_dvec2()))
    });
    let corners: Vec<(DVec2, DVec2)> = corners.collect();
    let (first, last) = (corners[0], *corners.iter().max_by(|a, b| a.0.x.total_cmp(&b.0.x))?);
    let scale = DVec2::splat((last.1.x - first.1.x) / (last.0.x - first.0.x));
    let offset = first.1 - first.0 * scale;
    corners
        .iter()
        .all(|(uv, place)| (*uv * scale + offset).distance(*place) < 1e-3)
        .then_some((scale, offset))
}

#[test]
fn each_instance_is_a_rectangle_of_its_own_in_which_charts_stay_where_they_are() {
    // Higher than wide: our own charts would be turned.
    let stacked = [[0.0, 0.25], [0.0, 0.75]];
    let instances = ["a", "b", "c", "d", "e", "f"].into_iter().zip([0.0, 5.0, 10.0, 15.0, 20.0, 25.0]);
    let instances: Vec<ObjectMesh> = instances.map(|(name, y)| panels(name, y, stacked)).collect();
    let scene = of(instances, grey(0.5, 0.0));
    let out = unwrapped(&scene, &at(10.0));
    assert_eq!((check(&out.atlas, &scene), &*out.report.findings), (vec![], &[][..]));
    assert_eq!((out.report.kept_count(), out.report.is_shared, out.atlas.charts().len()), (6, false, 12));
    let places: Vec<DVec2> = (0..6)
        .map(|object| {
            let (scale, offset) = rectangle(&scene, &out, 4 * object..4 * object + 4).unwrap();
            assert!(scale.distance(DVec2::splat(40.0)) < 1e-3, "{scale}");
            offset
        })
        .collect();
    for (i, a) in places.iter().enumerate() {
        assert!(places[..i].iter().all(|b| a.distance(*b) > 9.0), "{places:?}");
    }
    assert!(out.report.objects.iter().all(|object| (object.density - 10.0).abs() < 1e-3));
    // Seen from the other side than our own charts: what each lumel covers is the same.
    let coverage = Coverage::new(&out.atlas);
    let shares = (0..coverage.len()).flat_map(|place| coverage.shares(place));
    let covered: f64 = shares.map(|share| f64::from(share.area)).sum();
    assert!((covered - 1200.0).abs() < 0.03, "{covered}");
}

#[test]
fn a_square_that_all_objects_share_is_the_page() {
    let below = [[0.0, 1.0], [0.5, 1.0]];
    let scene = of(vec![panels("a", 0.0, APART), panels("b", 5.0, below)], grey(0.5, 0.0));
    for settings in [at(50.0), settings()] {
        let out = unwrapped(&scene, &settings);
        assert_eq!((check(&out.atlas, &scene), &*out.report.findings), (vec![], &[][..]));
        assert!(out.report.is_shared && out.report.kept_count() == 2 && out.atlas.pages().len() == 1);
        assert!(out.atlas.lumel_count() <= 1 << 16);
        for tri in (0..scene.triangle_count() as u32).map(TriId) {
            let uvs = scene.triangle(tri).map(|v| scene.lightmap_uvs()[v as usize]);
            let places = out.atlas.texture_coordinates(tri);
            assert!(uvs.iter().zip(places).all(|(uv, place)| uv.distance(place) < 1e-6), "{uvs:?}");
        }
    }
    let finer = UnwrapSettings { factors: vec![1.0, 2.0], ..at(10.0) };
    let out = unwrapped(&scene, &finer);
    assert!(!out.report.is_shared && out.report.kept_count() == 2, "one object is to be finer");
    let new = unwrapped(&scene, &UnwrapSettings { given: GivenUvs::Ignore, ..settings() });
    assert_eq!(new.report.kept_count(), 0);
}

#[test]
fn our_own_layouts_are_kept_at_another_density() {
    let mut builder =
        scene(vec![panels("a", 0.0, APART), panels("b", 5.0, APART)], vec![grey(0.5, 0.0)], Vec::new());
    builder.objects.iter_mut().for_each(|object| object.lightmap_uvs.clear());
    let scene = built(builder.clone());
    let own = unwrapped(&scene, &at(10.0)).atlas;
    let mut tri = 0;
    for object in &mut builder.objects {
        object.lightmap_uvs = vec![Vec2::ZERO; object.positions.len()];
        for face in &object.faces {
            for (&vertex, place) in face.vertices.iter().zip(own.texture_coordinates(TriId(tri))) {
                object.lightmap_uvs[vertex as usize] = place;
            }
            tri += 1;
        }
    }
    let out = unwrapped(&built(builder), &at(37.0));
    assert!(out.report.is_shared, "{:?}", out.report);
}

#[test]
fn the_backs_of_a_layout_have_lumels_of_their_own() {
    let material = || two_sided(grey(0.5, 0.0));
    let below = [[0.0, 1.0], [0.5, 1.0]];
    for (objects, n_pages) in [
        (vec![panels("a", 0.0, APART), panels("b", 5.0, APART)], 1),
        (vec![panels("a", 0.0, APART), panels("b", 5.0, below)], 2),
    ] {
        let scene = of(objects, material());
        let out = unwrapped(&scene, &at(10.0));
        assert_eq!((check(&out.atlas, &scene), &*out.report.findings), (vec![], &[][..]));
        assert_eq!((out.report.kept_count(), out.atlas.pages().len()), (2, n_pages));
        assert_eq!(out.atlas.charts().len(), 8);
    }
}

/// Why the coordinates of an object are not kept.
fn refused(mesh: ObjectMesh, settings: &UnwrapSettings) -> String {
    let scene = of(vec![mesh], grey(0.5, 0.0));
    let out = unwrapped(&scene, settings);
    assert_eq!(check(&out.atlas, &scene), []);
    assert_eq!(out.report.objects[0].method, Method::Conformal);
    let [finding] = &*out.report.findings else { panic!("{:?}", out.report.findings) };
    let text = finding.to_string();
    let reason = text.strip_prefix("object \"a\": its lightmap coordinates are not kept: ");
    reason.map(str::to_owned).unwrap_or_else(|| panic!("{text}"))
}

#[test]
fn coordinates_that_cannot_be_used_are_replaced_and_named() {
    let changed = |change: &dyn Fn(&mut Vec<Vec2>)| {
        let mut mesh = panels("a", 0.0, APART);
        change(&mut mesh.lightmap_uvs);
        refused(mesh, &at(10.0))
    };
    assert_eq!(changed(&|uvs| uvs[1] = Vec2::NAN), "triangle 0 has none");
    assert_eq!(changed(&|uvs| uvs[0].x = -0.3), "triangle 0 reaches out of the square from 0 to 1");
    assert_eq!(changed(&|uvs| uvs[..4].fill(Vec2::ZERO)), "triangle 0 has no area there");
    let overlapping = changed(&|uvs| uvs[4..].iter_mut().for_each(|uv| uv.x -= 0.3));
    assert!(overlapping.ends_with("and others overlap, 50.0 % of its area"), "{overlapping}");
}

#[test]
fn charts_that_are_too_near_at_a_density_are_kept_at_a_higher_one() {
    // A 64th of the square apart: a sixteenth of a metre.
    let near = || panels("a", 0.0, [[0.0, 0.25], [0.25 + 1.0 / 64.0, 0.25]]);
    let why = refused(near(), &at(10.0));
    let expected = "its charts are less than 2 lumels apart at 10.000 lumels per metre; ask for more lumels or a smaller gutter";
    assert_eq!(why, expected);
    for settings in [at(32.0), UnwrapSettings { gutter: 1, ..at(16.0) }] {
        let scene = of(vec![near()], grey(0.5, 0.0));
        assert_eq!(unwrapped(&scene, &settings).report.kept_count(), 1);
    }
}

#[test]
fn slivers_that_overlap_are_told_of_and_do_no_harm() {
    let mut mesh = panels("a", 0.0, APART);
    let corner = mesh.positions[0] + Vec3::Z;
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([corner, corner + Vec3::X * 0.03, corner + Vec3::Y * 0.03]);
    mesh.lightmap_uvs.extend([Vec2::splat(0.1), Vec2::new(0.1075, 0.1), Vec2::new(0.1, 0.0925)]);
    mesh.faces.push(lumel_scene::Face { vertices: [first, first + 1, first + 2], ..mesh.faces[0] });
    let out = unwrapped(&of(vec![mesh], grey(0.5, 0.0)), &at(40.0));
    assert_eq!(out.report.kept_count(), 1);
    let [finding] = &*out.report.findings else { panic!("{:?}", out.report.findings) };
    assert!(finding.message.starts_with("its lightmap coordinates are kept, though "), "{finding}");
}

#[test]
fn objects_without_coordinates_are_unwrapped_beside_those_that_have_some() {
    let mut without = panels("without", 5.0, APART);
    without.lightmap_uvs.clear();
    let scene: SceneBuilder = scene(vec![panels("a", 0.0, APART), without], vec![grey(0.5, 0.0)], Vec::new());
    let out = unwrapped(&built(scene), &settings());
    let methods: Vec<Method> = out.report.objects.iter().map(|object| object.method).collect();
    assert_eq!((methods, out.report.findings), (vec![Method::Given, Method::Conformal], vec![]));
}
