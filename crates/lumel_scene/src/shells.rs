//! Surfaces that enclose a solid.

use crate::face_list::FaceList;
use crate::weld::{Weld, sorted_by_number};
use crate::{Scene, TriId};
use glam::DVec3;

/// A shell whose volume is less than this share of what its area could enclose is a sheet with two sides.
const LEAST_VOLUME: f64 = 1e-4;

/// A cube without one face lacks a fifth of its area; half a sphere, half; a sheet, all of it.
const MAX_OPENING: f64 = 0.5;

impl Scene {
    /// Whether a triangle belongs to a closed shell: who sees its back is inside a solid, or outside a room.
    ///
    /// A shell is what hangs together by edges, whichever objects it is made of. It is closed if each of its edges is passed
    /// as often in the one direction as in the other. Two-sided triangles have no back and bound nothing.
    pub fn bounds_solid(&self, tri: TriId) -> bool {
        let shells = self.shells();
        !self.is_two_sided(tri) && shells.all[shells.of(self.traced(tri))].is_closed()
    }

    /// The triangle that stands for the shell of another one: the same for all of a shell.
    pub fn shell(&self, tri: TriId) -> TriId {
        TriId(self.shells().of(self.traced(tri)) as u32)
    }

    /// Whether two triangles belong to one shell.
    pub fn hang_together(&self, a: TriId, b: TriId) -> bool {
        self.shell(a) == self.shell(b)
    }
}

/// The shells of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Shells {
    /// By traced triangle: the triangle that stands for its shell.
    of: Vec<u32>,
    /// By the triangle that stands for it.
    all: Vec<Shell>,
}

impl Shells {
    pub(crate) fn of_faces(faces: &FaceList) -> Self {
        let mut weld = Weld::default();
        let points: Vec<u32> = faces.positions.iter().map(|p| weld.number(*p)).collect();
        let mut edges = Vec::with_capacity(3 * faces.traced);
        for tri in 0..faces.traced {
            let [a, b, c] = faces.triangles[tri].map(|vertex| points[vertex as usize]);
            let edge =
                |(from, to): (u32, u32)| Edge { ends: (from.min(to), from.max(to)), forward: from < to, tri };
            edges.extend([(a, b), (b, c), (c, a)].map(edge));
        }
        let edges = sorted_by_number(&edges, weld.len(), |edge: &Edge| edge.ends.1);
        let edges = sorted_by_number(&edges, weld.len(), |edge| edge.ends.0);
        let mut forest = Forest::new(faces.traced);
        for edge in edges.chunk_by(|a, b| a.ends == b.ends) {
            edge.windows(2).for_each(|pair| forest.join(pair[0].tri, pair[1].tri));
        }
        let of: Vec<u32> = (0..faces.traced).map(|tri| forest.of(tri) as u32).collect();
        let mut all = vec![Shell::default(); faces.traced];
        let is_one_sided = |tri: usize| faces.other_side[tri].index() == tri;
        for edge in edges.chunk_by(|a, b| a.ends == b.ends) {
            let one_sided = || edge.iter().filter(|edge| is_one_sided(edge.tri));
            let (n, forward) = (one_sided().count(), one_sided().filter(|edge| edge.forward).count());
            let shell = &mut all[of[edge[0].tri] as usize];
            shell.is_open |= 2 * forward != n;
            shell.is_twisted |= (2 * forward).abs_diff(n) > 1;
        }
        for tri in (0..faces.traced).filter(|tri| is_one_sided(*tri)) {
            let corners = faces.triangles[tri].map(|vertex| faces.positions[vertex as usize]);
            all[of[tri] as usize].add(corners.map(|p| p.as_dvec3()));
        }
        Self { of, all }
    }

    fn of(&self, tri: TriId) -> usize {
        self.of[tri.index()] as usize
    }

    /// Whether a traced triangle belongs to a shell of which one side is inside: a closed one, or one of one piece that lacks
    /// only as much as a box without bottom or a room without a wall.
    pub(crate) fn has_inside(&self, tri: usize) -> bool {
        self.all[self.of[tri] as usize].has_inside()
    }
}

/// A side of a triangle between two points.
#[derive(Clone, Copy)]
struct Edge {
    ends: (u32, u32),
    forward: bool,
    tri: usize,
}

/// Triangles that hang together.
#[derive(Clone, Copy, Debug, Default)]
struct Shell {
    /// Whether some edge is passed more often in one direction than in the other.
    is_open: bool,
    /// Whether neighbours face different ways somewhere.
    is_twisted: bool,
    /// Negative where the lit side is inside, m³.
    volume: f64,
    /// m².
    area: f64,
    /// The sum of all areas times normals, m²: what the faces that lack would have to cancel.
    opening: DVec3,
}

impl Shell {
    fn add(&mut self, [a, b, c]: [DVec3; 3]) {
        let area = 0.5 * (b - a).cross(c - a);
        self.volume += a.dot(b.cross(c)) / 6.0;
        self.area += area.length();
        self.opening += area;
    }

