//! Every effect of the catalogue, started from the screen and refitted by simulation (discovery.md, method step 3).
//!
//! Two heats: all effects, from their best starts, over a part of the segments; then the leaders over all segments to
//! convergence, with a search along parameters that gradients do not find.

use breakaway_core::plant::effect::{Over, Scale, Search};
use breakaway_core::plant::{Base, Effect, Kind, MAX_SUB_STEPS, Plant};
use rayon::prelude::*;

use super::data::{Data, FIT_SEGMENT_S};
use super::decide::{NAMING, paired};
use super::screen::{Screen, Start, stroke};
use crate::identify::shooting::{self, Candidate, Fit, FitError, Free, Problem, Segment};
use crate::identify::track::median;

/// Floor of the logarithm, as a share of the median segment's mean square: of the current model's in the first heat, and of
/// the best effect's in the final.
const HEAT_FLOOR: f64 = 0.1;
const FINAL_FLOOR: f64 = 1.0;
/// Floor of the base model's fit, as a multiple of the mean square that it leaves.
const BASE_FLOOR: f64 = 10.0;
/// Mean square of the median segment over the noise's from which a named effect is fitted like that.
const MISSES_MUCH: f64 = 4.0;
/// One in so many segments is in the first heat; iterations there, in the final, and of a fit that is to converge.
const FIRST_SHARE: usize = 3;
const FIRST_ITERATIONS: usize = 5;
const FINAL_ITERATIONS: usize = 12;
const LAST_ITERATIONS: usize = 20;
/// Restarts of a fit that is to converge, at the most, and the gain in nats that is worth another.
const RESTARTS: usize = 2;
const WORTH_A_RESTART: f64 = 20.0;
/// Leaders that go to the final at the least, and the share of the best gain that takes further ones there.
const LEADERS: usize = 6;
const CLOSE: f64 = 0.7;
/// Share of the best gain below which an effect with a memory, whose simulation takes ten times as long, stays out.
const COSTLY: f64 = 0.25;
/// Share of the best gain from which an effect's form is refined, and from which it is iterated to convergence and its
/// thresholds are searched.
const COMPETITIVE: f64 = 0.4;
const CONTENDING: f64 = 0.7;
/// Starts simulated per effect, and where the screen is blind to it.
const STARTS: usize = 4;
const PERIODIC_STARTS: usize = 9;
const BLIND_STARTS: usize = 24;
/// Segments on which starts are compared, half of them those that the current model fits worst; iterations there; and
/// how many starts go on.
const TRIAL_SEGMENTS: usize = 14;
const TRIAL_ITERATIONS: usize = 2;
const TRIAL_KEPT: usize = 3;
const PERIODIC_KEPT: usize = 5;
/// One in so many of these where the model carries bristles or a second body already, whose simulation is slow.
const SLOW_SHARE: usize = 3;
/// Share of the screen's amplitude from which an effect grows out of the current model; and its most, as a share of f1 for
/// forces, or as a ratio.
const SEED_AMPLITUDE: f64 = 0.1;

/// How far a wave number may be from a whole one to be taken for it.
const WHOLE: f64 = 0.1;

/// What became of an effect of the catalogue in one round.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Which effect.
    pub kind: Kind,
    /// Its refit over all segments, or why there is none.
    pub fit: Result<Fit, String>,
}

impl Tried {
    /// Cost of the refit; infinite if there is none.
    pub fn cost(&self) -> f64 {
        self.fit.as_ref().map_or(f64::INFINITY, |fit| fit.cost)
    }
}

/// Why an effect does not come into question beside the model; `None` if it does.
pub fn excluded(kind: Kind, current: &Candidate, rotary: bool) -> Option<&'static str> {
    if current.effects.iter().any(|e| e.kind == kind) {
        return Some("already in the model");
    }
    let has = |kinds: &[Kind]| current.effects.iter().any(|e| kinds.contains(&e.kind));
    if kind.bristles() && has(&[Kind::Dahl, Kind::LuGre]) {
        return Some("the model carries bristle friction already");
    }
    if kind.free_memory() == 2 && current.effects.iter().any(|e| e.kind.free_memory() == 2) {
        return Some("the model carries a second body already");
    }
    if (kind == Kind::LuGre && has(&[Kind::Stribeck])) || (kind == Kind::Stribeck && has(&[Kind::LuGre])) {
        return Some("LuGre friction has the Stribeck curve in it");
    }
    if matches!(kind, Kind::GravityLoad | Kind::EncoderEccentricity) && !rotary {
        return Some("needs an angle in radians");
    }
    None
}

