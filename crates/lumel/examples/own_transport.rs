//! A transport of your own: a dense matrix, measured once and then applied without rays or scenes.
//!
//! Whatever can say what a chunk of elements receives is a transport: another device, other machines, a table. This one
//! asks another operator for the light that reaches every node from every node, and multiplies.
//!
//! `cargo run --release -p lumel --example own_transport`

#![allow(clippy::print_stdout, reason = "an example is a program")]

use lumel_accel::Bvh;
use lumel_basis::{Basis, Field, NodeId, PointReceivers, VertexBasis, reflecting_areas};
use lumel_solve::{Gather, Integrals, Operator, Silent, SolveState, Stop, solve};
use lumel_transport::{
    CachedTransport, ChunkSink, Control, CpuTransport, Job, Plan, Shape, Source, Sums, Transport,
    TransportError, accumulate,
};
use std::ops::Range;
use std::sync::Arc;

/// Rows of a chunk.
const ROWS: u32 = 64;

/// The operator K as a matrix; direct light is left to the operator it was made from.
struct Matrix<T> {
    inner: T,
    n: u32,
    /// Column by column: what each node gets of one unit at a node.
    columns: Vec<Vec<glam::Vec3>>,
}

impl<T: Transport> Matrix<T> {
    fn new(inner: T, control: &Control) -> Result<Self, TransportError> {
        let n = inner.shape().nodes as u32;
        let column = |node: u32| {
            let mut unit = Field::zeros(n as usize);
            unit.coefficients_mut(NodeId(node))[0] = glam::Vec3::ONE;
            let job = Job { source: Source::Field(&unit), bounce: 1, pass: 0, active: None };
            Ok(accumulate(&inner, &job, control, None)?.field.values().to_vec())
        };
        let columns = (0..n).map(column).collect::<Result<_, TransportError>>()?;
        Ok(Self { inner, n, columns })
    }

    /// What a node gets of a field.
    fn row(&self, node: usize, field: &Field) -> glam::DVec3 {
        let products = self.columns.iter().zip(field.values());
        products.map(|(column, e)| column[node].as_dvec3() * e.as_dvec3()).sum()
    }
}

impl<T: Transport> Transport for Matrix<T> {
    fn shape(&self) -> Shape {
        Shape { chunks: self.n.div_ceil(ROWS), ..self.inner.shape() }
    }

    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        // What is no bounce is measured as a whole, and handed on in our chunks.
        let other = match job.source {
            Source::Field(_) => None,
            _ => Some(accumulate(&self.inner, job, control, None)?),
        };
        for chunk in chunks {
            control.check()?;
            let rows = chunk * ROWS..self.n.min((chunk + 1) * ROWS);
            control.count(rows.len() as u64, 0);
            let mut sums = Sums::default();
            for node in rows.map(NodeId) {
                match (&other, job.source) {
                    (None, Source::Field(field)) => sums.push(node, 1.0, self.row(node.index(), field)),
                    (Some(measured), Source::Nothing) => {
                        sums.push_hidden(node, 1.0, measured.hidden[node.index()].into());
                    }
                    (Some(measured), _) if measured.known[node.index()] => {
                        sums.push(node, 1.0, measured.field.node(node).0.as_dvec3());
                    }
                    _ => {}
                }
            }
            sink.accept(chunk, sums);
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let opened = lumel::open("furnace", &lumel::OpenOptions::default())?;
    let scene = Arc::new(opened.builder.build()?.0);
    let basis = Arc::new(VertexBasis::new(Arc::clone(&scene)));
    let receivers = Arc::new(PointReceivers::at_vertices(&basis));
    let tracer = Arc::new(Bvh::build(&scene));
    let plan = Plan { direct_samples: 4, indirect_samples: 64, ..Plan::default() };
    let traced = || {
        let (scene, receivers) = (Arc::clone(&scene), Arc::clone(&receivers));
        CpuTransport::new(scene, Arc::clone(&tracer) as _, Arc::clone(&basis), receivers, plan)
    };
    let control = Control::default();
    let matrix = Matrix::new(CachedTransport::new(traced(), None), &control)?;
    let rays = control.rays();

    let integrals = Integrals::new(basis.node_areas().to_vec(), reflecting_areas(&scene, &*basis));
    let solved = |transport: &dyn Transport| {
        let (mut state, schedule) = (SolveState::new(), Gather { stop: Stop::Bounces(8) });
        let operator = Operator::new(transport, &*basis);
        solve(operator, &integrals, &schedule, &mut state, &control, &Silent).map(|()| state.total())
    };
    let (by_matrix, by_rows) = (solved(&matrix)?, solved(&CachedTransport::new(traced(), None))?);
    let differences = by_matrix.values().iter().zip(by_rows.values()).map(|(a, b)| (*a - *b).length());
    let largest = differences.fold(0.0, f32::max);
    println!("a matrix of {0} × {0} from {rays} rays; its light differs by {largest:e} W/m²", matrix.n);
    if largest > 1e-4 {
        return Err("the matrix is not the operator".into());
    }
    Ok(())
}
