use super::*;
use crate::{
    Barycentrics, Face, FaceSide, Material, MaterialId, ObjectId, ObjectMesh, Scene, SceneBuilder,
    SceneError, Smoothing, SurfacePoint, TriId,
};
use glam::{Vec2, Vec3, Vec3Swizzles};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

type Bits = [u32; 3];

fn bits(p: Vec3) -> Bits {
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

fn mesh(positions: Vec<Vec3>, triangles: &[[u32; 3]], material: u32) -> ObjectMesh {
    let face = |&vertices| Face { vertices, material: MaterialId(material), smoothing: Smoothing::Crease };
    ObjectMesh {
        uvs: positions.iter().map(|p| Vec2::new(p.x, p.y)).collect(),
        positions,
        faces: triangles.iter().map(face).collect(),
        ..ObjectMesh::default()
    }
}

/// A crooked box whose six sides are objects of their own, and a two-sided flap on its floor.
fn room() -> Arc<Scene> {
    let corner = |i: u32| {
        let at = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32);
        at * Vec3::new(1.3, 0.9, 1.1) + 0.1 * at.yzx() * at
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let side = |quad: &[u32; 4]| mesh(quad.map(corner).to_vec(), &[[0, 1, 2], [0, 2, 3]], 0);
    let mut objects: Vec<ObjectMesh> = quads.iter().map(side).collect();
    let flap = [[0.3, 0.4, 0.2], [0.9, 0.4, 0.3], [0.8, 0.7, 0.9], [0.2, 0.5, 0.7]].map(Vec3::from);
    objects.push(mesh(flap.to_vec(), &[[0, 1, 2], [0, 2, 3]], 1));
    let materials = vec![Material::default(), Material::default().two_sided()];
    let builder = SceneBuilder { name: "room".into(), objects, materials, ..SceneBuilder::default() };
    Arc::new(builder.build().unwrap().0)
}

/// Splits edges here and there, several times.
fn somewhere(scene: &Arc<Scene>, rounds: u32) -> Bisection {
    let mut mesh = Bisection::new(Arc::clone(scene));
    let mut state = 7_u32;
    for _ in 0..rounds {
        let parts: Vec<Part> = mesh.parts().copied().collect();
        let chosen = parts.iter().filter_map(|part| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let k = (state >> 28) as usize % 3;
            (state >> 16 & 7 == 0).then(|| [part.vertices[k], part.vertices[(k + 1) % 3]])
        });
        let chosen: Vec<[u32; 2]> = chosen.collect();
        assert!(mesh.split(chosen, usize::MAX));
    }
    mesh
}

fn area(scene: &Scene) -> f64 {
    (0..scene.triangle_count() as u32)
        .map(|tri| crate::triangle::area(scene.triangle_positions(TriId(tri))))
        .sum()
}

/// Directed edges of the triangles that rays meet, by position, with how often they occur.
fn edges(scene: &Scene) -> BTreeMap<[Bits; 2], u32> {
    let mut edges = BTreeMap::new();
    for tri in (0..scene.traced_count() as u32).map(TriId) {
        let corners = scene.triangle_positions(tri);
        for k in 0..3 {
            *edges.entry([bits(corners[k]), bits(corners[(k + 1) % 3])]).or_insert(0) += 1;
        }
    }
    edges
}

