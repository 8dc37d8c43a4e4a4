//! The judge's search. A round adds the effect that holds on both sides and is the best of its rivals; or two, where
//! they only show together. At the end each effect that no longer holds beside the later ones is dropped.

use breakaway_core::plant::Kind;
use rayon::prelude::*;

use super::bar::{self, Bar};
use super::evidence::{Evidence, Rejection, weigh};
use super::library::Library;
use super::one_wave::{as_one_wave, is_open, one_wave};
use super::regression::rms;
use super::review;
use super::settings::Settings;
use super::sides::{Fitted, Model, Weights};
use super::term::{Name, Term};
use super::weak_form::WeakForm;

/// Terms, or pairs of them, that were tried beside a model.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The new terms: one, or two.
    pub terms: Vec<Term>,
    /// What speaks for each of them beside all others.
    pub evidence: Vec<Evidence>,
    /// The smaller gain of the two sides over the model without any of them, nats.
    pub gain: f64,
    /// Sum of the squares that it leaves in every block, on side U and on side A.
    pub blocks: [Vec<f64>; 2],
}

impl Tried {
    /// Why it cannot be named; `None` if every term holds.
    pub fn rejection(&self) -> Option<Rejection> {
        self.evidence.iter().find_map(|e| e.rejection)
    }
    /// Amplitudes and parameters.
    fn size(&self) -> usize {
        self.terms.iter().map(|t| t.size).sum()
    }
    /// How much better it is than another, in standard deviations over blocks (Vuong's test). The side that tells less
    /// counts.
    pub fn better_than(&self, other: &Self) -> f64 {
        let of_side = |side: usize| {
            let gains: Vec<f64> =
                other.blocks[side].iter().zip(&self.blocks[side]).map(|(theirs, own)| theirs - own).collect();
            let n = gains.len().max(2) as f64;
            let mean = gains.iter().sum::<f64>() / n;
            let variance = gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (n - 1.0);
            mean / (variance / n).sqrt().max(f64::MIN_POSITIVE)
        };
        of_side(0).min(of_side(1))
    }
    /// The names.
    pub fn names(&self) -> Vec<Name> {
        self.terms.iter().map(|t| t.name).collect()
    }
}

/// One round: what was tried, and its outcome.
#[derive(Clone, Debug)]
pub struct Round {
    /// The best of every name, in order of the smaller gain.
    pub tried: Vec<Tried>,
    /// What it came to.
    pub outcome: Outcome,
}

/// The outcome of a round.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Names, and the names that are tied with them.
    Named(Vec<Name>, Vec<Name>),
    /// This gains, and is a decoy or inconsistent.
    Unknown(Name),
    /// Nothing gains.
    Nothing,
}

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

/// Judges in windows of one width; `None` where a model cannot be fitted.
pub fn judge(form: &WeakForm<'_>, settings: &Settings) -> Option<Judged> {
    let mut stage = Stage::new(form, settings, Model::default(), &Weights::equal(form))?;
    let (mut rounds, mut bearings) = (Vec::new(), Vec::new());
    let share = |f: &Fitted| [rms(&f.u.residual) / rms(&form.row_u), rms(&f.a.residual) / rms(&form.row_a)];
    let first = share(&stage.fitted);
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
    let last = share(&stage.fitted);
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
        gain.is_finite().then_some(Tried { terms, evidence, gain, blocks })
    }

    /// The columns beside the model.
    pub(super) fn library(&self) -> Library<'_> {
        Library::new(self.form, &self.model, &self.fitted, &self.weights)
    }

    /// Every term of the library alone. The best of them leave their grid.
    pub(super) fn singles(&self) -> (Vec<Tried>, Bar) {
        let library = self.library();
        let terms = library.terms();
        let mut all: Vec<Tried> = terms.into_par_iter().filter_map(|term| self.weighed(term, &Bar::OPEN)).collect();
        let bar = self.bar(&all);
        let decoys = bar::decoys(&all, self.settings);
        self.reject_small_gains(&mut all, &bar, &decoys);
        let mut best = self.with_contenders_tuned(&library, best_of_each(all, self.settings));
        best.sort_by(|x, y| rank(y).total_cmp(&rank(x)));
        (best, bar)
    }

    /// The best pair of every two names. The first of a pair is one of the effects that gain most, whether or not it
    /// holds alone.
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
            let pairs =
                terms.into_par_iter().filter(|t| matches!(t.name, Name::Effect(_)) && t.name != one.terms[0].name);
            let weighed = pairs.filter_map(|term| self.weighed_pair((&one.terms[0], &fitted), term, &quiet));
            all.extend(weighed.collect::<Vec<_>>());
        }
        self.reject_small_gains(&mut all, bar, &bar::decoys(singles, self.settings));
        best_of_each(all, self.settings)
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

/// Gain on a side above which a term is tried with a partner, nats.
const PAIR_GAIN: f64 = 0.05;
/// Most terms that are tried with a partner.
const PAIR_FIRSTS: usize = 4;
/// Gain on side U above which a term predicts a part of what is left, nats.
const PREDICTS: f64 = 0.05;

fn score(tried: &Tried) -> f64 {
    tried.evidence[0].u.flat.max(0.0) + tried.evidence[0].a.flat.max(0.0)
}

/// Whether an effect or a decoy that does not hold gains more than every one that does.
fn inconsistent_rival(tried: &[Tried], settings: &Settings) -> bool {
    let holds = tried.iter().filter(|t| t.rejection().is_none()).map(|t| t.gain).fold(0.0, f64::max);
    let possible = tried.iter().filter(|t| !matches!(t.rejection(), None | Some(Rejection::Inertia | Rejection::Base)));
    possible.map(|t| t.gain).any(|gain| gain * settings.rival > holds)
}

