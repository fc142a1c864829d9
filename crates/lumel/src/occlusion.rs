//! Ambient occlusion at vertices and lumels.

use crate::{Baker, Lumels};
use lumel_basis::Basis;
use lumel_solve::SolveState;
use lumel_transport::{
    AmbientOcclusion, Control, Job, Measured, Source, Transport, TransportError, accumulate,
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
        if let Some(readout) = self.readout() {
            readout.read(&mut field);
        }
        Ok(self.carried_at_vertices(&field).iter().map(|value| value.x.clamp(0.0, 1.0)).collect())
    }

    /// How open the surroundings of each lumel are: 1 where nothing near hides anything; 0 where the lumel sees nothing but the
    /// inside of geometry. With as many rays as light would have without rounds.
    ///
    /// # Errors
    /// When it is cancelled or tracing fails.
    pub fn openness_at_lumels(
        &self,
        occlusion: AmbientOcclusion,
        lumels: &Lumels,
        control: &Control,
    ) -> Result<Vec<f32>, TransportError> {
        let measured = openness(&self.traced_at_lumels(lumels), occlusion, control)?;
        Ok(measured.field.values().iter().map(|value| value.x).collect())
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
