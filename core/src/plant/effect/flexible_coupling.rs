//! A second inertia hangs on a shaft or a belt that gives. The encoder is on the motor side.

use super::backlash::ONE_SECOND_BODY;
use super::{ActsIn, Definition, Element, Instant, Law, Memory, Parameter, Relation, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Flexible coupling: `load μ·b behind spring and damper: ÿ = ωr²·(x − y) + 2ζ·ωr·(ẋ − ẏ)`.
#[derive(Clone, Copy, Debug)]
pub struct FlexibleCoupling;

impl Law for FlexibleCoupling {
    const DEFINITION: Definition = Definition {
        name: "flexible_coupling",
        title: "Flexible coupling",
        law: "load μ·b behind spring and damper: ÿ = ωr²·(x − y) + 2ζ·ωr·(ẋ − ẏ)",
        acts_in: ActsIn::Mechanics,
        parameters: &[
            Parameter::new(Role::InertiaShare, "mu", "load share of the inertia b", 0.0, 0.98)
                .search(Search::Grid(Scale::Unit, &[0.06])),
            Parameter::new(Role::NaturalFrequency, "omega_r", "anti-resonance (load against a fixed motor)", 1.0, 1e5)
                .search(Search::Resonance(40.0, 480.0)),
            Parameter::new(Role::DampingRatio, "zeta", "damping ratio", 0.0, 2.0)
                .search(Search::Grid(Scale::Unit, &[0.06])),
        ],
        shown_by: "multisine above the resonance",
        confused_with: &["backlash", "inertia_step", "dahl"],
        compensation: None,
        excludes: &[Relation { name: "backlash", why: ONE_SECOND_BODY }],
        ..Definition::PLAIN
    };

    const REMEMBERS: bool = true;
    const FREE_MEMORY: usize = 2;

    fn inertia<R: Real>(p: &[R], _t: R, _memory: &Memory<R>) -> R {
        R::ONE - p[0]
    }

    fn mechanics<R: Real>(p: &[R], base: &Base<R>, mid: &Instant<R>, memory: &mut Memory<R>, h: f64) -> R {
        // The memory holds the load's position and velocity; they advance by the midpoint rule.
        let half = 0.5 * h;
        let damping = (p[2] * p[1]).scale(2.0);
        let y_mid = memory[0] + memory[1].scale(half);
        let a0 = p[1] * p[1] * (mid.x - memory[0]) + damping * (mid.v - memory[1]);
        let w_mid = memory[1] + a0.scale(half);
        let a = p[1] * p[1] * (mid.x - y_mid) + damping * (mid.v - w_mid);
        memory[0] += w_mid.scale(h);
        memory[1] += a.scale(h);
        -(p[0] * base.b * a)
    }

    fn at_rest<R: Real>(_p: &[R], x: R) -> Memory<R> {
        [x, R::ZERO, R::ZERO]
    }

    fn bandwidth(p: &[f64], _base: &Base<f64>) -> f64 {
        p[1] / libm::sqrt((1.0 - p[0]).max(0.02))
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::SprungLoad { share: p[0], angular_frequency: p[1], damping_ratio: p[2] }
    }
}
