//! Output error by multiple shooting: the plant is simulated over short segments, each from its own initial position
//! and velocity, and base and effect parameters are fitted jointly (docs/discovery.md, section 8).
//!
//! Minimised is `Σ_segments n/2·log(σ² + mse)` by Levenberg–Marquardt. The logarithm bounds the influence of any one
//! segment; initial states are eliminated by Schur complement; derivatives come from dual numbers.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use breakaway_core::plant::{Base, Drive, Effect, Plant, State};
use breakaway_core::scalar::Real;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

mod bounds;
pub mod candidate;
pub mod dual;
mod equations;
mod lost;
mod mend;
mod prior;
pub mod track;
mod warm_up;

pub use candidate::{Candidate, Free};
use dual::Dual;
use equations::{Normal, Sums};
use track::Track;
use track::median;
use warm_up::placed;

/// A segment counts for at least this many samples, however smooth its residual: misfit differs from one to the next.
const LEAST_SAMPLES: f64 = 4.0;

/// Longest sub-step, s. Reversals within longer ones cost more than the data's noise: at 10 ms, b of a relay recording
/// comes out 3e-4 low, six of its standard errors.
const STEP_S: f64 = 1e-3;

/// Step of the sensor's numerical slope, position units.
const SENSOR_STEP: f64 = 1e-6;

/// Growth of a segment's mean square in one step that counts as a jump.
const JUMP: f64 = 1.3;

/// Two steps in a row that gain less than this share of what all steps gained end the fit: the weights of the segments
/// follow the fit, so one small step may be a narrow valley's.
const ENOUGH: f64 = 2e-4;

/// Iterations of a start on its own, the model held.
pub const SCORE_ITERATIONS: usize = 6;

/// Fits of fewer iterations are not softened; nor those whose median segment is below this multiple of the noise.
const LEAST_TO_SOFTEN: usize = 5;
const SOFTEN_ABOVE: f64 = 4.0;

/// Samples of a track that are simulated in one go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Index of the track.
    pub track: usize,
    /// First sample.
    pub start: usize,
    /// Number of samples, ≥ 2.
    pub len: usize,
}

/// Where a segment starts: position, velocity, and how far the free memory of an effect (a bristle, a second body) is from
/// what the motion before the segment says.
pub type Start = [f64; 4];

/// Data and noise floor of a fit.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// Prepared recordings.
    pub tracks: &'a [Track],
    /// Segments to fit.
    pub segments: &'a [Segment],
    /// Noise floor, position units.
    pub sigma: f64,
    /// Seconds of measured motion followed before each segment to bring the effects' memories up to date.
    pub warm_up_s: f64,
    /// Mean square added to every segment's in the logarithm, in place of σ²; 0 for σ² itself.
    pub softening: f64,
    /// Half the sub-steps that the effects' dynamics ask for: to compare starts, not to state parameters.
    pub coarse: bool,
    /// Where simulated samples are counted.
    pub work: Option<&'a AtomicU64>,
}

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model.
    pub candidate: Candidate,
    /// Its free parameters.
    pub free: Vec<Free>,
    /// Floor of the segments' mean squares in the logarithm, position units squared.
    pub floor: f64,
    /// Mean square error of every segment, position units squared.
    pub mse: Vec<f64>,
    /// Effective samples of every segment: residuals that are correlated count for less.
    pub samples: Vec<f64>,
    /// Initial position and velocity of every segment.
    pub initial: Vec<Start>,
    /// The minimised cost.
    pub cost: f64,
    /// Whether it ended by itself, not by the number of iterations.
    pub converged: bool,
}

/// Covariance of a fit's free parameters.
#[derive(Clone, Debug)]
pub struct Covariance {
    free: Vec<Free>,
    matrix: DMatrix<f64>,
}

/// Starts after a step, and where they come from.
struct Stepped<'a> {
    old: &'a [Start],
    old_mse: &'a [f64],
    new: Vec<Start>,
    /// Whether only the mean squares are wanted, no step following.
    last: bool,
}

/// Sums of a segment's residual.
#[derive(Default)]
struct Missed {
    square: f64,
    lagged: f64,
    previous: f64,
}

impl Missed {
    fn by(&mut self, residual: f64) {
        self.square += residual * residual;
        self.lagged += residual * self.previous;
        self.previous = residual;
    }
    fn mean_square(&self, len: usize) -> f64 {
        self.square / len as f64
    }
    /// Effective samples: a residual that is correlated counts for less.
    fn samples(&self, len: usize) -> f64 {
        let correlation = (self.lagged / self.square.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (len as f64 * (1.0 - correlation) / (1.0 + correlation)).max(LEAST_SAMPLES)
    }
}

/// Why a candidate could not be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FitError {
    /// The simulation leaves the range of numbers from the start.
    #[error("the simulation diverges with the starting parameters")]
    Diverges,
    /// There is nothing to fit.
    #[error("no segment to fit")]
    NoSegment,
    /// More parameters than the solver carries.
    #[error("too many free parameters ({0})")]
    TooMany(usize),
}

