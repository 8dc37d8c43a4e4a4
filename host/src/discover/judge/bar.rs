//! The gains that a name needs. They rise with those of the decoys, which gain by what this machine leaves unexplained.

use rayon::prelude::*;

use super::evidence::{Evidence, Rejection};
use super::search::Stage;
use super::settings::Settings;
use super::term::{Name, Term};
use super::tried::{Tried, best_of_each};

/// The gains that a name needs in these recordings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Over all rows, nats.
    pub flat: f64,
    /// Where the effect acts, nats.
    pub local: f64,
}

impl Bar {
    /// Any gain is enough.
    pub const OPEN: Self = Self { flat: f64::NEG_INFINITY, local: f64::NEG_INFINITY };

    /// The bar of a machine on which no decoy gains.
    pub fn quiet(settings: &Settings) -> Self {
        Self::over_decoy(0.0, settings)
    }

    /// The bar where the best decoy gains so much, nats.
    fn over_decoy(gain: f64, settings: &Settings) -> Self {
        let [rough, quiet] = settings.gain;
        let flat = (settings.over_decoys * gain).clamp(quiet, rough);
        let share = ((flat - quiet) / (rough - quiet)).clamp(0.0, 1.0);
        let [rough, quiet] = settings.local_gain;
        Self { flat, local: quiet + share * (rough - quiet) }
    }

    /// Whether the gains are enough: over all rows on the side that gains less, and where the effect acts on side U.
    pub fn reached_by(&self, evidence: &Evidence) -> bool {
        evidence.gain() >= self.flat && evidence.u.local >= self.local
    }
}

impl Stage<'_> {
    /// The bar by the decoys that were tried.
    pub(super) fn bar(&self, all: &[Tried]) -> Bar {
        let most = possible_decoys(all).map(|tried| tried.gain).fold(0.0, f64::max);
        Bar::over_decoy(most, self.settings)
    }

    /// Rejects the effects and pairs that gain too little. A decoy may gain because it holds the effect itself, as a free
    /// curve over velocity holds a drag. So what is below `bar` is compared with what `decoys` still gain beside it.
    pub(super) fn reject_small_gains(&self, all: &mut [Tried], bar: &Bar, decoys: &[Term]) {
        all.par_iter_mut().filter(|own| own.rejection().is_none()).for_each(|own| {
            let reached = |bar: &Bar| own.evidence.iter().all(|evidence| bar.reached_by(evidence));
            let beside = || !is_decoy(own) && self.bar_beside(&own.terms, decoys).is_some_and(|bar| reached(&bar));
            if !(reached(bar) || reached(&Bar::quiet(self.settings)) && beside()) {
                own.evidence[0].rejection = Some(Rejection::Gain);
            }
        });
    }

    /// The bar by what `decoys` gain beside new terms; `None` where the model with them has no fit.
    fn bar_beside(&self, terms: &[Term], decoys: &[Term]) -> Option<Bar> {
        let model = terms.iter().fold(self.model.clone(), |model, term| model.with(term));
        let beside = self.with_model(model)?;
        let tried: Vec<Tried> = decoys.iter().filter_map(|decoy| beside.weighed(decoy.clone(), &Bar::OPEN)).collect();
        Some(beside.bar(&tried))
    }
}

/// The best decoy of every name.
pub(super) fn decoys(all: &[Tried], settings: &Settings) -> Vec<Term> {
    let decoys: Vec<Tried> = all.iter().filter(|own| is_decoy(own)).cloned().collect();
    best_of_each(decoys, settings).into_iter().filter_map(|own| own.terms.into_iter().next()).collect()
}

fn is_decoy(tried: &Tried) -> bool {
    matches!(tried.terms[0].name, Name::Decoy(_))
}

/// Decoys beside which the motion is physical.
fn possible_decoys(all: &[Tried]) -> impl Iterator<Item = &Tried> {
    let possible = |own: &&Tried| !matches!(own.rejection(), Some(Rejection::Inertia | Rejection::Base));
    all.iter().filter(|own| is_decoy(own)).filter(possible)
}

