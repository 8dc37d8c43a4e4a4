//! The corrected closed form of the relay experiment: describing functions with the ω that the paper drops
//! (docs/theory.md, sections 2 and 4, errata 14, 18 and 21).
//!
//! Harmonic balance at the fundamental `x = a·sin ωt`:
//! real `b·a·ω² = 4h1/π`, imaginary `c·a·ω + 4f1/π = 4h2/π`.
//!
//! Exact for data made by the describing function; on real limit cycles the neglected harmonics cost c and f1 5–20 %.
//! The reported standard errors hold the errors of (a, ω) and, with more than two experiments, the scatter, but not
//! this bias.

use crate::plant::Base;
use crate::says::says;
use crate::scalar::Real;
use core::f64::consts::{FRAC_PI_4, PI};

/// One settled relay experiment, with the standard errors of its fit (0 if unknown).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleFit<R> {
    /// Amplitude of the relay on the error, drive units, > 0.
    pub h1: R,
    /// Amplitude of the relay on the error's integral, drive units, > 0.
    pub h2: R,
    /// Amplitude of the fundamental, position units, > 0.
    pub a: R,
    /// Angular frequency, rad/s, > 0.
    pub omega: R,
    /// Standard error of `a`.
    pub a_error: R,
    /// Standard error of `omega`.
    pub omega_error: R,
}

/// The estimate; units as in [`Base`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DescribingEstimate<R> {
    /// Inertia, damping and Coulomb friction.
    pub parameters: [R; 3],
    /// Covariance of (b, c, f1), propagated from the errors of (a, ω). With more than two experiments the errors are
    /// scaled up where the experiments disagree by more.
    pub covariance: [[R; 3]; 3],
    /// Condition of the scaled normal matrix of (c, f1).
    pub condition: R,
}

/// Why describing functions do not give a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DescribingError {
    /// Fewer than two experiments.
    TooFewExperiments,
    /// An amplitude, a frequency or a relay level is not finite and positive, or an error is negative.
    BadExperiment {
        /// Index of the experiment.
        index: usize,
    },
    /// All experiments use the same h2: c and f1 cannot be separated.
    SameH2,
    /// All experiments have the same speed amplitude a·ω: c and f1 cannot be separated.
    SameSpeed,
}

says! { DescribingError:
    Self::TooFewExperiments => "two experiments are needed",
    Self::BadExperiment { index } => "experiment {index} has an amplitude, a frequency or a level that is not positive, or a negative error",
    Self::SameH2 => "all experiments use the same h2: c and f1 cannot be separated",
    Self::SameSpeed => "all experiments have the same speed: c and f1 cannot be separated",
}

impl DescribingError {
    /// Which experiment would help.
    #[must_use]
    pub const fn advice(self) -> &'static str {
        match self {
            Self::TooFewExperiments => "c and f1 need two experiments with different h2",
            Self::BadExperiment { .. } => "give finite, positive h1, h2, a and ω, from a settled limit cycle",
            Self::SameH2 => {
                "all experiments use the same h2: c and f1 cannot be separated; repeat with a different h2 (h1 alone gives no information)"
            }
            Self::SameSpeed => {
                "all experiments have the same speed amplitude a·ω: c and f1 cannot be separated; repeat with a clearly different h2"
            }
        }
    }
}

/// Solves `b_i = 4h1_i/(π a_i ω_i²)` and `[π a_i ω_i/4, 1]·[c; f1] = h2_i` by least squares over all experiments.
///
/// # Errors
/// [`DescribingError`]; the condition for a solution is a1ω1 ≠ a2ω2 (the paper's is a1 ≠ a2).
pub fn describing_function<R: Real>(experiments: &[CycleFit<R>]) -> Result<DescribingEstimate<R>, DescribingError> {
    check(experiments)?;
    let count = R::from_f64(experiments.len() as f64);
    let mean = |value: fn(&CycleFit<R>) -> R| sum(experiments, value) / count;
    let (b, speed, h2) = (mean(inertia), mean(scaled_speed), mean(|fit| fit.h2));
    let spread = sum(experiments, |fit| square(scaled_speed(fit) - speed));
    let cross = sum(experiments, |fit| (scaled_speed(fit) - speed) * (fit.h2 - h2));
    // Condition of the scaled 2×2 matrix: (1 + ρ)/(1 − ρ) with 1 − ρ² = spread/Σz².
    let power = spread + count * square(speed);
    let rho = (R::ONE - spread / power).sqrt();
    let condition = square(R::ONE + rho) * power / spread;
    if condition.is_finite() && condition < R::from_f64(MAX_CONDITION) {
        let c = cross / spread;
        let line = Line { b, c, speed, h2, spread, count };
        return Ok(DescribingEstimate {
            parameters: [b, c, h2 - c * speed],
            covariance: line.covariance(experiments),
            condition,
        });
    }
    Err(DescribingError::SameSpeed)
}

/// Speeds closer than about 0.2 % cannot be told apart in any record.
const MAX_CONDITION: f64 = 1e6;

fn check<R: Real>(experiments: &[CycleFit<R>]) -> Result<(), DescribingError> {
    if experiments.len() < 2 {
        return Err(DescribingError::TooFewExperiments);
    }
    let positive = |value: R| value.is_finite() && value > R::ZERO;
    for (index, fit) in experiments.iter().enumerate() {
        let errors = [fit.a_error, fit.omega_error];
        let good = [fit.h1, fit.h2, fit.a, fit.omega].into_iter().all(positive)
            && errors.into_iter().all(|error| error.is_finite() && error >= R::ZERO)
            && inertia(fit).is_finite()
            && square(scaled_speed(fit)).is_finite();
        if !good {
            return Err(DescribingError::BadExperiment { index });
        }
    }
    let first = experiments.first().map_or(R::ZERO, |fit| fit.h2);
    let same = |fit: &CycleFit<R>| (fit.h2 - first).abs() <= first * R::from_f64(1e-6);
    if experiments.iter().all(same) {
        return Err(DescribingError::SameH2);
    }
    Ok(())
}

