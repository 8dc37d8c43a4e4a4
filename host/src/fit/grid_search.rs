//! Grid search over the initial state of a second body within a gap. Among impacts the motion before a segment does not
//! tell it: the least difference grows from each impact to the next. No step of the fit leads from one order of impacts
//! to another.

use std::ops::ControlFlow;

use breakaway_core::plant::{Plant, State};

use super::hidden_state::displaced;
use super::settings::{CLOSER, NARROW, STUCK, WIDE};
use super::{Candidate, Problem, Segment, Start};

/// Starts of a segment that are tried by simulation. The best is kept.
pub(super) struct Trials<'a> {
    problem: &'a Problem<'a>,
    plant: Plant<'a, f64>,
    segment: Segment,
    /// The state that the motion before the segment leaves.
    before: State<f64>,
    /// Mean square that the best start leaves, position units squared; infinite until one was tried.
    pub(super) mse: f64,
    /// The best start.
    pub(super) start: Start,
}

impl<'a> Trials<'a> {
    pub(super) fn new(problem: &'a Problem<'a>, candidate: &'a Candidate, segment: Segment, start: Start) -> Self {
        let plant = Plant { base: candidate.base, effects: &candidate.effects };
        let before = problem.state_before(&plant, segment);
        Self { problem, plant, segment, before, mse: f64::INFINITY, start }
    }

    /// Tries a start. Its simulation ends as soon as it is no better than the best.
    pub(super) fn run(&mut self, start: Start) {
        let track = &self.problem.tracks[self.segment.track];
        let most = self.mse * self.segment.len as f64;
        let steps = self.problem.sub_steps(&self.plant, self.segment);
        let mut square = 0.0;
        let state = displaced(&self.plant, &self.before, start);
        self.problem.simulate_from(&self.plant, steps, self.segment, state, |k, x| {
            square += (track.weight(k) * (track.x[k] - x)).powi(2);
            if square < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        if square < most {
            (self.mse, self.start) = (square / self.segment.len as f64, start);
        }
    }

    /// Seeks a second body everywhere in its gap. The motor keeps its own start.
    pub(super) fn search_gap(&mut self) {
        let mut effects = self.plant.effects.iter().zip(&self.before.memory);
        let Some((effect, said)) = effects.find(|(effect, _)| effect.kind.free_memory() > 0) else { return };
        let Some(gap) = effect.kind.gap().map(|i| effect.p[i]) else { return };
        if self.mse < STUCK * self.problem.floor() {
            return;
        }
        let [x, v, ..] = self.start;
        let fastest = 2.0 * self.problem.typical_speed(self.segment);
        let mut step = [0.5 * gap, fastest].map(|most| most / f64::from(WIDE));
        let mut about = [x - said[0], -said[1]];
        for round in 0..=CLOSER {
            let wide = if round == 0 { WIDE } else { NARROW };
            for (i, k) in (-wide..=wide).flat_map(|i| (-wide..=wide).map(move |k| (i, k))) {
                self.run([x, v, about[0] + f64::from(i) * step[0], about[1] + f64::from(k) * step[1]]);
            }
            about = [self.start[2], self.start[3]];
            step = step.map(|step| step / 3.0);
        }
    }
}
