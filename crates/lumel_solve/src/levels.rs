//! Measuring the fine levels of a hierarchy only where coarse ones say too little.

use crate::SolveState;
use crate::observer::{Observer, Step};
use crate::operator::Operator;
use crate::solver::{self, SolveError};
use lumel_basis::{Basis, Field, Hierarchy, NodeId, Sampling};
use lumel_scene::luminance;
use lumel_transport::{
    ChunkSink, Control, Job, Measured, Pass, Passes, Shape, Source, Sums, Transport, TransportError,
    accumulate,
};
use std::ops::Range;
use std::sync::Arc;

/// Levels that are measured everywhere: what is smaller than the finest of them may be missed.
const WHOLE_LEVELS: u32 = 2;

/// What light must differ by, in standard errors: less may be noise.
const SIGNIFICANT: f64 = 3.0;

/// Makes operators that measure some nodes of a hierarchy and keep their rays.
pub trait Halves: Sync {
    /// The operator of one half of the samples: 0 or 1.
    fn operator(&self, half: u32, nodes: &[bool]) -> Box<dyn Transport>;

    /// Measures direct light at all nodes; `None` if it takes hemisphere rays, so that it is measured where bounces are.
    fn direct(&self) -> Option<&dyn Transport>;
}

/// How far a hierarchy is refined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// What nodes of a level may differ by from what coarser levels say, relative to the light there, unless finer ones are measured.
    pub error: f64,
    /// Nodes that are measured at most.
    pub max_nodes: usize,
}

/// A hierarchy of which some nodes are measured.
pub struct RefinedLevels<'a> {
    transport: Grown<'a>,
    valid: Vec<bool>,
    /// Whether no more nodes were allowed where light wants them.
    pub is_cut: bool,
}

impl<'h> RefinedLevels<'h> {
    /// Finds the nodes that are worth measuring.
    ///
    /// Nodes of the two coarsest levels all are. Of a finer level those are that a node of the level before overlaps whose
    /// coefficient is above the error and above noise, which the two halves of its samples tell. Coefficients are those of the first bounce. Direct
    /// light, whose shadows are too sharp for nodes, is measured before in the basis that holds it, if there is one. Otherwise it is measured at
    /// all nodes where that takes no hemisphere rays; else it counts as a bounce does. `of_all` is the operator of all nodes.
    ///
    /// # Errors
    /// When it is cancelled or an operator fails.
    pub fn new(
        of_all: Operator<'_>,
        hierarchy: &dyn Hierarchy,
        halves: &'h dyn Halves,
        refinement: Refinement,
        state: &mut SolveState,
        control: &Control,
        observer: &dyn Observer,
    ) -> Result<Self, SolveError> {
        if of_all.reflected_direct().is_some() {
            solver::measure_direct(of_all, state, control, observer)?;
        }
        observer.step_started(Step::Validity);
        let basis = of_all.basis;
        let nodes = basis.node_count();
        let mut growing = Growing {
            basis,
            hierarchy,
            halves,
            control,
            active: vec![false; nodes],
            valid: vec![false; nodes],
            direct: Field::zeros(nodes),
            values: Field::zeros(nodes),
            variances: vec![0.0; nodes],
            passes: Passes::default(),
        };
        let (direct, in_other) = (halves.direct(), state.direct_in(basis));
        let everywhere = match direct.filter(|_| in_other.is_none()) {
            None => None,
            Some(direct) => {
                let job = Job { source: Source::Emitters(None), bounce: 0, pass: 0, active: None };
                let mut field = accumulate(direct, &job, control, None)?.field;
                hierarchy.analyze(&mut field, None);
                Some(field)
            }
        };
        let lit = in_other.map(|direct| Source::Reflecting { direct, carried: None });
        let lit = lit.or(everywhere.as_ref().map(Source::Field));
        let mut is_cut = false;
        let coarse = hierarchy.level_count().min(WHOLE_LEVELS);
        let mut fresh: Vec<NodeId> =
            (0..coarse).flat_map(|level| hierarchy.nodes_of_level(level)).map(NodeId).collect();
        let mut level = coarse - 1;
        while !fresh.is_empty() {
            if growing.count() + fresh.len() > refinement.max_nodes && level >= coarse {
                is_cut = true;
                break;
            }
            growing.add(&fresh, lit)?;
            if level + 1 >= hierarchy.level_count() {
                break;
            }
            let marked = growing.marked(level, refinement.error);
            fresh = hierarchy.finer(level, &marked);
            level += 1;
        }
        let Growing { active, valid, passes, .. } = growing;
        Ok(Self { transport: Grown { direct, passes, active }, valid, is_cut })
    }

