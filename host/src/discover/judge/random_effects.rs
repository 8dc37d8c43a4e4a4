//! The mean of estimates that each have an error of their own, and that differ by more than these errors.

use super::gain::z_of_t;

/// A mean of several estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error.
    pub error: f64,
    /// Degrees of freedom of the error; infinite where the values differ by no more than their own errors.
    pub freedom: f64,
}

impl Estimate {
    /// The mean over its error, as a normal number.
    pub(super) fn z(&self) -> f64 {
        let t = self.mean / self.error;
        if self.freedom.is_finite() { z_of_t(t, self.freedom) } else { t }
    }
}

/// The random-effects mean of at least three values with these variances (DerSimonian and Laird 1986, *Controlled
/// Clinical Trials* 7, 177). The variance by which the values differ beyond their own is added to each. The values tell
/// only that part of the error. So the degrees of freedom are those of a known beside an estimated variance
/// (Satterthwaite 1946, *Biometrics* 2, 110). `None` where there are fewer values, or where a variance is not above 0.
pub(super) fn mean(values: &[f64], variances: &[f64]) -> Option<Estimate> {
    if values.len() < 3 || !variances.iter().all(|own| *own > 0.0 && own.is_finite()) {
        return None;
    }
    let with = |between: f64| {
        let weights = || variances.iter().map(|own| 1.0 / (own + between));
        let total: f64 = weights().sum();
        let squares: f64 = weights().map(|weight| weight * weight).sum();
        (weights().zip(values).map(|(weight, value)| weight * value).sum::<f64>() / total, total, squares)
    };
    let (fixed, total, squares) = with(0.0);
    let q: f64 = values.iter().zip(variances).map(|(value, own)| (value - fixed).powi(2) / own).sum();
    let count = values.len() as f64;
    let between = ((q - (count - 1.0)) / (total - squares / total)).max(0.0);
    let (mean, total, squares) = with(between);
    let share = between * squares / total;
    mean.is_finite().then_some(Estimate {
        mean,
        error: total.sqrt().recip(),
        freedom: (total * total / squares - 1.0) / (share * share),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal variances that explain the spread: the mean of five has an error of 1/√5. Values that differ by more have the
    /// error of their spread, √(20/3)/√4.
    #[test]
    fn the_error_is_that_of_the_spread() {
        let alike = mean(&[1.0, 1.5, 0.5, 1.2, 0.8], &[1.0; 5]).unwrap();
        assert!((alike.mean - 1.0).abs() < 1e-12 && (alike.error - 0.2_f64.sqrt()).abs() < 1e-12, "{alike:?}");
        assert!(alike.freedom.is_infinite());
        let apart = mean(&[1.0, 3.0, 5.0, 7.0], &[0.01; 4]).unwrap();
        assert!((apart.error - (20.0_f64 / 12.0).sqrt()).abs() < 1e-9, "{apart:?}");
        assert!((apart.freedom - 3.0).abs() < 0.01, "{apart:?}");
    }

    /// One value that is known well and lies apart does not outweigh five that agree.
    #[test]
    fn one_that_lies_apart_does_not_decide() {
        let values = [1.0, 1.0, 1.0, 1.0, 1.0, -1.0];
        let own = mean(&values, &[0.01, 0.01, 0.01, 0.01, 0.01, 1e-6]).unwrap();
        assert!(own.mean > 0.5, "{own:?}");
    }

    #[test]
    fn few_values_tell_no_spread() {
        assert_eq!(mean(&[1.0, 2.0], &[1.0; 2]), None);
        assert_eq!(mean(&[1.0, 2.0, 3.0], &[1.0, 0.0, 1.0]), None);
    }
}
