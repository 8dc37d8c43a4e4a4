//! Friction grows with the transmitted force, as in gears, worm drives and ball screws.

use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Parameter, Role};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Load-dependent friction: `−k·|u|·sgn v`.
#[derive(Clone, Copy, Debug)]
pub struct LoadFriction;

impl Law for LoadFriction {
    const DEFINITION: Definition = Definition {
        name: "load_friction",
        title: "Load-dependent friction",
        law: "−k·|u|·sgn v",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Ratio, "k", "friction per unit of drive", -1.0, 1.0),
        ],
        shown_by: "several levels of drive",
        confused_with: &["dead_zone"],
        compensation: Some("feed-forward k·|u|"),
        ..Definition::PLAIN
    };

    fn level<R: Real>(p: &[R], _base: &Base<R>, at: &Instant<R>) -> R {
        p[0] * at.u.abs()
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::LevelOfDrive { ratio: p[0] })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::LevelByDrive { ratio: p[0] }
    }
}
