//! The error of light over all surfaces, not only where it is stored.

use crate::statistics::{Estimate, Ratio};
use crate::surface_points::random_surface_points;
use glam::DVec3;
use lumel_basis::{Basis, Field, FieldLighting, Lighting, PointReceivers};
use lumel_scene::{Scene, SurfacePoint};
use lumel_transport::{Control, Job, Source, Transport, accumulate};

/// Light at random points of the surfaces, to compare other light with.
///
/// Points are uniform by area over all surfaces, so that the errors found are means over the surfaces. The normals are the
/// geometric ones.
pub struct Reference<'a> {
    scene: &'a Scene,
    points: Vec<SurfacePoint>,
    /// Irradiance, W·m⁻².
    values: Vec<DVec3>,
    /// Squared standard errors of `values`, summed over channels.
    variances: Vec<f64>,
}

/// How far light is from a reference, over all surfaces.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceError {
    /// Root mean square of the difference over that of the reference; the noise of the reference is taken off.
    ///
    /// Zero where the difference is smaller than the noise of the reference explains.
    pub rms: f64,
    /// Standard error of `rms`.
    pub rms_error: f64,
    /// Mean over that of the reference, minus one.
    pub bias: f64,
    /// Standard error of `bias`.
    pub bias_error: f64,
    /// Root mean square without the worst 2 % of the points, over that of the reference; its noise is in it.
    pub trimmed: f64,
    /// The difference that 95 % of the points stay below, over the root mean square of the reference.
    ///
    /// The noise of the reference is in it.
    pub percentile_95: f64,
    /// The same for 99 % of the points.
    pub percentile_99: f64,
    /// Number of points.
    pub n_points: usize,
}

impl<'a> Reference<'a> {
    /// Irradiance that is known: `f` of position and geometric normal, grey.
    pub fn known(scene: &'a Scene, n: u32, seed: u64, f: impl Fn(DVec3, DVec3) -> f64) -> Self {
        let points = random_surface_points(scene, n, seed);
        let value = |at: &SurfacePoint| {
            let normal = scene.geometric_normal(at.tri).as_dvec3();
            DVec3::splat(f(scene.position(*at).as_dvec3(), normal))
        };
        let values = points.iter().map(value).collect();
        Self { scene, values, variances: vec![0.0; points.len()], points }
    }

    /// Irradiance that is measured at the points.
    ///
    /// `towards` makes the operator that measures the points; it may trace another mesh of the same surfaces. Direct
    /// light and what the surfaces reflect of `field` are measured by `passes` (at least two) independent sets of the
    /// operator's samples. Points inside geometry are left out. Unbiased for the light of `field`, whose own error
    /// stays.
    pub fn measured(
        scene: &'a Scene,
        n: u32,
        seed: u64,
        towards: impl FnOnce(PointReceivers) -> Box<dyn Transport>,
        field: Option<&Field>,
        passes: u32,
    ) -> Self {
        let direct = Source::Emitters(None);
        let sources: Vec<Source<'_>> = [direct].into_iter().chain(field.map(Source::Field)).collect();
        Self::of_sources(scene, [u64::from(n), seed], towards, &sources, passes)
    }

    /// The same of what the surfaces reflect of `field` alone.
    pub fn reflected(
        scene: &'a Scene,
        n: u32,
        seed: u64,
        towards: impl FnOnce(PointReceivers) -> Box<dyn Transport>,
        field: &Field,
        passes: u32,
    ) -> Self {
        Self::of_sources(scene, [u64::from(n), seed], towards, &[Source::Field(field)], passes)
    }

