//! Fits carried to their end: over all segments, to convergence, in refined form, along thresholds; and the refusal of what
//! the recordings do not resolve (discovery.md, method step 3).

use breakaway_core::plant::effect::{ActsIn, Over, Scale, Search};
use breakaway_core::plant::{Effect, MAX_SUB_STEPS, Plant};
use rayon::prelude::*;

use super::data::Data;
use super::decide::{NAMING, paired};
use super::screen::stroke;
use crate::identify::shooting::{self, Candidate, Fit, FitError, Free, Problem};
use crate::identify::track::median;

/// Floor of the base model's fit, as a multiple of the mean square that it leaves.
const BASE_FLOOR: f64 = 10.0;
/// Mean square of the median segment over the noise's from which a named effect is fitted like that.
const MISSES_MUCH: f64 = 4.0;
/// Iterations in the final, and of a fit that is to converge.
pub(super) const FINAL_ITERATIONS: usize = 12;
const LAST_ITERATIONS: usize = 20;
/// Iterations with all sub-steps after those with half of them.
const FINE_ITERATIONS: usize = 3;
/// Restarts of a fit that is to converge, at the most, and the gain in nats that is worth another.
const RESTARTS: usize = 2;
const WORTH_A_RESTART: f64 = 20.0;
/// How far a wave number may be from a whole one to be taken for it.
const WHOLE: f64 = 0.1;

/// Share of a sample's time below which a delay or a lag of the drive is not believed: the solver's own error is a like share.
const LEAST_OF_A_SAMPLE: f64 = 0.01;
/// Share of the inertia below which a second body is not believed.
const LEAST_BODY: f64 = 0.02;
/// Damping ratio from which less than a tenth of an oscillation is left after a period: a body that hardly rings is what
/// a gap's contact looks like.
const MOST_DAMPING: f64 = 0.35;

/// Over all segments to convergence.
pub(super) fn finish(data: &Data, start: &Fit) -> Result<Fit, String> {
    let problem = data.problem();
    // Bristles take many sub-steps: most of the way with half of them.
    let slow = start.candidate.effects.iter().any(|effect| effect.kind.bristles());
    let first = Problem { coarse: slow, ..problem };
    let from = |initial| first.fit(&start.candidate, &start.free, initial, FINAL_ITERATIONS);
    // Where the heat had all segments, as it has of short ones, its starts are worth as much as the smoothed motion.
    let mut fits = vec![from(None)];
    if start.initial.len() == data.fit.len() {
        fits.push(from(Some(start.initial.as_slice())));
    }
    let best = fits.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let mut fit = best.unwrap_or(Err(FitError::NoSegment)).map_err(|e| e.to_string())?;
    if slow {
        fit = problem.fit(&fit.candidate, &fit.free, Some(&fit.initial), FINE_ITERATIONS).map_err(|e| e.to_string())?;
    }
    resolved(data, &fit.candidate, &fit.candidate.effects)?;
    Ok(fit)
}

/// As it comes out of the first heat, where it may not set a mark for the others if it is refused.
pub(super) fn begun(data: &Data, fit: Fit) -> Result<Fit, String> {
    // Bristles that took the share of an effect which was missing are too long until it is there: only the new ones count yet.
    let new = fit.candidate.effects.len().saturating_sub(1)..;
    resolved(data, &fit.candidate, &fit.candidate.effects[new])?;
    Ok(fit)
}

fn cost(fit: &Result<Fit, FitError>) -> f64 {
    fit.as_ref().map_or(f64::INFINITY, |fit| fit.cost)
}

