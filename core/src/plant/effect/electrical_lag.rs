//! The current follows the voltage with a first-order lag.

use super::{ActsIn, Definition, Element, Held, Instant, Law, Memory, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Electrical lag: `τ·u̇_a = u − u_a`.
#[derive(Clone, Copy, Debug)]
pub struct ElectricalLag;

impl Law for ElectricalLag {
    const DEFINITION: Definition = Definition {
        name: "electrical_lag",
        title: "Electrical lag",
        law: "τ·u̇_a = u − u_a",
        acts_in: ActsIn::Drive,
        parameters: &[
            Parameter::new(Role::TimeConstant, "tau", "time constant L/R", 1e-9, 1.0)
                .search(Search::Grid(Scale::Unit, &[0.0002, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.016])),
        ],
        shown_by: "switching edges",
        confused_with: &["delay"],
        compensation: None,
        ..Definition::PLAIN
    };

    const ALONG_THE_DRIVE: u8 = 5;
    const REMEMBERS: bool = true;
    const SHAPES_THE_DRIVE: bool = true;
    // A sub-step in which the axis turns round takes the mean drive. A lag of a third of a sample shows how much that
    // matters (hidden plant, kind world, seed 834, 1 %). With 2, 3, 5 and 7 sub-steps it fits by 13 to 22 nats better than
    // a delay. With 1 and 4, among which the reversals fall otherwise, it fits by 1 and 3 nats worse.
    const SUB_STEPS: usize = 2;

    fn drive<R: Real>(p: &[R], at: &Instant<R>, _past: Held<'_>, memory: &mut Memory<R>, h: f64) -> R {
        let ratio = R::from_f64(h) / p[0];
        let decay = (-ratio).exp();
        let error = memory[0] - at.u;
        memory[0] = at.u + error * decay;
        let mean = error * ((R::ONE - decay) / ratio);
        memory[1] = if ratio < R::from_f64(0.05) {
            // The first terms of the same, which are differences of larger numbers there.
            error * ratio * (R::from_f64(1.0 / 12.0) - ratio * (R::from_f64(1.0 / 24.0) - ratio.scale(1.0 / 80.0)))
        } else {
            (error - mean) / ratio - mean.scale(0.5)
        };
        at.u + mean
    }

    fn lead<R: Real>(_p: &[R], memory: &Memory<R>) -> R {
        memory[1]
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::DriveLag { time_constant_s: p[0] }
    }
}
