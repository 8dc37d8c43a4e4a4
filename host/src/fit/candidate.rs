//! A model under test, and which of its parameters are free.

use breakaway_core::plant::{Base, Effect};

/// A model under test: base and effects by value.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Base parameters.
    pub base: Base<f64>,
    /// Effects.
    pub effects: Vec<Effect<f64>>,
}

impl Candidate {
    /// Numbers that start a segment: position and velocity, and those of the first effect with a free memory.
    pub(super) fn local(&self) -> usize {
        2 + self.effects.iter().map(|effect| effect.kind.free_memory()).find(|n| *n > 0).unwrap_or(0)
    }
}

/// A free parameter of a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Free {
    /// b, c, f1 by index.
    Base(usize),
    /// Parameter `.1` of effect `.0`.
    Effect(usize, usize),
}

impl Free {
    /// All base parameters and every effect parameter that is not held at its default.
    pub fn all(effects: &[Effect<f64>]) -> Vec<Self> {
        let mut free: Vec<Self> = (0..3).map(Self::Base).collect();
        for (j, effect) in effects.iter().enumerate() {
            for (i, parameter) in effect.kind.definition().parameters.iter().enumerate() {
                if parameter.default.is_none_or(|default| effect.p[i] != default) {
                    free.push(Self::Effect(j, i));
                }
            }
        }
        free
    }

    pub(super) fn get(self, candidate: &Candidate) -> f64 {
        match self {
            Self::Base(0) => candidate.base.b,
            Self::Base(1) => candidate.base.c,
            Self::Base(_) => candidate.base.f1,
            Self::Effect(j, i) => candidate.effects[j].p[i],
        }
    }

    pub(super) fn set(self, candidate: &mut Candidate, value: f64) {
        let (min, max) = self.range(candidate);
        let value = value.clamp(min, max);
        match self {
            Self::Base(0) => candidate.base.b = value,
            Self::Base(1) => candidate.base.c = value,
            Self::Base(_) => candidate.base.f1 = value,
            Self::Effect(j, i) => candidate.effects[j].p[i] = value,
        }
    }

    pub(super) fn range(self, candidate: &Candidate) -> (f64, f64) {
        match self {
            Self::Base(0) => (f64::MIN_POSITIVE, f64::MAX),
            Self::Base(_) => (0.0, f64::MAX),
            Self::Effect(j, i) => {
                let parameter = &candidate.effects[j].kind.definition().parameters[i];
                (parameter.min, parameter.max)
            }
        }
    }

    /// The value of that parameter in the largest base; infinite for an effect's.
    pub(super) fn largest(self, base: &Base<f64>) -> f64 {
        match self {
            Self::Base(i) => [base.b, base.c, base.f1][i.min(2)],
            Self::Effect(..) => f64::INFINITY,
        }
    }

    /// Whether it is strictly positive: then it is stepped by ratio.
    pub(super) fn logarithmic(self, candidate: &Candidate) -> bool {
        self.range(candidate).0 > 0.0
    }
}
