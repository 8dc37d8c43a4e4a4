//! The gain of drive and motor falls as they warm up, or as the battery empties.

use super::{ActsIn, Definition, Element, Held, Instant, Law, Memory, Parameter, Role};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Drive gain drift: `u_a = u·(1 − k·t)`.
#[derive(Clone, Copy, Debug)]
pub struct GainDrift;

impl Law for GainDrift {
    const DEFINITION: Definition = Definition {
        name: "gain_drift",
        title: "Drive gain drift",
        law: "u_a = u·(1 − k·t)",
        acts_in: ActsIn::Drive,
        parameters: &[
            Parameter::new(Role::Rate, "k", "relative loss of gain per second", -1.0, 1.0),
        ],
        shown_by: "long sessions",
        confused_with: &["friction_drift"],
        compensation: None,
        shared_clock: true,
        ..Definition::PLAIN
    };

    const ALONG_THE_DRIVE: u8 = 1;

    fn drive<R: Real>(p: &[R], at: &Instant<R>, _past: Held<'_>, _memory: &mut Memory<R>, _h: f64) -> R {
        at.u * (R::ONE - p[0] * at.t)
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::DriveGainDrift { rate: p[0] }
    }
}
