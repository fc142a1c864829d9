//! Irradiance at single points.

use crate::{Baker, Settings};
use glam::Vec3;
use lumel_basis::{Basis, Field, PointReceivers, Receivers, Sampling};
use lumel_solve::{Gatherable, REPLICATES, SolveState, mean_and_error};
use lumel_transport::{Control, CpuTransport, Job, Plan, Transport, TransportError, accumulate};
use std::sync::Arc;

/// Irradiance at points, W·m⁻².
#[derive(Clone, Debug, PartialEq)]
pub struct PointMeasurement {
    /// All light that arrives at each point.
    pub irradiance: Vec<Vec3>,
    /// `bounces[k][point]`: light that arrives after `k` reflections.
    pub bounces: Vec<Vec<Vec3>>,
    /// Standard error of `irradiance` from the sampling at the points; not that of the solution they gather.
    pub standard_error: Vec<Vec3>,
    /// `bounce_errors[k][point]`: the same for each of `bounces`.
    pub bounce_errors: Vec<Vec<Vec3>>,
}

/// Measures the irradiance at points by a fresh gather of the bounces in `state`.
///
/// Bounce `k` at a point gathers bounce `k − 1` of the state, so that the light of `state` and one bounce more than
/// its last is not counted: both end with the same bounce. The samples of the settings are split into eight
/// independent sets. Unbiased for the state.
///
/// # Errors
/// When it is cancelled or tracing fails.
pub fn measure_points(
    baker: &Baker,
    state: &SolveState,
    points: &PointReceivers,
    control: &Control,
) -> Result<PointMeasurement, TransportError> {
    let [direct_samples, indirect_samples] = share_of_samples(baker);
    let transport = CpuTransport::new(
        Arc::clone(baker.scene()),
        Arc::clone(baker.tracer()),
        Arc::clone(baker.basis()),
        Arc::new(points.clone()),
        Plan { direct_samples, indirect_samples, ..baker.settings().plan() },
    );
    let n_bounces = state.bounces.len();
    let steps = replicates((&transport, &**baker.basis()), state, None, control)?;
    let n_points = points.node_count();
    let totals = totals(n_points, &steps);
    Ok(PointMeasurement {
        irradiance: mean(n_points, totals.iter()),
        bounces: steps.iter().take(n_bounces).map(|step| mean(n_points, step.iter())).collect(),
        standard_error: standard_error(n_points, &totals),
        bounce_errors: steps.iter().take(n_bounces).map(|step| standard_error(n_points, step)).collect(),
    })
}

/// The standard error of all light at every vertex of the scene, W·m⁻², per channel.
///
/// Every node is measured again by eight independent sets of samples, which share those of the settings; their spread
/// gives the error of their mean. A solve has one set of as many samples, which is as good with random points and
/// better with others, so that its error is at most this. It is the error of sampling at the node alone: light is
/// gathered from the bounces in `state`, whose own errors are not in it. Nodes that could not be measured and took the
/// mean of their neighbours have none: zero.
///
/// # Errors
/// When it is cancelled or tracing fails.
pub fn vertex_errors(
    baker: &Baker,
    state: &SolveState,
    control: &Control,
) -> Result<Vec<Vec3>, TransportError> {
    let transport = baker.traced_transport(share_of_samples(baker));
    let n_nodes = transport.shape().nodes;
    let active = (transport.shape().sampling == Sampling::Point).then_some(state.valid.as_slice());
    let steps = replicates((&*transport, &**baker.basis()), state, active, control)?;
    let reader = baker.light_reader(state);
    let totals: Vec<Field> =
        totals(n_nodes, &steps).iter().map(|total| reader.read(total).into_owned()).collect();
    // Each level of points has errors of its own: what is read is their mean.
    let levels = baker.basis().points().map_or(1, |points| points.level_count()) as f32;
    let errors = baker.carried_at_vertices(&Field::from_values(standard_error(n_nodes, &totals)));
    Ok(errors.into_iter().map(|error| error / levels).collect())
}

/// The direct and the hemisphere samples of one of the replicates.
fn share_of_samples(baker: &Baker) -> [u32; 2] {
    let Settings { direct_samples, indirect_samples, .. } = *baker.settings();
    [direct_samples, indirect_samples].map(|samples| samples.div_ceil(REPLICATES as u32).max(1))
}

/// Independent measurements of each bounce of a state, and of its tail after those.
///
/// The variance within one of them would say nothing: its samples are spread evenly, not independently.
fn replicates(
    (transport, basis): (&dyn Transport, &dyn Basis),
    state: &SolveState,
    active: Option<&[bool]>,
    control: &Control,
) -> Result<Vec<Vec<Field>>, TransportError> {
    let into_rest = state.gatherable_beyond_bounces(basis);
    let sources = (0..state.bounces.len()).map(|k| state.source_of(k, basis));
    let mut steps: Vec<Vec<Field>> = Vec::new();
    for (bounce, source) in sources.chain(into_rest.as_ref().map(Gatherable::source)).enumerate() {
        let replicate = |pass| {
            // Apart from the points of the solve, which the gathered light depends on.
            let job = Job { source, bounce: bounce as u32, pass: pass + 1, active };
            Ok(accumulate(transport, &job, control, None)?.field)
        };
        steps.push((0..REPLICATES as u32).map(replicate).collect::<Result<_, TransportError>>()?);
    }
    Ok(steps)
}

