//! Tessellation.

use crate::edge_length::EdgeLength;
use crate::mesh::{Face, ObjectMesh};
use crate::triangle::{area, length_squared, longest, middle, widest_corner};
use crate::{Material, SceneBuilder, SceneError, Warnings, normals, tangents};
use glam::Vec3;
use std::collections::HashMap;

/// The most triangles that tessellation makes: a solve of them takes about 20 GB without stored rays.
const MAX_RESULT: u64 = 40_000_000;

/// Triangles per vertex of a fine mesh.
const TRIANGLES_PER_VERTEX: u64 = 2;

/// Lengths grow by this until no more triangles than that are added.
const COARSER: f64 = std::f64::consts::SQRT_2;

impl SceneBuilder {
    /// Splits triangles at the midpoint of their longest edge until no edge is longer than `max_edge` metres.
    ///
    /// Whether an edge is split depends on its two end points alone, and its midpoint has the same bits from either
    /// end. Triangles that meet along an edge therefore agree on the points along it without knowing of each other,
    /// even across objects: what was closed stays closed. Of edges of equal length the one opposite the smallest
    /// position goes first, so that the order of the corners does not matter either.
    ///
    /// Missing normals and tangents are made first: smooth ones are those of the given mesh. Positions, normals, tangents, texture
    /// coordinates and vertex colours are interpolated. Edges that are short enough stay, and so do those that no
    /// number lies between the ends of. Faces and objects that [`SceneBuilder::build`] would drop or refuse are left
    /// alone, dropped ones at the end of their object.
    ///
    /// # Errors
    /// When `max_edge` is not a positive number or the result would be too large; the meshes are then unchanged.
    pub fn tessellate(&mut self, max_edge: f32) -> Result<Warnings, SceneError> {
        if !(max_edge > 0.0 && max_edge.is_finite()) {
            return Err(SceneError::BadEdgeLength(max_edge));
        }
        self.recenter();
        self.unify_diagonals();
        let rule = self.rule(EdgeLength::Uniform(f64::from(max_edge)));
        // Nothing is made before it is known that it fits.
        let bound: f64 = self.objects.iter().map(|o| rule.fewest_triangles(o, f64::from(max_edge))).sum();
        let triangles = if bound > MAX_RESULT as f64 { bound as u64 } else { self.count(&rule, MAX_RESULT) };
        if triangles > MAX_RESULT {
            let scene = self.name.clone();
            return Err(SceneError::TooFine { scene, max_edge, triangles, limit: MAX_RESULT });
        }
        Ok(self.split(&rule))
    }

    /// Splits triangles as [`tessellate`](Self::tessellate) does, by lengths that suit the scene.
    ///
    /// Edges get at most a 64th of the diameter of the ball around most of the triangles, growing away from it to a 64th of
    /// the scene's diameter, however the scene is turned; longer ones where more than about `vertex_budget` vertices would be added. Meshes that are as
    /// fine already stay as they are. Returns the length too, `None` if nothing was split.
    pub fn tessellate_to_suit(&mut self, vertex_budget: u32) -> (Option<f32>, Warnings) {
        self.recenter();
        self.unify_diagonals();
        let Some(mut length) = EdgeLength::for_scene(self) else { return (None, Warnings::default()) };
        let given = self.face_count();
        let limit = given.saturating_add(TRIANGLES_PER_VERTEX * u64::from(vertex_budget));
        let triangles = loop {
            let triangles = self.count(&self.rule(length), limit);
            if triangles <= limit {
                break triangles;
            }
            length = length.scaled(COARSER);
        };
        if triangles == given {
            return (None, Warnings::default());
        }
        (Some(length.shortest() as f32), self.split(&self.rule(length)))
    }

    fn face_count(&self) -> u64 {
        self.objects.iter().map(|object| object.faces.len() as u64).sum()
    }

