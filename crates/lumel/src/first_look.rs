//! A first look at all light, long before a solve has it.

use crate::{Baker, BounceBasis};
use glam::{DVec3, Vec3};
use lumel_basis::{Basis as _, Field, NodeWeights, PointReceivers};
use lumel_scene::{Barycentrics, SurfacePoint, TriId};
use lumel_transport::{Control, CpuTransport, Job, Plan, Source, TransportError, accumulate};
use std::sync::Arc;

/// Triangles at which direct light is looked at, at least and at most.
const FEWEST_DIRECT: usize = 8_000;
const MOST_DIRECT: usize = 64_000;

/// Shadow rays that are traced for it, about, between these limits.
const DIRECT_RAYS: u64 = 256_000;

/// Triangles at which it is looked at first, to know how many rays each takes.
const PILOT: usize = 500;

/// Triangles at which bounces are, fewer: they change more slowly from place to place.
const INDIRECT: usize = 8_000;

/// Rays from each of them: few are enough, since neighbours are smoothed together.
const DIRECT_SAMPLES: u32 = 4;
const INDIRECT_SAMPLES: u32 = 16;

/// How much later bounces are like the last one that was looked at; otherwise they are even. Half is best in the Cornell box and the
/// atrium together.
const SHAPE: f32 = 0.5;

/// The middle of a triangle.
const MIDDLE: Barycentrics = Barycentrics { u: 1.0 / 3.0, v: 1.0 / 3.0 };

impl Baker {
    /// A first look at direct light, one bounce, and all later ones together as far as the two tell them, for looking at until a
    /// solve has them: the same for any number of threads, and for any size of scene at most some 400,000 rays, unless more than
    /// eight lights shine on each place.
    ///
    /// Measured in the middle of some triangles, with few rays, and spread over the surfaces in between. Biased: what is finer than
    /// the triangles that are looked at is lost, and places inside geometry are taken for dark ones.
    ///
    /// # Errors
    /// When it is cancelled or tracing fails.
    pub fn first_look(&self, control: &Control) -> Result<Vec<Field>, TransportError> {
        let lit = |operator: &Operator| accumulate(operator, &job(Source::Emitters(None), 0), control, None);
        let (pilot, before) = (Places::new(self, PILOT), control.rays());
        let operator = pilot.operator()?;
        lit(&operator)?;
        let of_each = ((control.rays() - before) / pilot.triangles.len().max(1) as u64).max(1);
        let few = Places::new(self, ((DIRECT_RAYS / of_each) as usize).clamp(FEWEST_DIRECT, MOST_DIRECT));
        let fewest = Places::new(self, INDIRECT);
        let mut bounces = vec![few.spread(&lit(&few.sharing(&operator)?)?.field)];
        let source = bounces.first().map_or(Source::Nothing, Source::Field);
        let measured = accumulate(&fewest.sharing(&operator)?, &job(source, 1), control, None)?;
        bounces.push(fewest.spread(&measured.field));
        bounces.extend(self.later(&bounces));
        Ok(bounces)
    }

    /// All light after some bounces: as much as they would have as a geometric series, which is the more even the later.
    fn later(&self, bounces: &[Field]) -> Option<Field> {
        let series = self.integrals().tail(bounces)?;
        let area: f64 = self.basis().node_areas().iter().map(|&area| f64::from(area)).sum();
        let mean = (self.integrals().incident(&series) / area).as_vec3();
        Some(Field::from_values(series.values().iter().map(|value| mean.lerp(*value, SHAPE)).collect()))
    }
}

type Operator = CpuTransport<BounceBasis, PointReceivers>;

fn job(source: Source<'_>, bounce: u32) -> Job<'_> {
    Job { source, bounce, pass: 0, active: None }
}

/// The triangles at which a first look measures: one in so many, in the order of the mesh, in which neighbours follow each other.
struct Places<'a> {
    baker: &'a Baker,
    triangles: Vec<TriId>,
}

impl<'a> Places<'a> {
    /// At most so many places; all triangles where there are fewer.
    fn new(baker: &'a Baker, at_most: usize) -> Self {
        let n = baker.scene().triangle_count();
        Self { baker, triangles: (0..n as u32).step_by(n.div_ceil(at_most).max(1)).map(TriId).collect() }
    }

    /// What measures light at the places, and reads it everywhere.
    fn operator(&self) -> Result<Operator, TransportError> {
        let (baker, receivers) = (self.baker, self.receivers()?);
        let (tracer, basis) = (Arc::clone(baker.tracer()), Arc::clone(baker.basis()));
        Ok(CpuTransport::new(Arc::clone(baker.scene()), tracer, basis, receivers, self.plan()))
    }

