//! Minimisation of the separable cost within a bracket, shared by the batch and the streaming fit.

use super::normal::{Factor, Normal, dot};

/// The linear solution at one frequency and what the frequency's own column adds to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point<const N: usize> {
    /// Linear parameters (p, q, ...).
    pub theta: [f64; N],
    /// Cholesky factor of the normal matrix of the linear columns.
    pub factor: Factor<N>,
    /// G⁻¹·Xᵀx_ω: the part of the frequency's column inside the span of the others.
    pub shadow: [f64; N],
    /// Squared length of the frequency's column outside that span: the information on ω.
    pub information: f64,
    /// Σ r·x_ω = −½·dJ/dω.
    pub descent: f64,
    /// Σ r².
    pub rss: f64,
}

/// Second pass at one frequency: residuals and the frequency's column.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border<const N: usize> {
    theta: [f64; N],
    factor: Factor<N>,
    cross: [f64; N],
    square: f64,
    descent: f64,
    rss: f64,
}

impl<const N: usize> Border<N> {
    /// None if the columns are linearly dependent.
    pub(super) fn new(normal: &Normal<N>) -> Option<Self> {
        let (theta, factor, _) = normal.solve()?;
        Some(Self { theta, factor, cross: [0.0; N], square: 0.0, descent: 0.0, rss: 0.0 })
    }
    pub(super) fn theta(&self) -> &[f64; N] {
        &self.theta
    }
    /// One row: its columns, d(row·theta)/dω, and the measured value.
    #[inline]
    pub(super) fn add(&mut self, row: &[f64; N], slope: f64, y: f64) {
        let residual = y - dot(row, &self.theta);
        for (sum, x) in self.cross.iter_mut().zip(row) {
            *sum += x * slope;
        }
        self.square += slope * slope;
        self.descent += residual * slope;
        self.rss += residual * residual;
    }
    pub(super) fn point(&self) -> Point<N> {
        let shadow = self.factor.solve(&self.cross);
        Point {
            theta: self.theta,
            factor: self.factor,
            shadow,
            information: self.square - dot(&shadow, &self.cross),
            descent: self.descent,
            rss: self.rss,
        }
    }
}

/// Iterations at most; a bisection step halves the bracket, so 60 exhaust an f64.
const ITERATIONS: usize = 60;

/// Finds the zero of dJ/dω in `low..high` from `start`: Gauss-Newton steps of the projected problem, replaced by
/// bisection where they leave the bracket. Stops at the precision of f64, or of 1e-5 standard errors.
///
/// None if the columns become dependent, or if the cost falls all the way to an end of the bracket (no minimum inside).
pub(super) fn refine<const N: usize>(
    mut low: f64,
    mut high: f64,
    start: f64,
    degrees_of_freedom: f64,
    mut evaluate: impl FnMut(f64) -> Option<Point<N>>,
) -> Option<(f64, Point<N>)> {
    let mut omega = start;
    for _ in 0..ITERATIONS {
        let point = evaluate(omega)?;
        let information = point.information;
        if information.is_nan() || information <= 0.0 {
            return None;
        }
        let step = point.descent / information;
        let noise = libm::sqrt(point.rss / (degrees_of_freedom * information));
        if step.abs() <= (4.0 * f64::EPSILON * omega).max(1e-5 * noise) {
            return Some((omega, point));
        }
        if step > 0.0 {
            low = omega;
        } else {
            high = omega;
        }
        let newton = omega + step;
        omega = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if high - low <= 8.0 * f64::EPSILON * omega {
            // The sign changed inside, or the bracket closed on one of its ends.
            let point = evaluate(omega)?;
            let small = (point.descent / point.information).abs() <= 1e-9 * omega;
            return small.then_some((omega, point));
        }
    }
    None
}