/// The first heat: a part of the segments, the current model refitted to it, and the few on which starts are compared.
struct Heat<'a> {
    data: &'a Data,
    current: Fit,
    segments: Vec<Segment>,
    trial: Vec<Segment>,
    trial_initial: Vec<shooting::Start>,
}

impl<'a> Heat<'a> {
    fn new(data: &'a Data, current: &Fit) -> Self {
        let step = FIRST_SHARE.min(data.fit.len().div_ceil(12).max(1));
        let part: Vec<usize> = (0..data.fit.len()).step_by(step).collect();
        let segments: Vec<Segment> = part.iter().map(|i| data.fit[*i]).collect();
        let initial: Vec<_> = part.iter().map(|i| current.initial[*i]).collect();
        // Gains count from the current model's own best on these segments, or they would all be offset.
        let current = data
            .over(&segments)
            .fit(&current.candidate, &current.free, Some(&initial), FIRST_ITERATIONS)
            .unwrap_or_else(|_| current.clone());
        let mut worst: Vec<usize> = (0..segments.len()).collect();
        worst.sort_by(|a, b| current.mse[*b].total_cmp(&current.mse[*a]));
        let even = segments.len().div_ceil(TRIAL_SEGMENTS / 2).max(1);
        let mut trial: Vec<usize> = (0..segments.len()).step_by(even).collect();
        trial
            .extend(worst.into_iter().filter(|i| i % even != 0).take(TRIAL_SEGMENTS - trial.len().min(TRIAL_SEGMENTS)));
        let trial_initial = trial.iter().map(|i| current.initial[*i]).collect();
        Self { data, trial: trial.into_iter().map(|i| segments[i]).collect(), trial_initial, current, segments }
    }
}

/// What a round of trials gives: the effects, and the current model and the data as they were judged in it.
#[derive(Debug)]
pub struct Round {
    /// The data with the round's floor.
    pub data: Data,
    /// The current model, refitted with that floor.
    pub current: Fit,
    /// Every effect of the catalogue.
    pub tried: Vec<Tried>,
}

/// Tries every effect of the catalogue on the residual of `current`.
///
/// A model that misses a machine by many times the noise of its encoder is not judged by the few segments that happen to
/// come near that noise: the floor of the logarithm is a share of what the best effect leaves.
pub fn try_all(data: &Data, current: &Fit, screen: &Screen<'_>, rotary: bool) -> Round {
    let softened = data.softened(HEAT_FLOOR * median(current.mse.clone()));
    let heat = Heat::new(&softened, current);
    let first: Vec<(Kind, Result<Fit, String>)> = Kind::ALL
        .par_iter()
        .with_max_len(1)
        .map(|&kind| match excluded(kind, &current.candidate, rotary) {
            Some(reason) => (kind, Err(reason.to_owned())),
            None => (kind, first_heat(&heat, screen, kind)),
        })
        .collect();
    let without = heat.current.cost;
    let mut gains: Vec<(usize, f64)> = first
        .iter()
        .enumerate()
        .filter_map(|(i, (_, fit))| fit.as_ref().ok().map(|fit| (i, without - fit.cost)))
        .collect();
    gains.sort_by(|a, b| b.1.total_cmp(&a.1));
    let best = gains.first().map_or(0.0, |g| g.1);
    let left = gains.first().and_then(|g| first[g.0].1.as_ref().ok()).map_or(0.0, |fit| median(fit.mse.clone()));
    let data = data.softened(FINAL_FLOOR * left);
    let current = data
        .problem()
        .fit(&current.candidate, &current.free, Some(&current.initial), FINAL_ITERATIONS)
        .unwrap_or_else(|_| current.clone());
    let finalists: Vec<usize> = gains
        .iter()
        .enumerate()
        .filter(|(rank, (i, gain))| {
            let costly = first[*i].0.remembers() && *gain < COSTLY * best;
            (*rank < LEADERS || *gain > CLOSE * best) && !costly
        })
        .map(|(_, (i, _))| *i)
        .collect();
    let mut tried: Vec<Tried> = first
        .into_par_iter()
        .with_max_len(1)
        .enumerate()
        .map(|(i, (kind, fit))| {
            let fit = fit.and_then(|fit| {
                if finalists.contains(&i) {
                    finish(&data, &fit)
                } else {
                    Err(format!("gains {:.0} of {best:.0} nats in the first heat", without - fit.cost))
                }
            });
            Tried { kind, fit }
        })
        .collect();
    // Where nothing gains, no share is positive, and nothing is worth more work.
    let best = tried.iter().map(Tried::cost).fold(current.cost, f64::min);
    let share = |fit: &Fit| (current.cost - fit.cost) / (current.cost - best);
    tried.par_iter_mut().with_max_len(1).for_each(|t| {
        if let Ok(fit) = &mut t.fit
            && (share(fit) > COMPETITIVE || (t.kind.threshold() && !t.kind.remembers()))
        {
            *fit = polished(&data, fit.clone(), share(fit) > CONTENDING, rotary);
        }
    });
    Round { data, current, tried }
}

