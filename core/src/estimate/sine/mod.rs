//! Sine fit: `y = A·sin(ωt+θ) + d` by separable least squares (docs/theory.md, section 3).
//!
//! With `p = A cos θ`, `q = A sin θ` the model is linear in (p, q, d) and the cost `J(ω) = Σy² − gᵀG⁻¹g` has to be
//! minimised over ω alone. `fmin` on 0.5..2 times the estimate (the memo's way) is not unimodal (erratum 8). Here a
//! grid no coarser than 1/(4T) hertz finds the cell and a safeguarded Gauss-Newton iteration on dJ/dω refines within
//! it.
//!
//! - [`fit_fixed`], [`fit_free`]: a whole record in memory, any (jittered) clock, harmonics and drift on request.
//! - [`StreamingSine`]: samples as they come, memory for 32 block phasors, for the microcontroller.
//!
//! Both give a [`SineFit`] with standard errors, or a [`SineError`] that says what is wrong with the record.

use crate::says::says;

mod batch;
mod columns;
mod grid;
mod normal;
mod refine;
mod result;
mod sample;
mod solve;
mod streaming;

pub use batch::{FrequencySearch, even, fit_fixed, fit_free};
pub use columns::SineModel;
pub use result::{Harmonic, SineErrors, SineFit, cramer_rao};
pub use sample::Sample;
pub use streaming::{BlockSums, StreamingSine};

/// Fewest cycles for a fit with free frequency: below, the sine, its frequency and the offset are nearly one shape.
/// Against the closed form of [`cramer_rao`], the bound on A (on ω) is up to 1.2 (2.5) times as large at 1 cycle,
/// 1.9 (3.3) at 0.9 and 4.8 (5.4) at 0.75.
pub const MIN_CYCLES_FREE: f64 = 0.75;
/// Fewest cycles for a fit at a known frequency: there the bound on A is up to 2.3 times that of [`cramer_rao`].
pub const MIN_CYCLES_FIXED: f64 = 0.5;

/// Why a record has no sine fit; names the parameter or the property of the record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SineError {
    /// Fewer samples than the fit needs.
    TooFewSamples {
        /// Samples in the record.
        samples: usize,
        /// Samples needed.
        needed: usize,
    },
    /// The record covers too little of a period: [`MIN_CYCLES_FREE`], [`MIN_CYCLES_FIXED`].
    TooFewCycles {
        /// Cycles in the record.
        cycles: f64,
        /// Cycles needed.
        needed: f64,
    },
    /// A time or a value is NaN or infinite, or so large that its sums are.
    NotFinite,
    /// Time does not increase at this sample (counted from 0).
    TimeOrder {
        /// Index of the first sample that is not later than the one before.
        sample: usize,
    },
    /// The sampling period is not finite and positive.
    SamplePeriod,
    /// The (estimated) frequency is not inside (0, limit). The limit is Nyquist, a quarter of the sampling rate for
    /// the streaming fit, or Nyquist over the highest harmonic.
    Frequency {
        /// The lowest frequency that is too high, rad/s.
        limit_rad_s: f64,
    },
    /// The search range is empty or not finite and positive.
    SearchRange,
    /// The best frequency is on the edge of the search range: widen it or correct the estimate.
    SearchEdge {
        /// The edge, rad/s.
        omega_rad_s: f64,
    },
    /// The signal is constant, or nothing in it is at this frequency.
    ZeroSignal,
    /// The columns of the model cannot be told apart on these sampling instants.
    Singular,
    /// The estimate is too far off for the number of blocks (B < 8·M·|ε|): repeat with this frequency.
    Recentre {
        /// The frequency to give to [`StreamingSine::new`], rad/s.
        omega_rad_s: f64,
    },
    /// The streaming fit's blocks hold ten times the power of the sine that they resolve. The signal's frequency is
    /// far from the given one, or its signal-to-noise ratio is below −10 dB.
    OutOfReach,
    /// A count's difference from the first sample, or a block's integer sum, left its range.
    Saturated,
}

says! { SineError:
    Self::TooFewSamples { samples, needed } => "{samples} samples, and the fit needs {needed}; record for longer",
    Self::TooFewCycles { cycles, needed } => "{cycles:.2} cycles, and the fit needs {needed}; record for longer",
    Self::NotFinite => "numbers too large to be summed",
    Self::TimeOrder { sample } => "time does not increase at sample {sample}",
    Self::SamplePeriod => "the sampling period is not positive",
    Self::Frequency { limit_rad_s } => "the frequency must be above 0 and below {limit_rad_s:.4e} rad/s",
    Self::SearchRange => "no frequency to look at: the period does not fit the sampling rate",
    Self::SearchEdge { omega_rad_s } => "the best frequency, {omega_rad_s:.4e} rad/s, is at the edge of the search",
    Self::ZeroSignal => "the signal is constant, there is no sine in it",
    Self::Singular => "the samples cannot tell sine and offset apart; record for longer",
    Self::Recentre { omega_rad_s } => "the given frequency is too far off; repeat with {omega_rad_s:.4e} rad/s",
    Self::OutOfReach => "the frequency of the signal is far from the given one, or the noise is too large",
    Self::Saturated => "the counts left their range",
}
