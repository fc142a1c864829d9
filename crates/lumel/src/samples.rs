//! Where a bake measures light, for looking at.

use crate::Baker;
use glam::Vec3;
use lumel_accel::Ray;
use lumel_basis::{Basis, CENTER, ElementId, NodeId, NodeWeights, Receivers, Sampling};
use lumel_sample::{Dim, StreamKey};
use lumel_transport::hemisphere_direction;

impl Baker {
    /// Points at which light is measured, at most `limit` of them, and whether each counts in `valid`: a flag per
    /// node, or nothing where that is not known.
    ///
    /// At vertices these are the origins of their rays, which lie a little inside the triangles around. Over areas
    /// every element has as many origins as samples; the first of each is given.
    pub fn sample_points(&self, valid: &[bool], limit: usize) -> Vec<(Vec3, bool)> {
        let receivers = self.receivers();
        let n = receivers.element_count();
        let step = n.div_ceil(limit.max(1)).max(1);
        let mut weights = NodeWeights::default();
        let point = |element: usize| {
            let element = ElementId(element as u32);
            weights.clear();
            let u = match receivers.sampling() {
                Sampling::Point => CENTER,
                Sampling::Area => {
                    let key = StreamKey::new(self.settings().seed).element(element.0).bounce(0).pass(0);
                    let [s, t, ..] = self.settings().sampler.for_count(1).stream(key, Dim::Area).sample_4d(0);
                    [s, t]
                }
            };
            let site = receivers.site(element, u);
            receivers.towards(element, u, &mut weights);
            let counts = weights.iter().any(|(node, _)| valid.get(node.index()).copied().unwrap_or(true));
            (site.origin, counts)
        };
        (0..n).step_by(step).map(point).collect()
    }

    /// The rays with which receivers at vertices measure a bounce (1 or later) at a vertex of the scene, each from its
    /// origin to where it ends; rays that meet nothing are `length` metres long.
    ///
    /// The very rays of the bake, unless it measures over areas: then those that it would send from the vertex.
    pub fn rays_of_vertex(&self, vertex: usize, bounce: u32, length: f32) -> Vec<[Vec3; 2]> {
        let Some(&at) = self.surfaces().points.points().get(vertex) else { return Vec::new() };
        let mut nodes = NodeWeights::default();
        self.basis().weights_at(at, &mut nodes);
        let Some((NodeId(node), _)) = nodes.iter().find(|(_, weight)| *weight > 0.0) else {
            return Vec::new();
        };
        let site = self.surfaces().at_vertices().receivers.central_site(ElementId(node));
        let settings = self.settings();
        let samples = settings.sampler.sample_count(settings.indirect_samples);
        let key = StreamKey::new(settings.seed).element(node).bounce(bounce).pass(0);
        let stream = settings.sampler.for_count(samples).stream(key, Dim::Hemisphere);
        let ray = |i: u32| {
            let direction = hemisphere_direction(&site, stream.sample_2d(i));
            let ray = Ray { skip: site.skip, ..Ray::new(site.origin, direction) };
            let t = self.tracer().closest_hit(&ray).map_or(length, |hit| hit.t);
            [site.origin, site.origin + direction * t]
        };
        (0..samples).map(ray).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::{Baker, OpenOptions, Projection, Settings};
    use std::sync::Arc;

    fn baker(settings: Settings) -> Baker {
        let opened = crate::open("cornell-box", &OpenOptions::default()).unwrap();
        Baker::new(Arc::new(opened.builder.build().unwrap().0), settings)
    }

    #[test]
    fn every_node_has_a_sample_point_near_its_vertex() {
        let baker = baker(Settings { projection: Projection::Point, ..Settings::default() });
        let points = baker.sample_points(&[], usize::MAX);
        assert!(points.len() > 10_000 && points.iter().all(|(_, counts)| *counts));
        let near = |p: &glam::Vec3| {
            baker
                .scene()
                .positions()
                .iter()
                .any(|v| v.distance(*p) < 1e-3 * baker.scene().bounds().diagonal())
        };
        assert!(points.iter().step_by(500).all(|(p, _)| near(p)));
        assert_eq!(baker.sample_points(&vec![false; points.len()], 10).iter().filter(|(_, c)| *c).count(), 0);
        assert!(baker.sample_points(&[], 100).len() <= 100);
    }

    #[test]
    fn points_over_areas_lie_on_surfaces() {
        let baker = baker(Settings { projection: Projection::Area, ..Settings::default() });
        let bounds = baker.scene().bounds();
        let inside = |p: glam::Vec3| (bounds.min - 0.01).cmple(p).all() && p.cmple(bounds.max + 0.01).all();
        assert!(baker.sample_points(&[], 1000).into_iter().all(|(p, _)| inside(p)));
    }

    #[test]
    fn rays_of_a_vertex_leave_it_into_its_hemisphere() {
        let settings = Settings { indirect_samples: 64, ..Settings::default() };
        let baker = baker(settings);
        let vertex = 1234;
        let normal = baker.scene().normals()[vertex];
        let rays = baker.rays_of_vertex(vertex, 1, 10.0);
        assert_eq!(rays.len(), 64);
        let mean: f32 =
            rays.iter().map(|[a, b]| (*b - *a).try_normalize().unwrap().dot(normal)).sum::<f32>() / 64.0;
        // Cosine-distributed: the mean cosine is 2/3.
        assert!((mean - 2.0 / 3.0).abs() < 0.02, "{mean}");
        assert_eq!(baker.rays_of_vertex(usize::MAX, 1, 1.0), Vec::<[glam::Vec3; 2]>::new());
    }
}