    /// The operator of the nodes that are measured.
    pub fn operator<'a>(&'a self, of_all: Operator<'a>) -> Operator<'a> {
        Operator { transport: &self.transport, active: Some(&self.transport.active), ..of_all }
    }

    /// Which nodes are measured.
    pub fn active(&self) -> &[bool] {
        &self.transport.active
    }

    /// Prepares a state that is new: which nodes lie inside geometry is known.
    pub fn prepare(&self, basis: &dyn Basis, state: &mut SolveState) {
        if state.valid.is_empty() {
            state.valid.clone_from(&self.valid);
            state.basis = Some(basis.identity());
        }
    }
}

/// A hierarchy to which measured nodes are added.
struct Growing<'a> {
    basis: &'a dyn Basis,
    hierarchy: &'a dyn Hierarchy,
    halves: &'a dyn Halves,
    control: &'a Control,
    /// Nodes that are measured, those inside geometry included.
    active: Vec<bool>,
    valid: Vec<bool>,
    /// Direct light at active nodes, where that is all that is known of it.
    direct: Field,
    /// Light at active nodes that decides.
    values: Field,
    /// Of `values`, luminance.
    variances: Vec<f64>,
    passes: Passes,
}

impl Growing<'_> {
    fn count(&self) -> usize {
        self.active.iter().filter(|active| **active).count()
    }

    /// Measures the first bounce at some more nodes, of direct light where it is known everywhere (`lit`), or else of what is known of it with
    /// these nodes, whose own direct light then counts, too.
    fn add(&mut self, fresh: &[NodeId], lit: Option<Source<'_>>) -> Result<(), SolveError> {
        let mut nodes = vec![false; self.active.len()];
        fresh.iter().for_each(|node| nodes[node.index()] = true);
        let nodes: Arc<[bool]> = nodes.into();
        let passes =
            [0, 1].map(|half| Pass::new(self.halves.operator(half, &nodes), Arc::clone(&nodes), 1.0));
        let measure = |source, bounce, active| {
            let job = Job { source, bounce, pass: 0, active };
            let [a, b] = &passes;
            Ok::<[Sums; 2], TransportError>([a.measure(&job, self.control)?, b.measure(&job, self.control)?])
        };
        let merged = |sums: &[Sums]| Measured::merge(nodes.len(), 1, sums);
        let seen: Vec<bool> = merged(&measure(Source::Nothing, 0, None)?).visible().collect();
        for &node in fresh {
            self.active[node.index()] = true;
            self.valid[node.index()] = seen[node.index()];
        }
        let (mut found, mut so_far) = (Vec::new(), Field::zeros(0));
        let lit = match lit {
            Some(lit) => lit,
            None => {
                let direct = measure(Source::Emitters(None), 0, Some(&seen))?;
                let mean = merged(&direct).field;
                for &node in fresh {
                    self.direct.coefficients_mut(node).copy_from_slice(mean.coefficients(node));
                }
                found.push(direct);
                so_far.clone_from(&self.direct);
                self.operator().complete(&mut so_far, &self.valid);
                Source::Field(&so_far)
            }
        };
        found.push(measure(lit, 1, Some(&seen))?);
        for sums in &found {
            let [mean, a, b] = [&sums[..], &sums[..1], &sums[1..]].map(|sums| merged(sums).field);
            for &node in fresh {
                let sum = self.values.node(node).0 + mean.node(node).0;
                self.values.coefficients_mut(node)[0] = sum;
                let difference = luminance(a.node(node).0 - b.node(node).0);
                self.variances[node.index()] += 0.25 * f64::from(difference).powi(2);
            }
        }
        passes.into_iter().for_each(|pass| self.passes.push(pass));
        Ok(())
    }

    fn operator(&self) -> Operator<'_> {
        Operator { active: Some(&self.active), ..Operator::new(&self.passes, self.basis) }
    }

    /// Which nodes of a level differ by too much from what coarser levels say.
    fn marked(&self, level: u32, error: f64) -> Vec<bool> {
        let (mut values, mut coefficients) = (self.values.clone(), self.values.clone());
        self.operator().extrapolate(&mut values, &self.valid);
        self.operator().complete(&mut coefficients, &self.valid);
        let areas = self.basis.node_areas();
        let coarsest = self.hierarchy.nodes_of_level(0);
        let light = |node: u32| f64::from(luminance(values.node(NodeId(node)).0));
        let (sum, area) = coarsest.fold((0.0, 0.0), |(sum, all), node| {
            let area = f64::from(areas[node as usize]);
            (sum + area * light(node), all + area)
        });
        let floor = if area > 0.0 { sum / area } else { 0.0 };
        let mut marked = vec![false; self.active.len()];
        for node in self.hierarchy.nodes_of_level(level).filter(|node| self.valid[*node as usize]) {
            let neighbours = self.basis.adjacency().neighbourhood(NodeId(node));
            let known = neighbours.filter(|node| self.valid[node.index()]);
            let (sum, n) =
                known.fold((0.0, 0.0), |(sum, n), node| (sum + self.variances[node.index()], n + 1.0));
            let noise = SIGNIFICANT * (sum / n).sqrt();
            let coefficient = f64::from(luminance(coefficients.node(NodeId(node)).0.abs()));
            marked[node as usize] = coefficient > (error * light(node).max(floor)).max(noise);
        }
        marked
    }
}

