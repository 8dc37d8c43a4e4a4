//! Coulomb friction changes over the session as the grease warms up.

use super::{ActsIn, Definition, Element, Instant, Law, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Friction warm-up: `−s·e^(−t/T)·sgn v`.
#[derive(Clone, Copy, Debug)]
pub struct FrictionDrift;

impl Law for FrictionDrift {
    const DEFINITION: Definition = Definition {
        name: "friction_drift",
        title: "Friction warm-up",
        law: "−s·e^(−t/T)·sgn v",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Level, "s", "extra friction when cold", -1e9, 1e9),
            Parameter::new(Role::TimeConstant, "T", "time constant of the warm-up", 1e-3, 1e7)
                .search(Search::Grid(Scale::Session, &[0.1, 0.2, 0.4, 0.8])),
        ],
        shown_by: "long sessions",
        confused_with: &["gain_drift"],
        compensation: None,
        shared_clock: true,
        ..Definition::PLAIN
    };

    fn level<R: Real>(p: &[R], _base: &Base<R>, at: &Instant<R>) -> R {
        p[0] * (-(at.t / p[1])).exp()
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::LevelInTime { rise: p[0], time_constant_s: p[1] }
    }
}
