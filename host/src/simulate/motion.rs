//! The motion of a simulated plant from sample to sample: of the simulated axis and of the virtual board alike.

use breakaway_core::plant::{Base, Drive, Effect, Kind, Plant, State};

use super::exact::Exact;

/// Sub-steps per sample beyond what the effects' bandwidth asks for.
const REFINEMENT: usize = 4;

/// A plant under way.
#[derive(Clone, Debug)]
pub struct SimulatedMotion {
    base: Base<f64>,
    effects: Vec<Effect<f64>>,
    method: Method,
}

/// How the motion is computed.
#[derive(Clone, Copy, Debug)]
enum Method {
    /// Closed form between events: base plant, with or without constant load.
    Exact(Exact),
    /// Sub-steps: any effects.
    Stepped(State<f64>),
}

impl SimulatedMotion {
    /// At rest at position 0.
    pub fn at_rest(base: Base<f64>, effects: &[Effect<f64>]) -> Self {
        let exact = effects.iter().all(|effect| effect.kind == Kind::ConstantLoad);
        let method = if exact {
            Method::Exact(Exact::at_rest(base, effects.iter().map(|effect| effect.p[0]).sum(), 0.0))
        } else {
            Method::Stepped(Plant { base, effects }.at_rest(0.0))
        };
        Self { base, effects: effects.to_vec(), method }
    }

    /// True position.
    pub const fn position(&self) -> f64 {
        match &self.method {
            Method::Exact(exact) => exact.x,
            Method::Stepped(state) => state.x,
        }
    }

    /// The position as its sensor has it, without noise and rounding.
    pub fn measured(&self) -> f64 {
        Plant { base: self.base, effects: &self.effects }.measured(self.position())
    }

    /// Sub-steps that a sample of `ts` seconds needs.
    pub fn sub_steps(&self, ts: f64) -> usize {
        Plant { base: self.base, effects: &self.effects }.sub_steps(ts) * REFINEMENT
    }

    /// One sample under the last drive of `drive`; the drives before it are those that a delay reads.
    pub fn advance(&mut self, drive: Drive<'_>, sub_steps: usize) {
        match &mut self.method {
            Method::Exact(exact) => exact.advance(drive.u.last().copied().unwrap_or(0.0), drive.ts),
            Method::Stepped(state) => {
                Plant { base: self.base, effects: &self.effects }.advance(state, drive, sub_steps);
            }
        }
    }
}
