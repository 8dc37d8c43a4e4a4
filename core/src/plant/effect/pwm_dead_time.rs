//! A bridge loses voltage in its dead time, against the direction of the current.

use super::{
    ActsIn, Compensation, Definition, Effect, Element, Held, Instant, Kind, Law, Memory, Parameter, Role, Scale, Search,
};
use crate::plant::base::Base;
use crate::scalar::Real;

/// PWM dead time: `u_a = u − d·sat(i/i0), i = u − Ke·v`.
#[derive(Clone, Copy, Debug)]
pub struct PwmDeadTime;

impl Law for PwmDeadTime {
    const DEFINITION: Definition = Definition {
        name: "pwm_dead_time",
        title: "PWM dead time",
        law: "u_a = u − d·sat(i/i0), i = u − Ke·v",
        acts_in: ActsIn::Drive,
        parameters: &[
            Parameter::new(Role::Level, "d", "voltage lost", 0.0, 1e9),
            Parameter::new(Role::Threshold, "i0", "width of the transition", 1e-9, 1e9)
                .search(Search::Grid(Scale::Drive, &[0.02, 0.06, 0.15])),
            Parameter::new(Role::BackEmf, "Ke", "back-EMF constant", 0.0, 1e9)
                .search(Search::Grid(Scale::Viscous, &[0.5])),
        ],
        shown_by: "several levels of drive and speed",
        confused_with: &["dead_zone"],
        compensation: Some("inverse: u + d·sat(i/i0)"),
        ..Definition::PLAIN
    };

    const ALONG_THE_DRIVE: u8 = 4;

    fn drive<R: Real>(p: &[R], at: &Instant<R>, _past: Held<'_>, _memory: &mut Memory<R>, _h: f64) -> R {
        let i = (at.u - p[2] * at.v) / p[1];
        at.u - p[0] * i.min(R::ONE).max(-R::ONE)
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        // The map from i to i − d·sat(i/i0) is invertible for i0 > d. For smaller i0 the slope of the inverse stays
        // below 1 + 10·d/i0.
        let edge = (p[1] - p[0]).max(p[1].scale(0.1)).max(R::from_f64(1e-9));
        Some(Compensation::DeadTime { loss: p[0], edge, back_emf: p[2] })
    }

    fn in_the_place_of(other: &Effect<f64>) -> Option<Effect<f64>> {
        // No back-EMF, and a transition as wide as the loss: below it the whole drive is lost.
        let d = other.p[0];
        (other.kind == Kind::DeadZone)
            .then(|| Effect::new(Kind::PwmDeadTime, &[d, d.max(Self::DEFINITION.parameters[1].min), 0.0]))
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::DriveDeadTime { loss: p[0], edge: p[1], back_emf: p[2] }
    }
}