#[test]
fn whatever_is_split_surfaces_stay_closed_and_as_large_as_they_were() {
    let scene = room();
    let mesh = somewhere(&scene, 9);
    let fine = scene.refined(mesh.splits()).unwrap();
    assert!(fine.triangle_count() > 500, "{}", fine.triangle_count());
    assert!((area(&fine) / area(&scene) - 1.0).abs() < 1e-6, "positions are rounded");
    let edges = edges(&fine);
    // A vertex that hung in an edge would leave the halves on one side and the whole on the other.
    let open: Vec<_> =
        edges.iter().filter(|([a, b], n)| **n != 1 || edges.get(&[*b, *a]) != Some(&1)).collect();
    let flap_border = |[a, _]: &[Bits; 2]| f32::from_bits(a[1]) > 0.3 && f32::from_bits(a[1]) < 0.75;
    assert!(open.iter().all(|(edge, n)| **n == 1 && flap_border(edge)), "{} open edges", open.len());
    // V − E + F of the box, without the flap of one patch.
    let points: BTreeSet<Bits> = edges.keys().map(|edge| edge[0]).collect();
    let n_edges = edges.keys().map(|[a, b]| [*a.min(b), *a.max(b)]).collect::<BTreeSet<_>>().len();
    let euler = points.len() as i64 - n_edges as i64 + fine.traced_count() as i64;
    assert_eq!(euler, 2 + 1);
}

#[test]
fn both_sides_of_a_surface_are_split_alike_and_keep_their_own_vertices() {
    let scene = room();
    let fine = scene.refined(somewhere(&scene, 8).splits()).unwrap();
    let backs = fine.triangle_count() - fine.traced_count();
    assert!(backs > 4);
    for back in (fine.traced_count()..fine.triangle_count()).map(|tri| TriId(tri as u32)) {
        let front = fine.traced(back);
        let ([a, b, c], corners) = (fine.triangle_positions(front), fine.triangle_positions(back));
        assert_eq!(corners, [b, a, c]);
        assert!(fine.triangle(front).iter().all(|v| !fine.triangle(back).contains(v)));
        let at = SurfacePoint { tri: front, bary: Barycentrics { u: 0.2, v: 0.3 } };
        let seen = fine.seen_side(at, FaceSide::Back).unwrap();
        assert!(fine.position(seen).distance(fine.position(at)) < 1e-6);
        assert!(fine.normals()[fine.triangle(back)[0] as usize].dot(fine.geometric_normal(back)) > 0.8);
    }
}

#[test]
fn points_lead_to_the_parts_that_they_lie_on_and_back() {
    let scene = room();
    let fine = scene.refined(somewhere(&scene, 9).splits()).unwrap();
    for i in 0..4000_u32 {
        let u = (i as f32 * 0.618_034).fract();
        let bary = Barycentrics { u, v: (i as f32 * 0.754_878).fract() * (1.0 - u) };
        let original = SurfacePoint { tri: TriId(i % scene.triangle_count() as u32), bary };
        let refined = fine.refined_point(original);
        assert!(refined.bary.weights().iter().all(|weight| (-1e-6..=1.0 + 1e-6).contains(weight)));
        assert!(fine.position(refined).distance(scene.position(original)) < 5e-5);
        let refinement = fine.refinement().unwrap();
        let back = refinement.original(refined);
        assert_eq!(back.tri, original.tri);
        assert!((back.bary.u - bary.u).abs().max((back.bary.v - bary.v).abs()) < 1e-5);
        // Once rounded, a point is found again with the same bits.
        assert_eq!(fine.refined_point(back), refined);
        assert!((fine.uv(refined) - scene.uv(original)).length() < 1e-4);
    }
}

#[test]
fn points_of_a_coarser_refinement_lead_to_a_finer_one_as_if_they_were_new() {
    let scene = room();
    let mut mesh = somewhere(&scene, 6);
    let coarse = scene.refined(mesh.splits()).unwrap();
    let edges: Vec<[u32; 2]> =
        mesh.parts().step_by(3).map(|part| [part.vertices[0], part.vertices[1]]).collect();
    assert!(mesh.split(edges, usize::MAX));
    let fine = scene.refined(mesh.splits()).unwrap();
    for i in 0..4000_u32 {
        let u = (i as f32 * 0.618_034).fract();
        let bary = Barycentrics { u, v: (i as f32 * 0.754_878).fract() * (1.0 - u) };
        let hit = SurfacePoint { tri: TriId(i % scene.traced_count() as u32), bary };
        let stored = coarse.refined_point(hit);
        assert_eq!(
            fine.refined_point(coarse.refinement().unwrap().original(stored)),
            fine.refined_point(hit)
        );
    }
}

