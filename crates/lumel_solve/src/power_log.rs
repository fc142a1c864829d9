//! The powers of bounces, each computed once.

use crate::Integrals;
use glam::DVec3;
use lumel_basis::Field;

/// The power that each bounce of a solve brings, in their order.
///
/// A bounce is integrated when it is added, never again: deciding after each of `n` bounces whether there are enough
/// reads each of them once.
#[derive(Clone, Debug)]
pub struct PowerLog<'a> {
    integrals: &'a Integrals,
    /// W by luminance.
    powers: Vec<f64>,
    /// Whether surfaces reflect nothing of the direct light.
    all_absorbed: bool,
}

impl<'a> PowerLog<'a> {
    /// The log before the first bounce.
    pub fn new(integrals: &'a Integrals) -> Self {
        Self { integrals, powers: Vec::new(), all_absorbed: false }
    }

    /// The log of these bounces, direct light included.
    pub fn of(integrals: &'a Integrals, bounces: &[Field]) -> Self {
        let mut log = Self::new(integrals);
        bounces.iter().for_each(|bounce| log.add(bounce));
        log
    }

    /// What powers are integrals of.
    pub(crate) fn integrals(&self) -> &'a Integrals {
        self.integrals
    }

    /// Adds the next bounce.
    pub fn add(&mut self, bounce: &Field) {
        if self.powers.is_empty() {
            self.all_absorbed = self.integrals.reflected(bounce) == DVec3::ZERO;
        }
        self.powers.push(self.integrals.power(bounce));
    }

    /// The power that arrives in each bounce, W by luminance.
    pub fn powers(&self) -> &[f64] {
        &self.powers
    }

    /// Share of all light, by luminance of the incident power, that bounces after the last one would bring.
    ///
    /// Assumes that each goes on shrinking by the ratio of the last two. `None` while there is no ratio or the last
    /// bounce was no weaker than the one before.
    pub fn remainder(&self) -> Option<f64> {
        self.remainder_after(self.powers.len(), self.powers.iter().sum())
    }

    /// [`remainder`](Self::remainder) after the first `n` bounces, whose powers add up to `total`.
    fn remainder_after(&self, n: usize, total: f64) -> Option<f64> {
        let [.., before, last] = self.powers[..n] else {
            return (n == 1 && self.all_absorbed).then_some(0.0);
        };
        if last <= 0.0 {
            return Some(0.0);
        }
        let ratio = last / before;
        (ratio < 1.0).then(|| last * ratio / (1.0 - ratio) / total)
    }

    /// How many bounces there are when, for the first time, the remainder is below `fraction` or more than `at_most`
    /// bounces follow the direct light; `None` if they are not enough.
    pub(crate) fn first_below(&self, fraction: f64, at_most: usize) -> Option<usize> {
        let mut total = 0.0;
        (1..=self.powers.len()).find(|&n| {
            total += self.powers[n - 1];
            n > at_most || self.remainder_after(n, total).is_some_and(|left| left < fraction)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stop;
    use glam::Vec3;

    /// Bounces on one node of one square metre.
    fn bounces(powers: &[f32]) -> Vec<Field> {
        powers.iter().map(|&power| Field::from_values(vec![Vec3::splat(power)])).collect()
    }

    fn integrals(albedo: f32) -> Integrals {
        Integrals::new(vec![1.0], vec![Vec3::splat(albedo)])
    }

    #[test]
    fn a_log_that_grows_says_what_one_of_all_bounces_says() {
        let (integrals, bounces) = (integrals(0.5), bounces(&[8.0, 4.0, 5.0, 2.0, 1.0, 0.5, 0.0]));
        let stop = Stop::Remainder { fraction: 0.03, at_most: 64 };
        let mut grown = PowerLog::new(&integrals);
        for n in 1..=bounces.len() {
            grown.add(&bounces[n - 1]);
            let whole = PowerLog::of(&integrals, &bounces[..n]);
            assert_eq!((grown.powers(), grown.remainder()), (whole.powers(), whole.remainder()));
            assert_eq!(grown.remainder(), integrals.remainder(&bounces[..n]));
            // After 0.5 W of 20.5 W, another 0.5 W is missing.
            assert_eq!(stop.wanted(&grown), (n >= 6).then_some(6), "{n} bounces");
        }
    }

    #[test]
    fn what_absorbs_all_light_needs_no_bounce() {
        let stop = Stop::Remainder { fraction: 0.5, at_most: 64 };
        let direct = bounces(&[1.0]);
        assert_eq!(stop.wanted(&PowerLog::of(&integrals(0.0), &direct)), Some(1));
        assert_eq!(stop.wanted(&PowerLog::of(&integrals(0.5), &direct)), None);
        assert_eq!(stop.wanted(&PowerLog::new(&integrals(0.0))), None, "there is no light yet");
    }
}
