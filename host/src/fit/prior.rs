//! The prior of a second body's start: it is near where the motion before the segment leaves it. Among impacts it may
//! be anywhere.

use super::settings::{LOST, MEMORY_DEVIATIONS};
use super::{Candidate, Problem, Start};

/// The prior of a second body's start, about the state that the motion before leaves.
#[derive(Clone, Copy)]
pub(super) struct Prior {
    /// Standard deviations of position and velocity.
    deviations: [f64; 2],
    /// Most nats that a start costs; infinite without a gap.
    most: f64,
}

impl Prior {
    /// Half the sum of squares of a start in its deviations.
    fn surprise(&self, start: Start) -> f64 {
        0.5 * ((start[2] / self.deviations[0]).powi(2) + (start[3] / self.deviations[1]).powi(2))
    }

    /// Minus the logarithm of the prior, at most `most`.
    fn cost(&self, start: Start) -> f64 {
        let surprise = self.surprise(start);
        surprise / (1.0 + surprise / self.most)
    }

    /// Precisions of position and velocity at a start.
    pub(super) fn precisions(&self, start: Start) -> [f64; 2] {
        let slope = (1.0 + self.surprise(start) / self.most).powi(-2);
        self.deviations.map(|deviation| slope / (deviation * deviation))
    }
}

impl Problem<'_> {
    pub(super) fn prior(&self, candidate: &Candidate) -> Prior {
        let position = MEMORY_DEVIATIONS * self.sigma;
        let within_a_gap = candidate.effects.iter().any(|effect| effect.kind.gap().is_some());
        Prior {
            deviations: [position, position * 0.1 / self.tracks[0].ts],
            most: if within_a_gap { LOST } else { f64::INFINITY },
        }
    }

    /// Minus the log prior of the second bodies' starts, nats.
    pub(super) fn memory_cost(&self, states: &[Start], candidate: &Candidate) -> f64 {
        if candidate.local() < 4 {
            return 0.0;
        }
        let prior = self.prior(candidate);
        states.iter().map(|start| prior.cost(*start)).sum()
    }
}
