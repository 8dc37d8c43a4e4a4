//! Bilinear forms of the recorded sums, and the small matrices of the solution.

use super::block::{COLUMNS, Matrix};
use crate::scalar::{ExactSum, SolverReal};

/// Index of ∫φu among a row's columns.
pub(super) const DRIVE: usize = COLUMNS - 1;
/// Index of ∫φ·sgn v.
pub(super) const SIGN: usize = 2;

pub(super) type Column<R> = [R; COLUMNS];

pub(super) fn drive_column<R: SolverReal>() -> Column<R> {
    let mut column = [R::ZERO; COLUMNS];
    column[DRIVE] = R::ONE;
    column
}

/// The parameters' columns as combinations of the recorded ones: the sign's carries the edge correction.
pub(super) fn columns<R: SolverReal, const N: usize>(f1: R) -> [Column<R>; N] {
    let mut columns = [[R::ZERO; COLUMNS]; N];
    for (k, column) in columns.iter_mut().enumerate() {
        column[k] = R::ONE;
    }
    let f1 = f1.max(R::ZERO);
    columns[SIGN][4] = f1;
    columns[SIGN][5] = f1 * f1 * f1;
    columns
}

#[inline(never)]
pub(super) fn bilinear<R: SolverReal>(matrix: &Matrix<R>, left: &Column<R>, right: &Column<R>) -> R::Sum {
    let mut sum = R::Sum::default();
    for (line, &a) in matrix.iter().zip(left) {
        if a != R::ZERO {
            let mut inner = R::Sum::default();
            for (entry, &b) in line.iter().zip(right) {
                inner = inner.plus(entry.times(b));
            }
            sum = sum.plus(inner.times(a));
        }
    }
    sum
}

/// Σ r² for given parameters.
pub(super) fn residual<R: SolverReal, const N: usize>(matrix: &Matrix<R>, parameters: &[R; N]) -> R {
    residual_form(matrix, parameters).max(R::ZERO)
}

/// Σ r² (or Σ `r·r_next`) for given parameters.
#[inline(never)]
pub(super) fn residual_form<R: SolverReal, const N: usize>(matrix: &Matrix<R>, parameters: &[R; N]) -> R {
    let mut direction = drive_column();
    for (column, &parameter) in columns::<R, N>(parameters[2]).iter().zip(parameters) {
        for (entry, &part) in direction.iter_mut().zip(column) {
            *entry -= parameter * part;
        }
    }
    bilinear::<R>(matrix, &direction, &direction).rounded()
}

/// Inverse by Gauss-Jordan elimination with row pivoting; `None` when a pivot vanishes.
pub(super) fn invert<R: SolverReal, const N: usize>(mut a: [[R; N]; N]) -> Option<[[R; N]; N]> {
    let mut inverse = [[R::ZERO; N]; N];
    for (k, line) in inverse.iter_mut().enumerate() {
        line[k] = R::ONE;
    }
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if a[i][k].abs() > a[pivot][k].abs() {
                pivot = i;
            }
        }
        a.swap(k, pivot);
        inverse.swap(k, pivot);
        let scale = R::ONE / a[k][k];
        if !scale.is_finite() {
            return None;
        }
        for j in 0..N {
            a[k][j] *= scale;
            inverse[k][j] *= scale;
        }
        for i in (0..N).filter(|&i| i != k) {
            let factor = a[i][k];
            for j in 0..N {
                let (left, right) = (a[k][j], inverse[k][j]);
                a[i][j] -= factor * left;
                inverse[i][j] -= factor * right;
            }
        }
    }
    Some(inverse)
}

/// inverse·meat·inverseᵀ.
pub(super) fn sandwich<R: SolverReal, const N: usize>(inverse: &[[R; N]; N], meat: &[[R; N]; N]) -> [[R; 4]; 4] {
    let mut covariance = [[R::ZERO; 4]; 4];
    for (line, left) in covariance.iter_mut().zip(inverse) {
        for (entry, right) in line.iter_mut().zip(inverse) {
            for (row, &a) in meat.iter().zip(left) {
                for (&value, &b) in row.iter().zip(right) {
                    *entry += a * value * b;
                }
            }
        }
    }
    covariance
}
