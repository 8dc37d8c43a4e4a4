//! The review of the final model: each of its terms is weighed beside all others. A term that no longer gains is
//! dropped, one that a rival outdoes gives its place to it, and ties are decided.

use breakaway_core::plant::Kind;
use rayon::prelude::*;

use super::bar::Bar;
use super::evidence::Rejection;
use super::library::tells_apart;
use super::outcome::tied;
use super::search::{Bearing, Stage};
use super::sides::Model;
use super::term::Name;
use super::tried::{Tried, best_of_each, rank};

/// Share of an effect's gain from which a rival is near enough for its parameters to be sought.
const NEAR: f64 = 0.5;

/// The stage with the terms that gain in the final model. `bearings` keeps one entry for each, with its ties.
pub(super) fn reviewed<'a>(mut stage: Stage<'a>, bearings: &mut Vec<Bearing>) -> Option<Stage<'a>> {
    let found = stage.model.terms.len();
    stage = backward_elimination(stage, bearings)?;
    loop {
        let laws = |stage: &Stage<'_>| {
            let terms = stage.model.terms.iter();
            terms.map(|term| (term.name, term.own_zeros)).collect::<Vec<_>>()
        };
        let before = laws(&stage);
        for (j, bearing) in bearings.iter_mut().enumerate() {
            stage = with_rivals(stage, j, bearing)?;
        }
        if laws(&stage) == before {
            break;
        }
        // A term may no longer gain beside the rival that took another's place.
        stage = backward_elimination(stage, bearings)?;
        if stage.model.terms.len() == before.len() {
            break;
        }
    }
    if stage.model.terms.len() < found {
        weigh_in_order(&stage, bearings);
    }
    Some(stage)
}

/// Drops terms that no longer gain beside all others, that which gains least first, until each of them gains. The last one
/// stays if it can be fitted.
fn backward_elimination<'a>(mut stage: Stage<'a>, bearings: &mut Vec<Bearing>) -> Option<Stage<'a>> {
    loop {
        let alone = stage.model.terms.len() == 1;
        let mut least: Option<(f64, usize, Stage<'a>)> = None;
        for (j, term) in stage.model.terms.iter().enumerate() {
            let beside = without(&stage, j)?;
            let tried = beside.weighed(term.clone(), &Bar::OPEN);
            let gain = match &tried {
                Some(tried) if alone || tried.rejection() != Some(Rejection::Gain) => continue,
                Some(tried) => tried.gain,
                None => f64::NEG_INFINITY,
            };
            if least.as_ref().is_none_or(|(least, ..)| gain < *least) {
                least = Some((gain, j, beside));
            }
        }
        let Some((_, j, beside)) = least else { break };
        bearings.remove(j);
        stage = beside;
    }
    Some(stage)
}

/// The stage after the rivals of its `j`-th term were tried in the term's place. `bearing` keeps its ties.
fn with_rivals<'a>(stage: Stage<'a>, j: usize, bearing: &mut Bearing) -> Option<Stage<'a>> {
    let Name::Effect(own) = stage.model.terms[j].name else { return Some(stage) };
    let beside = without(&stage, j)?;
    let Some(tried) = beside.weighed(stage.model.terms[j].clone(), &Bar::OPEN) else { return Some(stage) };
    let tried = with_zeros(&beside, tried);
    let before: Vec<Kind> = bearing.tied.iter().map(|(kind, _)| *kind).collect();
    let rivals = rivals(&beside, own, &before, tried.gain);
    let as_well: Vec<&Tried> = tied(&tried, &rivals, &before, stage.settings).collect();
    let tie_z = stage.settings.tie_z;
    let holding = || as_well.iter().copied().filter(|rival| rival.rejection().is_none());
    let best = |a: &&Tried, b: &&Tried| a.gain.total_cmp(&b.gain);
    // A law fits no worse than its special cases. It is named only where it fits better.
    let special = holding().filter(|rival| kind(rival).is_some_and(|kind| own.generalises(kind))).max_by(best);
    let told = |rival: &&Tried| kind(rival).is_some_and(|kind| tells_apart(own, kind));
    let better = || holding().filter(told).filter(|rival| rival.better_than(&tried) >= tie_z).max_by(best);
    let named = special.or_else(better).unwrap_or(&tried);
    let others = as_well.iter().copied().chain([&tried]).filter(|other| kind(other) != kind(named));
    let others = others.filter_map(|other| Some((kind(other)?, named.better_than(other))));
    bearing.tied = others.filter(|(_, lead)| *lead < tie_z).collect();
    if kind(named) == Some(own) && named.terms[0].own_zeros == stage.model.terms[j].own_zeros {
        return Some(stage);
    }
    bearing.evidence = named.evidence[0];
    let mut model = stage.model.clone();
    model.terms[j] = named.terms[0].clone();
    Stage::new(stage.form, stage.settings, model, &stage.weights)
}

