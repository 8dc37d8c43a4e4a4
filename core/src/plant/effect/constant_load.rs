//! A constant force. On one axis it is the same effect as Coulomb friction that differs between the directions.

use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Parameter, Role};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Constant load: `−f0`.
#[derive(Clone, Copy, Debug)]
pub struct ConstantLoad;

impl Law for ConstantLoad {
    const DEFINITION: Definition = Definition {
        name: "constant_load",
        title: "Constant load",
        law: "−f0",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Level, "f0", "load; positive resists positive motion", -1e9, 1e9),
        ],
        shown_by: "any record with motion in both directions",
        confused_with: &[],
        compensation: Some("feed-forward f0"),
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], _at: &Instant<R>) -> R {
        -p[0]
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::Linear { constant: p[0], stiffness: R::ZERO })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Constant { force: -p[0] }
    }
}
