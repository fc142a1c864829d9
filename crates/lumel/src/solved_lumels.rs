//! What a solve says of the light at lumels.

use crate::{Baker, Lumels};
use lumel_basis::{Field, VertexLighting};
use lumel_lightmap::SolvedLight;
use lumel_scene::SurfacePoint;
use lumel_solve::SolveState;

impl Baker {
    /// Direct light and all bounces of a solve, read at the middle of each lumel; zero where the surfaces of the solve are not near.
    ///
    /// [`Lightmap::finished`](lumel_lightmap::Lightmap::finished) takes noise off by it.
    pub fn solved_at_lumels(&self, state: &SolveState, lumels: &Lumels) -> SolvedLight {
        let Some((direct, bounces)) = state.bounces.split_first() else { return SolvedLight::default() };
        let Lumels { scene, atlas, coverage } = lumels;
        let middles = coverage.middles(atlas, &atlas.refined(scene, self.scene()));
        let reader = self.light_reader(state);
        let beyond = state.beyond_bounces();
        let bounces = Field::sum(direct.node_count(), bounces.iter().chain(&beyond));
        let [direct, bounces] = [direct, &bounces].map(|field| {
            let values = reader.positive_at_vertices(field);
            let light = VertexLighting::new(self.scene(), &values).ok();
            let at = |middle: &Option<SurfacePoint>| light.zip(*middle).map(|(light, at)| light.at(at).0);
            middles.iter().map(|middle| at(middle).unwrap_or_default()).collect()
        });
        SolvedLight { direct, bounces }
    }
}
