//! The held-out part of a machine's recordings, and how well a model simulates it.

use breakaway_core::plant::effect::Memory;

use crate::fit::{Candidate, MeasuredMotion, Problem, SCORE_ITERATIONS, Segment, median, sampled, segments, session};
use crate::recording::Recording;

/// Length of a window to which its start is fitted, as a share of the window: 0.4 s of 1 s, as in a discovery.
const START_SHARE: f64 = 0.4;
/// Most windows that are simulated; more are thinned evenly.
const MOST_WINDOWS: usize = 80;

/// A window, measured and simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Time, s.
    pub t: Vec<f64>,
    /// Applied drive.
    pub u: Vec<f64>,
    /// Measured position.
    pub measured: Vec<f64>,
    /// Simulated from `start` under `u`.
    pub simulated: Vec<f64>,
    /// Position and velocity at the first sample.
    pub start: [f64; 2],
    /// What the effects remember there, in their order.
    pub memory: Vec<Memory<f64>>,
}

/// How well a model simulates what is held out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Root mean square error, position units.
    pub rmse: f64,
    /// The same of an axis that stands still where the window begins.
    pub standstill_rmse: f64,
    /// Windows.
    pub windows: usize,
}

/// Whether the last third of every recording holds a segment: what a discovery holds out without `--holdout`.
fn is_held_out(tracks: &[MeasuredMotion], segment: &Segment) -> bool {
    segment.start * 3 >= tracks[segment.track].t.len() * 2
}

/// The windows of `window_s` in the last third of every recording, simulated. The start of each is fitted to its
/// beginning, and the rest goes on without the measurement.
pub fn windows(model: &Candidate, recordings: &[Recording], window_s: f64) -> Vec<Window> {
    let tracks = session(recordings);
    let mut held_out = segments(&tracks, window_s);
    held_out.retain(|segment| is_held_out(&tracks, segment));
    let held_out = sampled(held_out, MOST_WINDOWS);
    let sigma = median(tracks.iter().map(|track| track.sigma).collect());
    let simulated = |segment: &Segment| {
        let track = &tracks[segment.track];
        let len = ((START_SHARE * window_s / track.ts).round() as usize).clamp(2, segment.len);
        let beginning = [Segment { len, ..*segment }];
        let problem = Problem {
            tracks: &tracks,
            segments: &beginning,
            sigma,
            warm_up_s: 0.3,
            softening: 0.0,
            coarse: false,
            work: None,
        };
        let start = problem
            .fit(model, &[], None, SCORE_ITERATIONS)
            .map_or_else(|_| problem.smoothed_initial(model)[0], |fitted| fitted.initial[0]);
        let range = segment.start..segment.start + segment.len;
        Window {
            t: track.t[range.clone()].to_vec(),
            u: track.u[range.clone()].to_vec(),
            measured: track.x[range].to_vec(),
            simulated: problem.positions(model, *segment, start),
            start: [start[0], start[1]],
            memory: problem.memory_at(model, *segment, start),
        }
    };
    held_out.iter().map(simulated).collect()
}

/// Root mean square of the differences of `positions` of the windows from the measured ones.
pub fn rmse<'a>(windows: &'a [Window], positions: impl Fn(&'a Window) -> &'a [f64]) -> f64 {
    let (mut square, mut samples) = (0.0, 0);
    for window in windows {
        square += window.measured.iter().zip(positions(window)).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        samples += window.measured.len();
    }
    (square / samples.max(1) as f64).sqrt()
}

/// The score of a model over such windows; `None` without one.
pub fn score(model: &Candidate, recordings: &[Recording], window_s: f64) -> Option<Score> {
    let windows = windows(model, recordings, window_s);
    let still = |window: &Window| window.measured.iter().map(|x| (x - window.measured[0]).powi(2)).sum::<f64>();
    let samples: usize = windows.iter().map(|window| window.measured.len()).sum();
    (samples > 0).then(|| Score {
        rmse: rmse(&windows, |window| &window.simulated),
        standstill_rmse: (windows.iter().map(still).sum::<f64>() / samples as f64).sqrt(),
        windows: windows.len(),
    })
}
