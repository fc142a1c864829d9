//! The light of some emitters, apart from that of the others.

use crate::directional::by_direction;
use crate::integrals::{ambient_field, scaled};
use crate::observer::{Observer, Step};
use crate::operator::Operator;
use crate::replicates::Problem;
use crate::schedule::Shot;
use crate::solver::{SolveError, transport_shot};
use crate::{PowerLog, SolveState};
use lumel_basis::{Field, NodeId};
use lumel_transport::{Control, EmitterMask, Job, Source, TransportError};

/// Finds the part that each mask of emitters has in the total of a finished solve.
///
/// The solve is repeated for each, with as many bounces or the same shots, the same samples and the same factors for its tail.
/// As light is linear, layers of masks that make up all emitters add up to the total, to the rounding of single precision. On
/// stored rays a layer costs its own shadow rays and no hemisphere ray. With operators of a final gather or of directional light,
/// these are finished for each layer too.
///
/// # Errors
/// When it is cancelled or the transport fails; `state` is as before then.
pub fn solve_layers(
    problem: Problem<'_>,
    [final_gather, directional]: [Option<Operator<'_>>; 2],
    masks: &[EmitterMask],
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    let Problem { operator, integrals, .. } = problem;
    let tail_factors = state.tail.as_ref().and_then(|_| integrals.tail_factors(&state.bounces));
    let batches = if state.shot.is_some() { batches(&problem, state, control)? } else { Vec::new() };
    let direct = operator.reflected_direct();
    let visible = direct.map(|direct| direct.visible(control)).transpose()?.flatten();
    let (mut layers, mut by_directions) = (Vec::with_capacity(masks.len()), Vec::new());
    for (number, mask) in (0..).zip(masks) {
        let step = Step::Layer(number);
        observer.step_started(step);
        let mut layer = SolveState { basis: state.basis, valid: state.valid.clone(), ..SolveState::new() };
        if let Some(direct) = direct {
            layer.read_direct = Some(direct.measure(Some(mask), visible.as_deref(), control)?);
        }
        for bounce in 0..state.bounces.len() {
            let source = match bounce {
                0 => Source::Emitters(Some(mask)),
                _ => layer.source_of(bounce, operator.basis),
            };
            let job = Job { source, bounce: bounce as u32, pass: 0, active: operator.active(&state.valid) };
            let field = operator.apply(&job, control, None)?.field;
            layer.bounces.push(field);
        }
        batches.iter().try_for_each(|nodes| transport_shot(operator, &mut layer, nodes, control))?;
        layer.tail = match &state.shot {
            Some(_) => state.tail.as_ref().map(|_| ambient_field(integrals, state, &layer)),
            None => tail_factors.zip(layer.bounces.last()).map(|(factors, last)| scaled(last, factors)),
        };
        if let Some(operator) = final_gather.filter(|_| state.gathered.is_some()) {
            layer.gathered = Some(crate::solver::gathered(operator, &layer, control)?);
        }
        layers.push(layer.total());
        if let Some(operator) = directional {
            by_directions.push(by_direction(operator, Some(mask), &layer, control)?);
        }
        observer.step_done(step, state);
    }
    (state.layers, state.directional_layers) = (layers, by_directions);
    Ok(())
}

/// The nodes of each shot of a finished solve: its steps are taken once more.
fn batches(
    problem: &Problem<'_>,
    solved: &SolveState,
    control: &Control,
) -> Result<Vec<Vec<NodeId>>, TransportError> {
    let mut state = SolveState {
        basis: solved.basis,
        valid: solved.valid.clone(),
        bounces: solved.bounces.clone(),
        read_direct: solved.read_direct.clone(),
        ..SolveState::new()
    };
    let powers = PowerLog::of(problem.integrals, &state.bounces);
    let shots = solved.shot.as_ref().map_or(0, |shot| shot.shots);
    let mut batches = Vec::new();
    for _ in 0..shots {
        let Some(Shot::Nodes(nodes)) = problem.schedule.next(&state, &powers) else { break };
        transport_shot(problem.operator, &mut state, &nodes, control)?;
        batches.push(nodes);
    }
    Ok(batches)
}

/// The weighted sum of layers: all light with every emitter dimmed to its share.
///
/// `shares` are per layer and colour channel, 1 for as solved.
pub fn mix(layers: &[Field], shares: &[glam::Vec3]) -> Field {
    let nodes = layers.first().map_or(0, Field::node_count);
    let dimmed: Vec<Field> = layers.iter().zip(shares).map(|(layer, &share)| scaled(layer, share)).collect();
    Field::sum(nodes, &dimmed)
}
