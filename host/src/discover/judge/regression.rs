//! Cross-validated weighted least squares over the windows.

use std::borrow::Cow;
use std::ops::Range;

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
        let blocks = blocks_of(form);
        let acting = Acting::of(&columns, &blocks);
        let scale: Vec<f64> = acting.squares.iter().map(|square| (square / n as f64).sqrt()).collect();
        if scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
            return None;
        }
        let per_scale: Vec<f64> = scale.iter().map(|scale| 1.0 / scale).collect();
        let mut grams = vec![DMatrix::<f64>::zeros(p + 1, p + 1); folds];
        let mut weighted = Weighted::default();
        for ((block, rows), acting) in blocks.iter().zip(&acting.columns) {
            let gram = &mut grams[block % folds];
            // The target is the last column.
            weighted.make(acting, &columns, self.target, (&per_scale, weights), rows);
            let of = |i: &usize| if *i == acting.len() { p } else { acting[*i] };
            for a in 0..=acting.len() {
                for b in a..=acting.len() {
                    gram[(of(&b), of(&a))] += dot(weighted.column(a), weighted.column(b));
                }
            }
        }
        let all = grams.iter().fold(DMatrix::zeros(p + 1, p + 1), |sum, gram| sum + gram);
        let (coefficients, inverse) = solve(&all, p)?;
        let of_folds: Vec<DVector<f64>> =
            grams.iter().map(|gram| Some(solve(&(&all - gram), p)?.0)).collect::<Option<_>>()?;
        let mut residual = self.target.to_vec();
        let mut scores = DMatrix::<f64>::zeros(form.blocks, p);
        let mut own = Vec::new();
        for ((block, rows), acting) in blocks.iter().zip(&acting.columns) {
            let of_fold = &of_folds[block % folds];
            weighted.make(acting, &columns, self.target, (&per_scale, weights), rows);
            own.clear();
            own.extend_from_slice(weighted.column(acting.len()));
            for (i, j) in acting.iter().copied().enumerate() {
                let step = of_fold[j] * per_scale[j];
                for (r, c) in residual[rows.clone()].iter_mut().zip(&columns[j][rows.clone()]) {
                    *r -= step * c;
                }
                for (r, c) in own.iter_mut().zip(weighted.column(i)) {
                    *r -= coefficients[j] * c;
                }
            }
            // Rows of one block are not independent, so that the scores are summed over blocks.
            for (i, j) in acting.iter().copied().enumerate() {
                scores[(*block, j)] += dot(&own, weighted.column(i));
            }
        }
        if residual.iter().any(|r| !r.is_finite()) {
            return None;
        }
        let covariance = &inverse * scores.tr_mul(&scores) * &inverse;
        Some(Fit {
            standard_errors: (0..p).map(|j| covariance[(j, j)].max(0.0).sqrt() / scale[j]).collect(),
            coefficients: coefficients.iter().zip(&scale).map(|(c, s)| c / s).collect(),
            residual,
        })
    }
}

/// Where the columns are not zero. A column of one recording is zero in the blocks of the others.
struct Acting {
    /// Indices of the columns that are not zero in a block, for every block.
    columns: Vec<Vec<usize>>,
    /// Sum of squares of every column.
    squares: Vec<f64>,
}

impl Acting {
    fn of(columns: &[&[f64]], blocks: &[(usize, Range<usize>)]) -> Self {
        let mut squares = vec![0.0; columns.len()];
        let acting = blocks.iter().map(|(_, rows)| {
            let each = columns.iter().zip(&mut squares).enumerate();
            let acts = each.filter_map(|(j, (column, sum))| {
                let own = &column[rows.clone()];
                let square = dot(own, own);
                *sum += square;
                // A square that is no number must be seen.
                (square != 0.0).then_some(j)
            });
            acts.collect()
        });
        Self { columns: acting.collect(), squares }
    }
}

/// The columns of one block, weighted and scaled, one after the other; the target comes last.
#[derive(Default)]
struct Weighted {
    rows: usize,
    values: Vec<f64>,
}

impl Weighted {
    fn make(
        &mut self,
        acting: &[usize],
        columns: &[&[f64]],
        target: &[f64],
        (per_scale, weights): (&[f64], &[f64]),
        rows: &Range<usize>,
    ) {
        self.rows = rows.len();
        self.values.clear();
        let weights = &weights[rows.clone()];
        for j in acting {
            let (own, unit) = (&columns[*j][rows.clone()], per_scale[*j]);
            self.values.extend(own.iter().zip(weights).map(|(c, w)| w * c * unit));
        }
        self.values.extend(target[rows.clone()].iter().zip(weights).map(|(t, w)| w * t));
    }

    fn column(&self, i: usize) -> &[f64] {
        &self.values[i * self.rows..(i + 1) * self.rows]
    }
}

/// Blocks with their rows, which follow each other.
fn blocks_of(form: &WeakForm<'_>) -> Vec<(usize, Range<usize>)> {
    let mut blocks: Vec<(usize, Range<usize>)> = Vec::new();
    for (i, row) in form.rows.iter().enumerate() {
        match blocks.last_mut() {
            Some((block, rows)) if *block == row.block => rows.end = i + 1,
            _ => blocks.push((row.block, i..i + 1)),
        }
    }
    blocks
}

/// Sum of products, see [`dot_from`].
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    dot_from(a, b, 0.0)
}

/// Sum of the products of `a` with what `b` is above a reference, over the shorter of both. Eight sums run side by side,
/// because a processor adds them at once.
#[inline]
pub(super) fn dot_from(a: &[f64], b: &[f64], reference: f64) -> f64 {
    let n = a.len().min(b.len());
    let (a8, b8) = (a[..n].chunks_exact(8), b[..n].chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(x, y)| x * (y - reference)).sum();
    let mut sums = [0.0; 8];
    for (x, y) in a8.zip(b8) {
        for ((sum, x), y) in sums.iter_mut().zip(x).zip(y) {
            *sum += x * (y - reference);
        }
    }
    sums.iter().sum::<f64>() + rest
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
