//! What is prepared once for a scene's surfaces, whatever its lights.

use lumel_accel::RayTracer;
use lumel_basis::{AreaReceivers, LeastSquares, PointReceivers, Receivers, VertexBasis, VertexPoints};
use lumel_scene::Scene;
use lumel_transport::Order;
use std::sync::{Arc, OnceLock};

/// The ray tracer, the basis and the receivers of a scene; cheap to clone, and shared by its [relit](Scene::relit) ones.
#[derive(Clone)]
pub(crate) struct Surfaces {
    pub(crate) tracer: Arc<dyn RayTracer>,
    /// The piecewise linear basis on the vertices, which all solves read.
    pub(crate) basis: Arc<VertexBasis>,
    pub(crate) points: Arc<VertexPoints>,
    at_vertices: Arc<OnceLock<Ordered<PointReceivers>>>,
    over_areas: Arc<OnceLock<Ordered<AreaReceivers>>>,
    least_squares: Arc<OnceLock<LeastSquares>>,
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
    pub(crate) fn new(scene: &Arc<Scene>, tracer: Arc<dyn RayTracer>) -> Self {
        let basis = Arc::new(VertexBasis::new(Arc::clone(scene)));
        let points = Arc::new(VertexPoints::new(scene));
        Self {
            tracer,
            basis,
            points,
            at_vertices: Arc::default(),
            over_areas: Arc::default(),
            least_squares: Arc::default(),
        }
    }

    /// Measures at the vertices.
    pub(crate) fn at_vertices(&self) -> &Ordered<PointReceivers> {
        self.at_vertices.get_or_init(|| Ordered::new(PointReceivers::at_vertices(&self.basis)))
    }

    /// Measures over the triangles around vertices.
    pub(crate) fn over_areas(&self) -> &Ordered<AreaReceivers> {
        self.over_areas.get_or_init(|| Ordered::new(AreaReceivers::new(Arc::clone(&self.basis))))
    }

    /// Reads what is measured over areas as the nearest function.
    pub(crate) fn least_squares(&self) -> &LeastSquares {
        self.least_squares.get_or_init(|| LeastSquares::new(&self.basis, LeastSquares::ALPHA))
    }
}
