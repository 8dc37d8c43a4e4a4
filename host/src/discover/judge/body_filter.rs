//! What a second body on the motor lets through of a force.

use wide::f64x4;

use super::weak_form::{Field, WeakForm};

/// Signals that are filtered in one go. Each sample waits for the one before it, so that four take hardly longer than one.
const TOGETHER: usize = 4;

/// Coefficients of a filter of second order: of the input from the newest sample on, and of the two outputs before.
struct Filter {
    input: [f64; 3],
    output: [f64; 2],
    /// Share of a constant input that passes.
    still: f64,
}

impl Filter {
    /// (s² + 2ζωs + ω²)/(s² + (1 + r)(2ζωs + ω²)) by the bilinear transform, for samples `h_s` seconds apart. r is the second
    /// body's inertia over the motor's.
    fn new([omega, zeta, ratio]: [f64; 3], h_s: f64) -> Self {
        let k = 2.0 / h_s;
        let (damping, stiffness) = (2.0 * zeta * omega, omega * omega);
        let part = |scale: f64| {
            [
                k * k + scale * (damping * k + stiffness),
                2.0 * (scale * stiffness - k * k),
                k * k + scale * (stiffness - damping * k),
            ]
        };
        let both = 1.0 + ratio.max(0.0);
        let (above, below) = (part(1.0), part(both));
        // A division in each step would take half of the time.
        let [above, below] = [above, below].map(|own| own.map(|c| c / below[0]));
        Self { input: above, output: [below[1], below[2]], still: 1.0 / both }
    }

    /// The filtered signals. Each starts at rest under its first sample. A shorter one goes on with zeros, because an effect
    /// of one recording has no samples in the others.
    fn run(&self, signals: [&[f64]; TOGETHER]) -> [Vec<f64>; TOGETHER] {
        let n = signals.iter().map(|signal| signal.len()).max().unwrap_or(0);
        let mut filtered = [(); TOGETHER].map(|()| Vec::with_capacity(n));
        // Each lane is written out. The compiler may leave `map` of an array as a call for each sample.
        let [one, two, three, four] = signals;
        let at = |k: usize| {
            let of = |signal: &[f64]| signal.get(k).copied().unwrap_or(0.0);
            f64x4::new([of(one), of(two), of(three), of(four)])
        };
        let first = at(0);
        let (mut x1, mut x2, mut y1, mut y2) = (first, first, first * self.still, first * self.still);
        let ([b0, b1, b2], [a1, a2]) = (self.input.map(f64x4::splat), self.output.map(f64x4::splat));
        for k in 0..n {
            let x = at(k);
            // The newest output comes last, because the next step waits for it alone.
            let y = (b0 * x + b1 * x1 + b2 * x2 - a2 * y2) - a1 * y1;
            for (filtered, y) in filtered.iter_mut().zip(y.to_array()) {
                filtered.push(y);
            }
            (x2, x1, y2, y1) = (x1, x, y1, y);
        }
        filtered
    }
}

/// Means in every window of what a second body lets through of each field. `body` is its angular frequency (rad/s) and damping
/// ratio on a motor that is held, and its inertia over the motor's.
pub(super) fn passed(form: &WeakForm<'_>, fields: &[&Field], body: [f64; 3]) -> Vec<Vec<f64>> {
    let pieces = &form.dataset.pieces;
    let together = fields.chunks(TOGETHER).flat_map(|some| {
        let mut filtered: [Field; TOGETHER] = Default::default();
        for (i, piece) in pieces.iter().enumerate() {
            let signals = std::array::from_fn(|j| &some.get(j).unwrap_or(&some[0])[i][..]);
            let own = Filter::new(body, piece.h_s).run(signals);
            filtered.iter_mut().zip(own).for_each(|(field, own)| field.push(own));
        }
        filtered.into_iter().take(some.len()).map(|field| form.means(&field)).collect::<Vec<_>>()
    });
    together.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body of half the motor's inertia at 30 rad/s. A constant passes by 1/(1 + r) at once, and so does a slow sine. A
    /// fast one passes as if the body were not there. A signal without samples leaves the others as they are.
    #[test]
    fn slow_forces_move_both_bodies_and_fast_ones_the_motor_alone() {
        let h_s = 1e-3;
        let sine = |omega: f64| -> Vec<f64> { (0..20_000).map(|k| (omega * h_s * k as f64).sin()).collect() };
        let (slow, fast, constant) = (sine(1.0), sine(600.0), vec![1.0; 20_000]);
        let passed = Filter::new([30.0, 0.1, 0.5], h_s).run([&slow, &fast, &constant, &[]]);
        let gain = |i: usize, signal: &[f64]| {
            let rms = |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
            rms(&passed[i][10_000..]) / rms(&signal[10_000..])
        };
        // |H| is .6664 at 1 rad/s and 1.0011 at 600 rad/s, by the bilinear transform. The sums end within a period.
        assert!((gain(0, &slow) - 0.6664).abs() < 1e-3, "{}", gain(0, &slow));
        assert!((gain(1, &fast) - 1.0011).abs() < 1e-3, "{}", gain(1, &fast));
        assert!(passed[2].iter().all(|y| (y - 1.0 / 1.5).abs() < 1e-9));
        assert!(passed[3].iter().all(|y| *y == 0.0));
    }
}
