//! A force periodic in time: a fan, another machine on the same frame.

use super::{ActsIn, Definition, Instant, Law, Over, Parameter, Search};
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
            Parameter::new("A", "U", "amplitude", -1e9, 1e9),
            Parameter::new("omega", "rad/s", "angular frequency", 1e-9, 1e9).search(Search::Spectrum(Over::Time)),
            Parameter::new("phi", "rad", "phase at t = 0", -1e9, 1e9).search(Search::Phase),
        ],
        shown_by: "any record, over the session",
        confused_with: &["cogging"],
        compensation: None,
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        p[0] * (p[1] * at.t + p[2]).sin()
    }
}
