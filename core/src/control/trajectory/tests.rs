use super::*;
use crate::scalar::{Q32, Real};
use proptest::prelude::*;

/// Velocity and acceleration are the derivatives of the position. The test takes central differences over one tick,
/// whose own error is a sixth (a twelfth) of the next derivative times Ts².
fn derivatives_hold(at: impl Fn(u32) -> Setpoint<f64>, ticks: u32, tick: f64, third: f64, fourth: f64) {
    for k in 1..ticks {
        let (before, here, after) = (at(k - 1), at(k), at(k + 1));
        let v = (after.x - before.x) / (2.0 * tick);
        let a = (after.x - 2.0 * here.x + before.x) / (tick * tick);
        assert!((v - here.v).abs() <= third * tick * tick / 6.0 + 1e-9, "{k}: v {v} {}", here.v);
        assert!((a - here.a).abs() <= fourth * tick * tick / 12.0 + 1e-6, "{k}: a {a} {}", here.a);
    }
}

#[test]
fn the_sine_is_one() {
    let sine = Sine::<f64>::new(0.7, 3.0, 1e-3).unwrap();
    let w = core::f64::consts::TAU * 3.0;
    derivatives_hold(|k| sine.at(k), 2000, 1e-3, 0.7 * w * w * w, 0.7 * w * w * w * w);
    // The frequency's rounding is 2⁻³³ of the tick rate: 4e-4 of a milliradian after 2·10⁶ ticks.
    let far = sine.at(2_000_000);
    assert!((far.x - 0.7 * libm::sin(w * 2000.0)).abs() < 0.7 * w * 2000.0 * 1e-7);
}

/// Trapezoid and S-curve: limits hold, the distance is exact, the derivatives match within each piece.
#[test]
fn profiles_keep_their_limits() {
    for distance in [2.0, -0.3, 0.004, 1e-7, 0.0] {
        let trapezoid = Profile::<f64>::trapezoid(distance, 1.5, 8.0, 1e-3).unwrap();
        let curve = Profile::<f64>::s_curve(distance, 1.5, 8.0, 300.0, 1e-3).unwrap();
        for (profile, jerk) in [(trapezoid, f64::INFINITY), (curve, 300.0)] {
            let n = profile.ticks();
            let (mut speed, mut acceleration, mut change) = (0.0_f64, 0.0_f64, 0.0_f64);
            for k in 0..n + 5 {
                let (here, next) = (profile.at(k), profile.at(k + 1));
                speed = speed.max(here.v.abs());
                acceleration = acceleration.max(here.a.abs());
                change = change.max((next.a - here.a).abs() / 1e-3);
                // A piece is a cubic: over a tick x changes by the mean velocity, up to its jerk's share.
                let jump = next.x - here.x - 0.5e-3 * (next.v + here.v);
                assert!(jump.abs() < 8.0 * 1e-6, "{distance} {k}: {jump:e}");
            }
            assert!(
                speed <= 1.5 * (1.0 + 1e-9) && acceleration <= 8.0 * (1.0 + 1e-9),
                "{distance} {speed} {acceleration}"
            );
            assert!(change <= jerk * (1.0 + 1e-6), "{distance}: {change}");
            let end = profile.at(n);
            assert_eq!((end.x, end.v, end.a), (distance, 0.0, 0.0));
            // The last tick of the move leads there.
            let last = profile.at(n - 1);
            let gap = last.x + 1e-3 * last.v + 0.5e-6 * last.a - distance;
            assert!(gap.abs() < 1e-6 + 300.0 * 1e-9, "{gap:e}");
        }
    }
}

/// The times are those of the closed forms, to the rounding of each phase to a tick. A trapezoid takes d/v + v/a, an
/// S-curve d/v + v/a + a/j.
#[test]
fn profiles_are_as_fast_as_their_limits_allow() {
    let ticks = f64::from(Profile::<f64>::trapezoid(2.0, 1.5, 8.0, 1e-3).unwrap().ticks());
    let exact = (2.0 / 1.5 + 1.5 / 8.0) * 1e3;
    assert!((ticks - exact).abs() <= 3.0, "{ticks} {exact}");
    let ticks = f64::from(Profile::<f64>::s_curve(2.0, 1.5, 8.0, 300.0, 1e-3).unwrap().ticks());
    let exact = (2.0 / 1.5 + 1.5 / 8.0 + 8.0 / 300.0) * 1e3;
    assert!((ticks - exact).abs() <= 7.0, "{ticks} {exact}");
}

