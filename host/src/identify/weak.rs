//! Equation error in weak form (docs/theory.md, section 5).
//!
//! Over windows of ±20 ms, with the test function `φ = (1 − s²)⁴`, the equation of motion is integrated against φ and
//! its derivatives are moved onto φ:
//!
//! `b·∫φ̈x − c·∫φ̇x + f1·∫φ·sgn v + f0·∫φ = ∫φu`
//!
//! The kernels of the sampled x are corrected to be exact on 1, t, t², t³ for any sampling instants. Otherwise a
//! constant position leaks in as a false spring. u is held from sample to sample and integrated exactly.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};

use crate::fit::MeasuredMotion;

/// Half-width of a window, s; at least `MIN_HALF_SAMPLES` samples.
pub const HALF_WIDTH_S: f64 = 0.020;
const MIN_HALF_SAMPLES: usize = 8;
/// Longest sample interval at which windows keep their standard width, s.
pub(super) const STANDARD_INTERVAL_S: f64 = HALF_WIDTH_S / MIN_HALF_SAMPLES as f64;
/// ∫(1−s²)⁴ ds and ∫s²(1−s²)⁴ ds over −1..1.
const I0: f64 = 256.0 / 315.0;
const I2: f64 = 256.0 / 3465.0;

/// One window: the sides of its equation and where it lies.
#[derive(Clone, Debug)]
pub struct Window {
    /// MeasuredMotion it lies in.
    pub track: usize,
    /// First sample; the weights run from here.
    pub first: usize,
    /// Sample at its centre.
    pub centre: usize,
    /// ∫φ̈x.
    pub acceleration: f64,
    /// −∫φ̇x.
    pub velocity: f64,
    /// ∫φ·sgn v.
    pub direction: f64,
    /// ∫φ.
    pub unit: f64,
    /// ∫φu.
    pub drive: f64,
    /// Weight of every sample interval: ∫φ over it.
    pub weights: Vec<f64>,
    /// What all sides of the equation are multiplied by: noise at rest over noise at the window's speed.
    pub scale: f64,
    kernels: Arc<Kernels>,
    width: f64,
}

/// Antiderivative of (1 − s²)⁴.
fn antiderivative(s: f64) -> f64 {
    let q = s * s;
    s * (1.0 + q * (-4.0 / 3.0 + q * (6.0 / 5.0 + q * (-4.0 / 7.0 + q / 9.0))))
}

/// Mean of sgn v over an interval with velocities `v0`, `v1` at its ends.
pub fn mean_direction(v0: f64, v1: f64) -> f64 {
    if v0 * v1 < 0.0 {
        let before = v0 / (v0 - v1);
        v0.signum() * (2.0 * before - 1.0)
    } else if v0 == 0.0 && v1 == 0.0 {
        0.0
    } else {
        (v0 + v1).signum()
    }
}

/// The quadrature kernels of ∫φ̇x and ∫φ̈x on the abscissae `s`.
#[derive(Debug)]
struct Kernels {
    first: Vec<f64>,
    second: Vec<f64>,
}

impl Kernels {
    fn new(s: &[f64]) -> Option<Self> {
        let n = s.len();
        let spacing = |i: usize| {
            let left = if i > 0 { s[i] - s[i - 1] } else { 0.0 };
            let right = if i + 1 < n { s[i + 1] - s[i] } else { 0.0 };
            0.5 * (left + right)
        };
        // Jitter may put the outermost samples beyond ±1, where φ is zero.
        let q = |s: f64| (1.0 - s * s).max(0.0);
        let mut first: Vec<f64> = (0..n).map(|i| -8.0 * s[i] * q(s[i]).powi(3) * spacing(i)).collect();
        let mut second: Vec<f64> =
            (0..n).map(|i| (48.0 * s[i] * s[i] * q(s[i]).powi(2) - 8.0 * q(s[i]).powi(3)) * spacing(i)).collect();
        let mut gram = Matrix4::zeros();
        for &si in s {
            let row = Vector4::new(1.0, si, si * si, si * si * si);
            gram += row * row.transpose();
        }
        let inverse = gram.try_inverse()?;
        let correct = |weights: &mut Vec<f64>, exact: Vector4<f64>| {
            let mut moments = Vector4::zeros();
            for (w, &si) in weights.iter().zip(s) {
                moments += *w * Vector4::new(1.0, si, si * si, si * si * si);
            }
            let lambda = inverse * (exact - moments);
            for (w, &si) in weights.iter_mut().zip(s) {
                *w += lambda.dot(&Vector4::new(1.0, si, si * si, si * si * si));
            }
        };
        correct(&mut first, Vector4::new(0.0, -I0, 0.0, -3.0 * I2));
        correct(&mut second, Vector4::new(0.0, 0.0, 2.0 * I0, 0.0));
        Some(Self { first, second })
    }
}

