//! Segments whose start is caught: a body that the first samples stop tells nothing of how fast it came, so that no step
//! of the fit frees it, while the measured one went on.

use rayon::prelude::*;

use super::lost::Trials;
use super::{Problem, Segment, Start};
use crate::fit::candidate::Candidate;
use crate::fit::track::{HALF_WIDTH_S, median};

/// A segment is looked at whose mean square is above this multiple of the median segment's, and of the floor: that of 400
/// samples of noise is within 1 ± 0.25.
pub(super) const CAUGHT: f64 = 1.5;
/// Of fewer segments than these the median says nothing.
const FEW: usize = 4;
/// Start velocities tried, in standard deviations of the smoothed velocity about it.
const VELOCITIES: [f64; 10] = [0.0, -0.5, 0.5, -1.0, 1.0, -1.5, 1.5, -2.5, 2.5, 4.0];
/// Then about the best of them, by these: a body that all but rests at the start leaves a narrow well.
const FINER: [f64; 3] = [0.25, 0.12, 0.06];
/// Standard deviation of the slope of a local cubic over `n` points of half-width h, in σ/h: √(75/4n), n = 21.
const SLOPE_DEVIATIONS: f64 = 0.945;
/// Steps of a mended start on its own.
const STEPS: usize = 3;
/// Share of its mean square that a start must lose to be taken in exchange.
const WORTH: f64 = 0.8;

impl Problem<'_> {
    /// Starts caught segments anew, from velocities all about the smoothed one. Whether any was exchanged.
    pub(super) fn mend(&self, candidate: &Candidate, states: &mut [Start], mse: &[f64]) -> bool {
        let typical = if mse.len() < FEW { 0.0 } else { median(mse.to_vec()) };
        let bound = CAUGHT * self.floor().max(typical);
        let smoothed = self.smoothed_initial(candidate);
        let mended: Vec<(usize, Start)> = mse
            .par_iter()
            .enumerate()
            .filter(|(_, mse)| mse.is_nan() || **mse > bound)
            .filter_map(|(i, mse)| Some((i, self.freed(candidate, self.segments[i], states[i], smoothed[i], *mse)?)))
            .collect();
        for (i, start) in &mended {
            states[*i] = *start;
        }
        !mended.is_empty()
    }

    /// A start from which the segment's mean square is well below `mse`.
    fn freed(&self, candidate: &Candidate, segment: Segment, old: Start, smoothed: Start, mse: f64) -> Option<Start> {
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
        trials.find_lost();
        if trials.mse.is_infinite() {
            return None;
        }
        let mut best = trials.start;
        let mut normal = self.normal_any(candidate, &[], segment, best);
        for _ in 0..STEPS {
            let Some(next) = self.start_step(candidate, &normal, (segment, best), 0, 1e-3) else { break };
            let stepped = self.normal_any(candidate, &[], segment, next);
            if stepped.mse.is_nan() || stepped.mse >= normal.mse {
                break;
            }
            (best, normal) = (next, stepped);
        }
        (normal.mse < WORTH * mse).then_some(best)
    }
}
