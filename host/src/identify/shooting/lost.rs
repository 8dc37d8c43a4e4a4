//! Second bodies that are lost: among impacts the motion before a segment does not say where a body within a gap is (the least
//! difference grows from each to the next), and no step of the fit leads from one order of impacts to another.

use std::ops::ControlFlow;

use breakaway_core::plant::{Plant, State};

use super::mend::{CAUGHT, Nearest};
use super::warm_up::placed;
use super::{Problem, Segment};
use crate::identify::candidate::Candidate;

/// Positions tried over the gap to either side, and velocities up to twice the segment's typical speed to either side.
const WIDE: i32 = 4;
/// Then about the best, in steps of a third, so many times, so many to either side.
const CLOSER: usize = 3;
const NARROW: i32 = 2;

impl Problem<'_> {
    /// Seeks a second body all over its gap, the motor's own start as it is in `nearest`.
    pub(super) fn find_lost(&self, candidate: &Candidate, segment: Segment, warm: &State<f64>, nearest: &mut Nearest) {
        let mut effects = candidate.effects.iter().zip(&warm.memory);
        let Some((effect, said)) = effects.find(|(effect, _)| effect.kind.free_memory() > 0) else { return };
        let Some(gap) = effect.kind.gap().map(|i| effect.p[i]) else { return };
        if nearest.mse < CAUGHT * self.floor() {
            return;
        }
        let plant = Plant { base: candidate.base, effects: &candidate.effects };
        let [x, v, ..] = nearest.start;
        let mut step = [0.5 * gap / f64::from(WIDE), 2.0 * self.typical_speed(segment) / f64::from(WIDE)];
        let mut about = [x - said[0], -said[1]];
        for round in 0..=CLOSER {
            let wide = if round == 0 { WIDE } else { NARROW };
            for (i, k) in (-wide..=wide).flat_map(|i| (-wide..=wide).map(move |k| (i, k))) {
                let start = [x, v, about[0] + f64::from(i) * step[0], about[1] + f64::from(k) * step[1]];
                if let Some(mse) = self.below(nearest.mse, &plant, segment, placed(&plant, warm, start)) {
                    *nearest = Nearest { mse, start };
                }
            }
            about = [nearest.start[2], nearest.start[3]];
            step = step.map(|step| step / 3.0);
        }
    }

    /// The mean square of a segment from a state, if it is below `bound`.
    pub(super) fn below(&self, bound: f64, plant: &Plant<'_, f64>, segment: Segment, state: State<f64>) -> Option<f64> {
        let track = &self.tracks[segment.track];
        let most = bound * segment.len as f64;
        let mut square = 0.0;
        self.simulate_from(plant, self.sub_steps(plant, segment), segment, state, |k, x| {
            square += (track.weight(k) * (track.x[k] - x)).powi(2);
            if square < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        (square < most).then(|| square / segment.len as f64)
    }
}
