//! Small dense least squares by normal equations, for up to eight parameters.
//!
//! The matrix is scaled to a unit diagonal and decomposed by cyclic Jacobi rotations. For eight columns that takes a
//! few microseconds. It never divides by a small pivot, and its smallest eigenvector says *which* parameter the data
//! cannot determine.

use crate::says::says;
use crate::scalar::Real;

/// The largest number of parameters.
pub const MAX_PARAMETERS: usize = 8;

/// Why normal equations have no trustworthy solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveError {
    /// Fewer rows than parameters, or more than [`MAX_PARAMETERS`] parameters.
    TooFewRows,
    /// A sum is not finite.
    NotFinite,
    /// The data cannot determine this parameter (the index of its column): it is the largest part of the weakest
    /// direction, or its column is zero.
    Undetermined {
        /// Index of the column.
        parameter: usize,
    },
}

says! { SolveError:
    Self::TooFewRows => "too few rows for the parameters, or too many parameters",
    Self::NotFinite => "numbers too large to be summed",
    Self::Undetermined { parameter } => "the data cannot determine parameter {parameter}",
}

/// Running sums of a least-squares problem with `N` columns: O(1) memory whatever the number of rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalEquations<R, const N: usize> {
    gram: [[R; N]; N],
    right: [R; N],
    square: R,
    rows: u32,
}

/// A least-squares solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<R, const N: usize> {
    /// The parameters.
    pub parameters: [R; N],
    /// Their covariance, from the residual variance; zero when there are as many rows as parameters.
    pub covariance: [[R; N]; N],
    /// The residual variance, RSS/(rows − N); zero when there are as many rows as parameters.
    pub variance: R,
    /// Ratio of the largest to the smallest eigenvalue of the scaled normal matrix; ≥ 1.
    pub condition: R,
    /// Smallest eigenvalue of the scaled normal matrix; at most 1.
    pub weakest: R,
    /// Column with the largest part in the weakest direction.
    pub weakest_parameter: usize,
}

impl<R: Real, const N: usize> Default for NormalEquations<R, N> {
    fn default() -> Self {
        Self { gram: [[R::ZERO; N]; N], right: [R::ZERO; N], square: R::ZERO, rows: 0 }
    }
}

impl<R: Real, const N: usize> NormalEquations<R, N> {
    /// Sums formed elsewhere: `gram` = Σ aaᵀ, `right` = Σ ay, `square` = Σ y².
    pub const fn from_sums(gram: [[R; N]; N], right: [R; N], square: R, rows: u32) -> Self {
        Self { gram, right, square, rows }
    }

    /// Adds the equation `row·θ = value`.
    pub fn add(&mut self, row: &[R; N], value: R) {
        for ((line, right), &a) in self.gram.iter_mut().zip(&mut self.right).zip(row) {
            for (entry, &b) in line.iter_mut().zip(row) {
                *entry += a * b;
            }
            *right += a * value;
        }
        self.square += value * value;
        self.rows = self.rows.saturating_add(1);
    }

    /// Number of rows added.
    pub const fn rows(&self) -> u32 {
        self.rows
    }