    /// The same that has all but the places from another.
    fn sharing(&self, operator: &Operator) -> Result<Operator, TransportError> {
        Ok(operator.towards(self.receivers()?, self.plan()))
    }

    fn receivers(&self) -> Result<Arc<PointReceivers>, TransportError> {
        let scene = self.baker.scene();
        let at = |&tri: &TriId| {
            let middle = SurfacePoint { tri, bary: MIDDLE };
            (middle, scene.shading_normal(middle))
        };
        PointReceivers::on_surfaces(scene, self.triangles.iter().map(at)).map(Arc::new).map_err(|place| {
            let cause = format!("triangle {} has no direction", self.triangles[place].0);
            TransportError::Failed { worker: "a first look at all light".to_owned(), cause }
        })
    }

    fn plan(&self) -> Plan {
        let plan = self.baker.settings().plan();
        Plan { direct_samples: DIRECT_SAMPLES, indirect_samples: INDIRECT_SAMPLES, ..plan }
    }

    /// What was measured at the places, spread over all nodes.
    fn spread(&self, measured: &Field) -> Field {
        let basis = self.baker.basis();
        let (mut sums, mut all_weights) =
            (vec![DVec3::ZERO; basis.node_count()], vec![0.0; basis.node_count()]);
        let mut weights = NodeWeights::default();
        for (&tri, value) in self.triangles.iter().zip(measured.values()) {
            weights.clear();
            basis.weights_at(SurfacePoint { tri, bary: MIDDLE }, &mut weights);
            for (node, weight) in weights.iter() {
                sums[node.index()] += f64::from(weight) * value.as_dvec3();
                all_weights[node.index()] += f64::from(weight);
            }
        }
        let known: Vec<bool> = all_weights.iter().map(|weight| *weight > 0.0).collect();
        let mean = |(sum, &weight): (&DVec3, &f64)| {
            if weight > 0.0 { (*sum / weight).as_vec3() } else { Vec3::ZERO }
        };
        let mut field = Field::from_values(sums.iter().zip(&all_weights).map(mean).collect());
        let known = basis.adjacency().extrapolate(&mut field, &known);
        // Parts of the mesh without a place are as bright as those before them in the mesh.
        let mut last = Vec3::ZERO;
        for (value, known) in field.values_mut().iter_mut().zip(&known) {
            if *known {
                last = *value;
            } else {
                *value = last;
            }
        }
        field
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{OpenOptions, Settings, Silent};
    use lumel_solve::SolveState;

    /// The root mean square of a difference, by that of the second field.
    fn off(baker: &Baker, found: &Field, exact: &Field) -> f64 {
        let difference = found.values().iter().zip(exact.values()).map(|(a, b)| *a - *b).collect();
        baker.root_mean_square(&Field::from_values(difference)) / baker.root_mean_square(exact)
    }

    #[test]
    fn a_first_look_has_about_the_light_of_a_solve_on_any_number_of_threads() {
        for name in ["atrium", "cornell-box"] {
            let opened = crate::open(name, &OpenOptions::default()).unwrap();
            let scene = Arc::new(opened.builder.build().unwrap().0);
            let settings = Settings { direct_samples: 16, indirect_samples: 32, ..Settings::default() };
            let baker = Baker::new(scene, settings);
            let mut solved = SolveState::new();
            baker.run(&mut solved, &Control::default(), &Silent).unwrap();
            let control = Control::default();
            let seen = baker.first_look(&control).unwrap();
            assert!(control.rays() < 1_000_000, "{name}: {}", control.rays());
            let later = solved.bounces[2..].iter().chain(&solved.tail);
            let exact = [&solved.bounces[0], &solved.bounces[1], &Field::sum(seen[2].node_count(), later)];
            // Of one bounce, the noise of sixteen rays; of the others, the pattern of that one, and all that a closed scene would keep.
            for (bounce, limit, power) in [(0, 0.15, 0.95..1.05), (1, 0.5, 0.95..1.05), (2, 0.65, 0.95..1.35)]
            {
                let (found, exact) = (&seen[bounce], exact[bounce]);
                let (share, off) = (baker.power(found) / baker.power(exact), off(&baker, found, exact));
                assert!(off < limit && power.contains(&share), "{name}, bounce {bounce}: {off}, {share}");
            }
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            assert!(alone.install(|| baker.first_look(&Control::default())).unwrap() == seen, "{name}");
        }
    }
}