/// Starts worth a simulation: the best of the screen; where the screen does not see far (extra mechanics faster than the
/// smoothing of the motion, thresholds), all over the grid.
fn chosen(kind: Kind, starts: Vec<Start>, share: usize) -> Vec<Start> {
    let most = match (blind(kind), kind.definition().periodic()) {
        (true, _) => BLIND_STARTS,
        (_, true) => PERIODIC_STARTS,
        _ => STARTS,
    };
    let most = most.div_ceil(share);
    let step = if blind(kind) { starts.len().div_ceil(most).max(1) } else { 1 };
    starts.into_iter().step_by(step).take(most).collect()
}

fn blind(kind: Kind) -> bool {
    kind.threshold() || kind.free_memory() > 0
}

fn first_heat(heat: &Heat<'_>, screen: &Screen<'_>, kind: Kind) -> Result<Fit, String> {
    let mut reason = "the weak form gives no starting value".to_owned();
    let problem = heat.data.over(&heat.segments);
    let heated = |candidate: &Candidate| {
        let free = Free::all(&candidate.effects);
        problem.fit(candidate, &free, Some(&heat.current.initial), FIRST_ITERATIONS)
    };
    let least = |fits: Vec<Fit>| fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    if kind.definition().periodic() && heat.data.segment_s < FIT_SEGMENT_S {
        // Few of the short segments hold what is looked for: the trial's would tell nothing.
        let starts = chosen(kind, screen.starts(kind), 1);
        let base = heat.current.candidate.base;
        let beside = starts.into_iter().map(|start| Candidate { base, ..start.candidate });
        return least(beside.filter_map(|candidate| heated(&candidate).ok()).collect()).ok_or(reason);
    }
    let mut tries: Vec<Fit> = Vec::new();
    let trial = heat.data.over(&heat.trial);
    let slow = heat.current.candidate.effects.iter().any(|effect| effect.kind.free_memory() > 0);
    let share = if slow { SLOW_SHARE } else { 1 };
    for start in chosen(kind, screen.starts(kind), share) {
        let variants = variants(&start.candidate, &heat.current.candidate.base);
        let fits = variants.iter().map(|candidate| {
            trial.fit(candidate, &without_wave_number(candidate), Some(&heat.trial_initial), TRIAL_ITERATIONS)
        });
        // One of each start goes on: what is far apart (wave numbers, thresholds) is not told apart by two steps.
        let mut best: Option<Fit> = None;
        for fit in fits {
            match fit {
                Ok(fit) if best.as_ref().is_none_or(|best| fit.cost < best.cost) => best = Some(fit),
                Ok(_) => (),
                Err(error) => reason = error.to_string(),
            }
        }
        tries.extend(best);
    }
    tries.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let kept = if kind.definition().periodic() { PERIODIC_KEPT } else { TRIAL_KEPT };
    let tries = tries.into_iter().take(kept.div_ceil(share));
    least(tries.filter_map(|fit| heated(&fit.candidate).ok()).collect()).ok_or(reason)
}

