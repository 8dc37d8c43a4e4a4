//! The load loses contact with the motor at every reversal and meets it again a gap later. The encoder is on the motor
//! side.

use super::{ActsIn, Definition, Element, Law, Memory, Parameter, Relation, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Why no other second body stands beside this one.
pub(super) const ONE_SECOND_BODY: &str = "a model has at most one second body";
const CONTACT_YIELDS: &str =
    "a real contact yields and this one does not; the difference acts late, after reversals";

const SHARES_OF_THE_STROKE: [f64; 11] = [0.003, 0.006, 0.011, 0.02, 0.035, 0.065, 0.12, 0.22, 0.4, 0.75, 1.4];

/// Backlash: `load μ·b free within a gap ±g/2 of the motor, contact with restitution e`.
#[derive(Clone, Copy, Debug)]
pub struct Backlash;

impl Law for Backlash {
    const DEFINITION: Definition = Definition {
        name: "backlash",
        title: "Backlash",
        law: "load μ·b free within a gap ±g/2 of the motor, contact with restitution e",
        acts_in: ActsIn::Mechanics,
        parameters: &[
            Parameter::new(Role::Gap, "g", "whole width of the gap", 0.0, 1e9)
                .search(Search::Grid(Scale::Stroke, &SHARES_OF_THE_STROKE)),
            Parameter::new(Role::InertiaShare, "mu", "load share of the inertia b", 0.0, 0.98)
                .search(Search::Grid(Scale::Unit, &[0.4])),
            Parameter::new(Role::Restitution, "e", "restitution: closing speed left after an impact", 0.0, 0.95)
                .search(Search::Grid(Scale::Unit, &[0.2])),
        ],
        shown_by: "reversals, multisine",
        confused_with: &["lugre", "dahl", "flexible_coupling"],
        compensation: None,
        excludes: &[Relation { name: "flexible_coupling", why: ONE_SECOND_BODY }],
        residue: &[
            Relation { name: "load_friction", why: CONTACT_YIELDS },
            Relation { name: "delay", why: CONTACT_YIELDS },
            Relation { name: "electrical_lag", why: CONTACT_YIELDS },
            Relation { name: "dahl", why: CONTACT_YIELDS },
            Relation { name: "lugre", why: CONTACT_YIELDS },
        ],
        ..Definition::PLAIN
    };

    const REMEMBERS: bool = true;
    const FREE_MEMORY: usize = 2;

    // The memory holds the load's position y, its velocity w, and the side with which the motor pushes (−1, 0, 1). An
    // impact is a contact of at least one sub-step, even where the load leaves again.
    fn inertia<R: Real>(p: &[R], _t: R, memory: &Memory<R>) -> R {
        if memory[2] == R::ZERO { R::ONE - p[1] } else { R::ONE }
    }

    fn impact<R: Real>(p: &[R], x: &mut R, v: &mut R, memory: &mut Memory<R>, h: f64) {
        let half_gap = p[0].scale(0.5);
        let side = memory[2];
        if side != R::ZERO {
            // The load coasts, since it has no friction of its own: contact ends as soon as the motor falls behind.
            if (*v - memory[1]) * side >= R::ZERO {
                memory[1] = *v;
                memory[0] = *x - half_gap * side;
                return;
            }
            memory[2] = R::ZERO;
        }
        memory[0] += memory[1].scale(h);
        let offset = *x - memory[0];
        if offset.abs() < half_gap {
            return;
        }
        let side = offset.sgn();
        let closing = (*v - memory[1]) * side;
        if closing <= R::ZERO {
            return;
        }
        // Momentum gives the common velocity, and restitution the closing speed that is left. The part of the sub-step
        // after the impact is redone with them.
        let common = (R::ONE - p[1]) * *v + p[1] * memory[1];
        let rebound = p[2] * closing * side;
        let after = common - p[1] * rebound;
        let overlap = offset.abs() - half_gap;
        let late = (overlap / closing).min(R::from_f64(h));
        *x += (after - *v) * late;
        *v = after;
        memory[1] = common + (R::ONE - p[1]) * rebound;
        memory[0] = *x - half_gap * side + (memory[1] - after) * late;
        memory[2] = side;
    }

    fn displaced<R: Real>(p: &[R], x: R, more: [R; 2], memory: &mut Memory<R>) {
        memory[0] += more[0];
        memory[1] += more[1];
        // A load well off the face is not pushed.
        if (x - memory[0]) * memory[2] < p[0].scale(0.49) {
            memory[2] = R::ZERO;
        }
    }

    fn at_rest<R: Real>(_p: &[R], x: R) -> Memory<R> {
        [x, R::ZERO, R::ZERO]
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::LooseLoad { share: p[1], gap: p[0], restitution: p[2] }
    }
}
