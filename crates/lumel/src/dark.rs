//! Faces that stay dark although they can be seen.

use crate::Baker;
use lumel_accel::Ray;
use lumel_basis::{Basis, Field};
use lumel_sample::{Dim, Frame, SamplerKind, StreamKey, cosine_hemisphere};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};
use lumel_solve::SolveState;

/// Rays from the middle of a face that decide whether it can be seen.
const RAYS: u32 = 16;

impl Baker {
    /// Triangles that can be seen but stay dark, because all vertices they hang together with lie inside geometry.
    ///
    /// A beam whose ends stick in two posts is one: only more vertices on it help. Faces that are hidden themselves,
    /// such as the underside of a box on a floor, do not count.
    pub fn dark_faces(&self, state: &SolveState) -> usize {
        if !state.valid.contains(&false) {
            return 0;
        }
        let basis = self.basis();
        let mut nothing = Field::zeros(state.valid.len());
        let reached = basis.adjacency().extrapolate(&mut nothing, &state.valid);
        let corner_nodes = basis.corner_nodes().unwrap_or_default();
        let faces = (0..).map(TriId).zip(corner_nodes);
        let dark = faces.filter(|(_, nodes)| nodes.iter().all(|node| !reached[node.index()]));
        dark.filter(|(tri, _)| self.is_seen(*tri)).count()
    }

    /// Whether most rays from the middle of a triangle do not meet the back of a surface.
    fn is_seen(&self, tri: TriId) -> bool {
        let scene: &Scene = self.scene();
        let middle = SurfacePoint { tri, bary: Barycentrics { u: 1.0 / 3.0, v: 1.0 / 3.0 } };
        let normal = scene.geometric_normal(tri);
        let frame = Frame::from_normal(normal);
        let origin = scene.ray_origin(middle);
        let stream =
            SamplerKind::Sobol.for_count(RAYS).stream(StreamKey::new(0).element(tri.0), Dim::Validity);
        let meets_back = |i: &u32| {
            let direction = frame.to_world(cosine_hemisphere(stream.sample_2d(*i)));
            let ray = Ray::new(origin, direction).skipping(scene.traced(tri));
            self.tracer().closest_hit(&ray).is_some_and(|hit| scene.seen_side(hit.at, hit.side).is_none())
        };
        2 * (0..RAYS).filter(meets_back).count() < RAYS as usize
    }
}

#[cfg(test)]
mod tests {
    use crate::{Baker, BounceLimit, Control, Projection, Settings, Silent, SolveState};
    use glam::Vec3;
    use lumel_scene::{Face, Material, MaterialId, ObjectMesh, Radiance, SceneBuilder, Smoothing};
    use std::sync::Arc;

    /// A box from `min` to `max`, seen from outside.
    fn solid(min: Vec3, max: Vec3) -> ObjectMesh {
        let corner = |i: usize| {
            let pick = |axis: usize| if (i >> axis) & 1 == 1 { max[axis] } else { min[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        };
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Flat };
        ObjectMesh {
            name: "box".into(),
            positions: (0..8).map(corner).collect(),
            faces: quads.iter().flat_map(|&[a, b, c, d]| [face([a, b, c]), face([a, c, d])]).collect(),
            ..ObjectMesh::default()
        }
    }

    fn dark_faces(max_edge: Option<f32>) -> usize {
        let post = |x: f32| solid(Vec3::new(x, 0.0, 0.0), Vec3::new(x + 0.4, 2.0, 0.4));
        let beam = solid(Vec3::new(0.2, 1.0, 0.1), Vec3::new(2.2, 1.2, 0.3));
        let mut builder = SceneBuilder {
            objects: vec![post(0.0), post(2.0), beam],
            materials: vec![Material::default()],
            sky: Radiance::splat(1.0).into(),
            ..SceneBuilder::default()
        };
        if let Some(max_edge) = max_edge {
            builder.tessellate(max_edge).unwrap();
        }
        let settings =
            Settings { projection: Projection::Point, bounces: BounceLimit::Count(0), ..Settings::default() };
        let baker = Baker::new(Arc::new(builder.build().unwrap().0), settings);
        let mut state = SolveState::new();
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        baker.dark_faces(&state)
    }

    #[test]
    fn a_beam_between_posts_is_dark_until_it_has_vertices_of_its_own() {
        // Its four long sides of two triangles each; its ends are inside the posts and do not count.
        assert_eq!(dark_faces(None), 8);
        assert_eq!(dark_faces(Some(0.3)), 0);
    }
}
