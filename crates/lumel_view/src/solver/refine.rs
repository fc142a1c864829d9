//! A mesh that is refined where light needs it, as it can be seen meanwhile.

use super::published::{Ending, Phase, Shared, lock};
use super::task::{Keep, Task};
use crate::mesh::Mesh;
use crate::selection::Illumination;
use glam::Vec3;
use lumel::{Baker, Control, RefinementEnd, RefinementState, Refining, SolveError};
use std::sync::Arc;

/// The given mesh of a task, to be refined.
pub(super) fn start(task: &Task, shared: &Shared) -> Result<Arc<Baker>, Ending> {
    let given = given(task, shared)?;
    Ok(Arc::new(given.relit(Arc::clone(given.scene()), task.settings.clone())))
}

/// Refines a mesh, from `state` on, and publishes it after each round with its light.
pub(super) fn refine(
    start: Arc<Baker>,
    state: Option<&RefinementState>,
    control: &Control,
    shared: &Shared,
    keep: &Keep,
) -> Result<Arc<Baker>, Ending> {
    *lock(&shared.refinement) = state.cloned();
    let mut mesh: Option<Arc<Mesh>> = None;
    let mut watch = |refining: &Refining<'_>| {
        let (bounce, vertices) = (refining.bounce, refining.mesh().vertex_count());
        shared.publish_phase(Phase::Refining { bounce, vertices });
        if let Some(state) = refining.state() {
            let checkpoint = || start.checkpoint_of_refinement(state.clone());
            let problem = keep.as_ref().and_then(|keep| keep(&checkpoint()).err());
            lock(&shared.published).checkpoint_problem = problem;
            *lock(&shared.refinement) = Some(state);
        }
        let same = mesh.take().filter(|mesh| mesh.scene.vertex_count() == vertices);
        let finer =
            same.map_or_else(|| Mesh::refined(&start, refining.mesh().splits()), |same| Ok((*same).clone()));
        // Its edges are those of the scene.
        let Ok(finer) = finer else { return };
        let indicator = refining.indicator().into_iter().map(Vec3::splat).collect();
        let finer = Arc::new(Mesh { indicator: Some(Arc::new(indicator)), ..finer });
        let light = Illumination { sum_only: Some(Arc::new(refining.irradiance())), ..Illumination::new() };
        mesh = Some(Arc::clone(&finer));
        shared.publish_light(|published| {
            (published.mesh, published.light) = (Some(finer), light);
        });
    };
    match start.adapted_from(state, control, &mut watch) {
        Ok(Some(adapted)) => {
            *lock(&shared.refinement) = None;
            let limit = start.settings().max_vertices as usize;
            *lock(&shared.vertices_missing) = (adapted.ended == RefinementEnd::Vertices).then_some(limit);
            Ok(Arc::new(adapted.baker))
        }
        Ok(None) => Ok(start),
        Err(SolveError::Cancelled) => Err(Ending::Stopped),
        Err(error) => Err(Ending::Failed(error.to_string())),
    }
}

/// What computes light on the given mesh of a task with these edges split.
pub(super) fn refined(task: &Task, splits: &[[u32; 2]], shared: &Shared) -> Result<Arc<Baker>, Ending> {
    let mesh = Mesh::refined(&*given(task, shared)?, splits).map_err(Ending::Failed)?;
    Ok(Arc::new(Baker::with_tracer(mesh.scene, mesh.tracer, task.settings.clone())))
}

fn given(task: &Task, shared: &Shared) -> Result<Arc<Baker>, Ending> {
    let given = task.given.read(&task.scene).map_err(Ending::Failed)?;
    *lock(&shared.given) = Some(Arc::clone(&given));
    Ok(given)
}
