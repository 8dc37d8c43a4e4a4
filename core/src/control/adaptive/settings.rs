//! What the adaptive law is told: start values, adaptation gains, and why they are refused.

use crate::control::tuning::{Gains, TuningError};
use crate::says::says;
use crate::scalar::Real;

/// What the law adapts, or starts from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimates<R> {
    /// b̂, drive units per (X/s²).
    pub b: R,
    /// ĉ = f̂2 − â, drive units per (X/s).
    pub c: R,
    /// f̂1, drive units.
    pub f1: R,
    /// f̂, bound of what the model misses, drive units.
    pub f: R,
}

/// How fast the law adapts, and within what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptation<F = f64> {
    /// kb, kc, kf1, kf: in the units of the parameter squared over (drive unit·X).
    pub gains: Estimates<F>,
    /// Leak of f̂, in X/s per drive unit; 0 for none.
    pub sigma: F,
    /// δ, X/s; > 0.
    pub delta: F,
    /// Smallest b̂; ≥ 0.
    pub b_min: F,
    /// Kv·s in u_c instead of the paper's Kv·s_Δ, so that the PID of remark 1 goes on within δ (erratum 33). The proof
    /// stays: s·s_Δ ≥ s_Δ², so V̇ ≤ −Kv·b·s_Δ² all the same.
    pub pid_inside: bool,
    /// Largest speed of the reference that is expected, X/s: for the gains' limit only.
    pub speed: F,
    /// Largest acceleration of the reference that is expected, X/s²: for the gains' limit only.
    pub acceleration: F,
}

/// Why an adaptive controller is refused; with the largest gain that would do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AdaptiveError {
    /// Kv, Λ1, Λ2, the filter, the tick, the limit.
    Gains(TuningError),
    /// δ is not finite and positive.
    Delta,
    /// σ is not finite and non-negative.
    Sigma,
    /// `b_min` is not finite and non-negative.
    SmallestB,
    /// A start value is not finite and non-negative.
    Start,
    /// An expected speed or acceleration is not finite and non-negative.
    Motion,
    /// kb is negative, or past |ẍ|·√(kb/b)·Ts = 0.1.
    B {
        /// The largest kb.
        largest: f64,
    },
    /// kc is negative, or past |v|·√(kc/b)·Ts = 0.1.
    C {
        /// The largest kc.
        largest: f64,
    },
    /// kf1 is negative, or past √(kf1/b)·Ts = 0.1.
    F1 {
        /// The largest kf1.
        largest: f64,
    },
    /// kf is negative, or past √(kf/b)·Ts = 0.1.
    F {
        /// The largest kf.
        largest: f64,
    },
}

says! { AdaptiveError:
    Self::Gains(error) => "{error}",
    Self::B { largest } => "adaptation gain b is past what this tick allows; the largest is {largest:.4e}",
    Self::C { largest } => "adaptation gain c is past what this tick allows; the largest is {largest:.4e}",
    Self::F1 { largest } => "adaptation gain f1 is past what this tick allows; the largest is {largest:.4e}",
    Self::F { largest } => "adaptation gain f is past what this tick allows; the largest is {largest:.4e}",
    Self::Delta => "delta must be above 0",
    Self::Sigma => "the adaptive law's sigma must be 0 or more, and sigma times the gain f times the tick at most 1",
    Self::SmallestB => "b_min must be 0 or more",
    Self::Start => "start values must be 0 or more",
    Self::Motion => "speed and acceleration must be 0 or more",
}

/// The least δ behind an encoder, X/s: half of the most that a count of `step` (X) makes of ė, behind observer and filter.
/// Below, the law adapts to the rounding, whose mean drives b̂ up (docs/adaptive.md, what `breakaway tune` chooses).
pub fn least_delta<F: Real>(step: F, gains: &Gains<F>, tick_s: F) -> F {
    step.scale(0.5) * gains.rate_of_step(tick_s)
}

impl<F: Real> Adaptation<F> {
    /// Gains in proportion to the squares of the start values, so that one number sets the speed of all. Along a
    /// reference of at most `speed` and `acceleration`, the forces θ_i·φ_i of the model adapt with up to `rate`
    /// rad/s. With F = b·acceleration + c·speed + f1, `k_i = (b·rate²/F²)·θ_i²`.
    ///
    /// δ is the speed error within which nothing adapts (X/s); a few encoder steps per filter time.
    pub fn normalised(start: &Estimates<F>, rate: F, speed: F, acceleration: F, delta: F) -> Self {
        let largest = start.b * acceleration + start.c * speed + start.f1;
        let scale = if largest > F::ZERO { start.b * rate * rate / (largest * largest) } else { F::ZERO };
        let gain = |value: F| scale * value * value;
        Self {
            gains: Estimates {
                b: gain(start.b),
                c: gain(start.c),
                f1: gain(start.f1),
                // What is missed is taken to be a tenth of the friction.
                f: gain(start.f1.scale(0.1)),
            },
            sigma: if start.f1 > F::ZERO { delta / start.f1 } else { F::ZERO },
            delta,
            b_min: start.b.scale(0.2),
            pid_inside: true,
            speed,
            acceleration,
        }
    }
}
