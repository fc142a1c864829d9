//! Solving for coefficients.

use super::LeastSquares;
use glam::{DVec3, Vec3A};
use rayon::prelude::*;

/// Iterations end when no residual, over the diagonal of its row, is larger than this share of the largest mean of its
/// colour: coefficients are then off by about 1e-7 of it, which single precision rounds away.
const TOLERANCE: f64 = 4e-7;

/// More iterations than usual meshes need: twelve without a regulariser, some thirty with it.
const MAX_ITERATIONS: usize = 60;

/// Rows that are summed one after the other; the sums of blocks are added in order, whichever thread made them.
const BLOCK: usize = 1024;

impl LeastSquares {
    /// Conjugate gradients with Jacobi's preconditioner from the means, one system for each colour.
    ///
    /// The eigenvalues of the mass matrix lumped to its row sums, which are twice its diagonal, lie from 1/4 to 1 on any
    /// mesh (Wathen 1987), so that each iteration leaves a third of the error at most without a regulariser.
    pub(super) fn solve(&self, means: &[DVec3]) -> (Vec<DVec3>, usize) {
        let n = means.len();
        let block = |i: usize| i * BLOCK..((i + 1) * BLOCK).min(n);
        let largest = means.iter().fold(DVec3::ZERO, |max, mean| max.max(mean.abs()));
        let mut u = means.to_vec();
        let residual = |u: &[DVec3], i: usize| means[i] * self.areas[i] - self.matrix.times(i, u);
        let mut r: Vec<DVec3> = (0..n).into_par_iter().map(|i| residual(&u, i)).collect();
        let conditioned = |r: DVec3, row: usize| r * self.inverse_diagonal[row];
        // Rounded, which is no error: what is added to `u` is what takes its product off the residual.
        let mut p: Vec<Vec3A> =
            r.par_iter().enumerate().map(|(row, r)| conditioned(*r, row).as_vec3a()).collect();
        let mut rz =
            sum(r.par_chunks(BLOCK).zip(p.par_chunks(BLOCK)).map(|(r, z)| dot(z, r.iter().copied())));
        let mut change = p.iter().fold(Vec3A::ZERO, |max, z| max.max(z.abs())).as_dvec3();
        let (mut ap, mut n_iterations) = (vec![Vec3A::ZERO; n], 0);
        while change.cmpgt(TOLERANCE * largest).any() && n_iterations < MAX_ITERATIONS {
            n_iterations += 1;
            let of_block = |(i, ap): (usize, &mut [Vec3A])| {
                ap.iter_mut().zip(block(i)).for_each(|(ap, row)| *ap = self.matrix.times_single(row, &p));
                dot(&p[block(i)], ap.iter().map(|ap| ap.as_dvec3()))
            };
            let step = ratio(rz, sum(ap.par_chunks_mut(BLOCK).enumerate().map(of_block)));
            let parts = u.par_chunks_mut(BLOCK).zip(r.par_chunks_mut(BLOCK)).enumerate();
            let stepped = parts.map(|(i, (u, r))| {
                let (mut product, mut largest) = (DVec3::ZERO, DVec3::ZERO);
                for (k, row) in block(i).enumerate() {
                    u[k] += step * p[row].as_dvec3();
                    r[k] -= step * ap[row].as_dvec3();
                    let z = conditioned(r[k], row);
                    product += r[k] * z;
                    largest = largest.max(z.abs());
                }
                (product, largest)
            });
            let stepped: Vec<(DVec3, DVec3)> = stepped.collect();
            change = stepped.iter().fold(DVec3::ZERO, |max, (_, largest)| max.max(*largest));
            let next = stepped.into_iter().fold(DVec3::ZERO, |sum, (product, _)| sum + product);
            let kept = ratio(next, rz);
            rz = next;
            let turned = |row: usize, p: Vec3A| (conditioned(r[row], row) + kept * p.as_dvec3()).as_vec3a();
            p.par_iter_mut().enumerate().for_each(|(row, p)| *p = turned(row, *p));
        }
        // What is left goes to the nodes by their areas, so that power is conserved to rounding: the columns of the
        // matrix sum to the areas.
        let left = |i: usize| {
            let area = self.areas[i];
            u[i] + if area > 0.0 { residual(&u, i) / area } else { DVec3::ZERO }
        };
        ((0..n).into_par_iter().map(left).collect(), n_iterations)
    }
}

fn dot(a: &[Vec3A], b: impl Iterator<Item = DVec3>) -> DVec3 {
    a.iter().zip(b).fold(DVec3::ZERO, |sum, (a, b)| sum + a.as_dvec3() * b)
}

/// The sum of what blocks have, in their order.
fn sum(blocks: impl IndexedParallelIterator<Item = DVec3>) -> DVec3 {
    blocks.collect::<Vec<_>>().into_iter().sum()
}

/// Of each colour; zero for those that are solved.
fn ratio(above: DVec3, below: DVec3) -> DVec3 {
    DVec3::select(below.cmpgt(DVec3::ZERO), above / below, DVec3::ZERO)
}
