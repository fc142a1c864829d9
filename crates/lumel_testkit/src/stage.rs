//! A built scene with its ray tracer, and operators on it.

use crate::combination::{Method, Solver, Storage};
use crate::quadrature::hat_average;
use crate::stored::StoredPasses;
use glam::{DVec3, Vec3};
use lumel_accel::{Bvh, InstructionSet, RayTracer, SeeThrough, tracer_of};
use lumel_basis::{
    AreaReceivers, Directional, ElementId, Field, PointReceivers, Receivers, VertexBasis, reflecting_areas,
};
use lumel_scene::{Scene, SceneBuilder};
use lumel_transport::{
    Control, CpuTransport, DirectionalTransport, Job, Measured, Plan, Source, Transport, accumulate,
};
use std::sync::{Arc, Mutex};

/// A scene that rays can be traced in.
pub struct Stage {
    scene: Arc<Scene>,
    tracer: Arc<dyn RayTracer>,
    basis: Arc<VertexBasis>,
}

/// A basis and the operator on it.
pub struct Operator {
    /// The basis.
    pub basis: Arc<VertexBasis>,
    /// The operator from this basis to itself.
    pub transport: Box<dyn Transport>,
    storage: Storage,
}

/// The ray tracer of a scene, with the instructions that the environment variable `LUMEL_TEST_INSTRUCTIONS` names, such as
/// `portable`; with the best that there are without it.
pub fn tracer(scene: &Scene) -> Arc<dyn RayTracer> {
    let Some(name) = std::env::var_os("LUMEL_TEST_INSTRUCTIONS") else { return tracer_of(scene) };
    let is_meant = |set: &InstructionSet| name.eq_ignore_ascii_case(set.to_string());
    let set = InstructionSet::available().into_iter().find(is_meant);
    let set = set.unwrap_or_else(|| panic!("this machine has no instructions {name:?}"));
    let traced: Option<Arc<dyn RayTracer>> = match scene.has_transparent() {
        true => SeeThrough::build(scene).with_instructions(set).map(|tracer| Arc::new(tracer) as _),
        false => Bvh::build(scene).with_instructions(set).map(|tree| Arc::new(tree) as _),
    };
    traced.unwrap_or_else(|| panic!("{set} is there"))
}

impl Stage {
    /// Builds a scene that must be sound.
    pub fn new(builder: SceneBuilder) -> Self {
        let (scene, warnings) = builder.build().expect("the test's scene builds");
        assert!(warnings.is_empty(), "{:?}", warnings.iter().next());
        let scene = Arc::new(scene);
        let tracer = tracer(&scene);
        let basis = Arc::new(VertexBasis::new(scene.clone()));
        Self { scene, tracer, basis }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The basis that all operators here read.
    pub fn basis(&self) -> &Arc<VertexBasis> {
        &self.basis
    }

    /// The operator of a method.
    pub fn operator(&self, method: Method, plan: Plan) -> Operator {
        let transport = match method.storage {
            Storage::Vertex => self.towards(method.solver, PointReceivers::at_vertices(&self.basis), plan),
            Storage::VertexArea => self.towards(method.solver, AreaReceivers::new(self.basis.clone()), plan),
        };
        Operator { basis: self.basis.clone(), transport, storage: method.storage }
    }

    /// The operator from the vertices to some receivers.
    pub fn towards<R: Receivers + 'static>(
        &self,
        solver: Solver,
        receivers: R,
        plan: Plan,
    ) -> Box<dyn Transport> {
        let (scene, tracer) = (self.scene.clone(), self.tracer.clone());
        let (basis, receivers) = (self.basis.clone(), Arc::new(receivers));
        match solver {
            Solver::Traced => Box::new(CpuTransport::new(scene, tracer, basis, receivers, plan)),
            Solver::Stored => {
                let stored = Mutex::default();
                Box::new(StoredPasses { scene, tracer, basis, receivers, plan, stored })
            }
        }
    }

    /// The operator from the vertices to some receivers that measures light by direction.
    pub fn directional<R: Receivers + 'static>(
        &self,
        receivers: R,
        kind: Directional,
        plan: Plan,
    ) -> Box<dyn Transport> {
        let (scene, tracer) = (self.scene.clone(), self.tracer.clone());
        let inner = CpuTransport::new(scene, tracer, self.basis.clone(), Arc::new(receivers), plan);
        Box::new(DirectionalTransport::new(inner, kind))
    }

    /// The operator from the vertices to points with normals.
    pub fn points(&self, solver: Solver, points: &[(Vec3, Vec3)], plan: Plan) -> Box<dyn Transport> {
        let receivers =
            PointReceivers::new(&self.scene, points.iter().copied()).expect("points have normals");
        self.towards(solver, receivers, plan)
    }

    /// The integral of albedo times each basis function, m².
    pub fn reflecting_areas(&self) -> Vec<Vec3> {
        reflecting_areas(&self.scene, &*self.basis)
    }

    /// A field over the vertices whose value is `f` of position and normal.
    pub fn field(&self, f: impl Fn(Vec3, Vec3) -> f32) -> Field {
        let value = |(position, normal)| Vec3::splat(f(position, normal));
        Field::from_values(self.nodes().into_iter().map(value).collect())
    }

    /// Position and normal of each node.
    pub fn nodes(&self) -> Vec<(Vec3, Vec3)> {
        let of =
            |&vertex: &u32| (self.scene.positions()[vertex as usize], self.scene.normals()[vertex as usize]);
        self.basis.first_vertices().iter().map(of).collect()
    }

    /// What an operator should measure of the irradiance `f` of point and normal: no discretisation left.
    ///
    /// At points, `f` where the rays start; over areas, its mean under the hat function, by quadrature.
    pub fn expected(&self, operator: &Operator, f: &dyn Fn(DVec3, DVec3) -> f64) -> Vec<f64> {
        match operator.storage {
            Storage::Vertex => {
                let receivers = PointReceivers::at_vertices(&self.basis);
                (0..receivers.element_count() as u32)
                    .map(|e| receivers.central_site(ElementId(e)))
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
