//! How long edges may be, and where.

use crate::mesh::ObjectMesh;
use crate::triangle::angle;
use crate::{Face, Scene, SceneBuilder, TriId};
use glam::{DVec3, Vec3};

/// Edges per diameter of what they lie in: the shadows of a room show, and it takes seconds to bake.
///
/// A little less than 64, for diagonals that are halved six times must be short enough however they are rounded.
pub(crate) const PER_DIAMETER: f64 = 63.9;

/// Around the core of a scene, edges may be twice as long for every eighth of its diameter.
const GRADING: f64 = 8.0;

/// What is further from the middle of the core than so many mean distances does not belong to it.
const OUTSIDE_CORE: f64 = 3.0;

/// The core is known after so many rounds at most.
const MAX_ROUNDS: usize = 16;

/// The longest edge that is allowed at each place, metres.
///
/// A function of the place alone, so that triangles which share an edge agree about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EdgeLength {
    /// The same everywhere.
    Uniform(f64),
    /// Shortest in the core of the scene, and longer away from it.
    Graded {
        /// A ball.
        core: Ball,
        /// In the core, and the most anywhere.
        shortest: f64,
        longest: f64,
    },
}

/// A ball: unlike a box, it turns with the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ball {
    center: DVec3,
    radius: f64,
}

impl EdgeLength {
    /// Lengths that suit a scene: a 64th of the diameter of its core, growing to a 64th of that of all.
    ///
    /// The core is where most of its triangles are: a room on a plane of a kilometre, not the plane. For a box, it is the
    /// ball around it.
    pub(crate) fn for_scene(builder: &SceneBuilder) -> Option<Self> {
        Self::for_corners(&builder.objects.iter().flat_map(corners).collect::<Vec<_>>())
    }

    /// The same for a scene that has been built.
    pub(crate) fn for_built(scene: &Scene) -> Option<Self> {
        let fronts = (0..scene.traced_count() as u32).map(TriId).filter(|&tri| scene.traced(tri) == tri);
        let of_triangle = |tri| corners_of(scene.triangle_positions(tri));
        Self::for_corners(&fronts.flat_map(of_triangle).collect::<Vec<_>>())
    }

    fn for_corners(corners: &[Corner]) -> Option<Self> {
        let core = core(corners);
        let longest = 2.0 * core.reach(corners.iter()) / PER_DIAMETER;
        // Most corners may lie on one point, which is no core.
        let shortest = (2.0 * core.radius / PER_DIAMETER).max(longest * 1e-6);
        (longest > 0.0 && longest.is_finite()).then_some(Self::Graded { core, shortest, longest })
    }

    /// The same with all lengths multiplied.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Uniform(length) => Self::Uniform(factor * length),
            Self::Graded { core, shortest, longest } => {
                Self::Graded { core, shortest: factor * shortest, longest: factor * longest }
            }
        }
    }

    /// The shortest of them.
    pub(crate) fn shortest(self) -> f64 {
        match self {
            Self::Uniform(length) => length,
            Self::Graded { shortest, .. } => shortest,
        }
    }

    /// That of an edge with this midpoint.
    #[inline]
    pub(crate) fn at(&self, midpoint: DVec3) -> f64 {
        match *self {
            Self::Uniform(length) => length,
            Self::Graded { core, shortest, longest } => {
                let outside = (midpoint.distance(core.center) - core.radius).max(0.0);
                let growth = 1.0 + GRADING * outside / (2.0 * core.radius).max(PER_DIAMETER * shortest);
                (shortest * growth).min(longest)
            }
        }
    }
}

impl Ball {
    /// How far from its centre the furthest of some corners is.
    fn reach<'a>(&self, corners: impl Iterator<Item = &'a Corner>) -> f64 {
        // Sums of other orders or of a turned scene differ in the last digits, which must not decide anything.
        f64::from(corners.map(|(p, _)| p.distance(self.center)).fold(0.0, f64::max) as f32)
    }
}

/// A corner of a face and its angle: however polygons are cut into triangles, the angles at a corner add up to the same.
type Corner = (DVec3, f64);

/// The sound corners of an object.
fn corners(object: &ObjectMesh) -> impl Iterator<Item = Corner> + '_ {
    let exists = |face: &&Face| face.vertices.iter().all(|&v| (v as usize) < object.positions.len());
    let all = object.faces.iter().filter(exists).flat_map(|face| corners_of(object.corners(face)));
    all.filter(|(p, angle)| p.is_finite() && angle.is_finite())
}

fn corners_of(corners: [Vec3; 3]) -> [Corner; 3] {
    [0, 1, 2].map(|k| (corners[k].as_dvec3(), angle(corners, k)))
}

/// The ball that most corners lie in: what is far beyond their mean distance from their middle is left out until nothing is.
fn core(corners: &[Corner]) -> Ball {
    let (mut ball, mut left_in) = (Ball { center: DVec3::ZERO, radius: f64::INFINITY }, usize::MAX);
    for _ in 0..MAX_ROUNDS {
        let inside = || corners.iter().filter(|(p, _)| p.distance(ball.center) <= ball.radius);
        let weight: f64 = inside().map(|(_, angle)| angle).sum();
        let count = inside().count();
        if count == left_in || weight <= 0.0 {
            break;
        }
        left_in = count;
        let center = inside().map(|(p, angle)| *angle * *p).sum::<DVec3>() / weight;
        let center = center.as_vec3().as_dvec3();
        let distance = inside().map(|(p, angle)| angle * p.distance(center)).sum::<f64>() / weight;
        ball = Ball { center, radius: OUTSIDE_CORE * distance };
    }
    let inside = corners.iter().filter(|(p, _)| p.distance(ball.center) <= ball.radius);
    Ball { radius: ball.reach(inside), ..ball }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_grow_away_from_the_core_to_a_limit() {
        let core = Ball { center: DVec3::ZERO, radius: 1.0 };
        let graded = EdgeLength::Graded { core, shortest: 0.05, longest: 1.0 };
        let at = |x: f64| graded.at(DVec3::new(x, 0.0, 0.0));
        assert_eq!((at(0.0), at(1.0), at(1e9)), (0.05, 0.05, 1.0));
        let growth = at(3.0) / 0.05 - 1.0;
        assert!((growth - GRADING * 2.0 / (PER_DIAMETER * 0.05)).abs() < 1e-12, "{growth}");
        assert!(graded.scaled(2.0).at(DVec3::ZERO) == 0.1 && graded.shortest() == 0.05);
    }

    #[test]
    fn a_few_corners_far_out_do_not_widen_the_core() {
        let cube = |i: u32| DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2 & 1).into());
        let mut corners: Vec<Corner> = (0..80).map(|i| (cube(i), 1.0)).collect();
        let of_cube = core(&corners);
        let radius = f64::from((0.75f64.sqrt()) as f32);
        assert_eq!(of_cube, Ball { center: DVec3::splat(0.5), radius });
        corners.extend([-1e6, 1e6, 2e6].map(|x| (DVec3::splat(x), 1.0)));
        assert_eq!(core(&corners), of_cube);
        assert_eq!(core(&[]).reach([].iter()), 0.0);
    }
}
