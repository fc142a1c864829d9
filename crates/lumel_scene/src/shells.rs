//! Surfaces that enclose a solid.

use crate::face_list::FaceList;
use crate::weld::Weld;
use crate::{Scene, TriId, triangle};

/// A shell whose volume is less than this share of what its area could enclose is a sheet with two sides.
const LEAST_VOLUME: f64 = 1e-4;

impl Scene {
    /// Whether a triangle belongs to a closed shell: who sees its back is inside a solid, or outside a room.
    ///
    /// A shell is what hangs together by edges, whichever objects it is made of. It is closed if each of its edges is passed
    /// as often in the one direction as in the other. Two-sided triangles have no back and belong to none.
    pub fn bounds_solid(&self, tri: TriId) -> bool {
        self.solids()[tri.index()]
    }
}

/// Whether each triangle belongs to a closed shell.
pub(crate) fn closed(faces: &FaceList) -> Vec<bool> {
    let mut weld = Weld::default();
    let points: Vec<u32> = faces.positions.iter().map(|p| weld.number(*p)).collect();
    let is_one_sided = |tri: &usize| faces.other_side[*tri].index() == *tri;
    let mut edges: Vec<Edge> = (0..faces.triangles.len())
        .filter(is_one_sided)
        .flat_map(|tri| {
            let [a, b, c] = faces.triangles[tri].map(|vertex| points[vertex as usize]);
            [(a, b), (b, c), (c, a)].map(|(from, to)| Edge {
                ends: (from.min(to), from.max(to)),
                forward: from < to,
                tri,
            })
        })
        .collect();
    edges.sort_unstable_by_key(|edge| edge.ends);
    let mut shells = Shells::new(faces.triangles.len());
    for edge in edges.chunk_by(|a, b| a.ends == b.ends) {
        edge.windows(2).for_each(|pair| shells.join(pair[0].tri, pair[1].tri));
    }
    let mut enclosed = vec![Enclosed { is_closed: true, volume: 0.0, area: 0.0 }; faces.triangles.len()];
    for edge in edges.chunk_by(|a, b| a.ends == b.ends) {
        let forward = edge.iter().filter(|edge| edge.forward).count();
        enclosed[shells.of(edge[0].tri)].is_closed &= 2 * forward == edge.len();
    }
    for tri in (0..faces.triangles.len()).filter(is_one_sided) {
        let corners = faces.triangles[tri].map(|vertex| faces.positions[vertex as usize]);
        let shell = &mut enclosed[shells.of(tri)];
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        shell.volume += a.dot(b.cross(c)) / 6.0;
        shell.area += triangle::area(corners);
    }
    (0..faces.triangles.len()).map(|tri| is_one_sided(&tri) && enclosed[shells.of(tri)].is_solid()).collect()
}

struct Edge {
    ends: (u32, u32),
    forward: bool,
    tri: usize,
}

#[derive(Clone, Copy)]
struct Enclosed {
    is_closed: bool,
    /// Negative where the lit side is inside, m³.
    volume: f64,
    area: f64,
}

impl Enclosed {
    fn is_solid(&self) -> bool {
        self.is_closed && self.volume.abs() > LEAST_VOLUME * self.area.powf(1.5)
    }
}

/// Triangles that hang together: a forest in which each points towards the one that stands for all.
struct Shells(Vec<u32>);

impl Shells {
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
    use crate::{Material, MaterialId, Scene, SceneBuilder, TriId};
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