/// The best of every name. One zero for all recordings is preferred to one for each, unless the latter does better with
/// the z of a name.
pub(super) fn best_of_each(mut all: Vec<Tried>, settings: &Settings) -> Vec<Tried> {
    all.sort_by(|x, y| rank(y).total_cmp(&rank(x)));
    let mut best: Vec<Tried> = Vec::new();
    for one in all {
        let Some(own) = best.iter_mut().find(|t| t.names() == one.names()) else {
            best.push(one);
            continue;
        };
        let zeros = |tried: &Tried| tried.terms.iter().filter(|t| t.own_zeros).count();
        let as_well = own.rejection() == one.rejection() && own.better_than(&one) < settings.z;
        if as_well && zeros(&one) < zeros(own) {
            *own = one;
        }
    }
    best
}

/// Parts of a nat in which gains are compared. The rounding of numbers, which differs from one machine to another, must
/// not choose among equals.
const PARTS: f64 = 1e9;

/// Order of what was tried: consistent ones first, then by the smaller gain.
fn rank(tried: &Tried) -> f64 {
    if tried.gain.is_finite() {
        (tried.gain * PARTS).round() / PARTS + if tried.rejection().is_none() { 10.0 } else { 0.0 }
    } else {
        f64::NEG_INFINITY
    }
}

fn has_body(tried: &Tried) -> bool {
    tried.terms.iter().any(|term| term.body.is_some())
}

/// The outcome of a round beside a model that leaves the share `left` of the drive.
fn decide(tried: &[Tried], left: f64, settings: &Settings) -> Outcome {
    let is_effect = |t: &&Tried| t.terms.iter().all(|t| matches!(t.name, Name::Effect(_)));
    let names: Vec<&Tried> = tried.iter().filter(|t| t.rejection().is_none()).filter(is_effect).collect();
    let bar_z = |tried: &Tried| settings.least_z(tried.terms[0].chosen_of);
    // Share of the drive that a term predicts.
    let predicted = |gain: f64| left * (1.0 - (-2.0 * gain).exp()).sqrt();
    let strongest = |tried: &[Tried]| {
        // A wave of another amplitude in each recording is no wave, and predicts nothing of a further recording.
        let is_one = |t: &&Tried| !t.terms[0].own_zeros || t.rejection() != Some(Rejection::Amplitude);
        let alone = tried.iter().filter(|t| t.terms.len() == 1 && t.gain > 0.0).filter(is_one);
        let alone = alone.filter(|t| t.evidence[0].z() >= bar_z(t));
        let seen = alone.map(|t| (t, t.evidence[0].u.flat));
        let seen = seen.filter(|(_, gain)| *gain > PREDICTS && predicted(*gain) > settings.predictable);
        seen.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(t, _)| t.terms[0].name)
    };
    let Some(best) = names.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)) else {
        return strongest(tried).map_or(Outcome::Nothing, Outcome::Unknown);
    };
    // A smaller term is preferred where it costs at most 3 % of the gain.
    let simple = names.iter().filter(|t| t.gain > 0.97 * best.gain).min_by_key(|t| t.size()).unwrap_or(best);
    for other in tried.iter().filter(|t| t.terms.len() == 1) {
        let factor = match other.terms[0].name {
            // The best damping of a second body decides whether it is a coupling.
            Name::Decoy(_) if has_body(simple) && other.terms[0].body.is_some() => 1.0,
            Name::Decoy(_) => settings.decoy,
            Name::Effect(_) if other.rejection().is_some() => settings.rival,
            Name::Effect(_) => continue,
        };
        // A term that is inconsistent alone speaks for the pair in which it is named.
        let part = simple.terms.len() > 1 && simple.terms.iter().any(|t| t.name == other.terms[0].name);
        let possible = !matches!(other.rejection(), Some(Rejection::Inertia | Rejection::Base));
        if possible && other.gain * factor > best.gain && other.evidence[0].z() >= bar_z(other) && !part {
            let material = predicted(other.gain) > settings.predictable;
            return if material { Outcome::Unknown(other.terms[0].name) } else { Outcome::Nothing };
        }
    }
    let mut names: Vec<Name> = Vec::new();
    for name in tied(simple, tried, &[], settings).flat_map(Tried::names).filter(|n| !simple.names().contains(n)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    Outcome::Named(simple.names(), names)
}

/// The rivals of `own` that do as well on both sides. They may miss a bar. One with more parameters counts only where
/// the two effects resemble each other, or where it was tied `before`.
pub(super) fn tied<'a>(
    own: &'a Tried,
    tried: &'a [Tried],
    before: &'a [Kind],
    settings: &'a Settings,
) -> impl Iterator<Item = &'a Tried> {
    let resembles = |t: &Tried| {
        let mut pairs = own.names().into_iter().zip(t.names());
        pairs.all(|pair| match pair {
            (Name::Effect(one), Name::Effect(other)) => one == other || one.resembles(other) || before.contains(&other),
            _ => false,
        })
    };
    tried.iter().filter(move |t| {
        let effects = t.terms.iter().all(|t| matches!(t.name, Name::Effect(_)));
        let near = !matches!(t.rejection(), Some(Rejection::Inertia | Rejection::Base | Rejection::Amplitude));
        let as_well = t.gain > settings.tie * own.gain && own.better_than(t) < settings.tie_z;
        effects && near && t.terms.len() == own.terms.len() && as_well && (t.size() <= own.size() || resembles(t))
    })
}
