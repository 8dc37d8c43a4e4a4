//! Kernels of the windows: means, and derivatives of the position.
//!
//! With φ(s) = (1 − s²)³ over ±T, normalised, `∫φẍ = ∫φ̈x` and `∫φẋ = −∫φ̇x`. The sampled kernels are corrected to be
//! exact on 1, t, t² and t³. Without that a constant position would look like a spring.

use nalgebra::{Matrix4, Vector4};

use super::regression::dot_from;

/// Kernels of one window of ±m samples: of the mean, the velocity and the acceleration.
#[derive(Clone, Debug)]
pub struct Kernels {
    /// Samples from the middle to the edge.
    pub half: usize,
    /// Weights of the mean, 1.
    pub mean: Vec<f64>,
    /// Weights of the velocity, 1/s.
    pub velocity: Vec<f64>,
    /// Weights of the acceleration, 1/s².
    pub acceleration: Vec<f64>,
}

impl Kernels {
    /// Kernels of ±`half` samples, `half` ≥ 2, of `h_s` seconds each.
    pub fn new(half: usize, h_s: f64) -> Self {
        // φ is 0 at one sample beyond the last. So every sample within counts.
        let m = (half + 1) as f64;
        let s: Vec<f64> = (0..=2 * half).map(|j| (j as f64 - half as f64) / m).collect();
        let width = m * h_s;
        let q = |s: f64| 1.0 - s * s;
        let phi: Vec<f64> = s.iter().map(|s| q(*s).powi(3)).collect();
        let total: f64 = phi.iter().sum();
        let mean: Vec<f64> = phi.iter().map(|p| p / total).collect();
        let second_moment: f64 = mean.iter().zip(&s).map(|(w, s)| w * s * s).sum();
        let slope: Vec<f64> = s.iter().map(|s| 6.0 * s * q(*s).powi(2) / total).collect();
        let curvature: Vec<f64> = s.iter().map(|s| (24.0 * s * s * q(*s) - 6.0 * q(*s).powi(2)) / total).collect();
        let slope = corrected(&slope, &s, &phi, Vector4::new(0.0, 1.0, 0.0, 3.0 * second_moment));
        let curvature = corrected(&curvature, &s, &phi, Vector4::new(0.0, 0.0, 2.0, 0.0));
        Self {
            half,
            mean,
            velocity: slope.iter().map(|w| w / width).collect(),
            acceleration: curvature.iter().map(|w| w / (width * width)).collect(),
        }
    }

    /// The weighted sum of the samples about `k`, each less that at `k`.
    #[inline]
    pub(super) fn at(&self, weights: &[f64], x: &[f64], k: usize) -> f64 {
        dot_from(weights, &x[k - self.half..], x[k])
    }
}

/// Weights with the `wanted` moments of 1, s, s² and s³. The correction is shaped like the test function.
fn corrected(weights: &[f64], s: &[f64], phi: &[f64], wanted: Vector4<f64>) -> Vec<f64> {
    let row = |s: f64| Vector4::new(1.0, s, s * s, s * s * s);
    let mut gram = Matrix4::zeros();
    let mut moments = Vector4::zeros();
    for ((w, s), p) in weights.iter().zip(s).zip(phi) {
        gram += *p * row(*s) * row(*s).transpose();
        moments += *w * row(*s);
    }
    let Some(inverse) = gram.try_inverse() else { return weights.to_vec() };
    let lambda = inverse * (wanted - moments);
    weights.iter().zip(s).zip(phi).map(|((w, s), p)| w + p * lambda.dot(&row(*s))).collect()
}

/// The weighted sum at every sample; at either end, that of the nearest full window.
pub(super) fn over(kernel: &Kernels, weights: &[f64], x: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n < 2 * kernel.half + 1 {
        return vec![0.0; n];
    }
    let mut values = vec![0.0; n];
    for (k, value) in values.iter_mut().enumerate().take(n - kernel.half).skip(kernel.half) {
        *value = kernel.at(weights, x, k);
    }
    let (first, last) = (values[kernel.half], values[n - 1 - kernel.half]);
    values[..kernel.half].fill(first);
    values[n - kernel.half..].fill(last);
    values
}

pub(super) fn norm(weights: &[f64]) -> f64 {
    weights.iter().map(|w| w * w).sum::<f64>().sqrt()
}
