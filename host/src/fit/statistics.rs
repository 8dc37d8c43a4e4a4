//! Root mean square and median.

/// Root of the mean square; 0 if there are no values.
pub(super) fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (square, n) = values.fold((0.0, 0), |(square, n), value| (square + value * value, n + 1));
    (square / f64::from(n.max(1))).sqrt()
}

/// Median of a set of numbers; 0 if there are none.
pub fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
