//! What is prepared once for a scene's surfaces, whatever its lights.

use crate::BounceBasis;
use crate::settings::Settings;
use lumel_accel::RayTracer;
use lumel_basis::{
    AreaReceivers, Basis, LeastSquares, MeshlessBasis, PointReceivers, Receivers, VertexBasis, VertexPoints,
};
use lumel_scene::Scene;
use lumel_transport::{CpuTransport, Order, Plan, SurfaceWalks};
use std::sync::{Arc, OnceLock};

/// The ray tracer, the basis and the receivers of a scene; cheap to clone, and shared by its [relit](Scene::relit) ones.
#[derive(Clone)]
pub(crate) struct Surfaces {
    pub(crate) tracer: Arc<dyn RayTracer>,
    /// What bounces are carried on.
    pub(crate) basis: Arc<BounceBasis>,
    /// The piecewise linear basis on the vertices, where light is read in the end.
    pub(crate) vertices: Arc<VertexBasis>,
    pub(crate) points: Arc<VertexPoints>,
    at_vertices: Arc<OnceLock<Ordered<PointReceivers>>>,
    over_areas: Arc<OnceLock<Ordered<AreaReceivers>>>,
    least_squares: Arc<OnceLock<LeastSquares>>,
    at_nodes: Arc<OnceLock<Ordered<PointReceivers>>>,
}

/// Receivers in the order in which they are measured.
#[derive(Clone)]
pub(crate) struct Ordered<R> {
    pub(crate) receivers: Arc<R>,
    pub(crate) order: Order,
}

impl<R: Receivers> Ordered<R> {
    fn new(receivers: R) -> Self {
        let order = Order::new(&receivers);
        Self { receivers: Arc::new(receivers), order }
    }
}

impl Surfaces {
    pub(crate) fn new(scene: &Arc<Scene>, tracer: Arc<dyn RayTracer>, settings: &Settings) -> Self {
        let vertices = Arc::new(VertexBasis::new(Arc::clone(scene)));
        let points = Arc::new(VertexPoints::new(scene));
        let on_vertices = Self {
            tracer,
            basis: Arc::new(BounceBasis::Vertices(Arc::clone(&vertices))),
            vertices,
            points,
            at_nodes: Arc::default(),
            at_vertices: Arc::default(),
            over_areas: Arc::default(),
            least_squares: Arc::default(),
        };
        on_vertices.carrying(settings)
    }

    /// The same surfaces with the basis that bounces are carried on with these settings.
    pub(crate) fn carrying(&self, settings: &Settings) -> Self {
        let scene = self.vertices.scene();
        let spacing = settings.point_spacing.on(scene);
        let wanted = spacing.map(|spacing| (spacing, settings.levels));
        if self.basis.points().map(|points| (points.spacing(), points.level_count())) == wanted {
            return self.clone();
        }
        let basis = match wanted {
            None => BounceBasis::Vertices(Arc::clone(&self.vertices)),
            Some((spacing, levels)) => {
                let obstacles = SurfaceWalks { scene, tracer: &*self.tracer };
                let points = MeshlessBasis::around_obstacles(Arc::clone(scene), spacing, levels, &obstacles);
                // Kernels blur the edges of shadows by more than vertices do that lie closer together.
                let is_finer = self.vertices.node_count() > points.node_count();
                let direct = is_finer.then(|| Arc::clone(&self.vertices));
                BounceBasis::Points { points: Arc::new(points), direct }
            }
        };
        Self { basis: Arc::new(basis), at_nodes: Arc::default(), ..self.clone() }
    }

    /// The operator that measures there under the light of a scene with these surfaces, every job of which traces rays of its own.
    pub(crate) fn traced<R: Receivers>(
        &self,
        scene: &Arc<Scene>,
        measured: &Ordered<R>,
        plan: Plan,
    ) -> CpuTransport<BounceBasis, R> {
        let (tracer, basis) = (Arc::clone(&self.tracer), Arc::clone(&self.basis));
        let measured = (Arc::clone(&measured.receivers), measured.order.clone());
        CpuTransport::in_order(Arc::clone(scene), tracer, basis, measured, plan)
    }

    /// Measures at the scattered points; at the vertices where there are none.
    pub(crate) fn at_nodes(&self) -> &Ordered<PointReceivers> {
        match self.basis.points() {
            Some(points) => self.at_nodes.get_or_init(|| Ordered::new(PointReceivers::at_nodes(points))),
            None => self.at_vertices(),
        }
    }

    /// Measures at the vertices.
    pub(crate) fn at_vertices(&self) -> &Ordered<PointReceivers> {
        self.at_vertices.get_or_init(|| Ordered::new(PointReceivers::at_vertices(&self.vertices)))
    }

    /// Measures over the triangles around vertices.
    pub(crate) fn over_areas(&self) -> &Ordered<AreaReceivers> {
        self.over_areas.get_or_init(|| Ordered::new(AreaReceivers::new(Arc::clone(&self.vertices))))
    }

    /// Reads what is measured over areas as the nearest function.
    pub(crate) fn least_squares(&self) -> &LeastSquares {
        self.least_squares.get_or_init(|| LeastSquares::new(&self.vertices, LeastSquares::ALPHA))
    }
}
