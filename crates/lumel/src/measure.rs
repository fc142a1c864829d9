//! Irradiance at single points.

use crate::Baker;
use glam::{DVec3, Vec3};
use lumel_basis::{Field, PointReceivers, Receivers};
use lumel_solve::SolveState;
use lumel_transport::{Cancelled, Control, CpuTransport, Job, Plan, Source, accumulate};
use std::sync::Arc;

/// Independent sets of samples, whose spread gives the standard error.
///
/// The variance within one set would say nothing: its samples are spread evenly, not independently.
const REPLICATES: u32 = 8;

/// Irradiance at points, W·m⁻².
#[derive(Clone, Debug, PartialEq)]
pub struct PointMeasurement {
    /// All light that arrives at each point.
    pub irradiance: Vec<Vec3>,
    /// `bounces[k][point]`: light that arrives after `k` reflections.
    pub bounces: Vec<Vec<Vec3>>,
    /// Standard error of `irradiance` from the sampling at the points; not that of the solution they gather.
    pub standard_error: Vec<Vec3>,
}

/// Measures the irradiance at points by a fresh gather of the bounces in `state`.
///
/// Bounce `k` at a point gathers bounce `k − 1` of the state, so that the light of `state` and one bounce more than
/// its last is not counted: both end with the same bounce. The samples of the settings are split into eight
/// independent sets. Unbiased for the state.
///
/// # Errors
/// When it is cancelled.
pub fn measure_points(
    baker: &Baker,
    state: &SolveState,
    points: &PointReceivers,
    control: &Control,
) -> Result<PointMeasurement, Cancelled> {
    let settings = baker.settings();
    let share = |samples: u32| samples.div_ceil(REPLICATES).max(1);
    let plan = Plan {
        direct_samples: share(settings.direct_samples),
        indirect_samples: share(settings.indirect_samples),
        ..settings.plan()
    };
    let transport = CpuTransport::new(
        Arc::clone(baker.scene()),
        Arc::clone(baker.tracer()),
        Arc::new(baker.vertex_basis().clone()),
        Arc::new(points.clone()),
        plan,
    );
    let n_bounces = state.bounces.len();
    // Beyond the last bounce, its light and all later light bounce once more into the tail.
    let before_tail = state
        .tail
        .as_ref()
        .map(|tail| Field::sum(tail.len(), state.bounces.last().into_iter().chain([tail])));
    let sources =
        (0..n_bounces).map(|k| if k == 0 { Source::Emitters } else { Source::Field(&state.bounces[k - 1]) });
    let mut steps: Vec<Vec<Field>> = Vec::new();
    for (bounce, source) in sources.chain(before_tail.as_ref().map(Source::Field)).enumerate() {
        let replicate = |pass| {
            // Apart from the points of the solve, which the gathered light depends on.
            let job = Job { source, bounce: bounce as u32, pass: pass + 1, active: None };
            Ok(accumulate(&transport, &job, control, None)?.field)
        };
        steps.push((0..REPLICATES).map(replicate).collect::<Result<_, Cancelled>>()?);
    }
    let n_points = points.node_count();
    let mean_of = |step: &Vec<Field>| mean(n_points, step.iter());
    let totals: Vec<Field> =
        (0..REPLICATES as usize).map(|r| Field::sum(n_points, steps.iter().map(|step| &step[r]))).collect();
    Ok(PointMeasurement {
        irradiance: mean(n_points, totals.iter()),
        bounces: steps.iter().take(n_bounces).map(mean_of).collect(),
        standard_error: standard_error(n_points, &totals),
    })
}

fn mean<'a>(n_points: usize, replicates: impl Iterator<Item = &'a Field>) -> Vec<Vec3> {
    let sum = Field::sum(n_points, replicates);
    sum.values().iter().map(|&v| v / REPLICATES as f32).collect()
}

/// The standard deviation of the replicates over the root of their number.
fn standard_error(n_points: usize, replicates: &[Field]) -> Vec<Vec3> {
    let n = replicates.len() as f64;
    let at = |i: usize| replicates.iter().map(move |field| field.values()[i].as_dvec3());
    let error = |i: usize| {
        let mean = at(i).sum::<DVec3>() / n;
        let squares: DVec3 = at(i).map(|v| (v - mean) * (v - mean)).sum();
        (squares / (n * (n - 1.0))).map(f64::sqrt).as_vec3()
    };
    (0..n_points).map(error).collect()
}
