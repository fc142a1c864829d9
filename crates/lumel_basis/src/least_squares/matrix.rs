//! A sparse matrix over nodes.

use crate::NodeId;
use glam::{DVec3, Vec3A};
use rayon::prelude::*;
use std::ops::Range;

/// Rows that are assembled one after the other, to be put together in order.
const ROWS_PER_PART: usize = 4096;

/// A matrix over nodes in compressed rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Matrix {
    /// Where each row ends.
    ends: Vec<u32>,
    /// Each row in ascending order.
    columns: Vec<NodeId>,
    values: Vec<f32>,
}

impl Matrix {
    /// Assembles it row by row. `push_terms` adds terms of a row with their columns; those of one column are summed in
    /// the order in which they were added.
    pub(super) fn from_rows(
        n_rows: usize,
        push_terms: impl Fn(NodeId, &mut Vec<(NodeId, f64)>) + Sync,
    ) -> Self {
        let starts: Vec<usize> = (0..n_rows).step_by(ROWS_PER_PART).collect();
        let part = |&start: &usize| {
            let (mut part, mut terms, mut sums) = (Self::default(), Vec::new(), Vec::new());
            for row in start..(start + ROWS_PER_PART).min(n_rows) {
                terms.clear();
                sums.clear();
                push_terms(NodeId(row as u32), &mut terms);
                for &(column, value) in &terms {
                    match sums.iter_mut().find(|(known, _): &&mut (NodeId, f64)| *known == column) {
                        Some((_, sum)) => *sum += value,
                        None => sums.push((column, value)),
                    }
                }
                sums.sort_unstable_by_key(|(column, _)| *column);
                part.columns.extend(sums.iter().map(|(column, _)| *column));
                part.values.extend(sums.iter().map(|(_, value)| *value as f32));
                part.ends.push(part.columns.len() as u32);
            }
            part
        };
        let parts: Vec<Self> = starts.par_iter().map(part).collect();
        let n_values = parts.iter().map(|part| part.values.len()).sum();
        let mut matrix = Self {
            ends: Vec::with_capacity(n_rows),
            columns: Vec::with_capacity(n_values),
            values: Vec::with_capacity(n_values),
        };
        for part in parts {
            let begin = matrix.columns.len() as u32;
            matrix.ends.extend(part.ends.into_iter().map(|end| begin + end));
            matrix.columns.extend(part.columns);
            matrix.values.extend(part.values);
        }
        matrix
    }

    /// Where a row lies.
    #[inline]
    fn range(&self, row: usize) -> Range<usize> {
        let begin = if row == 0 { 0 } else { self.ends[row - 1] };
        begin as usize..self.ends[row] as usize
    }

    /// The columns and values of a row.
    #[inline]
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = (NodeId, f64)> + '_ {
        let row = self.range(row);
        let values = self.values[row.clone()].iter().map(|&value| f64::from(value));
        self.columns[row].iter().copied().zip(values)
    }

    /// A row times a vector in single precision: of half the memory, and all colours in one operation.
    #[inline]
    pub(super) fn times_single(&self, row: usize, vector: &[Vec3A]) -> Vec3A {
        let row = self.range(row);
        let terms = self.columns[row.clone()].iter().zip(&self.values[row]);
        terms.fold(Vec3A::ZERO, |sum, (column, value)| sum + vector[column.index()] * *value)
    }

    /// A row times a vector.
    #[inline]
    pub(super) fn times(&self, row: usize, vector: &[DVec3]) -> DVec3 {
        self.row(row).fold(DVec3::ZERO, |sum, (column, value)| sum + vector[column.index()] * value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_all_parts_follow_each_other() {
        let n_rows = 2 * ROWS_PER_PART + 3;
        // A difference of neighbours, the last row without one before it.
        let matrix = Matrix::from_rows(n_rows, |row, terms| {
            terms.extend([(row, 2.0), (row, 1.0)]);
            terms.extend(row.0.checked_sub(1).map(|before| (NodeId(before), -3.0)));
        });
        let vector: Vec<DVec3> = (0..n_rows).map(|i| DVec3::new(i as f64, 1.0, 0.0)).collect();
        assert_eq!(matrix.times(0, &vector), DVec3::new(0.0, 3.0, 0.0));
        assert!((1..n_rows).all(|row| matrix.times(row, &vector) == DVec3::new(3.0, 0.0, 0.0)));
        assert!(
            matrix
                .row(ROWS_PER_PART)
                .map(|(column, _)| column.index())
                .eq([ROWS_PER_PART - 1, ROWS_PER_PART])
        );
    }
}
