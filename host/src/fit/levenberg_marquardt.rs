//! Levenberg–Marquardt: descent of the cost from a start.

use breakaway_core::plant::Base;

use super::initial_state::Stepped;
use super::settings::{
    DAMPING, DAMPING_BETTER, DAMPING_RANGE, DAMPING_SINGULAR, DAMPING_WORSE, ENOUGH, MOST_FREE, MOST_RATIO, SMALL_GAIN,
};
use super::{Candidate, Fit, FitError, Free, Problem, Start};

/// The candidate after a step of its free parameters. Strictly positive ones change by ratio; none exceeds the largest
/// base.
fn stepped(candidate: &Candidate, free: &[Free], step: &[f64], largest: &Base<f64>) -> Candidate {
    let mut next = candidate.clone();
    for (parameter, delta) in free.iter().zip(step) {
        let value = parameter.get(candidate);
        let new = if parameter.logarithmic(candidate) {
            value * (delta / value).clamp(-MOST_RATIO, MOST_RATIO).exp()
        } else {
            value + delta
        };
        parameter.set(&mut next, new.min(parameter.largest(largest)));
    }
    next
}

impl Problem<'_> {
    /// Descends from a start, at most `iterations` steps.
    pub(super) fn levenberg_marquardt(
        &self,
        start: &Candidate,
        free: &[Free],
        initial: Option<&[Start]>,
        iterations: usize,
    ) -> Result<Fit, FitError> {
        if self.segments.is_empty() {
            return Err(FitError::NoSegment);
        }
        if free.len() > MOST_FREE {
            return Err(FitError::TooMany(free.len()));
        }
        let largest = self.largest_base();
        let mut candidate = start.clone();
        let mut states = initial.map_or_else(|| self.smoothed_initial(&candidate), <[_]>::to_vec);
        let mut normals = self.normals(&candidate, free, &states);
        let mut mse: Vec<f64> = normals.iter().map(|n| n.mse).collect();
        let mut cost = self.cost_of(&mse) + self.memory_cost(&states, &candidate);
        if !cost.is_finite() {
            return Err(FitError::Diverges);
        }
        let first = cost;
        let mut damping = DAMPING;
        let (mut converged, mut small) = (false, false);
        for iteration in 1..=iterations {
            let Some((step, local)) = self.step(&candidate, &normals, &states, free.len(), damping) else {
                damping *= DAMPING_SINGULAR;
                continue;
            };
            let next = stepped(&candidate, free, step.as_slice(), &largest);
            let next_states: Vec<Start> =
                states.iter().zip(&local).map(|(s, d)| std::array::from_fn(|i| s[i] + d[i])).collect();
            let (next_states, next_normals) = {
                // No step follows the last one.
                let stepped = Stepped { old: &states, old_mse: &mse, new: next_states, last: iteration == iterations };
                self.best_initial_states(&next, free, stepped)
            };
            let next_mse: Vec<f64> = next_normals.iter().map(|n| n.mse).collect();
            let next_cost = self.cost_of(&next_mse) + self.memory_cost(&next_states, &next);
            if next_cost < cost {
                let gain = cost - next_cost;
                candidate = next;
                states = next_states;
                normals = next_normals;
                mse = next_mse;
                cost = next_cost;
                damping = (damping * DAMPING_BETTER).max(DAMPING_RANGE[0]);
                if gain < (SMALL_GAIN[0] + SMALL_GAIN[1] * self.segments.len() as f64).max(ENOUGH * (first - cost)) {
                    if small {
                        converged = true;
                        break;
                    }
                    small = true;
                } else {
                    small = false;
                }
            } else {
                damping *= DAMPING_WORSE;
                if damping > DAMPING_RANGE[1] {
                    converged = true;
                    break;
                }
            }
        }
        let samples = normals.iter().map(|n| n.samples).collect();
        Ok(Fit { candidate, free: free.to_vec(), floor: self.floor(), mse, samples, initial: states, cost, converged })
    }
}
