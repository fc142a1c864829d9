//! Where renderers are compared.

use crate::BOUNCES;
use glam::Vec3;
use lumel::{Baker, BounceLimit, Bvh, Control, Projection, RayTracer, Scene, Settings, SolveState};
use lumel_basis::{Lighting, PointReceivers, VertexBasis, VertexLighting};
use lumel_scene::SurfacePoint;
use lumel_testkit::random_surface_points;
use lumel_transport::{CpuTransport, Job, Plan, Source, accumulate};
use std::sync::Arc;

/// Random points of the surfaces that are compared, but for those inside geometry.
const SURFACE_POINTS: u32 = 2000;

/// Where renderers are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Places {
    /// At the nodes. lumel solves for the light at just these points.
    Nodes,
    /// At random points, uniform by area over all surfaces. lumel solves for the light on all surfaces and reads it there.
    Surfaces,
}

impl Places {
    pub(crate) fn named(name: &str) -> Self {
        match name {
            "nodes" => Self::Nodes,
            "surfaces" => Self::Surfaces,
            _ => panic!("renderers are compared at nodes or surfaces, not at {name}"),
        }
    }

    /// What lumel solves with.
    pub(crate) fn settings(self) -> Settings {
        let projection = match self {
            Self::Nodes => Projection::Point,
            Self::Surfaces => Projection::LeastSquares,
        };
        Settings { projection, bounces: BounceLimit::Count(BOUNCES), ..Settings::default() }
    }

    /// Where light is measured by whoever measures at points.
    pub(crate) fn receivers(self, scene: &Arc<Scene>) -> PointReceivers {
        match self {
            Self::Nodes => PointReceivers::at_vertices(&Arc::new(VertexBasis::new(Arc::clone(scene)))),
            Self::Surfaces => at_points(scene, &surface_points(scene)),
        }
    }

    /// The coefficients of a solve: at the nodes as they are, or as they are read at all vertices. W·m⁻².
    pub(crate) fn values(self, baker: &Baker, state: &SolveState) -> Vec<Vec3> {
        match self {
            Self::Nodes => state.total().values().to_vec(),
            Self::Surfaces => baker.light_at_vertices(state),
        }
    }

    /// The light at the receivers, from the values of a solve.
    pub(crate) fn read(self, scene: &Arc<Scene>, values: Vec<Vec3>) -> Vec<Vec3> {
        match self {
            Self::Nodes => values,
            Self::Surfaces => {
                let light = VertexLighting::new(scene, &values).unwrap();
                let read = |at| light.irradiance(at, scene.geometric_normal(at.tri)).0;
                surface_points(scene).into_iter().map(read).collect()
            }
        }
    }
}

/// Random points of all surfaces but for those inside geometry.
fn surface_points(scene: &Arc<Scene>) -> Vec<SurfacePoint> {
    let points = random_surface_points(scene, SURFACE_POINTS, 12);
    let basis = Arc::new(VertexBasis::new(Arc::clone(scene)));
    let receivers = Arc::new(at_points(scene, &points));
    let tracer: Arc<dyn RayTracer> = Arc::new(Bvh::build(scene));
    let transport = CpuTransport::new(Arc::clone(scene), tracer, basis, receivers, Plan::default());
    let job = Job { source: Source::Nothing, bounce: 0, pass: 0, active: None };
    let measured = accumulate(&transport, &job, &Control::default(), None).unwrap();
    points.into_iter().zip(measured.visible()).filter(|(_, visible)| *visible).map(|(at, _)| at).collect()
}

fn at_points(scene: &Scene, points: &[SurfacePoint]) -> PointReceivers {
    let site = |at: &SurfacePoint| (*at, scene.geometric_normal(at.tri));
    PointReceivers::on_surfaces(scene, points.iter().map(site)).unwrap()
}
