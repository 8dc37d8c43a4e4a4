//! A spring, a hose or a cable chain pulls the axis to a rest position.

use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Spring or cable: `−k·(x − x0)`.
#[derive(Clone, Copy, Debug)]
pub struct Spring;

impl Law for Spring {
    const DEFINITION: Definition = Definition {
        name: "spring",
        title: "Spring or cable",
        law: "−k·(x − x0)",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Stiffness, "k", "stiffness", -1e9, 1e9),
            Parameter::new(Role::Position, "x0", "rest position", -1e9, 1e9)
                .search(Search::Grid(Scale::Extent, &[0.0, 0.3, -0.3, 1.0, -1.0])),
        ],
        shown_by: "long travel",
        confused_with: &["constant_load"],
        compensation: Some("feed-forward along the reference"),
        generalises: &["constant_load"],
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        -(p[0] * (at.x - p[1]))
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::Linear { constant: -p[0] * p[1], stiffness: p[0] })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Spring { stiffness: p[0], rest: p[1] }
    }
}
