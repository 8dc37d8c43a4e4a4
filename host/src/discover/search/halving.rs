//! Successive halving over the starts of an effect. All are compared over few segments and iterations, the better half
//! over more, and the best over still more.

use breakaway_core::plant::effect::{Role, Search};
use breakaway_core::plant::{Base, Effect, Kind};
use rayon::prelude::*;

use super::descend::{FINAL_ITERATIONS, is_slow};
use crate::discover::data::{Data, FIT_SEGMENT_S};
use crate::discover::model::Model;
use crate::discover::screen::{Screen, Start as Point};
use crate::fit::{Fit, Problem, Segment, Start};

/// One segment in so many is in the part.
const PART: usize = 3;
/// Fewest segments of the part, where there are so many.
const LEAST_PART: usize = 12;
/// Segments on which starts are compared first. About half of them are those that the current model fits worst.
const FEW: usize = 14;
/// Starts of an effect that are tried, the best of the screen.
const STARTS: usize = 4;
/// The same for a periodic effect. For thresholds, and for effects with a memory, the screen tells little: all starts
/// are tried.
const PERIODIC_STARTS: usize = 9;
/// One start in so many is tried where the model already has bristles or a second body, whose simulation is slow. A gap
/// keeps all its starts.
const SLOW_SHARE: usize = 3;
/// Most starts that are kept after the first rung.
const KEPT: usize = 5;
/// Iterations of a rung.
const ITERATIONS: usize = 2;
/// Iterations of the last rung.
const LAST: usize = 5;
/// Share of the screen's amplitude from which an effect grows out of the current model. It is also the largest such
/// amplitude: as a share of f1 for a force, as such for a ratio.
const SEED_AMPLITUDE: f64 = 0.1;
/// Share of the best gain at which a whole number of waves is preferred to another.
const AS_GOOD: f64 = 0.9;

/// The current model over a part of the segments, with the few on which starts are compared first.
pub(super) struct Halving<'a> {
    data: &'a Data,
    model: Model,
    pub current: Fit,
    /// Indices of the part among all segments.
    indices: Vec<usize>,
    part: Vec<Segment>,
    few: Vec<Segment>,
    few_initial: Vec<Start>,
    rotary: bool,
}

impl<'a> Halving<'a> {
    pub(super) fn new(data: &'a Data, current: &Fit, rotary: bool) -> Self {
        // Few of the short segments show the effect, and they are quickly simulated. So all of them are used.
        let share = if data.segment_s < FIT_SEGMENT_S { 1 } else { PART };
        let step = share.min(data.fit.len().div_ceil(LEAST_PART).max(1));
        let part: Vec<usize> = (0..data.fit.len()).step_by(step).collect();
        let segments: Vec<Segment> = part.iter().map(|i| data.fit[*i]).collect();
        let initial: Vec<Start> = part.iter().map(|i| current.initial[*i]).collect();
        let model = Model::of(current);
        // The current model is fitted to these segments too. Otherwise all gains would have an offset.
        let current = model.fit(&data.over(&segments), Some(&initial), LAST).unwrap_or_else(|_| current.clone());
        let mut worst: Vec<usize> = (0..segments.len()).collect();
        worst.sort_by(|a, b| current.mse[*b].total_cmp(&current.mse[*a]));
        let even = segments.len().div_ceil(FEW / 2).max(1);
        let mut few: Vec<usize> = (0..segments.len()).step_by(even).collect();
        few.extend(worst.into_iter().filter(|i| i % even != 0).take(FEW - few.len().min(FEW)));
        let few_initial = few.iter().map(|i| current.initial[*i]).collect();
        let few = few.into_iter().map(|i| segments[i]).collect();
        Self { data, model, current, indices: part, part: segments, few, few_initial, rotary }
    }

    /// The gain of a fit to all segments, counted over the part, nats.
    pub(super) fn gain_of(&self, fit: &Fit) -> f64 {
        let mse: Vec<f64> = self.indices.iter().map(|i| fit.mse[*i]).collect();
        self.current.cost - self.data.over(&self.part).cost_of(&mse)
    }

