//! The review of the final model: each of its terms is weighed beside all others. A term that no longer gains is
//! dropped, and ties are decided.

use breakaway_core::plant::Kind;
use rayon::prelude::*;

use super::evidence::{Bar, Rejection};
use super::library::Library;
use super::search::{Bearing, Stage, Tried, best_of_each, tied};
use super::sides::Model;
use super::term::Name;

/// The stage with the terms that gain in the final model. `bearings` keeps one entry for each, with its ties.
pub(super) fn reviewed<'a>(mut stage: Stage<'a>, bearings: &mut Vec<Bearing>) -> Option<Stage<'a>> {
    let mut j = 0;
    while j < stage.model.terms.len() {
        let Name::Effect(own) = stage.model.terms[j].name else { return Some(stage) };
        let beside = without(&stage, j)?;
        let tried = beside.weighed(stage.model.terms[j].clone(), &Bar::OPEN);
        let alone = stage.model.terms.len() == 1;
        let Some(tried) = tried.filter(|tried| alone || tried.rejection() != Some(Rejection::Gain)) else {
            bearings.remove(j);
            (stage, j) = (beside, 0);
            continue;
        };
        let before: Vec<Kind> = bearings[j].tied.iter().map(|(kind, _)| *kind).collect();
        let rivals = rivals(&beside, own, &before);
        let as_well = tied(&tried, &rivals, stage.settings).filter_map(|rival| match rival.terms[0].name {
            Name::Effect(kind) => Some((kind, tried.better_than(rival))),
            Name::Decoy(_) => None,
        });
        bearings[j].tied = as_well.collect();
        j += 1;
    }
    Some(stage)
}

/// The model without its `j`-th term.
fn without<'a>(stage: &Stage<'a>, j: usize) -> Option<Stage<'a>> {
    let terms = stage.model.terms.iter().enumerate().filter(|(i, _)| *i != j);
    let model = Model { terms: terms.map(|(_, term)| term.clone()).collect() };
    Stage::new(stage.form, stage.settings, model, &stage.weights)
}

/// The effects that may be confused with `own`, and those that did as well `before`. Each is tried beside the other
/// terms.
fn rivals(beside: &Stage<'_>, own: Kind, before: &[Kind]) -> Vec<Tried> {
    let confused = |a: Kind, b: Kind| a.definition().confused_with.contains(&b.name());
    let rival = |kind| kind != own && (confused(own, kind) || confused(kind, own) || before.contains(&kind));
    let library = Library::new(beside.form, &beside.model, &beside.fitted, &beside.weights);
    let rivals = library.of_effects(rival).into_par_iter().filter(|term| matches!(term.name, Name::Effect(_)));
    best_of_each(rivals.filter_map(|term| beside.weighed(term, &Bar::OPEN)).collect(), beside.settings)
}
