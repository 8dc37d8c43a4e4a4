//! The model as it grows: in every round the effects of the catalogue are tried, the best is held against data that it was not
//! fitted to, and what was named before is looked at again beside it.

use breakaway_core::plant::{Effect, Kind};

use super::candidates::{self, Round};
use super::data::Data;
use super::decide::{FURTHER, NAMING, paired};
use super::gap::{Gap, LEAST_TOTAL, open_loop_squares, root_mean};
use super::outcome::{CandidateRow, NamedEffect, Rival, Rung, Verdict};
use super::ranking::{better, evidence, instead, like, nearest, others, parameters, preference, rivals, table};
use super::refit;
use super::screen::Screen;
use crate::identify::shooting::{Covariance, Fit};
use crate::recording::Units;

/// Most effects added in one discovery.
const MAX_ADDED: usize = 3;

/// Other effects with which a model is begun again, at the most.
const OTHER_BEGINNINGS: usize = 2;

/// A model on its way from the base to all that can be named.
pub(super) struct Chain<'a> {
    data: &'a Data,
    units: &'a Units,
    base: (Fit, Gap),
    current: Fit,
    gap: Gap,
    named: Vec<Named>,
    ladder: Vec<Rung>,
    /// The first round, as it was before any effect was considered.
    opening: Option<Round>,
    first_round: Vec<CandidateRow>,
    closest: Option<String>,
    tie: Option<Tie>,
    remarks: Vec<String>,
    /// The next round and what is named in it, where looking one further has found that already.
    ahead: Option<(Round, Accepted)>,
}

/// A named effect: what comes close, and the laws that are tried in its place once another is named.
struct Named {
    effect: NamedEffect,
    instead: Vec<Effect<f64>>,
}

/// Two fits that the recordings do not tell apart.
pub(super) struct Tie {
    pub a: Fit,
    pub b: Fit,
    pub kinds: [Kind; 2],
}

/// What the chain comes to.
pub(super) struct Ended {
    pub verdict: Verdict,
    pub fit: Fit,
    pub errors: Covariance,
    pub named: Vec<NamedEffect>,
    pub ladder: Vec<Rung>,
    /// What became of every effect in the first round.
    pub first_round: Vec<CandidateRow>,
    /// The effect that came closest in it, said.
    pub closest: Option<String>,
    pub tie: Option<Tie>,
    pub remarks: Vec<String>,
}

/// An effect that is to be named: its place in the round, the fit with it, and what that leaves on held-out data.
type Accepted = (usize, Fit, Gap);

impl<'a> Chain<'a> {
    pub(super) fn new(data: &'a Data, units: &'a Units, base: Fit) -> Self {
        let gap = Gap::of(data, &base);
        Self {
            data,
            units,
            current: base.clone(),
            gap,
            named: Vec::new(),
            ladder: vec![rung(data, &base)],
            base: (base, gap),
            opening: None,
            first_round: Vec::new(),
            closest: None,
            tie: None,
            remarks: Vec::new(),
            ahead: None,
        }
    }

    /// Where the effects of the model begin that were not given.
    fn known(&self) -> usize {
        self.base.0.candidate.effects.len()
    }

    /// One effect more; `false` where none is missing or none can be named.
    pub(super) fn step(&mut self, progress: &(dyn Fn(&str) + Sync)) -> bool {
        let first = self.named.is_empty();
        // The ladder has the base's rung, and one for every step.
        if self.ladder.len() > MAX_ADDED || (!first && !self.gap.something_left()) {
            return false;
        }
        progress(&format!("looking for effect {} among {}", self.named.len() + 1, Kind::ALL.len()));
        let ahead = self.ahead.take().map(|(round, accepted)| (round, Some(accepted)));
        let Some((mut round, found)) = ahead.or_else(|| Some((self.round(&self.current)?, None))) else { return false };
        if first {
            self.closest = nearest(&round.data, &round.current, &round.tried, self.units);
            self.opening = Some(round.clone());
        }
        let accepted = found.or_else(|| self.accepted(&mut round));
        self.take(round, accepted)
    }

