//! Ambient occlusion at vertices and lumels.

use crate::lumels::portion_of;
use crate::{Baker, Lumels};
use lumel_basis::Basis;
use lumel_lightmap::{LumelLight, PartLight};
use lumel_solve::SolveState;
use lumel_transport::{
    AmbientOcclusion, Control, Job, Measured, Plan, Source, Transport, TransportError, accumulate,
};

impl Baker {
    /// How open the surroundings of each vertex of the scene are: 1 where nothing near hides anything. With the projection and the
    /// hemisphere samples of the settings; vertices inside geometry have the values of their neighbours.
    ///
    /// # Errors
    /// When it is cancelled or tracing fails.
    pub fn openness_at_vertices(
        &self,
        occlusion: AmbientOcclusion,
        state: &SolveState,
        control: &Control,
    ) -> Result<Vec<f32>, TransportError> {
        let settings = self.settings();
        let transport = self.traced_transport([settings.direct_samples, settings.indirect_samples]);
        let Measured { mut field, known, .. } = openness(&*transport, occlusion, control)?;
        let valid: Vec<bool> =
            known.iter().zip(&state.valid).map(|(known, valid)| *known && *valid).collect();
        self.basis().adjacency().complete(&mut field, &valid);
        if let Some(hierarchy) = self.basis().hierarchy() {
            hierarchy.analyze(&mut field, None);
        }
        if let Some(readout) = self.readout() {
            readout.read(&mut field);
        }
        Ok(self.carried_at_vertices(&field).iter().map(|value| value.x.clamp(0.0, 1.0)).collect())
    }

    /// How open the surroundings of each lumel are: 1 where nothing near hides anything; 0 where the lumel sees nothing but the
    /// inside of geometry. With as many rays as light would have without rounds, in two halves that tell how noisy it is.
    ///
    /// # Errors
    /// When it is cancelled or tracing fails.
    pub fn openness_at_lumels(
        &self,
        occlusion: AmbientOcclusion,
        lumels: &Lumels,
        control: &Control,
    ) -> Result<LumelLight, TransportError> {
        let plan = self.settings().plan();
        let plan = Plan { indirect_samples: plan.indirect_samples.div_ceil(2), ..plan };
        let [first, second] = [0, 1].map(|half| {
            let transport = self.traced_at_lumels(lumels, portion_of(plan, [0, half]));
            let Measured { field, known, .. } = openness(&transport, occlusion, control)?;
            Ok(PartLight { known, sources: vec![field.values().to_vec()] })
        });
        let n = lumels.coverage.len();
        let mut openness = LumelLight::new(n, 1, false);
        openness.add(0..n, &[first?, second?]);
        Ok(openness)
    }
}

fn openness(
    transport: &dyn Transport,
    occlusion: AmbientOcclusion,
    control: &Control,
) -> Result<Measured, TransportError> {
    let job = Job { source: Source::Ambient(occlusion), bounce: 0, pass: 0, active: None };
    accumulate(transport, &job, control, None)
}
