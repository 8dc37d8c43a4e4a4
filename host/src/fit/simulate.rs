//! Simulation of one segment, and the sums of its residual.

use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

use breakaway_core::plant::effect::Memory;
use breakaway_core::plant::{Drive, Plant, State};
use breakaway_core::scalar::Real;
use nalgebra::{DMatrix, DVector};

use super::hidden_state::displaced;
use super::normal::Normal;
use super::settings::{LEAST_SAMPLES, STEP_S};
use super::{Candidate, Problem, Segment, Start};

/// Sums of a segment's residual.
#[derive(Default)]
pub(super) struct Residual {
    square: f64,
    lagged: f64,
    previous: f64,
}

impl Residual {
    pub(super) fn add(&mut self, residual: f64) {
        self.square += residual * residual;
        self.lagged += residual * self.previous;
        self.previous = residual;
    }
    pub(super) fn mean_square(&self, len: usize) -> f64 {
        self.square / len as f64
    }
    /// Effective samples. A correlated residual counts for less.
    pub(super) fn samples(&self, len: usize) -> f64 {
        let correlation = (self.lagged / self.square.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (len as f64 * (1.0 - correlation) / (1.0 + correlation)).max(LEAST_SAMPLES)
    }
}

impl Problem<'_> {
    /// Simulates one segment, and hands the index and the reading of every sample to `visit`.
    pub(super) fn simulate<R: Real>(
        &self,
        plant: &Plant<'_, R>,
        n: usize,
        segment: Segment,
        start: [R; 4],
        visit: impl FnMut(usize, R) -> ControlFlow<()>,
    ) {
        self.simulate_from(plant, n, segment, displaced(plant, &self.state_before(plant, segment), start), visit);
    }

    /// The same from a state, until `visit` breaks off.
    pub(super) fn simulate_from<R: Real>(
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
            // A number with derivatives counts as many times more as it is longer than a plain one.
            let numbers = n * size_of::<R>() / size_of::<f64>();
            work.fetch_add(samples * numbers as u64, Ordering::Relaxed);
        }
    }

    /// Sub-steps of a sample period: as many as the effects need, none longer than [`STEP_S`], but not more than 32 for
    /// that.
    pub(super) fn sub_steps<R: Real>(&self, plant: &Plant<'_, R>, segment: Segment) -> usize {
        let ts = self.tracks[segment.track].ts;
        let asked = plant.sub_steps(ts);
        let resolved = if self.coarse { asked.div_ceil(2) } else { asked };
        resolved.max((ts / STEP_S).round().min(32.0) as usize)
    }

    /// The residual of a segment from a given start, without the normal equations.
    pub(super) fn residual(&self, candidate: &Candidate, segment: Segment, initial: Start) -> Normal {
        let plant = Plant { base: candidate.base, effects: &candidate.effects };
        let track = &self.tracks[segment.track];
        let mut residual = Residual::default();
        self.simulate(&plant, self.sub_steps(&plant, segment), segment, initial, |k, x| {
            residual.add(track.weight(k) * (track.x[k] - x));
            ControlFlow::Continue(())
        });
        Normal {
            hessian: DMatrix::zeros(0, 0),
            gradient: DVector::zeros(0),
            mse: residual.mean_square(segment.len),
            samples: residual.samples(segment.len),
        }
    }

    /// What the effects remember at a given start of a segment, in their order: for a program that simulates it elsewhere.
    pub fn memory_at(&self, candidate: &Candidate, segment: Segment, initial: Start) -> Vec<Memory<f64>> {
        let plant = Plant { base: candidate.base, effects: &candidate.effects };
        let state = displaced(&plant, &self.state_before(&plant, segment), initial);
        state.memory[..candidate.effects.len().min(state.memory.len())].to_vec()
    }

    /// Simulates a segment from a given initial state. Gives the positions as the sensor reports them, position units.
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
