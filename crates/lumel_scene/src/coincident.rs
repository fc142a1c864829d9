//! Faces in the same place: found, named, and reduced to one surface with one or two sides.
//!
//! Faces coincide if they have the same three corners, to the bit; halves of quads that are split along different diagonals
//! are made to. Of those that face the same way one is kept, and no more than its light is counted;
//! those that face opposite ways become the two sides of one surface. Which one is kept depends on what the faces are, not
//! on their order: the brightest emitter, then what is opaque, then the lightest, then the first by name.

use crate::mesh::ObjectMesh;
use crate::runs::Runs;
use crate::weld::{Weld, sorted_by_number};
use crate::{Material, SceneBuilder, Warnings, luminance};
use glam::{DVec3, Vec3};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// An object's face: the places of both in their lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct FaceRef {
    pub(crate) object: usize,
    pub(crate) face: usize,
}

/// Drops faces that coincide with others that face the same way; returns the pairs of those left that face opposite ways.
///
/// `kept` says which of the given faces of each object are there, and is told what is dropped.
pub(crate) fn resolve(
    objects: &mut [ObjectMesh],
    kept: &mut [Runs],
    materials: &[Material],
    warnings: &mut Warnings,
) -> Vec<[FaceRef; 2]> {
    let groups = Points::of(objects).groups(objects);
    if groups.is_empty() {
        return Vec::new();
    }
    let mut drops: Vec<Vec<bool>> = objects.iter().map(|object| vec![false; object.faces.len()]).collect();
    let (mut pairs, mut report) = (Vec::new(), Report::default());
    for group in groups {
        let better = |a: &FaceRef, b: &FaceRef| prefer(objects, materials, *a, *b);
        let winner = |odd: bool| {
            let facing = group.iter().filter(|(_, is_odd)| *is_odd == odd).map(|(face, _)| *face);
            facing.min_by(better)
        };
        let [even, odd] = [false, true].map(winner);
        for &(face, is_odd) in &group {
            let keeper = if is_odd { odd } else { even };
            if let Some(keeper) = keeper.filter(|keeper| *keeper != face) {
                drops[face.object][face.face] = true;
                report.dropped(keeper.object, face.object);
            }
        }
        if let (Some(even), Some(odd)) = (even, odd) {
            pairs.push([even.min(odd), even.max(odd)]);
            report.paired(even.object, odd.object);
        }
    }
    report.warn(objects, warnings);
    let places = drop_faces(objects, kept, &drops);
    let moved = |FaceRef { object, face }: FaceRef| FaceRef { object, face: places[object][face] };
    pairs.into_iter().map(|pair| pair.map(moved)).collect()
}

impl SceneBuilder {
    /// Splits quads with the same corners along the same diagonal, so that [`build`](Self::build) finds that their halves
    /// coincide. Changes the faces of flat quads that are there twice.
    ///
    /// [`tessellate`](Self::tessellate) does it first: what coincides then does so afterwards.
    pub fn unify_diagonals(&mut self) {
        Points::of(&self.objects).unify_diagonals(&mut self.objects);
    }
}

/// The order in which faces in one place are preferred.
fn prefer(objects: &[ObjectMesh], materials: &[Material], a: FaceRef, b: FaceRef) -> Ordering {
    let material = |f: FaceRef| &materials[objects[f.object].faces[f.face].material.index()];
    let (of_a, of_b) = (material(a), material(b));
    let brightness = |m: &Material| luminance(m.emission.0);
    brightness(of_b)
        .total_cmp(&brightness(of_a))
        .then_with(|| of_a.transparency.is_possible().cmp(&of_b.transparency.is_possible()))
        .then_with(|| luminance(of_b.albedo).total_cmp(&luminance(of_a.albedo)))
        .then_with(|| of_a.name.cmp(&of_b.name))
        .then_with(|| objects[a.object].name.cmp(&objects[b.object].name))
        .then(a.cmp(&b))
}

