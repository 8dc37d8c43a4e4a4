//! The inertia changes once, when a load is picked up or put down.

use super::{ActsIn, Definition, Element, Law, Memory, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

const SHARES_OF_THE_SESSION: [f64; 17] =
    [0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9];

/// Inertia step: `b → b·(1 + r) for t ≥ t0`.
#[derive(Clone, Copy, Debug)]
pub struct InertiaStep;

impl Law for InertiaStep {
    const DEFINITION: Definition = Definition {
        name: "inertia_step",
        title: "Inertia step",
        law: "b → b·(1 + r) for t ≥ t0",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Ratio, "r", "relative change of inertia", -0.95, 100.0),
            Parameter::new(Role::Instant, "t0", "session time of the change", -1e9, 1e9)
                .search(Search::Grid(Scale::Session, &SHARES_OF_THE_SESSION)),
        ],
        shown_by: "a load picked up or put down during the session",
        confused_with: &["friction_drift", "gain_drift"],
        compensation: None,
        shared_clock: true,
        ..Definition::PLAIN
    };

    const THRESHOLD: bool = true;

    fn inertia<R: Real>(p: &[R], t: R, _memory: &Memory<R>) -> R {
        if t >= p[1] { R::ONE + p[0] } else { R::ONE }
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::InertiaStep { share: p[0], at_s: p[1] }
    }
}
