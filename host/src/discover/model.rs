//! A model of the search: a base, effects, and what a fit does with each of their parameters.

use breakaway_core::plant::effect::{MAX_PARAMETERS, Over, Search};
use breakaway_core::plant::{Base, Effect};

use crate::fit::{Candidate, Fit, FitError, Free, Problem, Start};

/// Largest distance of a wave number from the whole one that it is taken for, waves in a turn.
const WHOLE: f64 = 0.1;
/// Fewest whole waves in a turn. A single wave is the gravity load's.
const LEAST_WAVES: f64 = 2.0;

/// What a fit does with a parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    /// It is fitted.
    Free,
    /// It stays where it is: a whole number of waves in a turn.
    Held,
    /// It stays at the value that gives the law its plain form.
    Unrefined,
}

/// A model. Every fit of it, and of models that grow out of it, respects the status of its parameters.
#[derive(Clone, Debug)]
pub(super) struct Model {
    pub base: Base<f64>,
    pub effects: Vec<Effect<f64>>,
    status: Vec<[Status; MAX_PARAMETERS]>,
}

/// Parameters at the default of a refinement are unrefined; all others of the law are free.
fn plain(effect: &Effect<f64>) -> [Status; MAX_PARAMETERS] {
    let parameters = effect.kind.definition().parameters;
    std::array::from_fn(|i| match parameters.get(i).map(|parameter| parameter.default) {
        None => Status::Held,
        Some(default) if default == Some(effect.p[i]) => Status::Unrefined,
        Some(_) => Status::Free,
    })
}

impl Model {
    /// The model of a candidate. Every parameter is free that is not at its refinement's default.
    pub(super) fn new(candidate: &Candidate) -> Self {
        let Candidate { base, effects } = candidate.clone();
        let status = effects.iter().map(plain).collect();
        Self { base, effects, status }
    }

    /// The model of a fit. A parameter that the fit held stays held.
    pub(super) fn of(fit: &Fit) -> Self {
        let mut model = Self::new(&fit.candidate);
        for (j, row) in model.status.iter_mut().enumerate() {
            for (i, status) in row.iter_mut().enumerate() {
                if *status == Status::Free && !fit.free.contains(&Free::Effect(j, i)) {
                    *status = Status::Held;
                }
            }
        }
        model
    }

    pub(super) fn candidate(&self) -> Candidate {
        Candidate { base: self.base, effects: self.effects.clone() }
    }

    /// The parameters that a fit finds.
    pub(super) fn free(&self) -> Vec<Free> {
        let rows = self.status.iter().enumerate();
        let effects = rows.flat_map(|(j, row)| {
            let free = row.iter().enumerate().filter(|(_, status)| **status == Status::Free);
            free.map(move |(i, _)| Free::Effect(j, i))
        });
        (0..3).map(Free::Base).chain(effects).collect()
    }

    /// Fits what is free.
    ///
    /// # Errors
    /// [`FitError`].
    pub(super) fn fit(
        &self,
        problem: &Problem<'_>,
        initial: Option<&[Start]>,
        iterations: usize,
    ) -> Result<Fit, FitError> {
        problem.fit(&self.candidate(), &self.free(), initial, iterations)
    }

    /// The model with these values; the status of its parameters stays.
    pub(super) fn at(mut self, values: &Candidate) -> Self {
        self.base = values.base;
        self.effects.clone_from(&values.effects);
        self
    }

    /// With another base.
    pub(super) fn on(mut self, base: Base<f64>) -> Self {
        self.base = base;
        self
    }

    /// With another effect, last.
    pub(super) fn with(&self, effect: Effect<f64>) -> Self {
        let mut model = self.clone();
        model.status.push(plain(&effect));
        model.effects.push(effect);
        model
    }

    /// Without effect `j`.
    pub(super) fn without(&self, j: usize) -> Self {
        let mut model = self.clone();
        model.effects.remove(j);
        model.status.remove(j);
        model
    }

    /// The first `count` effects alone.
    pub(super) fn truncated(&self, count: usize) -> Self {
        let mut model = self.clone();
        model.effects.truncate(count);
        model.status.truncate(count);
        model
    }