/// Removes faces; where each of an object's faces is now.
fn drop_faces(objects: &mut [ObjectMesh], kept: &mut [Runs], drops: &[Vec<bool>]) -> Vec<Vec<usize>> {
    let mut places = Vec::with_capacity(objects.len());
    for ((object, kept), drops) in objects.iter_mut().zip(kept).zip(drops) {
        let left_before = drops.iter().scan(0, |left, drop| {
            let place = *left;
            *left += usize::from(!drop);
            Some(place)
        });
        places.push(left_before.collect());
        if drops.contains(&true) {
            let mut dropped = drops.iter();
            object.faces.retain(|_| dropped.next() != Some(&true));
            let left = kept.iter().zip(drops).filter(|(_, drop)| !**drop).map(|(face, _)| face);
            let mut runs = Runs::default();
            runs.extend(left);
            *kept = runs;
        }
    }
    places
}

/// The same number for all vertices in one place.
struct Points {
    /// By object and vertex.
    numbers: Vec<Vec<u32>>,
    len: usize,
}

/// A face by the numbers of its corners in ascending order, and whether its winding is an odd permutation of that.
type Key = ([u32; 3], bool);

impl Points {
    fn of(objects: &[ObjectMesh]) -> Self {
        let mut weld = Weld::default();
        let mut number = |position: &Vec3| weld.number(*position);
        let numbers =
            objects.iter().map(|object| object.positions.iter().map(&mut number).collect()).collect();
        Self { numbers, len: weld.len() }
    }

    /// The points at the corners of a face, if there are such vertices.
    fn corners(&self, object: usize, vertices: [u32; 3]) -> Option<[u32; 3]> {
        let [a, b, c] = vertices.map(|vertex| self.numbers[object].get(vertex as usize).copied());
        Some([a?, b?, c?])
    }

    /// All faces of all objects with the points at their corners.
    fn faces<'a>(&'a self, objects: &'a [ObjectMesh]) -> impl Iterator<Item = (FaceRef, [u32; 3])> + 'a {
        objects.iter().enumerate().flat_map(move |(object, mesh)| {
            mesh.faces.iter().enumerate().filter_map(move |(face, f)| {
                Some((FaceRef { object, face }, self.corners(object, f.vertices)?))
            })
        })
    }

    /// The faces that are in one place with others, place by place.
    fn groups(&self, objects: &[ObjectMesh]) -> Vec<Vec<(FaceRef, bool)>> {
        let mut all: Vec<(Key, FaceRef)> =
            self.faces(objects).map(|(face, corners)| (sorted(corners), face)).collect();
        for k in [2, 1, 0] {
            all = sorted_by_number(&all, self.len, |((corners, _), _)| corners[k]);
        }
        let same = all.chunk_by(|a, b| a.0.0 == b.0.0).filter(|same| same.len() > 1);
        same.map(|same| same.iter().map(|&((_, is_odd), face)| (face, is_odd)).collect()).collect()
    }

