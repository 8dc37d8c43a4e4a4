//! Normal equations of a small linear least-squares problem, by Cholesky factors.

use crate::scalar::SolverReal;

/// Sums of a least-squares problem with `N` columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal<R, const N: usize> {
    /// Lower triangle of XᵀX.
    gram: [[R; N]; N],
    /// Xᵀy.
    rhs: [R; N],
    /// Rows added.
    rows: usize,
}

/// Cholesky factor of XᵀX.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factor<R, const N: usize> {
    lower: [[R; N]; N],
}

/// A pivot below this share of its diagonal, in roundings: the column is a combination of the others to the arithmetic's
/// precision.
const PIVOT: f64 = 450.0;

// The loops run over two or three arrays by the same constant bound N, which iterators would hide.
#[allow(clippy::needless_range_loop)]
impl<R: SolverReal, const N: usize> Normal<R, N> {
    pub(super) const EMPTY: Self = Self { gram: [[R::ZERO; N]; N], rhs: [R::ZERO; N], rows: 0 };

    #[inline]
    pub(super) fn add(&mut self, row: &[R; N], y: R) {
        for i in 0..N {
            for j in 0..=i {
                self.gram[i][j] += row[i] * row[j];
            }
            self.rhs[i] += row[i] * y;
        }
        self.rows += 1;
    }

    /// None if the columns are linearly dependent.
    pub(super) fn factor(&self) -> Option<Factor<R, N>> {
        if self.rows < N {
            return None;
        }
        let mut lower = [[R::ZERO; N]; N];
        for i in 0..N {
            for j in 0..=i {
                let mut sum = self.gram[i][j];
                for k in 0..j {
                    sum -= lower[i][k] * lower[j][k];
                }
                if i == j {
                    // Written so that NaN is refused too.
                    if sum > self.gram[i][i] * R::EPSILON.scale(PIVOT) {
                        lower[i][i] = sum.sqrt();
                    } else {
                        return None;
                    }
                } else {
                    lower[i][j] = sum / lower[j][j];
                }
            }
        }
        Some(Factor { lower })
    }

    /// The solution, its factor, and the part gᵀG⁻¹g of Σy² that it explains.
    pub(super) fn solve(&self) -> Option<([R; N], Factor<R, N>, R)> {
        let factor = self.factor()?;
        let theta = factor.solve(&self.rhs);
        let explained = dot(&theta, &self.rhs);
        Some((theta, factor, explained))
    }
}

#[allow(clippy::needless_range_loop)]
impl<R: SolverReal, const N: usize> Factor<R, N> {
    /// G⁻¹·v.
    pub(super) fn solve(&self, v: &[R; N]) -> [R; N] {
        let mut x = *v;
        for i in 0..N {
            for k in 0..i {
                x[i] -= self.lower[i][k] * x[k];
            }
            x[i] = x[i] / self.lower[i][i];
        }
        for i in (0..N).rev() {
            for k in i + 1..N {
                x[i] -= self.lower[k][i] * x[k];
            }
            x[i] = x[i] / self.lower[i][i];
        }
        x
    }

    /// Column `j` of G⁻¹.
    pub(super) fn inverse_column(&self, j: usize) -> [R; N] {
        let mut unit = [R::ZERO; N];
        if let Some(entry) = unit.get_mut(j) {
            *entry = R::ONE;
        }
        self.solve(&unit)
    }
}

pub(super) fn dot<R: SolverReal, const N: usize>(a: &[R; N], b: &[R; N]) -> R {
    let mut sum = R::ZERO;
    for (&x, &y) in a.iter().zip(b) {
        sum += x * y;
    }
    sum
}
