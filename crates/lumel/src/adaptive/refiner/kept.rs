//! A refinement that is kept, to be continued later.

use super::{Probe, Refiner};
use lumel_export::{NextRefinement, RefinementState, SavedProbe};
use lumel_scene::{Bisection, Scene, SceneError};
use std::sync::Arc;

impl Refiner {
    /// All that is needed to go on; what direct light was measured only as long as more of it is to be.
    pub(crate) fn state(&self, next: NextRefinement) -> RefinementState {
        let mut probes = Vec::new();
        if next == NextRefinement::Direct {
            let of_vertices = (0..).zip(&self.vertices);
            probes.extend(of_vertices.filter_map(|(v, probe)| Some(saved([v; 3], probe.as_ref()?))));
            probes.extend(self.middles.iter().map(|(&[a, b], probe)| saved([a, b, b], probe)));
            let within = self.within.iter();
            probes.extend(within.flat_map(|(&corners, all)| all.iter().map(move |p| saved(corners, p))));
            // Not in the order of maps; those within a triangle keep theirs.
            probes.sort_by_key(|probe| probe.corners);
        }
        RefinementState { next, splits: self.mesh.splits().to_vec(), floor: self.floor, probes }
    }

    /// What was kept.
    ///
    /// # Errors
    /// [`SceneError::BadSplits`] for edges and vertices that the scene does not have.
    pub(crate) fn from_state(
        scene: &Arc<Scene>,
        state: &RefinementState,
        error: f64,
        max_vertices: usize,
    ) -> Result<Self, SceneError> {
        let mesh = Bisection::with_splits(Arc::clone(scene), &state.splits)?;
        let mut refiner = Self { floor: state.floor, ..Self::new(mesh, error, max_vertices) };
        refiner.vertices.resize(refiner.mesh.vertex_count(), None);
        let mut rest = state.probes.as_slice();
        while let [first, others @ ..] = rest {
            let [a, b, c] = first.corners;
            let n = rest.iter().take_while(|probe| probe.corners == first.corners).count();
            match refiner.vertices.get_mut(a as usize) {
                Some(vertex) if (a, b) == (b, c) => *vertex = Some(probe(first)),
                Some(_) if b == c => drop(refiner.middles.insert([a, b], probe(first))),
                Some(_) if n == 4 => {
                    let all = [0, 1, 2, 3].map(|i| probe(&rest[i]));
                    refiner.within.insert(first.corners, all);
                    rest = &rest[4..];
                    continue;
                }
                _ => {
                    let (scene, splits) = (scene.name().to_owned(), state.splits.len());
                    return Err(SceneError::BadSplits { scene, splits });
                }
            }
            rest = others;
        }
        Ok(refiner)
    }
}

fn saved(corners: [u32; 3], probe: &Probe) -> SavedProbe {
    let Probe { light, variance, visible, irradiance } = *probe;
    SavedProbe { corners, light, variance, visible, irradiance }
}

fn probe(saved: &SavedProbe) -> Probe {
    let SavedProbe { light, variance, visible, irradiance, .. } = *saved;
    Probe { light, variance, visible, irradiance }
}
