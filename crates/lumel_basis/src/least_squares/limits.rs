//! Taking back what overshoots beside the edges of light.

use super::LeastSquares;
use crate::Field;
use glam::DVec3;
use rayon::prelude::*;

/// How far coefficients may leave the range of the means around them, as a share of its ends: an eye sees dark rings from
/// about here on, and smooth light on a fine mesh stays within.
const ROOM: f64 = 0.1;

/// How far at borders, as a share of the range, but not below zero: what linear functions need there, whose means are those
/// of the inside; on a triangle by itself, twice their range.
const ROOM_AT_BORDERS: f64 = 2.0;

/// What is taken back at one node may bring its neighbours out of range. More rounds change nothing that can be seen.
const ROUNDS: usize = 3;

/// How much nodes take of what least squares move between them: where light has an edge, less than all.
///
/// Means become coefficients by moving light from node to node. Beside an edge of the light, the dim side gives more than it
/// has to spare and becomes darker than anything around it, even black. Where a coefficient would leave the range of the
/// means around it by more than a tenth, its node gives and takes less, and so do the nodes at the other end, so that power
/// is conserved. Everywhere else nothing changes.
///
/// After Zalesak, *Fully multidimensional flux-corrected transport algorithms for fluids*, Journal of Computational Physics
/// 31 (3), 1979, with the differences that what stays in range is not limited, and that all colours have one share.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Of each node, what it gives and what it takes: 0 to 1.
    shares: Vec<[f32; 2]>,
    /// Whether nothing that moves to a node or away from it is limited.
    free: Vec<bool>,
    /// They say which of two nodes gives to the other, for any light within these limits, so that it stays linear.
    coefficients: Vec<DVec3>,
    /// The means that they are the projection of.
    means: Vec<DVec3>,
}

impl Limits {
    /// The share of what moves from node `j` to node `i` for a coefficient `value` of the matrix.
    fn between(&self, i: usize, j: usize, value: f64) -> DVec3 {
        let ([i_gives, i_takes], [j_gives, j_takes]) = (self.shares[i], self.shares[j]);
        let moves_to_i = (value * (self.coefficients[i] - self.coefficients[j])).cmpgt(DVec3::ZERO);
        let [to_i, from_i] = [i_takes.min(j_gives), i_gives.min(j_takes)];
        DVec3::select(moves_to_i, DVec3::splat(to_i.into()), DVec3::splat(from_i.into()))
    }
}

impl LeastSquares {
    /// The limits that keep the projection of these means in range; of several channels, those of the first.
    ///
    /// # Panics
    /// If the field has another number of nodes than the basis.
    pub fn limits(&self, means: &Field) -> Limits {
        let n = self.areas.len();
        assert_eq!(means.node_count(), n, "the field is one over other nodes");
        let first_channel = means.values().iter().step_by(means.channels());
        let means: Vec<DVec3> = first_channel.map(|mean| mean.as_dvec3()).collect();
        let (coefficients, _) = self.solve(&means);
        let room: Vec<[DVec3; 2]> = (0..n).into_par_iter().map(|i| self.room(i, &means)).collect();
        let mut limits = Limits { shares: vec![[1.0; 2]; n], free: vec![true; n], coefficients, means };
        for _ in 0..ROUNDS {
            let share = |i: usize| {
                let moved = (limits.coefficients[i] - limits.means[i]) * self.areas[i];
                let [low, high] = room[i];
                let stays = limits.free[i] && moved.cmpge(low).all() && moved.cmple(high).all();
                if stays { [1.0; 2] } else { self.shares(i, &limits, room[i]) }
            };
            limits.shares = (0..n).into_par_iter().map(share).collect();
            let is_free = |i: usize| self.matrix.row(i).all(|(j, _)| limits.shares[j.index()] == [1.0; 2]);
            limits.free = (0..n).into_par_iter().map(is_free).collect();
        }
        limits
    }

    /// The shares that keep node `i` within its room, as far as those of its neighbours are right.
    fn shares(&self, i: usize, limits: &Limits, [low, high]: [DVec3; 2]) -> [f32; 2] {
        let moved = self.moved(i, limits, &limits.coefficients);
        let [given, taken] = moved.fold([DVec3::ZERO; 2], |[given, taken], moved| {
            [given + moved.min(DVec3::ZERO), taken + moved.max(DVec3::ZERO)]
        });
        let share = |is_out, end: DVec3, all: DVec3| {
            DVec3::select(is_out, (end / all).clamp(DVec3::ZERO, DVec3::ONE), DVec3::ONE).min_element() as f32
        };
        let [gives, takes] = limits.shares[i];
        let sum = given + taken;
        [
            gives * share(sum.cmplt(low), low - taken, given),
            takes * share(sum.cmpgt(high), high - given, taken),
        ]
    }

    /// [`project`](Self::project) within limits, which may be those of other means: it is linear in the means.
    ///
    /// # Panics
    /// If the field or the limits have another number of nodes than the basis.
    pub fn project_within(&self, limits: &Limits, means: &mut Field) {
        assert_eq!(limits.shares.len(), self.areas.len(), "the limits are those of other nodes");
        self.in_each_channel(means, |means| {
            let solved = if *means == limits.means { None } else { Some(self.solve(means).0) };
            let coefficients = solved.as_ref().unwrap_or(&limits.coefficients);
            let limited = |i: usize| {
                if self.areas[i] == 0.0 || limits.free[i] {
                    return coefficients[i];
                }
                means[i] + self.moved(i, limits, coefficients).sum::<DVec3>() / self.areas[i]
            };
            ((0..means.len()).into_par_iter().map(limited).collect(), ())
        });
    }

    /// The light that the projection moves to node `i` from each node within limits: without any, they sum to the difference
    /// of its coefficient and its mean, times its area.
    fn moved(&self, i: usize, limits: &Limits, coefficients: &[DVec3]) -> impl Iterator<Item = DVec3> {
        self.matrix.row(i).map(move |(j, value)| {
            let j = j.index();
            (coefficients[i] - coefficients[j]) * (value * limits.between(i, j, value))
        })
    }

    /// How much light may move away from node `i`, not above zero, and to it.
    fn room(&self, i: usize, means: &[DVec3]) -> [DVec3; 2] {
        let around = self.matrix.row(i).map(|(j, _)| j.index()).filter(|&j| self.areas[j] > 0.0);
        let [low, high] =
            around.fold([means[i]; 2], |[low, high], j| [low.min(means[j]), high.max(means[j])]);
        let at_border = if self.is_border[i] { ROOM_AT_BORDERS } else { 0.0 } * (high - low);
        let lowest = (low - at_border.max(ROOM * low.abs())).max(low.min(DVec3::ZERO));
        [lowest, high + at_border.max(ROOM * high.abs())].map(|end| (end - means[i]) * self.areas[i])
    }
}
