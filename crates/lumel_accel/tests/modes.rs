//! Every way to trace a ray, on every instruction set of this machine, against brute force.

#![allow(clippy::print_stdout, reason = "says which instruction sets were tested")]

use glam::Vec3;
use lumel_accel::{BruteForce, Bundle, Bvh, Hit, InstructionSet, Ray, RayTracer};
use lumel_sample::{Dim, Sampler, StreamKey};
use lumel_scene::TriId;

/// Reproducible numbers in `0..1`.
struct Numbers(StreamKey, u32);

impl Numbers {
    fn new(seed: u64) -> Self {
        Self(StreamKey::new(seed), 0)
    }

    fn next(&mut self) -> f32 {
        self.1 += 1;
        Sampler::Random.sample_2d(self.0, self.1, Dim::Area)[0]
    }

    /// In `-1..1` per axis.
    fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - Vec3::ONE
    }
}

/// The same tree for every instruction set.
fn trees(corners: &[[Vec3; 3]]) -> Vec<Bvh> {
    let tree = Bvh::from_corners(corners.to_vec());
    let available = InstructionSet::available();
    println!("tested with {available:?}");
    available.into_iter().filter_map(|set| tree.clone().with_instructions(set)).collect()
}

/// Traces rays from one origin in all ways; returns how many hit something.
fn assert_bundle(name: &str, corners: &[[Vec3; 3]], trees: &[Bvh], bundle: &Bundle<'_>) -> usize {
    let brute = BruteForce::from_corners(corners.to_vec());
    let n = bundle.directions.len();
    let rays: Vec<Ray> = (0..n).map(|i| bundle.ray(i)).collect();
    let expected: Vec<Option<Hit>> = rays.iter().map(|ray| brute.closest_hit(ray)).collect();
    for tree in trees {
        let set = tree.instructions();
        let (mut together, mut apart, mut blocked) = (vec![None; n], vec![None; n], vec![false; n]);
        tree.closest_hits(bundle, &mut together);
        tree.closest_hits_of(&rays, &mut apart);
        tree.occlusions(bundle, &mut blocked);
        for i in 0..n {
            let (ray, expected) = (&rays[i], expected[i]);
            assert_eq!(tree.closest_hit(ray), expected, "{name}, {set}, alone: {ray:?}");
            assert_eq!(together[i], expected, "{name}, {set}, together: {ray:?}");
            assert_eq!(apart[i], expected, "{name}, {set}, apart: {ray:?}");
            assert_eq!(tree.occluded(ray), expected.is_some(), "{name}, {set}, shadow: {ray:?}");
            assert_eq!(blocked[i], expected.is_some(), "{name}, {set}, shaft: {ray:?}");
        }
    }
    expected.iter().flatten().count()
}

/// Directions around one another, in all densities from a pencil to all around; a quarter are the middle one itself.
fn directions(numbers: &mut Numbers, around: Vec3, n: usize) -> Vec<Vec3> {
    let width = numbers.next().powi(3) * 2.0 * around.length().max(f32::MIN_POSITIVE);
    (0..n).map(|i| if i % 4 == 0 { around } else { around + numbers.point() * width }).collect()
}

/// Bundles from random origins towards triangles; checks that the comparison means something.
fn assert_all_ways(name: &str, corners: &[[Vec3; 3]], n_bundles: usize) {
    let trees = trees(corners);
    let mut numbers = Numbers::new(name.len() as u64);
    let all = corners.as_flattened();
    let (min, max) = all.iter().fold((all[0], all[0]), |(min, max), p| (min.min(*p), max.max(*p)));
    let (center, half) = (0.5 * min + 0.5 * max, (0.5 * max - 0.5 * min).max_element());
    let mut n_hits = 0;
    for k in 0..n_bundles {
        let [a, b, c] = corners[(numbers.next() * corners.len() as f32) as usize % corners.len()];
        let origin = center + numbers.point() * half * 1.3;
        let (s, t) = (numbers.next(), numbers.next());
        let target = match k % 4 {
            0 => a,
            1 => a.lerp(b, s),
            2 => (a + b + c) / 3.0,
            _ => a.lerp(b, s).lerp(c, t),
        };
        let count = [1, 3, 16, 17, 64, 100, 257][k % 7];
        let directions = directions(&mut numbers, target - origin, count);
        let t_max = if k % 3 == 0 { 1.0 + numbers.next() } else { f32::INFINITY };
        let skip = (k % 5 == 0).then(|| TriId((numbers.next() * corners.len() as f32) as u32));
        let bundle = Bundle { origin, directions: &directions, t_max, skip };
        n_hits += assert_bundle(name, corners, &trees, &bundle);
    }
    assert!(n_hits > n_bundles, "{name}: only {n_hits} hits in {n_bundles} bundles");
}

