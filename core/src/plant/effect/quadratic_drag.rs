//! A fan, a propeller or a turbulent film brakes with the square of the speed.

use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Parameter, Role};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Quadratic drag: `−k·v·|v|`.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticDrag;

impl Law for QuadraticDrag {
    const DEFINITION: Definition = Definition {
        name: "quadratic_drag",
        title: "Quadratic drag",
        law: "−k·v·|v|",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Coefficient("U·s²/X²"), "k", "drag coefficient", 0.0, 1e9),
        ],
        shown_by: "high speed",
        confused_with: &["stribeck", "saturation"],
        compensation: Some("feed-forward k·v·|v|"),
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        -(p[0] * at.v * at.v.abs())
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::Drag { by_speed: R::ZERO, by_square: p[0] })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Drag { by_speed: 0.0, by_square: p[0] }
    }
}