    fn rule(&self, length: EdgeLength) -> Rule {
        Rule { length, smallest_area: 1e-12 * self.diagonal_squared() }
    }

    /// The triangles that splitting would leave; gives up as soon as there are more than `limit`.
    fn count(&self, rule: &Rule, limit: u64) -> u64 {
        let mut triangles = 0;
        for object in &self.objects {
            let left = limit.saturating_sub(triangles);
            triangles += if has_whole_attributes(object) {
                rule.count(object, left)
            } else {
                object.faces.len() as u64
            };
        }
        triangles
    }

    fn split(&mut self, rule: &Rule) -> Warnings {
        let mut warnings = Warnings::default();
        for object in self.objects.iter_mut().filter(|o| has_whole_attributes(o)) {
            rule.split(object, &self.materials, &mut warnings);
        }
        warnings
    }
}

/// Whether each attribute is there for all vertices or none.
fn has_whole_attributes(object: &ObjectMesh) -> bool {
    let ObjectMesh { normals, uvs, tangents, lightmap_uvs, tints, alphas, .. } = object;
    let counts = [normals.len(), uvs.len(), tangents.len(), lightmap_uvs.len(), tints.len(), alphas.len()];
    counts.iter().all(|&n| n == 0 || n == object.positions.len())
}

/// What is split.
struct Rule {
    /// Longer edges are split.
    length: EdgeLength,
    /// Triangles up to this area are left alone, m².
    smallest_area: f64,
}

impl Rule {
    /// How many triangles the splitting of one object leaves; gives up as soon as there are more than `limit`.
    fn count(&self, object: &ObjectMesh, limit: u64) -> u64 {
        let (mut triangles, mut pending) = (0, Vec::new());
        for face in &object.faces {
            if !self.is_sound(object, face) {
                triangles += 1;
                continue;
            }
            pending.push(object.corners(face));
            while let Some(corners) = pending.pop() {
                if let Some(k) = self.edge_to_split(corners) {
                    let [a, b, c] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
                    let middle = middle(a, b);
                    pending.extend([[middle, b, c], [a, middle, c]]);
                } else {
                    triangles += 1;
                }
                if triangles + pending.len() as u64 > limit {
                    return triangles + pending.len() as u64;
                }
            }
        }
        triangles
    }

    /// Splits the triangles of one object.
    fn split(&self, object: &mut ObjectMesh, materials: &[Material], warnings: &mut Warnings) {
        let faces = std::mem::take(&mut object.faces);
        let (sound, other) = faces.into_iter().partition(|f| self.is_sound(object, f));
        object.faces = sound;
        normals::fill_missing(object, warnings);
        tangents::fill_missing(object, materials, warnings);
        let sound = std::mem::take(&mut object.faces);
        let mut midpoints = HashMap::new();
        let mut pending = Vec::new();
        for face in sound {
            pending.push(face.vertices);
            while let Some(vertices) = pending.pop() {
                if let Some(k) = self.edge_to_split(object.corners(&Face { vertices, ..face })) {
                    let [a, b, c] = [vertices[k], vertices[(k + 1) % 3], vertices[(k + 2) % 3]];
                    let middle =
                        *midpoints.entry((a.min(b), a.max(b))).or_insert_with(|| add_middle(object, a, b));
                    pending.push([middle, b, c]);
                    pending.push([a, middle, c]);
                } else {
                    let vertices = from_widest_corner(vertices, object.corners(&Face { vertices, ..face }));
                    object.faces.push(Face { vertices, ..face });
                }
            }
        }
        object.faces.extend(other);
    }

