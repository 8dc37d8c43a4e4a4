//! Whether a drive moves a position, and which way: a regression of the acceleration.

use nalgebra::{DMatrix, DVector};

/// Lengths of a block, rows: short ones see fast motion, long ones see through the noise.
const BLOCKS: [usize; 6] = [1, 2, 5, 10, 20, 50];
/// Most rows that are looked at.
const MOST_ROWS: usize = 200_000;
/// Fewest blocks of a regression with seven unknowns.
const LEAST: usize = 32;

/// What the acceleration says of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Gain {
    /// Acceleration per drive.
    pub value: f64,
    /// Value over its standard error.
    pub t: f64,
}

/// The gain from `u` to the acceleration of `x`, where the data tell it best.
///
/// Beside it are velocity, its sign, a constant and the position. Where it is known how many radians a unit of `x` is, there is
/// gravity on an arm too. A drive that holds the axis against a spring or gravity would otherwise seem to push the wrong way.
pub(super) fn gain(t: &[f64], u: &[f64], x: &[f64], radians: Option<f64>) -> Gain {
    let rows = t.len().min(u.len()).min(x.len()).min(MOST_ROWS);
    let gains = BLOCKS.into_iter().filter_map(|block| of_blocks(&t[..rows], &u[..rows], &x[..rows], radians, block));
    gains.max_by(|a, b| a.t.abs().total_cmp(&b.t.abs())).unwrap_or_default()
}

/// The same over blocks of `block` rows. The acceleration of two neighbours is driven by the mean of both.
fn of_blocks(t: &[f64], u: &[f64], x: &[f64], radians: Option<f64>, block: usize) -> Option<Gain> {
    let count = (t.len().saturating_sub(1) / block).saturating_sub(1);
    if count < LEAST {
        return None;
    }
    let mut rows = Vec::with_capacity(count);
    for k in 0..count {
        let (a, b, c) = (k * block, (k + 1) * block, (k + 2) * block);
        let (before_s, after_s) = (t[b] - t[a], t[c] - t[b]);
        let (before, after) = ((x[b] - x[a]) / before_s, (x[c] - x[b]) / after_s);
        let acceleration = (after - before) / (0.5 * (before_s + after_s));
        let drive = u[a..c].iter().sum::<f64>() / (c - a) as f64;
        let velocity = 0.5 * (before + after);
        let way = if velocity == 0.0 { 0.0 } else { velocity.signum() };
        let mut row = vec![drive, velocity, way, 1.0, x[b] - x[0]];
        row.extend(radians.iter().flat_map(|radians| [(radians * x[b]).sin(), (radians * x[b]).cos()]));
        if acceleration.is_finite() && row.iter().all(|value| value.is_finite()) {
            rows.push((DVector::from_vec(row), acceleration));
        }
    }
    let unknowns = rows.first()?.0.len();
    // Each regressor in its own rms, so that the matrix is one of numbers about 1.
    let squares = rows.iter().fold(DVector::zeros(unknowns), |sum, (row, _)| sum + row.component_mul(row));
    let scale = squares.map(|square: f64| if square > 0.0 { (square / rows.len() as f64).sqrt() } else { 1.0 });
    let (mut normal, mut right) = (DMatrix::zeros(unknowns, unknowns), DVector::zeros(unknowns));
    for (row, acceleration) in &mut rows {
        row.component_div_assign(&scale);
        normal.ger(1.0, row, row, 1.0);
        right.axpy(*acceleration, row, 1.0);
    }
    // A regressor that is always zero, or the same as another, has no say.
    normal += DMatrix::identity(unknowns, unknowns) * (1e-9 * rows.len() as f64);
    let inverse = normal.try_inverse()?;
    let solution = &inverse * right;
    let residual = |(row, acceleration): &(DVector<f64>, f64)| (acceleration - row.dot(&solution)).powi(2);
    let variance = rows.iter().map(residual).sum::<f64>() / (rows.len().saturating_sub(unknowns)).max(1) as f64;
    let error = (variance * inverse[(0, 0)]).sqrt();
    let gain = Gain { value: solution[0] / scale[0], t: solution[0] / error };
    (gain.t.is_finite() && gain.value.is_finite()).then_some(gain)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A relay of ±1 on x″ = 3·u − v: the gain is 3, and −3 with the sign turned. The tolerance is that of accelerations
    /// from differences over a row.
    #[test]
    fn the_gain_has_the_sign_of_the_drive() {
        let (mut x, mut v) = (0.0, 0.0);
        let t: Vec<f64> = (0..4000).map(|k| f64::from(k) * 1e-3).collect();
        let u: Vec<f64> = t.iter().map(|t| if ((t / 0.3) as usize).is_multiple_of(2) { 1.0 } else { -1.0 }).collect();
        let positions: Vec<f64> = u
            .iter()
            .map(|u| {
                x += v * 1e-3;
                v += (3.0 * u - v) * 1e-3;
                x
            })
            .collect();
        let right = gain(&t, &u, &positions, None);
        assert!((right.value / 3.0 - 1.0).abs() < 0.02 && right.t > 10.0, "{right:?}");
        let turned: Vec<f64> = u.iter().map(|u| -u).collect();
        let wrong = gain(&t, &turned, &positions, Some(1.0));
        assert!((wrong.value / -3.0 - 1.0).abs() < 0.02 && wrong.t < -10.0, "{wrong:?}");
        assert_eq!(gain(&t[..20], &u, &positions, None), Gain::default());
    }
}
