//! An unbalanced mass turns with a rotary axis. The position x is in radians.

use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Parameter, Role};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Gravity load: `+m·sin(x + φ)`.
#[derive(Clone, Copy, Debug)]
pub struct GravityLoad;

impl Law for GravityLoad {
    const DEFINITION: Definition = Definition {
        name: "gravity_load",
        title: "Gravity load",
        law: "+m·sin(x + φ)",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Amplitude, "m", "amplitude", -1e9, 1e9),
            Parameter::phase("phi", 0, "phase"),
        ],
        shown_by: "large angles",
        confused_with: &["cogging"],
        compensation: Some("feed-forward along the reference"),
        needs_angle: true,
        phase_per_recording: true,
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        p[0] * (at.x + p[1]).sin()
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::Ripple { wave_number: R::ONE, first: [-p[0], p[1]], second: [R::ZERO; 2] })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Ripple { wave_number: 1.0, first: [p[0], p[1]], second: [0.0; 2] }
    }
}
