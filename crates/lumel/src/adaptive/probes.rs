//! Light measured at points, to see where it is not linear.

use super::criterion::Probe;
use crate::settings::Settings;
use crate::surfaces::Surfaces;
use glam::{DVec3, Vec3};
use lumel_accel::{Ray, RayTracer};
use lumel_basis::{Field, PointReceivers};
use lumel_scene::{Light, Scene, SurfacePoint, luminance};
use lumel_solve::mean_and_error;
use lumel_transport::{Control, CpuTransport, Job, Plan, Source, TransportError, accumulate};
use std::sync::Arc;

/// Independent sets of samples, whose spread tells how noisy a probe is.
const SETS: u32 = 4;

/// Measures light at points of a scene.
pub(crate) struct Probes<'a> {
    pub(crate) scene: &'a Arc<Scene>,
    pub(crate) surfaces: &'a Surfaces,
    pub(crate) settings: &'a Settings,
    /// What surfaces reflect, if it counts.
    pub(crate) reflecting: Option<&'a Field>,
}

impl Probes<'_> {
    /// Measures direct light, and what surfaces reflect, with the samples of the settings.
    pub(crate) fn measure(
        &self,
        points: &[SurfacePoint],
        control: &Control,
    ) -> Result<Vec<Probe>, TransportError> {
        let with_normal = |at: &SurfacePoint| (*at, self.scene.shading_normal(*at));
        let Ok(receivers) = PointReceivers::on_surfaces(self.scene, points.iter().map(with_normal)) else {
            return Ok(vec![Probe::default(); points.len()]);
        };
        let part = |samples: u32| samples.div_ceil(SETS);
        let plan = Plan {
            direct_samples: part(self.settings.direct_samples),
            indirect_samples: part(self.settings.indirect_samples),
            ..self.settings.plan()
        };
        let Surfaces { tracer, basis, .. } = self.surfaces;
        let transport = CpuTransport::new(
            Arc::clone(self.scene),
            Arc::clone(tracer),
            Arc::clone(basis),
            Arc::new(receivers),
            plan,
        );
        let measure = |source, bounce, set| {
            // Apart from the samples of the solve.
            let job = Job { source, bounce, pass: set + 1, active: None };
            Ok(accumulate(&transport, &job, control, None)?.field)
        };
        let of_set = |set| {
            let direct = measure(Source::Emitters(None), 0, set)?;
            let reflected = self.reflecting.map(|field| measure(Source::Field(field), 1, set)).transpose()?;
            Ok(Field::sum(points.len(), [&direct].into_iter().chain(&reflected)))
        };
        let sets: Vec<Field> = (0..SETS).map(of_set).collect::<Result<_, TransportError>>()?;
        let beacons = Beacons::new(self.scene);
        let probe = |i: usize| {
            let values = sets.iter().map(|set| DVec3::splat(luminance(set.values()[i]).into()));
            let (mean, error) = mean_and_error(values);
            let visible = beacons.visible(self.scene, &**tracer, points[i]);
            let irradiance = sets.iter().map(|set| set.values()[i]).sum::<Vec3>() / SETS as f32;
            Probe { light: mean.x, variance: error.x * error.x, visible, irradiance }
        };
        Ok((0..points.len()).map(probe).collect())
    }
}

/// The middles of the brightest lights: where a light appears or disappears, there is the edge of a shadow.
struct Beacons(Vec<Beacon>);

/// As many lights are looked for from each point.
const BEACONS: usize = 16;

enum Beacon {
    /// A place.
    At(Vec3),
    /// The direction towards it, a unit vector.
    Towards(Vec3),
}

impl Beacons {
    fn new(scene: &Scene) -> Self {
        let mut lights: Vec<&Light> = scene.lights().iter().collect();
        lights.sort_by(|a, b| luminance(b.strength()).total_cmp(&luminance(a.strength())));
        let beacon = |light: &&Light| match light {
            Light::Rect(light) => Beacon::At(light.center),
            Light::Disk(light) => Beacon::At(light.center),
            Light::Sphere(light) => Beacon::At(light.center),
            Light::Point(light) => Beacon::At(light.position),
            Light::Spot(light) => Beacon::At(light.point.position),
            Light::Directional(light) => Beacon::Towards(-light.direction),
            Light::Sun(light) => Beacon::Towards(-light.parallel.direction),
        };
        Self(lights.iter().take(BEACONS).map(beacon).collect())
    }

    /// Which of them a point sees, a bit each.
    fn visible(&self, scene: &Scene, tracer: &dyn RayTracer, at: SurfacePoint) -> u32 {
        let (origin, normal) = (scene.ray_origin(at), scene.geometric_normal(at.tri));
        let is_visible = |beacon: &Beacon| {
            let ray = match *beacon {
                Beacon::At(position) => Ray::between(origin, position),
                Beacon::Towards(direction) => Ray::new(origin, direction),
            };
            ray.direction.dot(normal) > 0.0 && !tracer.occluded(&ray.skipping(scene.traced(at.tri)))
        };
        self.0.iter().enumerate().map(|(i, beacon)| u32::from(is_visible(beacon)) << i).sum()
    }
}