fn sum<R: Real>(experiments: &[CycleFit<R>], value: impl Fn(&CycleFit<R>) -> R) -> R {
    let mut total = R::ZERO;
    for fit in experiments {
        total += value(fit);
    }
    total
}

fn square<R: Real>(value: R) -> R {
    value * value
}

/// 4h1/(π a ω²).
fn inertia<R: Real>(fit: &CycleFit<R>) -> R {
    fit.h1 / (R::from_f64(FRAC_PI_4) * fit.a * square(fit.omega))
}

/// π a ω/4.
fn scaled_speed<R: Real>(fit: &CycleFit<R>) -> R {
    R::from_f64(FRAC_PI_4) * fit.a * fit.omega
}

/// The fitted line h2 = c·z + f1 about its centre.
struct Line<R> {
    b: R,
    c: R,
    speed: R,
    h2: R,
    spread: R,
    count: R,
}

impl<R: Real> Line<R> {
    /// First-order propagation of the errors of (a, ω), plus what the scatter of h2 about the line exceeds them by.
    fn covariance(&self, experiments: &[CycleFit<R>]) -> [[R; 3]; 3] {
        let mut covariance = [[R::ZERO; 3]; 3];
        let (mut scatter, mut expected) = (R::ZERO, R::ZERO);
        for fit in experiments {
            let z = scaled_speed(fit);
            let rest = fit.h2 - self.h2 - self.c * (z - self.speed);
            let c_by_z = (rest - self.c * (z - self.speed)) / self.spread;
            let f1_by_z = -self.c / self.count - self.speed * c_by_z;
            let by_a = z / fit.a;
            let by_omega = z / fit.omega;
            let b_share = inertia(fit) / self.count;
            let toward_a = [-b_share / fit.a, c_by_z * by_a, f1_by_z * by_a];
            let two = R::ONE + R::ONE;
            let toward_omega = [-two * b_share / fit.omega, c_by_z * by_omega, f1_by_z * by_omega];
            outer(&mut covariance, &toward_a, square(fit.a_error));
            outer(&mut covariance, &toward_omega, square(fit.omega_error));
            scatter += square(rest);
            expected += square(self.c * by_a * fit.a_error) + square(self.c * by_omega * fit.omega_error);
        }
        let spare = self.count - R::from_f64(2.0);
        if spare > R::ZERO {
            let excess = (scatter / spare - expected / self.count).max(R::ZERO);
            // Slope and intercept of a line with noise in h2.
            outer(&mut covariance, &[R::ZERO, R::ONE, -self.speed], excess / self.spread);
            outer(&mut covariance, &[R::ZERO, R::ZERO, R::ONE], excess / self.count);
        }
        let inertia_scatter = sum(experiments, |fit| square(inertia(fit) - self.b));
        if self.count > R::ONE {
            let excess = inertia_scatter / ((self.count - R::ONE) * self.count) - covariance[0][0];
            outer(&mut covariance, &[R::ONE, R::ZERO, R::ZERO], excess.max(R::ZERO));
        }
        covariance
    }
}

fn outer<R: Real>(covariance: &mut [[R; 3]; 3], direction: &[R; 3], variance: R) {
    for (line, &left) in covariance.iter_mut().zip(direction) {
        for (entry, &right) in line.iter_mut().zip(direction) {
            *entry += left * right * variance;
        }
    }
}

/// A predicted limit cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction<R> {
    /// Angular frequency, rad/s: h1·c/(b·(h2−f1)).
    pub omega: R,
    /// Amplitude of the fundamental: 4b(h2−f1)²/(π c² h1).
    pub a: R,
    /// Factor by which a deviation shrinks per cycle, about e^(−2(h2−f1)/h1).
    pub contraction: R,
}

/// Why a plant has no limit cycle under a dual relay; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoCycle {
    /// h1 is not finite and positive.
    H1,
    /// h2 ≤ f1: the relay on the integral cannot feed what friction takes.
    H2NotAboveFriction,
    /// h1 + h2 ≤ f1: the axis does not break away.
    BelowBreakaway,
    /// c = 0: nothing limits the amplitude.
    NoDamping,
}

/// Predicts the limit cycle of a plant by describing functions (docs/theory.md, section 2); 1 % off in ω and 2 % in a
/// on the reference plant.
///
/// # Errors
/// [`NoCycle`] says why there is none.
pub fn predict<R: Real>(plant: &Base<R>, h1: R, h2: R) -> Result<Prediction<R>, NoCycle> {
    if !(h1.is_finite() && h1 > R::ZERO) {
        return Err(NoCycle::H1);
    }
    if h1 + h2 <= plant.f1 {
        return Err(NoCycle::BelowBreakaway);
    }
    if !(h2.is_finite() && h2 > plant.f1) {
        return Err(NoCycle::H2NotAboveFriction);
    }
    if plant.c <= R::ZERO {
        return Err(NoCycle::NoDamping);
    }
    let excess = h2 - plant.f1;
    let four_over_pi = R::from_f64(4.0 / PI);
    Ok(Prediction {
        omega: h1 * plant.c / (plant.b * excess),
        a: four_over_pi * plant.b * square(excess / plant.c) / h1,
        contraction: (R::from_f64(-2.0) * excess / h1).exp(),
    })
}

#[cfg(test)]
mod tests;
