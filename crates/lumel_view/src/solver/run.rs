//! The work of a job.

use super::first_look::FirstLook;
use super::lumels;
use super::points::Points;
use super::published::{Ending, Phase, Shared, lock};
use super::publisher::Publisher;
use super::refine;
use super::task::{Keep, SolveStart, Solved, Task, Work};
use crate::mesh::Mesh;
use crate::selection::Layer;
use crate::unshot::Unshot;
use lumel::{Baker, Control, LightReader, ResumeError, SolveState, Tracker, TransportError};
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
    let (baker, mut state) = match begin(task, start, control, shared, keep) {
        Ok(begun) => begun,
        Err(ending) => return ending,
    };
    let mesh = Arc::new(Mesh::of(&baker));
    shared.change_light(|published| {
        let known = published.mesh.take().filter(|known| known.is_of(&mesh.scene));
        published.mesh = known.or(Some(mesh));
    });
    *lock(&shared.tracker) = Some(Tracker::new(&baker, &state));
    let first_look = match first_look(task, &baker, &state, control, shared) {
        Ok(first_look) => first_look,
        Err(ending) => return ending,
    };
    let publisher = Publisher::new(&baker, control, shared, keep).after(first_look);
    publisher.publish_first_look();
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

/// Scenes of fewer vertices have direct light as soon as they would have a first look.
const LARGE: usize = 50_000;

/// A first look at all light, where it is wanted and direct light takes its time.
fn first_look(
    task: &Task,
    baker: &Baker,
    state: &SolveState,
    control: &Control,
    shared: &Shared,
) -> Result<Option<FirstLook>, Ending> {
    let is_new = state.bounces.is_empty() && lock(&shared.published).light.is_empty();
    if !(task.first_look && is_new && baker.scene().vertex_count() >= LARGE) {
        return Ok(None);
    }
    match baker.first_look(control) {
        Ok(bounces) => Ok(Some(FirstLook::new(bounces))),
        Err(TransportError::Cancelled) => Err(Ending::Stopped),
        Err(error) => Err(Ending::Failed(error.to_string())),
    }
}

/// What solves, on the mesh that it solves on, and the state from which it goes on.
fn begin(
    task: &Task,
    start: SolveStart,
    control: &Control,
    shared: &Shared,
    keep: &Keep,
) -> Result<(Arc<Baker>, SolveState), Ending> {
    let open = || Arc::new(task.baker.relit(Arc::clone(&task.scene), task.settings.clone()));
    let saved = match start {
        SolveStart::Anew => return Ok((open(), SolveState::new())),
        SolveStart::Refine(state) => {
            let start = refine::start(task, shared)?;
            return Ok((refine::refine(start, state.as_deref(), control, shared, keep)?, SolveState::new()));
        }
        SolveStart::From(state) => {
            let baker = open();
            let state = baker.continued(*state);
            return Ok((baker, state));
        }
        SolveStart::FromFile(saved) => saved,
    };
    let failed = |error: ResumeError| Ending::Failed(error.to_string());
    if saved.is_refinement() {
        let start = refine::start(task, shared)?;
        let state = start.resume_refinement(&saved).map_err(failed)?;
        return Ok((refine::refine(start, state.as_ref(), control, shared, keep)?, SolveState::new()));
    }
    let baker = match saved.splits() {
        [] => open(),
        splits => refine::refined(task, splits, shared)?,
    };
    let state = baker.resume(&saved).map_err(failed)?;
    Ok((baker, state))
}

/// Publishes what there is besides the bounces, and hands over what was computed.
fn conclude(shared: &Shared, baker: Arc<Baker>, state: SolveState) {
    let reader = baker.light_reader(&state);
    let beyond = beyond_bounces(&state);
    let tail = beyond.as_ref().map(|tail| Arc::new(reader.at_vertices(tail)));
    let direct = reader.direct_at_vertices().map(|direct| Arc::new(direct.to_vec()));
    let valid = Arc::new(baker.flags_at_vertices(&state.valid));
    let layers = layers(&reader, &state);
    let directional = state.directional.as_ref().and_then(|field| reader.directional_at_vertices(field));
    let unshot = Unshot::of(&baker, &state).map(Arc::new);
    let points = Points::of(&baker, shared);
    shared.publish_light(|p| {
        points.publish_all(p, (&reader, &state), beyond.as_ref());
        if let Some(direct) = direct {
            p.light.set_direct(direct);
        }
        p.light.current = None;
        p.light.tail = tail;
        p.light.valid = valid;
        p.light.layers = layers;
        p.light.directional = directional.map(Arc::new);
        p.unshot = unshot;
    });
    drop(reader);
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

/// What the sum of the bounces lacks of all light: the tail, what was shot, or what a final gather has made different.
fn beyond_bounces(state: &SolveState) -> Option<Field> {
    if state.gathered.is_none() {
        return state.beyond_bounces();
    }
    let bounces = Field::sum(state.valid.len(), &state.bounces);
    let total = state.total();
    let rest = total.values().iter().zip(bounces.values()).map(|(total, bounces)| *total - *bounces);
    Some(Field::from_values(rest.collect()))
}