#[test]
fn back_and_forth_comes_back() {
    let profile = Profile::<f64>::s_curve(2.0, 1.5, 8.0, 300.0, 1e-3).unwrap().back_and_forth(0.1).unwrap();
    let half = profile.ticks() + 100;
    assert_eq!(profile.at(half - 50).x, 2.0);
    for k in 0..half {
        assert!((profile.at(k).x + profile.at(half + k).x - 2.0).abs() < 1e-12);
        assert_eq!(profile.at(k + 2 * half), profile.at(k));
    }
}

#[test]
fn samples_give_their_derivatives() {
    let mut x = [0.0; 200];
    for (k, value) in x.iter_mut().enumerate() {
        *value = 0.5 * (k as f64 * 1e-2) * (k as f64 * 1e-2);
    }
    let samples = Samples::new(&x, 1e-2).unwrap();
    for k in 1..199 {
        let here = samples.at(k);
        assert!((here.v - f64::from(k) * 1e-2).abs() < 1e-9 && (here.a - 1.0).abs() < 1e-6);
    }
    assert_eq!(samples.at(5000), Setpoint { x: x[199], v: samples.at(199).v, a: samples.at(199).a });
    assert_eq!(Samples::<f64>::new(&[], 1e-2).err(), Some(TrajectoryError::Empty));
}

/// f32 and Q32 against f64. f32 rounds x to 6e-8 of its size. Q32 rounds the tick to 1.2e-10 s, which 2000 of them
/// make 2.4e-7. Velocities and accelerations are larger by ω and ω².
#[test]
fn scalars_agree() {
    let (a, b, c) = (
        Sine::<f64>::new(1.0, 2.0, 1e-3).unwrap(),
        Sine::<f32>::new(1.0, 2.0, 1e-3).unwrap(),
        Sine::<Q32>::new(1.0, 2.0, 1e-3).unwrap(),
    );
    let (p, q, r) = (
        Profile::<f64>::s_curve(2.0, 1.5, 8.0, 300.0, 1e-3).unwrap(),
        Profile::<f32>::s_curve(2.0, 1.5, 8.0, 300.0, 1e-3).unwrap(),
        Profile::<Q32>::s_curve(2.0, 1.5, 8.0, 300.0, 1e-3).unwrap(),
    );
    for k in 0..4000 {
        for (exact, single, fixed) in [(a.at(k), b.at(k), c.at(k)), (p.at(k), q.at(k), r.at(k))] {
            for (exact, single, fixed, scale) in [
                (exact.x, f64::from(single.x), fixed.x.to_f64(), 1.0),
                (exact.v, f64::from(single.v), fixed.v.to_f64(), 13.0),
                (exact.a, f64::from(single.a), fixed.a.to_f64(), 160.0),
            ] {
                assert!((single - exact).abs() < 1e-6 * scale, "{k} {single} {exact}");
                assert!((fixed - exact).abs() < 4e-7 * scale, "{k} {fixed} {exact}");
            }
        }
    }
}

proptest! {
    #[test]
    fn nothing_panics(d in any::<f64>(), v in any::<f64>(), a in any::<f64>(), j in any::<f64>(), ts in any::<f64>(), k in any::<u32>()) {
        let _ = Sine::<f32>::new(d, v, ts).map(|s| s.at(k));
        let _ = Profile::<f32>::trapezoid(d, v, a, ts).map(|p| p.at(k));
        let curve = Profile::<f32>::s_curve(d, v, a, j, ts);
        let _ = curve.map(|p| (p.at(k), p.back_and_forth(a).map(|p| p.at(k))));
    }

    #[test]
    fn limits_hold_for_any_move(d in -10.0..10.0_f64, v in 0.01..10.0_f64, a in 0.1..100.0_f64, j in 1.0..1e4_f64) {
        let profile = Profile::<f64>::s_curve(d, v, a, j, 1e-3).unwrap();
        let n = profile.ticks();
        for i in 0..=100 {
            let here = profile.at((u64::from(n) * i / 100) as u32);
            prop_assert!(here.v.abs() <= v * (1.0 + 1e-6) && here.a.abs() <= a * (1.0 + 1e-6));
            prop_assert!(here.x * d >= -1e-9 && here.x.abs() <= d.abs() * (1.0 + 1e-9) + 1e-12);
        }
    }
}
