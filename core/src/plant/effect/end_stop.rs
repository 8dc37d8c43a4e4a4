//! A stop, a cable that is pulled tight, or a bellows that is pressed flat pushes back from one position on.

use super::{ActsIn, Definition, Element, Instant, Law, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// End stop: `−|k|·(x − x0) where k·(x − x0) > 0`.
#[derive(Clone, Copy, Debug)]
pub struct EndStop;

impl Law for EndStop {
    const DEFINITION: Definition = Definition {
        name: "end_stop",
        title: "End stop",
        law: "−|k|·(x − x0) where k·(x − x0) > 0",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Stiffness, "k", "stiffness; negative: the stop lies below x0", -1e9, 1e9),
            Parameter::new(Role::Position, "x0", "where the stop begins", -1e9, 1e9)
                .search(Search::Grid(Scale::Extent, &[0.4, 0.6, 0.8, 0.9])),
        ],
        shown_by: "travel to the end, several times",
        confused_with: &["spring", "gravity_load"],
        compensation: None,
        repeats: true,
        ..Definition::PLAIN
    };

    fn force<R: Real>(p: &[R], at: &Instant<R>) -> R {
        let pressed = p[0] * (at.x - p[1]);
        if pressed <= R::ZERO {
            R::ZERO
        } else if p[0] > R::ZERO {
            -pressed
        } else {
            pressed
        }
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::Stop { stiffness: p[0], begins: p[1] }
    }
}
