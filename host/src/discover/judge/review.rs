//! The review of the final model: each of its terms is weighed beside all others. A term that no longer gains is
//! dropped, and ties are decided.

use breakaway_core::plant::Kind;
use rayon::prelude::*;

use super::evidence::{Bar, Rejection};
use super::library::Library;
use super::search::{Bearing, Stage, Tried, best_of_each, tied};
use super::sides::Model;
use super::term::Name;

/// Share of an effect's gain from which a rival is near enough for its parameters to be sought.
const NEAR: f64 = 0.5;

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
        let rivals = rivals(&beside, own, &before, tried.gain);
        let as_well: Vec<&Tried> = tied(&tried, &rivals, stage.settings).collect();
        // A law fits no worse than its special cases. It is named only where it fits better.
        let special = as_well.iter().filter(|rival| rival.rejection().is_none());
        let special = special.filter(|rival| kind(rival).is_some_and(|kind| own.generalises(kind)));
        let named = *special.max_by(|a, b| a.gain.total_cmp(&b.gain)).unwrap_or(&&tried);
        let others = as_well.iter().copied().chain([&tried]).filter(|other| kind(other) != kind(named));
        bearings[j].tied = others.filter_map(|other| Some((kind(other)?, named.better_than(other)))).collect();
        if kind(named) != Some(own) {
            bearings[j].evidence = named.evidence[0];
            let mut model = stage.model.clone();
            model.terms[j] = named.terms[0].clone();
            stage = Stage::new(stage.form, stage.settings, model, &stage.weights)?;
        }
        j += 1;
    }
    Some(stage)
}

/// The effect of a single term; `None` for a decoy.
fn kind(tried: &Tried) -> Option<Kind> {
    match tried.terms[0].name {
        Name::Effect(kind) => Some(kind),
        Name::Decoy(_) => None,
    }
}

/// The model without its `j`-th term.
fn without<'a>(stage: &Stage<'a>, j: usize) -> Option<Stage<'a>> {
    let terms = stage.model.terms.iter().enumerate().filter(|(i, _)| *i != j);
    let model = Model { terms: terms.map(|(_, term)| term.clone()).collect() };
    Stage::new(stage.form, stage.settings, model, &stage.weights)
}

/// The effects that may be confused with `own`, and those that did as well `before`. Each is tried beside the other
/// terms. Those that gain half of `gain` or more get the parameters that gain most, as `own` did.
fn rivals(beside: &Stage<'_>, own: Kind, before: &[Kind], gain: f64) -> Vec<Tried> {
    let confused = |a: Kind, b: Kind| a.definition().confused_with.contains(&b.name());
    let rival = |kind| kind != own && (confused(own, kind) || confused(kind, own) || before.contains(&kind));
    let library = Library::new(beside.form, &beside.model, &beside.fitted, &beside.weights);
    let rivals = library.of_effects(rival).into_par_iter().filter(|term| matches!(term.name, Name::Effect(_)));
    let rivals = best_of_each(rivals.filter_map(|term| beside.weighed(term, &Bar::OPEN)).collect(), beside.settings);
    let tuned = |rival: Tried| {
        let near = rival.gain > NEAR * gain;
        near.then(|| beside.tuned(&rival.terms[0])).flatten().unwrap_or(rival)
    };
    rivals.into_par_iter().map(tuned).collect()
}