/// All that is free but the wave number of the last effect: few segments do not give it as well as the spectrum of all.
fn without_wave_number(candidate: &Candidate) -> Vec<Free> {
    let j = candidate.effects.len() - 1;
    let parameters = candidate.effects[j].kind.definition().parameters;
    let mut free = Free::all(&candidate.effects);
    free.retain(|free| !matches!(*free, Free::Effect(k, i) if k == j && matches!(parameters[i].search, Search::Spectrum(_))));
    free
}

/// The starts of one point of the screen. The weak form's base is biased where something is missing, and the current one
/// lacks the effect: both; and the effect small beside the current base, from where a fit cannot lose.
fn variants(start: &Candidate, base: &Base<f64>) -> Vec<Candidate> {
    let beside = Candidate { base: *base, effects: start.effects.clone() };
    let last = start.effects.len() - 1;
    let parameters = start.effects[last].kind.definition().parameters;
    let mut small = beside.clone();
    let mut grows = false;
    for (p, parameter) in small.effects[last].p.iter_mut().zip(parameters) {
        if parameter.search == Search::Amplitude && parameter.default.is_none() {
            let most = if parameter.unit == "U" { SEED_AMPLITUDE * base.f1 } else { SEED_AMPLITUDE };
            *p *= SEED_AMPLITUDE;
            if matches!(parameter.unit, "U" | "1") {
                *p = p.clamp(-most, most);
            }
            grows = true;
        }
    }
    if grows { vec![start.clone(), beside, small] } else { vec![beside] }
}

/// Over all segments to convergence.
fn finish(data: &Data, start: &Fit) -> Result<Fit, String> {
    resolved(data, &start.candidate)?;
    let fit = data.problem().fit(&start.candidate, &start.free, None, FINAL_ITERATIONS).map_err(|e| e.to_string())?;
    resolved(data, &fit.candidate)?;
    Ok(fit)
}

