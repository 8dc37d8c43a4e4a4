//! Several starts for segments that are stuck. A simulated body that the first samples stop tells nothing of how fast
//! it came. The measured body went on, and no step of the fit frees the simulated one.

use rayon::prelude::*;

use super::grid_search::Trials;
use super::settings::{DAMPING, FEW, FINER, HALF_WIDTH_S, SLOPE_DEVIATIONS, STEPS, STUCK, VELOCITIES, WORTH};
use super::statistics::median;
use super::{Candidate, Problem, Segment, Start};

impl Problem<'_> {
    /// Starts stuck segments anew, from velocities about the smoothed one. Says whether any start was exchanged.
    pub(super) fn restart_stuck(&self, candidate: &Candidate, states: &mut [Start], mse: &[f64]) -> bool {
        let typical = if mse.len() < FEW { 0.0 } else { median(mse.to_vec()) };
        let bound = STUCK * self.floor().max(typical);
        let smoothed = self.smoothed_initial(candidate);
        let restarted: Vec<(usize, Start)> = mse
            .par_iter()
            .enumerate()
            .filter(|(_, mse)| mse.is_nan() || **mse > bound)
            .filter_map(|(i, mse)| {
                Some((i, self.restarted(candidate, self.segments[i], states[i], smoothed[i], *mse)?))
            })
            .collect();
        for (i, start) in &restarted {
            states[*i] = *start;
        }
        !restarted.is_empty()
    }

    /// A start from which the segment's mean square is below .8 of `mse`; `None` if there is none.
    fn restarted(
        &self,
        candidate: &Candidate,
        segment: Segment,
        old: Start,
        smoothed: Start,
        mse: f64,
    ) -> Option<Start> {
        let mut trials = Trials::new(self, candidate, segment, old);
        let deviation = SLOPE_DEVIATIONS * self.sigma / HALF_WIDTH_S;
        let [x, v, ..] = smoothed;
        let forgotten = Some([0.0; 2]).filter(|forgotten| old[2..] != *forgotten);
        for [y, w] in [Some([old[2], old[3]]), forgotten].into_iter().flatten() {
            for k in VELOCITIES {
                trials.run([x, v + k * deviation, y, w]);
            }
        }
        for share in FINER {
            let [x, v, y, w] = trials.start;
            for k in [-share, share] {
                trials.run([x, v + k * deviation, y, w]);
            }
        }
        trials.search_gap();
        if trials.mse.is_infinite() {
            return None;
        }
        let mut best = trials.start;
        let mut normal = self.normal(candidate, &[], segment, best);
        for _ in 0..STEPS {
            let Some(next) = self.start_step(candidate, &normal, (segment, best), 0, DAMPING) else { break };
            let stepped = self.normal(candidate, &[], segment, next);
            if stepped.mse.is_nan() || stepped.mse >= normal.mse {
                break;
            }
            (best, normal) = (next, stepped);
        }
        (normal.mse < WORTH * mse).then_some(best)
    }
}
