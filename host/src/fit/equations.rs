//! The normal equations of all segments. A Schur complement eliminates every segment's initial state.

use nalgebra::{DMatrix, DVector};

use super::normal::Normal;
use super::{Candidate, Problem, Segment, Start};

/// Normal equations of the parameters, without the initial states.
pub(super) struct Reduced {
    pub(super) hessian: DMatrix<f64>,
    gradient: DVector<f64>,
    /// Σ of the outer products of the segments' gradients.
    pub(super) scores: DMatrix<f64>,
    eliminated: Vec<(DMatrix<f64>, DMatrix<f64>, DVector<f64>)>,
}

impl Problem<'_> {
    /// Normal equations of one segment's start, with its prior and bounds, over the weight of the segment.
    pub(super) fn local_equations(
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
            // A body that sticks, or is pushed, forgets its start. Such a start stays where it is.
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
    pub(super) fn reduce(
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

    /// One damped Gauss–Newton step of the parameters and the initial states; `None` if the equations are singular.
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
            // A parameter that changes no residual keeps its value.
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
}