/// Refuses what the recordings do not show: dynamics so fast that what is simulated is the solver's; bristles so long
/// that they never let go, which are a spring whose rest every segment chooses for itself; bodies so light that only
/// their start, free in every segment, is left of them, or on a spring that is all damper; and inertia or friction that no drive of the recordings
/// overcomes, beside which only the starts move anything.
fn resolved(data: &Data, candidate: &Candidate, bristles: &[Effect<f64>]) -> Result<(), String> {
    let plant = Plant { base: candidate.base, effects: &candidate.effects };
    if data.tracks.iter().any(|track| plant.sub_steps(track.ts) >= MAX_SUB_STEPS) {
        return Err("became faster than the recordings resolve".to_owned());
    }
    let brief = |effect: &Effect<f64>| {
        let definition = effect.kind.definition();
        let times = definition.parameters.iter().zip(&effect.p).filter(|(parameter, _)| parameter.unit == "s");
        definition.acts_in == ActsIn::Drive
            && data.tracks.iter().any(|track| times.clone().any(|(_, value)| *value < LEAST_OF_A_SAMPLE * track.ts))
    };
    if candidate.effects.iter().any(brief) {
        return Err("became shorter than the recordings' time stamps tell".to_owned());
    }
    let (base, largest) = (candidate.base, data.problem().largest_base());
    if base.b >= largest.b || base.c >= largest.c || base.f1 >= largest.f1 {
        return Err("its inertia or friction became larger than any drive of the recordings moves".to_owned());
    }
    let softest = candidate.base.f1 / stroke(data);
    let soft = |effect: &Effect<f64>| {
        let parameters = effect.kind.definition().parameters.iter().zip(&effect.p);
        effect.kind.bristles()
            && parameters.into_iter().any(|(parameter, value)| {
                matches!(parameter.search, Search::Grid(Scale::Presliding, _)) && *value < softest
            })
    };
    if bristles.iter().any(soft) {
        return Err("its bristles became longer than the motion".to_owned());
    }
    let light = |effect: &Effect<f64>| {
        let share = effect.kind.definition().parameters.iter().position(|p| p.symbol == "mu");
        effect.kind.second_body() && share.is_some_and(|i| effect.p[i] < LEAST_BODY)
    };
    if candidate.effects.iter().any(light) {
        return Err(format!("its body became lighter than {:.0} % of the inertia", 100.0 * LEAST_BODY));
    }
    let dull = |effect: &Effect<f64>| {
        let damping = effect.kind.definition().parameters.iter().position(|p| p.symbol == "zeta");
        damping.is_some_and(|i| effect.p[i] > MOST_DAMPING)
    };
    if candidate.effects.iter().any(dull) {
        return Err("its body hardly rings: what gives may be a gap's contact".to_owned());
    }
    Ok(())
}

/// Fits a model that may miss much: the floor is far above the mean square that it leaves, which makes it a plain least-squares
/// fit to all segments alike, and not to those (of one direction, of one speed) that it can be made to follow.
///
/// # Errors
/// [`FitError`] of the fit.
pub fn fit_softly(data: &Data, start: &Candidate, iterations: usize) -> Result<Fit, FitError> {
    let free = Free::all(&start.effects);
    let fit = data.problem().fit(start, &free, None, iterations)?;
    levelled(data, start, &free, &fit, iterations, None)
}

/// A named effect's fit as the base model's is made, where it leaves far more than the noise too.
pub fn settled(data: &Data, fit: Fit) -> Fit {
    if median(fit.mse.clone()) < MISSES_MUCH * data.sigma * data.sigma {
        return fit;
    }
    levelled(data, &fit.candidate, &fit.free, &fit, LAST_ITERATIONS, Some(&fit.initial)).unwrap_or(fit)
}

fn levelled(
    data: &Data,
    start: &Candidate,
    free: &[Free],
    fit: &Fit,
    iterations: usize,
    initial: Option<&[shooting::Start]>,
) -> Result<Fit, FitError> {
    let softened = data.softened(BASE_FLOOR * fit.mse.iter().sum::<f64>() / fit.mse.len() as f64);
    softened.problem().fit(start, free, initial, iterations)
}

/// Iterated to the end, from its own starts and from the smoothed motion, again while that gains: what is left afterwards is
/// the model's, and a further effect is not named for finishing the fit.
pub fn converged(data: &Data, fit: &Fit) -> Fit {
    let problem = data.problem();
    let mut best = fit.clone();
    if best.converged {
        return best;
    }
    for _ in 0..RESTARTS {
        let again = [Some(best.initial.as_slice()), None]
            .into_iter()
            .filter_map(|initial| problem.fit(&best.candidate, &best.free, initial, LAST_ITERATIONS).ok())
            .min_by(|a, b| a.cost.total_cmp(&b.cost));
        let Some(again) = again else { break };
        let gain = best.cost - again.cost;
        if gain > 0.0 {
            best = again;
        }
        if gain < WORTH_A_RESTART {
            break;
        }
    }
    best
}

