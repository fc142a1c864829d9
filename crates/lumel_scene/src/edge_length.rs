//! How long edges may be, and where.

use crate::mesh::ObjectMesh;
use crate::{Bounds, SceneBuilder};
use glam::{DVec3, Vec3};

/// Edges per diagonal of what they lie in: the shadows of a room show, and it takes seconds to bake.
const PER_DIAGONAL: f64 = 64.0;

/// Around the core of a scene, edges may be twice as long for every eighth of its diagonal.
const GRADING: f64 = 8.0;

/// Share of the corners of faces that lie outside the core on either side of each axis.
const OUTSIDE_CORE: f64 = 0.05;

/// The longest edge that is allowed at each place, metres.
///
/// A function of the place alone, so that triangles which share an edge agree about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EdgeLength {
    /// The same everywhere.
    Uniform(f64),
    /// Shortest in the core of the scene, and longer away from it.
    Graded {
        /// Of the core.
        center: DVec3,
        half: DVec3,
        /// In the core, and the most anywhere.
        shortest: f64,
        longest: f64,
    },
}

impl EdgeLength {
    /// Lengths that suit a scene: a 64th of the diagonal of its core, growing to a 64th of that of all.
    ///
    /// The core is where most of its triangles are: a room on a plane of a kilometre, not the plane.
    pub(crate) fn for_scene(builder: &SceneBuilder) -> Option<Self> {
        let corners: Vec<Vec3> = builder.objects.iter().flat_map(corners).filter(|p| p.is_finite()).collect();
        let all = Bounds::around(corners.iter().copied());
        let axes = [0, 1, 2].map(|axis| {
            let mut values: Vec<f32> = corners.iter().map(|p| p[axis]).collect();
            middle_range(&mut values)
        });
        let [x, y, z] = axes;
        let [x, y, z] = [x?, y?, z?];
        let core = Bounds { min: Vec3::new(x[0], y[0], z[0]), max: Vec3::new(x[1], y[1], z[1]) };
        let diagonal = |bounds: &Bounds| (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length();
        let longest = diagonal(&all) / PER_DIAGONAL;
        // Most corners may lie on one point or line, which is no core.
        let shortest = (diagonal(&core) / PER_DIAGONAL).max(longest * 1e-6);
        let (min, max) = (core.min.as_dvec3(), core.max.as_dvec3());
        let graded = Self::Graded { center: 0.5 * (min + max), half: 0.5 * (max - min), shortest, longest };
        (longest > 0.0 && longest.is_finite()).then_some(graded)
    }

    /// The same with all lengths multiplied.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Uniform(length) => Self::Uniform(factor * length),
            Self::Graded { center, half, shortest, longest } => {
                Self::Graded { center, half, shortest: factor * shortest, longest: factor * longest }
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
            Self::Graded { center, half, shortest, longest } => {
                let outside = ((midpoint - center).abs() - half).max(DVec3::ZERO).length();
                let growth = 1.0 + GRADING * outside / (2.0 * half.length()).max(PER_DIAGONAL * shortest);
                (shortest * growth).min(longest)
            }
        }
    }
}

fn corners(object: &ObjectMesh) -> impl Iterator<Item = Vec3> + '_ {
    let vertices = object.faces.iter().flat_map(|face| face.vertices);
    vertices.filter_map(|vertex| object.positions.get(vertex as usize).copied())
}

/// The range that most of some numbers lie in.
fn middle_range(values: &mut [f32]) -> Option<[f32; 2]> {
    let last = values.len().checked_sub(1)?;
    let outside = (OUTSIDE_CORE * last as f64) as usize;
    let mut at = |place: usize| *values.select_nth_unstable_by(place, f32::total_cmp).1;
    Some([at(outside), at(last - outside)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_grow_away_from_the_core_to_a_limit() {
        let graded =
            EdgeLength::Graded { center: DVec3::ZERO, half: DVec3::splat(1.0), shortest: 0.05, longest: 1.0 };
        let at = |x: f64| graded.at(DVec3::new(x, 0.0, 0.0));
        assert_eq!((at(0.0), at(1.0), at(1e9)), (0.05, 0.05, 1.0));
        let growth = at(3.0) / 0.05 - 1.0;
        assert!((growth - GRADING * 2.0 / 12f64.sqrt()).abs() < 1e-12, "{growth}");
        assert!(graded.scaled(2.0).at(DVec3::ZERO) == 0.1 && graded.shortest() == 0.05);
    }

    #[test]
    fn a_few_values_far_out_do_not_widen_the_range() {
        let mut values: Vec<f32> = (0..100).map(|i| (i % 10) as f32).chain([-1e6, 1e6]).collect();
        assert_eq!(middle_range(&mut values), Some([0.0, 9.0]));
        assert_eq!(middle_range(&mut []), None);
    }
}