    /// Solves for the parameters.
    ///
    /// `max_condition` bounds the condition of the scaled normal matrix, e.g. 1e10 in f64 and 1e5 in f32.
    ///
    /// # Errors
    /// [`SolveError`]; an undetermined parameter is named by its column.
    pub fn solve(&self, max_condition: R) -> Result<Solution<R, N>, SolveError> {
        if N == 0 || N > MAX_PARAMETERS || (self.rows as usize) < N {
            return Err(SolveError::TooFewRows);
        }
        let scale = self.scale()?;
        let mut matrix = self.gram;
        scale_by(&mut matrix, &scale);
        let (values, vectors) = eigen(matrix);
        let (mut weakest, mut largest) = (0, R::ZERO);
        for (index, &value) in values.iter().enumerate() {
            if value < *values.get(weakest).unwrap_or(&value) {
                weakest = index;
            }
            largest = largest.max(value);
        }
        let smallest = *values.get(weakest).unwrap_or(&R::ZERO);
        let weakest_parameter = largest_part(&vectors, weakest);
        // Written so that a NaN is refused too.
        if !(smallest > R::ZERO && smallest * max_condition >= largest) {
            return Err(SolveError::Undetermined { parameter: weakest_parameter });
        }
        let mut inverse = [[R::ZERO; N]; N];
        for (k, &value) in values.iter().enumerate() {
            for (line, left) in inverse.iter_mut().zip(&vectors) {
                for (entry, right) in line.iter_mut().zip(&vectors) {
                    *entry += left[k] * right[k] / value;
                }
            }
        }
        scale_by(&mut inverse, &scale);
        let mut parameters = [R::ZERO; N];
        let mut explained = R::ZERO;
        for ((parameter, line), &right) in parameters.iter_mut().zip(&inverse).zip(&self.right) {
            for (&entry, &value) in line.iter().zip(&self.right) {
                *parameter += entry * value;
            }
            explained += *parameter * right;
        }
        let spare = self.rows as usize - N;
        let variance =
            if spare == 0 { R::ZERO } else { (self.square - explained).max(R::ZERO) / R::from_f64(spare as f64) };
        let covariance = inverse.map(|line| line.map(|entry| entry * variance));
        if !parameters.iter().all(|value| value.is_finite()) || !variance.is_finite() {
            return Err(SolveError::NotFinite);
        }
        Ok(Solution {
            parameters,
            covariance,
            variance,
            condition: largest / smallest,
            weakest: smallest,
            weakest_parameter,
        })
    }

    /// 1/√(diagonal), and the refusal of columns that are zero or not finite.
    fn scale(&self) -> Result<[R; N], SolveError> {
        let finite = self.gram.iter().flatten().chain(&self.right).all(|value| value.is_finite());
        if !finite || !self.square.is_finite() {
            return Err(SolveError::NotFinite);
        }
        let mut scale = [R::ZERO; N];
        for (index, (entry, line)) in scale.iter_mut().zip(&self.gram).enumerate() {
            let root = line[index].sqrt();
            *entry = R::ONE / root;
            if !(root > R::ZERO && entry.is_finite()) {
                return Err(SolveError::Undetermined { parameter: index });
            }
        }
        Ok(scale)
    }
}

fn scale_by<R: Real, const N: usize>(matrix: &mut [[R; N]; N], scale: &[R; N]) {
    for (line, &left) in matrix.iter_mut().zip(scale) {
        for (entry, &right) in line.iter_mut().zip(scale) {
            *entry = *entry * left * right;
        }
    }
}

fn largest_part<R: Real, const N: usize>(vectors: &[[R; N]; N], column: usize) -> usize {
    let (mut best, mut part) = (0, R::ZERO);
    for (index, line) in vectors.iter().enumerate() {
        let size = line[column].abs();
        if size > part {
            (best, part) = (index, size);
        }
    }
    best
}

