//! Fits carried to their end.

use breakaway_core::plant::Effect;

use crate::discover::data::Data;
use crate::discover::model::Model;
use crate::fit::{Candidate, Fit, FitError, Problem, Start, median};

/// Floor of the base model's fit, as a multiple of the mean square that it leaves.
const BASE_FLOOR: f64 = 10.0;
/// Mean square of the median segment over the noise's from which a named effect is fitted like that.
const MISSES_MUCH: f64 = 4.0;
/// Iterations over all segments, and of a fit that is to converge.
pub(super) const FINAL_ITERATIONS: usize = 12;
pub(super) const LAST_ITERATIONS: usize = 20;
/// Iterations with all sub-steps after those with half of them.
const FINE_ITERATIONS: usize = 3;
/// Restarts of a fit that is to converge, at the most, and the gain in nats that is worth another.
const RESTARTS: usize = 2;
const WORTH_A_RESTART: f64 = 20.0;
/// The same as a share of what the fit leaves above the noise: an effect that is missing takes that, not another restart.
const OF_WHAT_IS_LEFT: f64 = 0.01;

/// Whether the effects take many sub-steps of a sample: most of the way is gone with half of them.
pub(super) fn is_slow(effects: &[Effect<f64>]) -> bool {
    effects.iter().any(|effect| effect.kind.bristles() || effect.kind.sub_steps() > 1)
}

/// From the fit over a part of the segments to all of them.
pub(super) fn over_all(data: &Data, start: &Fit) -> Result<Fit, String> {
    let problem = data.problem();
    let model = Model::of(start);
    let slow = is_slow(&model.effects);
    let first = Problem { coarse: slow, ..problem };
    let mut fits = vec![model.fit(&first, None, FINAL_ITERATIONS)];
    // Where the part was all of them, as it is of short ones, its starts are worth as much as the smoothed motion.
    if start.initial.len() == data.fit.len() {
        fits.push(model.fit(&first, Some(&start.initial), FINAL_ITERATIONS));
    }
    let cost = |fit: &Result<Fit, FitError>| fit.as_ref().map_or(f64::INFINITY, |fit| fit.cost);
    let best = fits.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let fit = best.unwrap_or(Err(FitError::NoSegment));
    let fit = match fit {
        Ok(fit) if slow => Model::of(&fit).fit(&problem, Some(&fit.initial), FINE_ITERATIONS),
        other => other,
    };
    fit.map_err(|error| error.to_string())
}

/// Fits a model that may miss much: the floor is far above the mean square that it leaves, which makes it a plain least-squares
/// fit to all segments alike, and not to those (of one direction, of one speed) that it can be made to follow.
///
/// # Errors
/// [`FitError`] of the fit.
pub(in crate::discover) fn fit_softly(data: &Data, start: &Candidate, iterations: usize) -> Result<Fit, FitError> {
    let model = Model::new(start);
    let fit = model.fit(&data.problem(), None, iterations)?;
    levelled(data, &model, &fit, iterations, None)
}

/// A fit as the base model's is made, where it leaves far more than the noise too.
pub(in crate::discover) fn settled(data: &Data, fit: Fit) -> Fit {
    if median(fit.mse.clone()) < MISSES_MUCH * data.sigma * data.sigma {
        return fit;
    }
    levelled(data, &Model::of(&fit), &fit, LAST_ITERATIONS, Some(&fit.initial)).unwrap_or(fit)
}

fn levelled(
    data: &Data,
    model: &Model,
    fit: &Fit,
    iterations: usize,
    initial: Option<&[Start]>,
) -> Result<Fit, FitError> {
    let softened = data.softened(BASE_FLOOR * fit.mse.iter().sum::<f64>() / fit.mse.len() as f64);
    model.fit(&softened.problem(), initial, iterations)
}

/// Nats by which a fit stays above the noise's own.
fn above_the_noise(data: &Data, fit: &Fit) -> f64 {
    let noise = vec![data.sigma * data.sigma; fit.mse.len()];
    let problem = data.problem();
    problem.cost_of(&fit.mse) - problem.cost_of(&noise)
}

/// Iterated to the end, from its own starts and from the smoothed motion, again while that gains: what is left afterwards is
/// the model's, and a further effect is not named for finishing the fit.
pub(super) fn converged(data: &Data, fit: &Fit) -> Fit {
    let problem = data.problem();
    let mut best = fit.clone();
    if best.converged {
        return best;
    }
    for _ in 0..RESTARTS {
        let model = Model::of(&best);
        let again = [Some(best.initial.as_slice()), None]
            .into_iter()
            .filter_map(|initial| model.fit(&problem, initial, LAST_ITERATIONS).ok())
            .min_by(|a, b| a.cost.total_cmp(&b.cost));
        let Some(again) = again else { break };
        let gain = best.cost - again.cost;
        if gain > 0.0 {
            best = again;
        }
        if gain < WORTH_A_RESTART.max(OF_WHAT_IS_LEFT * above_the_noise(data, &best)) {
            break;
        }
    }
    best
}
