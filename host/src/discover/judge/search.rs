//! The judge's search. A round adds the effect that holds on both sides and is the best of its rivals; or two, where
//! they only show together. At the end each effect that no longer holds beside the later ones is dropped.

use breakaway_core::plant::Kind;
use rayon::prelude::*;

use super::bar::{self, Bar};
use super::evidence::{Evidence, Rejection, weigh};
use super::library::Library;
use super::one_wave::{as_one_wave, is_open, one_wave};
use super::outcome::{Outcome, Round, decide, inconsistent_rival};
use super::regression::rms;
use super::review;
use super::ringing::{damped_gain, reject_overdamped};
use super::settings::Settings;
use super::sides::{Fitted, Model};
use super::start::whole_waves;
use super::term::{Name, Term};
use super::tried::{Tried, best_of_each, rank};
use super::weak_form::WeakForm;
use super::weights::Weights;

/// What speaks for a term of the final model.
#[derive(Clone, Debug)]
pub struct Bearing {
    /// Beside the terms that were found before it.
    pub evidence: Evidence,
    /// Effects that do as well in its place, in the final model. The number is the term's lead, in standard deviations.
    pub tied: Vec<(Kind, f64)>,
}

/// What the judge found.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Half-width of the windows, s.
    pub half_width_s: f64,
    /// The rounds.
    pub rounds: Vec<Round>,
    /// The final model.
    pub model: Model,
    /// What speaks for each of its terms.
    pub bearings: Vec<Bearing>,
    /// Residual of the base and of the final model over the rms of the drive (side U) and of the acceleration (side A).
    pub residual: [[f64; 2]; 2],
    /// The final model's fit.
    pub fitted: Fitted,
}

impl Judged {
    /// Gain of all names together over the base, nats a window; that of the side that gains less.
    pub fn gain(&self) -> f64 {
        let [before, after] = self.residual;
        (0..2).map(|side| (before[side] / after[side]).ln()).fold(f64::INFINITY, f64::min)
    }
    /// Inertia of the motor and of a second body that hangs on it, drive units · s² / position unit.
    pub fn inertia(&self) -> f64 {
        let terms = self.model.terms.iter().zip(&self.fitted.u.amplitudes);
        let loads = terms.filter(|(term, _)| term.body.is_some()).filter_map(|(_, amplitudes)| amplitudes.first());
        self.fitted.u.b + loads.sum::<f64>()
    }
}

/// A model that is fitted with the weights of its own residual.
pub(super) struct Stage<'a> {
    pub form: &'a WeakForm<'a>,
    pub settings: &'a Settings,
    pub model: Model,
    pub fitted: Fitted,
    pub weights: Weights,
}

/// Residual over the rms of the drive (side U) and of the acceleration (side A).
pub(super) fn share(form: &WeakForm<'_>, fitted: &Fitted) -> [f64; 2] {
    [rms(&fitted.u.residual) / rms(&form.row_u), rms(&fitted.a.residual) / rms(&form.row_a)]
}

/// Judges in windows of one width; `None` where a model cannot be fitted.
pub fn judge(form: &WeakForm<'_>, settings: &Settings) -> Option<Judged> {
    let mut stage = Stage::new(form, settings, Model::default(), &Weights::equal(form))?;
    let (mut rounds, mut bearings) = (Vec::new(), Vec::new());
    let first = share(form, &stage.fitted);
    while stage.model.terms.len() < settings.most_names {
        let round = stage.round();
        let (named, tied) = match &round.outcome {
            Outcome::Named(names, tied) => (round.tried.iter().find(|t| t.names() == *names).cloned(), tied.clone()),
            _ => (None, Vec::new()),
        };
        rounds.push(round);
        let Some(mut named) = named else { break };
        if named.terms.len() > 1 {
            named = stage.with_pair_tuned(named);
        }
        let model = named.terms.iter().fold(stage.model.clone(), |model, term| model.with(term));
        stage = Stage::new(form, settings, model, &stage.weights)?;
        let kinds = tied.iter().filter_map(|name| match name {
            Name::Effect(kind) => Some((*kind, 0.0)),
            Name::Decoy(_) => None,
        });
        let tied: Vec<(Kind, f64)> = kinds.collect();
        bearings.extend(named.evidence.into_iter().map(|evidence| Bearing { evidence, tied: tied.clone() }));
    }
    let stage = review::reviewed(stage, &mut bearings)?;
    let last = share(form, &stage.fitted);
    Some(Judged {
        half_width_s: form.half_width_s,
        rounds,
        model: stage.model,
        bearings,
        residual: [first, last],
        fitted: stage.fitted,
    })
}