impl Problem<'_> {
    /// Simulates one segment and hands every sample and its reading to `visit`.
    fn simulate<R: Real>(
        &self,
        plant: &Plant<'_, R>,
        n: usize,
        segment: Segment,
        start: [R; 4],
        visit: impl FnMut(usize, R) -> ControlFlow<()>,
    ) {
        self.simulate_from(plant, n, segment, placed(plant, &self.warm_state(plant, segment), start), visit);
    }

    /// The same from a state, as long as `visit` wants it.
    fn simulate_from<R: Real>(
        &self,
        plant: &Plant<'_, R>,
        n: usize,
        segment: Segment,
        mut state: State<R>,
        mut visit: impl FnMut(usize, R) -> ControlFlow<()>,
    ) {
        let track = &self.tracks[segment.track];
        let mut samples = 0;
        for k in segment.start..segment.start + segment.len {
            samples += 1;
            if visit(k, plant.measured(state.x)).is_break() {
                break;
            }
            let drive = Drive { u: &track.u[..=k], ts: track.dt(k), t: track.t[k] };
            plant.advance(&mut state, drive, n);
        }
        if let Some(work) = self.work {
            // With derivatives a number is as many times longer as they take.
            let numbers = n * size_of::<R>() / size_of::<f64>();
            work.fetch_add(samples * numbers as u64, Ordering::Relaxed);
        }
    }

    /// Sub-steps of a sample period: what the effects ask for, and none longer than [`STEP_S`].
    fn sub_steps<R: Real>(&self, plant: &Plant<'_, R>, segment: Segment) -> usize {
        let ts = self.tracks[segment.track].ts;
        let asked = plant.sub_steps(ts);
        let resolved = if self.coarse { asked.div_ceil(2) } else { asked };
        resolved.max((ts / STEP_S).round().min(32.0) as usize)
    }

    fn normal<const N: usize>(&self, candidate: &Candidate, free: &[Free], segment: Segment, initial: Start) -> Normal {
        let p = free.len();
        let mut base = [candidate.base.b, candidate.base.c, candidate.base.f1].map(Dual::<N>::constant);
        let mut effects: Vec<Effect<Dual<N>>> =
            candidate.effects.iter().map(|e| Effect { kind: e.kind, p: e.p.map(Dual::constant) }).collect();
        for (lane, parameter) in free.iter().enumerate() {
            let dual = Dual::parameter(parameter.get(candidate), lane);
            match *parameter {
                Free::Base(i) => base[i] = dual,
                Free::Effect(j, i) => effects[j].p[i] = dual,
            }
        }
        let plant = Plant { base: Base { b: base[0], c: base[1], f1: base[2] }, effects: &effects };
        let n = self.sub_steps(&plant, segment);
        let local = candidate.local();
        let track = &self.tracks[segment.track];
        let mut sums = Sums::<N>::new();
        let mut missed = Missed::default();
        self.simulate(
            &plant,
            n,
            segment,
            std::array::from_fn(|i| if i < local { Dual::parameter(initial[i], p + i) } else { Dual::constant(0.0) }),
            |k, simulated| {
                let weight = track.weight(k);
                let residual = weight * (track.x[k] - simulated.value);
                missed.by(residual);
                sums.add(&simulated.scale(weight).gradient, residual);
                ControlFlow::Continue(())
            },
        );
        let m = p + local;
        let (hessian, gradient) = sums.finished(m);
        Normal { hessian, gradient, mse: missed.mean_square(segment.len), samples: missed.samples(segment.len) }
    }

    /// How a segment is missed from a given start, without the normal equations.
    fn plain(&self, candidate: &Candidate, segment: Segment, initial: Start) -> Normal {
        let plant = Plant { base: candidate.base, effects: &candidate.effects };
        let track = &self.tracks[segment.track];
        let mut missed = Missed::default();
        self.simulate(&plant, self.sub_steps(&plant, segment), segment, initial, |k, x| {
            missed.by(track.weight(k) * (track.x[k] - x));
            ControlFlow::Continue(())
        });
        Normal {
            hessian: DMatrix::zeros(0, 0),
            gradient: DVector::zeros(0),
            mse: missed.mean_square(segment.len),
            samples: missed.samples(segment.len),
        }
    }

    fn normal_any(&self, candidate: &Candidate, free: &[Free], segment: Segment, initial: Start) -> Normal {
        match free.len() + candidate.local() {
            0..=4 => self.normal::<4>(candidate, free, segment, initial),
            5..=8 => self.normal::<8>(candidate, free, segment, initial),
            9..=12 => self.normal::<12>(candidate, free, segment, initial),
            _ => self.normal::<20>(candidate, free, segment, initial),
        }
    }

    /// The cost of given mean square errors of the segments.
    pub fn cost_of(&self, mse: &[f64]) -> f64 {
        self.segments.iter().zip(mse).map(|(segment, mse)| 0.5 * segment.len as f64 * (self.floor() + mse).ln()).sum()
    }

    /// Starting initial states: the smoothed motion, as it is before the candidate's sensor.
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

    fn floor(&self) -> f64 {
        (self.sigma * self.sigma).max(self.softening)
    }

    /// Fits the free parameters and every segment's initial state.
    ///
    /// Where all segments are far above the noise the logarithm is a landscape of wells, one for every segment that can be
    /// fitted alone. The first half of the iterations fills them up to the median segment.
    ///
    /// # Errors
    /// [`FitError`] if there is nothing to fit or the start diverges.
    pub fn fit(
        &self,
        start: &Candidate,
        free: &[Free],
        initial: Option<&[Start]>,
        iterations: usize,
    ) -> Result<Fit, FitError> {
        if iterations < LEAST_TO_SOFTEN {
            return self.descend(start, free, initial, iterations);
        }
        let mut first = self.descend(start, free, initial, 1)?;
        self.mend(&first.candidate, &mut first.initial, &first.mse);
        let softening = median(first.mse.clone());
        let fit = if softening < SOFTEN_ABOVE * self.floor() {
            self.descend(&first.candidate, free, Some(&first.initial), iterations - 1)?
        } else {
            let soft = Problem { softening, ..*self };
            let filled = soft.descend(&first.candidate, free, Some(&first.initial), iterations / 2)?;
            self.descend(&filled.candidate, free, Some(&filled.initial), iterations.div_ceil(2))?
        };
        let mut states = fit.initial.clone();
        if !self.mend(&fit.candidate, &mut states, &fit.mse) {
            return Ok(fit);
        }
        let again = self.descend(&fit.candidate, free, Some(&states), iterations.div_ceil(2))?;
        Ok(if again.cost < fit.cost { again } else { fit })
    }

    fn normals(&self, candidate: &Candidate, free: &[Free], states: &[Start]) -> Vec<Normal> {
        let segments = self.segments.par_iter().zip(states).with_min_len(8);
        segments.map(|(segment, start)| self.normal_any(candidate, free, *segment, *start)).collect()
    }

    /// Covariance of the free parameters of a fit to these segments.
    pub fn covariance(&self, fit: &Fit) -> Covariance {
        let problem = Problem { softening: fit.floor, ..*self };
        let normals = problem.normals(&fit.candidate, &fit.free, &fit.initial);
        Covariance {
            free: fit.free.clone(),
            matrix: problem.sandwich(&fit.candidate, &normals, &fit.initial, fit.free.len()),
        }
    }

    /// Levenberg–Marquardt from a start.
    fn descend(
        &self,
        start: &Candidate,
        free: &[Free],
        initial: Option<&[Start]>,
        iterations: usize,
    ) -> Result<Fit, FitError> {
        if self.segments.is_empty() {
            return Err(FitError::NoSegment);
        }
        if free.len() > 16 {
            return Err(FitError::TooMany(free.len()));
        }
        let largest = self.largest_base();
        let mut candidate = start.clone();
        let mut states = initial.map_or_else(|| self.smoothed_initial(&candidate), <[_]>::to_vec);
        let mut normals = self.normals(&candidate, free, &states);
        let mut mse: Vec<f64> = normals.iter().map(|n| n.mse).collect();
        let mut cost = self.cost_of(&mse) + self.memory_cost(&states, &candidate);
        if !cost.is_finite() {
            return Err(FitError::Diverges);
        }
        let first = cost;
        let mut damping = 1e-3;
        let (mut converged, mut small) = (false, false);
        for iteration in 1..=iterations {
            let Some((step, local)) = self.step(&candidate, &normals, &states, free.len(), damping) else {
                damping *= 10.0;
                continue;
            };
            let mut next = candidate.clone();
            for (parameter, delta) in free.iter().zip(step.iter()) {
                let value = parameter.get(&candidate);
                let new = if parameter.logarithmic(&candidate) {
                    value * (delta / value).clamp(-1.5, 1.5).exp()
                } else {
                    value + delta
                };
                parameter.set(&mut next, new.min(parameter.largest(&largest)));
            }
            let next_states: Vec<Start> =
                states.iter().zip(&local).map(|(s, d)| std::array::from_fn(|i| s[i] + d[i])).collect();
            let (next_states, next_normals) = {
                // No step follows the last one.
                let stepped = Stepped { old: &states, old_mse: &mse, new: next_states, last: iteration == iterations };
                self.settled(&next, free, stepped)
            };
            let next_mse: Vec<f64> = next_normals.iter().map(|n| n.mse).collect();
            let next_cost = self.cost_of(&next_mse) + self.memory_cost(&next_states, &next);
            if next_cost < cost {
                let gain = cost - next_cost;
                candidate = next;
                states = next_states;
                normals = next_normals;
                mse = next_mse;
                cost = next_cost;
                damping = (damping * 0.2).max(1e-9);
                // Far below the evidence that any decision asks for.
                if gain < (0.1 + 0.002 * self.segments.len() as f64).max(ENOUGH * (first - cost)) {
                    if small {
                        converged = true;
                        break;
                    }
                    small = true;
                } else {
                    small = false;
                }
            } else {
                damping *= 8.0;
                if damping > 1e6 {
                    converged = true;
                    break;
                }
            }
        }
        let samples = normals.iter().map(|n| n.samples).collect();
        Ok(Fit { candidate, free: free.to_vec(), floor: self.floor(), mse, samples, initial: states, cost, converged })
    }

    /// Evaluates every segment from its stepped start. Where that made a segment worse (a reversal or a release jumps to
    /// another sample), its start is settled by itself, from the old one too: or a few segments would block the step of all.
    fn settled(&self, candidate: &Candidate, free: &[Free], stepped: Stepped<'_>) -> (Vec<Start>, Vec<Normal>) {
        let Stepped { old, old_mse, new, last } = stepped;
        let floor = self.floor();
        let settle = |i: usize, start: Start| {
            let segment = self.segments[i];
            let cost = |start: &Start, normal: &Normal| {
                0.5 * segment.len as f64 * (floor + normal.mse).ln()
                    + self.memory_cost(std::slice::from_ref(start), candidate)
            };
            let full = |start: Start| self.normal_any(candidate, free, segment, start);
            let run = |start: Start| (start, if last { self.plain(candidate, segment, start) } else { full(start) });
            let mut best = run(start);
            if best.1.mse <= (JUMP * old_mse[i]).max(2.0 * floor) {
                return best;
            }
            let before = run(old[i]);
            if cost(&before.0, &before.1) < cost(&best.0, &best.1) {
                best = before;
            }
            let equations = if last { &full(best.0) } else { &best.1 };
            if let Some(step) = self.start_step(candidate, equations, (segment, best.0), free.len(), 1e-2) {
                let next = run(step);
                if cost(&next.0, &next.1) < cost(&best.0, &best.1) {
                    best = next;
                }
            }
            best
        };
        new.into_par_iter().enumerate().with_min_len(8).map(|(i, start)| settle(i, start)).unzip()
    }

    /// Scores a fixed model: only the initial states are fitted. Gives the mean square error of every segment.
    pub fn score(&self, candidate: &Candidate) -> Vec<f64> {
        self.segments
            .par_iter()
            .map(|&segment| {
                let problem = Problem { segments: std::slice::from_ref(&segment), ..*self };
                problem.fit(candidate, &[], None, SCORE_ITERATIONS).map_or(f64::INFINITY, |fit| fit.mse[0])
            })
            .collect()
    }

    /// Simulates a segment from a given initial state; positions as the sensor would report them.
    pub fn positions(&self, candidate: &Candidate, segment: Segment, initial: Start) -> Vec<f64> {
        let plant = Plant { base: candidate.base, effects: &candidate.effects };
        let n = self.sub_steps(&plant, segment);
        let mut positions = Vec::with_capacity(segment.len);
        self.simulate(&plant, n, segment, initial, |_, x| {
            positions.push(x);
            ControlFlow::Continue(())
        });
        positions
    }
}

impl Covariance {
    /// Standard error of a free parameter; `None` if it is held.
    pub fn standard_error(&self, parameter: Free) -> Option<f64> {
        let i = self.free.iter().position(|f| *f == parameter)?;
        Some(self.matrix[(i, i)].max(0.0).sqrt())
    }
}

/// Cuts the pieces of the tracks into segments of `length_s` (at least 8 samples); rests shorter than half are dropped.
pub fn segments(tracks: &[Track], length_s: f64) -> Vec<Segment> {
    let mut segments = Vec::new();
    for (track, prepared) in tracks.iter().enumerate() {
        let len = ((length_s / prepared.ts).round() as usize).max(8);
        for piece in prepared.pieces.windows(2) {
            let mut start = piece[0];
            while start + len / 2 < piece[1] {
                let len = len.min(piece[1] - start);
                if len >= 8 {
                    segments.push(Segment { track, start, len });
                }
                start += len;
            }
        }
    }
    segments
}

#[cfg(test)]
mod tests;