    /// The best start of an effect, fitted over the part; or the reason why there is none.
    pub(super) fn best(&self, screen: &Screen<'_>, kind: Kind) -> Result<Fit, String> {
        let part = Problem { coarse: self.is_coarse(kind), ..self.data.over(&self.part) };
        let starts = self.chosen(kind, screen.starts(kind));
        let none = || "the weak form gives no starting value".to_owned();
        if kind.definition().periodic() && self.data.segment_s < FIT_SEGMENT_S {
            return self.in_whole_waves(&part, starts).ok_or_else(none);
        }
        let mut kept = if kind.second_body() { self.bodies(&part, kind, starts) } else { self.over_few(kind, starts)? };
        kept.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        kept.truncate(kept.len().div_ceil(2).min(KEPT));
        if kept.len() > 1 {
            kept = self.over(&part, &kept, ITERATIONS);
        }
        let best = least(kept).ok_or_else(none)?;
        least(self.over(&part, std::slice::from_ref(&best), LAST)).ok_or_else(none)
    }

    /// Whether half of the sub-steps are enough to compare starts.
    fn is_coarse(&self, kind: Kind) -> bool {
        kind.bristles() || is_slow(&self.model.effects)
    }

    /// The fits go on over the part.
    fn over(&self, part: &Problem<'_>, fits: &[Fit], iterations: usize) -> Vec<Fit> {
        let fits = fits.par_iter().with_max_len(1).filter_map(|fit| {
            let new = *fit.candidate.effects.last()?;
            let initial = match fit.initial.len() == self.part.len() {
                true => Some(&fit.initial[..]),
                // Among impacts the measured motion is the better start.
                false if new.kind.gap().is_some() => None,
                false => Some(&self.current.initial[..]),
            };
            self.model.with(new).at(&fit.candidate).fit(part, initial, iterations).ok()
        });
        fits.collect()
    }

    /// The first rung: every start over the few segments, with its frequency held.
    fn over_few(&self, kind: Kind, starts: Vec<Point>) -> Result<Vec<Fit>, String> {
        let few = Problem { coarse: self.is_coarse(kind), ..self.data.over(&self.few) };
        let mut reason = "the weak form gives no starting value".to_owned();
        let mut fits = Vec::new();
        for start in starts {
            // One fit of each start goes on. Two iterations do not tell starts apart that are far from each other.
            let mut best: Option<Fit> = None;
            for model in self.variants(&start) {
                match model.at_its_frequency().fit(&few, Some(&self.few_initial), ITERATIONS) {
                    Ok(fit) if best.as_ref().is_none_or(|best| fit.cost < best.cost) => best = Some(fit),
                    Ok(_) => (),
                    Err(error) => reason = error.to_string(),
                }
            }
            fits.extend(best);
        }
        if fits.is_empty() { Err(reason) } else { Ok(fits) }
    }

    /// The first rung of a second body. Its start is free in every segment, so that few segments tell little: half of
    /// the part is used. Two iterations at a held frequency give its mass; two more then find the frequency. Among
    /// impacts two iterations tell nothing, so that a gap is fitted for longer.
    fn bodies(&self, part: &Problem<'_>, kind: Kind, starts: Vec<Point>) -> Vec<Fit> {
        let step = if self.part.len() < 2 * LEAST_PART { 1 } else { 2 };
        let segments: Vec<Segment> = self.part.iter().copied().step_by(step).collect();
        let initial: Vec<Start> = self.current.initial.iter().copied().step_by(step).collect();
        let half = Problem { segments: &segments, ..*part };
        let fits = starts.into_par_iter().with_max_len(1).filter_map(|start| {
            let model = self.beside(&start);
            if kind.gap().is_some() {
                return model.fit(&half, None, LAST).ok();
            }
            let held = model.at_its_frequency().fit(&half, Some(&initial), ITERATIONS).ok()?;
            model.at(&held.candidate).fit(&half, Some(&held.initial), ITERATIONS).ok()
        });
        fits.collect()
    }

