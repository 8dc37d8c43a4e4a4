//! Covariance of the free parameters from the scatter of the segments' scores.

use nalgebra::DMatrix;

use super::equations::Reduced;
use super::normal::Normal;
use super::{Candidate, Fit, Free, Problem, Start};

/// Covariance of a fit's free parameters.
#[derive(Clone, Debug)]
pub struct Covariance {
    free: Vec<Free>,
    pub(super) matrix: DMatrix<f64>,
}

impl Covariance {
    /// Standard error of a free parameter. `None` if it is held; NaN if the segments do not determine it.
    pub fn standard_error(&self, parameter: Free) -> Option<f64> {
        let i = self.free.iter().position(|f| *f == parameter)?;
        Some(self.matrix[(i, i)].max(0.0).sqrt())
    }
}

impl Problem<'_> {
    /// Covariance of the free parameters of a fit to these segments.
    pub fn covariance(&self, fit: &Fit) -> Covariance {
        let problem = Problem { softening: fit.floor, ..*self };
        let normals = problem.normals(&fit.candidate, &fit.free, &fit.initial);
        Covariance {
            free: fit.free.clone(),
            matrix: problem.sandwich(&fit.candidate, &normals, &fit.initial, fit.free.len()),
        }
    }

    /// Covariance of the parameters from the scatter of the segments' scores (sandwich). It also holds where the model
    /// misses something and the residual is not white. With fewer than four segments for each parameter it is the
    /// inverse Hessian.
    fn sandwich(&self, candidate: &Candidate, normals: &[Normal], states: &[Start], p: usize) -> DMatrix<f64> {
        let unknown = || DMatrix::from_element(p, p, f64::NAN);
        let Some(Reduced { hessian, scores, .. }) = self.reduce(candidate, normals, states, p, 0.0) else {
            return unknown();
        };
        let Some(inverse) = hessian.cholesky().map(|c| c.inverse()) else { return unknown() };
        if self.segments.len() < 4 * p { inverse } else { &inverse * scores * &inverse }
    }
}