/// The sum over all bounces of each replicate.
fn totals(nodes: usize, steps: &[Vec<Field>]) -> Vec<Field> {
    (0..REPLICATES).map(|r| Field::sum(nodes, steps.iter().map(|step| &step[r]))).collect()
}

fn mean<'a>(n_points: usize, replicates: impl Iterator<Item = &'a Field>) -> Vec<Vec3> {
    let sum = Field::sum(n_points, replicates);
    sum.values().iter().map(|&v| v / REPLICATES as f32).collect()
}

fn standard_error(n_points: usize, replicates: &[Field]) -> Vec<Vec3> {
    let at = |i: usize| replicates.iter().map(move |field| field.values()[i].as_dvec3());
    (0..n_points).map(|i| mean_and_error(at(i)).1.as_vec3()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BounceLimit, OpenOptions, Projection, SamplerKind};
    use lumel_scene::Scene;
    use lumel_solve::Silent;

    fn solved(scene: &Arc<Scene>, sampler: SamplerKind, seed: u64) -> (Baker, SolveState) {
        let settings = Settings {
            projection: Projection::Point,
            bounces: BounceLimit::Count(1),
            direct_samples: 16,
            indirect_samples: 32,
            sampler,
            seed,
            ..Settings::default()
        };
        let baker = Baker::new(Arc::clone(scene), settings);
        let mut state = SolveState::new();
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        (baker, state)
    }

    fn cornell_box() -> Arc<Scene> {
        Arc::new(crate::open("cornell-box", &OpenOptions::default()).unwrap().builder.build().unwrap().0)
    }

    /// Mean over vertices of the square of the predicted error, over that of half the difference of two seeds.
    fn predicted_over_found(scene: &Arc<Scene>, sampler: SamplerKind) -> f64 {
        let (baker, state) = solved(scene, sampler, 1);
        let errors = vertex_errors(&baker, &state, &Control::default()).unwrap();
        assert_eq!(errors.len(), scene.vertex_count());
        let [a, b] = [2, 3].map(|seed| {
            let (baker, state) = solved(scene, sampler, seed);
            baker.light_reader(&state).at_vertices(&state.total())
        });
        let predicted: f64 = errors.iter().map(|e| e.as_dvec3().length_squared()).sum();
        let found: f64 = a.iter().zip(&b).map(|(a, b)| (*a - *b).as_dvec3().length_squared() / 2.0).sum();
        predicted / found
    }

    #[test]
    fn errors_at_vertices_are_the_spread_of_solves_over_seeds() {
        let scene = cornell_box();
        // Eight sets of an eighth of the random points have the error of the whole. Over ten thousand vertices both
        // variances are known to a few percent; the closed form's pilots are shared by fewer samples, and the light
        // that is gathered has errors of its own: hence the room.
        let ratio = predicted_over_found(&scene, SamplerKind::Random);
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
        // Eight times as many Sobol points have a variance less than an eighth.
        let ratio = predicted_over_found(&scene, SamplerKind::Sobol);
        assert!((1.1..4.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn errors_of_bounces_add_up_to_that_of_the_sum_as_independent_ones_do() {
        let (baker, state) = solved(&cornell_box(), SamplerKind::Sobol, 1);
        let bounds = baker.scene().bounds();
        // Below the light and around, over the floor.
        let at = |i: u32| {
            let share = Vec3::new(f32::from((i % 20) as u8) + 0.5, 0.02, f32::from((i / 20) as u8) + 0.5);
            bounds.min + (bounds.max - bounds.min) * share / Vec3::new(20.0, 1.0, 20.0)
        };
        let points = PointReceivers::new(baker.scene(), (0..400).map(|i| (at(i), Vec3::Y))).unwrap();
        let measured = measure_points(&baker, &state, &points, &Control::default()).unwrap();
        assert_eq!(measured.bounce_errors.len(), 2);
        let variance = |errors: &Vec<Vec3>| errors.iter().map(|e| e.as_dvec3().length_squared()).sum::<f64>();
        let of_bounces: Vec<f64> = measured.bounce_errors.iter().map(variance).collect();
        assert!(of_bounces.iter().all(|&variance| variance > 0.0), "{of_bounces:?}");
        // Eight replicates know a variance to half of itself, 400 points to three percent.
        let ratio = variance(&measured.standard_error) / of_bounces.iter().sum::<f64>();
        assert!((0.85..1.18).contains(&ratio), "{ratio}");
    }
}
