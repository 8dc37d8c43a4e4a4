//! Bristles with damping carry the friction, and their level follows a Stribeck curve.

use super::dahl::{BRISTLES_AT_REST, ONE_BRISTLE};
use super::{ActsIn, Dahl, Definition, Element, Law, Memory, Parameter, Relation, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Why the Stribeck law does not stand beside this one.
pub(super) const HAS_THE_CURVE: &str = "LuGre friction contains the Stribeck curve";

/// LuGre friction: `friction σ·z + σ1·ż, ż = v − σ·|v|·z/g(v), g = f1 + s·e^(−(v/vs)²)`.
#[derive(Clone, Copy, Debug)]
pub struct LuGre;

impl Law for LuGre {
    const DEFINITION: Definition = Definition {
        name: "lugre",
        title: "LuGre friction",
        law: "friction σ·z + σ1·ż, ż = v − σ·|v|·z/g(v), g = f1 + s·e^(−(v/vs)²)",
        acts_in: ActsIn::Mechanics,
        parameters: &[
            Parameter::new(Role::Stiffness, "sigma", "bristle stiffness", 1e-9, 1e12)
                .search(Search::Grid(Scale::Presliding, &[3.0, 10.0, 30.0, 100.0, 300.0])),
            Parameter::new(Role::Damping, "sigma1", "bristle damping", 0.0, 1e9)
                .search(Search::Grid(Scale::BristleDamping, &[0.3])),
            Parameter::new(Role::Level, "s", "rise of friction towards rest", 0.0, 1e9)
                .search(Search::Grid(Scale::Coulomb, &[0.2])),
            Parameter::new(Role::Speed, "vs", "Stribeck velocity", 1e-12, 1e9)
                .search(Search::Grid(Scale::Speed, &[0.06])),
        ],
        shown_by: "reversals, below break-away, slow motion",
        confused_with: &["dahl", "stribeck", "backlash"],
        compensation: None,
        generalises: &["dahl", "stribeck"],
        excludes: &[
            Relation { name: "dahl", why: ONE_BRISTLE },
            Relation { name: "stribeck", why: HAS_THE_CURVE },
            Relation { name: "stiction", why: BRISTLES_AT_REST },
        ],
        ..Definition::PLAIN
    };

    const REMEMBERS: bool = true;
    const FREE_MEMORY: usize = 1;

    const BRISTLES: bool = true;

    fn bristle<R: Real>(p: &[R], level: R, v: R, memory: &mut Memory<R>, h: f64) -> R {
        let r = v / p[3];
        let g = level + p[2] * (-(r * r)).exp();
        let from = memory[0];
        let force = Dahl::bristle(p, g, v, memory, h);
        force + p[1] * (memory[0] - from).scale(1.0 / h)
    }

    fn bandwidth(p: &[f64], base: &Base<f64>) -> f64 {
        libm::sqrt(p[0] / base.b).max(p[1] / base.b)
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Bristles { stiffness: p[0], damping: p[1], rise: p[2], speed: p[3] }
    }
}
