//! The light of a solution as its points have it.

use crate::{Solution, SolutionError, SolutionPoints, SolutionSelection};
use glam::{DVec3, Vec3};
use lumel_basis::{CloudLighting, CloudPoint, PointCloud, VertexLighting};
use lumel_scene::Scene;

/// A part of a solution's light, read between its points rather than its vertices: on large triangles there is more of it.
///
/// Direct light, whose shadows are too sharp for points, is still that at the vertices.
#[derive(Clone, Debug)]
pub struct ScatteredLight {
    /// The points.
    pub cloud: PointCloud,
    /// The coefficient of each, W·m⁻².
    pub values: Vec<Vec3>,
    /// What is added to it at every vertex, W·m⁻².
    pub vertices: Vec<Vec3>,
}

impl ScatteredLight {
    /// The light on the scene that it belongs to, all levels of it.
    ///
    /// # Errors
    /// A scene with other vertices.
    pub fn lighting<'a>(&'a self, scene: &'a Scene) -> Result<CloudLighting<'a>, SolutionError> {
        let vertices = VertexLighting::new(scene, &self.vertices)?;
        Ok(CloudLighting { scene, cloud: &self.cloud, values: &self.values, finest: u32::MAX, vertices })
    }
}

impl SolutionPoints {
    /// The points in the coordinates of a scene.
    pub fn cloud(&self, scene: &Scene) -> PointCloud {
        let point = |i: usize| CloudPoint {
            position: (self.positions[i] - scene.origin()).as_vec3(),
            normal: self.normals[i],
            radius: self.radii[i],
            level: self.levels[i],
        };
        PointCloud::new((0..self.len()).map(point).collect())
    }
}

impl Solution {
    /// The chosen part of the light as the points have it that carried it; `None` where vertices did, and for layers, which
    /// are known at vertices alone.
    ///
    /// # Errors
    /// A solution of a different scene, and a bounce that was not computed.
    pub fn scattered_light(
        &self,
        scene: &Scene,
        selection: &SolutionSelection,
    ) -> Result<Option<ScatteredLight>, SolutionError> {
        self.check_belongs_to(scene)?;
        self.select(selection)?;
        let Some(points) = &self.points else { return Ok(None) };
        let reflected = points.bounces.iter().skip(1);
        let parts: Vec<&Vec<Vec3>> = match *selection {
            SolutionSelection::Sum => reflected.chain(&points.tail).collect(),
            SolutionSelection::Bounce(0) => Vec::new(),
            SolutionSelection::Bounce(k) => points.bounces.get(k).into_iter().collect(),
            SolutionSelection::Layer(_) => return Ok(None),
        };
        let sum = |i: usize| parts.iter().map(|part| part[i].as_dvec3()).sum::<DVec3>().as_vec3();
        let has_direct = matches!(selection, SolutionSelection::Sum | SolutionSelection::Bounce(0));
        let direct = self.bounces.first().filter(|_| has_direct);
        Ok(Some(ScatteredLight {
            cloud: points.cloud(scene),
            values: (0..points.len()).map(sum).collect(),
            vertices: direct.cloned().unwrap_or_else(|| vec![Vec3::ZERO; self.vertex_count()]),
        }))
    }
}
