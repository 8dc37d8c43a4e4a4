//! Add: the effects of the catalogue, each from its best starts, beside a model.

use breakaway_core::plant::{Effect, Kind};
use rayon::prelude::*;

use super::compare::{NAMING, gain, names, simplest};
use super::descend::{FINAL_ITERATIONS, over_all};
use super::halving::Halving;
use super::incumbent::Incumbent;
use super::plausible::resolved;
use super::refine::refined;
use crate::discover::data::Data;
use crate::discover::gap::{LEFT, mean_log};
use crate::discover::model::Model;
use crate::discover::screen::Screen;
use crate::fit::{Fit, median};

/// Floor of the logarithm over a part of the segments, as a share of the current model's median mean square.
const PART_FLOOR: f64 = 0.1;
/// Floor of the logarithm over all segments, as a share of the best effect's median mean square.
const FINAL_FLOOR: f64 = 1.0;
/// Effects that go on to all segments, at the least.
const FINALISTS: usize = 6;
/// Share of the best gain above which further effects go on to all segments.
const CLOSE: f64 = 0.7;
/// Share of the best gain below which no effect goes on.
const RIVAL: f64 = 0.25;
/// Share of the best gain above which an effect is refined.
const COMPETITIVE: f64 = 0.4;
/// Share of the best gain above which an effect's fit is iterated to the end before it is refined.
const CONTENDING: f64 = 0.7;
/// Share of what is left above the noise that a law must take to close it.
const MOST_OF_IT: f64 = 0.5;
/// Most effects with enough evidence that are considered.
const CONSIDERED: usize = 4;

/// The result of an effect of the catalogue beside a model.
#[derive(Clone, Debug)]
pub(super) struct Tried {
    /// Which effect.
    pub kind: Kind,
    /// Its fit over all segments, or why there is none.
    pub fit: Result<Fit, String>,
}

impl Tried {
    fn cost(&self) -> f64 {
        self.fit.as_ref().map_or(f64::INFINITY, |fit| fit.cost)
    }
}

/// Effects tried beside a model.
#[derive(Clone, Debug)]
pub(super) struct Round {
    /// The data with the round's floor.
    pub data: Data,
    /// The model, fitted with that floor.
    pub without: Fit,
    /// The effects, in the order of their costs.
    pub tried: Vec<Tried>,
}

/// Why an effect cannot be added beside others; `None` if it can.
pub(super) fn excluded(kind: Kind, effects: &[Effect<f64>], rotary: bool) -> Option<&'static str> {
    if kind.definition().needs_angle && !rotary {
        return Some("needs an angle in radians");
    }
    let residue = |of: Kind| of.definition().residue.iter().find(|other| other.name == kind.name()).map(|r| r.why);
    effects.iter().find_map(|effect| kind.excludes(effect.kind).or_else(|| residue(effect.kind)))
}

/// Tries the effects `kinds` beside `current`. `compared` is called as each was compared over a part of the segments.
///
/// The model may miss a machine by many times its encoder's noise. Then the few segments that come near the noise must
/// not decide. So the floor of the logarithm is a share of what the best effect leaves. The `incumbent`, in whose place
/// the effects are tried, lowers it where it leaves less.
pub(super) fn add(
    data: &Data,
    current: &Fit,
    (kinds, compared): (&[Kind], &(dyn Fn() + Sync)),
    incumbent: Option<Incumbent<'_>>,
    rotary: bool,
) -> Option<Round> {
    let screen = Screen::of_all_widths(data, &current.candidate)?;
    let softened = data.softened(PART_FLOOR * median(current.mse.clone()));
    let halving = Halving::new(&softened, current, rotary);
    let first = over_part(&halving, &softened, &screen, (kinds, compared), |kind| {
        excluded(kind, &current.candidate.effects, rotary)
    });
    let own = |fit: &Fit| halving.current.cost - fit.cost;
    let mut gains: Vec<(usize, f64)> =
        first.iter().enumerate().filter_map(|(i, t)| Some((i, own(t.fit.as_ref().ok()?)))).collect();
    gains.sort_by(|a, b| b.1.total_cmp(&a.1));
    let best = gains.first().map_or(0.0, |g| g.1);
    // An effect that gains little beside the incumbent is neither tied with it nor better.
    let contested = incumbent.map_or(f64::NEG_INFINITY, |own| RIVAL * halving.gain_of(own.fit));
    let left = gains.first().and_then(|g| first[g.0].fit.as_ref().ok()).map_or(0.0, |fit| median(fit.mse.clone()));
    let reached = incumbent.map(|own| median(own.fit.mse.clone()));
    let data = data.softened(FINAL_FLOOR * left.min(reached.unwrap_or(f64::INFINITY)));
    let without = Model::of(current)
        .fit(&data.problem(), Some(&current.initial), FINAL_ITERATIONS)
        .unwrap_or_else(|_| current.clone());
    let goes_on = |rank: usize, kind: Kind, gain: f64| {
        // Before it are the effects that gain more. Its own special case may be one of them.
        let idle = kind.remembers() && gains[..rank].iter().any(|(i, _)| kind.generalises(first[*i].kind));
        (rank < FINALISTS || gain > CLOSE * best) && gain > contested.max(RIVAL * best) && !idle
    };
    let finalists: Vec<usize> = gains
        .iter()
        .enumerate()
        .filter(|(rank, (i, gain))| goes_on(*rank, first[*i].kind, *gain))
        .map(|(_, (i, _))| *i)
        .collect();
    let finished = first.into_par_iter().with_max_len(1).enumerate().map(|(i, Tried { kind, fit })| {
        let fit = fit.and_then(|fit| {
            if !finalists.contains(&i) {
                return Err(format!("gains {:.0} of {best:.0} nats over a part of the segments", own(&fit)));
            }
            let fit = over_all(&data, &fit)?;
            resolved(&data, &fit.candidate, &fit.candidate.effects)?;
            Ok(fit)
        });
        let cost = |fit: &Result<Fit, String>| fit.as_ref().map_or(f64::INFINITY, |fit| fit.cost);
        let successor = incumbent.and_then(|own| own.successor(&data, current, kind, rotary)).map(Ok);
        let successor = successor.filter(|successor| cost(successor) < cost(&fit));
        Tried { kind, fit: successor.unwrap_or(fit) }
    });
    let mut tried: Vec<Tried> = finished.collect();
    refine(&data, &without, incumbent, &mut tried, rotary);
    tried.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    Some(Round { data, without, tried })
}