    /// All light of some sources at so many points of a seed.
    fn of_sources(
        scene: &'a Scene,
        [n, seed]: [u64; 2],
        towards: impl FnOnce(PointReceivers) -> Box<dyn Transport>,
        sources: &[Source<'_>],
        passes: u32,
    ) -> Self {
        let points = random_surface_points(scene, n as u32, seed);
        let site = |at: &SurfacePoint| (*at, scene.geometric_normal(at.tri));
        let receivers =
            PointReceivers::on_surfaces(scene, points.iter().map(site)).expect("triangles have normals");
        let transport = towards(receivers);
        let measure = |source: Source<'_>, bounce, pass| {
            let job = Job { source, bounce, pass, active: None };
            accumulate(&*transport, &job, &Control::default(), None).expect("nobody cancels")
        };
        let fields: Vec<Field> = (0..passes)
            .map(|pass| {
                let measured = |source: &Source<'_>| {
                    let bounce = u32::from(!matches!(source, Source::Emitters(_)));
                    measure(*source, bounce, pass).field
                };
                Field::sum(points.len(), &sources.iter().map(measured).collect::<Vec<_>>())
            })
            .collect();
        let visible: Vec<bool> = measure(Source::Nothing, 0, 0).visible().collect();
        let mut reference = Self { scene, points: vec![], values: vec![], variances: vec![] };
        for (i, at) in points.into_iter().enumerate().filter(|(i, _)| visible[*i]) {
            let channel = |k: usize| Estimate::new(fields.iter().map(|f| f64::from(f.values()[i][k])));
            let channels = [0, 1, 2].map(channel);
            reference.points.push(at);
            reference.values.push(channels.map(|channel| channel.mean).into());
            reference.variances.push(channels.iter().map(|channel| channel.error.powi(2)).sum());
        }
        reference
    }

    /// The points, those inside geometry left out.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// Irradiance at the points, W·m⁻².
    pub fn values(&self) -> &[DVec3] {
        &self.values
    }

    /// How noisy the reference itself is: root mean square of its standard errors over that of its values.
    pub fn noise(&self) -> f64 {
        let power: f64 = self.values.iter().map(|value| value.length_squared()).sum();
        (self.variances.iter().sum::<f64>() / power).sqrt()
    }

    /// The error of a field in its basis.
    pub fn error_of_field(&self, basis: &dyn Basis, field: &Field) -> SurfaceError {
        self.error_of(&FieldLighting { basis, field })
    }

    /// The error of light.
    pub fn error_of(&self, light: &dyn Lighting) -> SurfaceError {
        let read =
            |at: &SurfacePoint| light.irradiance(*at, self.scene.geometric_normal(at.tri)).0.as_dvec3();
        let found: Vec<DVec3> = self.points.iter().map(read).collect();
        let pairs = || found.iter().zip(&self.values);
        let squares = pairs().map(|(found, value)| found.distance_squared(*value));
        let without_noise = squares.clone().zip(&self.variances).map(|(square, variance)| square - variance);
        let powers: Vec<f64> = self.values.iter().map(|value| value.length_squared()).collect();
        let square = Ratio::new(&without_noise.collect::<Vec<_>>(), &powers);
        let rms = square.value.max(0.0).sqrt();
        let sums = |values: &[DVec3]| values.iter().map(|value| value.element_sum()).collect::<Vec<f64>>();
        let mean = Ratio::new(&sums(&found), &sums(&self.values));
        let mut distances: Vec<f64> = squares.map(f64::sqrt).collect();
        distances.sort_by(f64::total_cmp);
        let n = distances.len();
        let power = powers.iter().sum::<f64>() / n as f64;
        let best = &distances[..n - n / 50];
        let trimmed = best.iter().map(|distance| distance * distance).sum::<f64>() / best.len() as f64;
        let percentile = |percent: usize| distances[(n * percent / 100).min(n - 1)] / power.sqrt();
        SurfaceError {
            rms,
            // Of a square root: half the relative error. Where nothing but noise is left, the root of its bound.
            rms_error: if square.value > square.error {
                square.error / (2.0 * rms)
            } else {
                square.error.sqrt()
            },
            bias: mean.value - 1.0,
            bias_error: mean.error,
            trimmed: (trimmed / power).sqrt(),
            percentile_95: percentile(95),
            percentile_99: percentile(99),
            n_points: n,
        }
    }
}
