//! Refine: the refinements of a law's form, whole waves in a turn, and thresholds and levels that gradients do not
//! find.

use breakaway_core::plant::effect::{Role, Search};

use super::compare::NAMING;
use super::descend::{FINAL_ITERATIONS, LAST_ITERATIONS, converged};
use crate::discover::data::Data;
use crate::discover::decide::paired;
use crate::discover::model::Model;
use crate::fit::{Fit, Free, Problem};

/// Least gain of a refinement, nats, beside the price of its parameters.
const WORTH: f64 = 10.0;
/// Ratios of a coordinate search over the thresholds of an effect.
const COARSE: [f64; 2] = [1.4, 1.12];
/// The same for an effect whose threshold is its only parameter. At rest the threshold decides at which sample the body
/// starts, so that it is sought to .5 %.
const FINE: [f64; 5] = [1.5, 1.15, 1.05, 1.015, 1.005];
/// The same for a level at rest. A fit stops a percent or two before its narrow minimum.
const LEVEL: [f64; 3] = [1.05, 1.02, 1.007];
/// Most steps in one direction.
const STEPS: usize = 4;
/// Iterations of each step.
const STEP_ITERATIONS: usize = 2;
/// Gain that is worth the next step, nats.
const WORTH_A_STEP: f64 = 0.5;

/// The fit with its last effect refined. The fit of a `contender` is iterated to its end first, and its thresholds are
/// sought.
pub(super) fn refined(data: &Data, fit: Fit, contender: bool, rotary: bool) -> Fit {
    let problem = data.problem();
    let last = fit.candidate.effects.len() - 1;
    let fit = with_form(&problem, if contender { converged(data, &fit) } else { fit }, last);
    let fit = if rotary { in_whole_waves(data, fit, last) } else { fit };
    // A threshold that was not found leaves its effect far behind. Without a memory the search for it is cheap.
    let kind = fit.candidate.effects[last].kind;
    if kind.threshold() && (contender || !kind.remembers()) { along_thresholds(&problem, fit, last) } else { fit }
}

/// The refinements of the form of effect `j`: a second harmonic, or an exponent. They do not change its name. They are
/// kept only where they pay for their parameters.
fn with_form(problem: &Problem<'_>, best: Fit, j: usize) -> Fit {
    let effect = best.candidate.effects[j];
    let parameters = effect.kind.definition().parameters;
    let model = Model::of(&best);
    let refinements: Vec<usize> = (0..parameters.len()).filter(|i| parameters[*i].default.is_some()).collect();
    let Some(&first) = refinements.first() else { return best };
    let price = WORTH + NAMING.price * refinements.len() as f64;
    let phases: &[f64] = if refinements.len() > 1 { &[0.0, 2.0, -2.0] } else { &[0.0] };
    phases
        .iter()
        .filter_map(|phase| {
            let mut model = model.clone();
            let p = &mut model.effects[j].p;
            // An amplitude starts at a tenth of the first, an exponent at half its usual value.
            p[first] = if p[first] == 0.0 { 0.1 * p[0] } else { 0.5 * p[first] };
            if let Some(second) = refinements.get(1) {
                p[*second] = *phase;
            }
            for i in &refinements {
                model.refine(j, *i);
            }
            model.fit(problem, Some(&best.initial), FINAL_ITERATIONS).ok()
        })
        .filter(|fit| fit.cost < best.cost - price)
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .unwrap_or(best)
}

/// A ripple along the angle of a shaft gets a whole number of waves in a turn, where that does as well.
fn in_whole_waves(data: &Data, fit: Fit, j: usize) -> Fit {
    let Some(model) = Model::of(&fit).in_whole_waves(j) else { return fit };
    match model.fit(&data.problem(), Some(&fit.initial), LAST_ITERATIONS) {
        Ok(whole) if paired(&whole.mse, &fit.mse, &fit.samples, data.floor()).lambda < NAMING.price => whole,
        _ => fit,
    }
}

/// Coordinate search over the parameters of effect `j` that are on a grid. The rest is refitted.
fn along_thresholds(problem: &Problem<'_>, best: Fit, j: usize) -> Fit {
    let own = best.free.iter().filter(|free| matches!(free, Free::Effect(k, _) if *k == j)).count();
    let ratios: &[f64] = if own == 1 { &FINE } else { &COARSE };
    let parameters = best.candidate.effects[j].kind.definition().parameters.iter();
    let on_a_grid = parameters.enumerate().filter(|(_, p)| matches!(p.search, Search::Grid(..)) && p.default.is_none());
    let best = along(problem, best, j, &on_a_grid.map(|(i, _)| i).collect::<Vec<_>>(), ratios);
    Model::of(&best).fit(problem, Some(&best.initial), 5).unwrap_or(best)
}

/// The fit with the levels of its last effect sought; `None` where that is no better.
pub(super) fn along_levels(data: &Data, fit: &Fit) -> Option<Fit> {
    let j = fit.candidate.effects.len().checked_sub(1)?;
    let parameters = fit.candidate.effects[j].kind.definition().parameters.iter();
    let levels = parameters.enumerate().filter(|(_, p)| p.role == Role::Level && p.search == Search::Amplitude);
    let best = along(&data.problem(), fit.clone(), j, &levels.map(|(i, _)| i).collect::<Vec<_>>(), &LEVEL);
    (best.cost < fit.cost).then_some(best)
}

/// Coordinate search over the parameters `indices` of effect `j`. A parameter moves up and down by each ratio, as long
/// as the fit improves.
fn along(problem: &Problem<'_>, mut best: Fit, j: usize, indices: &[usize], ratios: &[f64]) -> Fit {
    let parameters = best.candidate.effects[j].kind.definition().parameters;
    for &ratio in ratios {
        for &i in indices {
            for factor in [ratio, 1.0 / ratio] {
                for _ in 0..STEPS {
                    let mut model = Model::of(&best);
                    let value = &mut model.effects[j].p[i];
                    *value = (*value * factor).clamp(parameters[i].min, parameters[i].max);
                    model.hold(j, i);
                    match model.fit(problem, Some(&best.initial), STEP_ITERATIONS) {
                        Ok(fit) if fit.cost < best.cost - WORTH_A_STEP => best = Fit { free: best.free.clone(), ..fit },
                        _ => break,
                    }
                }
            }
        }
    }
    best
}
