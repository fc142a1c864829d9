//! Light measured at the points of a meshless basis.

use super::MeshlessBasis;
use crate::area_receivers::reach_over;
use crate::points::Surroundings;
use crate::{Basis, PointReceivers, Site};
use lumel_sample::Frame;
use std::sync::Arc;

impl PointReceivers {
    /// Measures the nodes of a [`MeshlessBasis`] at their points, with the hemispheres of their triangles.
    ///
    /// Points are uniform by area, so that none of them has to lie in the corner of a room, or with its hemisphere half inside a
    /// wall. A point inside other geometry sees back faces and is found invalid.
    pub fn at_nodes(basis: &Arc<MeshlessBasis>) -> Self {
        let scene = basis.scene();
        let site = |point: &super::SurfaceSample| Site {
            origin: scene.ray_origin(point.at),
            frame: Frame::from_normal(scene.geometric_normal(point.at.tri)),
            skip: Some(scene.traced(point.at.tri)),
        };
        let sites = basis.points().iter().map(site).collect();
        // As far as from vertices, each of which has two triangles.
        let reaches = basis.node_areas().iter().map(|&area| reach_over(0.5 * area)).collect();
        let surfaces = basis.points().iter().map(|point| point.at.tri).collect();
        let surroundings = Surroundings { basis: basis.clone(), reaches, surfaces };
        Self::from_sites(basis.identity().derived("points"), sites, Some(surroundings))
    }
}
