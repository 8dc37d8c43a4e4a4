//! The result of a sine fit and its standard errors.

use super::normal::{Factor, dot};
use super::refine::Point;
use super::{SineError, SineModel};
use crate::estimate::angle::angle_of;
use crate::scalar::SolverReal;
use core::f64::consts::TAU;

/// A fitted sine `y = A·sin(ω(t − t_ref) + θ) + d`, in f64 or f32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SineFit<R = f64> {
    /// A, in the signal's unit; > 0.
    pub amplitude: R,
    /// ω, rad/s.
    pub omega_rad_s: R,
    /// θ with t_ref at the record's centre (midway between first and last sample), in −π..π. This is the phase that
    /// the data determine best: it does not depend on ω's error.
    pub phase_centre_rad: R,
    /// θ with t_ref at the first sample, in −π..π.
    pub phase_start_rad: R,
    /// d, in the signal's unit (at the centre if there is drift); 0 if the model has no offset.
    pub offset: R,
    /// Slope, in the signal's unit per second, if asked for.
    pub drift_per_s: Option<R>,
    /// Third harmonic, if asked for.
    pub third: Option<Harmonic<R>>,
    /// Fifth harmonic, if asked for.
    pub fifth: Option<Harmonic<R>>,
    /// Residual standard deviation √(RSS/(N − k)), k the number of fitted parameters (memo erratum 6).
    pub rms: R,
    /// Periods in the record, ω·N·Ts/2π.
    pub cycles: R,
    /// Samples used.
    pub samples: usize,
    /// One standard deviation of each parameter.
    pub se: SineErrors<R>,
}

/// A harmonic `A_h·sin(hω(t − t_c) + θ_h)`, t_c the record's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic<R = f64> {
    /// A_h, in the signal's unit.
    pub amplitude: R,
    /// θ_h, in −π..π.
    pub phase_centre_rad: R,
}

/// Standard errors: the Cramér–Rao bound of this record at the estimated noise, σ² = RSS/(N − k).
///
/// It is the full bound: the inverse Fisher information with all columns of the model. For records of many cycles it
/// becomes the closed form of [`cramer_rao`]. At one cycle the offset and ω cost more than the closed form says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SineErrors<R = f64> {
    /// Of the amplitude.
    pub amplitude: R,
    /// Of ω, rad/s; 0 if ω was given.
    pub omega_rad_s: R,
    /// Of the phase at the centre.
    pub phase_centre_rad: R,
    /// Of the phase at the first sample.
    pub phase_start_rad: R,
    /// Of the offset.
    pub offset: R,
}

/// The closed-form Cramér–Rao bound of docs/theory.md, section 3 for many cycles of a sine of `amplitude` in white
/// noise of standard deviation `sigma`. The sine is sampled `samples` times every `sample_period_s` seconds:
/// `var A = 2σ²/N`, `var ω = 24σ²/(A²Ts²N(N²−1))`, `var θ_centre = 2σ²/(A²N)`, `var d = σ²/N`.
pub fn cramer_rao(amplitude: f64, sigma: f64, samples: usize, sample_period_s: f64) -> SineErrors {
    let n = samples as f64;
    let relative = sigma / amplitude;
    let omega = relative / sample_period_s * libm::sqrt(24.0 / (n * (n * n - 1.0)));
    let phase = relative * libm::sqrt(2.0 / n);
    let lever = 0.5 * (n - 1.0) * sample_period_s * omega;
    SineErrors {
        amplitude: sigma * libm::sqrt(2.0 / n),
        omega_rad_s: omega,
        phase_centre_rad: phase,
        phase_start_rad: libm::sqrt(phase * phase + lever * lever),
        offset: sigma / libm::sqrt(n),
    }
}

/// Wraps an angle to −π..π.
pub(super) fn wrap<R: SolverReal>(angle: R) -> R {
    // Not `remainder`, a long division: what rounding leaves here is what it left in the angle.
    angle - R::from_i64(angle.scale(1.0 / TAU).nearest()).scale(TAU)
}

/// What scales the dimensionless solution back to the record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales<R> {
    /// Signal units per dimensionless unit, > 0.
    pub signal: R,
    /// Signal that was subtracted before.
    pub reference: R,
    /// Seconds per dimensionless unit of time, > 0.
    pub time_s: R,
    /// From the first sample to the centre, in dimensionless time.
    pub half: R,
    /// Samples used.
    pub samples: usize,
    /// Whether ω was fitted.
    pub free: bool,
}

