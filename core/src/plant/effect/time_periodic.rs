//! A force is periodic in time: a fan, or another machine on the same frame, shakes the axis.

use super::{ActsIn, Definition, Element, Instant, Law, Over, Parameter, Role, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Time-periodic disturbance: `+A·sin(ω·t + φ)`.
#[derive(Clone, Copy, Debug)]
pub struct TimePeriodic;

impl Law for TimePeriodic {
    const DEFINITION: Definition = Definition {
        name: "time_periodic",
        title: "Time-periodic disturbance",
        law: "+A·sin(ω·t + φ)",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Amplitude, "A", "amplitude", -1e9, 1e9),
            Parameter::new(Role::AngularFrequency, "omega", "angular frequency", 1e-9, 1e9)
                .search(Search::Spectrum(Over::Time)),
            Parameter::phase("phi", 0, "phase at t = 0"),
        ],
        shown_by: "any record, over the session",
        confused_with: &["cogging"],
        compensation: None,
        generalises: &["constant_load"],
        shared_clock: true,
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        p[0] * (p[1] * at.t + p[2]).sin()
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Shaking { amplitude: p[0], angular_frequency: p[1], phase: p[2] }
    }
}
