//! The first heat: every effect of the catalogue from its best starts, over a part of the segments.

use breakaway_core::plant::effect::Search;
use breakaway_core::plant::{Base, Kind};
use rayon::prelude::*;

use super::data::{Data, FIT_SEGMENT_S};
use super::gap::{LEFT, mean_log};
use super::refit::{FINAL_ITERATIONS, begun, in_whole_waves, without_wave_number};
use super::screen::{Screen, Start};
use crate::identify::shooting::{self, Candidate, Fit, Free, Problem, Segment};

/// One in so many segments is in the first heat, and iterations there.
const FIRST_SHARE: usize = 3;
const FIRST_ITERATIONS: usize = 5;
/// Starts simulated per effect; all of them where the screen is blind to it.
const STARTS: usize = 4;
const PERIODIC_STARTS: usize = 9;
/// Segments on which starts are compared, half of them those that the current model fits worst; iterations there; and
/// how many starts go on.
const TRIAL_SEGMENTS: usize = 14;
const TRIAL_ITERATIONS: usize = 2;
const TRIAL_KEPT: usize = 3;
const PERIODIC_KEPT: usize = 5;
const RESONANCES_KEPT: usize = 5;
/// Share of the best gain from which a whole number of waves is preferred to another.
const AS_GOOD: f64 = 0.9;
/// One in so many of these where the model carries bristles or a second body already, whose simulation is slow.
const SLOW_SHARE: usize = 3;
/// Share of the screen's amplitude from which an effect grows out of the current model; and its most, as a share of f1 for
/// forces, or as a ratio.
const SEED_AMPLITUDE: f64 = 0.1;
/// Share of what is left above the noise that a law takes which closes it.
const MOST_OF_IT: f64 = 0.5;

/// An effect after the first heat: its fit, or why there is none.
pub(super) type Begun = (Kind, Result<Fit, String>);

/// A part of the segments, the current model refitted to it, and the few on which starts are compared.
pub(super) struct Heat<'a> {
    data: &'a Data,
    pub current: Fit,
    segments: Vec<Segment>,
    trial: Vec<Segment>,
    trial_initial: Vec<shooting::Start>,
    rotary: bool,
}

impl<'a> Heat<'a> {
    pub(super) fn new(data: &'a Data, current: &Fit, rotary: bool) -> Self {
        // Few of the short segments hold what is looked for, and are quickly simulated: all of them.
        let share = if data.segment_s < FIT_SEGMENT_S { 1 } else { FIRST_SHARE };
        let step = share.min(data.fit.len().div_ceil(12).max(1));
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
        Self { data, trial: trial.into_iter().map(|i| segments[i]).collect(), trial_initial, current, segments, rotary }
    }

    /// Every effect that comes into question, or why it does not.
    ///
    /// A second body, whose start is free in every segment, comes last: where a law without one brings the segments down to
    /// the noise there is nothing left that it could explain.
    pub(super) fn all(
        &self,
        screen: &Screen<'_>,
        excluded: impl Fn(Kind) -> Option<&'static str> + Sync,
    ) -> Vec<Begun> {
        let begin = |kind: Kind| match excluded(kind) {
            Some(reason) => (kind, Err(reason.to_owned())),
            None => (kind, first_heat(self, screen, kind).and_then(|fit| begun(self.data, fit))),
        };
        let (bodies, laws): (Vec<Kind>, Vec<Kind>) = Kind::ALL.iter().partition(|kind| kind.second_body());
        let mut all: Vec<Begun> = laws.into_par_iter().with_max_len(1).map(begin).collect();
        let closes =
            |(kind, fit): &Begun| fit.as_ref().ok().filter(|fit| self.closed_by(fit)).map(|fit| (*kind, fit.cost));
        let closing = all.iter().filter_map(closes).min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((kind, _)) = closing {
            let reason = format!("{} brings what is left down to the noise without a second body", kind.name());
            all.extend(
                bodies.into_iter().map(|body| (body, Err(excluded(body).map_or(reason.clone(), str::to_owned)))),
            );
        } else {
            all.par_extend(bodies.into_par_iter().with_max_len(1).map(begin));
        }
        all
    }

    /// Whether `fit` takes most of what is left above the noise, and leaves nothing there.
    fn closed_by(&self, fit: &Fit) -> bool {
        let (before, after) = (mean_log(&self.current.mse, self.data.sigma), mean_log(&fit.mse, self.data.sigma));
        after < LEFT && after < (1.0 - MOST_OF_IT) * before
    }
}

/// Starts worth a simulation: the best of the screen; where the screen does not see far (extra mechanics faster than the
/// smoothing of the motion, thresholds), all over the grid.
fn chosen(kind: Kind, starts: Vec<Start>, share: usize) -> Vec<Start> {
    let most = match (blind(kind), kind.definition().periodic()) {
        (true, _) => starts.len(),
        (_, true) => PERIODIC_STARTS,
        _ => STARTS,
    };
    let most = most.div_ceil(share).max(1);
    let step = if blind(kind) { starts.len().div_ceil(most).max(1) } else { 1 };
    starts.into_iter().step_by(step).take(most).collect()
}

