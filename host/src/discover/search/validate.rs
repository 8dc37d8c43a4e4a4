//! The conditions on data that were not fitted, under which the effects of a model are named.

use std::cell::OnceCell;

use super::Search;
use super::compare::{names, names_further};
use super::node::Node;
use super::plausible::resolved;
use crate::discover::gap::{Gap, LEAST_TOTAL};

/// Why a model is not named.
pub(super) enum Refusal {
    /// One of its effects is not named: which, and why.
    Effect(usize, String),
    /// None of its effects is named.
    Model(&'static str),
}

impl Search<'_> {
    /// Why the effects of a model are not named; `None` if they are. Each of them must hold beside the others, but those
    /// on which the forces have decided.
    pub(super) fn refusal(&self, node: &mut Node) -> Option<Refusal> {
        let determined = OnceCell::new();
        for j in (0..node.added()).rev() {
            if self.is_decided(node.kinds()[j]) {
                continue;
            }
            let round = self.contested(node, j)?;
            node.contests[j] = Some(round.clone());
            let before = if node.added() == 1 { self.base.gap } else { Gap::of(self.data, &round.without) };
            // Real impacts leave something beside idealised ones, which looks like many an effect.
            let impacts = node.kinds().iter().enumerate().any(|(i, kind)| i != j && kind.gap().is_some());
            let further =
                || !impacts && !before.only_outliers() && names_further(&round.data, &round.without, &node.fit);
            let place = self.known + j;
            let own = node.fit.candidate.effects.get(place..=place).unwrap_or_default();
            // What grew beside an effect, and the last iterations, may have moved it beyond the recordings since it was tried.
            let unresolved = resolved(self.data, &node.fit.candidate, own).err();
            let reason = if let Some(reason) = before.refuses(&node.gap).or(unresolved) {
                reason
            } else if !*determined.get_or_init(|| self.data.problem().covariance(&node.fit).determined()) {
                "has parameters that the recordings do not determine".to_owned()
            } else if node.kinds()[j].second_body() && !before.followed_by_bodies(&node.gap) {
                "follows short segments from a start free in each, and not the open loop".to_owned()
            } else if node.added() == 1 && !names(&round.data, &round.without, &node.fit) {
                "fits, but most segments do not bear it out".to_owned()
            } else if node.added() > 1 && !further() && !before.closed_by(&node.gap) {
                "lowers the error in a few segments only, and a gap stays".to_owned()
            } else {
                continue;
            };
            return Some(Refusal::Effect(j, reason));
        }
        let base = &self.base.gap;
        if base.leaves(&node.gap, LEAST_TOTAL) {
            return Some(Refusal::Model("leave most of the gap"));
        }
        // The typical segment may become better while diverging segments become worse.
        (!node.gap.shrinks(base)).then_some(Refusal::Model("widen the gap"))
    }

    /// The model that is named, the base if none is. Models at the noise come first, by the number of their effects.
    /// The others are ordered by the logarithmic gap that they leave.
    pub(super) fn chosen(&mut self, mut nodes: Vec<Node>) -> Node {
        let base = self.base.gap;
        while !nodes.is_empty() {
            let key = |node: &Node| (!node.explained(&base), if node.explained(&base) { node.added() } else { 0 });
            let order = |a: &Node, b: &Node| {
                let typical =
                    || if a.gap.below(&b.gap) { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater };
                key(a).cmp(&key(b)).then_with(typical)
            };
            let Some(best) = (0..nodes.len()).min_by(|a, b| order(&nodes[*a], &nodes[*b])) else { break };
            let mut node = nodes.remove(best);
            let names: Vec<&str> = node.kinds().iter().map(|kind| kind.name()).collect();
            match self.refusal(&mut node) {
                None => return node,
                Some(Refusal::Model(harm)) => {
                    self.remarks.push(format!("{} would {harm}: not named", names.join(" and ")));
                }
                Some(Refusal::Effect(j, reason)) => {
                    self.remarks.push(format!("{} {reason}: not named", names[j]));
                    let without = node.contests[j].as_ref().map(|round| round.without.clone());
                    let rest = without.map(|fit| Node::new(self.data, fit, self.known));
                    let fresh = |rest: &Node| rest.added() > 0 && !nodes.iter().any(|other| other.same_kinds(rest));
                    nodes.extend(rest.filter(fresh));
                }
            }
        }
        self.base.clone()
    }
}
