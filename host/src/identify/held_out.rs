//! Prediction of blocks of the recordings that were not fitted, and what two models differ by in it (docs/theory.md, section 5).
//!
//! The recordings are cut into contiguous blocks, which belong to two folds in turn. Models are fitted to either fold
//! and predict the other. A prediction goes [`HORIZON_S`] ahead of a state that was fitted to the samples before.
//! That lies between the 40 ms over which the weak form balances forces and the 0.4 s over which the simulation
//! follows positions. So neither estimator minimises this error on the data that it is fitted to.

use rayon::prelude::*;

use super::output_error::MAX_SEGMENTS;
use super::weak::Window;
use crate::fit::{Candidate, MeasuredMotion, Problem, SCORE_ITERATIONS, Segment};

/// Length of a block, s: three segments of the simulation's fit, and longer than friction remembers.
const BLOCK_S: f64 = 1.2;
/// How far ahead is predicted, and over how long before the state is fitted, s. Together that is 0.1 s, between 40 ms
/// and 0.4 s. Of the horizons measured (docs/theory.md, section 5) it has the largest share of right choices. Over
/// longer ones a missing force adds up, and hides the errors of the parameters.
const HORIZON_S: f64 = 0.05;
/// Samples of a horizon at the least: two are needed for a state.
const LEAST_HORIZON: usize = 4;
/// Blocks that are predicted at the most, evenly taken: enough for any test, however long the session.
const MOST_PREDICTED: usize = 60;
/// Fewest blocks that a paired test is made of.
const FEWEST: usize = 8;
/// Student's t from which two models differ, by chance once in a hundred times (two-sided). It is that of many
/// blocks, and what is added over their number less one. It is the tabulated value to 2 % from eight blocks.
const STUDENT: [f64; 2] = [2.58, 6.0];

/// Samples of one piece of a track that are fitted or predicted together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Block {
    track: usize,
    start: usize,
    end: usize,
}

/// Two models' errors of prediction, block by block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Blocks that both models predict, none of them fitted.
    pub blocks: usize,
    /// Mean over the blocks of ln(first model's error / second model's error).
    pub log_ratio: f64,
    /// Its standard error, from the scatter of the blocks.
    pub se: f64,
}

impl Comparison {
    fn of(differences: &[f64]) -> Option<Self> {
        let n = differences.len();
        if n < FEWEST {
            return None;
        }
        let mean = differences.iter().sum::<f64>() / n as f64;
        let scatter = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n * (n - 1)) as f64;
        Some(Self { blocks: n, log_ratio: mean, se: scatter.sqrt() })
    }

    /// First model's error over the second model's, geometric mean over the blocks.
    pub fn ratio(&self) -> f64 {
        self.log_ratio.exp()
    }

    /// Mean difference over its standard error; positive where the second model predicts better.
    pub fn t(&self) -> f64 {
        self.log_ratio / self.se.max(f64::MIN_POSITIVE)
    }

    /// The t that is beyond chance.
    fn significant(&self) -> f64 {
        STUDENT[0] + STUDENT[1] / (self.blocks - 1) as f64
    }

    /// Whether the second model predicts better, beyond chance.
    pub fn second_is_better(&self) -> bool {
        self.t() > self.significant()
    }

    /// Whether the first model predicts better, beyond chance.
    pub fn first_is_better(&self) -> bool {
        self.t() < -self.significant()
    }
}

/// The data of one fold.
pub(super) struct Fold {
    /// Windows of the weak form that lie within the fold's blocks.
    pub windows: Vec<Window>,
    /// Segments of the simulation that tile the fold's blocks.
    pub segments: Vec<Segment>,
}

/// Cuts every piece of the tracks into blocks of about [`BLOCK_S`]; shorter pieces have none.
pub(super) fn blocks(tracks: &[MeasuredMotion]) -> Vec<Block> {
    let mut blocks = Vec::new();
    for (index, track) in tracks.iter().enumerate() {
        let len = ((BLOCK_S / track.ts).round() as usize).max(2 * horizon(track, HORIZON_S));
        for piece in track.pieces.windows(2) {
            let (start, samples) = (piece[0], piece[1] - piece[0]);
            let n = samples / len;
            let edge = |i: usize| start + i * samples / n;
            blocks.extend((0..n).map(|i| Block { track: index, start: edge(i), end: edge(i + 1) }));
        }
    }
    blocks
}

