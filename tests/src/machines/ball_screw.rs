//! The ripple of a ball screw: the line of the position's spectrum in the force that plain least squares leaves. No part
//! of the tool is used.

use breakaway::recording::Recording;
use nalgebra::{DMatrix, DVector};

/// Rows on either side of one, over which a cubic gives its velocity and acceleration.
const ROWS: usize = 10;
/// Speed below which the direction of the friction is unsure, m/s.
const SLOW: f64 = 0.01;
/// Rows of which one is used. The drive changes little within 5 ms.
const EVERY: usize = 5;

/// A row in motion.
#[derive(Clone, Copy, Debug)]
struct Motion {
    /// Position, m; velocity, m/s; acceleration, m/s²; mean of the drive, V.
    x: f64,
    v: f64,
    a: f64,
    u: f64,
}

/// The rows in motion of an evenly sampled recording.
fn motions(recording: &Recording) -> Vec<Motion> {
    let h = recording.t[1] - recording.t[0];
    let at = |i: usize, j: usize| ((i as f64 - ROWS as f64) * h).powi(j as i32);
    let cubic = DMatrix::from_fn(2 * ROWS + 1, 4, at).pseudo_inverse(1e-12).unwrap();
    let windows = recording.x.windows(2 * ROWS + 1).zip(recording.u.windows(2 * ROWS + 1));
    let of = |(x, u): (&[f64], &[f64])| {
        let fit = &cubic * DVector::from_column_slice(x);
        Motion { x: x[ROWS], v: fit[1], a: 2.0 * fit[2], u: u.iter().sum::<f64>() / u.len() as f64 }
    };
    windows.step_by(EVERY).map(of).filter(|own| own.v.abs() > SLOW).collect()
}

/// The strongest line of what inertia, friction in either direction and a load leave of the drive. Given are its wave number
/// (1/m), its share of the energy, and its phase (rad).
fn line(rows: &[Motion]) -> [f64; 3] {
    let column = |i: usize, j: usize| [rows[i].a, rows[i].v, rows[i].v.abs(), rows[i].v.signum(), 1.0][j];
    let design = DMatrix::from_fn(rows.len(), 5, column);
    let drive = DVector::from_iterator(rows.len(), rows.iter().map(|own| own.u));
    let left = &drive - &design * design.clone().svd(true, true).solve(&drive, 1e-12).unwrap();
    let energy = left.norm_squared() * rows.len() as f64;
    let of = |k: f64| {
        let sum = |wave: fn(f64) -> f64| rows.iter().zip(&left).map(|(own, r)| r * wave(k * own.x)).sum::<f64>();
        let (cos, sin) = (sum(f64::cos), sum(f64::sin));
        [k, (cos * cos + sin * sin) / energy, sin.atan2(cos)]
    };
    (30..800).map(|k| of(10.0 * f64::from(k))).max_by(|a, b| a[1].total_cmp(&b[1])).unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::catalogue::EMPS;
    use crate::machines::reading;
    use crate::measured_data;

    /// Waves of 2.5 mm in a metre, times 2π.
    const WAVES: f64 = std::f64::consts::TAU / 2.5e-3;

    /// The strongest line has waves of 2.5 mm over all rows, in either half and in either direction. So it is the
    /// machine's, and a name for it is true. The halves give one phase. Lines are 10 /m apart and a half has a resolution of 30 /m.
    #[test]
    fn emps_has_a_force_every_2_5_mm() {
        let Some(data) = measured_data() else { return };
        let source = reading::read(&EMPS, &data).unwrap().swap_remove(0);
        let all = motions(source.recording.as_ref().unwrap());
        let (first, second) = all.split_at(all.len() / 2);
        let (forward, backward): (Vec<Motion>, Vec<Motion>) = all.iter().partition(|own| own.v > 0.0);
        let parts = [&all, first, second, &forward, &backward].map(line);
        println!("{parts:.3?}");
        assert!(parts.iter().all(|[k, share, _]| (k - WAVES).abs() < 10.0 && *share > 0.03), "{parts:?}");
        assert!((parts[1][2] - parts[2][2]).abs() < 0.2, "{parts:?}");
    }
}