    pub(super) fn hold(&mut self, j: usize, i: usize) {
        self.status[j][i] = Status::Held;
    }

    /// Sets a refinement of the law's form free.
    pub(super) fn refine(&mut self, j: usize, i: usize) {
        self.status[j][i] = Status::Free;
    }

    /// The model with the frequencies of its last effect held, over position or time or of a resonance. It is for the
    /// next fit alone.
    pub(super) fn at_its_frequency(&self) -> Self {
        let mut model = self.clone();
        let Some(j) = self.effects.len().checked_sub(1) else { return model };
        for (i, parameter) in self.effects[j].kind.definition().parameters.iter().enumerate() {
            if matches!(parameter.search, Search::Spectrum(_) | Search::Resonance(..)) {
                model.hold(j, i);
            }
        }
        model
    }

    /// The model with a whole number of waves in a turn for effect `j`, which is held. `None` where the effect has no
    /// wave number over position, where that is whole, or where it is not near a whole one.
    pub(super) fn in_whole_waves(&self, j: usize) -> Option<Self> {
        let along = |search| matches!(search, Search::Spectrum(Over::Position | Over::PositionAndDirection));
        let i = self.effects[j].kind.definition().parameters.iter().position(|p| along(p.search))?;
        let n = self.effects[j].p[i];
        let near = n != n.round() && (n - n.round()).abs() <= WHOLE;
        (near && n.round() >= LEAST_WAVES).then(|| {
            let mut model = self.clone();
            model.effects[j].p[i] = n.round();
            model.hold(j, i);
            model
        })
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::*;

    const BASE: Base<f64> = Base { b: 1.0, c: 1.0, f1: 1.0 };

    fn fit_of(model: &Model) -> Fit {
        let (candidate, free) = (model.candidate(), model.free());
        let none = Vec::new;
        Fit {
            candidate,
            free,
            floor: 1.0,
            mse: none(),
            samples: none(),
            initial: Vec::new(),
            cost: 0.0,
            converged: true,
        }
    }

    /// Cogging of 7.02 waves becomes seven. The seven stay held in the model of the fit, and beside another effect.
    #[test]
    fn whole_waves_stay_held() {
        let cogging = Effect::new(Kind::Cogging, &[0.1, 7.02, 0.3]);
        let model = Model::new(&Candidate { base: BASE, effects: vec![cogging] });
        assert_eq!(model.free().len(), 3 + 3);
        let whole = model.in_whole_waves(0).unwrap();
        let beside = Model::of(&fit_of(&whole)).with(Effect::new(Kind::ConstantLoad, &[0.1]));
        assert_eq!(beside.effects[0].p[1].to_bits(), 7.0_f64.to_bits());
        assert!(!beside.free().contains(&Free::Effect(0, 1)));
        assert_eq!(beside.free().len(), 3 + 2 + 1);
        assert!(beside.in_whole_waves(0).is_none() && beside.without(0).in_whole_waves(0).is_none());
    }

    /// The judge holds the wave number of a spectrum. Near a whole one the whole one is tried all the same.
    #[test]
    fn a_held_number_of_a_spectrum_becomes_whole() {
        let cogging = Effect::new(Kind::Cogging, &[0.1, 2.96, 0.3]);
        let mut model = Model::new(&Candidate { base: BASE, effects: vec![cogging] });
        model.hold(0, 1);
        assert_eq!(model.in_whole_waves(0).unwrap().effects[0].p[1].to_bits(), 3.0_f64.to_bits());
    }

    /// A refinement is free once it is asked for, and stays so in later models.
    #[test]
    fn refinements_are_asked_for() {
        let stribeck = Effect::new(Kind::Stribeck, &[0.1, 0.2]);
        let mut model = Model::new(&Candidate { base: BASE, effects: vec![stribeck] });
        assert!(!model.free().contains(&Free::Effect(0, 2)));
        model.effects[0].p[2] = 1.0;
        model.refine(0, 2);
        assert!(Model::of(&fit_of(&model)).free().contains(&Free::Effect(0, 2)));
    }
}
