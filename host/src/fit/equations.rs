//! The normal equations of multiple shooting: every segment's start is eliminated by Schur complement.

use nalgebra::{DMatrix, DVector};

use super::{Problem, Segment, Start};
use crate::fit::candidate::Candidate;
use crate::fit::track::root_mean_square;

/// Normal equations of the parameters, the initial states eliminated.
struct Reduced {
    hessian: DMatrix<f64>,
    gradient: DVector<f64>,
    /// Σ of the outer products of the segments' gradients.
    scores: DMatrix<f64>,
    eliminated: Vec<(DMatrix<f64>, DMatrix<f64>, DVector<f64>)>,
}

/// Normal equations of one segment, empty where only its mean square was asked for.
pub(super) struct Normal {
    pub(super) hessian: DMatrix<f64>,
    pub(super) gradient: DVector<f64>,
    pub(super) mse: f64,
    pub(super) samples: f64,
}

/// Samples whose products are summed in one go: the sums stay in registers meanwhile.
const TOGETHER: usize = 8;

/// Sums over a segment of the products of the derivatives with each other and with the residual.
pub(super) struct Sums<const N: usize> {
    hessian: [[f64; N]; N],
    gradient: [f64; N],
    rows: [[f64; N]; TOGETHER],
    waiting: usize,
}

impl<const N: usize> Sums<N> {
    pub(super) const fn new() -> Self {
        Self { hessian: [[0.0; N]; N], gradient: [0.0; N], rows: [[0.0; N]; TOGETHER], waiting: 0 }
    }

    pub(super) fn add(&mut self, derivatives: &[f32; N], residual: f64) {
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

    /// The products of the waiting rows. Both triangles: whole rows are what the compiler makes vectors of.
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

    /// The first `m` rows and columns, and the first `m` of the gradient.
    pub(super) fn finished(mut self, m: usize) -> (DMatrix<f64>, DVector<f64>) {
        self.sum();
        (DMatrix::from_fn(m, m, |i, j| self.hessian[i][j]), DVector::from_fn(m, |i, _| self.gradient[i]))
    }
}

impl Problem<'_> {
    /// A step of one segment's start alone, the parameters held.
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

    /// Normal equations of one segment's start, its prior and bounds included, over the weight of the segment.
    fn local_equations(
        &self,
        candidate: &Candidate,
        normal: &Normal,
        at: (Segment, Start),
        p: usize,
        damping: f64,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (segment, start) = at;
        let weight = 1.0 / (self.floor() + normal.mse);
        let count = normal.gradient.len() - p;
        let mut local = normal.hessian.view((p, p), (count, count)).into_owned();
        let mut gradient = normal.gradient.rows(p, count).into_owned();
        let scales = self.start_scales(segment);
        for i in 0..count {
            // A body that sticks, or is pushed, forgets how it started: such starts stay where they are.
            local[(i, i)] = local[(i, i)] * (1.0 + damping) + 1.0 / (weight * scales[i] * scales[i]);
        }
        if count == 4 {
            for (i, precision) in (2..4).zip(self.prior(candidate).precisions(start)) {
                local[(i, i)] += precision / weight;
                gradient[i] -= precision / weight * start[i];
            }
        }
        (local, gradient)
    }

    /// Eliminates the initial states of every segment; `None` if a segment does not determine its own.
    fn reduce(
        &self,
        candidate: &Candidate,
        normals: &[Normal],
        states: &[Start],
        p: usize,
        damping: f64,
    ) -> Option<Reduced> {
        let mut reduced = Reduced {
            hessian: DMatrix::zeros(p, p),
            gradient: DVector::zeros(p),
            scores: DMatrix::zeros(p, p),
            eliminated: Vec::with_capacity(normals.len()),
        };
        for ((normal, segment), state) in normals.iter().zip(self.segments).zip(states) {
            let weight = 1.0 / (self.floor() + normal.mse);
            let count = normal.gradient.len() - p;
            let (local, local_gradient) = self.local_equations(candidate, normal, (*segment, *state), p, damping);
            let inverse = local.cholesky()?.inverse();
            let cross = normal.hessian.view((0, p), (p, count)).into_owned();
            let product = &cross * &inverse;
            reduced.hessian += weight * (normal.hessian.view((0, 0), (p, p)) - &product * cross.transpose());
            let score = weight * (normal.gradient.rows(0, p) - &product * &local_gradient);
            reduced.scores += &score * score.transpose();
            reduced.gradient += score;
            reduced.eliminated.push((inverse, cross, local_gradient));
        }
        Some(reduced)
    }

    /// Root mean square of the measured velocity.
    pub(super) fn typical_speed(&self, segment: Segment) -> f64 {
        let v = &self.tracks[segment.track].vs[segment.start..segment.start + segment.len];
        root_mean_square(v.iter().copied())
    }

    /// How far a start may be from where it is, at the most: of position, velocity and the second body's.
    fn start_scales(&self, segment: Segment) -> Start {
        let track = &self.tracks[segment.track];
        let range = segment.start..segment.start + segment.len;
        let speed = self.typical_speed(segment);
        let x = &track.xs[range];
        let travel = x.iter().copied().fold(f64::MIN, f64::max) - x.iter().copied().fold(f64::MAX, f64::min);
        let velocity = speed + 100.0 * self.sigma;
        [100.0 * self.sigma + travel, velocity, 10.0 * self.sigma + 0.2 * travel, velocity]
    }

    /// One damped Gauss–Newton step: parameters and initial states.
    pub(super) fn step(
        &self,
        candidate: &Candidate,
        normals: &[Normal],
        states: &[Start],
        p: usize,
        damping: f64,
    ) -> Option<(DVector<f64>, Vec<Start>)> {
        let reduced = self.reduce(candidate, normals, states, p, damping)?;
        let mut damped = reduced.hessian.clone();
        for i in 0..p {
            damped[(i, i)] *= 1.0 + damping;
            // A parameter that the data does not touch keeps its value.
            if damped[(i, i)] <= 0.0 {
                damped[(i, i)] = 1.0;
            }
        }
        let step = damped.cholesky()?.solve(&reduced.gradient);
        let local = reduced
            .eliminated
            .iter()
            .map(|(inverse, cross, gradient)| {
                let d = inverse * (gradient - cross.transpose() * &step);
                std::array::from_fn(|i| d.get(i).copied().unwrap_or(0.0))
            })
            .collect();
        Some((step, local))
    }

    /// Covariance of the parameters from the scatter of the segments' scores (sandwich): honest also where the model
    /// misses something and the residual is not white. With too few segments for that, the inverse Hessian.
    pub(super) fn sandwich(
        &self,
        candidate: &Candidate,
        normals: &[Normal],
        states: &[Start],
        p: usize,
    ) -> DMatrix<f64> {
        let unknown = || DMatrix::from_element(p, p, f64::NAN);
        let Some(Reduced { hessian, scores, .. }) = self.reduce(candidate, normals, states, p, 0.0) else {
            return unknown();
        };
        let Some(inverse) = hessian.cholesky().map(|c| c.inverse()) else { return unknown() };
        if self.segments.len() < 4 * p { inverse } else { &inverse * scores * &inverse }
    }
}
