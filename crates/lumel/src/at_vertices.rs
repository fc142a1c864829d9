//! Reading what a solve has found at the vertices of the scene.

use crate::light_reader::{LightReader, positive};
use crate::{Baker, layers};
use glam::Vec3;
use lumel_basis::Field;
use lumel_export::{Solution, SolutionLayer, SolutionMeta, SolutionPoints};
use lumel_solve::{SolveState, mix};

impl Baker {
    /// A field of a solve as bounces carry it, at every vertex of the scene, W·m⁻²: the mean under the hat function of
    /// each vertex where light is measured over areas.
    ///
    /// For fields that are not all measured yet, and for those that were [read](LightReader) before, such as
    /// standard errors.
    pub fn carried_at_vertices(&self, field: &Field) -> Vec<Vec3> {
        self.surfaces().points.read(&**self.basis(), field)
    }

    /// All light of a state at every vertex of the scene, W·m⁻², never negative.
    pub fn light_at_vertices(&self, state: &SolveState) -> Vec<Vec3> {
        self.light_reader(state).all_at_vertices(state)
    }

    /// All light at every vertex of the scene, W·m⁻², with each layer dimmed to a share: no ray is traced.
    ///
    /// `share` is told the name of a layer; 1 leaves it as it was solved. `None` if `state` has no layers.
    pub fn mixed(&self, state: &SolveState, share: impl Fn(&str) -> Vec3) -> Option<Vec<Vec3>> {
        let names = layers::light_layers(self.scene(), self.settings());
        let shares: Vec<Vec3> = names.iter().map(|layer| share(&layer.name)).collect();
        (!state.layers.is_empty())
            .then(|| self.light_reader(state).positive_at_vertices(&mix(&state.layers, &shares)))
    }

    /// What holds for the nodes of the basis, for every vertex of the scene; true where it is not known of the node.
    pub fn flags_at_vertices(&self, nodes: &[bool]) -> Vec<bool> {
        self.surfaces().points.all(&**self.basis(), nodes)
    }

    /// The light at every vertex of the scene.
    ///
    /// All light is what its bounces add up to, but never negative; bounces and layers may be, so that they add up. It differs
    /// from [`light_at_vertices`](Self::light_at_vertices) by what iterations leave of either, some
    /// millionths.
    pub fn solution(&self, state: &SolveState) -> Solution {
        let reader = self.light_reader(state);
        let read = reader.read_state(state);
        let at_vertices = |field: &Field| self.carried_at_vertices(field);
        let bounce = |(k, field): (usize, &Field)| match reader.direct_at_vertices().filter(|_| k == 0) {
            Some(direct) => direct.to_vec(),
            None => at_vertices(field),
        };
        let settings = serde_json::to_value(self.settings()).unwrap_or_default();
        let errors = state.errors.as_ref();
        Solution {
            meta: SolutionMeta::new(self.scene(), settings),
            positions: self.scene().world_positions().collect(),
            normals: self.scene().normals().to_vec(),
            irradiance: match state.bounces.is_empty() {
                true => vec![Vec3::ZERO; self.scene().vertex_count()],
                false => positive(reader.with_direct(at_vertices(&read.total()))),
            },
            bounces: read.bounces.iter().enumerate().map(bounce).collect(),
            tail: read.beyond_bounces().as_ref().map(at_vertices),
            valid: self.flags_at_vertices(&state.valid),
            standard_error: errors.map(|errors| self.carried_at_vertices(&errors.standard_error)),
            layers: self.layers(state, &reader),
            directional: state.directional.as_ref().and_then(|field| reader.directional_at_vertices(field)),
            occlusion: None,
            splits: self.splits().to_vec(),
            points: self.solution_points(state),
        }
    }

    /// The points that have carried the light of a state.
    fn solution_points(&self, state: &SolveState) -> Option<SolutionPoints> {
        let basis = self.basis().points()?;
        let values = |field: &Field| field.values().to_vec();
        let (points, scene) = (basis.points(), self.scene());
        Some(SolutionPoints {
            positions: points.iter().map(|point| scene.to_world(point.position)).collect(),
            normals: points.iter().map(|point| point.normal).collect(),
            radii: vec![basis.radius(); points.len()],
            levels: vec![0; points.len()],
            valid: state.valid.clone(),
            bounces: state.bounces.iter().map(values).collect(),
            tail: state.beyond_bounces().as_ref().map(values),
        })
    }

    /// The layers of a state at all vertices.
    fn layers(&self, state: &SolveState, reader: &LightReader<'_>) -> Vec<SolutionLayer> {
        let names = layers::light_layers(self.scene(), self.settings()).into_iter().map(|layer| layer.name);
        let layer = |(k, (name, field))| SolutionLayer {
            name,
            irradiance: reader.at_vertices(field),
            directional: state.directional_layers.get(k).and_then(|f| reader.directional_at_vertices(f)),
        };
        names.zip(&state.layers).enumerate().map(layer).collect()
    }
}