/// All windows of the tracks that lie within one piece and hold no stick phase.
pub fn windows(tracks: &[MeasuredMotion]) -> Vec<Window> {
    windows_of(tracks, HALF_WIDTH_S, |_, _, _| true)
}

/// As [`windows`], of another half-width, s; the noise of their force falls as its power −2.5. Only those that are
/// wanted, by track, first and last sample.
pub fn windows_of(
    tracks: &[MeasuredMotion],
    half_width_s: f64,
    wanted: impl Fn(usize, usize, usize) -> bool,
) -> Vec<Window> {
    let mut all = Vec::new();
    for (index, track) in tracks.iter().enumerate() {
        let half = ((half_width_s / track.ts).round() as usize).max(MIN_HALF_SAMPLES);
        let width = half as f64 * track.ts;
        let still = still_samples(track);
        let mut cache: Option<Arc<Kernels>> = None;
        for piece in track.pieces.windows(2) {
            let mut centre = piece[0] + half;
            while centre + half < piece[1] {
                let (first, last) = (centre - half, centre + half);
                if wanted(index, first, last) && !still[first..=last].iter().any(|s| *s) {
                    let s: Vec<f64> = (first..=last).map(|k| (track.t[k] - track.t[centre]) / width).collect();
                    let uniform =
                        s.iter().enumerate().all(|(i, si)| (si - (i as f64 / half as f64 - 1.0)).abs() < 1e-3);
                    let own = if uniform { None } else { Kernels::new(&s).map(Arc::new) };
                    if uniform && cache.is_none() {
                        cache = Kernels::new(&s).map(Arc::new);
                    }
                    let kernels = if uniform { cache.as_ref() } else { own.as_ref() };
                    if let Some(kernels) = kernels {
                        all.push(window(track, index, first, centre, width, &s, kernels));
                    }
                }
                centre += half / 2;
            }
        }
    }
    all
}

fn window(
    track: &MeasuredMotion,
    index: usize,
    first: usize,
    centre: usize,
    width: f64,
    s: &[f64],
    kernels: &Arc<Kernels>,
) -> Window {
    let upto = |s: f64| antiderivative(s.clamp(-1.0, 1.0));
    let scale = track.weight(centre);
    let weights: Vec<f64> = s.windows(2).map(|w| scale * width * (upto(w[1]) - upto(w[0]))).collect();
    let (mut direction, mut drive, mut unit) = (0.0, 0.0, 0.0);
    for (i, w) in weights.iter().enumerate() {
        let k = first + i;
        direction += w * mean_direction(track.vs[k], track.vs[k + 1]);
        drive += w * track.u[k];
        unit += w;
    }
    let mut window = Window {
        track: index,
        first,
        centre,
        acceleration: 0.0,
        velocity: 0.0,
        direction,
        unit,
        drive,
        weights,
        scale,
        kernels: Arc::clone(kernels),
        width,
    };
    (window.acceleration, window.velocity) = window.derivatives(|k| track.x[k]);
    window
}

/// Samples within a stick phase: the smoothed velocity stays below its noise for five samples or more.
fn still_samples(track: &MeasuredMotion) -> Vec<bool> {
    let half = ((0.010 / track.ts).round() as usize).max(4);
    let points = (2 * half + 1) as f64;
    // Standard deviation of the slope of a local cubic on n points: σ·√(75/n³)/Ts.
    let noise = (4.0 * track.sigma * (75.0 / points.powi(3)).sqrt() / track.ts).max(1e-300);
    let n = track.t.len();
    let mut still = vec![false; n];
    let mut run = 0;
    for k in 0..n {
        run = if track.vs[k].abs() < noise { run + 1 } else { 0 };
        if run >= 5 {
            still[k + 1 - run..=k].fill(true);
        }
    }
    still
}

impl Window {
    /// Half its width, s.
    pub fn half_width_s(&self) -> f64 {
        self.width
    }

    /// ∫φ̈g and −∫φ̇g of a quantity given at the samples of the window's track.
    pub fn derivatives(&self, g: impl Fn(usize) -> f64) -> (f64, f64) {
        let reference = g(self.centre);
        let (mut second, mut first) = (0.0, 0.0);
        for (i, (w1, w2)) in self.kernels.first.iter().zip(&self.kernels.second).enumerate() {
            let value = g(self.first + i) - reference;
            first -= w1 * value;
            second += w2 * value;
        }
        (self.scale * second / self.width, self.scale * first)
    }

