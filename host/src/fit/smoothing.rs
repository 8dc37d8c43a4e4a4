//! Smoothed motion: a local cubic around every sample.

use super::prepare::MeasuredMotion;

impl MeasuredMotion {
    /// Local least squares around every sample of `from..to`.
    pub(super) fn smooth(&mut self, from: usize, to: usize, half: usize, residuals: &mut [f64]) {
        if to - from < 5 {
            return;
        }
        let scale = half as f64 * self.ts;
        let uniform = (from + 1..to).all(|k| ((self.t[k] - self.t[k - 1]) / self.ts - 1.0).abs() < 0.01);
        let interior =
            uniform.then(|| kernels(&(0..=2 * half).map(|i| i as f64 / half as f64 - 1.0).collect::<Vec<_>>(), true));
        #[allow(clippy::needless_range_loop, reason = "k is the centre of a window into several columns")]
        for k in from..to {
            // At the ends a parabola over samples of one side is used. A cubic's slope there is mostly noise.
            let first = k.saturating_sub(half).min((to - 1).saturating_sub(2 * half)).max(from);
            let last = (first + 2 * half).min(to - 1);
            let centred = k - first == half && last - k == half;
            let own;
            let weights = match &interior {
                Some(weights) if centred => weights,
                _ => {
                    let s: Vec<f64> = (first..=last).map(|i| (self.t[i] - self.t[k]) / scale).collect();
                    own = kernels(&s, centred);
                    &own
                }
            };
            let centre = self.x[k];
            let mut fit = [0.0; 3];
            for (i, weight) in (first..=last).zip(weights) {
                let y = self.x[i] - centre;
                fit[0] += weight[0] * y;
                fit[1] += weight[1] * y;
                fit[2] += weight[2] * y;
            }
            self.xs[k] = centre + fit[0];
            self.vs[k] = fit[1] / scale;
            self.acceleration[k] = 2.0 * fit[2] / (scale * scale);
            residuals[k] = fit[0];
        }
    }
}

/// Least-squares weights of value, slope and curvature at s = 0, on the abscissae `s`: of a cubic, or else of a
/// parabola.
fn kernels(s: &[f64], cubic: bool) -> Vec<[f64; 3]> {
    let row = |si: f64| nalgebra::Vector4::new(1.0, si, si * si, if cubic { si * si * si } else { 0.0 });
    let mut gram = nalgebra::Matrix4::<f64>::zeros();
    for &si in s {
        gram += row(si) * row(si).transpose();
    }
    if !cubic {
        gram[(3, 3)] = 1.0;
    }
    let Some(inverse) = gram.try_inverse() else {
        return vec![[1.0 / s.len() as f64, 0.0, 0.0]; s.len()];
    };
    s.iter()
        .map(|&si| {
            let weights = inverse * row(si);
            [weights[0], weights[1], weights[2]]
        })
        .collect()
}

#[cfg(test)]
mod tests;
