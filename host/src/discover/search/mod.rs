//! A beam search over models on the simulated motion. Its moves add an effect, drop one, swap one for another, or
//! refine one.

mod add;
mod compare;
mod contest;
mod descend;
mod end;
mod halving;
mod incumbent;
mod node;
mod plausible;
mod refine;
mod table;
#[cfg(test)]
mod tests;
mod validate;

use std::sync::Arc;
use std::sync::atomic::Ordering;

use breakaway_core::plant::Kind;

use super::data::Data;
use super::judge::library::tells;
use super::model::Model;
use super::progress::{Progress, Watch};
use super::ruled::radians;
use crate::fit::{Fit, median};
use crate::recording::Units;
use add::{Round, add};
use compare::{NAMING, has_body};
use node::Node;

pub(super) use contest::{Standing, confusable, stand_ins};
pub(super) use descend::{fit_softly, settled};
pub(super) use end::{Ended, Tie, rung};
pub(super) use table::parameters;

/// Models that are kept from one depth to the next.
const BEAM: usize = 2;
/// Most effects added in one discovery.
const MAX_ADDED: usize = 3;
/// Simulated numbers after which a search tries no further effect. A sample counts once for each sub-step; with
/// derivatives, as many times more as its numbers are longer. So many take about 20 s of a core. A round of all effects
/// takes half.
const MOST_WORK: u64 = 400_000_000;
/// Multiple of [`MOST_WORK`] after which effects are not dropped or swapped either. The model is then from the round
/// before the bound.
const LAST_WORK: u64 = 2;
/// Iterations of the model that a search starts from.
const ITERATIONS: usize = 20;

/// A model to begin with.
pub(super) struct Beginning {
    pub model: Model,
    /// Whether the simulated motion bears out its effects. Otherwise models are grown from the base too.
    pub borne_out: bool,
}

/// The data and the state of a search.
pub(super) struct Search<'a> {
    data: &'a Data,
    units: &'a Units,
    base: Node,
    /// The effects that may be added.
    kinds: &'a [Kind],
    /// Effects of the base that were given.
    known: usize,
    /// Whether the position is an angle.
    rotary: bool,
    /// The first round: the effects beside the base.
    first: Option<Arc<Round>>,
    remarks: Vec<String>,
}

impl<'a> Search<'a> {
    pub(super) fn new(data: &'a Data, units: &'a Units, base: Fit, kinds: &'a [Kind]) -> Self {
        let known = base.candidate.effects.len();
        let rotary = radians(units).is_some();
        Self { data, units, base: Node::new(data, base, known), kinds, known, rotary, first: None, remarks: Vec::new() }
    }

    /// Whether so much was simulated that no further effect is tried.
    fn is_spent(&self) -> bool {
        self.data.work.load(Ordering::Relaxed) > MOST_WORK
    }

    /// Whether so much was simulated that a model is left as it is. Nothing is dropped or swapped any more.
    fn is_exhausted(&self) -> bool {
        self.data.work.load(Ordering::Relaxed) > LAST_WORK * MOST_WORK
    }

    /// Whether the measured forces have decided on an effect: they tell it, and it is not among those that are sought.
    /// It is neither dropped nor swapped nor doubted then. Beside an effect that is still missing, the motion may not
    /// tell it.
    fn is_decided(&self, kind: Kind) -> bool {
        tells(kind) && !self.kinds.contains(&kind)
    }

    /// Searches, and names a model. Models are grown from `start`; and from the base, where there is no start, or where its
    /// effects are in doubt.
    pub(super) fn run(mut self, start: Option<&Beginning>, progress: Watch<'_>) -> Ended {
        let added = start.map_or(&[][..], |start| &start.model.effects[self.known..]);
        let decided = added.iter().any(|effect| self.is_decided(effect.kind));
        let begun = start.and_then(|start| self.begun(&start.model, progress));
        // Beside an effect that is still missing, the motion may not gain by what the forces have decided.
        let begun = begun.filter(|node| decided || node.gap.below(&self.base.gap));
        let mut beam: Vec<Node> = begun.into_iter().collect();
        let mut visited = beam.clone();
        let enough = |node: &Node| start.is_some_and(|start| start.borne_out) || node.explained(&self.base.gap);
        if !decided && !beam.iter().any(enough) {
            beam.push(self.base.clone());
        }
        for _ in 0..MAX_ADDED {
            let mut pool = self.grown(&beam, progress);
            // A dropped effect may lead a fit out of a narrow valley. The model that was there before takes the better
            // fit.
            for node in &pool {
                let old = visited.iter_mut().find(|old| old.same_kinds(node) && node.fit.cost < old.fit.cost);
                if let Some(old) = old {
                    *old = node.clone();
                }
            }
            pool.retain(|node| !visited.iter().any(|other| other.same_kinds(node)));
            beam = self.best(pool);
            visited.extend(beam.iter().cloned());
        }
        self.end(visited, progress)
    }