/// Gain of the best significant decoy, nats; 0 if none is significant.
pub(super) fn best_decoy(all: &[Tried], settings: &Settings) -> f64 {
    let significant = |own: &&Tried| own.evidence[0].z() >= settings.least_z(own.terms[0].chosen_of);
    possible_decoys(all).filter(significant).map(|own| own.gain).fold(0.0, f64::max)
}

#[cfg(test)]
pub(in crate::discover) mod tests {
    use breakaway_core::plant::Kind;

    use super::*;
    use crate::discover::judge::dataset::Dataset;
    use crate::discover::judge::sides::Model;
    use crate::discover::judge::weak_form::WeakForm;
    use crate::discover::judge::weights::Weights;
    use crate::recording::Recording;

    /// What an axis has beside b = .02 and c = .03.
    #[derive(Clone, Copy)]
    pub struct Axis {
        pub f1: f64,
        pub drag: f64,
        pub load: f64,
        /// Start of the random numbers.
        pub seed: u64,
    }

    impl Axis {
        /// 20 s at 500 Hz under two sines. A random torque of 20 Hz comes from a linear congruential generator.
        pub fn recording(self) -> Recording {
            let (mut x, mut v, mut torque, mut seed) = (0.0, 0.0_f64, 0.0, self.seed);
            let mut recording = Recording::default();
            for k in 0..10_000 {
                let t = 2e-3 * f64::from(k);
                let u = 0.5 * (2.1 * t).cos() + 0.3 * (13.3 * t).sin();
                recording.t.push(t);
                recording.u.push(u);
                recording.x.push(x);
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let uniform = (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
                torque += 0.22 * (0.3 * uniform - torque);
                for _ in 0..20 {
                    let force = u + torque + self.load - self.drag * v * v.abs();
                    let free = v + (force - self.f1 * v.signum() - 0.03 * v) / 0.02 * 1e-4;
                    v = if free * v < 0.0 && force.abs() <= self.f1 { 0.0 } else { free };
                    x += v * 1e-4;
                }
            }
            recording
        }
    }

    /// An axis with a drag that is small beside its random torque.
    fn axis(f1: f64, seed: u64) -> Recording {
        Axis { f1, drag: 0.002, load: 0.0, seed }.recording()
    }

    /// The drag of a first round, and the bar by the decoys of that round.
    fn drag_of(recordings: &[Recording]) -> (Tried, Bar) {
        let settings = Settings::default();
        let dataset = Dataset::new(recordings, &settings);
        let form = WeakForm::new(&dataset, 0.03, &settings).unwrap();
        let stage = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let (tried, bar) = stage.singles();
        let drag = tried.into_iter().find(|own| own.terms[0].name == Name::Effect(Kind::QuadraticDrag)).unwrap();
        (drag, bar)
    }

    /// A free curve over velocity gains as much as the drag that it holds, and would raise the bar above the drag. Beside
    /// the drag it gains nothing.
    #[test]
    fn a_decoy_that_holds_the_effect_does_not_raise_its_bar() {
        let (drag, bar) = drag_of(&[axis(0.1, 1), axis(0.1, 2)]);
        assert!(!bar.reached_by(&drag.evidence[0]), "{bar:?} {:?}", drag.evidence[0]);
        assert_eq!(drag.rejection(), None);
    }

    /// Friction that differs between recordings is another decoy's, and stays beside the drag. On such a machine the drag
    /// is too small.
    #[test]
    fn a_decoy_of_something_else_raises_the_bar() {
        let (drag, bar) = drag_of(&[axis(0.1, 1), axis(0.13, 2)]);
        assert!(!bar.reached_by(&drag.evidence[0]), "{bar:?} {:?}", drag.evidence[0]);
        assert_eq!(drag.rejection(), Some(Rejection::Gain));
    }
}