fn soup(n: usize, size: f32, seed: u64) -> Vec<[Vec3; 3]> {
    let mut numbers = Numbers::new(seed);
    let mut triangle = || {
        let center = numbers.point();
        [(); 3].map(|()| center + numbers.point() * size)
    };
    (0..n).map(|_| triangle()).collect()
}

fn placed(corners: &[[Vec3; 3]], scale: f32, shift: Vec3) -> Vec<[Vec3; 3]> {
    corners.iter().map(|t| t.map(|p| p * scale + shift)).collect()
}

#[test]
fn random_triangles_of_all_sizes_are_met_alike() {
    assert_all_ways("small", &soup(1500, 0.05, 1), 140);
    assert_all_ways("large", &soup(60, 1.0, 2), 140);
    assert_all_ways("few", &soup(5, 0.8, 3), 70);
}

#[test]
fn scales_and_places_do_not_matter() {
    let corners = soup(600, 0.1, 4);
    assert_all_ways("tiny", &placed(&corners, 1e-6, Vec3::ZERO), 70);
    assert_all_ways("huge", &placed(&corners, 1e6, Vec3::ZERO), 70);
    assert_all_ways("far away", &placed(&corners, 1.0, Vec3::new(1e3, -5e2, 2e3)), 70);
    assert_all_ways("small and far away", &placed(&corners, 0.01, Vec3::splat(300.0)), 70);
}

#[test]
fn needles_are_met_alike() {
    let mut numbers = Numbers::new(5);
    let mut needle = || {
        let (from, to) = (numbers.point(), numbers.point());
        [from, to, to + numbers.point() * 1e-5]
    };
    let corners: Vec<_> = (0..400).map(|_| needle()).collect();
    // Nearly nothing meets a needle but what is aimed at it.
    assert_all_ways("needles", &corners, 140);
}

/// Squares of two triangles, three layers of them in one plane.
fn coplanar() -> Vec<[Vec3; 3]> {
    let at = |x: i32, z: i32| Vec3::new(x as f32, 0.0, z as f32);
    let cells = (0..10).flat_map(|x| (0..10).map(move |z| (x, z)));
    let grid = cells.flat_map(|(x, z)| {
        [[at(x, z), at(x, z + 1), at(x + 1, z)], [at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)]]
    });
    let grid: Vec<_> = grid.collect();
    let big = [[at(0, 0), at(0, 10), at(10, 0)], [at(10, 0), at(0, 10), at(10, 10)]];
    grid.iter().chain(&big).chain(&grid).copied().collect()
}

#[test]
fn of_coplanar_triangles_the_lowest_is_met() {
    let corners = coplanar();
    let trees = trees(&corners);
    // Straight down, where the distance is exact: a tie of three.
    let directions = vec![-Vec3::Y; 40];
    for origin in [Vec3::new(3.25, 2.0, 4.25), Vec3::new(5.0, 1.0, 5.0), Vec3::new(2.0, 3.0, 7.5)] {
        let bundle = Bundle { origin, directions: &directions, t_max: f32::INFINITY, skip: None };
        assert_eq!(assert_bundle("coplanar", &corners, &trees, &bundle), 40);
    }
    // Aslant, with a square's corner and edges among the targets.
    let mut numbers = Numbers::new(8);
    for _ in 0..60 {
        let origin = Vec3::new(numbers.next() * 10.0, 1.0 + numbers.next(), numbers.next() * 10.0);
        let target = |n: &mut Numbers| {
            Vec3::new((n.next() * 20.0).round() / 2.0, 0.0, (n.next() * 20.0).round() / 2.0)
        };
        let directions: Vec<Vec3> = (0..64).map(|_| target(&mut numbers) - origin).collect();
        let bundle = Bundle { origin, directions: &directions, t_max: 2.0, skip: None };
        let brute = BruteForce::from_corners(corners.clone());
        for tree in &trees {
            let (mut hits, mut blocked) = (vec![None; 64], vec![false; 64]);
            tree.closest_hits(&bundle, &mut hits);
            tree.occlusions(&bundle, &mut blocked);
            for (i, hit) in hits.iter().enumerate() {
                let expected = brute.closest_hit(&bundle.ray(i));
                assert_eq!(*hit, expected, "{}: {:?}", tree.instructions(), bundle.ray(i));
                assert_eq!(blocked[i], expected.is_some());
            }
        }
    }
}