    /// Names what a round came to; `false` where that is nothing.
    fn take(&mut self, mut round: Round, accepted: Option<Accepted>) -> bool {
        let rivals = accepted.as_ref().map_or_else(Vec::new, |(index, fit, _)| self.rivals(&mut round, *index, fit));
        let Round { data: judged, current: without, tried } = round;
        if self.named.is_empty() {
            self.first_round = table(&judged, &without, &tried, accepted.as_ref().map(|a| a.0));
        }
        let Some((index, fit, after)) = accepted else { return false };
        let kind = tried[index].kind;
        if let Some(rival) = rivals.iter().find(|r| r.tied)
            && let Some(Ok(other)) = tried.iter().find(|t| t.kind == rival.kind).map(|t| &t.fit)
        {
            self.tie = Some(Tie { a: fit.clone(), b: other.clone(), kinds: [kind, rival.kind] });
        }
        let instead = instead(&tried, index, &rivals, self.known() + self.named.len());
        self.current = fit;
        self.gap = after;
        self.named.push(Named { effect: NamedEffect { kind, parameters: Vec::new(), rivals }, instead });
        self.look_back(&judged);
        self.ladder.push(rung(self.data, &self.current));
        true
    }

    /// Chains that begin with another effect of the first round, where this one leaves more than the noise: what gained most
    /// while two were missing may be neither. Those that most segments bear out first.
    pub(super) fn begun_otherwise(&self) -> impl Iterator<Item = Self> {
        let opening = self.opening.as_ref().filter(|_| !self.named.is_empty() && !self.explained());
        opening.into_iter().flat_map(|round| {
            let places = others(&round.data, &round.current, &round.tried, self.named[0].effect.kind);
            places.into_iter().take(OTHER_BEGINNINGS).filter_map(|index| {
                let mut other = Self::new(self.data, self.units, self.base.0.clone());
                let (fit, after) = other.carried_through(round, index)?;
                other.closest.clone_from(&self.closest);
                other.remarks.push(format!(
                    "begun with {} in place of {}, which leaves more than the noise",
                    round.tried[index].kind.name(),
                    self.named[0].effect.kind.name()
                ));
                other.take(round.clone(), Some((index, fit, after))).then_some(other)
            })
        })
    }

    /// Whether this is to stand in the place of `first`, which it was begun otherwise from: it comes down to the noise by names that
    /// hold, and not by an effect more than those of `first`, where that found none that holds.
    pub(super) fn replaces(&self, first: &Self) -> bool {
        let more = first.named.iter().all(|a| self.named.iter().any(|b| a.effect.kind == b.effect.kind));
        self.explained() && self.withdrawal().is_none() && !more
    }