    fn unify_diagonals(&self, objects: &mut [ObjectMesh]) {
        let mut edges: Vec<([u32; 2], FaceRef)> = Vec::new();
        for (face, [a, b, c]) in self.faces(objects) {
            edges.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], face)));
        }
        for k in [1, 0] {
            edges = sorted_by_number(&edges, self.len, |(ends, _)| ends[k]);
        }
        // Where the edges of each point begin, those of the point before end.
        let mut begins = vec![0; self.len + 1];
        edges.iter().for_each(|([p, _], _)| begins[*p as usize + 1] += 1);
        (0..self.len).for_each(|p| begins[p + 1] += begins[p]);
        let has_edge = |p: u32, q: u32| {
            let (p, q) = (p.min(q) as usize, p.max(q));
            let of_p = &edges[begins[p]..begins[p + 1]];
            of_p.get(of_p.partition_point(|([_, other], _)| *other < q))
                .is_some_and(|([_, other], _)| *other == q)
        };
        // By four corners: the quads there.
        let mut quads: BTreeMap<[u32; 4], Vec<Quad>> = BTreeMap::new();
        for at_edge in edges.chunk_by(|a, b| a.0 == b.0) {
            for (i, &(diagonal, first)) in at_edge.iter().enumerate() {
                let others = at_edge[i + 1..].iter().filter(|(_, second)| second.object == first.object);
                for &(_, second) in others {
                    let Some([one, other]) = self.halves(objects, diagonal, [first, second]) else {
                        continue;
                    };
                    let points = &self.numbers[first.object];
                    // Most edges are no diagonal of a quad that is there twice.
                    if !has_edge(points[one[0] as usize], points[other[0] as usize]) {
                        continue;
                    }
                    if let Some(quad) = self.quad(objects, diagonal, [(first, one), (second, other)]) {
                        let mut corners = quad.around.map(|vertex| points[vertex as usize]);
                        corners.sort_unstable();
                        quads.entry(corners).or_default().push(quad);
                    }
                }
            }
        }
        for mut same in quads.into_values() {
            same.sort_unstable_by_key(|quad| quad.diagonal);
            let [first, others @ ..] = same.as_slice() else { continue };
            for Quad { halves, around: [a, b, c, d], .. } in
                others.iter().filter(|q| q.diagonal != first.diagonal)
            {
                let faces = &mut objects[halves[0].object].faces;
                faces[halves[0].face].vertices = [*a, *b, *c];
                faces[halves[1].face].vertices = [*c, *d, *a];
            }
        }
    }

    /// The vertices of two faces of an object, each from the corner that their common edge leaves out.
    fn halves(&self, objects: &[ObjectMesh], edge: [u32; 2], halves: [FaceRef; 2]) -> Option<[[u32; 3]; 2]> {
        let points = &self.numbers[halves[0].object];
        let [one, other] = halves.map(|half| {
            let vertices = objects[half.object].faces[half.face].vertices;
            let tip = (0..3).find(|&i| !edge.contains(&points[vertices[i] as usize]));
            tip.map(|tip| [0, 1, 2].map(|i| vertices[(tip + i) % 3]))
        });
        Some([one?, other?])
    }

    /// The quad that two faces with an edge in common are halves of: flat, facing one way, of one material.
    fn quad(
        &self,
        objects: &[ObjectMesh],
        diagonal: [u32; 2],
        [(first, [a, b, d]), (second, [c, e, f])]: [(FaceRef, [u32; 3]); 2],
    ) -> Option<Quad> {
        let (object, points) = (&objects[first.object], &self.numbers[first.object]);
        let faces = [first, second].map(|half| object.faces[half.face]);
        let same = |v: u32, w: u32| points[v as usize] == points[w as usize];
        let is_one = faces[0].material == faces[1].material && faces[0].smoothing == faces[1].smoothing;
        let around = [a, b, c, d];
        let is_quad =
            is_one && same(b, f) && same(d, e) && is_flat(around.map(|v| object.positions[v as usize]));
        is_quad.then_some(Quad { diagonal, halves: [first, second], around })
    }
}

/// Two halves of a quad, and the ends of the edge that they share.
struct Quad {
    diagonal: [u32; 2],
    halves: [FaceRef; 2],
    /// The vertices in the order of their winding, from one that is no end of the diagonal.
    around: [u32; 4],
}

/// How far from a plane the corners of a quad may lie, as a share of its area to the power 3/2.
const FLAT: f64 = 1e-5;

/// Whether a quad lies in a plane and its halves beside each other, along either diagonal.
fn is_flat(corners: [Vec3; 4]) -> bool {
    let [a, b, c, d] = corners.map(|p| p.as_dvec3());
    let normal = (c - a).cross(d - b);
    let faces = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) > 0.0;
    (b - a).dot((c - a).cross(d - a)).abs() <= FLAT * normal.length().powf(1.5)
        && faces(a, b, c)
        && faces(c, d, a)
        && faces(a, b, d)
        && faces(c, d, b)
}

