//! The encoder's scale is off its centre, so the reading errs once per turn. The position x is in radians.

use super::{ActsIn, Definition, Element, Law, Parameter, Role};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Encoder eccentricity: `measured = x + A·sin(x + φ)`.
#[derive(Clone, Copy, Debug)]
pub struct EncoderEccentricity;

impl Law for EncoderEccentricity {
    const DEFINITION: Definition = Definition {
        name: "encoder_eccentricity",
        title: "Encoder eccentricity",
        law: "measured = x + A·sin(x + φ)",
        acts_in: ActsIn::Sensor,
        parameters: &[
            Parameter::new(Role::Eccentricity, "A", "amplitude", -1e9, 1e9),
            Parameter::phase("phi", 0, "phase"),
        ],
        shown_by: "long travel at high speed",
        confused_with: &["cogging", "gravity_load"],
        compensation: None,
        needs_angle: true,
        phase_per_recording: true,
        ..Definition::PLAIN
    };

    fn sensor<R: Real>(p: &[R], x: R) -> R {
        p[0] * (x + p[1]).sin()
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::ReadingRipple { amplitude: p[0], wave_number: 1.0, phase: p[1] }
    }
}
