//! Baking in a few lines: light comes back as the meshes were given.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use lumel::{
    Bake, BakeError, Control, Face, FaceSide, Light, Material, MaterialId, ObjectMesh, Projection, RectLight,
    SceneBuilder, SettingsPatch, Smoothing, Step, Vec3,
};
use std::sync::{Arc, Mutex};

fn light() -> RectLight {
    RectLight::new([0.0, 2.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], [9.0, 9.0, 9.0])
}

/// Two quads that meet in a right angle, with a seam down the middle of the first, a face without area, a vertex that no
/// face uses, and a two-sided second quad.
fn corner() -> ObjectMesh {
    let face =
        |vertices, material| Face { vertices, material: MaterialId(material), smoothing: Smoothing::Crease };
    let positions: Vec<Vec3> = [
        [-1.0, 0.0, 1.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [-1.0, 0.0, -1.0],
        // The seam, and nothing.
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [7.0, 7.0, 7.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, -1.0],
        // The wall at the back.
        [1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0],
    ]
    .map(Vec3::from)
    .to_vec();
    ObjectMesh {
        name: "corner".into(),
        uvs: (0..positions.len()).map(|i| lumel::glam::Vec2::splat(i as f32)).collect(),
        positions,
        faces: vec![
            face([0, 1, 2], 0),
            face([1, 1, 2], 0),
            face([0, 2, 3], 0),
            face([4, 7, 8], 0),
            face([4, 8, 5], 0),
            face([3, 8, 9], 1),
            face([3, 9, 10], 1),
        ],
        ..ObjectMesh::default()
    }
}

fn scene() -> SceneBuilder {
    let mut scene = SceneBuilder::new("corner");
    scene.add_material(Material::diffuse("white", [0.8, 0.8, 0.8]));
    scene.add_material(Material::diffuse("red", [0.8, 0.1, 0.1]).two_sided());
    scene.objects.push(corner());
    scene.add_light(light());
    scene
}

fn bake() -> lumel::Baked {
    Bake::new(scene()).bounces(2).run().unwrap()
}

#[test]
fn light_comes_back_in_the_order_of_the_vertices_that_were_given() {
    let baked = bake();
    let mesh = corner();
    let object = lumel::ObjectId(0);
    let front = baked.light_at_vertices(object, FaceSide::Front);
    let back = baked.light_at_vertices(object, FaceSide::Back);
    assert_eq!((front.len(), back.len()), (mesh.positions.len(), mesh.positions.len()));
    assert_eq!(front[6], None, "no face uses it");
    let behind: Vec<bool> = back.iter().map(Option::is_some).collect();
    let wall = |vertex| [3, 8, 9, 10].contains(&vertex);
    assert!((0..mesh.positions.len()).all(|vertex| behind[vertex] == wall(vertex)), "{behind:?}");
    // Both sides of the seam see the same.
    assert_eq!((front[1], front[2]), (front[4], front[5]));
    // What each vertex has is what is stored where it is.
    let (scene, solution) = (baked.baker().scene(), baked.solution());
    for (position, light) in mesh.positions.iter().zip(&front).filter_map(|(p, e)| Some((p, (*e)?))) {
        let here = (0..scene.vertex_count()).filter(|&v| scene.positions()[v] == *position);
        let light_here: Vec<Vec3> = here.map(|v| solution.irradiance[v]).collect();
        let (min, max) = light_here.iter().fold((Vec3::MAX, Vec3::ZERO), |(a, b), e| (a.min(*e), b.max(*e)));
        let slack = Vec3::splat(1e-6);
        assert!(light.cmpge(min - slack).all() && light.cmple(max + slack).all(), "{position}: {light}");
    }
}

#[test]
fn light_at_corners_tells_the_walls_of_a_crease_apart() {
    let baked = bake();
    let corners = baked.light_at_corners(lumel::ObjectId(0), FaceSide::Front);
    assert_eq!(corners.len(), corner().faces.len());
    assert_eq!(corners[1], None, "a face without area");
    let [floor, wall] = [corners[2].unwrap()[2], corners[5].unwrap()[0]];
    assert!(
        (floor - wall).length() > 0.1 * floor.length(),
        "vertex 3 on the floor and on the wall: {floor} {wall}"
    );
    let mean = baked.light_at_vertices(lumel::ObjectId(0), FaceSide::Front)[3].unwrap();
    assert!(mean.cmpge(floor.min(wall)).all() && mean.cmple(floor.max(wall)).all());
    let behind = baked.light_at_corners(lumel::ObjectId(0), FaceSide::Back);
    assert!(behind[5].is_some() && behind[0].is_none());
}

#[test]
fn a_relit_bake_is_the_bake_under_those_lights() {
    let brighter = RectLight { radiance: lumel::Radiance::splat(20.0), ..light() };
    let relit = bake().relit(vec![Light::Rect(brighter)]).unwrap();
    let mut other = scene();
    other.lights = vec![Light::Rect(brighter)];
    let baked = Bake::new(other).bounces(2).run().unwrap();
    assert_eq!(relit.solution().irradiance, baked.solution().irradiance);
}

#[test]
fn progress_is_told_for_every_step_from_its_beginning_to_its_end() {
    let told: Arc<Mutex<Vec<(Step, f64)>>> = Arc::default();
    let note = Arc::clone(&told);
    let on_progress = move |step, share| note.lock().unwrap().push((step, share));
    // At vertices, as a solve over areas has no step of validity.
    let at_vertices = SettingsPatch { projection: Some(Projection::Point), ..SettingsPatch::default() };
    Bake::new(scene()).settings(at_vertices).bounces(1).on_progress(on_progress).run().unwrap();
    let told = told.lock().unwrap();
    for step in [Step::Validity, Step::Bounce(0), Step::Bounce(1)] {
        let shares: Vec<f64> = told.iter().filter(|(s, _)| *s == step).map(|(_, share)| *share).collect();
        assert_eq!((shares.first(), shares.last()), (Some(&0.0), Some(&1.0)), "{step:?}");
        assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)));
    }
}

#[test]
fn a_bake_can_be_cancelled_and_refuses_what_makes_no_sense() {
    let control = Arc::new(Control::default());
    control.cancel();
    let result = Bake::new(scene()).control(control).run();
    assert!(matches!(result, Err(BakeError::Solve(lumel::SolveError::Cancelled))), "{result:?}");
    let nothing = Bake::new(SceneBuilder::new("nothing")).run();
    assert!(matches!(nothing, Err(BakeError::Scene(_))), "{nothing:?}");
    let patch = lumel::SettingsPatch { direct_samples: Some(0), ..Default::default() };
    let refused = Bake::new(scene()).settings(patch).run();
    assert!(matches!(refused, Err(BakeError::Settings(_))), "{refused:?}");
}

#[test]
fn what_is_saved_is_the_solution() {
    let (baked, folder) = (bake(), tempfile::tempdir().unwrap());
    let path = folder.path().join("corner.npz");
    baked.save(&path).unwrap();
    assert_eq!(lumel::Solution::load(&path).unwrap().irradiance, baked.solution().irradiance);
    baked.save(folder.path().join("corner.glb")).unwrap();
    let error = baked.save(folder.path().join("corner.jpg")).unwrap_err().to_string();
    assert!(error.contains(".npz, .glb"), "{error}");
}
