//! Fits carried to their end.

use breakaway_core::plant::Effect;

use crate::discover::data::Data;
use crate::discover::model::Model;
use crate::fit::{Candidate, Fit, FitError, Problem, Start, median};

/// Floor of the base model's fit, as a multiple of the mean square that it leaves.
const BASE_FLOOR: f64 = 10.0;
/// Mean square of the median segment, over the noise's, from which a named effect is fitted with the base model's
/// floor.
const MISSES_MUCH: f64 = 4.0;
/// Iterations of a fit to all segments.
pub(super) const FINAL_ITERATIONS: usize = 12;
/// Iterations of a fit that is to converge.
pub(super) const LAST_ITERATIONS: usize = 20;
/// Iterations with all sub-steps, after those with half of them.
const FINE_ITERATIONS: usize = 3;
/// Most restarts of a fit that is to converge.
const RESTARTS: usize = 2;
/// Gain that is worth another restart, nats.
const WORTH_A_RESTART: f64 = 20.0;
/// The same as a share of what the fit leaves above the noise. A missing effect takes that; another restart does not.
const OF_WHAT_IS_LEFT: f64 = 0.01;

/// Whether the effects take many sub-steps of a sample, as stiff bristles do. Half of the sub-steps are then enough for most of a fit.
pub(super) fn is_slow(effects: &[Effect<f64>]) -> bool {
    effects.iter().any(|effect| effect.kind.bristles())
}

/// Fits to all segments what was fitted to a part of them.
pub(super) fn over_all(data: &Data, start: &Fit) -> Result<Fit, String> {
    let problem = data.problem();
    let model = Model::of(start);
    let slow = is_slow(&model.effects);
    let first = Problem { coarse: slow, ..problem };
    let mut fits = vec![model.fit(&first, None, FINAL_ITERATIONS)];
    // With short segments the part is all of them. Its starts are then worth as much as the smoothed motion.
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

/// Fits a model that may miss much. Its floor is far above the mean square that it leaves, so that the fit is plain
/// least squares over all segments. A low floor would favour segments that the model can follow, those of one direction
/// or speed.
///
/// # Errors
/// [`FitError`] of the fit.
pub(in crate::discover) fn fit_softly(data: &Data, start: &Candidate, iterations: usize) -> Result<Fit, FitError> {
    let model = Model::new(start);
    let fit = model.fit(&data.problem(), None, iterations)?;
    levelled(data, &model, &fit, iterations, None)
}

/// A fit with the base model's floor, where the median segment leaves far more than the noise; else the fit as it is.
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

/// Cost of a fit above that of the noise alone, nats.
fn above_the_noise(data: &Data, fit: &Fit) -> f64 {
    let noise = vec![data.sigma * data.sigma; fit.mse.len()];
    let problem = data.problem();
    problem.cost_of(&fit.mse) - problem.cost_of(&noise)
}

/// The fit iterated to its end. It starts from its own starts and from the smoothed motion, again as long as that
/// gains. What is left then belongs to the model, and no effect is named for finishing the fit.
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