/// Operators of nodes that were added one after the other, and one of direct light everywhere.
struct Grown<'a> {
    direct: Option<&'a dyn Transport>,
    passes: Passes,
    active: Vec<bool>,
}

impl Grown<'_> {
    fn direct_chunks(&self) -> u32 {
        self.direct.map_or(0, |direct| direct.shape().chunks)
    }
}

/// Hands over sums under later numbers.
struct Later<'a> {
    sink: &'a dyn ChunkSink,
    by: u32,
}

impl ChunkSink for Later<'_> {
    fn accept(&self, chunk: u32, sums: Sums) {
        self.sink.accept(chunk + self.by, sums);
    }
}

impl Transport for Grown<'_> {
    /// Chunks of direct light come first; each job measures those of its kind.
    fn shape(&self) -> Shape {
        let shape = self.passes.shape();
        Shape { chunks: self.direct_chunks() + shape.chunks, sampling: Sampling::Point, ..shape }
    }

    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        let split = self.direct_chunks();
        match (self.direct, job.source) {
            (Some(direct), Source::Emitters(_)) => {
                // Nobody has looked whether the others lie inside geometry.
                let seen: Option<Vec<bool>> = job.active.map(|valid| {
                    valid.iter().zip(&self.active).map(|(valid, active)| *valid || !active).collect()
                });
                let job = Job { active: seen.as_deref(), ..*job };
                direct.measure(&job, chunks.start.min(split)..chunks.end.min(split), control, sink)
            }
            _ => {
                let chunks = chunks.start.max(split) - split..chunks.end.max(split) - split;
                self.passes.measure(job, chunks, control, &Later { sink, by: split })
            }
        }
    }
}
