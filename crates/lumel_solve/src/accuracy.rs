//! What the spread of replicates says about errors.

use glam::{DVec3, Vec3};
use lumel_basis::{Adjacency, Field, NodeId};
use serde::{Deserialize, Serialize};

/// Independent solves whose spread gives the standard error.
pub const REPLICATES: usize = 8;

/// Half the width of a 95 % interval, in standard errors: Student's t with seven degrees of freedom.
///
/// The truth lies within this many standard errors of the mean of eight replicates 95 times in 100, if replicates are
/// distributed normally. A normal quantile, 1.96, would leave out that the spread of eight is itself uncertain.
pub const CONFIDENCE_95: f64 = 2.364_624_251;

/// Values darker than this share of the mean irradiance of all surfaces are compared with it instead of themselves.
const FLOOR: f64 = 0.1;

/// A node goes on while its own spread is this many times the target, whatever its neighbours say.
///
/// Where spreads are alike, one that is twice what it should be happens once in five thousand times, so that deciding by
/// it hardly picks the nodes whose spread is small by luck.
const OWN_LIMIT: f64 = 2.0;

/// What a solve is to reach.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Half the width of the 95 % interval of a value, relative to it.
    pub error: f64,
    /// The share of values that must be below.
    pub share: f64,
    /// Rounds at most; each but the first doubles the samples of the nodes that it measures.
    pub rounds: u32,
    /// Bytes of stored rays.
    pub memory: u64,
}

/// Why no more samples were added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ended {
    /// Enough values are below the target.
    Reached,
    /// As many samples as a node may have.
    Samples,
    /// More rays would not fit into memory.
    Memory,
}

/// How good a solution is; half widths are those of 95 % intervals, relative.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// What was to be reached.
    pub target: Target,
    /// Share of values below the target, by the spread of each and its neighbours: what decides.
    pub share: f64,
    /// Share of values below the target by their own spread alone.
    pub own_share: f64,
    /// The half width that half of all values are below.
    pub median: f64,
    /// The largest half width.
    pub worst: f64,
    /// Rounds so far.
    pub rounds: u32,
    /// Why there were no more; `None` while it goes on.
    pub ended: Option<Ended>,
}

/// How far each value may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// Standard error of all light at each node and channel, W·m⁻².
    ///
    /// From each node's own eight replicates; multiply by [`CONFIDENCE_95`] for an interval.
    pub standard_error: Field,
    /// In short.
    pub accuracy: Accuracy,
}

/// The spread of replicates and what is still to be done.
pub(crate) struct Spread {
    pub(crate) standard_error: Field,
    /// Nodes above the target.
    pub(crate) above: Vec<bool>,
    pub(crate) accuracy: Accuracy,
}

impl Spread {
    /// That of the totals of all replicates; `mean_light` is the irradiance that dark values are compared with.
    pub(crate) fn new(
        totals: &[Vec<DVec3>],
        valid: &[bool],
        adjacency: &Adjacency,
        mean_light: impl FnOnce(&Field) -> f64,
        target: Target,
    ) -> Self {
        let of_node = |node: usize| mean_and_error(totals.iter().map(move |total| total[node]));
        let moments: Vec<(DVec3, DVec3)> = (0..valid.len()).map(of_node).collect();
        let mean = Field::from_values(moments.iter().map(|(mean, _)| mean.as_vec3()).collect());
        let errors: Vec<Vec3> = moments.iter().map(|(_, error)| error.as_vec3()).collect();
        let floor = FLOOR * mean_light(&mean);
        let relative: Vec<DVec3> =
            moments.iter().map(|(mean, error)| half_width(*mean, *error, floor)).collect();
        let pooled = |node: usize| {
            let all = || adjacency.neighbourhood(NodeId(node as u32)).map(NodeId::index);
            let beside = || all().filter(|&n| valid[n]);
            let squares: DVec3 = beside().map(|n| relative[n] * relative[n]).sum();
            (squares.max_element() / beside().count().max(1) as f64).sqrt()
        };
        let own = |node: usize| relative[node].max_element();
        let is_above = |node: usize| {
            valid[node] && (pooled(node) > target.error || own(node) > OWN_LIMIT * target.error)
        };
        let above: Vec<bool> = (0..valid.len()).map(is_above).collect();
        let mut widths: Vec<f64> = (0..valid.len()).filter(|&node| valid[node]).map(own).collect();
        widths.sort_by(f64::total_cmp);
        let share = |n_below: usize| {
            if widths.is_empty() { 1.0 } else { n_below as f64 / widths.len() as f64 }
        };
        let accuracy = Accuracy {
            target,
            share: share(widths.len() - above.iter().filter(|&&above| above).count()),
            own_share: share(widths.iter().filter(|&&width| width <= target.error).count()),
            median: widths.get(widths.len() / 2).copied().unwrap_or(0.0),
            worst: widths.last().copied().unwrap_or(0.0),
            rounds: 0,
            ended: None,
        };
        Self { standard_error: Field::from_values(errors), above, accuracy }
    }
}