/// Weighs each term anew beside those before it, as the search does. The evidence from the search is beside a term that
/// was dropped. A gravity load with one zero for all recordings took the place of one with a zero for each (hidden plant,
/// unkind world, seed 8416).
fn weigh_in_order(stage: &Stage<'_>, bearings: &mut [Bearing]) {
    let (mut model, mut weights) = (Model::default(), stage.weights.clone());
    for (term, bearing) in stage.model.terms.iter().zip(bearings) {
        let Some(before) = Stage::new(stage.form, stage.settings, model.clone(), &weights) else { return };
        if let Some(tried) = before.weighed(term.clone(), &Bar::OPEN) {
            bearing.evidence = tried.evidence[0];
        }
        (model, weights) = (model.with(term), before.weights);
    }
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

/// The better of a law of the position and the same law with the other choice of zeros. That is one for all recordings, or
/// one for each. The search chose beside fewer terms, where what was missing hid the zeros (hidden plant, unkind world, seed 8866).
fn with_zeros(beside: &Stage<'_>, tried: Tried) -> Tried {
    let library = beside.library();
    let (own, zeros) = (kind(&tried), tried.terms[0].own_zeros);
    let others = library.of_effects(|other| Some(other) == own).into_par_iter().filter(|term| term.own_zeros != zeros);
    let mut others: Vec<Tried> = others.filter_map(|term| beside.weighed(term, &Bar::OPEN)).collect();
    others.sort_by(|x, y| rank(y).total_cmp(&rank(x)));
    let Some(other) = others.into_iter().next() else { return tried };
    let other = beside.tuned(&library, other);
    best_of_each(vec![tried, other], beside.settings).swap_remove(0)
}

/// The effects that may be confused with `own`, and those that did as well `before`. Each is tried beside the other
/// terms. Those that gain half of `gain` or more get the parameters that gain most, as `own` did.
fn rivals(beside: &Stage<'_>, own: Kind, before: &[Kind], gain: f64) -> Vec<Tried> {
    let confused = |a: Kind, b: Kind| a.definition().confused_with.contains(&b.name());
    let rival = |kind| kind != own && (confused(own, kind) || confused(kind, own) || before.contains(&kind));
    let library = beside.library();
    let rivals = library.of_effects(rival).into_par_iter().filter(|term| matches!(term.name, Name::Effect(_)));
    let rivals = best_of_each(rivals.filter_map(|term| beside.weighed(term, &Bar::OPEN)).collect(), beside.settings);
    let tuned = |rival: Tried| if rival.gain > NEAR * gain { beside.tuned(&library, rival) } else { rival };
    rivals.into_par_iter().map(tuned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::judge::bar::tests::Axis;
    use crate::discover::judge::dataset::Dataset;
    use crate::discover::judge::evidence::Evidence;
    use crate::discover::judge::gain::Gain;
    use crate::discover::judge::settings::Settings;
    use crate::discover::judge::term::Term;
    use crate::discover::judge::weak_form::WeakForm;
    use crate::discover::judge::weights::Weights;
    use crate::discover::judge::zeros::tests::with_a_ripple;
    use crate::recording::Recording;

    /// 12 s at 500 Hz of a pendulum.
    fn pendulum() -> Recording {
        let (mut x, mut v) = (0.0, 0.0_f64);
        let mut recording = Recording::default();
        for k in 0..6000 {
            let t = 2e-3 * f64::from(k);
            let u = 0.9 * (2.1 * t).cos() + 0.3 * (13.3 * t).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push(x);
            for _ in 0..20 {
                v += (u - 0.3 * x.sin() - 0.1 * v.signum() - 0.05 * v) / 0.02 * 1e-4;
                x += v * 1e-4;
            }
        }
        recording
    }

    /// Windows in which an angle, rad, and ripples are told.
    fn windows<'a>(dataset: &'a Dataset, settings: &Settings) -> WeakForm<'a> {
        let mut form = WeakForm::new(dataset, 0.05, settings).unwrap();
        (form.radians, form.ripples) = (Some(1.0), true);
        form
    }

    /// The pendulum, fitted with a ripple of one wave in a radian. The gravity load is the same law with its wave number
    /// given, so it is named, and the ripple is tied with it.
    #[test]
    fn of_a_law_and_its_special_case_the_special_case_is_named() {
        let settings = Settings::default();
        let dataset = Dataset::new(&[pendulum()], &settings);
        let form = windows(&dataset, &settings);
        let base = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let library = base.library();
        let ripples = library.of_effects(|kind| kind == Kind::Cogging);
        let ripple = ripples.iter().find(|term| term.name == Name::Effect(Kind::Cogging)).unwrap();
        let ripple = library.remade(ripple, &[1.0]).unwrap();
        let evidence = base.weighed(ripple.clone(), &Bar::OPEN).unwrap().evidence[0];
        let model = Model::default().with(&ripple);
        let stage = Stage::new(&form, &settings, model, &base.weights).unwrap();
        let mut bearings = vec![Bearing { evidence, tied: Vec::new() }];
        let reviewed = reviewed(stage, &mut bearings).unwrap();
        assert_eq!(reviewed.model.terms[0].name, Name::Effect(Kind::GravityLoad));
        assert!(bearings[0].tied.iter().any(|(kind, _)| *kind == Kind::Cogging), "{:?}", bearings[0].tied);
    }

    /// An axis with a drag, fitted with the Stribeck curve that gains most. The drag has fewer parameters and leaves less
    /// by more than two standard deviations, so it takes the place. What stays tied is less far behind.
    #[test]
    fn a_rival_that_outdoes_a_term_takes_its_place() {
        let settings = Settings::default();
        let recordings = [1, 2].map(|seed| Axis { f1: 0.1, drag: 0.01, load: 0.0, seed }.recording());
        let dataset = Dataset::new(&recordings, &settings);
        let form = WeakForm::new(&dataset, 0.05, &settings).unwrap();
        let base = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let curves = base.library().of_effects(|kind| kind == Kind::Stribeck);
        let tried = curves.into_iter().filter_map(|term| base.weighed(term, &Bar::OPEN));
        let curve = tried.max_by(|a, b| a.gain.total_cmp(&b.gain)).unwrap();
        let model = Model::default().with(&curve.terms[0]);
        let stage = Stage::new(&form, &settings, model, &base.weights).unwrap();
        let mut bearings = vec![Bearing { evidence: curve.evidence[0], tied: Vec::new() }];
        let reviewed = reviewed(stage, &mut bearings).unwrap();
        assert_eq!(reviewed.model.terms[0].name, Name::Effect(Kind::QuadraticDrag));
        assert!(bearings[0].tied.iter().all(|(_, lead)| *lead < settings.tie_z), "{:?}", bearings[0].tied);
    }

    /// A pendulum with its gravity, and after it with a ripple of nearly one wave in a turn. Beside each other neither gains.
    /// The ripple gains less, so it is dropped, although gravity comes first.
    #[test]
    fn the_term_that_gains_least_is_dropped() {
        let settings = Settings::default();
        let dataset = Dataset::new(&[pendulum()], &settings);
        let form = windows(&dataset, &settings);
        let base = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let library = base.library();
        let of = |kind: Kind| library.of_effects(|own| own == kind).swap_remove(0);
        let ripple = library.remade(&of(Kind::Cogging), &[NEARLY_ONE_WAVE]).unwrap();
        let gravity = of(Kind::GravityLoad);
        let evidence = base.weighed(gravity.clone(), &Bar::OPEN).unwrap().evidence[0];
        let model = Model::default().with(&gravity).with(&ripple);
        let stage = Stage::new(&form, &settings, model, &base.weights).unwrap();
        let alone = |j| without(&stage, j).unwrap().weighed(stage.model.terms[j].clone(), &Bar::OPEN).unwrap();
        assert!([0, 1].map(alone).iter().all(|tried| tried.rejection() == Some(Rejection::Gain)));
        let mut bearings = [evidence, evidence].map(|evidence| Bearing { evidence, tied: Vec::new() }).to_vec();
        let stays = backward_elimination(stage, &mut bearings).unwrap();
        let names: Vec<Name> = stays.model.terms.iter().map(|term| term.name).collect();
        assert_eq!((names, bearings.len()), (vec![Name::Effect(Kind::GravityLoad)], 1));
    }

    /// Waves of the ripple in a turn.
    const NEARLY_ONE_WAVE: f64 = 1.0001;

    /// Three pendulums whose encoders start anywhere, fitted with one phase for all. The review gives each its own.
    #[test]
    fn zeros_are_chosen_anew() {
        let settings = Settings::default();
        let recordings = [(0.0, 7.1), (1.1, 9.7), (-2.0, 5.3)].map(|(zero, beat)| with_a_ripple(zero, beat, 0.0));
        let dataset = Dataset::new(&recordings, &settings);
        let mut form = WeakForm::new(&dataset, 0.03, &settings).unwrap();
        form.radians = Some(1.0);
        let base = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let gravity = base.library().of_effects(|kind| kind == Kind::GravityLoad);
        let gravity = gravity.into_iter().find(|term| !term.own_zeros).unwrap();
        let evidence = base.weighed(gravity.clone(), &Bar::OPEN).unwrap().evidence[0];
        let stage = Stage::new(&form, &settings, Model::default().with(&gravity), &base.weights).unwrap();
        let reviewed = reviewed(stage, &mut vec![Bearing { evidence, tied: Vec::new() }]).unwrap();
        let own = &reviewed.model.terms[0];
        assert!(own.name == Name::Effect(Kind::GravityLoad) && own.own_zeros, "{:?} {}", own.name, own.own_zeros);
    }

    /// A constant load, which the pendulum has not, was found before its gravity. It is dropped. The evidence for gravity
    /// is then that beside the base alone, whatever it was before. The windows weigh a little otherwise then, by less than a
    /// fifth of the gain.
    #[test]
    fn evidence_is_beside_what_stays() {
        let settings = Settings::default();
        let dataset = Dataset::new(&[pendulum()], &settings);
        let form = windows(&dataset, &settings);
        let base = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let of = |kind: Kind| base.library().of_effects(|own| own == kind).swap_remove(0);
        let (load, gravity) = (of(Kind::ConstantLoad), of(Kind::GravityLoad));
        let evidence = base.weighed(gravity.clone(), &Bar::OPEN).unwrap().evidence[0];
        let stale = Evidence { u: Gain::default(), a: Gain::default(), ..evidence };
        let model = Model::default().with(&load).with(&gravity);
        let stage = Stage::new(&form, &settings, model, &base.weights).unwrap();
        let mut bearings = [evidence, stale].map(|evidence| Bearing { evidence, tied: Vec::new() }).to_vec();
        let reviewed = reviewed(stage, &mut bearings).unwrap();
        assert_eq!(reviewed.model.terms.len(), 1);
        let [own, alone] = [bearings[0].evidence, evidence].map(|evidence| evidence.gain());
        assert!((own / alone - 1.0).abs() < 0.2, "{own} {alone}");
    }

    /// A ripple that does as well as gravity has more parameters, and gravity as a special case. It is tied with gravity
    /// where it was before: the review begins anew where it drops another term, and the tie stays then. A ripple of one wave
    /// in a turn has no more parameters, and is always tied.
    #[test]
    fn a_tie_stays_where_the_review_begins_anew() {
        let tried = |kind: Kind, size: usize, counted_waves: usize| {
            let terms = vec![Term { size, ..Term::force(Name::Effect(kind), Vec::new()) }];
            let [u, a] = [Gain::default(); 2];
            let evidence = vec![Evidence { u, a, disagreement: 0.0, coherence: 1.0, rejection: None }];
            let blocks = [vec![1.0, 1.1, 0.9, 1.0], vec![1.0, 1.1, 0.9, 1.0]];
            Tried { terms, evidence, gain: 0.1, blocks, counted_waves }
        };
        let gravity = tried(Kind::GravityLoad, 2, 0);
        let [any, of_one_wave] = [0, 1].map(|counted| [tried(Kind::Cogging, 3, counted)]);
        let settings = Settings::default();
        let ties = |ripples: &[Tried], before: &[Kind]| tied(&gravity, ripples, before, &settings).count();
        assert_eq!([ties(&any, &[]), ties(&any, &[Kind::Cogging]), ties(&of_one_wave, &[])], [0, 1, 1]);
    }
}