/// Place of the wave number along the position among the parameters of the last effect.
fn wave_number(candidate: &Candidate) -> Option<(usize, usize)> {
    let j = candidate.effects.len().checked_sub(1)?;
    let parameters = candidate.effects[j].kind.definition().parameters;
    let along = |search| matches!(search, Search::Spectrum(Over::Position | Over::PositionAndDirection));
    parameters.iter().position(|p| along(p.search)).map(|i| (j, i))
}

/// A ripple along the angle of a shaft has whole waves in a turn: the wave number rounded, if it is near one. One wave in a
/// turn is the gravity load's.
pub(super) fn in_whole_waves(candidate: &mut Candidate) -> bool {
    let Some((j, i)) = wave_number(candidate) else { return false };
    let n = &mut candidate.effects[j].p[i];
    let whole = (*n - n.round()).abs() <= WHOLE && n.round() >= 2.0;
    if whole {
        *n = n.round();
    }
    whole
}

/// All that is free but the frequency of the last effect, in position or in time, or of its resonance.
pub(super) fn without_wave_number(candidate: &Candidate) -> Vec<Free> {
    let j = candidate.effects.len() - 1;
    let parameters = candidate.effects[j].kind.definition().parameters;
    let mut free = Free::all(&candidate.effects);
    free.retain(
        |free| !matches!(*free, Free::Effect(k, i) if k == j && matches!(parameters[i].search, Search::Spectrum(_) | Search::Resonance(..))),
    );
    free
}

/// The fit with a whole number of waves where that does as well.
fn with_whole_waves(data: &Data, fit: Fit) -> Fit {
    let mut candidate = fit.candidate.clone();
    let free = wave_number(&candidate).map(|(j, i)| Free::Effect(j, i));
    if free.is_none_or(|free| !fit.free.contains(&free)) || !in_whole_waves(&mut candidate) {
        return fit;
    }
    let held = without_wave_number(&candidate);
    match data.problem().fit(&candidate, &held, Some(&fit.initial), LAST_ITERATIONS) {
        Ok(whole) if paired(&whole.mse, &fit.mse, &fit.samples, data.floor()).lambda < NAMING.price => whole,
        _ => fit,
    }
}

/// Form refined; for a contender iterated to the end, and thresholds searched.
pub(super) fn polished(data: &Data, fit: Fit, contender: bool, rotary: bool) -> Fit {
    let problem = data.problem();
    let last = fit.candidate.effects.len() - 1;
    let fit = if contender { converged(data, &fit) } else { fit };
    let fit = refined(&problem, fit, last);
    let fit = if rotary { with_whole_waves(data, fit) } else { fit };
    // A threshold that was not found leaves its effect far behind; without a memory the search is cheap.
    let kind = fit.candidate.effects[last].kind;
    if kind.threshold() && (contender || !kind.remembers()) { along_thresholds(&problem, fit, last) } else { fit }
}

/// The model with its effect `j` replaced by each of `others`, refitted over all segments.
pub fn replaced(data: &Data, current: &Fit, j: usize, others: &[Effect<f64>]) -> Vec<Fit> {
    let fresh = |other: &&Effect<f64>| !current.candidate.effects.iter().any(|effect| effect.kind == other.kind);
    let others: Vec<&Effect<f64>> = others.iter().filter(fresh).collect();
    let replaced = others.into_par_iter().with_max_len(1).map(|other| {
        let mut candidate = current.candidate.clone();
        candidate.effects[j] = *other;
        refitted(data, current, &candidate)
    });
    replaced.flatten().collect()
}

/// The model without its effect `j`, refitted over all segments.
pub fn without(data: &Data, current: &Fit, j: usize) -> Option<Fit> {
    let mut candidate = current.candidate.clone();
    candidate.effects.remove(j);
    refitted(data, current, &candidate)
}

/// Another model, from the starts of the current one.
fn refitted(data: &Data, current: &Fit, candidate: &Candidate) -> Option<Fit> {
    data.problem().fit(candidate, &Free::all(&candidate.effects), Some(&current.initial), LAST_ITERATIONS).ok()
}

