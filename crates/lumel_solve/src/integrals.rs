//! How much light is on its way, and how much is still to come.

use crate::{PowerLog, SolveState};
use glam::{DVec3, Vec3};
use lumel_basis::Field;
use lumel_scene::luminance;

/// Above this ratio of successive bounces the geometric series is not trusted.
const MAX_RATIO: f64 = 0.98;

/// Integrals of a field over the surfaces.
#[derive(Clone, Debug)]
pub struct Integrals {
    /// Area of each node, m².
    areas: Vec<f32>,
    /// Integral of albedo times the node's basis function, m².
    reflecting: Vec<Vec3>,
    /// How many times functions sum to 1.
    levels: u32,
}

impl Integrals {
    /// The integrals of a basis: `areas` is that of each basis function over the surfaces, `reflecting` that of albedo
    /// times each, both m².
    pub fn new(areas: Vec<f32>, reflecting: Vec<Vec3>) -> Self {
        Self { areas, reflecting, levels: 1 }
    }

    /// Those of a hierarchy with so many levels, on each of which the functions sum to 1.
    #[must_use]
    pub fn of_levels(self, levels: u32) -> Self {
        Self { levels: levels.max(1), ..self }
    }

    /// The area of all surfaces, m².
    fn area(&self) -> f64 {
        self.areas.iter().map(|&area| f64::from(area)).sum::<f64>() / f64::from(self.levels)
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.areas.len()
    }

    /// The mean albedo of all surfaces, by luminance.
    pub fn mean_albedo(&self) -> f64 {
        let area = self.area();
        let reflecting: f64 = self.reflecting.iter().map(|&area| f64::from(luminance(area))).sum();
        if area > 0.0 { reflecting / (area * f64::from(self.levels)) } else { 0.0 }
    }

    /// Power that arrives, W per channel.
    pub fn incident(&self, field: &Field) -> DVec3 {
        field.weighted_sum(self.areas.iter().map(|&area| Vec3::splat(area)))
    }

    /// The mean irradiance over all surfaces, by luminance, W·m⁻².
    pub fn mean(&self, field: &Field) -> f64 {
        let area = self.area();
        if area > 0.0 { self.power(field) / area } else { 0.0 }
    }

    /// The mean over all surfaces of the squared irradiance at nodes, by luminance, W²·m⁻⁴; of a hierarchy, an estimate.
    pub fn mean_square(&self, field: &Field) -> f64 {
        let area = self.area();
        let nodes = self.areas.iter().zip(field.values().iter().step_by(field.channels()));
        let sum: f64 = nodes.map(|(&area, e)| f64::from(area) * f64::from(luminance(*e)).powi(2)).sum();
        if area > 0.0 { sum / area } else { 0.0 }
    }

    /// Power that is reflected and so arrives again, W per channel.
    pub fn reflected(&self, field: &Field) -> DVec3 {
        field.weighted_sum(self.reflecting.iter().copied())
    }

    /// Power that arrives, W by luminance.
    pub fn power(&self, field: &Field) -> f64 {
        f64::from(luminance(self.incident(field).as_vec3()))
    }

    /// The power that each node has to shoot if this is unshot, W by luminance.
    pub fn unshot_powers(&self, unshot: &Field) -> Vec<f64> {
        let power = |(e, &area): (&Vec3, &Vec3)| f64::from(luminance(*e * area));
        unshot.values().iter().step_by(unshot.channels()).zip(&self.reflecting).map(power).collect()
    }

    /// The ambient term: the irradiance, W·m⁻², that light which is not computed yet would bring if it were the same everywhere.
    ///
    /// An estimate for looking at: it is never reflected. Unshot power is reflected again and again by surfaces of the mean
    /// albedo, and each time as much of it arrives as would of all light if what is unshot arrived whole. What was sent so far
    /// says nothing else about the rest: the brightest surfaces may be those that the sun lights and whose light leaves.
    /// (Cohen, Chen, Wallace and Greenberg 1988 let all of it arrive, as in a closed room.)
    pub fn ambient(&self, state: &SolveState) -> Vec3 {
        self.ambient_with(self.ambient_per_power(state), state)
    }

    fn ambient_with(&self, per_power: DVec3, state: &SolveState) -> Vec3 {
        let area = self.area();
        let unshot = state.unshot().map_or(DVec3::ZERO, |unshot| self.reflected(unshot));
        if area > 0.0 { (unshot * per_power / area).as_vec3() } else { Vec3::ZERO }
    }

