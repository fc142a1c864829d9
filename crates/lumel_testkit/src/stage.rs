//! A built scene with its ray tracer, and operators on it.

use crate::combination::Storage;
use crate::quadrature::hat_average;
use glam::{DVec3, Vec3};
use lumel_accel::{Bvh, InstructionSet, RayTracer};
use lumel_basis::{
    AreaVertexBasis, Basis, ElementId, Field, NodeWeights, PointReceivers, Receivers, VertexBasis,
};
use lumel_scene::{Scene, SceneBuilder};
use lumel_transport::{Control, CpuTransport, Job, Measured, Plan, Source, Transport, accumulate};
use std::sync::Arc;

/// A scene that rays can be traced in.
pub struct Stage {
    scene: Arc<Scene>,
    tracer: Arc<dyn RayTracer>,
    vertices: VertexBasis,
}

/// A basis and the operator on it.
pub struct Operator {
    /// The basis.
    pub basis: Arc<dyn Basis>,
    /// The operator from this basis to itself.
    pub transport: Box<dyn Transport>,
    storage: Storage,
}

/// The ray tracer of a scene, with the instructions that the environment variable `LUMEL_TEST_INSTRUCTIONS` names, such as
/// `portable`; with the best that there are without it.
pub fn tracer(scene: &Scene) -> Bvh {
    let tree = Bvh::build(scene);
    let Some(name) = std::env::var_os("LUMEL_TEST_INSTRUCTIONS") else { return tree };
    let is_meant = |set: &InstructionSet| name.eq_ignore_ascii_case(set.to_string());
    let set = InstructionSet::available().into_iter().find(is_meant);
    let set = set.unwrap_or_else(|| panic!("this machine has no instructions {name:?}"));
    tree.with_instructions(set).unwrap_or_else(|| panic!("{set} is there"))
}

impl Stage {
    /// Builds a scene that must be sound.
    pub fn new(builder: SceneBuilder) -> Self {
        let (scene, warnings) = builder.build().expect("the test's scene builds");
        assert!(warnings.is_empty(), "{:?}", warnings.iter().next());
        let scene = Arc::new(scene);
        let tracer = Arc::new(tracer(&scene));
        let vertices = VertexBasis::new(scene.clone());
        Self { scene, tracer, vertices }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The operator on a basis.
    pub fn operator(&self, storage: Storage, plan: Plan) -> Operator {
        fn of<B: Basis + 'static>(stage: &Stage, basis: B, storage: Storage, plan: Plan) -> Operator {
            let basis = Arc::new(basis);
            let (scene, tracer) = (stage.scene.clone(), stage.tracer.clone());
            let transport = Box::new(CpuTransport::new(scene, tracer, basis.clone(), basis.clone(), plan));
            Operator { basis, transport, storage }
        }
        match storage {
            Storage::Vertex => of(self, self.vertices.clone(), storage, plan),
            Storage::VertexArea => of(self, AreaVertexBasis::new(self.vertices.clone()), storage, plan),
        }
    }

    /// The operator from the vertices to points with normals.
    pub fn points(&self, points: &[(Vec3, Vec3)], plan: Plan) -> Box<dyn Transport> {
        let receivers = PointReceivers::new(points.iter().copied()).expect("points have normals");
        let (scene, tracer) = (self.scene.clone(), self.tracer.clone());
        let source = Arc::new(self.vertices.clone());
        Box::new(CpuTransport::new(scene, tracer, source, Arc::new(receivers), plan))
    }

    /// A field over the vertices whose value is `f` of position and normal.
    pub fn field(&self, f: impl Fn(Vec3, Vec3) -> f32) -> Field {
        let mut values = vec![Vec3::ZERO; self.vertices.node_count()];
        for (vertex, node) in self.vertices.node_of_vertex().iter().enumerate() {
            let value = f(self.scene.positions()[vertex], self.scene.normals()[vertex]);
            values[node.index()] = Vec3::splat(value);
        }
        Field::from_values(values)
    }

    /// Position and normal of each node.
    pub fn nodes(&self) -> Vec<(Vec3, Vec3)> {
        let mut nodes = vec![(Vec3::ZERO, Vec3::ZERO); self.vertices.node_count()];
        for (vertex, node) in self.vertices.node_of_vertex().iter().enumerate().rev() {
            nodes[node.index()] = (self.scene.positions()[vertex], self.scene.normals()[vertex]);
        }
        nodes
    }

    /// What an operator should measure of the irradiance `f` of point and normal: no discretisation left.
    ///
    /// At points, `f` where the rays start; over areas, its mean under the hat function, by quadrature.
    pub fn expected(&self, operator: &Operator, f: &dyn Fn(DVec3, DVec3) -> f64) -> Vec<f64> {
        match operator.storage {
            Storage::Vertex => {
                let mut nodes = NodeWeights::default();
                (0..self.vertices.element_count() as u32)
                    .map(|e| self.vertices.receiver(ElementId(e), [0.5; 2], &mut nodes))
                    .map(|site| f(site.origin.as_dvec3(), site.frame.normal.as_dvec3()))
                    .collect()
            }
            Storage::VertexArea => hat_average(&self.scene, &*operator.basis, 8, f),
        }
    }
}

/// Applies an operator once.
pub fn measure(transport: &dyn Transport, source: Source<'_>, pass: u32) -> Measured {
    let job = Job { source, bounce: 0, pass, active: None };
    accumulate(transport, &job, &Control::default(), None).expect("nobody cancels")
}

/// Applies an operator `n` times with independent samples.
pub fn replicates(transport: &dyn Transport, source: Source<'_>, n: u32) -> Vec<Field> {
    (0..n).map(|pass| measure(transport, source, pass).field).collect()
}