#[allow(clippy::needless_range_loop, reason = "two rows of one matrix are rotated together")]
/// Eigenvalues and eigenvectors (in columns) of a symmetric matrix, by cyclic Jacobi rotations
/// (Golub and Van Loan, Matrix Computations, algorithm 8.4.3).
fn eigen<R: Real, const N: usize>(mut a: [[R; N]; N]) -> ([R; N], [[R; N]; N]) {
    // Convergence is quadratic: eight columns are diagonal to f64's precision after about seven sweeps.
    const SWEEPS: usize = 12;
    let mut v = [[R::ZERO; N]; N];
    for (index, line) in v.iter_mut().enumerate() {
        line[index] = R::ONE;
    }
    let two = R::from_f64(2.0);
    for _ in 0..SWEEPS {
        for p in 0..N {
            for q in (p + 1)..N {
                let off = a[p][q];
                if off == R::ZERO {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (two * off);
                let sign = if theta < R::ZERO { -R::ONE } else { R::ONE };
                let t = sign / (theta.abs() + (theta * theta + R::ONE).sqrt());
                let cos = R::ONE / (t * t + R::ONE).sqrt();
                let sin = t * cos;
                for line in a.iter_mut().chain(&mut v) {
                    let (left, right) = (line[p], line[q]);
                    line[p] = cos * left - sin * right;
                    line[q] = sin * left + cos * right;
                }
                for k in 0..N {
                    let (top, bottom) = (a[p][k], a[q][k]);
                    a[p][k] = cos * top - sin * bottom;
                    a[q][k] = sin * top + cos * bottom;
                }
                a[p][q] = R::ZERO;
                a[q][p] = R::ZERO;
            }
        }
    }
    let mut values = [R::ZERO; N];
    for (index, value) in values.iter_mut().enumerate() {
        *value = a[index][index];
    }
    (values, v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line<R: Real>(offset: f64) -> NormalEquations<R, 2> {
        let mut sums = NormalEquations::default();
        for k in 0..10 {
            let x = R::from_f64(f64::from(k) + offset);
            sums.add(&[x, R::ONE], R::from_f64(2.0) * x - R::from_f64(3.0));
        }
        sums
    }

    #[test]
    fn a_line_is_fitted_exactly() {
        let fit = line::<f64>(0.0).solve(1e10).unwrap();
        assert!((fit.parameters[0] - 2.0).abs() < 1e-13 && (fit.parameters[1] + 3.0).abs() < 1e-13);
        // f32: condition 18 times 2⁻²³, with the rounding of ten sums.
        let fit = line::<f32>(0.0).solve(1e5).unwrap();
        assert!((fit.parameters[0] - 2.0).abs() < 1e-5 && (fit.parameters[1] + 3.0).abs() < 3e-5);
    }

    #[test]
    fn covariance_is_that_of_the_textbook_line() {
        // Residuals ±1 alternating at x = 0..3 with slope and mean free: var slope = s²/Σ(x−x̄)², Σ(x−x̄)² = 5.
        let mut sums = NormalEquations::<f64, 2>::default();
        for (x, y) in [(0.0, 1.0), (1.0, -1.0), (2.0, -1.0), (3.0, 1.0)] {
            sums.add(&[x, 1.0], y);
        }
        let fit = sums.solve(1e10).unwrap();
        assert!((fit.variance - 2.0).abs() < 1e-12);
        assert!((fit.covariance[0][0] - 2.0 / 5.0).abs() < 1e-12);
        assert!((fit.covariance[1][1] - 2.0 * (0.25 + 2.25 / 5.0)).abs() < 1e-12);
        assert!((fit.covariance[0][1] + 1.5 * 2.0 / 5.0).abs() < 1e-12);
    }

    #[test]
    fn refusals_name_the_column() {
        let mut sums = NormalEquations::<f64, 3>::default();
        assert_eq!(sums.solve(1e10), Err(SolveError::TooFewRows));
        for k in 0..9 {
            let x = f64::from(k);
            sums.add(&[x * x, 0.0, x], x);
        }
        assert_eq!(sums.solve(1e10), Err(SolveError::Undetermined { parameter: 1 }));
        let mut sums = NormalEquations::<f64, 3>::default();
        for k in 0..9 {
            let x = f64::from(k);
            sums.add(&[x * x, 1.0, 2.0 + 1e-9 * x], x);
        }
        assert!(matches!(sums.solve(1e10), Err(SolveError::Undetermined { parameter: 1 | 2 })));
        sums.add(&[f64::NAN, 0.0, 0.0], 0.0);
        assert_eq!(sums.solve(1e10), Err(SolveError::NotFinite));
    }

    #[test]
    fn eight_columns_agree_with_the_residual_of_their_own_solution() {
        let mut sums = NormalEquations::<f64, 8>::default();
        let truth = [1.0, -2.0, 3.0, -4.0, 5.0, -6.0, 7.0, -8.0];
        for k in 0..40 {
            let x = f64::from(k) * 0.17;
            let row = core::array::from_fn(|n| libm::sin(x * (n as f64 + 1.0)) + 0.1);
            let value = row.iter().zip(truth).map(|(a, t)| a * t).sum();
            sums.add(&row, value);
        }
        let fit = sums.solve(1e10).unwrap();
        for (value, truth) in fit.parameters.iter().zip(truth) {
            assert!((value - truth).abs() < 1e-9, "{value} {truth}");
        }
        assert!(fit.condition >= 1.0 && fit.weakest <= 1.0);
    }
}