/// The effects over a part of the segments. Second bodies come last, because their starts are free in every segment.
/// Where a law without one brings the segments down to the noise, nothing is left that a body could explain.
fn over_part(
    halving: &Halving<'_>,
    data: &Data,
    screen: &Screen<'_>,
    (kinds, compared): (&[Kind], &(dyn Fn() + Sync)),
    excluded: impl Fn(Kind) -> Option<&'static str> + Sync,
) -> Vec<Tried> {
    let begin = |kind: Kind| {
        let fit = match excluded(kind) {
            Some(reason) => Err(reason.to_owned()),
            None => halving.best(screen, kind).and_then(|fit| {
                let new = fit.candidate.effects.len().saturating_sub(1)..;
                resolved(data, &fit.candidate, &fit.candidate.effects[new])?;
                Ok(fit)
            }),
        };
        compared();
        Tried { kind, fit }
    };
    let (bodies, laws): (Vec<Kind>, Vec<Kind>) = kinds.iter().partition(|kind| kind.second_body());
    let mut all: Vec<Tried> = laws.into_par_iter().with_max_len(1).map(begin).collect();
    let closes = |fit: &Fit| {
        let (before, after) = (mean_log(&halving.current.mse, data.sigma), mean_log(&fit.mse, data.sigma));
        after < LEFT && after < (1.0 - MOST_OF_IT) * before
    };
    let closing = all.iter().filter(|t| t.fit.as_ref().is_ok_and(closes));
    let closing = closing.min_by(|a, b| a.cost().total_cmp(&b.cost())).map(|t| t.kind.name());
    if let Some(name) = closing {
        let reason = format!("{name} brings what is left down to the noise without a second body");
        let fate = |body| excluded(body).map_or(reason.clone(), str::to_owned);
        all.extend(bodies.into_iter().map(|body| Tried { kind: body, fit: Err(fate(body)) }));
    } else {
        all.par_extend(bodies.into_par_iter().with_max_len(1).map(begin));
    }
    all
}

/// Refines what is competitive. A law that is at the noise leaves nothing to one with more parameters, which is then
/// left as it is. The exception is an effect that may be confused with that law: it must be shown as well as it can be.
fn refine(data: &Data, without: &Fit, incumbent: Option<Incumbent<'_>>, tried: &mut [Tried], rotary: bool) {
    // Where nothing gains, no share is positive, so that nothing is refined but thresholds.
    let own = incumbent.map(|own| data.problem().cost_of(&own.fit.mse));
    let best = tried.iter().map(Tried::cost).chain(own).fold(without.cost, f64::min);
    let share = |fit: &Fit| (without.cost - fit.cost) / (without.cost - best);
    let fits = tried.iter().filter_map(|t| Some((t.kind, t.fit.as_ref().ok()?)));
    let enough = fits.filter(|(_, fit)| fit.cost < best + NAMING.lambda && mean_log(&fit.mse, data.sigma) < LEFT);
    let simplest = enough.map(|(kind, fit)| (fit.free.len(), kind)).min_by_key(|(parameters, _)| *parameters);
    let idle = |kind: Kind, fit: &Fit| {
        simplest.is_some_and(|(enough, simplest)| fit.free.len() > enough && !simplest.resembles(kind))
    };
    tried.par_iter_mut().with_max_len(1).for_each(|t| {
        if let Ok(fit) = &mut t.fit
            && !idle(t.kind, fit)
            && (share(fit) > COMPETITIVE || t.kind.threshold())
        {
            *fit = refined(data, fit.clone(), share(fit) > CONTENDING, rotary);
        }
    });
}

impl Round {
    /// The effects whose evidence suffices, in the order in which they are considered. The first is the simplest of
    /// those tied with the best. The others follow by their cost; there are at most [`CONSIDERED`].
    pub(super) fn preference(&self) -> Vec<usize> {
        let enough = |i: &usize| self.tried[*i].fit.as_ref().is_ok_and(|fit| names(&self.data, &self.without, fit));
        let mut order: Vec<usize> = (0..self.tried.len()).filter(enough).take(CONSIDERED).collect();
        let fits: Vec<&Fit> = order.iter().filter_map(|i| self.tried[*i].fit.as_ref().ok()).collect();
        if let Some(rank) = simplest(&self.data, &self.without, &fits) {
            let preferred = order.remove(rank);
            order.insert(0, preferred);
        }
        order
    }

    /// The effect with the greatest z among those whose evidence suffices, `named` left out. Second bodies are left out
    /// too: their starts gain wherever something is left.
    pub(super) fn second(&self, named: Kind) -> Option<usize> {
        let z = |i: usize| {
            let fit = self.tried[i].fit.as_ref().ok().filter(|fit| names(&self.data, &self.without, fit))?;
            Some((i, gain(&self.data, &self.without, fit).z))
        };
        let others = (0..self.tried.len()).filter(|i| {
            let kind = self.tried[*i].kind;
            kind != named && !kind.second_body()
        });
        others.filter_map(z).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    }
}
