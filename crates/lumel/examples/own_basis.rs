//! A basis of your own: one constant per triangle, the radiosity of old.
//!
//! It is solved by the transport and the solver as they are. A basis says what its coefficients mean, receivers say where
//! they are measured; both together are these few dozen lines.
//!
//! `cargo run --release -p lumel --example own_basis`

#![allow(clippy::print_stdout, reason = "an example is a program")]

use lumel_accel::Bvh;
use lumel_basis::{
    Adjacency, Basis, ElementId, Identity, NodeId, NodeWeights, Receivers, Sampling, Site, reflecting_areas,
};
use lumel_sample::{Frame, uniform_triangle};
use lumel_scene::{Scene, SurfacePoint, TriId};
use lumel_solve::{Gather, Integrals, Operator, Silent, SolveState, Stop, solve};
use lumel_transport::{CachedTransport, Control, CpuTransport, Plan};
use std::sync::Arc;

/// Functions that are constant on each triangle of a scene; measured over the triangles.
struct TriangleBasis {
    scene: Arc<Scene>,
    areas: Vec<f32>,
    adjacency: Adjacency,
}

impl TriangleBasis {
    fn new(scene: Arc<Scene>) -> Self {
        let n = scene.triangle_count();
        let areas = (0..n as u32).map(|tri| scene.area(TriId(tri))).collect();
        // Triangles are next to each other if they share a vertex: every vertex is a cell of its triangles, in pairs.
        let mut around = vec![Vec::new(); scene.vertex_count()];
        for (tri, corners) in (0..).map(NodeId).zip(scene.triangles()) {
            corners.iter().for_each(|&vertex| around[vertex as usize].push(tri));
        }
        let pairs =
            around.iter().flat_map(|ring: &Vec<NodeId>| ring.windows(2).map(|pair| [pair[0], pair[1]]));
        let adjacency = Adjacency::from_cells(n, pairs);
        Self { scene, areas, adjacency }
    }
}

impl Basis for TriangleBasis {
    fn identity(&self) -> Identity {
        Identity::new("triangles, constant", [&self.scene.geometry_hash().as_bytes()[..]])
    }

    fn node_count(&self) -> usize {
        self.areas.len()
    }

    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        weights.push(NodeId(at.tri.0), 1.0);
    }

    fn node_areas(&self) -> &[f32] {
        &self.areas
    }

    fn adjacency(&self) -> &Adjacency {
        &self.adjacency
    }
}

impl Receivers for TriangleBasis {
    fn identity(&self) -> Identity {
        Basis::identity(self).derived("areas of triangles")
    }

    fn node_count(&self) -> usize {
        self.areas.len()
    }

    fn element_count(&self) -> usize {
        self.areas.len()
    }

    fn sampling(&self) -> Sampling {
        Sampling::Area
    }

    fn nodes_of(&self, element: ElementId, nodes: &mut Vec<NodeId>) {
        nodes.push(NodeId(element.0));
    }

    fn site(&self, element: ElementId, u: [f32; 2]) -> Site {
        let tri = TriId(element.0);
        let at = SurfacePoint { tri, bary: uniform_triangle(u).into() };
        let normal = self.scene.geometric_normal(tri);
        Site {
            origin: self.scene.ray_origin(at),
            frame: Frame::from_normal(normal),
            skip: Some(self.scene.traced(tri)),
        }
    }

    fn towards(&self, element: ElementId, _: [f32; 2], nodes: &mut NodeWeights) {
        nodes.push(NodeId(element.0), 1.0);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let opened = lumel::open("cornell-box", &lumel::OpenOptions::default())?;
    let scene = Arc::new(opened.builder.build()?.0);
    let basis = Arc::new(TriangleBasis::new(Arc::clone(&scene)));
    let plan = Plan { direct_samples: 16, indirect_samples: 64, ..Plan::default() };
    let tracer = Arc::new(Bvh::build(&scene));
    let traced = CpuTransport::new(Arc::clone(&scene), tracer, Arc::clone(&basis), Arc::clone(&basis), plan);
    let transport = CachedTransport::new(traced, None);

    let integrals = Integrals::new(basis.areas.clone(), reflecting_areas(&scene, &*basis));
    let operator = Operator::new(&transport, &*basis);
    let (mut state, schedule) = (SolveState::new(), Gather { stop: Stop::Bounces(3) });
    solve(operator, &integrals, &schedule, &mut state, &Control::default(), &Silent)?;

    let mean = integrals.mean(&state.total());
    println!("{} triangles, {mean:.3} W/m² on average", basis.areas.len());
    // The vertex basis has the same power: both conserve it.
    let baked = lumel::Bake::of_scene(scene).bounces(3).run()?;
    let areas = baked.baker().basis().node_areas().to_vec();
    let vertices = Integrals::new(areas, Vec::new()).mean(&baked.state().total());
    println!("at vertices           {vertices:.3} W/m²");
    if (mean / vertices - 1.0).abs() > 0.02 {
        return Err(format!("the two bases disagree: {mean} and {vertices} W/m²").into());
    }
    Ok(())
}
