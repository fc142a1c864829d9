//! The work of a job.

use super::lumels;
use super::published::{Ending, Phase, Shared, lock};
use super::publisher::Publisher;
use super::task::{Keep, SolveStart, Solved, Task, Work};
use crate::selection::Layer;
use lumel::{Baker, Control, LightReader, SolveState, Tracker};
use lumel_basis::Field;
use std::sync::Arc;

/// Does the work of a job on the threads of the pool that it is called in.
pub(super) fn run(task: &Task, work: Work, control: &Control, shared: &Shared, keep: &Keep) -> Ending {
    match work {
        Work::Solve(start) => solve(task, start, control, shared, keep),
        Work::StandardError(solved) => {
            shared.publish_phase(Phase::StandardError);
            let result = lumel::vertex_errors(&solved.baker, &solved.state, control);
            *lock(&shared.solved) = Some(solved);
            match result {
                Ok(errors) => {
                    shared.publish_light(|p| p.light.standard_error = Some(Arc::new(errors)));
                    Ending::Done
                }
                Err(_) => Ending::Stopped,
            }
        }
        Work::Lumels { solved, layout, denoises } => {
            let ending = lumels::measure(&solved, &layout, denoises, control, shared);
            *lock(&shared.solved) = Some(solved);
            ending
        }
        Work::Read(solved) => {
            let baker = Arc::new(solved.baker.relit(Arc::clone(&task.scene), task.settings.clone()));
            Publisher::new(&baker, control, shared, keep).resumed(&solved.state);
            conclude(shared, baker, solved.state.clone());
            Ending::Done
        }
    }
}

fn solve(task: &Task, start: SolveStart, control: &Control, shared: &Shared, keep: &Keep) -> Ending {
    if let Err(error) = task.settings.validate() {
        return Ending::Failed(error.to_string());
    }
    let baker = Arc::new(task.baker.relit(Arc::clone(&task.scene), task.settings.clone()));
    let mut state = match start {
        SolveStart::Anew => SolveState::new(),
        SolveStart::From(state) => baker.continued(*state),
        SolveStart::FromFile(saved) => match baker.resume(&saved) {
            Ok(state) => state,
            Err(error) => return Ending::Failed(error.to_string()),
        },
    };
    *lock(&shared.tracker) = Some(Tracker::new(&baker, &state));
    let publisher = Publisher::new(&baker, control, shared, keep);
    publisher.resumed(&state);
    let result = std::thread::scope(|scope| {
        scope.spawn(|| publisher.serve());
        let _closing = publisher.closing();
        baker.run(&mut state, control, &publisher)
    });
    conclude(shared, baker, state);
    match result {
        Ok(()) => Ending::Done,
        Err(lumel::SolveError::Cancelled) => Ending::Stopped,
        Err(error) => Ending::Failed(error.to_string()),
    }
}

/// Publishes what there is besides the bounces, and hands over what was computed.
fn conclude(shared: &Shared, baker: Arc<Baker>, state: SolveState) {
    let reader = baker.light_reader(&state);
    let tail = beyond_bounces(&state).map(|tail| Arc::new(reader.at_vertices(&tail)));
    let valid = Arc::new(baker.flags_at_vertices(&state.valid));
    let layers = layers(&reader, &state);
    let directional = state.directional.as_ref().and_then(|field| reader.directional_at_vertices(field));
    drop(reader);
    shared.publish_light(|p| {
        p.light.current = None;
        p.light.tail = tail;
        p.light.valid = valid;
        p.light.layers = layers;
        p.light.directional = directional.map(Arc::new);
    });
    *lock(&shared.solved) = Some(Arc::new(Solved { baker, state }));
}

/// The layers of a state, none of them dimmed.
fn layers(reader: &LightReader<'_>, state: &SolveState) -> Vec<Layer> {
    let baker = reader.baker();
    let names = lumel::light_layers(baker.scene(), baker.settings()).into_iter().map(|layer| layer.name);
    let by_direction = |k: usize| reader.directional_at_vertices(state.directional_layers.get(k)?);
    let layer = |(k, (name, field))| Layer {
        name,
        values: Arc::new(reader.at_vertices(field)),
        directional: by_direction(k).map(Arc::new),
        share: 1.0,
    };
    names.zip(&state.layers).enumerate().map(layer).collect()
}

/// What the sum of the bounces lacks of all light: the tail, or what a final gather has made different.
fn beyond_bounces(state: &SolveState) -> Option<Field> {
    if state.gathered.is_none() {
        return state.tail.clone();
    }
    let bounces = Field::sum(state.valid.len(), &state.bounces);
    let total = state.total();
    let rest = total.values().iter().zip(bounces.values()).map(|(total, bounces)| *total - *bounces);
    Some(Field::from_values(rest.collect()))
}
