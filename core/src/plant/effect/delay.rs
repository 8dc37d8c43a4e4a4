//! The drive acts later than the recording says.

use super::{ActsIn, Definition, Element, Held, Instant, Law, Memory, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Delay of the drive: `u_a(t) = u(t − τ)`.
#[derive(Clone, Copy, Debug)]
pub struct Delay;

impl Law for Delay {
    const DEFINITION: Definition = Definition {
        name: "delay",
        title: "Delay of the drive",
        law: "u_a(t) = u(t − τ)",
        acts_in: ActsIn::Drive,
        parameters: &[
            Parameter::new(Role::Delay, "tau", "delay", 0.0, 1.0)
                .search(Search::Grid(Scale::Unit, &[0.0002, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.016])),
        ],
        shown_by: "switching edges",
        confused_with: &["electrical_lag"],
        compensation: None,
        ..Definition::PLAIN
    };

    const SUB_STEPS: usize = 7;

    fn drive<R: Real>(p: &[R], at: &Instant<R>, past: Held<'_>, _memory: &mut Memory<R>, h: f64) -> R {
        if p[0] <= R::ZERO {
            return at.u;
        }
        // The sub-step, shifted back by τ, covers parts of held samples. The mean of u over it is exact.
        let from = R::from_f64(past.from_s) - p[0];
        let to = from + R::from_f64(h);
        let first = libm::floor(from.to_f64() / past.ts);
        let newest = past.u.len() as i64 - 1;
        let at_sample = |k: f64| {
            let index = (newest + k as i64).clamp(0, newest) as usize;
            R::from_f64(past.u.get(index).copied().unwrap_or(0.0))
        };
        let mut sum = R::ZERO;
        let mut k = first;
        loop {
            let begin = from.max(R::from_f64(k * past.ts));
            let end = to.min(R::from_f64((k + 1.0) * past.ts));
            sum += at_sample(k) * (end - begin);
            k += 1.0;
            if k * past.ts >= to.to_f64() || k > first + 64.0 {
                break;
            }
        }
        sum / R::from_f64(h)
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::DriveDelay { delay_s: p[0] }
    }
}
