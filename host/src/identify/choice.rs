//! The choice between equation error and output error, by held-out prediction.

use super::equation_error::{WEAK_FORM, from_weak, solve_base};
use super::held_out::{self, Comparison, Fold};
use super::output_error::{FIT_SEGMENT_S, OUTPUT_ERROR, fitted_from, model_of};
use super::weak::Window;
use crate::fit::{Candidate, Problem};

/// Which estimator is reported, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The estimator that is reported.
    pub estimator: &'static str,
    /// Why.
    pub reason: Reason,
}

/// Why an estimator is reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// It predicts held-out blocks better, beyond chance. The comparison is of the other one with it.
    Predicts(Comparison),
    /// Held-out blocks do not tell the two apart; `white` says whether the simulation follows the recording down to its noise,
    /// which decides then. The comparison is of the other one with the one reported.
    Tied {
        /// The comparison.
        comparison: Comparison,
        /// Whether the residual of the simulation is noise.
        white: bool,
    },
    /// The recordings are too short to hold blocks out.
    Short {
        /// Whether the residual of the simulation is noise.
        white: bool,
    },
    /// The other estimator has no answer that is an axis.
    Only,
}

impl Choice {
    /// The comparison that it rests on: of the other estimator with the one reported.
    pub const fn comparison(&self) -> Option<&Comparison> {
        match &self.reason {
            Reason::Predicts(comparison) | Reason::Tied { comparison, .. } => Some(comparison),
            Reason::Short { .. } | Reason::Only => None,
        }
    }
}

/// Both estimators' models, fitted to one fold: weak form first.
pub(super) fn models(problem: &Problem<'_>, fold: &Fold, both: bool) -> Option<[Candidate; 2]> {
    let weak = from_weak(&solve_base(&fold.windows, both).ok()?, both);
    if weak.b.value <= 0.0 {
        return None;
    }
    let fitted = fitted_from(&Problem { segments: &fold.segments, ..*problem }, &weak)?;
    Some([model_of(&weak), fitted.candidate])
}

/// Compares the weak form with output error; `None` where too few blocks can be held out.
pub(super) fn compare(problem: &Problem<'_>, windows: &[Window], both: bool) -> Option<Comparison> {
    let blocks = held_out::blocks(problem.tracks);
    let fold = |i| held_out::fold(problem.tracks, &blocks, windows, FIT_SEGMENT_S, i);
    let models = [models(problem, &fold(0), both)?, models(problem, &fold(1), both)?];
    held_out::compare(problem, &blocks, &models)
}

/// Chooses. Without a difference beyond chance, the simulation is reported if it follows the recording down to its
/// noise, because it is then more precise. Otherwise the weak form is.
pub(super) fn choose(comparison: Option<Comparison>, white: bool) -> Choice {
    let [weak, simulated] = [WEAK_FORM, OUTPUT_ERROR];
    let tied = if white { simulated } else { weak };
    let swapped = |c: Comparison| Comparison { log_ratio: -c.log_ratio, ..c };
    match comparison {
        None => Choice { estimator: tied, reason: Reason::Short { white } },
        Some(c) if c.second_is_better() => Choice { estimator: simulated, reason: Reason::Predicts(c) },
        Some(c) if c.first_is_better() => Choice { estimator: weak, reason: Reason::Predicts(swapped(c)) },
        Some(c) => {
            let comparison = if white { c } else { swapped(c) };
            Choice { estimator: tied, reason: Reason::Tied { comparison, white } }
        }
    }
}