fn blind(kind: Kind) -> bool {
    kind.threshold() || kind.free_memory() > 0
}

fn first_heat(heat: &Heat<'_>, screen: &Screen<'_>, kind: Kind) -> Result<Fit, String> {
    let mut reason = "the weak form gives no starting value".to_owned();
    let problem = Problem { coarse: kind.bristles(), ..heat.data.over(&heat.segments) };
    let heated = |candidate: &Candidate, iterations: usize| {
        let free = Free::all(&candidate.effects);
        problem.fit(candidate, &free, Some(&heat.current.initial), iterations)
    };
    let least = |fits: Vec<Fit>| fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    if kind.definition().periodic() && heat.data.segment_s < FIT_SEGMENT_S {
        return over_short_segments(heat, &problem, chosen(kind, screen.starts(kind), 1)).ok_or(reason);
    }
    if kind.gap().is_some() {
        return least(through_impacts(heat, &problem, chosen(kind, screen.starts(kind), 1))).ok_or(reason);
    }
    let slow = heat.current.candidate.effects.iter().any(|effect| effect.kind.free_memory() > 0);
    let share = if slow { SLOW_SHARE } else { 1 };
    if kind.second_body() {
        let kept = RESONANCES_KEPT.div_ceil(share);
        return least(among_resonances(heat, &problem, chosen(kind, screen.starts(kind), share), kept)).ok_or(reason);
    }
    let mut tries: Vec<Fit> = Vec::new();
    let trial = Problem { coarse: kind.bristles(), ..heat.data.over(&heat.trial) };
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
    let kept = tries.into_iter().take(kept.div_ceil(share));
    // A few iterations over the heat's segments part those, and the rest is for the best.
    let best = least(kept.filter_map(|fit| heated(&fit.candidate, TRIAL_ITERATIONS).ok()).collect()).ok_or(reason)?;
    heated(&best.candidate, FIRST_ITERATIONS).map_err(|error| error.to_string())
}

/// A periodic effect over short segments, few of which hold what is looked for: a trial's would tell nothing, so all starts
/// go to the end. Where these few lie an integer of waves apart any other number does nearly as well; along the angle of a
/// shaft it is a whole one then.
fn over_short_segments(heat: &Heat<'_>, problem: &Problem<'_>, starts: Vec<Start>) -> Option<Fit> {
    let base = heat.current.candidate.base;
    let fits: Vec<(bool, Fit)> = starts
        .into_iter()
        .filter_map(|start| {
            let mut beside = Candidate { base, ..start.candidate };
            let whole = heat.rotary && in_whole_waves(&mut beside);
            let free = if whole { without_wave_number(&beside) } else { Free::all(&beside.effects) };
            Some((whole, problem.fit(&beside, &free, Some(&heat.current.initial), FINAL_ITERATIONS).ok()?))
        })
        .collect();
    let gain = |fit: &Fit| heat.current.cost - fit.cost;
    let best = fits.iter().map(|(_, fit)| gain(fit)).fold(0.0, f64::max);
    let worth = |(whole, fit): &(bool, Fit)| gain(fit) + if *whole { (1.0 - AS_GOOD) * best } else { 0.0 };
    fits.into_iter().max_by(|a, b| worth(a).total_cmp(&worth(b))).map(|(_, fit)| fit)
}

/// A body that is lost among impacts: two steps over a few segments would tell nothing, so all starts go to the end; and from
/// the measured motion, since one that was fitted without the impacts is far from it.
fn through_impacts(heat: &Heat<'_>, problem: &Problem<'_>, starts: Vec<Start>) -> Vec<Fit> {
    let base = heat.current.candidate.base;
    let fits = starts.into_par_iter().with_max_len(1).filter_map(|start| {
        let beside = Candidate { base, ..start.candidate };
        problem.fit(&beside, &Free::all(&beside.effects), None, FIRST_ITERATIONS).ok()
    });
    fits.collect()
}

/// A body on a spring: two steps at a frequency give its mass, with which two more are drawn to the right one; a few segments
/// would not tell which, and only the end does.
fn among_resonances(heat: &Heat<'_>, problem: &Problem<'_>, starts: Vec<Start>, kept: usize) -> Vec<Fit> {
    let base = heat.current.candidate.base;
    let drawn = starts.into_par_iter().with_max_len(1).filter_map(|start| {
        let beside = Candidate { base, ..start.candidate };
        let held = without_wave_number(&beside);
        let there = problem.fit(&beside, &held, Some(&heat.current.initial), TRIAL_ITERATIONS).ok()?;
        let free = Free::all(&there.candidate.effects);
        problem.fit(&there.candidate, &free, Some(&there.initial), TRIAL_ITERATIONS).ok()
    });
    let mut drawn: Vec<Fit> = drawn.collect();
    drawn.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    drawn.truncate(kept);
    let fits = drawn
        .into_par_iter()
        .with_max_len(1)
        .filter_map(|fit| problem.fit(&fit.candidate, &fit.free, Some(&heat.current.initial), FIRST_ITERATIONS).ok());
    fits.collect()
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