fn sorted(corners: [u32; 3]) -> Key {
    let [a, b, c] = corners;
    let mut ascending = corners;
    ascending.sort_unstable();
    let is_even = [[a, b, c], [b, c, a], [c, a, b]].contains(&ascending);
    (ascending, !is_even)
}

/// How many faces of which objects coincide.
#[derive(Default)]
struct Report {
    /// By the object that is kept and the one whose faces are dropped.
    dropped: BTreeMap<(usize, usize), usize>,
    paired: BTreeMap<(usize, usize), usize>,
}

impl Report {
    fn dropped(&mut self, kept: usize, dropped: usize) {
        *self.dropped.entry((kept, dropped)).or_default() += 1;
    }

    fn paired(&mut self, a: usize, b: usize) {
        *self.paired.entry((a.min(b), a.max(b))).or_default() += 1;
    }

    fn warn(&self, objects: &[ObjectMesh], warnings: &mut Warnings) {
        let name = |object: usize| format!("object \"{}\"", objects[object].name);
        let other = |a: usize, b: usize| {
            if a == b { "others of its own".to_owned() } else { format!("some of {}", name(a)) }
        };
        for (&(kept, dropped), n) in &self.dropped {
            let others = other(kept, dropped);
            let message = format!(
                "{n} triangles coincide with {others} and face the same way: left out; delete one of the two"
            );
            warnings.push(name(dropped), message);
        }
        for (&(a, b), n) in &self.paired {
            let others = other(a, b);
            let message = format!(
                "{n} triangles coincide with {others} and face the other way: taken as two sides of one surface"
            );
            warnings.push(name(b), message);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        FaceSide, Material, MaterialId, ObjectId, Radiance, Scene, SceneBuilder, SurfacePoint, TriId,
        Warnings,
    };
    use glam::{EulerRot, Quat, Vec3};

    const SQUARE: [[f32; 2]; 4] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];

