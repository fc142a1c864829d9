//! What holds for the atrium as a whole.

use super::*;
use lumel_scene::{Face, Scene, TriId};
use std::collections::BTreeMap;

fn triangles(scene: &Scene) -> impl Iterator<Item = TriId> {
    (0..scene.traced_count() as u32).map(TriId)
}

fn meshes(level: u32) -> Vec<ObjectMesh> {
    objects(Plan { fine: 1 << level }).into_iter().filter(|o| o.name != "banners").collect()
}

fn faces(meshes: &[ObjectMesh]) -> impl Iterator<Item = [Vec3; 3]> {
    meshes.iter().flat_map(|mesh| mesh.faces.iter().map(|face: &Face| mesh.corners(face)))
}

#[test]
fn it_has_sixty_to_seventy_thousand_triangles() {
    let n: usize = objects(Plan { fine: 1 }).iter().map(|o| o.faces.len()).sum();
    assert!((60_000..=70_000).contains(&n), "{n}");
}

#[test]
fn it_measures_thirty_by_thirteen_by_sixteen_metres() {
    let (scene, _) = atrium(0).build().unwrap();
    let bounds = scene.bounds();
    assert!((bounds.min - Vec3::new(-15.0, 0.0, -8.0)).length() < 1e-5, "{bounds:?}");
    assert!((bounds.max - Vec3::new(15.0, 13.0, 8.0)).length() < 1e-5, "{bounds:?}");
}

#[test]
fn triangles_are_small_and_not_thin() {
    // The roof and the plain outside may be coarse.
    let inside = meshes(0).into_iter().filter(|mesh| mesh.name != "roof");
    let (mut long, mut thin, mut n) = (0, 0, 0);
    for [a, b, c] in faces(&inside.collect::<Vec<_>>()) {
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let height = (b - a).cross(c - a).length() / longest;
        assert!(height > 1e-4 && longest < 0.9, "{a} {b} {c}");
        n += 1;
        // A cell of half a metre square has a diagonal of 0.7 m.
        long += u32::from(longest > 0.76);
        thin += u32::from(height < 0.1 * longest);
    }
    assert!(25 * long < n && 25 * thin < n, "{long} long and {thin} thin of {n}");
}

#[test]
fn attributes_are_finite_and_normals_look_the_way_of_their_face() {
    let (scene, _) = atrium(0).build().unwrap();
    assert!(scene.positions().iter().all(|p| p.is_finite()) && scene.uvs().iter().all(|uv| uv.is_finite()));
    for tri in triangles(&scene) {
        let face = scene.geometric_normal(tri);
        for vertex in scene.triangle(tri) {
            assert!(scene.normals()[vertex as usize].dot(face) > 0.5, "{tri:?}");
        }
    }
}

/// Every edge is met by others that run the other way, over its whole length: light has no gap to leak through.
///
/// Most edges have a partner of the same bits. The rest must be parallel to an axis, where parts with different
/// steps meet: a line of floating-point numbers with two equal coordinates is exactly straight.
#[test]
fn the_building_is_watertight() {
    let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    for level in [0, 1] {
        let meshes = meshes(level);
        let mut balance = BTreeMap::new();
        for corners in faces(&meshes) {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                let (key, sign) =
                    if bits(a) < bits(b) { ((bits(a), bits(b)), 1) } else { ((bits(b), bits(a)), -1) };
                *balance.entry(key).or_insert(0) += sign;
            }
        }
        // Along each line: where the sum of the directions of edges changes, and by how much.
        let mut lines: BTreeMap<_, Vec<(f32, i32)>> = BTreeMap::new();
        for ((a, b), sign) in balance.into_iter().filter(|(_, sign)| *sign != 0) {
            let (a, b) = (a.map(f32::from_bits), b.map(f32::from_bits));
            let axes: Vec<usize> = (0..3).filter(|&axis| a[axis] != b[axis]).collect();
            let [axis] = axes[..] else { panic!("level {level}: no partner for the edge {a:?} to {b:?}") };
            let mut line = a.map(f32::to_bits);
            line[axis] = 0;
            let (from, to, sign) =
                if a[axis] < b[axis] { (a[axis], b[axis], sign) } else { (b[axis], a[axis], -sign) };
            lines.entry((axis, line)).or_default().extend([(from, sign), (to, -sign)]);
        }
        for ((axis, line), mut changes) in lines {
            let line = line.map(f32::from_bits);
            changes.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut open = 0;
            for run in changes.chunk_by(|a, b| a.0 == b.0) {
                open += run.iter().map(|change| change.1).sum::<i32>();
                // The outside walls end on the ground, which is not there.
                let is_foot = axis != 1 && line[1] == 0.0 && (line[0].abs() == 15.0 || line[2].abs() == 8.0);
                assert!(
                    open == 0 || is_foot,
                    "level {level}: gap along axis {axis} at {line:?} from {}",
                    run[0].0
                );
            }
        }
    }
}

#[test]
fn walls_have_their_solid_on_the_inside() {
    // Volume by the divergence theorem: what is missing to close the solid lies in the plane y = 0.
    let meshes = meshes(0);
    let cone = |[a, b, c]: [Vec3; 3]| f64::from(a.dot(b.cross(c))) / 6.0;
    let volume: f64 = faces(&meshes).map(cone).sum();
    let block = 30.0 * 16.0 * 12.0;
    assert!((0.25 * block..0.5 * block).contains(&volume), "{volume}");
}

#[test]
fn cameras_stand_in_the_open() {
    for camera in cameras() {
        let p = camera.position;
        assert!(p.x.abs() < 14.35 && p.z.abs() < 7.35 && p.y > 1.5 && p.y < 9.0, "{}", camera.name);
        assert!(camera.axes().is_some());
    }
}

#[test]
fn the_sun_shines_into_the_court() {
    let sun = sun();
    let normal = sun.normal().unwrap();
    assert!(normal.y < -0.8, "{normal}");
    // The middle of its light falls on the floor of the court.
    let on_floor = sun.center - normal * (sun.center.y / normal.y);
    assert!(on_floor.x.abs() < 10.0 && on_floor.z.abs() < 3.8, "{on_floor}");
}

#[test]
fn textures_are_the_same_every_time_and_within_what_albedos_may_be() {
    let (first, second) = (paint::textures(), paint::textures());
    assert_eq!(first, second);
    assert_eq!(first.len(), 7);
    for texture in first {
        assert!(texture.max().max_element() < 0.9, "{}", texture.name);
        let mean = texture.mean();
        assert!(mean.min_element() > 0.01 && mean.max_element() < 0.8, "{}: {mean}", texture.name);
    }
}
