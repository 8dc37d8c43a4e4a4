//! A rational function of s, fitted to a frequency response.
//!
//! N(s)/D(s), both of degree n, by the iteration of Sanathanan and Koerner (1963). The linear problem A·D = N is weighted by
//! the last D. So its residual becomes that of A − N/D.

use nalgebra::{Complex, DMatrix, DVector};

/// Most iterations. Where they go on to improve, what is left is small against the errors.
const ITERATIONS: usize = 20;
/// Change of the misfit at which the iteration has ended, as a share.
const SETTLED: f64 = 1e-6;

/// A value of the response, to fit to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Datum {
    /// Angular frequency, rad/s.
    pub(super) omega_rad_s: f64,
    /// The value.
    pub(super) value: Complex<f64>,
    /// Its standard error.
    pub(super) se: f64,
    /// Its weight beside the error: 1 counts wholly.
    pub(super) weight: f64,
}

/// A fitted function.
#[derive(Clone, Debug)]
pub(super) struct Rational {
    /// Mean square of the residual over its standard error.
    pub(super) misfit: f64,
    /// Coefficients of D by power, without the highest, which is 1; of s over `scale`.
    denominator: Vec<f64>,
    numerator: Vec<f64>,
    scale_rad_s: f64,
}

/// Fits a function of `degree`; `None` where the values do not determine it.
pub(super) fn fit(values: &[Datum], degree: usize) -> Option<Rational> {
    let unknowns = 2 * degree + 1;
    let (first, last) = (values.first()?, values.last()?);
    if 2 * values.len() <= unknowns {
        return None;
    }
    // Near 1 in the middle of the band, so that powers are of like size.
    let scale_rad_s = (first.omega_rad_s * last.omega_rad_s).sqrt();
    let weights: f64 = values.iter().map(|value| value.weight).sum();
    let powers: Vec<Vec<Complex<f64>>> = values
        .iter()
        .map(|value| {
            let s = Complex::new(0.0, value.omega_rad_s / scale_rad_s);
            (0..=degree).map(|power| s.powu(power as u32)).collect()
        })
        .collect();
    let of = |coefficients: &[f64], powers: &[Complex<f64>]| -> Complex<f64> {
        coefficients.iter().zip(powers).map(|(coefficient, power)| *power * *coefficient).sum()
    };
    let mut before: Vec<Complex<f64>> = vec![Complex::new(1.0, 0.0); values.len()];
    let mut best: Option<Rational> = None;
    for _ in 0..ITERATIONS {
        let mut matrix = DMatrix::zeros(2 * values.len(), unknowns);
        let mut right = DVector::zeros(2 * values.len());
        for (row, (value, powers)) in values.iter().zip(&powers).enumerate() {
            let weight = value.weight.sqrt() / (value.se * before[row].norm().max(1e-9));
            let mut set = |column: usize, entry: Complex<f64>| {
                matrix[(2 * row, column)] = entry.re * weight;
                matrix[(2 * row + 1, column)] = entry.im * weight;
            };
            for (column, power) in powers.iter().enumerate() {
                if column < degree {
                    set(column, value.value * power);
                }
                set(degree + column, -power);
            }
            let given = -value.value * powers[degree] * weight;
            right[2 * row] = given.re;
            right[2 * row + 1] = given.im;
        }
        let solution = least_squares(matrix, &right)?;
        let (denominator, numerator) = solution.split_at(degree);
        let mut misfit = 0.0;
        for (row, (value, powers)) in values.iter().zip(&powers).enumerate() {
            before[row] = of(denominator, powers) + powers[degree];
            misfit += value.weight * ((value.value - of(numerator, powers) / before[row]).norm() / value.se).powi(2);
        }
        // Of real and imaginary part, less what the unknowns take.
        misfit *= 1.0 / (2.0 * weights) / (1.0 - unknowns as f64 / (2 * values.len()) as f64);
        if !misfit.is_finite() {
            return best;
        }
        let last = best.as_ref().map_or(f64::INFINITY, |best| best.misfit);
        if misfit < last {
            let (denominator, numerator) = (denominator.to_vec(), numerator.to_vec());
            best = Some(Rational { misfit, denominator, numerator, scale_rad_s });
        }
        if (last - misfit).abs() <= SETTLED * misfit {
            break;
        }
    }
    best
}

/// By QR of columns of equal size.
fn least_squares(mut matrix: DMatrix<f64>, right: &DVector<f64>) -> Option<Vec<f64>> {
    let sizes: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
    if sizes.iter().any(|size| !(size.is_finite() && *size > 0.0)) {
        return None;
    }
    for (mut column, size) in matrix.column_iter_mut().zip(&sizes) {
        column /= *size;
    }
    let qr = matrix.qr();
    let solution = qr.r().solve_upper_triangular(&(qr.q().transpose() * right))?;
    Some(solution.iter().zip(&sizes).map(|(value, size)| value / size).collect())
}

impl Rational {
    /// The poles, rad/s, those with a positive imaginary part.
    pub(super) fn poles(&self) -> Vec<Complex<f64>> {
        let mut all = self.denominator.clone();
        all.push(1.0);
        roots(&all, self.scale_rad_s)
    }

    /// The zeros, likewise.
    pub(super) fn zeros(&self) -> Vec<Complex<f64>> {
        roots(&self.numerator, self.scale_rad_s)
    }
}

/// Roots with a positive imaginary part of a polynomial by power: eigenvalues of its companion matrix.
fn roots(coefficients: &[f64], scale: f64) -> Vec<Complex<f64>> {
    let largest = coefficients.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let degree = coefficients.iter().rposition(|value| value.abs() > 1e-12 * largest).unwrap_or(0);
    if degree < 2 {
        return Vec::new();
    }
    let companion = DMatrix::from_fn(degree, degree, |row, column| match (row, column) {
        (row, column) if column + 1 == degree => -coefficients[row] / coefficients[degree],
        (row, column) if row == column + 1 => 1.0,
        _ => 0.0,
    });
    companion.complex_eigenvalues().iter().filter(|root| root.im > 0.0).map(|root| root * scale).collect()
}
