//! Percentiles.

/// The value at or below which `percent` of all values lie (nearest rank); reorders the list. `None` for an empty one.
pub(crate) fn percentile(values: &mut [f32], percent: f64) -> Option<f32> {
    let last = values.len().checked_sub(1)?;
    let rank = ((percent / 100.0 * values.len() as f64).ceil() as usize).saturating_sub(1).min(last);
    Some(*values.select_nth_unstable_by(rank, f32::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::percentile;

    #[test]
    fn percentiles_are_nearest_ranks() {
        let mut values: Vec<f32> = (1..=200).rev().map(|i| i as f32).collect();
        let at = [0.0, 1.0, 50.0, 99.0, 100.0].map(|p| percentile(&mut values, p));
        assert_eq!(at, [1.0, 2.0, 100.0, 198.0, 200.0].map(Some));
        assert_eq!(percentile(&mut [7.0], 1.0), Some(7.0));
        assert_eq!(percentile(&mut [], 50.0), None);
    }
}