#[test]
fn a_million_copies_of_one_triangle_are_one_hit() {
    let corners = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1_000_000];
    let tree = Bvh::from_corners(corners);
    let directions: Vec<Vec3> = (0..20).map(|i| Vec3::new(0.01 * i as f32, 0.2, -1.0)).collect();
    let bundle = Bundle {
        origin: Vec3::new(0.1, 0.1, 1.0),
        directions: &directions,
        t_max: f32::INFINITY,
        skip: Some(TriId(0)),
    };
    for set in InstructionSet::available() {
        let Some(tree) = tree.clone().with_instructions(set) else { continue };
        let mut hits = vec![None; 20];
        tree.closest_hits(&bundle, &mut hits);
        assert!(hits.iter().all(|hit| hit.is_some_and(|h| h.at.tri == TriId(1) && h.t == 1.0)), "{set}");
    }
}

#[test]
fn rays_that_cannot_be_traced_meet_nothing_and_disturb_nobody() {
    let corners = soup(300, 0.7, 9);
    let trees = trees(&corners);
    let mut numbers = Numbers::new(10);
    let mut directions = directions(&mut numbers, Vec3::X, 70);
    for (i, bad) in [(0, Vec3::ZERO), (7, Vec3::NAN), (20, Vec3::INFINITY), (69, Vec3::X * 1e-42)] {
        directions[i] = bad;
    }
    let bundle = Bundle {
        origin: Vec3::new(-1.5, 0.0, 0.0),
        directions: &directions,
        t_max: f32::INFINITY,
        skip: None,
    };
    assert!(assert_bundle("bad directions", &corners, &trees, &bundle) > 30);
    let nowhere = Bundle { origin: Vec3::NAN, ..bundle };
    assert_eq!(assert_bundle("no origin", &corners, &trees, &nowhere), 0);
    let empty = [];
    let nothing = Bundle { directions: &empty, ..bundle };
    assert_eq!(assert_bundle("no rays", &corners, &trees, &nothing), 0);
    let none: Vec<[Vec3; 3]> = Vec::new();
    let of_nothing = crate::trees(&none);
    assert_eq!(assert_bundle("no triangles", &none, &of_nothing, &bundle), 0);
}

#[test]
fn rays_apart_are_their_own() {
    let corners = soup(800, 0.3, 11);
    let brute = BruteForce::from_corners(corners.clone());
    let mut numbers = Numbers::new(12);
    // Neighbours that go the same way, then a crowd that does not; each skips another triangle.
    let mut rays: Vec<Ray> = Vec::new();
    for group in 0..60u32 {
        let start = numbers.point() * 1.5;
        let towards = corners[group as usize][0] - start;
        let spread = if group % 3 == 0 { 1.0 } else { 0.05 };
        for lane in 0..19 {
            let origin = start + numbers.point() * spread;
            let t_max = if lane % 4 == 0 { 0.7 } else { f32::INFINITY };
            let mut ray = Ray { origin, direction: towards + numbers.point() * spread, t_max, skip: None };
            if lane % 2 == 0 {
                ray.skip = brute.closest_hit(&ray).map(|hit| hit.at.tri);
            }
            rays.push(ray);
        }
    }
    let expected: Vec<_> = rays.iter().map(|ray| brute.closest_hit(ray)).collect();
    assert!(expected.iter().flatten().count() > 300);
    for tree in trees(&corners) {
        let mut hits = vec![None; rays.len()];
        tree.closest_hits_of(&rays, &mut hits);
        for (i, hit) in hits.iter().enumerate() {
            assert_eq!(*hit, expected[i], "{}: {:?}", tree.instructions(), rays[i]);
        }
    }
}
