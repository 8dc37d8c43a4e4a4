//! The drive acts later than the recording says.

use super::{ActsIn, Definition, Element, Held, Instant, Law, Memory, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Share of a sample below which two instants are one.
const SHORT: f64 = 1e-6;
/// Most samples that a sub-step reaches over. It is shorter than a sample; so many bound the work on any input.
const MOST_SAMPLES: usize = 64;

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

    fn switches_at<R: Real>(p: &[R], ts: f64) -> f64 {
        let delay_s = p[0].to_f64();
        let edge_s = delay_s - ts * libm::floor(delay_s / ts);
        if edge_s > SHORT * ts && edge_s < (1.0 - SHORT) * ts { edge_s } else { 0.0 }
    }

    fn drive<R: Real>(p: &[R], at: &Instant<R>, past: Held<'_>, _memory: &mut Memory<R>, h: f64) -> R {
        if p[0] <= R::ZERO {
            return at.u;
        }
        let (ts, delay_s) = (past.ts, p[0].to_f64());
        let newest = past.u.len() as i64 - 1;
        let held = |k: f64| past.u.get(newest.saturating_add(k as i64).clamp(0, newest) as usize).copied().unwrap_or(0.0);
        // The sub-step, shifted back by τ, covers parts of held samples. The mean of u over it is exact. A longer delay
        // brings more of the sample before each edge, and less of the one after it. An edge between two sub-steps
        // belongs to each of them by half.
        let short = SHORT * ts;
        let mut from = past.from_s - delay_s;
        let to = from + h;
        let mut k = libm::floor((from + short) / ts);
        let (mut sum, mut slope) = (0.0, 0.0);
        if from - k * ts <= short {
            slope = 0.5 * (held(k - 1.0) - held(k));
        }
        for _ in 0..MOST_SAMPLES {
            let edge = (k + 1.0) * ts;
            sum += held(k) * (edge.min(to) - from);
            if edge > to + short {
                break;
            }
            let step = held(k) - held(k + 1.0);
            if edge >= to - short {
                slope += 0.5 * step;
                break;
            }
            slope += step;
            from = edge;
            k += 1.0;
        }
        R::from_f64(sum / h) + (p[0] - R::from_f64(delay_s)).scale(slope / h)
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::DriveDelay { delay_s: p[0] }
    }
}