/// Refuses what the recordings do not show: dynamics so fast that what is simulated is the solver's, and bristles so long
/// that they never let go, which are a spring whose rest every segment chooses for itself.
fn resolved(data: &Data, candidate: &Candidate) -> Result<(), String> {
    let plant = Plant { base: candidate.base, effects: &candidate.effects };
    if data.tracks.iter().any(|track| plant.sub_steps(track.ts) >= MAX_SUB_STEPS) {
        return Err("became faster than the recordings resolve".to_owned());
    }
    let softest = candidate.base.f1 / stroke(data);
    let soft = |effect: &Effect<f64>| {
        let parameters = effect.kind.definition().parameters.iter().zip(&effect.p);
        effect.kind.bristles()
            && parameters.into_iter().any(|(parameter, value)| {
                matches!(parameter.search, Search::Grid(Scale::Presliding, _)) && *value < softest
            })
    };
    if candidate.effects.iter().any(soft) {
        return Err("its bristles became longer than the motion".to_owned());
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

/// A ripple along the angle of a shaft has whole waves in a turn: where the nearest whole number does as well, it is that.
fn in_whole_waves(data: &Data, fit: Fit) -> Fit {
    let j = fit.candidate.effects.len() - 1;
    let parameters = fit.candidate.effects[j].kind.definition().parameters;
    let wave = parameters.iter().position(|p| {
        matches!(p.search, Search::Spectrum(Over::Position | Over::PositionAndDirection))
    });
    let Some(i) = wave else { return fit };
    let mut candidate = fit.candidate.clone();
    let n = candidate.effects[j].p[i];
    candidate.effects[j].p[i] = n.round();
    // One wave in a turn is the gravity load's.
    if (n - n.round()).abs() > WHOLE || n.round() < 2.0 {
        return fit;
    }
    let held: Vec<Free> = fit.free.iter().copied().filter(|free| *free != Free::Effect(j, i)).collect();
    match data.problem().fit(&candidate, &held, Some(&fit.initial), LAST_ITERATIONS) {
        Ok(whole) if paired(&whole.mse, &fit.mse, &fit.samples, data.floor()).lambda < NAMING.price => whole,
        _ => fit,
    }
}

/// Form refined; for a contender iterated to the end, and thresholds searched.
fn polished(data: &Data, fit: Fit, contender: bool, rotary: bool) -> Fit {
    let problem = data.problem();
    let last = fit.candidate.effects.len() - 1;
    let fit = if contender { converged(data, &fit) } else { fit };
    let fit = refined(&problem, fit, last);
    let fit = if rotary { in_whole_waves(data, fit) } else { fit };
    // A threshold that was not found leaves its effect far behind; without a memory the search is cheap.
    let kind = fit.candidate.effects[last].kind;
    if kind.threshold() && (contender || !kind.remembers()) { along_thresholds(&problem, fit, last) } else { fit }
}

/// The model with its effect `j` replaced by each of `rivals`, simpler laws that were tried when it was named, refitted over
/// all segments: an effect named while another was still missing may have taken that one's share. The best replacement.
pub fn replaced(data: &Data, current: &Fit, j: usize, rivals: &[Effect<f64>]) -> Option<Fit> {
    let problem = data.problem();
    rivals
        .par_iter()
        .with_max_len(1)
        .filter_map(|rival| {
            let mut candidate = current.candidate.clone();
            if candidate.effects.iter().any(|effect| effect.kind == rival.kind) {
                return None;
            }
            candidate.effects[j] = *rival;
            problem.fit(&candidate, &Free::all(&candidate.effects), Some(&current.initial), LAST_ITERATIONS).ok()
        })
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Tries the refinements of the form of effect `j` (a second harmonic, an exponent): they do not change its name, and are
/// kept only where they pay for their parameters.
fn refined(problem: &Problem<'_>, best: Fit, j: usize) -> Fit {
    let effect = best.candidate.effects[j];
    let parameters = effect.kind.definition().parameters;
    let refinements: Vec<usize> = (0..parameters.len()).filter(|i| parameters[*i].default.is_some()).collect();
    let Some(&first) = refinements.first() else { return best };
    let price = 10.0 + NAMING.price * refinements.len() as f64;
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
            problem.fit(&candidate, &Free::all(&candidate.effects), Some(&best.initial), FINAL_ITERATIONS).ok()
        })
        .filter(|fit| fit.cost < best.cost - price)
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .unwrap_or(best)
}

/// Coordinate search over the parameters of effect `j` that are on a grid: ratios that shrink, the rest refitted.
fn along_thresholds(problem: &Problem<'_>, mut best: Fit, j: usize) -> Fit {
    let parameters = best.candidate.effects[j].kind.definition().parameters;
    // A single threshold, at rest, decides by the sample at which the body starts: to a percent and finer.
    let ratios: &[f64] = if best.free.len() == 4 { &[1.5, 1.15, 1.05, 1.015, 1.005] } else { &[1.4, 1.12] };
    for &ratio in ratios {
        for (i, parameter) in parameters.iter().enumerate() {
            if !matches!(parameter.search, Search::Grid(..)) || parameter.default.is_some() {
                continue;
            }
            for factor in [ratio, 1.0 / ratio] {
                // On, as long as it gets better.
                for _ in 0..4 {
                    let mut candidate = best.candidate.clone();
                    candidate.effects[j].p[i] =
                        (candidate.effects[j].p[i] * factor).clamp(parameter.min, parameter.max);
                    let others: Vec<Free> = best.free.iter().copied().filter(|f| *f != Free::Effect(j, i)).collect();
                    match problem.fit(&candidate, &others, Some(&best.initial), 2) {
                        Ok(fit) if fit.cost < best.cost - 0.5 => best = Fit { free: best.free.clone(), ..fit },
                        _ => break,
                    }
                }
            }
        }
    }
    problem.fit(&best.candidate, &best.free, Some(&best.initial), 5).unwrap_or(best)
}
