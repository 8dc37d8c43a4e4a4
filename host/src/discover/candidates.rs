//! Every effect of the catalogue, started from the screen and refitted by simulation (discovery.md, method step 3).
//!
//! Two heats: all effects, from their best starts, over a part of the segments; then the leaders over all segments to
//! convergence, with a search along parameters that gradients do not find.

use breakaway_core::plant::{Effect, Kind};
use rayon::prelude::*;

use super::data::Data;
use super::decide::NAMING;
use super::first_heat::Heat;
use super::gap::{LEFT, mean_log};
use super::ranking::{look_alike, special_case};
use super::refit::{FINAL_ITERATIONS, finish, polished};
use super::screen::Screen;
use crate::identify::shooting::{Candidate, Fit};
use crate::identify::track::median;

/// Floor of the logarithm, as a share of the median segment's mean square: of the current model's in the first heat, and of
/// the best effect's in the final.
const HEAT_FLOOR: f64 = 0.1;
const FINAL_FLOOR: f64 = 1.0;
/// Leaders that go to the final at the least, and the share of the best gain that takes further ones there.
const LEADERS: usize = 6;
const CLOSE: f64 = 0.7;
/// Share of the best gain below which an effect with a memory, whose simulation takes ten times as long, stays out.
const COSTLY: f64 = 0.25;
/// Share of the best gain from which an effect's form is refined, and from which it is iterated to convergence and its
/// thresholds are searched.
const COMPETITIVE: f64 = 0.4;
const CONTENDING: f64 = 0.7;
/// What became of an effect of the catalogue in one round.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Which effect.
    pub kind: Kind,
    /// Its refit over all segments, or why there is none.
    pub fit: Result<Fit, String>,
    /// The effect as it was fitted last, whatever became of the fit.
    pub begun: Option<Effect<f64>>,
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
    if kind.second_body() && current.effects.iter().any(|e| e.kind.second_body()) {
        return Some("the model carries a second body already");
    }
    if (matches!(kind, Kind::LoadFriction | Kind::Delay | Kind::ElectricalLag) || kind.bristles())
        && has(&[Kind::Backlash])
    {
        return Some(
            "looks like what a gap's contact that yields leaves of one that does not: after reversals, and late",
        );
    }
    if (kind == Kind::LuGre && has(&[Kind::Stribeck])) || (kind == Kind::Stribeck && has(&[Kind::LuGre])) {
        return Some("LuGre friction has the Stribeck curve in it");
    }
    if matches!(kind, Kind::GravityLoad | Kind::EncoderEccentricity) && !rotary {
        return Some("needs an angle in radians");
    }
    None
}

/// What a round of trials gives: the effects, and the current model and the data as they were judged in it.
#[derive(Clone, Debug)]
pub struct Round {
    /// The data with the round's floor.
    pub data: Data,
    /// The current model, refitted with that floor.
    pub current: Fit,
    /// Every effect of the catalogue, in the order of their costs.
    pub tried: Vec<Tried>,
}

/// Tries every effect of the catalogue on the residual of `current`.
///
/// A model that misses a machine by many times the noise of its encoder is not judged by the few segments that happen to
/// come near that noise: the floor of the logarithm is a share of what the best effect leaves.
pub fn try_all(data: &Data, current: &Fit, screen: &Screen<'_>, rotary: bool) -> Round {
    let softened = data.softened(HEAT_FLOOR * median(current.mse.clone()));
    let heat = Heat::new(&softened, current, rotary);
    let first = heat.all(screen, |kind| excluded(kind, &current.candidate, rotary));
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
            let kind = first[*i].0;
            let costly = kind.remembers() && *gain < COSTLY * best;
            // The gains are sorted: before it are those that gain more, its own special case perhaps.
            let idle = kind.remembers() && gains[..*rank].iter().any(|(i, _)| special_case(first[*i].0, kind));
            (*rank < LEADERS || *gain > CLOSE * best) && !costly && !idle
        })
        .map(|(_, (i, _))| *i)
        .collect();
    let mut tried: Vec<Tried> = first
        .into_par_iter()
        .with_max_len(1)
        .enumerate()
        .map(|(i, (kind, fit))| {
            let begun = fit.as_ref().ok().and_then(|fit| fit.candidate.effects.last().copied());
            let fit = fit.and_then(|fit| {
                if finalists.contains(&i) {
                    finish(&data, &fit)
                } else {
                    Err(format!("gains {:.0} of {best:.0} nats in the first heat", without - fit.cost))
                }
            });
            Tried { kind, fit, begun }
        })
        .collect();
    // Where nothing gains, no share is positive, and nothing is worth more work.
    let best = tried.iter().map(Tried::cost).fold(current.cost, f64::min);
    let share = |fit: &Fit| (current.cost - fit.cost) / (current.cost - best);
    // More parameters than a law that does as well and is at the noise can only fit that; but what it may be confused with is
    // to be shown as well as it can be.
    let fits = tried.iter().filter_map(|t| Some((t.kind, t.fit.as_ref().ok()?)));
    let enough = fits.filter(|(_, fit)| fit.cost < best + NAMING.lambda && mean_log(&fit.mse, data.sigma) < LEFT);
    let simplest = enough.map(|(kind, fit)| (fit.free.len(), kind)).min_by_key(|(parameters, _)| *parameters);
    let idle = |kind: Kind, fit: &Fit| {
        simplest.is_some_and(|(enough, simplest)| fit.free.len() > enough && !look_alike(simplest, kind))
    };
    tried.par_iter_mut().with_max_len(1).for_each(|t| {
        if let Ok(fit) = &mut t.fit
            && !idle(t.kind, fit)
            && (share(fit) > COMPETITIVE || t.kind.threshold())
        {
            *fit = polished(&data, fit.clone(), share(fit) > CONTENDING, rotary);
        }
    });
    tried.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    Round { data, current, tried }
}