    /// How much power arrives in the end of each watt that is unshot, by colour channel.
    fn ambient_per_power(&self, state: &SolveState) -> DVec3 {
        let sum = |of: &dyn Fn(&Field) -> DVec3| state.found().map(of).sum::<DVec3>();
        let unshot = state.unshot().map_or(DVec3::ZERO, |unshot| self.reflected(unshot));
        let sent = sum(&|field| self.reflected(field)) - unshot;
        let direct = state.bounces.first().map_or(DVec3::ZERO, |direct| self.incident(direct));
        let arrived = sum(&|field| self.incident(field)) - direct;
        let area = self.area();
        let all = area * f64::from(self.levels);
        let albedo = self.reflecting.iter().map(|area| area.as_dvec3()).sum::<DVec3>() / all;
        let channel = |k: usize| {
            let all = sent[k] + unshot[k];
            let arrives = if all > 0.0 { ((arrived[k] + unshot[k]) / all).clamp(0.0, 1.0) } else { 1.0 };
            arrives / (1.0 - (arrives * albedo[k]).min(MAX_RATIO))
        };
        DVec3::new(channel(0), channel(1), channel(2))
    }

    /// The share of all light found that is missing where light is shot: the power of the [ambient](Self::ambient) term.
    pub fn missing(&self, state: &SolveState) -> f64 {
        let area = self.area();
        let found: f64 = state.found().map(|field| self.power(field)).sum();
        let missing = area * f64::from(luminance(self.ambient(state)));
        if found > 0.0 { missing / found } else { 0.0 }
    }

    /// [`PowerLog::remainder`] of these bounces.
    pub fn remainder(&self, bounces: &[Field]) -> Option<f64> {
        PowerLog::of(self, bounces).remainder()
    }

    /// The bounces after the last one, as a geometric series of the last one: `λ/(1 − λ)` of it per channel.
    ///
    /// Consistent in shape only: the last bounce's pattern stands for all later ones, whose differences from it are
    /// of second order once light is well mixed. λ is the ratio of the last two, or the share that is reflected of the first one.
    /// `None` when there is no ratio below 0.98 in any channel.
    pub fn tail(&self, bounces: &[Field]) -> Option<Field> {
        let factors = self.tail_factors(bounces)?;
        Some(scaled(bounces.last()?, factors))
    }

    /// What stands for the light that was not computed: the [`tail`](Self::tail) of bounces, or what was shot, the
    /// [`ambient`](Self::ambient) term.
    pub fn tail_of(&self, state: &SolveState) -> Option<Field> {
        match state.shot {
            Some(_) => Some(ambient_field(self, state, state)),
            None => self.tail(&state.bounces),
        }
    }

    /// What the last bounce is multiplied by to give its [`tail`](Self::tail), per colour channel.
    pub(crate) fn tail_factors(&self, bounces: &[Field]) -> Option<Vec3> {
        let ratios = match bounces {
            [] | [_] => return None,
            // How the first bounce compares to direct light, of which much may leave at once, says nothing of later ones.
            [_, first] => self.reflected(first) / self.incident(first),
            [.., before, last] => self.incident(last) / self.incident(before),
        };
        let factor = |k: usize| {
            let ratio = ratios[k];
            if ratio > 0.0 && ratio < MAX_RATIO { (ratio / (1.0 - ratio)) as f32 } else { 0.0 }
        };
        let factors = Vec3::new(factor(0), factor(1), factor(2));
        (factors != Vec3::ZERO).then_some(factors)
    }
}

/// The [ambient](Integrals::ambient) term of a layer of a state that was shot, or of all of it, at every node.
///
/// It has the factors of the state, so that those of layers add up.
pub(crate) fn ambient_field(integrals: &Integrals, state: &SolveState, layer: &SolveState) -> Field {
    let channels = layer.unshot().map_or(1, Field::channels);
    let ambient = integrals.ambient_with(integrals.ambient_per_power(state), layer);
    let no_direction = std::iter::repeat_n(Vec3::ZERO, channels - 1);
    let node = std::iter::once(ambient).chain(no_direction);
    Field::with_channels(channels, (0..layer.node_count()).flat_map(|_| node.clone()).collect())
}

/// A field with every coefficient multiplied per colour channel.
pub(crate) fn scaled(field: &Field, factors: Vec3) -> Field {
    Field::with_channels(field.channels(), field.values().iter().map(|&value| value * factors).collect())
}