    /// Along the one diagonal and along the other, and both from behind.
    const SPLITS: [[[u32; 3]; 2]; 2] = [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [3, 0, 1]]];

    fn reversed(triangles: [[u32; 3]; 2]) -> [[u32; 3]; 2] {
        triangles.map(|[a, b, c]| [a, c, b])
    }

    fn corners() -> impl Iterator<Item = Vec3> {
        let turn = Quat::from_euler(EulerRot::XYZ, 0.3, 0.5, 0.7);
        SQUARE.into_iter().map(move |[x, y]| turn * Vec3::new(x, y, 0.0) + Vec3::new(3.0, 1.0, -2.0))
    }

    /// A square for each list of triangles; of a dark material, but for the one that shines.
    fn squares(lists: &[[[u32; 3]; 2]], shining: usize) -> SceneBuilder {
        let mut builder = SceneBuilder::new("squares");
        let dark = builder.add_material(Material::diffuse("dark", Vec3::splat(0.1)));
        let lamp = Material { emission: Radiance::splat(5.0), ..Material::diffuse("lamp", Vec3::ZERO) };
        let lamp = builder.add_material(lamp);
        for (n, list) in lists.iter().enumerate() {
            let material = if n == shining { lamp } else { dark };
            builder.add_mesh(format!("square {n}"), corners(), *list, material);
        }
        builder
    }

    fn built(mut builder: SceneBuilder) -> (Scene, Warnings) {
        builder.unify_diagonals();
        let given = builder.objects.clone();
        let (scene, warnings) = builder.build().unwrap();
        for (object, mesh) in (0..).map(ObjectId).zip(&given) {
            for (number, face) in mesh.faces.iter().enumerate() {
                let corners = scene.input_mesh(object).corners(number, FaceSide::Front);
                let positions = corners.map(|corners| corners.map(|v| scene.positions()[v as usize]));
                assert!(
                    positions.is_none_or(|positions| positions == mesh.corners(face)),
                    "{object:?} {number}"
                );
            }
        }
        (scene, warnings)
    }

    fn materials(scene: &Scene) -> Vec<MaterialId> {
        (0..scene.triangle_count() as u32).map(|tri| scene.material_id(TriId(tri))).collect()
    }

    fn texts(warnings: &Warnings) -> Vec<String> {
        warnings.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn of_faces_that_face_the_same_way_the_brightest_is_kept_in_any_order() {
        for (first, second) in [(SPLITS[0], SPLITS[0]), (SPLITS[0], SPLITS[1]), (SPLITS[1], SPLITS[0])] {
            for shining in [0, 1] {
                let (scene, warnings) = built(squares(&[first, second], shining));
                assert_eq!(materials(&scene), [MaterialId(1); 2]);
                let expected = format!(
                    "object \"square {}\": 2 triangles coincide with some of object \"square {shining}\" and face the \
                     same way: left out; delete one of the two",
                    1 - shining
                );
                assert_eq!(texts(&warnings), [expected]);
            }
        }
    }

    #[test]
    fn faces_back_to_back_are_two_sides_of_one_surface() {
        for back in [reversed(SPLITS[0]), reversed(SPLITS[1])] {
            for swapped in [false, true] {
                let lists = if swapped { [back, SPLITS[0]] } else { [SPLITS[0], back] };
                let (scene, warnings) = built(squares(&lists, 1));
                assert_eq!(scene.triangle_count(), 4);
                assert!(
                    texts(&warnings)[0].ends_with("face the other way: taken as two sides of one surface")
                );
                let met = scene.traced_corners().iter().filter(|corners| corners[0].is_finite()).count();
                assert_eq!(met, 2, "rays meet one of each two");
                for tri in [0, 1].map(TriId) {
                    let front = SurfacePoint { tri, bary: [0.2, 0.3].into() };
                    let back = scene.seen_side(front, FaceSide::Back).unwrap();
                    assert!((scene.position(back) - scene.position(front)).length() < 1e-6);
                    assert_eq!(
                        scene.geometric_normal(back.tri).dot(scene.geometric_normal(tri)).round(),
                        -1.0
                    );
                    assert_eq!((scene.traced(back.tri), scene.traced(tri)), (tri, tri));
                    assert_ne!(scene.material_id(back.tri), scene.material_id(tri));
                }
            }
        }
    }

    #[test]
    fn an_object_whose_faces_are_doubled_in_itself_is_told_once() {
        let mut builder = squares(&[SPLITS[0]], 1);
        let copies = [SPLITS[0], reversed(SPLITS[1])].concat();
        let like = builder.objects[0].faces[0];
        builder.objects[0].faces.extend(copies.into_iter().map(|vertices| crate::Face { vertices, ..like }));
        let (scene, warnings) = built(builder);
        assert_eq!((scene.triangle_count(), warnings.len()), (4, 2));
        let all = texts(&warnings).join("\n");
        assert!(all.contains("2 triangles coincide with others of its own and face the same way"), "{all}");
        assert!(all.contains("2 triangles coincide with others of its own and face the other way"), "{all}");
    }

    #[test]
    fn what_coincides_does_so_after_tessellation() {
        for other in [SPLITS[1], reversed(SPLITS[1])] {
            let mut builder = squares(&[SPLITS[0], other], 0);
            builder.tessellate(0.3).unwrap();
            let given: usize = builder.objects.iter().map(|object| object.faces.len()).sum();
            let (scene, _) = builder.build().unwrap();
            let expected = if other == SPLITS[1] { given / 2 } else { given };
            assert_eq!(scene.triangle_count(), expected);
            let met = scene.traced_corners().iter().filter(|corners| corners[0].is_finite()).count();
            assert_eq!(met, given / 2);
        }
    }

    #[test]
    fn neighbours_and_quads_that_are_not_flat_stay_as_they_are() {
        let mut builder = squares(&[SPLITS[0], SPLITS[1]], 0);
        builder.objects.iter_mut().for_each(|object| object.positions[1].y += 0.1);
        let (scene, warnings) = built(builder);
        assert_eq!((scene.triangle_count(), warnings.len()), (4, 0));
    }
}