impl<'a> Stage<'a> {
    pub(super) fn new(form: &'a WeakForm<'a>, settings: &'a Settings, model: Model, weights: &Weights) -> Option<Self> {
        let first = model.fit(form, weights, settings)?;
        let weights = Weights::of(form, &first);
        let fitted = model.fit(form, &weights, settings)?;
        Some(Self { form, settings, model, fitted, weights })
    }

    /// Another model, with the weights of this one.
    pub(super) fn with_model(&self, model: Model) -> Option<Stage<'a>> {
        let fitted = self.fit(&model)?;
        Some(Stage { form: self.form, settings: self.settings, model, fitted, weights: self.weights.clone() })
    }

    fn fit(&self, model: &Model) -> Option<Fitted> {
        model.fit(self.form, &self.weights, self.settings)
    }

    /// The evidence for the `index`-th term of a model: `before` is fitted without it, `after` with it.
    fn evidence(&self, before: &Fitted, after: &Fitted, (model, index): (&Model, usize), bar: &Bar) -> Evidence {
        let weigh = |after: &Fitted, model: &Model| {
            weigh(self.form, &self.weights, before, after, (model, index), bar, self.settings)
        };
        let own = weigh(after, model);
        if !is_open(&own) {
            return own;
        }
        let Some(term) = one_wave(model, index, after) else { return own };
        let mut one = model.clone();
        one.terms[index] = term;
        self.fit(&one).map_or(own, |after| as_one_wave(own, weigh(&after, &one), self.settings))
    }

    /// The evidence for a new term beside the model.
    pub(super) fn weighed(&self, term: Term, bar: &Bar) -> Option<Tried> {
        let model = self.model.with(&term);
        let after = self.fit(&model)?;
        let evidence = self.evidence(&self.fitted, &after, (&model, self.model.terms.len()), bar);
        self.tried(vec![term], vec![evidence], evidence.gain(), &after)
    }

    /// The evidence for two new terms, each beside the other; `fitted` is the fit of the model with the first. `None` where
    /// the second gains far too little beside the first, or the motion is not physical with both.
    fn weighed_pair(&self, (one, fitted): (&Term, &Fitted), other: Term, bar: &Bar) -> Option<Tried> {
        let known = self.model.terms.len();
        let model = self.model.with(one).with(&other);
        let after = self.fit(&model)?;
        let second = self.evidence(fitted, &after, (&model, known + 1), bar);
        let possible = !matches!(second.rejection, Some(Rejection::Inertia | Rejection::Base | Rejection::Amplitude));
        if !possible || second.gain() <= self.settings.tie * bar.flat {
            return None;
        }
        let without_one = self.fit(&self.model.with(&other))?;
        let first = self.evidence(&without_one, &after, (&model, known), bar);
        let nats = |before: &[f64], after: &[f64], weights: &[f64]| {
            let square = |r: &[f64]| r.iter().zip(weights).map(|(r, w)| (r * w).powi(2)).sum::<f64>();
            0.5 * (square(before) / square(after).max(f64::MIN_POSITIVE)).ln()
        };
        let gain_u = nats(&self.fitted.u.residual, &after.u.residual, &self.weights.u);
        let gain_a = nats(&self.fitted.a.residual, &after.a.residual, &self.weights.a);
        self.tried(vec![one.clone(), other], vec![first, second], gain_u.min(gain_a), &after)
    }

    /// New terms with their evidence; `None` where the gain is no number.
    fn tried(&self, terms: Vec<Term>, evidence: Vec<Evidence>, gain: f64, after: &Fitted) -> Option<Tried> {
        let blocks = |residual: &[f64], weights: &[f64]| {
            let mut sums = vec![0.0; self.form.blocks];
            for ((row, r), w) in self.form.rows.iter().zip(residual).zip(weights) {
                sums[row.block] += (r * w).powi(2);
            }
            sums
        };
        let blocks = [blocks(&after.u.residual, &self.weights.u), blocks(&after.a.residual, &self.weights.a)];
        let counted_waves = terms.iter().filter(|term| whole_waves(self.form, term).is_some()).count();
        gain.is_finite().then_some(Tried { terms, evidence, gain, blocks, counted_waves })
    }

    /// The columns beside the model.
    pub(super) fn library(&self) -> Library<'_> {
        Library::new(self.form, &self.model, &self.fitted, &self.weights)
    }

    /// The terms without the second bodies that side U alone tells to be idle. A second body filters every column of side
    /// A, which takes most of the time. Both sides must gain by it, so it is among those that gain most on side U.
    fn promising(&self, terms: Vec<Term>) -> Vec<Term> {
        let (bodies, mut terms): (Vec<Term>, Vec<Term>) = terms.into_iter().partition(|term| term.body.is_some());
        let left = |term: &Term| {
            let side = self.model.with(term).fit_drive(self.form, &self.weights.u, self.settings);
            side.map_or(f64::INFINITY, |side| {
                side.residual.iter().zip(&self.weights.u).map(|(r, w)| (r * w).powi(2)).sum()
            })
        };
        let mut ranked: Vec<(f64, Term)> = bodies.into_par_iter().map(|term| (left(&term), term)).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut kept: Vec<Name> = Vec::new();
        for (_, term) in ranked {
            if kept.iter().filter(|name| **name == term.name).count() < BODIES {
                kept.push(term.name);
                terms.push(term);
            }
        }
        terms
    }

    /// Every term of the library alone. The best of them leave their grid.
    pub(super) fn singles(&self) -> (Vec<Tried>, Bar) {
        let library = self.library();
        let terms = self.promising(library.terms());
        let mut all: Vec<Tried> = terms.into_par_iter().filter_map(|term| self.weighed(term, &Bar::OPEN)).collect();
        let bar = self.bar(&all);
        let decoys = bar::decoys(&all, self.settings);
        self.reject_small_gains(&mut all, &bar, &decoys);
        let mut best = self.with_contenders_tuned(&library, best_of_each(all, self.settings));
        let damped = damped_gain(&best, self.settings);
        reject_overdamped(&mut best, damped, self.settings);
        best.sort_by(|x, y| rank(y).total_cmp(&rank(x)));
        (best, bar)
    }

    /// The best pair of every two names. The first of a pair is one of the effects that gain most, whether or not it
    /// holds alone. The two may have one name, where a model may have several of it: an axis between two stops is led back
    /// by both.
    fn pairs(&self, singles: &[Tried], bar: &Bar) -> Vec<Tried> {
        let mut first: Vec<&Tried> = singles
            .iter()
            .filter(|t| t.rejection() != Some(Rejection::Inertia))
            .filter(|t| {
                matches!(t.terms[0].name, Name::Effect(_)) && t.evidence[0].u.flat.max(t.evidence[0].a.flat) > PAIR_GAIN
            })
            .collect();
        first.sort_by(|x, y| score(y).total_cmp(&score(x)));
        first.truncate(PAIR_FIRSTS);
        let quiet = Bar::quiet(self.settings);
        let mut all = Vec::new();
        for one in first {
            let beside = self.model.with(&one.terms[0]);
            let Some(fitted) = self.fit(&beside) else { continue };
            let terms = Library::new(self.form, &beside, &fitted, &self.weights).partners();
            let is_second = |name: Name| match name {
                Name::Effect(kind) => name != one.terms[0].name || kind.definition().repeats,
                Name::Decoy(_) => false,
            };
            let pairs = terms.into_par_iter().filter(|term| is_second(term.name));
            let weighed = pairs.filter_map(|term| self.weighed_pair((&one.terms[0], &fitted), term, &quiet));
            all.extend(weighed.collect::<Vec<_>>());
        }
        self.reject_small_gains(&mut all, bar, &bar::decoys(singles, self.settings));
        let mut best = best_of_each(all, self.settings);
        reject_overdamped(&mut best, damped_gain(singles, self.settings), self.settings);
        best
    }

    fn round(&self) -> Round {
        let (mut tried, bar) = self.singles();
        let left = rms(&self.fitted.u.residual) / rms(&self.form.row_u);
        let mut outcome = decide(&tried, left, self.settings);
        if !matches!(outcome, Outcome::Named(..)) || inconsistent_rival(&tried, self.settings) {
            let pairs = self.pairs(&tried, &bar);
            tried.extend(pairs);
            tried.sort_by(|x, y| rank(y).total_cmp(&rank(x)));
            outcome = decide(&tried, left, self.settings);
        }
        Round { tried, outcome }
    }
}

/// Most second bodies, and most damped modes, that are tried on both sides. Their grids have 75 and 50. docs/blind-history.md
/// has the seeds that were asked with and without this bound.
const BODIES: usize = 20;
/// Gain on a side above which a term is tried with a partner, nats.
const PAIR_GAIN: f64 = 0.05;
/// Most terms that are tried with a partner.
const PAIR_FIRSTS: usize = 4;
fn score(tried: &Tried) -> f64 {
    tried.evidence[0].u.flat.max(0.0) + tried.evidence[0].a.flat.max(0.0)
}
