//! The magnets attract the slots: a force that is periodic in the position. The second harmonic is a refinement.
//! Lines of other wave numbers (poles, slots, gear teeth) are entries of their own.

use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Over, Parameter, Role, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Cogging (force ripple): `+A·sin(n·x + φ) + A2·sin(2n·x + φ2)`.
#[derive(Clone, Copy, Debug)]
pub struct Cogging;

impl Law for Cogging {
    const DEFINITION: Definition = Definition {
        name: "cogging",
        title: "Cogging (force ripple)",
        law: "+A·sin(n·x + φ) + A2·sin(2n·x + φ2)",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Amplitude, "A", "amplitude", -1e9, 1e9),
            Parameter::new(Role::WaveNumber, "n", "wave number", 1e-9, 1e9)
                .search(Search::Spectrum(Over::Position)),
            Parameter::phase("phi", 0, "phase"),
            Parameter::new(Role::Amplitude, "A2", "amplitude of the second harmonic", -1e9, 1e9).refinement(0.0),
            Parameter::phase("phi2", 3, "phase of the second harmonic").refinement(0.0),
        ],
        shown_by: "long travel at low speed",
        confused_with: &["encoder_eccentricity", "time_periodic", "position_friction", "gravity_load", "spring"],
        compensation: Some("feed-forward along the reference"),
        generalises: &["gravity_load", "constant_load", "spring"],
        repeats: true,
        phase_per_recording: true,
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        let angle = p[1] * at.x;
        let mut force = p[0] * at.averaged(p[1]) * (angle + p[2]).sin();
        if p[3] != R::ZERO {
            force += p[3] * at.averaged(p[1] + p[1]) * (angle + angle + p[4]).sin();
        }
        force
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::Ripple { wave_number: p[1], first: [-p[0], p[2]], second: [-p[3], p[4]] })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Ripple { wave_number: p[1], first: [p[0], p[2]], second: [p[3], p[4]] }
    }
}
