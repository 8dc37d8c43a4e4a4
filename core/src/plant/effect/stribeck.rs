//! Friction falls with speed, from boundary to mixed lubrication. The exponent is a refinement; its usual value is 2.

use super::lugre::HAS_THE_CURVE;
use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Parameter, Relation, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Stribeck friction: `−s·e^(−(|v|/vs)^p)·sgn v`.
#[derive(Clone, Copy, Debug)]
pub struct Stribeck;

impl Law for Stribeck {
    const DEFINITION: Definition = Definition {
        name: "stribeck",
        title: "Stribeck friction",
        law: "−s·e^(−(|v|/vs)^p)·sgn v",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Level, "s", "rise of friction towards rest", 0.0, 1e9),
            Parameter::new(Role::Speed, "vs", "Stribeck velocity", 1e-12, 1e9)
                .search(Search::Grid(Scale::Speed, &[0.015, 0.03, 0.06, 0.12, 0.25])),
            Parameter::new(Role::Exponent, "p", "exponent", 0.5, 4.0).refinement(2.0),
        ],
        shown_by: "slow motion",
        confused_with: &["stiction", "lugre", "quadratic_drag"],
        compensation: Some("feed-forward along the reference, with sgn of the reference velocity"),
        excludes: &[Relation { name: "lugre", why: HAS_THE_CURVE }],
        ..Definition::PLAIN
    };

    fn level<R: Real>(p: &[R], _base: &Base<R>, at: &Instant<R>) -> R {
        let r = at.v.abs() / p[1];
        let r2 = r * r;
        // Past six Stribeck velocities the term is below e⁻³⁶ for p = 2.
        if r2 > R::from_f64(36.0) {
            return R::ZERO;
        }
        let exponent = if p[2] == R::from_f64(2.0) {
            r2
        } else if r > R::from_f64(1e-9) {
            (p[2] * r.ln()).exp()
        } else {
            R::ZERO
        };
        p[0] * (-exponent).exp()
    }

    fn compensation<R: Real>(p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::Stribeck { rise: p[0], speed: p[1], exponent: p[2] })
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::LevelBySpeed { rise: p[0], speed: p[1], exponent: p[2] }
    }
}