    /// All models that grow out of the beam. Where those of its first model explain the recordings, the second is left
    /// alone. The base is always tried; another model is tried only within the bound of work.
    fn grown(&mut self, beam: &[Node], progress: Watch<'_>) -> Vec<Node> {
        let mut pool: Vec<Node> = Vec::new();
        for parent in beam {
            let at_the_noise = parent.added() > 0 && !parent.gap.something_left();
            if parent.added() == MAX_ADDED || at_the_noise {
                continue;
            }
            if parent.added() > 0 && self.is_spent() {
                let remark = "beside what was found no further effect was sought: the search is at its bound of work";
                self.remarks.push(remark.to_owned());
                break;
            }
            progress(Progress::Round { effect: parent.added() + 1, candidates: self.kinds.len() });
            pool.extend(self.children(parent, progress));
            if pool.iter().any(|node| node.explained(&self.base.gap)) {
                break;
            }
        }
        pool
    }

    /// The model to begin with, fitted and improved; `None` where it cannot be simulated, or where nothing is left of it.
    fn begun(&self, model: &Model, progress: Watch<'_>) -> Option<Node> {
        progress(Progress::Step("fitting the simulated motion"));
        let problem = self.data.problem();
        let fit = model.fit(&problem, None, ITERATIONS).ok()?;
        let fit = descend::converged(self.data, &fit);
        plausible::resolved(self.data, &fit.candidate, &fit.candidate.effects).ok()?;
        let fit = refine::refined(self.data, fit, false, self.rotary);
        let node = Node::new(self.data, settled(self.data, fit), self.known);
        let node = self.improved(node);
        (node.added() > 0).then_some(node)
    }

    /// The models with one effect more: the preferred one, and the one that most segments bear out. A second missing
    /// effect may spoil the right one on held-out data. So both stay in the beam.
    fn children(&mut self, parent: &Node, progress: Watch<'_>) -> Vec<Node> {
        let compared = || progress(Progress::Compared);
        let Some(round) = add(self.data, &parent.fit, (self.kinds, &compared), None, self.rotary).map(Arc::new) else {
            return Vec::new();
        };
        if parent.added() == 0 {
            self.first = Some(round.clone());
        }
        let mut children: Vec<Node> = Vec::new();
        let mut refused = None;
        for index in round.preference() {
            let Some(node) = self.child(parent, &round, index) else { continue };
            if parent.gap.refuses(&node.gap).is_none() {
                let explained = node.explained(&self.base.gap);
                children.push(node);
                if explained {
                    return children;
                }
                break;
            }
            refused = refused.or(Some(node));
        }
        let first = children.first().or(refused.as_ref());
        let Some(named) = first.and_then(|node| node.kinds().last().copied()) else { return children };
        let other = round.second(named).and_then(|index| self.child(parent, &round, index));
        children.extend(other);
        if children.len() < BEAM {
            children.extend(refused);
        }
        children
    }

    /// A model of a round, improved. The effects tried in the place of its last one are kept. `None` where nothing
    /// added is left.
    fn child(&self, parent: &Node, round: &Arc<Round>, index: usize) -> Option<Node> {
        let node = Node::of(self.data, round, index, self.known)?;
        if parent.added() == 0 {
            return Some(node);
        }
        let node = self.improved(node);
        (node.added() > 0).then_some(node)
    }

    /// The best models of a pool, each of other effects. Models at the noise come first, then those without a second
    /// body, whose starts follow whatever is missing. The rest is by the likelihood less its price.
    fn best(&self, mut pool: Vec<Node>) -> Vec<Node> {
        let left = pool.iter().map(|node| median(node.fit.mse.clone())).fold(f64::INFINITY, f64::min);
        let data = self.data.softened(if left.is_finite() { left } else { 0.0 });
        let rank = |node: &Node| (!node.explained(&self.base.gap), has_body(&node.fit));
        let cost = |node: &Node| data.problem().cost_of(&node.fit.mse) + NAMING.price * node.fit.free.len() as f64;
        pool.sort_by(|a, b| rank(a).cmp(&rank(b)).then(cost(a).total_cmp(&cost(b))));
        let mut best: Vec<Node> = Vec::new();
        for node in pool {
            if best.len() < BEAM && !best.iter().any(|other| other.same_kinds(&node)) {
                best.push(node);
            }
        }
        best
    }
}