/// The mean of independent measurements of one value, and its standard error.
pub fn mean_and_error(values: impl ExactSizeIterator<Item = DVec3> + Clone) -> (DVec3, DVec3) {
    let n = values.len() as f64;
    let mean = values.clone().sum::<DVec3>() / n;
    let squares: DVec3 = values.map(|value| (value - mean) * (value - mean)).sum();
    (mean, (squares / (n * (n - 1.0))).map(f64::sqrt))
}

/// Half of the interval of each channel over its value, or over `floor` where that is more.
fn half_width(mean: DVec3, error: DVec3, floor: f64) -> DVec3 {
    let channel = |k: usize| match error[k] {
        0.0 => 0.0,
        error => CONFIDENCE_95 * error / mean[k].max(floor),
    };
    DVec3::new(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGET: Target = Target { error: 0.1, share: 0.95, rounds: 7, memory: 1 << 30 };

    /// Totals of eight replicates whose nodes have mean 1 and this standard error.
    fn totals(errors: &[f64]) -> Vec<Vec<DVec3>> {
        // Half are up and half are down by d: the variance of the mean is d² / 7.
        let sign = |r: usize| if r.is_multiple_of(2) { 1.0 } else { -1.0 };
        let of = |r: usize| errors.iter().map(|e| DVec3::splat(1.0 + sign(r) * e * 7f64.sqrt())).collect();
        (0..REPLICATES).map(of).collect()
    }

    /// A chain of nodes, each beside the next.
    fn chain(n: u32) -> Adjacency {
        Adjacency::from_cells(n as usize, (1..n).map(|i| [i - 1, i].map(NodeId)))
    }

    fn spread(errors: &[f64], mean_light: f64) -> Spread {
        let valid = vec![true; errors.len()];
        Spread::new(&totals(errors), &valid, &chain(errors.len() as u32), |_| mean_light, TARGET)
    }

    #[test]
    fn the_standard_error_is_that_of_the_mean_of_all_replicates() {
        let spread = spread(&[0.01, 0.02], 1.0);
        for (node, error) in [(0, 0.01), (1, 0.02)] {
            assert!((spread.standard_error.values()[node] - Vec3::splat(error)).length() < 1e-7);
        }
        assert!((spread.accuracy.worst / (0.02 * CONFIDENCE_95) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_node_that_is_good_by_luck_goes_on_with_its_neighbours() {
        let high = 1.5 * TARGET.error / CONFIDENCE_95;
        assert_eq!(spread(&[high, 0.0, high], 1.0).above, [true; 3]);
        let low = 0.9 * TARGET.error / CONFIDENCE_95;
        assert_eq!(spread(&[low, low, low], 1.0).above, [false; 3]);
    }

    #[test]
    fn a_node_much_worse_than_its_neighbours_goes_on_though_their_mean_is_good() {
        let far = 2.1 * TARGET.error / CONFIDENCE_95;
        let found = spread(&[0.0, 0.0, far, 0.0, 0.0, 0.0], 1.0).above;
        assert!(found[2] && !found[0] && !found[4] && !found[5], "{found:?}");
    }

    #[test]
    fn dark_values_are_compared_with_a_tenth_of_the_mean_light() {
        let error = 2.0 * TARGET.error / CONFIDENCE_95;
        assert_eq!(spread(&[error, error], 1.0).accuracy.share, 0.0);
        assert_eq!(spread(&[error, error], 21.0).accuracy.share, 1.0);
    }

    #[test]
    fn hidden_nodes_and_darkness_count_for_nothing() {
        let totals = totals(&[1.0, 0.0]);
        let spread = Spread::new(&totals, &[false, true], &chain(2), |_| 1.0, TARGET);
        assert_eq!((spread.above, spread.accuracy.share), (vec![false, false], 1.0));
        let dark = vec![vec![DVec3::ZERO; 2]; REPLICATES];
        let spread = Spread::new(&dark, &[true; 2], &chain(2), |_| 0.0, TARGET);
        assert_eq!((spread.accuracy.worst, spread.accuracy.share), (0.0, 1.0));
    }
}
