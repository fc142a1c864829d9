//! Points without the surfaces that they lie on: what shows light needs no more.

use super::clearance::{Clearance, Obstacles};
use super::nodes::{Node, NodeGrid, RADIUS};
use super::scatter::LIFT;
use crate::{Lighting, MeshlessBasis, NodeId, NodeWeights, SurfaceSample, VertexLighting};
use glam::Vec3;
use lumel_scene::{Irradiance, Scene, SurfacePoint};
use rayon::prelude::*;

/// A point of a [`PointCloud`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// Where it is in the coordinates of the scene, metres.
    pub position: Vec3,
    /// Which way the surface faces there, unit length.
    pub normal: Vec3,
    /// How far it reaches, metres: the same for all points of a level.
    pub radius: f32,
    /// Its level; 0 is the coarsest.
    pub level: u32,
}

/// Points of all levels of a [`MeshlessBasis`], read by position and normal.
///
/// The functions are those of the basis. It is made from a basis, or from what a file says of one, in no time compared
/// with scattering.
#[derive(Clone, Debug)]
pub struct PointCloud {
    points: Vec<CloudPoint>,
    /// From the coarsest to the finest.
    levels: Vec<CloudLevel>,
}

/// Points of one level.
#[derive(Clone, Debug)]
struct CloudLevel {
    grid: NodeGrid,
    /// Which of all points each node of the grid is.
    numbers: Vec<u32>,
}

impl PointCloud {
    /// A cloud of these points, numbered as they are given. Levels without points are left out.
    pub fn new(points: Vec<CloudPoint>) -> Self {
        let origin = points.iter().map(|point| point.position).fold(Vec3::INFINITY, Vec3::min);
        let mut by_level: Vec<u32> = (0..points.len() as u32).collect();
        by_level.sort_by_key(|&point| points[point as usize].level);
        let same = |a: &u32, b: &u32| points[*a as usize].level == points[*b as usize].level;
        let level = |numbers: &[u32]| {
            let mut numbers = numbers.to_vec();
            let radius = points[numbers[0] as usize].radius;
            let node = |&number: &u32| {
                let CloudPoint { position, normal, .. } = points[number as usize];
                Node { position, normal }
            };
            let grid = NodeGrid::of_radius(origin, radius, &mut numbers, node);
            CloudLevel { grid, numbers }
        };
        let levels = by_level.chunk_by(same).map(level).collect();
        Self { points, levels }
    }

    /// The points of a basis, numbered as its nodes.
    pub fn of(basis: &MeshlessBasis) -> Self {
        let of_level = |level: u32| {
            let radius = basis.radius_of_level(level);
            let points = &basis.points()[basis.nodes_of_level(level).start as usize..];
            let count = basis.nodes_of_level(level).len();
            points[..count].iter().map(move |&SurfaceSample { position, normal, .. }| CloudPoint {
                position,
                normal,
                radius,
                level,
            })
        };
        let cloud = Self::new((0..basis.level_count()).flat_map(of_level).collect());
        cloud.with_clearances(|number| basis.clearance(NodeId(number)))
    }

    /// The same where light does not pass what stands on the surfaces, as in [`MeshlessBasis::around_obstacles`]: for points that a file
    /// tells of.
    ///
    /// `surface` finds the place of a surface that a point lies on. Nothing hinders a point without one.
    #[must_use]
    pub fn around_obstacles(
        self,
        obstacles: &dyn Obstacles,
        surface: impl Fn(&CloudPoint) -> Option<SurfacePoint> + Sync,
    ) -> Self {
        let clearance = |point: &CloudPoint| {
            let CloudPoint { position, normal, radius, .. } = *point;
            let from = SurfaceSample { at: surface(point)?, position, normal };
            Clearance::around(&from, LIFT / RADIUS * radius, radius, obstacles)
        };
        let clearances: Vec<Option<Clearance>> = self.points.par_iter().map(clearance).collect();
        self.with_clearances(|number| clearances[number as usize])
    }

    fn with_clearances(self, clearance: impl Fn(u32) -> Option<Clearance>) -> Self {
        let around = |CloudLevel { grid, numbers }: CloudLevel| {
            let grid = grid.with_clearances(numbers.iter().map(|&number| clearance(number)));
            CloudLevel { grid, numbers }
        };
        Self { levels: self.levels.into_iter().map(around).collect(), ..self }
    }

    /// The points, in the order of their values.
    pub fn points(&self) -> &[CloudPoint] {
        &self.points
    }

    /// What stands around those points around which anything does, with their numbers.
    pub fn clearances(&self) -> impl Iterator<Item = (u32, Clearance)> {
        self.levels.iter().flat_map(|CloudLevel { grid, numbers }| {
            let known = |(node, &number)| Some((number, grid.clearance(node)?));
            numbers.iter().enumerate().filter_map(known)
        })
    }

    /// The number of levels.
    pub fn level_count(&self) -> u32 {
        self.levels.len() as u32
    }

    /// The points that count at a place that faces some way, with their weights, on levels up to `finest`: those of each level sum to 1,
    /// unless none of it is near.
    #[inline]
    pub fn weights_at(&self, position: Vec3, normal: Vec3, finest: u32, weights: &mut NodeWeights) {
        let count = self.levels.len().min(finest as usize + 1);
        for CloudLevel { grid, numbers } in &self.levels[..count] {
            grid.weights_at(position, normal, |node, weight| {
                weights.push(NodeId(numbers[node as usize]), weight);
            });
        }
    }

    /// The mean of values at the points by these weights.
    pub fn at(&self, values: &[Vec3], position: Vec3, normal: Vec3, finest: u32) -> Vec3 {
        let mut weights = NodeWeights::default();
        self.weights_at(position, normal, finest, &mut weights);
        weights.iter().map(|(node, weight)| values[node.index()] * weight).sum()
    }
}

/// Light at scattered points, with what vertices have besides: direct light, whose shadows are too sharp for points.
#[derive(Clone, Copy, Debug)]
pub struct CloudLighting<'a> {
    /// The surfaces.
    pub scene: &'a Scene,
    /// The points.
    pub cloud: &'a PointCloud,
    /// The coefficient of each, W·m⁻².
    pub values: &'a [Vec3],
    /// The finest level that is read; `u32::MAX` for all.
    pub finest: u32,
    /// What is added to it.
    pub vertices: VertexLighting<'a>,
}

impl Lighting for CloudLighting<'_> {
    fn irradiance(&self, at: SurfacePoint, _normal: Vec3) -> Irradiance {
        let SurfaceSample { position, normal, .. } = SurfaceSample::new(self.scene, at);
        Irradiance(self.vertices.at(at).0 + self.cloud.at(self.values, position, normal, self.finest))
    }
}