    /// ∫φ·g for a quantity that is constant from sample to sample.
    pub fn held_integral(&self, g: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().enumerate().map(|(i, w)| w * g(self.first + i)).sum()
    }

    /// ∫φ·g for a quantity given at the samples of the window's track (trapezoid between samples).
    pub fn integral(&self, g: impl Fn(usize) -> f64) -> f64 {
        let mut previous = g(self.first);
        let mut sum = 0.0;
        for (i, w) in self.weights.iter().enumerate() {
            let next = g(self.first + i + 1);
            sum += w * 0.5 * (previous + next);
            previous = next;
        }
        sum
    }
}

/// Least squares of the weak form.
#[derive(Clone, Debug)]
pub struct WeakFit {
    /// Coefficients, in the order of the columns.
    pub coefficients: DVector<f64>,
    /// Covariance, residual correlation of overlapping windows allowed for.
    pub covariance: DMatrix<f64>,
    /// Residual of every window.
    pub residual: DVector<f64>,
    /// Condition number of the scaled normal matrix.
    pub condition: f64,
    /// Lag-1 autocorrelation of the residual, from windows that do not overlap.
    pub lag_one: f64,
}

/// Coefficients and residual of `columns · coefficients = target`; `None` if the columns are not independent.
pub fn least_squares(columns: &DMatrix<f64>, target: &DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
    let norms: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
    if columns.nrows() < columns.ncols() + 4 || norms.iter().any(|norm| !(*norm > 0.0 && norm.is_finite())) {
        return None;
    }
    let gram = columns.tr_mul(columns);
    let scaled = DMatrix::from_fn(norms.len(), norms.len(), |i, j| gram[(i, j)] / (norms[i] * norms[j]));
    let right = columns.tr_mul(target);
    let solution = scaled.cholesky()?.solve(&DVector::from_fn(norms.len(), |i, _| right[i] / norms[i]));
    let coefficients = DVector::from_fn(norms.len(), |i, _| solution[i] / norms[i]);
    let residual = target - columns * &coefficients;
    Some((coefficients, residual))
}

/// Solves `columns · coefficients = target`; `None` if the columns are not independent.
pub fn solve(columns: &DMatrix<f64>, target: &DVector<f64>) -> Option<WeakFit> {
    let (n, p) = columns.shape();
    if n < p + 4 {
        return None;
    }
    let norms: Vec<f64> = (0..p).map(|j| columns.column(j).norm()).collect();
    if norms.iter().any(|norm| !(*norm > 0.0 && norm.is_finite())) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, p, |i, j| columns[(i, j)] / norms[j]);
    let gram = scaled.transpose() * &scaled;
    let eigenvalues = gram.clone().symmetric_eigenvalues();
    let condition = eigenvalues.max() / eigenvalues.min().max(1e-300);
    let inverse = gram.cholesky()?.inverse();
    let solution = &inverse * (scaled.transpose() * target);
    let residual = target - &scaled * &solution;
    // Windows advance by a quarter of their length; the meat sums the products over the overlap.
    let mut meat = DMatrix::<f64>::zeros(p, p);
    for lag in 0..4usize {
        let weight = 1.0 - lag as f64 / 4.0;
        for i in 0..n - lag {
            let product = residual[i] * residual[i + lag] * weight;
            let outer = scaled.row(i).transpose() * scaled.row(i + lag);
            if lag == 0 {
                meat += outer * product;
            } else {
                meat += (&outer + outer.transpose()) * product;
            }
        }
    }
    let mut covariance = &inverse * meat * &inverse;
    for i in 0..p {
        for j in 0..p {
            covariance[(i, j)] /= norms[i] * norms[j];
        }
    }
    let variance = residual.norm_squared().max(f64::MIN_POSITIVE);
    let lag_one = (0..n.saturating_sub(4)).map(|i| residual[i] * residual[i + 4]).sum::<f64>() / variance;
    let coefficients = DVector::from_fn(p, |i, _| solution[i] / norms[i]);
    Some(WeakFit { coefficients, covariance, residual, condition, lag_one })
}

/// The base columns [b, c, f1] and the constant load, for all windows.
pub fn base_columns(windows: &[Window]) -> (DMatrix<f64>, DVector<f64>) {
    let columns = DMatrix::from_fn(windows.len(), 4, |i, j| {
        let w = &windows[i];
        [w.acceleration, w.velocity, w.direction, w.unit][j]
    });
    (columns, DVector::from_iterator(windows.len(), windows.iter().map(|w| w.drive)))
}

#[cfg(test)]
mod tests;
