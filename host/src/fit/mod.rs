//! Output error by multiple shooting. The plant is simulated over short segments, each from its own initial position
//! and velocity. Base and effect parameters are fitted jointly (docs/theory.md, section 5; docs/discovery.md, section
//! 8). The cost is `Σ_segments n/2·log(σ² + mse)`. Its logarithm bounds the influence of any one segment.
//!
//! 1. `prepare` makes a [`MeasuredMotion`] of a recording (`smoothing`, `noise`); `segments` cuts it.
//! 2. `initial_state` starts every segment from the smoothed motion, `hidden_state` from what effects remember of the motion before.
//! 3. `simulate` simulates one segment; `normal` does it with numbers that carry derivatives (`dual`): its normal equations.
//! 4. `equations` eliminates the initial states by Schur complement and solves for the parameters (`prior`: of second bodies).
//! 5. `levenberg_marquardt` damps the steps until the cost stays (`parameter_bounds`: how far the base can go).
//! 6. `multi_start` starts stuck segments anew, by `grid_search` where a body is within a gap; then step 5 again.
//! 7. `covariance` gives the standard errors. `settings` has every constant.

use std::sync::atomic::AtomicU64;

use rayon::prelude::*;

mod candidate;
mod covariance;
pub mod dual;
mod equations;
mod golden_section;
mod grid_search;
mod hidden_state;
mod initial_state;
mod levenberg_marquardt;
mod multi_start;
mod noise;
mod normal;
mod parameter_bounds;
mod prepare;
mod prior;
mod segments;
mod settings;
mod simulate;
mod smoothing;
mod statistics;

pub use candidate::{Candidate, Free};
pub use covariance::Covariance;
pub use golden_section::golden_section;
pub use prepare::{MeasuredMotion, session};
pub use segments::{Segment, sampled, segments};
pub use settings::SCORE_ITERATIONS;
use settings::{LEAST_TO_SOFTEN, SOFTEN_ABOVE};
pub use statistics::median;

/// Start of a segment: position, velocity, and two numbers of an effect's free memory (a bristle, a second body). These
/// two are its difference from the memory that the motion before the segment leaves.
pub type Start = [f64; 4];

/// Data and noise floor of a fit.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// Prepared recordings.
    pub tracks: &'a [MeasuredMotion],
    /// Segments to fit.
    pub segments: &'a [Segment],
    /// Noise floor, position units.
    pub sigma: f64,
    /// Measured motion before each segment, s, over which the effects' memories are brought up to date.
    pub warm_up_s: f64,
    /// Mean square that stands for σ² in the logarithm where it is larger; 0 for σ² itself.
    pub softening: f64,
    /// Whether only half of the sub-steps are simulated. That is enough to compare starts, not to state parameters.
    pub coarse: bool,
    /// Counter of the simulated numbers.
    pub work: Option<&'a AtomicU64>,
}

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model.
    pub candidate: Candidate,
    /// Its free parameters.
    pub free: Vec<Free>,
    /// Floor of the segments' mean squares in the logarithm, position units squared.
    pub floor: f64,
    /// Mean square error of every segment, position units squared.
    pub mse: Vec<f64>,
    /// Effective samples of every segment. Correlated residuals count for less.
    pub samples: Vec<f64>,
    /// Start of every segment.
    pub initial: Vec<Start>,
    /// The minimised cost.
    pub cost: f64,
    /// Whether the fit ended by itself, before the number of iterations did.
    pub converged: bool,
}

/// Why a candidate has no fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
pub enum FitError {
    /// The simulation from the start exceeds the range of numbers.
    #[error("the simulation diverges with the starting parameters")]
    Diverges,
    /// There is nothing to fit.
    #[error("no segment to fit")]
    NoSegment,
    /// More parameters than the solver carries.
    #[error("too many free parameters ({0})")]
    TooMany(usize),
}

impl Problem<'_> {
    /// Fits the free parameters and every segment's initial state.
    ///
    /// Where all segments are far above the noise, the logarithm has a well for every segment that can be fitted alone.
    /// The first half of the iterations fills the wells up to the median segment.
    ///
    /// # Errors
    /// [`FitError`] if there is nothing to fit, if too many parameters are free, or if the start diverges.
    pub fn fit(
        &self,
        start: &Candidate,
        free: &[Free],
        initial: Option<&[Start]>,
        iterations: usize,
    ) -> Result<Fit, FitError> {
        if iterations < LEAST_TO_SOFTEN {
            return self.levenberg_marquardt(start, free, initial, iterations);
        }
        let mut first = self.levenberg_marquardt(start, free, initial, 1)?;
        self.restart_stuck(&first.candidate, &mut first.initial, &first.mse);
        let softening = median(first.mse.clone());
        let fit = if softening < SOFTEN_ABOVE * self.floor() {
            self.levenberg_marquardt(&first.candidate, free, Some(&first.initial), iterations - 1)?
        } else {
            let soft = Problem { softening, ..*self };
            let filled = soft.levenberg_marquardt(&first.candidate, free, Some(&first.initial), iterations / 2)?;
            self.levenberg_marquardt(&filled.candidate, free, Some(&filled.initial), iterations.div_ceil(2))?
        };
        let mut states = fit.initial.clone();
        if !self.restart_stuck(&fit.candidate, &mut states, &fit.mse) {
            return Ok(fit);
        }
        let again = self.levenberg_marquardt(&fit.candidate, free, Some(&states), iterations.div_ceil(2))?;
        Ok(if again.cost < fit.cost { again } else { fit })
    }

    /// The cost of given mean square errors of the segments.
    pub fn cost_of(&self, mse: &[f64]) -> f64 {
        self.segments.iter().zip(mse).map(|(segment, mse)| 0.5 * segment.len as f64 * (self.floor() + mse).ln()).sum()
    }

    /// Scores a fixed model, of which only the initial states are fitted. Gives the mean square error of every segment,
    /// position units squared; infinite where the simulation diverges.
    pub fn score(&self, candidate: &Candidate) -> Vec<f64> {
        self.segments
            .par_iter()
            .map(|&segment| {
                let problem = Problem { segments: std::slice::from_ref(&segment), ..*self };
                problem.fit(candidate, &[], None, SCORE_ITERATIONS).map_or(f64::INFINITY, |fit| fit.mse[0])
            })
            .collect()
    }

    fn floor(&self) -> f64 {
        (self.sigma * self.sigma).max(self.softening)
    }
}

#[cfg(test)]
mod tests;
