//! A node of the beam: a model, its fit, and its error on held-out data. It keeps what was tried in the place of its
//! effects.

use std::sync::Arc;

use breakaway_core::plant::Kind;

use super::add::Round;
use super::descend::{converged, settled};
use super::refine::along_levels;
use crate::discover::data::Data;
use crate::discover::gap::Gap;
use crate::discover::model::Model;
use crate::fit::Fit;

/// A model of the beam.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub fit: Fit,
    pub gap: Gap,
    /// What was tried in the place of every added effect; `None` where nothing was tried yet.
    pub contests: Vec<Option<Arc<Round>>>,
    /// Effects that were dropped from it and exchanged in it, in words.
    pub remarks: Vec<String>,
}

impl Node {
    /// A model whose added effects were not compared with others yet. The first `known` effects never are.
    pub(super) fn new(data: &Data, fit: Fit, known: usize) -> Self {
        let contests = vec![None; fit.candidate.effects.len() - known];
        Self { gap: Gap::of(data, &fit), fit, contests, remarks: Vec::new() }
    }

    /// The model of a round with its effect `index`, iterated to the end. Its levels are sought where it leaves
    /// something.
    pub(super) fn of(data: &Data, round: &Arc<Round>, index: usize, known: usize) -> Option<Self> {
        let fit = round.tried[index].fit.as_ref().ok()?;
        let end = |fit: &Fit| settled(data, converged(&round.data, fit));
        let mut node = Self::new(data, end(fit), known);
        if node.gap.something_left()
            && let Some(fit) = along_levels(&round.data, &node.fit)
        {
            node = Self::new(data, end(&fit), known);
        }
        if let Some(last) = node.contests.last_mut() {
            *last = Some(round.clone());
        }
        Some(node)
    }

    /// The node that replaces `old`, with the reason.
    pub(super) fn after(mut self, old: &Self, remark: String) -> Self {
        self.remarks.clone_from(&old.remarks);
        self.remarks.push(remark);
        self
    }

    pub(super) fn model(&self) -> Model {
        Model::of(&self.fit)
    }

    /// Effects that were added.
    pub(super) fn added(&self) -> usize {
        self.contests.len()
    }

    /// Kinds of the effects that were added, in order.
    pub(super) fn kinds(&self) -> Vec<Kind> {
        let known = self.fit.candidate.effects.len() - self.added();
        self.fit.candidate.effects[known..].iter().map(|effect| effect.kind).collect()
    }

    /// Whether both have the same effects.
    pub(super) fn same_kinds(&self, other: &Self) -> bool {
        let sorted = |node: &Self| {
            let mut kinds = node.kinds();
            kinds.sort_unstable();
            kinds
        };
        sorted(self) == sorted(other)
    }

    /// Whether the model is down to the noise. `base` is the gap of the model without the added effects.
    pub(super) fn explained(&self, base: &Gap) -> bool {
        if self.kinds().iter().any(|kind| kind.second_body()) {
            base.explained_by_bodies(&self.gap)
        } else {
            self.gap.explained()
        }
    }
}
