//! The end of a search: the named model, its ladder and its rivals.

use breakaway_core::plant::Kind;

use super::Search;
use super::descend::LAST_ITERATIONS;
use super::node::Node;
use super::table::{nearest, parameters, rivals, table};
use crate::discover::data::Data;
use crate::discover::gap::{Gap, open_loop_squares, root_mean};
use crate::discover::outcome::{CandidateRow, NamedEffect, Rival, Rung, Verdict};
use crate::discover::progress::{Progress, Watch};
use crate::discover::{drive_free, force_residual};
use crate::fit::{Covariance, Fit};

/// Two fits that the recordings do not tell apart.
pub(in crate::discover) struct Tie {
    pub a: Fit,
    pub b: Fit,
    pub kinds: [Kind; 2],
}

/// The result of a search.
pub(in crate::discover) struct Ended {
    pub verdict: Verdict,
    pub fit: Fit,
    pub errors: Covariance,
    pub named: Vec<NamedEffect>,
    pub ladder: Vec<Rung>,
    /// The fate of every effect beside the base; empty where the search began with a model at the noise.
    pub first_round: Vec<CandidateRow>,
    /// The effect that came closest beside the base, in words.
    pub closest: Option<String>,
    pub tie: Option<Tie>,
    pub remarks: Vec<String>,
}

impl Search<'_> {
    /// Names the best of the visited models.
    pub(super) fn end(mut self, visited: Vec<Node>, progress: Watch<'_>) -> Ended {
        progress(Progress::Step("checking the model on held-out data"));
        let node = self.chosen(visited);
        self.remarks.extend(node.remarks.iter().cloned());
        let kinds = node.kinds();
        let errors = self.data.problem().covariance(&node.fit);
        let mut tie = None;
        let named: Vec<NamedEffect> = (0..node.added())
            .map(|j| {
                let rivals = self.rivals(&node, j, &mut tie);
                let parameters = parameters(&node.fit.candidate, self.known + j, Some(&errors), self.units);
                NamedEffect { kind: kinds[j], parameters, rivals }
            })
            .collect();
        let ladder = self.ladder(&node);
        let first = self.first.as_deref();
        let (first_round, closest) = first.map_or_else(Default::default, |round| {
            (
                table(round, kinds.first().copied(), named.first().map_or(&[], |own| &own.rivals)),
                nearest(round, self.units),
            )
        });
        Ended {
            verdict: match (named.is_empty(), self.base.gap.real(), node.explained(&self.base.gap)) {
                (true, false, _) => Verdict::NothingMissing,
                (true, true, _) => Verdict::Unknown,
                (false, _, true) => Verdict::Explained,
                (false, _, false) => Verdict::PartlyExplained,
            },
            fit: node.fit,
            errors,
            named,
            ladder,
            first_round,
            closest,
            tie,
            remarks: self.remarks,
        }
    }

    /// The rivals of effect `j` of the final model, beside its others. One that is tied must hold on the held-out data
    /// too. An effect on which the forces have decided has the rivals that they give it.
    fn rivals(&self, node: &Node, j: usize, tie: &mut Option<Tie>) -> Vec<Rival> {
        if self.is_decided(node.kinds()[j]) {
            return Vec::new();
        }
        let Some(round) = self.contested(node, j) else { return Vec::new() };
        let (own, kinds) = (node.kinds()[j], node.kinds());
        let before = if node.added() == 1 { self.base.gap } else { Gap::of(self.data, &round.without) };
        let fit_of = |kind: Kind| round.tried.iter().find(|t| t.kind == kind).and_then(|t| t.fit.as_ref().ok());
        let mut rivals = rivals(&round, &node.fit, own);
        rivals.retain(|rival| {
            let beside = kinds.contains(&rival.kind);
            let holds = |fit: &Fit| before.refuses(&Gap::of(self.data, fit)).is_none();
            !beside && (!rival.tied || fit_of(rival.kind).is_some_and(holds))
        });
        if let Some(other) = rivals.iter().find(|rival| rival.tied)
            && let Some(fit) = fit_of(other.kind)
        {
            *tie = Some(Tie { a: node.fit.clone(), b: fit.clone(), kinds: [own, other.kind] });
        }
        rivals
    }

    /// The base, and the model effect by effect.
    fn ladder(&self, node: &Node) -> Vec<Rung> {
        let mut ladder = vec![rung(self.data, &self.base.fit)];
        let model = node.model();
        for count in 1..node.added() {
            let part = model.truncated(self.known + count).fit(&self.data.problem(), None, LAST_ITERATIONS);
            ladder.extend(part.map(|fit| rung(self.data, &fit)));
        }
        if node.added() > 0 {
            ladder.push(rung(self.data, &node.fit));
        }
        ladder
    }
}

/// A rung of the ladder.
pub(in crate::discover) fn rung(data: &Data, fit: &Fit) -> Rung {
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
        force_residual: force_residual::shares(data, &fit.candidate),
        drive_free_rmse: drive_free::error(data),
    }
}