#[test]
fn all_edges_of_a_grid_split_make_four_of_each_triangle() {
    let at = |i: u32| Vec3::new((i % 5) as f32, (i / 5) as f32, 0.0);
    let cells = (0..16_u32).map(|cell| cell / 4 * 5 + cell % 4);
    let halves: Vec<[u32; 3]> = cells.flat_map(|i| [[i, i + 1, i + 6], [i, i + 6, i + 5]]).collect();
    let mut builder = SceneBuilder::new("grid");
    builder.materials.push(Material::default());
    builder.objects.push(mesh((0..25).map(at).collect(), &halves, 0));
    let scene = Arc::new(builder.build().unwrap().0);
    let mut mesh = Bisection::new(Arc::clone(&scene));
    let all: Vec<[u32; 2]> = mesh
        .parts()
        .flat_map(|part| [0, 1, 2].map(|k| [part.vertices[k], part.vertices[(k + 1) % 3]]))
        .collect();
    assert!(mesh.split(all, usize::MAX));
    let fine = scene.refined(mesh.splits()).unwrap();
    assert_eq!((fine.triangle_count(), fine.vertex_count()), (4 * 32, 81));
    assert!((area(&fine) - 16.0).abs() < 1e-12);
}

#[test]
fn a_mesh_made_of_its_splits_is_the_same_and_other_edges_are_refused() {
    let scene = room();
    let mesh = somewhere(&scene, 7);
    let again = Bisection::with_splits(Arc::clone(&scene), mesh.splits()).unwrap();
    assert!(mesh.parts().eq(again.parts()));
    assert_eq!(scene.refined(&[]).unwrap().geometry_hash(), scene.geometry_hash());
    assert_eq!(
        scene.refined(mesh.splits()).unwrap().original().unwrap().geometry_hash(),
        scene.geometry_hash()
    );
    let with = |change: fn(&mut Vec<[u32; 2]>)| {
        let mut splits = mesh.splits().to_vec();
        change(&mut splits);
        scene.refined(&splits).map(|scene| scene.triangle_count())
    };
    for change in [
        (|splits| splits[0] = [0, u32::MAX]) as fn(&mut Vec<[u32; 2]>),
        |splits| splits[3] = splits[2],
        |splits| splits.push([0, 20]),
        |splits| splits.truncate(splits.len() - 1),
    ] {
        assert!(matches!(with(change), Err(SceneError::BadSplits { .. })), "{:?}", with(change));
    }
}

#[test]
fn no_more_vertices_are_made_than_are_allowed() {
    let scene = room();
    let mut mesh = somewhere(&scene, 3);
    let (n, splits) = (mesh.vertex_count(), mesh.splits().to_vec());
    let edges: Vec<[u32; 2]> = mesh.parts().map(|part| [part.vertices[0], part.vertices[1]]).collect();
    assert!(!mesh.split(edges.clone(), n + 3));
    assert_eq!((mesh.vertex_count(), mesh.splits()), (n, &splits[..]));
    assert!(mesh.split(edges, usize::MAX));
    assert!(mesh.vertex_count() > n + 3);
}

#[test]
fn vertices_that_were_given_are_found_after_a_refinement() {
    let scene = room();
    let fine = scene.refined(somewhere(&scene, 5).splits()).unwrap();
    for object in (0..scene.object_names().len() as u32).map(ObjectId) {
        let [before, after] = [&*scene, &fine].map(|scene| scene.input_mesh(object));
        for side in [FaceSide::Front, FaceSide::Back] {
            assert_eq!(before.vertex_map(side), after.vertex_map(side));
            for face in 0..2 {
                assert_eq!(before.corners(face, side), after.corners(face, side));
                let corners =
                    |scene: &Scene, tri: Option<TriId>| tri.map(|tri| scene.triangle_positions(tri));
                let found = corners(&fine, after.triangle(face, side));
                assert!(found.is_none() || found == corners(&scene, before.triangle(face, side)));
            }
        }
    }
}