    /// The first corner of the longest edge that must and can be split.
    fn edge_to_split(&self, corners: [Vec3; 3]) -> Option<usize> {
        let edge = |k: usize| (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
        let too_long = (0..3).filter(|&k| {
            let (a, b, _) = edge(k);
            let middle = middle(a, b);
            let longest = self.length.at(middle.as_dvec3());
            length_squared(a, b) > longest * longest && middle != a && middle != b
        });
        longest(corners, too_long)
    }

    /// A lower bound for the triangles an object will have with edges of at most `h`.
    ///
    /// A triangle with no edge above `h` has at most the area `√3/4·h²` of the equilateral one, and an edge of length
    /// `l` becomes at least `l/h` edges, each the side of another triangle.
    fn fewest_triangles(&self, object: &ObjectMesh, h: f64) -> f64 {
        let pieces = |face| {
            let [a, b, c] = object.corners(face);
            let longest =
                [(a, b), (b, c), (c, a)].map(|(p, q)| length_squared(p, q)).into_iter().fold(0.0, f64::max);
            (area([a, b, c]) / (3_f64.sqrt() / 4.0 * h * h)).max(longest.sqrt() / h).max(1.0)
        };
        object.faces.iter().filter(|f| self.is_sound(object, f)).map(pieces).sum()
    }

    /// Whether a face has corners that exist and an area.
    fn is_sound(&self, object: &ObjectMesh, face: &Face) -> bool {
        let finite = |&v: &u32| object.positions.get(v as usize).is_some_and(|p| p.is_finite());
        face.vertices.iter().all(finite) && area(object.corners(face)) > self.smallest_area
    }
}

/// The vertices of a needle beginning with the corner between its shorter edges. Other triangles stay as they are.
fn from_widest_corner(mut vertices: [u32; 3], corners: [Vec3; 3]) -> [u32; 3] {
    vertices.rotate_left(widest_corner(corners));
    vertices
}

/// Adds the vertex in the middle of two others.
fn add_middle(object: &mut ObjectMesh, a: u32, b: u32) -> u32 {
    let (i, j) = (a.min(b) as usize, a.max(b) as usize);
    let new = object.positions.len() as u32;
    object.positions.push(middle(object.positions[i], object.positions[j]));
    // Opposite normals have no mean: zero stands for "none given".
    object.normals.push((object.normals[i] + object.normals[j]).try_normalize().unwrap_or(Vec3::ZERO));
    if !object.uvs.is_empty() {
        object.uvs.push(0.5 * (object.uvs[i] + object.uvs[j]));
    }
    if !object.tangents.is_empty() {
        object.tangents.push(tangents::middle(object.tangents[i], object.tangents[j]));
    }
    if !object.lightmap_uvs.is_empty() {
        object.lightmap_uvs.push(0.5 * (object.lightmap_uvs[i] + object.lightmap_uvs[j]));
    }
    if !object.tints.is_empty() {
        object.tints.push(0.5 * (object.tints[i] + object.tints[j]));
    }
    if !object.alphas.is_empty() {
        object.alphas.push(0.5 * (object.alphas[i] + object.alphas[j]));
    }
    new
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge_length::PER_DIAMETER;
    use crate::{Material, MaterialId, Smoothing};
    use glam::Vec2;
    use std::collections::{BTreeMap, BTreeSet};

    type Bits = [u32; 3];

    const BUDGET: u32 = 200_000;

    fn bits(p: Vec3) -> Bits {
        (p + Vec3::ZERO).to_array().map(f32::to_bits)
    }

    fn mesh(name: &str, positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> ObjectMesh {
        let face = |&vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
        ObjectMesh {
            name: name.to_owned(),
            positions: positions.iter().map(|&p| Vec3::from(p)).collect(),
            faces: triangles.iter().map(face).collect(),
            ..ObjectMesh::default()
        }
    }

    /// A crooked tetrahedron: no two edges have the same length.
    fn tetrahedron() -> ObjectMesh {
        let positions = [[0.1, 0.0, 0.0], [1.3, 0.2, 0.1], [0.2, 1.7, -0.1], [0.3, 0.4, 0.9]];
        mesh("tetrahedron", &positions, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    }

    /// Edges of equal length everywhere.
    fn cube() -> ObjectMesh {
        let corner = |i: u32| [(i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32];
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let halves: Vec<_> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        mesh("cube", &(0..8).map(corner).collect::<Vec<_>>(), &halves)
    }

    fn builder(objects: Vec<ObjectMesh>) -> SceneBuilder {
        SceneBuilder {
            name: "test".into(),
            objects,
            materials: vec![Material::default()],
            ..Default::default()
        }
    }

    fn tessellated(object: ObjectMesh, max_edge: f32) -> ObjectMesh {
        let mut b = builder(vec![object]);
        assert!(b.tessellate(max_edge).unwrap().is_empty());
        b.objects.remove(0)
    }

    fn triangles(object: &ObjectMesh) -> Vec<[Vec3; 3]> {
        object.faces.iter().map(|f| object.corners(f)).collect()
    }

    fn whole_area(object: &ObjectMesh) -> f64 {
        triangles(object).into_iter().map(area).sum()
    }

    fn edge_lengths(object: &ObjectMesh) -> Vec<f64> {
        let edges = |t: [Vec3; 3]| [(0, 1), (1, 2), (2, 0)].map(|(i, j)| length_squared(t[i], t[j]).sqrt());
        triangles(object).into_iter().flat_map(edges).collect()
    }

    /// Directed edges by position, with how often they occur.
    fn edges(object: &ObjectMesh) -> BTreeMap<(Bits, Bits), u32> {
        let mut edges = BTreeMap::new();
        for t in triangles(object) {
            for k in 0..3 {
                *edges.entry((bits(t[k]), bits(t[(k + 1) % 3]))).or_insert(0) += 1;
            }
        }
        edges
    }

    #[test]
    fn a_closed_mesh_stays_closed_without_hanging_vertices() {
        for (name, object) in [("tetrahedron", tetrahedron()), ("cube", cube())] {
            for max_edge in [0.9, 0.31, 0.05] {
                let fine = tessellated(object.clone(), max_edge);
                let edges = edges(&fine);
                // An edge with a vertex hanging in it has no partner of its own length on the other side.
                for (&(a, b), &n) in &edges {
                    assert_eq!((n, edges.get(&(b, a))), (1, Some(&1)), "{name} {max_edge}");
                }
                let points: BTreeSet<Bits> = edges.keys().map(|e| e.0).collect();
                let euler = points.len() as i64 - edges.len() as i64 / 2 + fine.faces.len() as i64;
                assert_eq!(euler, 2, "{name} {max_edge}");
            }
        }
    }

    #[test]
    fn area_and_facing_are_kept() {
        for object in [tetrahedron(), cube()] {
            let fine = tessellated(object.clone(), 0.04);
            assert!((whole_area(&fine) / whole_area(&object) - 1.0).abs() < 1e-6);
            let middle: Vec3 = object.positions.iter().sum::<Vec3>() / object.positions.len() as f32;
            assert!(triangles(&fine).iter().all(|[a, b, c]| (*b - *a).cross(*c - *a).dot(*a - middle) > 0.0));
        }
    }

    #[test]
    fn edges_end_up_between_a_fraction_and_the_whole_of_the_longest() {
        for object in [tetrahedron(), cube()] {
            for max_edge in [0.3, 0.07] {
                let lengths = edge_lengths(&tessellated(object.clone(), max_edge));
                assert!(lengths.iter().all(|&l| l <= f64::from(max_edge)));
                let long = lengths.iter().filter(|&&l| l > f64::from(max_edge) / 2.0).count();
                assert!(long * 4 > lengths.len() * 3, "{long} of {}", lengths.len());
                let shortest = lengths.iter().copied().fold(f64::MAX, f64::min);
                assert!(shortest > f64::from(max_edge) / 4.0, "{shortest}");
            }
        }
    }

    #[test]
    fn short_edges_are_left_as_they_are() {
        let coarse = tetrahedron();
        let fine = tessellated(coarse.clone(), 10.0);
        let positions = |o: &ObjectMesh| triangles(o);
        assert_eq!(positions(&fine), positions(&coarse));
    }

    #[test]
    fn objects_that_only_touch_get_the_same_points_along_their_common_edge() {
        let (a, b) = ([0.1, 0.2, 0.3], [1.7, 0.9, -0.4]);
        let left = mesh("left", &[a, b, [0.0, 2.0, 0.0]], &[[0, 1, 2]]);
        let right = mesh("right", &[b, [3.0, -2.0, 1.0], a], &[[2, 1, 0]]);
        let mut builder = builder(vec![left, right]);
        builder.tessellate(0.013).unwrap();
        let (a, b) = (Vec3::from(a).as_dvec3(), Vec3::from(b).as_dvec3());
        let on_edge = |p: &&Vec3| (p.as_dvec3() - a).cross(b - a).length() < 1e-6 * (b - a).length();
        let along =
            |o: &ObjectMesh| o.positions.iter().filter(on_edge).map(|&p| bits(p)).collect::<BTreeSet<_>>();
        assert_eq!(along(&builder.objects[0]), along(&builder.objects[1]));
        assert!(along(&builder.objects[0]).len() > 128);
    }

    #[test]
    fn vertices_are_shared_within_an_object() {
        let mut flat = mesh("flat", &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], &[]);
        flat.faces = mesh("", &[], &[[0, 1, 2], [0, 2, 3]]).faces;
        let fine = tessellated(flat, 0.1);
        let distinct: BTreeSet<Bits> = fine.positions.iter().map(|&p| bits(p)).collect();
        assert_eq!(distinct.len(), fine.positions.len());
    }

    #[test]
    fn linear_attributes_stay_linear() {
        let mut object = tetrahedron();
        let uv = |p: Vec3| Vec2::new(p.x + 2.0 * p.y, p.z - p.x);
        let tint = |p: Vec3| Vec3::splat(2.0) + p * 0.3;
        object.uvs = object.positions.iter().map(|&p| uv(p)).collect();
        object.lightmap_uvs = object.positions.iter().map(|&p| -uv(p)).collect();
        object.tints = object.positions.iter().map(|&p| tint(p)).collect();
        let fine = tessellated(object, 0.1);
        for (i, &p) in fine.positions.iter().enumerate() {
            assert!((fine.uvs[i] - uv(p)).length() < 1e-5);
            assert!((fine.lightmap_uvs[i] + uv(p)).length() < 1e-5);
            assert!((fine.tints[i] - tint(p)).length() < 1e-5);
        }
    }

    #[test]
    fn smooth_normals_are_those_of_the_given_mesh() {
        let mut object = cube();
        object.faces.iter_mut().for_each(|f| f.smoothing = Smoothing::Group(1));
        let fine = tessellated(object, 0.6);
        assert!(fine.normals.iter().all(|n| n.is_normalized()));
        let at = |p: [f32; 3]| fine.normals[fine.positions.iter().position(|&q| q == Vec3::from(p)).unwrap()];
        assert!((at([1.0, 1.0, 1.0]) - Vec3::ONE.normalize()).length() < 1e-6);
        assert!((at([1.0, 1.0, 0.5]) - Vec3::new(1.0, 1.0, 0.0).normalize()).length() < 1e-6);
    }

    #[test]
    fn the_order_of_corners_does_not_change_the_pieces() {
        let pieces = |object: &ObjectMesh| {
            let sorted = |mut t: [Bits; 3]| {
                t.sort_unstable();
                t
            };
            triangles(object).into_iter().map(|t| sorted(t.map(bits))).collect::<BTreeSet<_>>()
        };
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let first = pieces(&tessellated(mesh("a", &corners, &[[0, 1, 2]]), 0.09));
        for order in [[1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0]] {
            assert_eq!(pieces(&tessellated(mesh("b", &corners, &[order]), 0.09)), first, "{order:?}");
        }
        assert_eq!(tessellated(cube(), 0.1), tessellated(cube(), 0.1));
    }

    #[test]
    fn lengths_that_are_not_positive_numbers_are_refused() {
        for length in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let result = builder(vec![cube()]).tessellate(length);
            assert!(matches!(result, Err(SceneError::BadEdgeLength(_))), "{length}");
        }
    }

    #[test]
    fn absurd_lengths_are_refused_at_once_and_change_nothing() {
        for length in [1e-9, f32::MIN_POSITIVE, 1e-4] {
            let mut b = builder(vec![cube()]);
            let result = b.tessellate(length);
            assert!(matches!(result, Err(SceneError::TooFine { triangles, .. }) if triangles > MAX_RESULT));
            assert_eq!(b.objects, vec![cube()]);
        }
        let needle = mesh("needle", &[[0.0; 3], [1e9, 0.0, 0.0], [1e9, 1.0, 0.0]], &[[0, 1, 2]]);
        assert!(builder(vec![needle]).tessellate(0.1).is_err());
    }

    #[test]
    fn counting_stops_soon_after_the_limit() {
        let rule = |length| Rule { length: EdgeLength::Uniform(length), smallest_area: 0.0 };
        assert_eq!(rule(0.01).count(&cube(), 1000), 1001);
        assert_eq!(rule(0.3).count(&cube(), 10_000), tessellated(cube(), 0.3).faces.len() as u64);
    }

    #[test]
    fn without_a_length_edges_suit_the_scene() {
        let mut room = builder(vec![cube()]);
        let (length, _) = room.tessellate_to_suit(BUDGET);
        let wanted = 3f64.sqrt() / PER_DIAMETER;
        assert!((f64::from(length.unwrap()) / wanted - 1.0).abs() < 1e-6, "{length:?} {wanted}");
        let longest = edge_lengths(&room.objects[0]).into_iter().fold(0.0, f64::max);
        assert!(longest <= 3f64.sqrt() / 64.0);
        // What is as fine already stays as it is.
        let fine = room.objects.clone();
        assert_eq!((room.tessellate_to_suit(BUDGET).0, room.objects), (None, fine));
        let mut nothing = builder(Vec::new());
        assert_eq!(nothing.tessellate_to_suit(BUDGET).0, None);
        assert_eq!(
            builder(vec![mesh("point", &[[0.0; 3]; 3], &[[0, 1, 2]])]).tessellate_to_suit(BUDGET).0,
            None
        );
    }

    #[test]
    fn lengths_turn_with_the_scene() {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.3);
        // Long and thin, where a box depends on the axes most.
        let room = |turn: glam::DQuat| {
            let mut objects = vec![cube(), tetrahedron()];
            for position in objects.iter_mut().flat_map(|object| &mut object.positions) {
                *position = (turn * (position.as_dvec3() * glam::DVec3::new(9.0, 1.1, 1.3))).as_vec3();
            }
            let mut room = builder(objects);
            let length = f64::from(room.tessellate_to_suit(BUDGET).0.unwrap());
            (length, room.face_count() as f64)
        };
        let (as_given, turned) = (room(glam::DQuat::IDENTITY), room(turn));
        assert!((turned.0 / as_given.0 - 1.0).abs() < 1e-5, "{turned:?} {as_given:?}");
        assert!((turned.1 / as_given.1 - 1.0).abs() < 0.01, "{turned:?} {as_given:?}");
    }

    #[test]
    fn a_room_on_a_wide_plane_is_as_fine_as_without() {
        let mut room = cube();
        room = tessellated(room, 0.3);
        let plane = mesh("plane", &[[-1e3, -1.0, -1e3], [1e3, -1.0, -1e3], [0.0, -1.0, 1e3]], &[[0, 2, 1]]);
        let mut alone = builder(vec![room.clone()]);
        let mut both = builder(vec![room, plane]);
        let ([(a, _), (b, _)], objects) =
            ([alone.tessellate_to_suit(BUDGET), both.tessellate_to_suit(BUDGET)], &both.objects);
        assert_eq!(a, b);
        assert_eq!(objects[0], alone.objects[0]);
        assert!((100..40_000).contains(&objects[1].faces.len()), "{}", objects[1].faces.len());
        // What met along edges still does.
        let mut edges = BTreeSet::new();
        for [x, y, z] in triangles(&objects[1]) {
            edges.extend([(x, y), (y, z), (z, x)].map(|(p, q)| (bits(p), bits(q))));
        }
        let open = edges.iter().filter(|(p, q)| !edges.contains(&(*q, *p))).count();
        assert!(open < objects[1].faces.len() / 4, "{open}");
    }

    #[test]
    fn budgets_are_kept_and_scale_does_not_matter() {
        let stacked = |scale: f32, budget| {
            let sheet = |i: i32| {
                let mut sheet = cube();
                sheet
                    .positions
                    .iter_mut()
                    .for_each(|p| *p = (*p + Vec3::new(0.0, 0.0, 0.01 * i as f32)) * scale);
                sheet
            };
            let mut many = builder((0..40).map(sheet).collect());
            many.tessellate_to_suit(budget);
            many.face_count()
        };
        for budget in [10_000, 100_000] {
            let n = stacked(1.0, budget);
            let most = 2 * u64::from(budget);
            assert!((most / 4..=most + 480).contains(&n), "{n} triangles for {budget} vertices");
            assert_eq!(stacked(1024.0, budget), n);
        }
    }

    #[test]
    fn what_build_drops_or_refuses_is_left_alone() {
        let mut broken = cube();
        broken.positions.extend([Vec3::NAN, Vec3::ZERO, Vec3::ZERO]);
        broken.faces.extend(mesh("", &[], &[[0, 1, 8], [9, 10, 1], [0, 99, 2], [0, 0, 1]]).faces);
        let fine = tessellated(broken.clone(), 0.2);
        let sound = tessellated(cube(), 0.2);
        assert_eq!(fine.faces.len(), sound.faces.len() + 4);
        assert_eq!(fine.faces[sound.faces.len()..], broken.faces[12..]);
        assert!(
            (0..sound.faces.len()).all(|f| fine.corners(&fine.faces[f]) == sound.corners(&sound.faces[f]))
        );
        let mut short = cube();
        short.uvs = vec![Vec2::ZERO];
        assert_eq!(tessellated(short.clone(), 0.2), short);
        let mut nothing = SceneBuilder::default();
        assert!(nothing.tessellate(0.1).unwrap().is_empty());
    }

    #[test]
    fn edges_without_a_number_between_their_ends_stay() {
        let far = 16_777_216.0;
        let mut fine = mesh("far", &[[far, 0.0, 0.0], [far + 2.0, 0.0, 0.0], [far, 3.0, 0.0]], &[[0, 1, 2]]);
        // As part of a wide scene, which keeps its origin.
        Rule { length: EdgeLength::Uniform(0.5), smallest_area: 0.0 }.split(
            &mut fine,
            &[],
            &mut Warnings::default(),
        );
        // Up and down there is room for halves; along x the next number after `far` is 2 away.
        assert!((6..1000).contains(&fine.faces.len()), "{}", fine.faces.len());
        assert!(fine.positions.iter().all(|p| p.x == far || p.x == far + 2.0));
    }

    #[test]
    fn huge_and_tiny_scenes_are_split_alike() {
        for scale in [1e-15, 1.0, 1e15] {
            let mut object = tetrahedron();
            object.positions.iter_mut().for_each(|p| *p *= scale);
            let fine = tessellated(object, 0.1 * scale);
            assert!((1500..4000).contains(&fine.faces.len()), "{scale}: {}", fine.faces.len());
        }
    }
}
