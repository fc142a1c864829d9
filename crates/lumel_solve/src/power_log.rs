//! The powers of bounces, each computed once.

use crate::Integrals;
use lumel_basis::Field;
use lumel_scene::luminance;

/// The power that each bounce of a solve brings, in their order.
///
/// A bounce is integrated when it is added, never again: deciding after each of `n` bounces whether there are enough
/// reads each of them once.
#[derive(Clone, Debug)]
pub struct PowerLog<'a> {
    integrals: &'a Integrals,
    /// W by luminance.
    powers: Vec<f64>,
    /// What surfaces reflect of each, W by luminance.
    reflected: Vec<f64>,
}

impl<'a> PowerLog<'a> {
    /// The log before the first bounce.
    pub fn new(integrals: &'a Integrals) -> Self {
        Self { integrals, powers: Vec::new(), reflected: Vec::new() }
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
        self.powers.push(self.integrals.power(bounce));
        self.reflected.push(f64::from(luminance(self.integrals.reflected(bounce).as_vec3())));
    }

    /// The power that arrives in each bounce, W by luminance.
    pub fn powers(&self) -> &[f64] {
        &self.powers
    }

    /// Share of all light, by luminance of the incident power, that bounces after the last one would bring.
    ///
    /// Assumes that each goes on shrinking by one ratio. `None` after direct light, unless nothing is
    /// reflected, and while bounces do not shrink.
    pub fn remainder(&self) -> Option<f64> {
        self.remainder_after(self.powers.len(), self.powers.iter().sum())
    }

    /// [`remainder`](Self::remainder) after the first `n` bounces, whose powers add up to `total`.
    fn remainder_after(&self, n: usize, total: f64) -> Option<f64> {
        let (reflected, last) = (*self.reflected[..n].last()?, self.powers[n - 1]);
        if reflected <= 0.0 || last <= 0.0 {
            return Some(0.0);
        }
        let ratio = self.ratio_after(n)?;
        (ratio < 1.0).then(|| last * ratio / (1.0 - ratio) / total)
    }

    /// How much weaker each bounce to come will be than the one before it, as far as the first `n` bounces tell.
    ///
    /// That of the last two, or more where it still grows: by as much again, but no more than is reflected. Of the direct
    /// light much may fall where it leaves the scene at once, such as onto roofs, so that how the first bounce compares to
    /// it says nothing of those to come.
    fn ratio_after(&self, n: usize) -> Option<f64> {
        let ratio = |k: usize| Some(self.powers[k] / self.powers[k.checked_sub(1)?]);
        let last = ratio(n.checked_sub(1)?)?;
        let most = last.max(self.reflected[n - 1] / self.powers[n - 1]);
        Some(ratio(n - 2).map_or(most, |before| most.min(last + (last - before).max(0.0))))
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
    fn light_that_leaves_at_once_does_not_make_bounces_look_weak() {
        let integrals = integrals(0.5);
        let after = |powers: &[f32]| PowerLog::of(&integrals, &bounces(powers)).remainder().unwrap();
        // Nothing but what is reflected limits what follows the first bounce: as much as that bounce.
        assert_eq!(after(&[93.0, 7.0]), 7.0 / 100.0);
        // The ratio has grown from 0.1 to 0.25 and may grow to 0.4.
        assert_eq!(after(&[80.0, 8.0, 2.0]), 2.0 * 0.4 / 0.6 / 90.0);
        // Not beyond a half, however.
        assert_eq!(after(&[80.0, 8.0, 3.25]), 3.25 / 91.25);
        // Where it falls, it is the last one.
        assert_eq!(after(&[10.0, 8.0, 2.0]), 2.0 * 0.25 / 0.75 / 20.0);
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
