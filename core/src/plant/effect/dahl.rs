//! Below break-away the contact is a spring: friction builds up over the presliding distance f1/σ after every reversal.

use super::{ActsIn, Definition, Element, Law, Memory, Parameter, Relation, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Why no other law with bristles stands beside this one.
pub(super) const ONE_BRISTLE: &str = "a model has at most one bristle state";
/// Why a level at rest does not stand beside bristles.
pub(super) const BRISTLES_AT_REST: &str = "bristles also carry the friction at rest";

/// Dahl presliding: `friction σ·z, ż = v·(1 − σ·z·sgn v / f1)`.
#[derive(Clone, Copy, Debug)]
pub struct Dahl;

impl Law for Dahl {
    const DEFINITION: Definition = Definition {
        name: "dahl",
        title: "Dahl presliding",
        law: "friction σ·z, ż = v·(1 − σ·z·sgn v / f1)",
        acts_in: ActsIn::Mechanics,
        parameters: &[
            Parameter::new(Role::Stiffness, "sigma", "bristle stiffness", 1e-9, 1e12)
                .search(Search::Grid(Scale::Presliding, &[3.0, 10.0, 30.0, 100.0, 300.0])),
        ],
        shown_by: "reversals, below break-away",
        confused_with: &["lugre", "backlash", "flexible_coupling"],
        compensation: None,
        excludes: &[
            Relation { name: "lugre", why: ONE_BRISTLE },
            Relation { name: "stiction", why: BRISTLES_AT_REST },
        ],
        ..Definition::PLAIN
    };

    const REMEMBERS: bool = true;
    const FREE_MEMORY: usize = 1;

    const BRISTLES: bool = true;

    fn bristle<R: Real>(p: &[R], level: R, v: R, memory: &mut Memory<R>, h: f64) -> R {
        let limit = level / p[0] * v.sgn();
        let path = v.abs().scale(h);
        let ratio = path * p[0] / level.max(R::from_f64(1e-12));
        // The solution is exact for a constant v over the sub-step.
        let decay = (-ratio).exp();
        let from = memory[0];
        memory[0] = limit + (from - limit) * decay;
        let mean = if ratio > R::from_f64(1e-6) {
            limit + (from - limit) * ((R::ONE - decay) / ratio)
        } else {
            from
        };
        p[0] * mean
    }

    fn bandwidth(p: &[f64], base: &Base<f64>) -> f64 {
        libm::sqrt(p[0] / base.b)
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Bristles { stiffness: p[0], damping: 0.0, rise: 0.0, speed: 1.0 }
    }
}
