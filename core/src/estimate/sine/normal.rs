//! Normal equations of a small linear least-squares problem, by Cholesky factors.

/// Sums of a least-squares problem with `N` columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal<const N: usize> {
    /// Lower triangle of XᵀX.
    gram: [[f64; N]; N],
    /// Xᵀy.
    rhs: [f64; N],
    /// Rows added.
    rows: usize,
}

/// Cholesky factor of XᵀX.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factor<const N: usize> {
    lower: [[f64; N]; N],
}

/// A pivot below this share of its diagonal: the column is a combination of the others to the arithmetic's precision.
const PIVOT: f64 = 1e-13;

// The loops run over two or three arrays by the same constant bound N, which iterators would hide.
#[allow(clippy::needless_range_loop)]
impl<const N: usize> Normal<N> {
    pub(super) const EMPTY: Self = Self { gram: [[0.0; N]; N], rhs: [0.0; N], rows: 0 };

    #[inline]
    pub(super) fn add(&mut self, row: &[f64; N], y: f64) {
        for i in 0..N {
            for j in 0..=i {
                self.gram[i][j] += row[i] * row[j];
            }
            self.rhs[i] += row[i] * y;
        }
        self.rows += 1;
    }

    /// vᵀGv = Σ(row·v)².
    pub(super) fn square(&self, v: &[f64; N]) -> f64 {
        let mut sum = 0.0;
        for i in 0..N {
            let mut line = 0.5 * self.gram[i][i] * v[i];
            for j in 0..i {
                line += self.gram[i][j] * v[j];
            }
            sum += 2.0 * v[i] * line;
        }
        sum
    }

    /// None if the columns are linearly dependent.
    pub(super) fn factor(&self) -> Option<Factor<N>> {
        if self.rows < N {
            return None;
        }
        let mut lower = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..=i {
                let mut sum = self.gram[i][j];
                for k in 0..j {
                    sum -= lower[i][k] * lower[j][k];
                }
                if i == j {
                    // Written so that NaN is refused too.
                    if sum > PIVOT * self.gram[i][i] {
                        lower[i][i] = libm::sqrt(sum);
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
    pub(super) fn solve(&self) -> Option<([f64; N], Factor<N>, f64)> {
        let factor = self.factor()?;
        let theta = factor.solve(&self.rhs);
        let explained = dot(&theta, &self.rhs);
        Some((theta, factor, explained))
    }
}

#[allow(clippy::needless_range_loop)]
impl<const N: usize> Factor<N> {
    /// G⁻¹·v.
    pub(super) fn solve(&self, v: &[f64; N]) -> [f64; N] {
        let mut x = *v;
        for i in 0..N {
            for k in 0..i {
                x[i] -= self.lower[i][k] * x[k];
            }
            x[i] /= self.lower[i][i];
        }
        for i in (0..N).rev() {
            for k in i + 1..N {
                x[i] -= self.lower[k][i] * x[k];
            }
            x[i] /= self.lower[i][i];
        }
        x
    }

    /// Column `j` of G⁻¹.
    pub(super) fn inverse_column(&self, j: usize) -> [f64; N] {
        let mut unit = [0.0; N];
        if let Some(entry) = unit.get_mut(j) {
            *entry = 1.0;
        }
        self.solve(&unit)
    }
}

pub(super) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
