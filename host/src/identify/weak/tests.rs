//! The kernels on polynomials, and the regression on what it is made for.

use super::*;
use crate::recording::Recording;

/// Times of about 1 ms, jittered by up to ± 30 % of it.
fn times(jitter: f64) -> Vec<f64> {
    let mut phase = 0.37_f64;
    (0..400)
        .map(|k| {
            phase = (phase * 997.0 + 0.123).fract();
            1e-3 * (f64::from(k) + jitter * (2.0 * phase - 1.0))
        })
        .collect()
}

fn windows_of(jitter: f64, x: impl Fn(f64) -> f64) -> (Vec<Window>, MeasuredMotion) {
    let t = times(jitter);
    let track = MeasuredMotion::new(&Recording {
        u: vec![0.0; t.len()],
        x: t.iter().map(|t| x(*t)).collect(),
        t,
        ..Recording::default()
    });
    (windows(std::slice::from_ref(&track)), track)
}

/// ∫φ·g over the window's support, by the midpoint rule on 4000 points (error 1e-10 of the largest value).
fn integral(track: &MeasuredMotion, window: &Window, g: impl Fn(f64) -> f64) -> f64 {
    let centre = track.t[window.centre];
    let h = 2.0 * window.width / 4000.0;
    (0..4000)
        .map(|i| {
            let offset = -window.width + h * (f64::from(i) + 0.5);
            let q = 1.0 - (offset / window.width).powi(2);
            h * q.powi(4) * g(centre + offset)
        })
        .sum()
}

/// A constant gives nothing, and t, t², t³ their velocity and acceleration, for even and for jittered sampling. The
/// motion is of order 1 over the record; 1e-9 is the rounding of x times the kernels of order 1/width² = 2500, and the
/// comparison integral's error.
#[test]
fn kernels_are_exact_on_cubics() {
    for jitter in [0.0, 0.3] {
        type Function = fn(f64) -> f64;
        let cases: [(Function, Function, Function); 3] = [
            (|t| 5.0 + 3.0 * t, |_| 3.0, |_| 0.0),
            (|t| 2.0 * t - 7.0 * t * t, |t| 2.0 - 14.0 * t, |_| -14.0),
            (|t| t + 40.0 * t.powi(3), |t| 1.0 + 120.0 * t * t, |t| 240.0 * t),
        ];
        for (index, (x, v, a)) in cases.into_iter().enumerate() {
            let (all, track) = windows_of(jitter, x);
            assert!(all.len() > 20, "{}", all.len());
            for window in &all {
                let (velocity, acceleration) = (integral(&track, window, v), integral(&track, window, a));
                let errors = [window.velocity - velocity, window.acceleration - acceleration];
                assert!(
                    errors[0].abs() < 1e-9 && errors[1].abs() < 1e-7,
                    "jitter {jitter}, case {index}, window {}: {errors:?}",
                    window.centre
                );
            }
        }
    }
}

#[test]
fn a_constant_position_is_no_spring() {
    let (all, track) = windows_of(0.3, |t| (30.0 * t).sin());
    for window in &all {
        let (second, first) = window.derivatives(|_| 1e6);
        assert_eq!((second, first), (0.0, 0.0), "{}", track.t[window.centre]);
    }
}

/// `mean_direction` is the time average of the sign of a velocity that is linear in between.
#[test]
fn mean_direction_splits_at_the_zero() {
    for (v0, v1, mean) in
        [(1.0, 3.0, 1.0), (-2.0, -1.0, -1.0), (1.0, -1.0, 0.0), (3.0, -1.0, 0.5), (-3.0, 1.0, -0.5), (0.0, 0.0, 0.0)]
    {
        assert!((mean_direction(v0, v1) - mean).abs() < 1e-15, "{v0} {v1}");
    }
}

/// Columns that depend on each other, that are zero, or that are more than the rows: no answer.
#[test]
fn singular_systems_are_refused() {
    let target = DVector::from_fn(20, |i, _| i as f64);
    let twice = DMatrix::from_fn(20, 2, |i, j| (i as f64 + 1.0) * (j as f64 + 1.0));
    assert!(solve(&twice, &target).is_none_or(|fit| fit.condition > 1e12));
    assert!(solve(&DMatrix::zeros(20, 1), &target).is_none());
    assert!(solve(&DMatrix::from_element(4, 3, 1.0), &DVector::zeros(4)).is_none());
}
