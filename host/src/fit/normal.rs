//! The normal equations of one segment, for the free parameters and its initial state. One simulation with dual numbers
//! gives the residual and all its derivatives.

use std::ops::ControlFlow;

use breakaway_core::plant::{Base, Effect, Plant};
use breakaway_core::scalar::Real as _;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::dual::Dual;
use super::settings::TOGETHER;
use super::simulate::Residual;
use super::{Candidate, Free, Problem, Segment, Start};

/// Normal equations of one segment. They are empty where only its mean square is needed.
pub(super) struct Normal {
    pub(super) hessian: DMatrix<f64>,
    pub(super) gradient: DVector<f64>,
    pub(super) mse: f64,
    pub(super) samples: f64,
}

/// Sums over a segment of the products of the derivatives with each other and with the residual.
struct Sums<const N: usize> {
    hessian: [[f64; N]; N],
    gradient: [f64; N],
    rows: [[f64; N]; TOGETHER],
    waiting: usize,
}

impl<const N: usize> Sums<N> {
    const fn new() -> Self {
        Self { hessian: [[0.0; N]; N], gradient: [0.0; N], rows: [[0.0; N]; TOGETHER], waiting: 0 }
    }

    fn add(&mut self, derivatives: &[f32; N], residual: f64) {
        let row = &mut self.rows[self.waiting];
        for ((slot, sum), derivative) in row.iter_mut().zip(&mut self.gradient).zip(derivatives) {
            *slot = f64::from(*derivative);
            *sum += *slot * residual;
        }
        self.waiting += 1;
        if self.waiting == TOGETHER {
            self.sum();
        }
    }

    /// The products of the waiting rows. Both triangles are summed, because the compiler makes vectors of whole rows.
    fn sum(&mut self) {
        for (i, sums) in self.hessian.iter_mut().enumerate() {
            let mut total = *sums;
            for row in &self.rows {
                for j in 0..N {
                    total[j] += row[i] * row[j];
                }
            }
            *sums = total;
        }
        self.rows = [[0.0; N]; TOGETHER];
        self.waiting = 0;
    }

    /// The first `m` rows and columns, with the first `m` entries of the gradient.
    fn finished(mut self, m: usize) -> (DMatrix<f64>, DVector<f64>) {
        self.sum();
        (DMatrix::from_fn(m, m, |i, j| self.hessian[i][j]), DVector::from_fn(m, |i, _| self.gradient[i]))
    }
}

/// Base and effects as dual numbers. Lane `k` belongs to the k-th free parameter.
fn differentiated<const N: usize>(candidate: &Candidate, free: &[Free]) -> (Base<Dual<N>>, Vec<Effect<Dual<N>>>) {
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
    (Base { b: base[0], c: base[1], f1: base[2] }, effects)
}

impl Problem<'_> {
    fn normal_of<const N: usize>(
        &self,
        candidate: &Candidate,
        free: &[Free],
        segment: Segment,
        initial: Start,
    ) -> Normal {
        let p = free.len();
        let (base, effects) = differentiated::<N>(candidate, free);
        let plant = Plant { base, effects: &effects };
        let n = self.sub_steps(&plant, segment);
        let local = candidate.local();
        let track = &self.tracks[segment.track];
        let mut sums = Sums::<N>::new();
        let mut total = Residual::default();
        self.simulate(
            &plant,
            n,
            segment,
            std::array::from_fn(|i| if i < local { Dual::parameter(initial[i], p + i) } else { Dual::constant(0.0) }),
            |k, simulated| {
                let weight = track.weight(k);
                let residual = weight * (track.x[k] - simulated.value);
                total.add(residual);
                sums.add(&simulated.scale(weight).gradient, residual);
                ControlFlow::Continue(())
            },
        );
        let (hessian, gradient) = sums.finished(p + local);
        Normal { hessian, gradient, mse: total.mean_square(segment.len), samples: total.samples(segment.len) }
    }

    /// Normal equations of one segment from a given start.
    pub(super) fn normal(&self, candidate: &Candidate, free: &[Free], segment: Segment, initial: Start) -> Normal {
        match free.len() + candidate.local() {
            0..=4 => self.normal_of::<4>(candidate, free, segment, initial),
            5..=8 => self.normal_of::<8>(candidate, free, segment, initial),
            9..=12 => self.normal_of::<12>(candidate, free, segment, initial),
            _ => self.normal_of::<20>(candidate, free, segment, initial),
        }
    }

    /// Normal equations of all segments.
    pub(super) fn normals(&self, candidate: &Candidate, free: &[Free], states: &[Start]) -> Vec<Normal> {
        let segments = self.segments.par_iter().zip(states).with_min_len(8);
        segments.map(|(segment, start)| self.normal(candidate, free, *segment, *start)).collect()
    }
}
