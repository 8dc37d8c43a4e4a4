//! The drive loses a constant part of every command. The loss looks like Coulomb friction where the drive never
//! changes its sign before the velocity does.

use super::{ActsIn, Compensation, Definition, Element, Held, Instant, Law, Memory, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Dead zone of the drive: `u_a = u − d·sgn u, 0 for |u| < d`.
#[derive(Clone, Copy, Debug)]
pub struct DeadZone;

impl Law for DeadZone {
    const DEFINITION: Definition = Definition {
        name: "dead_zone",
        title: "Dead zone of the drive",
        law: "u_a = u − d·sgn u, 0 for |u| < d",
        acts_in: ActsIn::Drive,
        parameters: &[
            Parameter::new(Role::Threshold, "d", "half-width", 0.0, 1e9)
                .search(Search::Grid(Scale::Drive, &[0.01, 0.03, 0.1, 0.3])),
        ],
        shown_by: "small drive",
        confused_with: &["load_friction", "pwm_dead_time", "stiction"],
        compensation: Some("inverse: u + d·sgn u"),
        ..Definition::PLAIN
    };

    const ALONG_THE_DRIVE: u8 = 3;

    fn drive<R: Real>(p: &[R], at: &Instant<R>, _past: Held<'_>, _memory: &mut Memory<R>, _h: f64) -> R {
        (at.u.abs() - p[0]).max(R::ZERO) * at.u.sgn()
    }

    fn compensation<R: Real>(p: &[R], base: &Base<R>) -> Option<Compensation<R>> {
        // Within ±band the inverse is a ramp, or noise around zero would make the drive chatter by ±d. A band below the
        // break-away force costs nothing, since the axis rests there anyway.
        let band = base.f1.scale(0.5).max(p[0].scale(0.1)).max(R::from_f64(1e-9));
        Some(Compensation::DeadZone { loss: p[0], band })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::DriveDeadZone { half_width: p[0] }
    }
}