    /// A periodic effect over short segments. Few of them show it, so that all starts are fitted to the end. Where
    /// those few lie a whole number of waves apart, other wave numbers do nearly as well. Along the angle of a shaft a
    /// whole number is then taken.
    fn in_whole_waves(&self, part: &Problem<'_>, starts: Vec<Point>) -> Option<Fit> {
        let fits = starts.into_par_iter().with_max_len(1).filter_map(|start| {
            let model = self.beside(&start);
            let whole = model.in_whole_waves(model.effects.len() - 1).filter(|_| self.rotary);
            let fit = whole.as_ref().unwrap_or(&model).fit(part, Some(&self.current.initial), FINAL_ITERATIONS).ok()?;
            Some((whole.is_some(), fit))
        });
        let fits: Vec<(bool, Fit)> = fits.collect();
        let gain = |fit: &Fit| self.current.cost - fit.cost;
        let best = fits.iter().map(|(_, fit)| gain(fit)).fold(0.0, f64::max);
        let worth = |(whole, fit): &(bool, Fit)| gain(fit) + if *whole { (1.0 - AS_GOOD) * best } else { 0.0 };
        fits.into_iter().max_by(|a, b| worth(a).total_cmp(&worth(b))).map(|(_, fit)| fit)
    }

    /// The starts that are worth a simulation.
    fn chosen(&self, kind: Kind, starts: Vec<Point>) -> Vec<Point> {
        let unseen = kind.threshold() || kind.free_memory() > 0;
        let most = match (unseen, kind.definition().periodic()) {
            (true, _) => starts.len(),
            (_, true) => PERIODIC_STARTS,
            _ => STARTS,
        };
        let slow = self.model.effects.iter().any(|effect| effect.kind.free_memory() > 0);
        let most = most.div_ceil(if slow && kind.gap().is_none() { SLOW_SHARE } else { 1 }).max(1);
        let step = if unseen { starts.len().div_ceil(most).max(1) } else { 1 };
        starts.into_iter().step_by(step).take(most).collect()
    }

    /// The new effect of a start beside the current model.
    fn beside(&self, start: &Point) -> Model {
        let new = start.candidate.effects.last().copied();
        new.map_or_else(|| self.model.clone(), |new| self.model.with(new)).on(self.current.candidate.base)
    }

    /// The models of one point of the screen. The weak form's base is biased where something is missing; the current
    /// base lacks the effect. So both are tried. The third has a small effect beside the current base, from where a fit
    /// cannot lose.
    fn variants(&self, start: &Point) -> Vec<Model> {
        let beside = self.beside(start);
        let last = beside.effects.len() - 1;
        match grown_from(&beside.effects[last], &beside.base) {
            Some(small) => {
                let mut little = beside.clone();
                little.effects[last] = small;
                vec![beside.clone().on(start.candidate.base), beside, little]
            }
            None => vec![beside],
        }
    }
}

/// The effect with small amplitudes; `None` where it has no amplitude.
fn grown_from(effect: &Effect<f64>, base: &Base<f64>) -> Option<Effect<f64>> {
    let mut small = *effect;
    let mut grows = false;
    for (p, parameter) in small.p.iter_mut().zip(effect.kind.definition().parameters) {
        if parameter.search == Search::Amplitude && parameter.default.is_none() {
            *p *= SEED_AMPLITUDE;
            let most = match parameter.role {
                Role::Amplitude | Role::Level => SEED_AMPLITUDE * base.f1,
                Role::Ratio => SEED_AMPLITUDE,
                _ => f64::INFINITY,
            };
            *p = p.clamp(-most, most);
            grows = true;
        }
    }
    grows.then_some(small)
}

fn least(fits: Vec<Fit>) -> Option<Fit> {
    fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))
}
