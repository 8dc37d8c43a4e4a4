//! Drop and swap: an effect of a model is compared with nothing, and with what it may be confused with, beside the
//! others.

use std::cmp::Ordering;
use std::sync::Arc;

use breakaway_core::plant::{Effect, Kind};

use super::Search;
use super::add::{Round, add};
use super::compare::{as_good, better, gain, has_body};
use super::descend::LAST_ITERATIONS;
use super::incumbent::Incumbent;
use super::node::Node;
use crate::discover::data::Data;
use crate::discover::gap::Gap;
use crate::discover::model::Model;
use crate::fit::Fit;

/// Most changes of a model for each of its effects.
const CHANGES: usize = 2;

/// The effects that may stand in the place of `kind`. Either may be confused with the other, or is a special case of
/// the other. A model at the noise gives no place to a second body, or to a law that has `kind` as a special case. They
/// would only fit the noise.
pub(in crate::discover) fn confusable(kind: Kind, at_the_noise: bool) -> Vec<Kind> {
    let confused = |a: Kind, b: Kind| a.definition().confused_with.contains(&b.name());
    let comes_in = |other: Kind| {
        let alike =
            confused(kind, other) || confused(other, kind) || kind.generalises(other) || other.generalises(kind);
        let idle = (other.second_body() && !kind.second_body()) || other.generalises(kind);
        other != kind && alike && !(at_the_noise && idle)
    };
    Kind::ALL.iter().copied().filter(|other| comes_in(*other)).collect()
}

impl Search<'_> {
    /// The effects tried in the place of the `j`-th added one, beside the others; `None` where the model without it has
    /// no fit.
    pub(super) fn contested(&self, node: &Node, j: usize) -> Option<Arc<Round>> {
        if let Some(Some(round)) = node.contests.get(j) {
            return Some(round.clone());
        }
        let without = if node.added() == 1 {
            self.base.fit.clone()
        } else {
            let model = node.model().without(self.known + j);
            model.fit(&self.data.problem(), Some(&node.fit.initial), LAST_ITERATIONS).ok()?
        };
        let kinds = confusable(node.kinds()[j], !node.gap.something_left());
        let incumbent = Incumbent { fit: &node.fit, place: self.known + j };
        add(self.data, &without, (&kinds, &|| ()), Some(incumbent), self.rotary).map(Arc::new)
    }

    /// The model without the effects that the others can do without. An effect is also exchanged for another that does
    /// better, or that does as well and is simpler.
    pub(super) fn improved(&self, mut node: Node) -> Node {
        for _ in 0..CHANGES * node.added() {
            if self.is_exhausted() {
                break;
            }
            let Some(changed) = self.changed(&mut node) else { break };
            node = changed;
        }
        node
    }

    fn changed(&self, node: &mut Node) -> Option<Node> {
        for j in (0..node.added()).rev() {
            if self.is_decided(node.kinds()[j]) {
                continue;
            }
            let Some(round) = self.contested(node, j) else { continue };
            node.contests[j] = Some(round.clone());
            let name = node.kinds()[j].name();
            let extra = node.fit.free.len().saturating_sub(round.without.free.len());
            if node.added() > 1 && !better(&gain(&round.data, &round.without, &node.fit), extra) {
                let rest = Node::new(self.data, round.without.clone(), self.known);
                return Some(rest.after(node, format!("beside the others, nothing is left of {name}")));
            }
            if let Some((other, how)) = self.exchanged(node, &round, node.kinds()[j]) {
                let new = other.kinds().last().map_or("", |kind| kind.name());
                let remark = format!("{new} does {how} {name}");
                return Some(other.after(node, remark));
            }
        }
        None
    }

    /// The model with another effect of the round in the place of `own`; `None` where none does better or as well.
    fn exchanged(&self, node: &Node, round: &Arc<Round>, own: Kind) -> Option<(Node, &'static str)> {
        let sought = round.tried.iter().enumerate().filter(|(_, tried)| !self.is_decided(tried.kind));
        for (index, tried) in sought.filter(|(_, tried)| tried.kind != own) {
            let Ok(fit) = &tried.fit else { continue };
            if simpler(round, node, fit) {
                return Some((Node::of(self.data, round, index, self.known)?, "as well as"));
            }
            let extra = fit.free.len().saturating_sub(node.fit.free.len());
            if better(&gain(&round.data, &node.fit, fit), extra) && Gap::of(self.data, fit).below(&node.gap) {
                return Some((Node::of(self.data, round, index, self.known)?, "better than"));
            }
        }
        None
    }
}

/// Whether `fit` is tied with the node's and simpler: with no second body where that has one, or with fewer parameters.
/// Of two that are as simple the more likely one is taken.
fn simpler(round: &Round, node: &Node, fit: &Fit) -> bool {
    let key = |fit: &Fit| (has_body(fit), fit.free.len());
    match key(fit).cmp(&key(&node.fit)) {
        Ordering::Less => as_good(&round.data, fit, &node.fit),
        Ordering::Equal => gain(&round.data, &node.fit, fit).lambda > 0.0,
        Ordering::Greater => false,
    }
}

/// The result of another effect in the place of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::discover) enum Standing {
    /// The recordings bear it out rather than that.
    Better,
    /// They do not tell the two apart.
    AsGood,
}

/// The effects of `kinds` that do as well in the place of the `j`-th effect of a fit, or better. They are in the order
/// of their costs; there are none where nothing can be fitted. The recordings determine the parameters of each.
pub(in crate::discover) fn stand_ins(data: &Data, fit: &Fit, j: usize, kinds: &[Kind]) -> Vec<(Effect<f64>, Standing)> {
    let Ok(without) = Model::of(fit).without(j).fit(&data.problem(), Some(&fit.initial), LAST_ITERATIONS) else {
        return Vec::new();
    };
    // An effect that needs an angle is left to the judge, which can weigh it.
    let Some(round) = add(data, &without, (kinds, &|| ()), Some(Incumbent { fit, place: j }), false) else {
        return Vec::new();
    };
    let standing = |own: &Fit| {
        let extra = own.free.len().saturating_sub(fit.free.len());
        if better(&gain(&round.data, fit, own), extra) {
            Some(Standing::Better)
        } else {
            as_good(&round.data, own, fit).then_some(Standing::AsGood)
        }
    };
    let tried = round.tried.iter().filter_map(|tried| {
        let own = tried.fit.as_ref().ok()?;
        let standing = standing(own)?;
        let determined = data.problem().covariance(own).determined();
        determined.then_some((*own.candidate.effects.last()?, standing))
    });
    tried.collect()
}