/// Tries the refinements of the form of effect `j` (a second harmonic, an exponent): they do not change its name, and are
/// kept only where they pay for their parameters.
fn refined(problem: &Problem<'_>, best: Fit, j: usize) -> Fit {
    let effect = best.candidate.effects[j];
    let parameters = effect.kind.definition().parameters;
    let refinements: Vec<usize> = (0..parameters.len()).filter(|i| parameters[*i].default.is_some()).collect();
    let Some(&first) = refinements.first() else { return best };
    let price = 10.0 + NAMING.price * refinements.len() as f64;
    let mut held = Free::all(&best.candidate.effects);
    held.retain(|free| !best.free.contains(free));
    let phases: &[f64] = if refinements.len() > 1 { &[0.0, 2.0, -2.0] } else { &[0.0] };
    phases
        .iter()
        .filter_map(|phase| {
            let mut candidate = best.candidate.clone();
            let p = &mut candidate.effects[j].p;
            // An amplitude starts at a tenth of the first, an exponent at half its usual value.
            p[first] = if p[first] == 0.0 { 0.1 * p[0] } else { 0.5 * p[first] };
            if let Some(second) = refinements.get(1) {
                p[*second] = *phase;
            }
            let mut free = Free::all(&candidate.effects);
            free.retain(|free| !held.contains(free));
            problem.fit(&candidate, &free, Some(&best.initial), FINAL_ITERATIONS).ok()
        })
        .filter(|fit| fit.cost < best.cost - price)
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .unwrap_or(best)
}

/// Coordinate search over the parameters of effect `j` that are on a grid: ratios that shrink, the rest refitted.
fn along_thresholds(problem: &Problem<'_>, best: Fit, j: usize) -> Fit {
    // A single threshold, at rest, decides by the sample at which the body starts: to a percent and finer.
    let own = best.free.iter().filter(|free| matches!(free, Free::Effect(k, _) if *k == j)).count();
    let ratios: &[f64] = if own == 1 { &[1.5, 1.15, 1.05, 1.015, 1.005] } else { &[1.4, 1.12] };
    let parameters = best.candidate.effects[j].kind.definition().parameters.iter();
    let on_a_grid = parameters.enumerate().filter(|(_, p)| matches!(p.search, Search::Grid(..)) && p.default.is_none());
    let best = along(problem, best, j, &on_a_grid.map(|(i, _)| i).collect::<Vec<_>>(), ratios);
    problem.fit(&best.candidate, &best.free, Some(&best.initial), 5).unwrap_or(best)
}

/// A level at rest that many segments pass decides, as a threshold does, by the sample at which the body starts: the fit stops
/// a percent or two short of it, in one of many narrow wells.
pub(super) fn shaken(data: &Data, fit: &Fit) -> Option<Fit> {
    let best = fit.clone();
    let j = best.candidate.effects.len() - 1;
    let parameters = best.candidate.effects[j].kind.definition().parameters.iter();
    let levels = parameters.enumerate().filter(|(_, p)| p.search == Search::Amplitude && p.unit == "U");
    let best = along(&data.problem(), best, j, &levels.map(|(i, _)| i).collect::<Vec<_>>(), &[1.05, 1.02, 1.007]);
    (best.cost < fit.cost).then_some(best)
}

/// Coordinate search over the parameters `indices` of effect `j`: on by each ratio, up and down, as long as it gets better.
fn along(problem: &Problem<'_>, mut best: Fit, j: usize, indices: &[usize], ratios: &[f64]) -> Fit {
    let parameters = best.candidate.effects[j].kind.definition().parameters;
    for &ratio in ratios {
        for &i in indices {
            for factor in [ratio, 1.0 / ratio] {
                for _ in 0..4 {
                    let mut candidate = best.candidate.clone();
                    candidate.effects[j].p[i] =
                        (candidate.effects[j].p[i] * factor).clamp(parameters[i].min, parameters[i].max);
                    let others: Vec<Free> = best.free.iter().copied().filter(|f| *f != Free::Effect(j, i)).collect();
                    match problem.fit(&candidate, &others, Some(&best.initial), 2) {
                        Ok(fit) if fit.cost < best.cost - 0.5 => best = Fit { free: best.free.clone(), ..fit },
                        _ => break,
                    }
                }
            }
        }
    }
    best
}
