//! A conductor moves through a magnet's field. The drag rises with the speed, peaks, and falls again.

use super::{ActsIn, Definition, Instant, Law, Parameter, Role, Scale, Search};
use crate::scalar::Real;

/// Eddy-current brake: `−F·2(v/v0)/(1 + (v/v0)²)`.
#[derive(Clone, Copy, Debug)]
pub struct EddyBrake;

impl Law for EddyBrake {
    const DEFINITION: Definition = Definition {
        name: "eddy_brake",
        title: "Eddy-current brake",
        law: "−F·2(v/v0)/(1 + (v/v0)²)",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Level, "F", "largest drag", 0.0, 1e9),
            Parameter::new(Role::Speed, "v0", "speed of the largest drag", 1e-12, 1e9)
                .search(Search::Grid(Scale::Speed, &[0.2, 0.5, 1.0, 2.0])),
        ],
        shown_by: "levels of speed",
        confused_with: &["stribeck", "quadratic_drag"],
        compensation: None,
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        let r = at.v / p[1];
        -(p[0] * (r + r) / (R::ONE + r * r))
    }
}
