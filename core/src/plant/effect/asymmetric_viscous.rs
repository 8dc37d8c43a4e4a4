//! Viscous friction that differs between the directions: c + d forward, c − d backward.

use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Parameter, Role};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Asymmetric viscous friction: `−d·|v|`.
#[derive(Clone, Copy, Debug)]
pub struct AsymmetricViscous;

impl Law for AsymmetricViscous {
    const DEFINITION: Definition = Definition {
        name: "asymmetric_viscous",
        title: "Asymmetric viscous friction",
        law: "−d·|v|",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Damping, "d", "half the difference of c between the directions", -1e9, 1e9),
        ],
        shown_by: "both directions at several speeds",
        confused_with: &["constant_load"],
        compensation: Some("feed-forward d·|v|"),
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        -(p[0] * at.v.abs())
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::Drag { by_speed: p[0], by_square: R::ZERO })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Drag { by_speed: p[0], by_square: 0.0 }
    }
}
