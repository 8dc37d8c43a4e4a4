//! Cross-validated weighted least squares over the windows.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};

use super::weak_form::WeakForm;

/// Share of the largest diagonal element that is added to the normal matrix. Two columns that say the same then share
/// their amplitude.
const RIDGE: f64 = 1e-9;

/// A linear model of one side: what is explained, and by what.
#[derive(Clone, Debug)]
pub struct Design<'a> {
    /// The explained quantity in every window.
    pub target: &'a [f64],
    /// Columns.
    pub columns: Vec<Cow<'a, [f64]>>,
}

/// A design's fit.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Coefficients from all rows.
    pub coefficients: Vec<f64>,
    /// Standard errors, from the scatter over blocks.
    pub standard_errors: Vec<f64>,
    /// Held-out residual of every row, unweighted: the row's own fold is left out of the coefficients.
    pub residual: Vec<f64>,
}

impl Design<'_> {
    /// Fits it with `weights` on the residuals. `None` where there are too few rows or blocks, where a column is zero
    /// or of other windows, or where no finite solution exists.
    pub fn fit(&self, form: &WeakForm<'_>, weights: &[f64], folds: usize) -> Option<Fit> {
        let columns: Vec<&[f64]> = self.columns.iter().map(|column| &**column).collect();
        let (n, p) = (self.target.len(), columns.len());
        let folds = folds.min(form.blocks);
        // A column of other windows cannot be used in these.
        let foreign = columns.iter().any(|column| column.len() != n);
        if foreign || n < 4 * p + 8 || folds < 2 {
            return None;
        }
        let scale: Vec<f64> = columns.iter().map(|c| rms(c)).collect();
        if scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
            return None;
        }
        let mut grams = vec![DMatrix::<f64>::zeros(p + 1, p + 1); folds];
        let mut z = vec![0.0; p + 1];
        for (i, row) in form.rows.iter().enumerate() {
            for ((z, column), scale) in z.iter_mut().zip(&columns).zip(&scale) {
                *z = weights[i] * column[i] / scale;
            }
            z[p] = weights[i] * self.target[i];
            let gram = &mut grams[row.block % folds];
            for a in 0..=p {
                for b in a..=p {
                    gram[(b, a)] += z[a] * z[b];
                }
            }
        }
        let all = grams.iter().fold(DMatrix::zeros(p + 1, p + 1), |sum, gram| sum + gram);
        let (coefficients, inverse) = solve(&all, p)?;
        let of_folds: Vec<DVector<f64>> =
            grams.iter().map(|gram| Some(solve(&(&all - gram), p)?.0)).collect::<Option<_>>()?;
        let predicted = |coefficients: &DVector<f64>, i: usize| -> f64 {
            coefficients.iter().zip(&columns).zip(&scale).map(|((c, column), s)| c * column[i] / s).sum()
        };
        let residual: Vec<f64> = form
            .rows
            .iter()
            .enumerate()
            .map(|(i, row)| self.target[i] - predicted(&of_folds[row.block % folds], i))
            .collect();
        if residual.iter().any(|r| !r.is_finite()) {
            return None;
        }
        // Rows of one block are not independent, so that the scores are summed over blocks.
        let mut scores = DMatrix::<f64>::zeros(form.blocks, p);
        for (i, row) in form.rows.iter().enumerate() {
            let own = weights[i] * weights[i] * (self.target[i] - predicted(&coefficients, i));
            for (j, (column, s)) in columns.iter().zip(&scale).enumerate() {
                scores[(row.block, j)] += own * column[i] / s;
            }
        }
        let covariance = &inverse * scores.tr_mul(&scores) * &inverse;
        Some(Fit {
            standard_errors: (0..p).map(|j| covariance[(j, j)].max(0.0).sqrt() / scale[j]).collect(),
            coefficients: coefficients.iter().zip(&scale).map(|(c, s)| c / s).collect(),
            residual,
        })
    }
}

/// Coefficients and inverse normal matrix of the first `p` columns of a lower Gram matrix whose last row is the target's.
fn solve(gram: &DMatrix<f64>, p: usize) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let mut normal = DMatrix::from_fn(p, p, |i, j| if i >= j { gram[(i, j)] } else { gram[(j, i)] });
    let largest = (0..p).map(|i| normal[(i, i)]).fold(0.0, f64::max);
    for i in 0..p {
        normal[(i, i)] += RIDGE * largest;
    }
    let inverse = normal.cholesky()?.inverse();
    let right = DVector::from_fn(p, |i, _| gram[(p, i)]);
    Some((&inverse * right, inverse))
}

/// Root mean square; 0 of nothing.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
