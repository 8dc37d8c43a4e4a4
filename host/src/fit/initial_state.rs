//! Initial states of the segments: the smoothed motion as a start, and a step of one segment alone, with the parameters
//! held.

use rayon::prelude::*;

use super::normal::Normal;
use super::settings::{JUMP, SENSOR_STEP, START_DAMPING};
use super::statistics::root_mean_square;
use super::{Candidate, Free, Problem, Segment, Start};

/// Starts after a step, with the starts before it.
pub(super) struct Stepped<'a> {
    pub(super) old: &'a [Start],
    pub(super) old_mse: &'a [f64],
    pub(super) new: Vec<Start>,
    /// Whether only the mean squares are needed, because no step follows.
    pub(super) last: bool,
}

/// A step of a start's position alone; not finite if the segment does not show the position.
fn position_step(normal: &Normal, [x, v, y, w]: Start) -> Start {
    [x + normal.gradient[0] / normal.hessian[(0, 0)], v, y, w]
}

impl Problem<'_> {
    /// Initial states from the smoothed motion, less what the candidate's sensor adds to it.
    pub fn smoothed_initial(&self, candidate: &Candidate) -> Vec<Start> {
        let reading = |x: f64| candidate.effects.iter().map(|effect| effect.sensor(x)).sum::<f64>();
        let start = |s: &Segment| {
            let (measured, speed) = (self.tracks[s.track].xs[s.start], self.tracks[s.track].vs[s.start]);
            let x = (0..4).fold(measured, |x, _| measured - reading(x));
            let slope = (reading(x + SENSOR_STEP) - reading(x - SENSOR_STEP)) / (2.0 * SENSOR_STEP);
            [x, speed / (1.0 + slope).max(0.1), 0.0, 0.0]
        };
        self.segments.iter().map(start).collect()
    }

    /// Root mean square of the smoothed velocity over a segment, position units/s.
    pub(super) fn typical_speed(&self, segment: Segment) -> f64 {
        let v = &self.tracks[segment.track].vs[segment.start..segment.start + segment.len];
        root_mean_square(v.iter().copied())
    }

    /// Largest changes of a start, which bound its step: of position and velocity, and of both for a second body.
    pub(super) fn start_scales(&self, segment: Segment) -> Start {
        let track = &self.tracks[segment.track];
        let range = segment.start..segment.start + segment.len;
        let speed = self.typical_speed(segment);
        let x = &track.xs[range];
        let travel = x.iter().copied().fold(f64::MIN, f64::max) - x.iter().copied().fold(f64::MAX, f64::min);
        let velocity = speed + 100.0 * self.sigma;
        [100.0 * self.sigma + travel, velocity, 10.0 * self.sigma + 0.2 * travel, velocity]
    }

    /// A step of one segment's start alone, with the parameters held; `None` if its equations are singular.
    pub(super) fn start_step(
        &self,
        candidate: &Candidate,
        normal: &Normal,
        at: (Segment, Start),
        p: usize,
        damping: f64,
    ) -> Option<Start> {
        let (local, gradient) = self.local_equations(candidate, normal, at, p, damping);
        let step = local.cholesky()?.solve(&gradient);
        Some(std::array::from_fn(|i| at.1[i] + step.get(i).copied().unwrap_or(0.0)))
    }

    /// Evaluates every segment from its stepped start. A step can make a segment worse, where a reversal or a release
    /// jumps to another sample. Then the old start, and a step of the start alone, are tried too. Otherwise a few
    /// segments would block the step of all.
    pub(super) fn best_initial_states(
        &self,
        candidate: &Candidate,
        free: &[Free],
        stepped: Stepped<'_>,
    ) -> (Vec<Start>, Vec<Normal>) {
        let Stepped { old, old_mse, new, last } = stepped;
        let floor = self.floor();
        let best_of = |i: usize, start: Start| {
            let segment = self.segments[i];
            let cost = |start: &Start, normal: &Normal| {
                0.5 * segment.len as f64 * (floor + normal.mse).ln()
                    + self.memory_cost(std::slice::from_ref(start), candidate)
            };
            let full = |start: Start| self.normal(candidate, free, segment, start);
            let run = |start: Start| (start, if last { self.residual(candidate, segment, start) } else { full(start) });
            let mut best = run(start);
            if best.1.mse <= (JUMP * old_mse[i]).max(2.0 * floor) {
                return best;
            }
            let before = run(old[i]);
            if cost(&before.0, &before.1) < cost(&best.0, &best.1) {
                best = before;
            }
            let equations = if last { &full(best.0) } else { &best.1 };
            let step = self.start_step(candidate, equations, (segment, best.0), free.len(), START_DAMPING);
            // A body at rest hardly shows its velocity, whose step then ends far off. With the model held few steps
            // follow. So the position may step alone.
            let position = free.is_empty().then(|| position_step(equations, best.0));
            for next in [step, position].into_iter().flatten().filter(|start| start[0].is_finite()) {
                let next = run(next);
                if cost(&next.0, &next.1) < cost(&best.0, &best.1) {
                    best = next;
                    break;
                }
            }
            best
        };
        new.into_par_iter().enumerate().with_min_len(8).map(|(i, start)| best_of(i, start)).unzip()
    }
}
