//! Exact light transport, along paths from random points of the surfaces.

use crate::place::Place;
use glam::Vec3;
use lumel::Control;
use lumel_accel::Ray;
use lumel_basis::{Lighting, PointReceivers};
use lumel_sample::{Dim, Frame, Sampler, StreamKey, cosine_hemisphere};
use lumel_scene::SurfacePoint;
use lumel_testkit::{Ratio, random_surface_points};
use lumel_transport::{Job, Measured, Plan, Source, accumulate};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Reflections after the direct light.
pub(crate) const BOUNCES: usize = 4;

/// Paths that are traced together.
const BATCH: u32 = 1 << 17;
/// Light samples at each end of a path: the spread between paths is much larger than that of these.
const DIRECT_SAMPLES: u32 = 8;

/// Paths that start at independent points, uniform by area over all surfaces but for what lies inside geometry, and
/// reflect in directions with density `cos θ/π`.
///
/// The direct light at the end of a path after `k` reflections, times the albedos on the way, is an unbiased estimate of
/// bounce `k` at its start. No light is interpolated. Reading stored light at the end of the same paths makes the ratio
/// of both less noisy than either.
#[derive(Default)]
pub(crate) struct Paths {
    starts: Vec<SurfacePoint>,
    /// Where each path ends after one reflection, if it meets a surface, and the albedo there.
    reflected: Vec<Option<End>>,
    /// `exact[k][path]`: irradiance of bounce `k` at the start, mean of the channels, W·m⁻².
    exact: [Vec<f64>; BOUNCES + 1],
}

/// The end of a path.
#[derive(Clone, Copy)]
struct End {
    at: SurfacePoint,
    /// Product of the albedos of all points after the start.
    weight: Vec3,
}

impl Paths {
    /// At least `n` paths, without those that start inside geometry.
    pub(crate) fn trace(place: &Place, n: u32) -> Self {
        let mut paths = Self::default();
        (0..n.div_ceil(BATCH)).for_each(|batch| paths.append(place, batch));
        paths
    }

    fn append(&mut self, place: &Place, batch: u32) {
        let starts = random_surface_points(&place.scene, BATCH, u64::from(batch));
        // Each batch and bounce has samples of its own.
        let seed = |bounce: usize| (u64::from(batch) << 8) + bounce as u64 + 1;
        let visible: Vec<bool> = place.measured(&starts, Source::Nothing, seed(0)).visible().collect();
        let starts: Vec<SurfacePoint> =
            starts.into_iter().zip(visible).filter(|(_, visible)| *visible).map(|(at, _)| at).collect();
        let mut ends: Vec<Option<End>> =
            starts.iter().map(|&at| Some(End { at, weight: Vec3::ONE })).collect();
        for bounce in 0..=BOUNCES {
            if bounce > 0 {
                ends = place.reflected(&ends, StreamKey::new(seed(bounce)).pass(1));
            }
            if bounce == 1 {
                self.reflected.extend(&ends);
            }
            self.exact[bounce].extend(place.direct_light(&ends, seed(bounce)));
        }
        self.starts.extend(starts);
    }

    /// Number of paths.
    pub(crate) fn count(&self) -> usize {
        self.starts.len()
    }

    /// Power of light as it is stored over the exact power of some bounces.
    pub(crate) fn stored(&self, light: &dyn Lighting, bounces: RangeInclusive<usize>) -> Ratio {
        let read = |at: &SurfacePoint| mean(light.irradiance(*at, Vec3::ZERO).0);
        self.over_exact(self.starts.par_iter().map(read).collect(), bounces)
    }

    /// Power of what the surfaces reflect of `light`, read by a fresh gather, over the exact power of a bounce.
    pub(crate) fn gathered(&self, light: &dyn Lighting, bounce: usize) -> Ratio {
        let read = |end: &Option<End>| {
            end.map_or(0.0, |end| mean(end.weight * light.irradiance(end.at, Vec3::ZERO).0))
        };
        self.over_exact(self.reflected.par_iter().map(read).collect(), bounce..=bounce)
    }

    /// Power of the negative part of light over the exact power of the direct light.
    pub(crate) fn negative(&self, light: &dyn Lighting) -> f64 {
        let negative = |at: &SurfacePoint| mean(light.irradiance(*at, Vec3::ZERO).0.min(Vec3::ZERO));
        let found: f64 = self.starts.par_iter().map(negative).sum();
        found.abs() / self.exact[0].iter().sum::<f64>()
    }

    fn over_exact(&self, found: Vec<f64>, bounces: RangeInclusive<usize>) -> Ratio {
        let exact = |path| bounces.clone().map(|bounce| self.exact[bounce][path]).sum();
        Ratio::new(&found, &(0..self.count()).map(exact).collect::<Vec<f64>>())
    }
}

impl Place {
    /// Each path continued by one reflection.
    fn reflected(&self, ends: &[Option<End>], key: StreamKey) -> Vec<Option<End>> {
        let continued = |(path, end): (usize, &Option<End>)| {
            let End { at, weight } = (*end)?;
            let normal = self.scene.geometric_normal(at.tri);
            let u = Sampler::Random.sample_2d(key.element(path as u32), 0, Dim::Hemisphere);
            let direction = Frame::from_normal(normal).to_world(cosine_hemisphere(u));
            let hit = self.tracer.closest_hit(&Ray::new(self.scene.ray_origin(at), direction))?;
            let at = self.scene.seen_side(hit.at, hit.side)?;
            Some(End { at, weight: weight * self.scene.albedo(at).0 })
        };
        ends.par_iter().enumerate().map(continued).collect()
    }

    /// Direct light at the ends, weighted; zero for paths that have left the scene.
    fn direct_light(&self, ends: &[Option<End>], seed: u64) -> Vec<f64> {
        let points: Vec<SurfacePoint> = ends.iter().flatten().map(|end| end.at).collect();
        let measured = self.measured(&points, Source::Emitters(None), seed).field;
        let mut light = measured.values().iter().copied();
        let weighted = |end: &Option<End>| match end {
            Some(end) => mean(end.weight * light.next().unwrap_or_default()),
            None => 0.0,
        };
        ends.iter().map(weighted).collect()
    }

    /// Irradiance at points, and the share of their rays that meet back faces if the source is nothing.
    fn measured(&self, points: &[SurfacePoint], source: Source<'_>, seed: u64) -> Measured {
        let site = |at: &SurfacePoint| (*at, self.scene.geometric_normal(at.tri));
        let receivers = PointReceivers::on_surfaces(&self.scene, points.iter().map(site))
            .expect("triangles have normals");
        let plan = Plan { direct_samples: DIRECT_SAMPLES, seed, ..Plan::default() };
        let transport = self.towards(receivers, plan);
        let job = Job { source, bounce: 0, pass: 0, active: None };
        accumulate(&transport, &job, &Control::default(), None).expect("nobody cancels")
    }
}

fn mean(light: Vec3) -> f64 {
    f64::from(light.element_sum()) / 3.0
}