/// Samples of a horizon.
fn horizon(track: &MeasuredMotion, horizon_s: f64) -> usize {
    ((horizon_s / track.ts).round() as usize).max(LEAST_HORIZON)
}

/// Every other block, from the first or from the second.
fn members(blocks: &[Block], fold: usize) -> impl Iterator<Item = &Block> {
    blocks.iter().skip(fold).step_by(2)
}

/// What is fitted of a fold. `windows` are all windows, in order.
pub(super) fn fold(
    tracks: &[MeasuredMotion],
    blocks: &[Block],
    windows: &[Window],
    segment_s: f64,
    fold: usize,
) -> Fold {
    let mut own = Fold { windows: Vec::new(), segments: Vec::new() };
    for block in members(blocks, fold) {
        let first = windows.partition_point(|w| (w.track, w.first) < (block.track, block.start));
        let inside = |w: &&Window| w.track == block.track && w.first + w.weights.len() < block.end;
        own.windows.extend(windows[first..].iter().take_while(inside).cloned());
        let samples = block.end - block.start;
        let n = ((samples as f64 * tracks[block.track].ts / segment_s).round() as usize).max(1);
        let edge = |i: usize| block.start + i * samples / n;
        own.segments.extend((0..n).map(|i| Segment { track: block.track, start: edge(i), len: edge(i + 1) - edge(i) }));
    }
    let (all, most) = (own.segments.len(), MAX_SEGMENTS / 2);
    if all > most {
        own.segments = (0..most).map(|i| own.segments[i * all / most]).collect();
    }
    own
}

/// Compares two models. `models` holds them as fitted to either fold; each predicts the other fold's blocks.
pub(super) fn compare(problem: &Problem<'_>, blocks: &[Block], models: &[[Candidate; 2]; 2]) -> Option<Comparison> {
    compare_ahead(problem, blocks, models, HORIZON_S)
}

/// The same over another horizon, s.
fn compare_ahead(
    problem: &Problem<'_>,
    blocks: &[Block],
    models: &[[Candidate; 2]; 2],
    horizon_s: f64,
) -> Option<Comparison> {
    let floor = problem.sigma * problem.sigma;
    let every = blocks.len().div_ceil(MOST_PREDICTED).max(1);
    // An odd stride takes blocks of both folds.
    let every = if every > 1 { every | 1 } else { 1 };
    let differences: Vec<f64> = blocks
        .par_iter()
        .enumerate()
        .filter(|(i, _)| i % every == 0)
        .filter_map(|(i, block)| {
            let [first, second] = &models[1 - i % 2];
            let [first, second] = [first, second].map(|model| errors(problem, model, *block, horizon_s));
            let logs = first.iter().zip(&second).map(|(a, b)| 0.5 * ((floor + a) / (floor + b)).ln());
            let (sum, n) = logs.filter(|log| log.is_finite()).fold((0.0, 0), |(sum, n), log| (sum + log, n + 1));
            (n > 0).then(|| sum / f64::from(n))
        })
        .collect();
    Comparison::of(&differences)
}

/// Mean square errors of prediction over a block: a state is fitted to one horizon, and the next is predicted.
fn errors(problem: &Problem<'_>, model: &Candidate, block: Block, horizon_s: f64) -> Vec<f64> {
    let track = &problem.tracks[block.track];
    let samples = horizon(track, horizon_s);
    let starts = (block.start..).step_by(2 * samples).take_while(|start| start + 2 * samples <= block.end);
    starts
        .map(|start| {
            let seen = Segment { track: block.track, start, len: samples };
            let known = Problem { segments: std::slice::from_ref(&seen), ..*problem };
            let Ok(state) = known.fit(model, &[], None, SCORE_ITERATIONS) else { return f64::NAN };
            let positions = problem.positions(model, Segment { len: 2 * samples, ..seen }, state.initial[0]);
            let ahead = start + samples..start + 2 * samples;
            let square = ahead.clone().map(|k| (track.weight(k) * (track.x[k] - positions[k - start])).powi(2));
            square.sum::<f64>() / samples as f64
        })
        .collect()
}

#[cfg(test)]
mod measured;
#[cfg(test)]
mod tests;
