//! Faces that stay dark although they can be seen.

use crate::Baker;
use lumel_basis::{Basis, Field, NodeId};
use lumel_solve::SolveState;
use lumel_transport::{Control, CpuTransport, Job, Plan, Source, TransportError, accumulate};
use std::sync::Arc;

impl Baker {
    /// Triangles that can be seen but stay dark, because all vertices they hang together with lie inside geometry.
    ///
    /// A beam whose ends stick in two posts is one: it has to be measured over its [area](crate::Projection::Area), or needs
    /// more vertices. Faces that are hidden themselves, such as the underside of a box on a floor, do not count.
    ///
    /// # Errors
    /// When it is cancelled.
    pub fn dark_faces(&self, state: &SolveState, control: &Control) -> Result<usize, TransportError> {
        if !state.valid.contains(&false) {
            return Ok(0);
        }
        let basis = self.basis();
        let mut nothing = Field::zeros(state.valid.len());
        let reached = basis.adjacency().extrapolate(&mut nothing, &state.valid);
        let dark = |nodes: &&[NodeId; 3]| nodes.iter().all(|node| !reached[node.index()]);
        let faces: Vec<[NodeId; 3]> =
            basis.corner_nodes().unwrap_or_default().iter().filter(dark).copied().collect();
        if faces.is_empty() {
            return Ok(0);
        }
        let mut nodes = vec![false; state.valid.len()];
        faces.iter().flatten().for_each(|node| nodes[node.index()] = true);
        let visible = self.visible_over_areas(&nodes, control)?;
        Ok(faces.iter().filter(|face| face.iter().any(|node| visible[node.index()])).count())
    }

    /// Whether most of the surface around each node of some can be seen.
    fn visible_over_areas(&self, nodes: &[bool], control: &Control) -> Result<Vec<bool>, TransportError> {
        let over_areas = self.surfaces().over_areas();
        let measured = (Arc::clone(&over_areas.receivers), over_areas.order.clone());
        let (scene, tracer) = (Arc::clone(self.scene()), Arc::clone(self.tracer()));
        let basis = Arc::clone(&self.surfaces().vertices);
        let transport = CpuTransport::in_order(scene, tracer, basis, measured, Plan::default());
        let transport = transport.with_samples(Plan::default(), nodes);
        let job = Job { source: Source::Nothing, bounce: 0, pass: 0, active: None };
        Ok(accumulate(&transport, &job, control, None)?.visible().collect())
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
        baker.dark_faces(&state, &Control::default()).unwrap()
    }

    #[test]
    fn a_beam_between_posts_is_dark_until_it_has_vertices_of_its_own() {
        // Its four long sides of two triangles each; its ends are inside the posts and do not count.
        assert_eq!(dark_faces(None), 8);
        assert_eq!(dark_faces(Some(0.3)), 0);
    }
}
