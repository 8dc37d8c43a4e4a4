//! Viscous friction that differs between the directions: c + d forward, c − d backward.

use super::{ActsIn, Definition, Instant, Law, Parameter};
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
            Parameter::new("d", "U·s/X", "half the difference of viscous friction between the directions", -1e9, 1e9),
        ],
        shown_by: "both directions at several speeds",
        confused_with: &["constant_load"],
        compensation: Some("feed-forward d·|v|"),
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        -(p[0] * at.v.abs())
    }
}