    /// Why all that is named is not to be: what it would do to the gap. The typical segment may become better while those that
    /// diverge grow.
    fn withdrawal(&self) -> Option<&'static str> {
        let base = &self.base.1;
        if self.named.is_empty() {
            None
        } else if base.leaves(&self.gap, LEAST_TOTAL) {
            Some("leave most of the gap")
        } else {
            (!self.gap.shrinks(base)).then_some("widen the gap")
        }
    }

    /// Whether the model is down to the noise.
    fn explained(&self) -> bool {
        if self.named.iter().any(|named| named.effect.kind.second_body()) {
            self.base.1.explained_by_bodies(&self.gap)
        } else {
            self.gap.explained()
        }
    }

    fn round(&self, fit: &Fit) -> Option<Round> {
        let screen = Screen::of_all_widths(self.data, &fit.candidate)?;
        let rotary = matches!(self.units.x.as_str(), "rad" | "x");
        Some(candidates::try_all(self.data, fit, &screen, rotary))
    }

    /// The first effect, in the order of preference, that holds on data that it was not fitted to.
    fn accepted(&mut self, round: &mut Round) -> Option<Accepted> {
        let mut looked_further = false;
        for index in preference(&round.data, &round.current, &round.tried) {
            let Some((fit, after)) = self.carried_through(round, index) else { continue };
            self.finish_without(round, &fit);
            if !evidence(&round.data, &round.current, &round.tried[index], &NAMING) {
                round.tried[index].fit = Err("only finishes the fit of what was named before".to_owned());
                continue;
            }
            let Some(reason) = self.refusal(round, index, &after) else { return Some((index, fit, after)) };
            // What another missing effect spoils on held-out data may be right.
            if !looked_further && self.named.len() + 1 < MAX_ADDED && self.gap.typically_halved(&after) {
                looked_further = true;
                self.ahead = self.explained_beside(&fit);
                if self.ahead.is_some() {
                    return Some((index, fit, after));
                }
            }
            self.remarks.push(format!("{} {reason}: not named", round.tried[index].kind.name()));
            round.tried[index].fit = Err(reason);
        }
        None
    }

    /// What an effect gained by leading the earlier ones out of a narrow valley is not its own: the model without it goes on
    /// from there, if that is better.
    fn finish_without(&mut self, round: &mut Round, fit: &Fit) {
        if self.named.is_empty() {
            return;
        }
        let last = fit.candidate.effects.len() - 1;
        if let Some(other) = refit::without(&round.data, fit, last).filter(|other| other.cost < round.current.cost) {
            round.current = other.clone();
            self.go_on_with(other);
        }
    }

    /// An effect's fit carried to its end, and what it leaves.
    fn carried_through(&self, round: &Round, index: usize) -> Option<(Fit, Gap)> {
        let fit = round.tried[index].fit.as_ref().ok()?;
        let fit = refit::settled(self.data, refit::converged(&round.data, fit));
        let after = Gap::of(self.data, &fit);
        let shaken = Some(&fit).filter(|_| after.something_left()).and_then(|fit| refit::shaken(&round.data, fit));
        let Some(shaken) = shaken else { return Some((fit, after)) };
        let fit = refit::settled(self.data, refit::converged(&round.data, &shaken));
        let after = Gap::of(self.data, &fit);
        Some((fit, after))
    }

    /// The round beside `fit` whose best effect brings the model down to the noise, with that effect; `None` where it does not.
    /// A second body, whose start is free in every segment, does not count.
    fn explained_beside(&self, fit: &Fit) -> Option<(Round, Accepted)> {
        let round = self.round(fit)?;
        let best = *preference(&round.data, &round.current, &round.tried).first()?;
        let (fit, after) = self.carried_through(&round, best)?;
        let explains = after.explained() && !round.tried[best].kind.second_body();
        explains.then_some((round, (best, fit, after)))
    }

    /// Why an effect that leaves `after` is not named.
    fn refusal(&self, round: &Round, index: usize, after: &Gap) -> Option<String> {
        let tried = &round.tried[index];
        if let Some(reason) = self.gap.refuses(after) {
            return Some(reason);
        }
        if tried.kind.second_body() && !self.gap.followed_by_bodies(after) {
            return Some("follows short segments from a start free in each, and not the open loop".to_owned());
        }
        let enough = !self.gap.only_outliers() && evidence(&round.data, &round.current, tried, &FURTHER);
        (!self.named.is_empty() && !enough && !self.gap.closed_by(after))
            .then(|| "thins what is left in a few segments, and does not close it".to_owned())
    }

    /// What comes close to the effect that is named; what is tied with it must hold on the held-out data too.
    fn rivals(&self, round: &mut Round, index: usize, fit: &Fit) -> Vec<Rival> {
        let mut rivals = rivals(&round.data, fit, &round.tried, index);
        rivals.retain(|rival| {
            let other = round.tried.iter_mut().find(|t| t.kind == rival.kind && rival.tied);
            let reason = other.as_ref().and_then(|t| self.gap.refuses(&Gap::of(self.data, t.fit.as_ref().ok()?)));
            if let (Some(other), Some(reason)) = (other, &reason) {
                other.fit = Err(reason.clone());
            }
            reason.is_none()
        });
        rivals
    }

    /// What was named while another was still missing may have taken that one's share, or another law's place; and what is
    /// dropped may be the law for which one of the others stands.
    fn look_back(&mut self, judged: &Data) {
        let mut dropped: Vec<Effect<f64>> = Vec::new();
        for j in (0..self.named.len()).rev() {
            let place = self.known() + j;
            let own = self.current.candidate.effects[place];
            let without = (j + 1 < self.named.len()).then(|| refit::without(judged, &self.current, place)).flatten();
            if let Some(other) = without.filter(|other| self.gives_way(other, judged)) {
                self.remarks.push(format!("beside what was named later, nothing is left of {}", own.kind.name()));
                self.tie.take_if(|tie| tie.kinds.contains(&own.kind));
                self.named.remove(j);
                self.go_on_with(other);
                dropped.push(own);
            } else if self.named.len() > 1 {
                self.exchange(judged, j, &self.named[j].instead.clone());
            }
        }
        for j in 0..self.named.len() {
            let alike = dropped.iter().filter(|law| like(self.named[j].effect.kind, law.kind)).copied();
            self.exchange(judged, j, &alike.collect::<Vec<_>>());
        }
    }

    /// Another law in the place of the `j`-th named one, if one of `others` is to be there.
    fn exchange(&mut self, judged: &Data, j: usize, others: &[Effect<f64>]) {
        let place = self.known() + j;
        let name = self.named[j].effect.kind.name();
        let others = refit::replaced(judged, &self.current, place, others);
        let best =
            others.into_iter().filter(|other| self.gives_way(other, judged)).min_by(|a, b| a.cost.total_cmp(&b.cost));
        let Some(other) = best else { return };
        let new = other.candidate.effects[place].kind;
        let how = if other.free.len() < self.current.free.len() { "does as well as" } else { "does better than" };
        self.remarks.push(format!("beside the others, {} {how} {name}", new.name()));
        self.named[j].effect.kind = new;
        self.named[j].effect.rivals.retain(|rival| rival.kind != new);
        self.go_on_with(other);
    }

    /// Whether the current model gives way to `other`: with fewer parameters it is enough to do as well; else `other` must be
    /// better, on held-out data too.
    fn gives_way(&self, other: &Fit, judged: &Data) -> bool {
        let (own, its) = (self.current.free.len(), other.free.len());
        if its < own {
            !better(&paired(&other.mse, &self.current.mse, &self.current.samples, judged.floor()), own - its)
        } else {
            better(&paired(&self.current.mse, &other.mse, &other.samples, judged.floor()), its - own)
                && Gap::of(self.data, other).below(&self.gap)
        }
    }

    fn go_on_with(&mut self, fit: Fit) {
        self.gap = Gap::of(self.data, &fit);
        self.current = fit;
    }

    /// The verdict, and all that goes with it.
    pub(super) fn end(mut self) -> Ended {
        let (base, base_gap) = self.base.clone();
        if let Some(harm) = self.withdrawal() {
            let names: Vec<&str> = self.named.iter().map(|n| n.effect.kind.name()).collect();
            self.remarks.push(format!("{} would {harm}: not named", names.join(" and ")));
            (self.current, self.gap) = (base.clone(), base_gap);
            self.named.clear();
            self.ladder.truncate(1);
            self.tie = None;
        }
        let explained = self.explained();
        let mut named: Vec<NamedEffect> = self.named.into_iter().map(|named| named.effect).collect();
        let kinds: Vec<Kind> = named.iter().map(|effect| effect.kind).collect();
        let errors = self.data.problem().covariance(&self.current);
        for (j, effect) in named.iter_mut().enumerate() {
            // What is named beside it was no rival.
            effect.rivals.retain(|rival| !kinds.contains(&rival.kind));
            let place = base.candidate.effects.len() + j;
            effect.parameters = parameters(&self.current.candidate, place, Some(&errors), self.units);
        }
        Ended {
            verdict: match (named.is_empty(), base_gap.real(), explained) {
                (true, false, _) => Verdict::NothingMissing,
                (true, true, _) => Verdict::Unknown,
                (false, _, true) => Verdict::Explained,
                (false, _, false) => Verdict::PartlyExplained,
            },
            fit: self.current,
            errors,
            named,
            ladder: self.ladder,
            first_round: self.first_round,
            closest: self.closest,
            tie: self.tie.filter(|tie| !tie.kinds.iter().all(|kind| kinds.contains(kind))),
            remarks: self.remarks,
        }
    }
}

pub(super) fn rung(data: &Data, fit: &Fit) -> Rung {
    let score = data.over(&data.score).score(&fit.candidate);
    let (square, count) = open_loop_squares(data, &data.open_loop, fit)
        .iter()
        .fold((0.0, 0), |sum, (square, n)| (sum.0 + square, sum.1 + n));
    Rung {
        effects: fit.candidate.effects.iter().map(|e| e.kind).collect(),
        base: fit.candidate.base,
        fit_rmse: root_mean(&fit.mse),
        holdout_rmse: root_mean(&score),
        holdout_open_loop_rmse: (square / count.max(1) as f64).sqrt(),
    }
}
