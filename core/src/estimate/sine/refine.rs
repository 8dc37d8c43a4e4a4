//! Minimisation of the separable cost within a bracket, shared by the batch and the streaming fit.

use super::normal::{Factor, Normal, dot};
use crate::scalar::SolverReal;

/// The linear solution at one frequency and what the frequency's own column adds to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point<R, const N: usize> {
    /// Linear parameters (p, q, ...).
    pub theta: [R; N],
    /// Cholesky factor of the normal matrix of the linear columns.
    pub factor: Factor<R, N>,
    /// G⁻¹·Xᵀx_ω: the part of the frequency's column inside the span of the others.
    pub shadow: [R; N],
    /// Squared length of the frequency's column outside that span: the information on ω.
    pub information: R,
    /// Σ r·x_ω = −½·dJ/dω.
    pub descent: R,
    /// Σ r².
    pub rss: R,
}

/// Second pass at one frequency: residuals and the frequency's column.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border<R, const N: usize> {
    theta: [R; N],
    factor: Factor<R, N>,
    cross: [R; N],
    square: R,
    descent: R,
    rss: R,
}

impl<R: SolverReal, const N: usize> Border<R, N> {
    /// None if the columns are linearly dependent.
    pub(super) fn new(normal: &Normal<R, N>) -> Option<Self> {
        let (theta, factor, _) = normal.solve()?;
        Some(Self { theta, factor, cross: [R::ZERO; N], square: R::ZERO, descent: R::ZERO, rss: R::ZERO })
    }
    pub(super) fn theta(&self) -> &[R; N] {
        &self.theta
    }
    /// One row: its columns, d(row·theta)/dω, and the measured value.
    #[inline]
    pub(super) fn add(&mut self, row: &[R; N], slope: R, y: R) {
        let residual = y - dot(row, &self.theta);
        for (sum, &x) in self.cross.iter_mut().zip(row) {
            *sum += x * slope;
        }
        self.square += slope * slope;
        self.descent += residual * slope;
        self.rss += residual * residual;
    }
    pub(super) fn point(&self) -> Point<R, N> {
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

/// How finely a frequency is looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resolution<R> {
    /// Steps below this are rounding.
    pub step: R,
    /// A bracket that has closed holds a minimum if the next step stays below this.
    pub end: R,
}

impl<R: SolverReal> Resolution<R> {
    /// That of a frequency of about `omega`.
    pub(super) fn of(omega: R) -> Self {
        let step = omega * R::EPSILON.scale(4.0);
        Self { step, end: omega.scale(1e-9).max(step) }
    }
}

/// Finds the zero of dJ/dω in `low..high` from `start`: Gauss-Newton steps of the projected problem, replaced by
/// bisection where they leave the bracket. Stops at the precision of the type, or of 1e-5 standard errors.
///
/// None if the columns become dependent, or if the cost falls all the way to an end of the bracket (no minimum inside).
pub(super) fn refine<R: SolverReal, const N: usize>(
    mut low: R,
    mut high: R,
    start: R,
    resolution: Resolution<R>,
    degrees_of_freedom: R,
    mut evaluate: impl FnMut(R) -> Option<Point<R, N>>,
) -> Option<(R, Point<R, N>)> {
    let mut omega = start;
    let mut closed = false;
    for _ in 0..ITERATIONS {
        let point = evaluate(omega)?;
        let step = point.descent / point.information;
        // Written so that NaN is refused too.
        if !(point.information > R::ZERO && step.is_finite()) {
            return None;
        }
        if closed {
            // The sign changed inside, or the bracket closed on one of its ends.
            return (step.abs() <= resolution.end).then_some((omega, point));
        }
        let noise = (point.rss / (degrees_of_freedom * point.information)).sqrt();
        if step.abs() <= resolution.step.max(noise.scale(1e-5)) {
            return Some((omega, point));
        }
        if step > R::ZERO {
            low = omega;
        } else {
            high = omega;
        }
        let newton = omega + step;
        omega = if newton > low && newton < high { newton } else { (low + high).scale(0.5) };
        closed = high - low <= resolution.step.scale(2.0);
    }
    None
}

#[cfg(test)]
mod tests;
