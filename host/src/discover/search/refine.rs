//! Refine: refinements of a law's form, whole waves in a turn, and the thresholds and levels that gradients do not find.

use breakaway_core::plant::effect::{Role, Search};

use super::compare::NAMING;
use super::descend::{FINAL_ITERATIONS, LAST_ITERATIONS, converged};
use crate::discover::data::Data;
use crate::discover::decide::paired;
use crate::discover::model::Model;
use crate::fit::{Fit, Free, Problem};

/// Nats that a refinement gains at the least, beside the price of its parameters.
const WORTH: f64 = 10.0;
/// Ratios of a coordinate search. A single threshold, at rest, decides by the sample at which the body starts: to a percent
/// and finer.
const COARSE: [f64; 2] = [1.4, 1.12];
const FINE: [f64; 5] = [1.5, 1.15, 1.05, 1.015, 1.005];
/// The same of a level at rest, which a fit leaves a percent or two short of its narrow well.
const LEVEL: [f64; 3] = [1.05, 1.02, 1.007];
/// Steps on in one direction, iterations of each, and the gain in nats that is worth the next.
const STEPS: usize = 4;
const STEP_ITERATIONS: usize = 2;
const WORTH_A_STEP: f64 = 0.5;

/// The last effect refined; that of a `contender` from the end of the fit, and along its thresholds.
pub(super) fn refined(data: &Data, fit: Fit, contender: bool, rotary: bool) -> Fit {
    let problem = data.problem();
    let last = fit.candidate.effects.len() - 1;
    let fit = with_form(&problem, if contender { converged(data, &fit) } else { fit }, last);
    let fit = if rotary { in_whole_waves(data, fit, last) } else { fit };
    // A threshold that was not found leaves its effect far behind; without a memory the search is cheap.
    let kind = fit.candidate.effects[last].kind;
    if kind.threshold() && (contender || !kind.remembers()) { along_thresholds(&problem, fit, last) } else { fit }
}

/// The refinements of the form of effect `j` (a second harmonic, an exponent): they do not change its name, and are kept only
/// where they pay for their parameters.
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

/// A ripple along the angle of a shaft has whole waves in a turn, where that does as well.
fn in_whole_waves(data: &Data, fit: Fit, j: usize) -> Fit {
    let Some(model) = Model::of(&fit).in_whole_waves(j) else { return fit };
    match model.fit(&data.problem(), Some(&fit.initial), LAST_ITERATIONS) {
        Ok(whole) if paired(&whole.mse, &fit.mse, &fit.samples, data.floor()).lambda < NAMING.price => whole,
        _ => fit,
    }
}

/// Coordinate search over the parameters of effect `j` that are on a grid, the rest refitted.
fn along_thresholds(problem: &Problem<'_>, best: Fit, j: usize) -> Fit {
    let own = best.free.iter().filter(|free| matches!(free, Free::Effect(k, _) if *k == j)).count();
    let ratios: &[f64] = if own == 1 { &FINE } else { &COARSE };
    let parameters = best.candidate.effects[j].kind.definition().parameters.iter();
    let on_a_grid = parameters.enumerate().filter(|(_, p)| matches!(p.search, Search::Grid(..)) && p.default.is_none());
    let best = along(problem, best, j, &on_a_grid.map(|(i, _)| i).collect::<Vec<_>>(), ratios);
    Model::of(&best).fit(problem, Some(&best.initial), 5).unwrap_or(best)
}

/// The levels of the last effect sought about the fit; `None` where that is no better.
pub(super) fn along_levels(data: &Data, fit: &Fit) -> Option<Fit> {
    let j = fit.candidate.effects.len().checked_sub(1)?;
    let parameters = fit.candidate.effects[j].kind.definition().parameters.iter();
    let levels = parameters.enumerate().filter(|(_, p)| p.role == Role::Level && p.search == Search::Amplitude);
    let best = along(&data.problem(), fit.clone(), j, &levels.map(|(i, _)| i).collect::<Vec<_>>(), &LEVEL);
    (best.cost < fit.cost).then_some(best)
}

/// Coordinate search over the parameters `indices` of effect `j`: on by each ratio, up and down, as long as it gets better.
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