    fn is_closed(&self) -> bool {
        !self.is_open && self.volume.abs() > LEAST_VOLUME * self.area.powf(1.5)
    }

    fn has_inside(&self) -> bool {
        self.is_closed()
            || self.is_open && !self.is_twisted && self.opening.length() < MAX_OPENING * self.area
    }
}

/// Triangles that hang together: a forest in which each points towards the one that stands for all.
struct Forest(Vec<u32>);

impl Forest {
    fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    fn of(&mut self, mut tri: usize) -> usize {
        while self.0[tri] as usize != tri {
            self.0[tri] = self.0[self.0[tri] as usize];
            tri = self.0[tri] as usize;
        }
        tri
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b)] = a.min(b) as u32;
    }
}

#[cfg(test)]
mod tests {
    use crate::{Material, MaterialId, Radiance, Scene, SceneBuilder, Sides, TriId};
    use glam::{EulerRot, Quat, Vec3};

    const FACES: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

    fn corners(at: Vec3) -> impl Iterator<Item = Vec3> {
        let turn = Quat::from_euler(EulerRot::XYZ, 0.3, 0.5, 0.7);
        (0..8).map(move |i| at + turn * Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32))
    }

    fn triangles(quads: &[[u32; 4]]) -> Vec<[u32; 3]> {
        quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
    }

    fn built(fill: impl FnOnce(&mut SceneBuilder, MaterialId)) -> Scene {
        let mut builder = SceneBuilder::new("shells");
        let material = builder.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
        fill(&mut builder, material);
        builder.build().unwrap().0
    }

    fn solid(scene: &Scene) -> Vec<bool> {
        (0..scene.triangle_count() as u32).map(|tri| scene.bounds_solid(TriId(tri))).collect()
    }

    #[test]
    fn boxes_and_rooms_are_closed_and_one_without_a_lid_is_not() {
        for flip in [false, true] {
            let scene = built(|builder, material| {
                let turned = |mut t: [u32; 3]| {
                    if flip {
                        t.swap(0, 1)
                    }
                    t
                };
                builder.add_mesh(
                    "box",
                    corners(Vec3::ZERO),
                    triangles(&FACES).into_iter().map(turned),
                    material,
                );
                let lidless = triangles(&FACES[..5]).into_iter().map(turned);
                builder.add_mesh("lidless", corners(Vec3::X * 5.0), lidless, material);
            });
            assert_eq!(solid(&scene), [[true; 10].as_slice(), &[true; 2], &[false; 10]].concat());
        }
    }

    #[test]
    fn where_the_file_does_not_say_it_sheets_have_two_sides_and_boxes_one() {
        let mut builder = SceneBuilder::new("shapes");
        let shape = |name| Material { sides: Sides::Shape, ..Material::diffuse(name, Vec3::splat(0.5)) };
        let grey = builder.add_material(shape("grey"));
        let lamp = builder.add_material(Material { emission: Radiance::splat(1.0), ..shape("lamp") });
        let mut mixed = triangles(&FACES[..5]);
        mixed[3].swap(0, 1);
        let objects = [
            ("box", triangles(&FACES), grey, false),
            ("lidless box", triangles(&FACES[..5]), grey, false),
            ("corner", triangles(&[FACES[0], FACES[2]]), grey, true),
            ("sheet", triangles(&FACES[..1]), grey, true),
            ("lamp", triangles(&FACES[..1]), lamp, false),
            ("mixed up", mixed, grey, true),
        ];
        for (n, (name, triangles, material, _)) in objects.iter().enumerate() {
            builder.add_mesh(*name, corners(Vec3::X * 5.0 * n as f32), triangles.clone(), *material);
        }
        let (scene, _) = builder.build().unwrap();
        for tri in (0..scene.traced_count() as u32).map(TriId) {
            let (name, .., two_sided) = &objects[scene.object_id(tri).index()];
            assert_eq!(scene.is_two_sided(tri), *two_sided, "{name}");
        }
    }

    #[test]
    fn the_sides_of_a_shell_may_be_objects_of_their_own() {
        let scene = built(|builder, material| {
            for face in FACES {
                builder.add_mesh("side", corners(Vec3::ONE), triangles(&[face]), material);
            }
        });
        assert_eq!(solid(&scene), [true; 12]);
    }

    #[test]
    fn sheets_with_two_sides_and_mixed_windings_enclose_nothing() {
        let scene = built(|builder, material| {
            let sheet = [Vec3::ZERO, Vec3::X, Vec3::Y];
            builder.add_mesh("sheet", sheet, [[0, 1, 2]], material);
            builder.add_mesh("back", sheet, [[0, 2, 1]], material);
            let mut mixed = triangles(&FACES);
            mixed[0].swap(0, 1);
            builder.add_mesh("mixed", corners(Vec3::X * 5.0), mixed, material);
            let both = builder.add_material(Material::diffuse("both", Vec3::ONE).two_sided());
            builder.add_mesh("two-sided", corners(Vec3::Y * 5.0), triangles(&FACES), both);
        });
        assert!(!solid(&scene).contains(&true));
    }
}
