//! The friction level at rest is higher than in the slowest sliding.

use super::dahl::BRISTLES_AT_REST;
use super::{ActsIn, Definition, Element, Law, Parameter, Relation, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Stiction: `break-away level f1 + s at rest only`.
#[derive(Clone, Copy, Debug)]
pub struct Stiction;

impl Law for Stiction {
    const DEFINITION: Definition = Definition {
        name: "stiction",
        title: "Stiction",
        law: "break-away level f1 + s at rest only",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Level, "s", "rise of the level at rest", 0.0, 1e9)
                .search(Search::Grid(Scale::Coulomb, &[0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2])),
        ],
        shown_by: "slow sine through rest, stick phases",
        confused_with: &["stribeck"],
        compensation: None,
        excludes: &[
            Relation { name: "dahl", why: BRISTLES_AT_REST },
            Relation { name: "lugre", why: BRISTLES_AT_REST },
        ],
        ..Definition::PLAIN
    };

    const THRESHOLD: bool = true;

    fn breakaway<R: Real>(p: &[R]) -> R {
        p[0]
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::LevelAtRest { rise: p[0] }
    }
}
