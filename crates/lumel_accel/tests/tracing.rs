//! The hierarchy against brute force, and rays aimed where tracers leak.

use glam::Vec3;
use lumel_accel::{BruteForce, Bundle, Bvh, Ray, RayTracer};
use lumel_sample::{Dim, Sampler, StreamKey};
use lumel_scene::{FaceSide, RayOrigins, TriId};

/// Reproducible numbers in `0..1`.
struct Numbers {
    key: StreamKey,
    index: u32,
}

impl Numbers {
    fn new(seed: u64) -> Self {
        Self { key: StreamKey::new(seed), index: 0 }
    }

    fn next(&mut self) -> f32 {
        self.index += 1;
        Sampler::Random.sample_2d(self.key, self.index, Dim::Area)[0]
    }

    /// In `-1..1` per axis.
    fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - Vec3::ONE
    }

    fn triangle(&mut self, size: f32) -> [Vec3; 3] {
        let center = self.point();
        [(); 3].map(|()| center + self.point() * size)
    }
}

/// A sphere of `20 * 4^level` triangles seen from outside, with its vertices and edges.
fn icosphere(level: u32) -> Vec<[Vec3; 3]> {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let v = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
    .map(|p| Vec3::from_array(p).normalize());
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    let mut triangles: Vec<[Vec3; 3]> = faces.iter().map(|f| f.map(|i: usize| v[i])).collect();
    for _ in 0..level {
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                // The sum does not depend on the order of its terms, so neighbours agree on the bits.
                let mid = |p: Vec3, q: Vec3| (p + q).normalize();
                let (ab, bc, ca) = (mid(a, b), mid(b, c), mid(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    triangles
}

fn assert_same_hits(name: &str, corners: &[[Vec3; 3]], rays: impl Iterator<Item = Ray>) -> usize {
    let bvh = Bvh::from_corners(corners.to_vec());
    let brute = BruteForce::from_corners(corners.to_vec());
    let mut n_hits = 0;
    for ray in rays {
        let expected = brute.closest_hit(&ray);
        assert_eq!(bvh.closest_hit(&ray), expected, "{name}: {ray:?}");
        assert_eq!(bvh.occluded(&ray), expected.is_some(), "{name}: {ray:?}");
        n_hits += usize::from(expected.is_some());
    }
    n_hits
}

#[test]
fn the_hierarchy_returns_the_hits_of_brute_force() {
    for (size, scale, shift) in [(0.1f32, 1.0, 0.0), (0.5, 1e-6, 0.0), (0.02, 1e6, 0.0), (0.1, 1.0, 1000.0)] {
        let mut numbers = Numbers::new(size.to_bits().into());
        let place = |p: Vec3| p * scale + Vec3::splat(shift);
        let corners: Vec<_> = (0..700).map(|_| numbers.triangle(size).map(place)).collect();
        let rays = (0..3000).map(|i| {
            let origin = place(numbers.point() * 1.5);
            let [a, b, c] = corners[i % corners.len()];
            let mut ray = Ray::between(origin, (a + b + c) / 3.0 + numbers.point() * (0.3 * size * scale));
            if i % 2 == 0 {
                ray.t_max = f32::INFINITY;
            }
            ray
        });
        let n_hits = assert_same_hits("soup", &corners, rays.collect::<Vec<_>>().into_iter());
        assert!(n_hits > 1000, "only {n_hits} of 3000 rays hit anything: the comparison means little");
    }
}

#[test]
fn ties_go_to_the_lowest_triangle() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    // Copies of one triangle, more than a leaf holds; their order in the tree is arbitrary.
    let corners = vec![triangle; 1000];
    let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
    let bvh = Bvh::from_corners(corners);
    assert_eq!(bvh.closest_hit(&ray).unwrap().at.tri, TriId(0));
    assert_eq!(bvh.closest_hit(&ray.skipping(TriId(0))).unwrap().at.tri, TriId(1));
}

#[test]
fn an_empty_scene_and_a_single_triangle_are_fine() {
    let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
    assert!(Bvh::from_corners(vec![]).closest_hit(&ray).is_none());
    assert!(!Bvh::from_corners(vec![]).occluded(&ray));
    let one = Bvh::from_corners(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let hit = one.closest_hit(&ray).unwrap();
    assert_eq!((hit.t, hit.side), (1.0, FaceSide::Front));
    assert!(one.occluded(&ray) && !one.occluded(&Ray { t_max: 1.0, ..ray }));
    assert!(!one.occluded(&ray.skipping(TriId(0))));
    let not_finite = Bvh::from_corners(vec![[Vec3::NAN, Vec3::X, Vec3::Y]]);
    assert!(not_finite.closest_hit(&ray).is_none());
}

#[test]
fn rays_along_the_axes_and_in_the_plane_of_a_box_side_agree_with_brute_force() {
    // A grid in the plane y = 0: all boxes are flat, and axis-parallel rays run in their sides.
    let at = |x: i32, z: i32| Vec3::new(x as f32, 0.0, z as f32);
    let corners: Vec<_> = (0..12)
        .flat_map(|x| (0..12).map(move |z| (x, z)))
        .flat_map(|(x, z)| {
            [[at(x, z), at(x, z + 1), at(x + 1, z)], [at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)]]
        })
        .collect();
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let rays = axes.into_iter().flat_map(|d| {
        let origins =
            [[3.0, 1.0, 4.0], [3.5, -1.0, 4.5], [0.0, 1.0, 0.0], [-1.0, 0.0, 3.0], [12.0, 2.0, 12.0]];
        origins.map(|o| Ray::new(Vec3::from_array(o), d))
    });
    assert_eq!(assert_same_hits("grid", &corners, rays), 4);
}

#[test]
fn nothing_leaks_through_the_edges_and_vertices_of_a_closed_mesh() {
    for shift in [0.0, 10.0] {
        let shift = Vec3::new(shift, -0.5 * shift, 0.25 * shift);
        let corners: Vec<_> = icosphere(4).into_iter().map(|t| t.map(|p| p + shift)).collect();
        let bvh = Bvh::from_corners(corners.clone());
        let mut numbers = Numbers::new(5);
        let (mut n, mut n_missed) = (0, 0);
        for corner in corners.iter().cycle().take(100_000) {
            let [a, b, c] = *corner;
            let s = numbers.next();
            let target = match n % 4 {
                0 => a,
                1 => a.lerp(b, s),
                2 => b.lerp(c, 0.5),
                _ => c.lerp(a, s),
            };
            let ray = Ray::new(shift + numbers.point() * 0.3, Vec3::ZERO);
            let ray = Ray { direction: target - ray.origin, ..ray };
            n += 1;
            n_missed += usize::from(bvh.closest_hit(&ray).is_none());
        }
        assert_eq!(n_missed, 0, "of {n} rays at edges and vertices, shifted by {shift}");
    }
}

#[test]
fn the_inside_of_a_closed_mesh_shows_its_back() {
    let bvh = Bvh::from_corners(icosphere(2));
    let mut numbers = Numbers::new(9);
    for _ in 0..2000 {
        let direction = numbers.point();
        assert_eq!(bvh.closest_hit(&Ray::new(Vec3::ZERO, direction)).unwrap().side, FaceSide::Back);
        let outside = Ray::new(direction.normalize() * 3.0, -direction);
        assert_eq!(bvh.closest_hit(&outside).unwrap().side, FaceSide::Front);
    }
}

#[test]
fn offset_origins_never_meet_their_own_triangle() {
    let mut numbers = Numbers::new(21);
    for i in 0..100_000 {
        let magnitude = 10f32.powi(i % 10 - 3);
        let base = numbers.point() * magnitude;
        let corners = [(); 3].map(|()| base + numbers.point() * magnitude);
        let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize() else {
            continue;
        };
        let (u, v) = (numbers.next(), numbers.next());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let direction = numbers.point().normalize();
        // Needles have an offset of their own, which bounds no error.
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        if area < 0.1 * magnitude * magnitude {
            continue;
        }
        let [a, b, c] = corners;
        let side = if direction.dot(normal) > 0.0 { [a, b, c] } else { [b, a, c] };
        let weights = if direction.dot(normal) > 0.0 { [u, v, 1.0 - u - v] } else { [v, u, 1.0 - u - v] };
        let origin = RayOrigins::new(side).at(weights);
        let tracer = BruteForce::from_corners(vec![corners]);
        assert!(!tracer.occluded(&Ray::new(origin, direction)), "{corners:?} {origin} {direction}");
    }
}

#[test]
fn triangles_that_shrink_again_and_again_do_not_overflow_the_stack() {
    // Each is a tenth of the one before: every split cuts off one, which makes a list of the tree.
    let shrinking = |i: i32| {
        let size = 10f32.powf(-0.2 * i as f32);
        [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| (p + Vec3::new(1.0, 1.0, 0.5)) * size)
    };
    let corners: Vec<_> = (0..190).flat_map(|i| std::iter::repeat_n(shrinking(i), 9)).collect();
    let mut numbers = Numbers::new(3);
    let rays: Vec<Ray> = (0..500i32)
        .map(|i| {
            let corners = shrinking(i % 190);
            let target = (corners[0] + corners[1] + corners[2]) / 3.0;
            // From beside the triangle: distances of its own size.
            let ray = Ray::between(target + numbers.point() * corners[1].x, target);
            Ray { t_max: 2.0, ..ray }
        })
        .collect();
    assert!(assert_same_hits("shrinking", &corners, rays.into_iter()) > 100);
}

#[test]
fn bundles_are_their_rays() {
    let bvh = Bvh::from_corners(icosphere(3));
    let mut numbers = Numbers::new(33);
    let directions: Vec<Vec3> = (0..300).map(|_| numbers.point()).collect();
    let bundle = Bundle {
        origin: Vec3::new(0.9, 0.8, 0.1),
        directions: &directions,
        t_max: 1.5,
        skip: Some(TriId(7)),
    };
    let mut hits = vec![None; 300];
    let mut occluded = vec![false; 300];
    bvh.closest_hits(&bundle, &mut hits);
    bvh.occlusions(&bundle, &mut occluded);
    for i in 0..300 {
        assert_eq!(hits[i], bvh.closest_hit(&bundle.ray(i)));
        assert_eq!(occluded[i], hits[i].is_some());
    }
    assert!(hits.iter().any(Option::is_some) && hits.iter().any(Option::is_none));
}

#[test]
fn the_tree_is_small_and_does_not_depend_on_the_number_of_threads() {
    let corners = icosphere(6);
    let n = corners.len();
    let describe = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| format!("{:?}", Bvh::from_corners(corners.clone())))
    };
    assert_eq!(describe(1), describe(3));
    assert!(Bvh::from_corners(corners.clone()).node_count() < n);
}
