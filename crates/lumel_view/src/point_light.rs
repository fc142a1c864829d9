//! Light at the scattered points that carry it.

use crate::selection::Selection;
use glam::{DVec3, Vec3};
use lumel::{Scene, Solution};
use lumel_basis::PointCloud;
use lumel_export::SolutionPoints;
use std::sync::Arc;

/// The coefficient of each point, W·m⁻².
pub type PointValues = Arc<Vec<Vec3>>;

/// Where direct light is known best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direct {
    /// At the points, as the other bounces.
    AtPoints,
    /// At the vertices, where it was measured once more.
    AtVertices,
}

/// Light at scattered points, bounce by bounce, as an [`Illumination`](crate::selection::Illumination) has it at vertices.
#[derive(Clone, Debug)]
pub struct PointIllumination {
    /// The points.
    pub cloud: Arc<PointCloud>,
    /// Bounces that are done.
    pub bounces: Vec<PointValues>,
    /// What is known of the bounce being measured.
    pub current: Option<PointValues>,
    /// Estimate of all bounces that were not computed.
    pub tail: Option<PointValues>,
    /// Whether each point was measured itself; empty while that is not known.
    pub valid: Arc<Vec<bool>>,
    /// Where direct light is read.
    pub direct: Direct,
}

impl PointIllumination {
    /// Points without light.
    pub fn new(cloud: Arc<PointCloud>) -> Self {
        let direct = Direct::AtPoints;
        Self { cloud, bounces: Vec::new(), current: None, tail: None, valid: Arc::default(), direct }
    }

    /// That of a solution on its scene, if points carried its light.
    pub fn of(solution: &Solution, scene: &Scene) -> Option<Self> {
        let points = solution.points.as_ref()?;
        Some(Self {
            cloud: Arc::new(points.cloud(scene)),
            bounces: points.bounces.iter().cloned().map(Arc::new).collect(),
            current: None,
            tail: points.tail.clone().map(Arc::new),
            valid: Arc::new(points.valid.clone()),
            direct: Direct::AtVertices,
        })
    }

    /// The same for a file, without the bounce that is being measured.
    pub fn for_solution(&self, scene: &Scene) -> SolutionPoints {
        let points = self.cloud.points();
        let known = self.valid.len() == points.len();
        SolutionPoints {
            positions: points.iter().map(|point| scene.to_world(point.position)).collect(),
            normals: points.iter().map(|point| point.normal).collect(),
            radii: points.iter().map(|point| point.radius).collect(),
            levels: points.iter().map(|point| point.level).collect(),
            valid: if known { self.valid.to_vec() } else { vec![true; points.len()] },
            bounces: self.bounces.iter().map(|bounce| bounce.to_vec()).collect(),
            tail: self.tail.as_ref().map(|tail| tail.to_vec()),
        }
    }

    /// Whether a part of the light has its direct light from the vertices.
    pub fn leaves_direct(&self, selection: Selection) -> bool {
        self.direct == Direct::AtVertices && selection.contains(0)
    }

    /// The chosen part of the light, without what vertices have of it.
    pub fn select(&self, selection: Selection) -> Vec<Vec3> {
        let is_here = |k: usize| selection.contains(k) && (k > 0 || !self.leaves_direct(selection));
        let bounces = self.bounces.iter().chain(&self.current).enumerate();
        let bounces = bounces.filter(|(k, _)| is_here(*k)).map(|(_, values)| values);
        let parts: Vec<&PointValues> =
            bounces.chain(self.tail.iter().filter(|_| selection.contains_tail())).collect();
        let sum = |i: usize| parts.iter().map(|part| part[i].as_dvec3()).sum::<DVec3>().as_vec3();
        (0..self.cloud.points().len()).map(sum).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_basis::CloudPoint;

    #[test]
    fn direct_light_is_read_at_the_vertices_once_it_was_measured_there() {
        let point = CloudPoint { position: Vec3::ZERO, normal: Vec3::Y, radius: 1.0, level: 0 };
        let values = |x: f32| Arc::new(vec![Vec3::splat(x)]);
        let mut light = PointIllumination {
            bounces: vec![values(1.0), values(2.0)],
            current: Some(values(4.0)),
            tail: Some(values(8.0)),
            ..PointIllumination::new(Arc::new(PointCloud::new(vec![point])))
        };
        let of = |light: &PointIllumination, selection| light.select(selection)[0].x;
        assert_eq!(of(&light, Selection::All), 15.0);
        assert_eq!(of(&light, Selection::Indirect), 14.0);
        assert_eq!(of(&light, Selection::Range(0, 1)), 3.0);
        light.direct = Direct::AtVertices;
        assert_eq!([Selection::All, Selection::DIRECT].map(|s| of(&light, s)), [14.0, 0.0]);
        assert!(light.leaves_direct(Selection::All) && !light.leaves_direct(Selection::Indirect));
    }
}
