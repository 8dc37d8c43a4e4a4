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
        Some(error(self.matrix[(i, i)]))
    }

    /// Whether the segments determine all free parameters: each has a standard error.
    pub fn determined(&self) -> bool {
        self.matrix.diagonal().iter().all(|variance| error(*variance).is_finite())
    }
}

/// The root of a variance; NaN where that is no positive number.
fn error(variance: f64) -> f64 {
    if variance > 0.0 { variance.sqrt() } else { f64::NAN }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A variance that is no positive number is no standard error of 0. MuJoCo's friction was called LuGre's with errors
    /// of 0, where the normal equations had no solution.
    #[test]
    fn what_is_not_determined_has_no_standard_error() {
        let of = |variances: [f64; 2]| Covariance {
            free: vec![Free::Base(0), Free::Base(1)],
            matrix: DMatrix::from_diagonal(&variances.to_vec().into()),
        };
        let told = of([4.0, 9.0]);
        assert_eq!((told.standard_error(Free::Base(1)), told.determined()), (Some(3.0), true));
        assert_eq!(told.standard_error(Free::Base(2)), None);
        for undetermined in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
            let own = of([4.0, undetermined]);
            let error = own.standard_error(Free::Base(1)).unwrap();
            assert!(!(own.determined() || error.is_finite()), "{undetermined} {error}");
        }
    }
}
