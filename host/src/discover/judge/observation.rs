//! The search with the direction of the friction that a friction observer gives beside what was found. The observer is told
//! the drive, and may hold an effect of the drive itself. So a name must gain with the velocity's own direction too.

use super::bar::Bar;
use super::evidence::Rejection;
use super::outcome::Outcome;
use super::search::{Judged, Stage, judge, share};
use super::settings::Settings;
use super::sides::Model;
use super::term::{Name, Term};
use super::tried::Tried;
use super::weak_form::WeakForm;
use super::weights::Weights;

/// Most times that the direction of the friction is found anew.
const OBSERVATIONS: usize = 3;
/// Share to which a new direction must bring the residual force, for the search to begin anew with it.
const CONVERGED: f64 = 0.95;
/// Least z, on the side that tells less, of a name in the windows of another direction of the friction.
const OTHER_DIRECTION_Z: f64 = 2.0;

impl Judged {
    /// Ties each name with what it was tied with in another search, unless that is named here.
    fn keep_ties(&mut self, other: &Self) {
        let names: Vec<Name> = self.model.terms.iter().map(|term| term.name).collect();
        for (name, bearing) in names.iter().zip(&mut self.bearings) {
            let own = other.model.terms.iter().zip(&other.bearings).find(|(term, _)| term.name == *name);
            for (kind, lead) in own.map_or(&[][..], |(_, own)| &own.tied) {
                let known = bearing.tied.iter().any(|(tied, _)| tied == kind) || names.contains(&Name::Effect(*kind));
                if !known {
                    bearing.tied.push((*kind, *lead));
                }
            }
        }
    }
}

/// The windows and what was found in them, with the direction of the friction that the found model gives. A reversal and a
/// rest are blurred by the velocity of the positions alone. The search begins anew where the found model leaves less with
/// the new direction, or where a name gains with the old direction alone.
pub(super) fn observed<'a>(form: WeakForm<'a>, own: Judged, settings: &Settings) -> (WeakForm<'a>, Judged) {
    let (mut best_form, mut best) = (None, own);
    for _ in 0..OBSERVATIONS {
        let latest = best_form.as_ref().unwrap_or(&form);
        let Some(observed) = latest.observed(&best.model, &best.fitted) else { break };
        let doubted = !gains_in(&observed, &best.model, settings);
        let refitted = best.model.refitted(&observed, settings).map(|fitted| share(&observed, &fitted)[0]);
        if !doubted && refitted.is_none_or(|refitted| refitted > CONVERGED * best.residual[1][0]) {
            break;
        }
        let Some(mut again) = judge(&observed, settings) else { break };
        again.keep_ties(&best);
        if !(doubted || takes_the_place(&again, &best)) || !gains_in(&form, &again.model, settings) {
            break;
        }
        (best_form, best) = (Some(observed), again);
    }
    (best_form.unwrap_or(form), best)
}

/// Whether what was found with a new direction takes the place of what was found before. It must leave no more, and still
/// name something. What can be predicted without a name must be so with either direction.
fn takes_the_place(again: &Judged, before: &Judged) -> bool {
    let names = |judged: &Judged| !judged.model.terms.is_empty();
    let unknown =
        |judged: &Judged| judged.rounds.last().is_some_and(|last| matches!(last.outcome, Outcome::Unknown(_)));
    again.residual[1][0] <= before.residual[1][0]
        && names(again) >= names(before)
        && (names(again) || unknown(again) <= unknown(before))
}

/// Whether each term of a model gains in other windows too, beside the others.
fn gains_in(form: &WeakForm<'_>, model: &Model, settings: &Settings) -> bool {
    if model.terms.is_empty() {
        return true;
    }
    let Some(base) = Stage::new(form, settings, Model::default(), &Weights::equal(form)) else { return false };
    let library = base.library();
    let terms: Vec<Term> = model
        .terms
        .iter()
        .map(|term| {
            let parameters: Vec<f64> = term.parameters.iter().map(|(_, value)| *value).collect();
            library.remade(term, &parameters).unwrap_or_else(|| term.afresh())
        })
        .collect();
    (0..terms.len()).all(|j| {
        let others = terms.iter().enumerate().filter(|(i, _)| *i != j);
        let model = Model { terms: others.map(|(_, term)| term.clone()).collect() };
        let beside = Stage::new(form, settings, model, &base.weights);
        let tried = beside.and_then(|beside| beside.weighed(terms[j].clone(), &Bar::OPEN));
        let possible = |tried: &Tried| matches!(tried.rejection(), None | Some(Rejection::Gain));
        tried.is_some_and(|tried| possible(&tried) && tried.gain > 0.0 && tried.evidence[0].z() > OTHER_DIRECTION_Z)
    })
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::super::bar::tests::Axis;
    use super::super::dataset::Dataset;
    use super::*;

    /// A drag that the axis has gains in any windows, and a spring that it has not gains in none.
    #[test]
    fn what_is_there_gains_with_either_direction() {
        let settings = Settings::default();
        let recordings = [Axis { f1: 0.1, drag: 0.01, load: 0.0, seed: 1 }.recording()];
        let dataset = Dataset::new(&recordings, &settings);
        let form = WeakForm::new(&dataset, 0.03, &settings).unwrap();
        let base = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let observed = form.observed(&base.model, &base.fitted).unwrap();
        let of = |kind: Kind| Model::default().with(&base.library().of_effects(|own| own == kind).swap_remove(0));
        for form in [&form, &observed] {
            let gains = [Kind::QuadraticDrag, Kind::Spring].map(|kind| gains_in(form, &of(kind), &settings));
            assert_eq!(gains, [true, false]);
        }
    }
}
