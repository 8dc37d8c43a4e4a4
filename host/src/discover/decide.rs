//! The decision on paired segments (docs/discovery.md, section 8).

/// Thresholds of naming, calibrated on clean seeds (docs/blind-history.md).
#[derive(Clone, Copy, Debug)]
pub struct Thresholds {
    /// Least mean of log(σ² + mse_without) − log(σ² + mse_with).
    pub delta: f64,
    /// Least z of that.
    pub z: f64,
    /// Least effective log-likelihood ratio after the price, nats.
    pub lambda: f64,
    /// Price of one parameter, nats.
    pub price: f64,
}

/// The calibrated ones.
pub const NAMING: Thresholds = Thresholds { delta: 0.002, z: 2.0, lambda: 25.0, price: 3.5 };
/// Thresholds of a further effect that does not close the gap. They are stricter because a fit that nearly explains a
/// record leaves outliers, which any flexible effect makes fewer.
pub const FURTHER: Thresholds = Thresholds { delta: 0.05, ..NAMING };
/// Two models are tied while the z of their paired difference is below this.
pub const TIED_Z: f64 = 2.5;
/// Likelihood ratio, nats, and z above which a few segments are enough.
const BEYOND_DOUBT: f64 = 100.0;
const BEYOND_DOUBT_Z: f64 = 1.2;

/// The comparison of two models over the same segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    /// Mean of log(σ² + mse_a) − log(σ² + mse_b): positive in favour of b.
    pub delta: f64,
    /// Its z score.
    pub z: f64,
    /// Effective log-likelihood ratio, nats, without the two segments that favour b most.
    pub lambda: f64,
}

/// Compares model `a` with model `b`; `samples` holds every segment's effective number of samples under `b`.
pub fn paired(a: &[f64], b: &[f64], samples: &[f64], sigma: f64) -> Paired {
    let floor = sigma * sigma;
    let n = a.len().max(1) as f64;
    let gains: Vec<f64> = a.iter().zip(b).map(|(a, b)| (floor + a).ln() - (floor + b).ln()).collect();
    let delta = gains.iter().sum::<f64>() / n;
    let variance = gains.iter().map(|g| (g - delta).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let z = delta / (variance / n).sqrt().max(1e-300);
    let mut shares: Vec<f64> = gains.iter().zip(samples).map(|(g, m)| 0.5 * g * m).collect();
    shares.sort_by(f64::total_cmp);
    let kept = shares.len().saturating_sub(2);
    Paired { delta, z, lambda: shares[..kept].iter().sum() }
}

impl Paired {
    /// Whether `b`, which costs `parameters` more, may be named. Most segments must show it, or a few must show it
    /// beyond doubt. A reversal or a phase of rest shows an effect in few segments.
    pub fn names(&self, parameters: usize, t: &Thresholds) -> bool {
        let lambda = self.lambda - t.price * parameters as f64;
        self.delta >= t.delta && ((self.z >= t.z && lambda >= t.lambda) || self.beyond_doubt(parameters, t.price))
    }

    /// Whether the likelihood is so large that it needs less than the z of a name. The two best segments are left out
    /// of it.
    pub fn beyond_doubt(&self, parameters: usize, price: f64) -> bool {
        self.z > BEYOND_DOUBT_Z && self.lambda - price * parameters as f64 > BEYOND_DOUBT
    }
}