impl<R: SolverReal> SineFit<R> {
    /// Scales `point`, found at the dimensionless `omega` (2π/ω in units of time), whose sum of squared residuals is `rss`.
    pub(super) fn assemble<const N: usize>(
        model: SineModel,
        omega: R,
        point: &Point<R, N>,
        rss: R,
        scales: &Scales<R>,
    ) -> Result<Self, SineError> {
        let at = |i: usize| point.theta.get(i).copied().unwrap_or(R::ZERO);
        let size = |i: usize| (at(i) * at(i) + at(i + 1) * at(i + 1)).sqrt();
        let amplitude = size(0);
        if !(at(0).is_finite() && at(1).is_finite()) {
            return Err(SineError::NotFinite);
        }
        // Against unit signal power: what is below is rounding.
        if amplitude < R::EPSILON.scale(45.0) {
            return Err(SineError::ZeroSignal);
        }
        let parameters = N + usize::from(scales.free);
        let count = |n: usize| R::from_i64(n as i64);
        let freedom = count(scales.samples.saturating_sub(parameters).max(1));
        let variance = rss.max(R::ZERO) / freedom;
        let phase_centre = angle_of(at(0), at(1), amplitude);
        let (unit_p, unit_q) = (at(0) / amplitude, at(1) / amplitude);
        let covariance = Covariance {
            factor: &point.factor,
            shadow: &point.shadow,
            omega: if scales.free { R::ONE / point.information } else { R::ZERO },
        };
        let along = covariance.pair(unit_p, unit_q);
        let across = covariance.pair(-unit_q / amplitude, unit_p / amplitude);
        let across_omega = covariance.pair_with_omega(-unit_q / amplitude, unit_p / amplitude);
        let start = across - scales.half.scale(2.0) * across_omega + scales.half * scales.half * covariance.omega;
        let sd = |v: R| (variance * v).max(R::ZERO).sqrt();
        let span = scales.half.scale(2.0) * count(scales.samples) / count(scales.samples.saturating_sub(1).max(1));
        let harmonic = |index: Option<usize>| {
            index.map(|i| Harmonic {
                amplitude: scales.signal * size(i),
                phase_centre_rad: angle_of(at(i), at(i + 1), size(i)),
            })
        };
        let offset = model.offset_index();
        let fit = Self {
            amplitude: scales.signal * amplitude,
            omega_rad_s: omega / scales.time_s,
            phase_centre_rad: phase_centre,
            phase_start_rad: wrap(phase_centre - omega * scales.half),
            offset: offset.map_or(R::ZERO, |i| scales.reference + scales.signal * at(i)),
            drift_per_s: model.drift_index().map(|i| scales.signal * at(i) / scales.time_s),
            third: harmonic(model.third_index()),
            fifth: harmonic(model.fifth_index()),
            rms: scales.signal * variance.sqrt(),
            cycles: (omega * span).scale(1.0 / TAU),
            samples: scales.samples,
            se: SineErrors {
                amplitude: scales.signal * sd(along),
                omega_rad_s: sd(covariance.omega) / scales.time_s,
                phase_centre_rad: sd(across),
                phase_start_rad: sd(start),
                offset: offset.map_or(R::ZERO, |i| scales.signal * sd(covariance.variance(i))),
            },
        };
        let finite = fit.amplitude.is_finite()
            && fit.omega_rad_s.is_finite()
            && fit.offset.is_finite()
            && fit.rms.is_finite()
            && fit.drift_per_s.is_none_or(R::is_finite);
        if finite { Ok(fit) } else { Err(SineError::NotFinite) }
    }
}

/// Inverse of the information matrix bordered by ω, for unit noise: `G⁻¹ + v·vᵀ/s`, `−v/s`, `1/s`,
/// v = G⁻¹Xᵀx_ω the shadow and s the information on ω.
struct Covariance<'a, R, const N: usize> {
    factor: &'a Factor<R, N>,
    shadow: &'a [R; N],
    omega: R,
}

impl<R: SolverReal, const N: usize> Covariance<'_, R, N> {
    fn of(&self, direction: &[R; N]) -> R {
        let shadow = dot(direction, self.shadow);
        dot(direction, &self.factor.solve(direction)) + shadow * shadow * self.omega
    }
    fn direction(p: R, q: R) -> [R; N] {
        let mut out = [R::ZERO; N];
        if let [first, second, ..] = out.as_mut_slice() {
            (*first, *second) = (p, q);
        }
        out
    }
    fn pair(&self, p: R, q: R) -> R {
        self.of(&Self::direction(p, q))
    }
    fn pair_with_omega(&self, p: R, q: R) -> R {
        -dot(&Self::direction(p, q), self.shadow) * self.omega
    }
    fn variance(&self, i: usize) -> R {
        let column = self.factor.inverse_column(i);
        let shadow = self.shadow.get(i).copied().unwrap_or(R::ZERO);
        column.get(i).copied().unwrap_or(R::ZERO) + shadow * shadow * self.omega
    }
}
