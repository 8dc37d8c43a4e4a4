use super::*;
use crate::control::tune;
use crate::scalar::Q32;

const BASE: [f64; 2] = [0.02685, 0.11];

/// A loop on the frictionless plant with held drive, position rounded to `step`; the drives.
fn run<R: Fast>(step: f64, ticks: usize) -> [f64; 2] {
    let [b, c] = BASE;
    let gains = tune(b, c, 10.0, 1e-3, 1).unwrap();
    let pid = Pid::<R>::new(&gains, 1e-3, 12.0).unwrap();
    let mut state = PidState::default();
    let (mut x, mut v, mut pending) = (0.0_f64, 0.0_f64, 0.0);
    let mut last = [0.0; 2];
    for k in 0..ticks {
        let angle = 6.0 * k as f64 * 1e-3;
        let reference = Setpoint {
            x: R::from_f64(libm::sin(angle)),
            v: R::from_f64(6.0 * libm::cos(angle)),
            a: R::from_f64(-36.0 * libm::sin(angle)),
        };
        let reading = libm::round(x / step) * step;
        let u = pid.drive(&mut state, reference, R::from_f64(reading));
        let saturated = u.abs() > pid.limit();
        pid.learn(&mut state, saturated);
        let applied = pending;
        pending = u.to_f64().clamp(-12.0, 12.0);
        v += (applied - c * v) / b * 1e-3;
        x += v * 1e-3;
        last = [x, pending];
    }
    last
}

/// The same loop in f64, f32 and Q32: positions within a few encoder steps (a rounding at a step's edge may fall either
/// way, and differs by a step's worth of derivative from there on), which is 20 times below what the loop's error is.
#[test]
fn scalars_agree() {
    let exact = run::<f64>(1e-3, 3000);
    for found in [run::<f32>(1e-3, 3000), run::<Q32>(1e-3, 3000)] {
        assert!((found[0] - exact[0]).abs() < 3e-3, "{found:?} {exact:?}");
    }
    // With a fine encoder only the arithmetic differs: f32's ė is a difference of positions of size 1 (6e-8) times
    // b·Kv/Ts = 1700.
    let exact = run::<f64>(1e-6, 3000);
    assert!((run::<f32>(1e-6, 3000)[0] - exact[0]).abs() < 2e-5);
    assert!((run::<Q32>(1e-6, 3000)[0] - exact[0]).abs() < 2e-5);
}

/// u = b·Kv·(Λ1·∫e + Λ2·e + ė), term by term.
#[test]
fn it_is_the_formula() {
    let gains = Gains { b: 2.0, kv: 30.0, lambda1: 50.0, lambda2: 10.0, filter_s: 0.0 };
    let pid = Pid::<f64>::new(&gains, 1e-3, 1e9).unwrap();
    let mut state = PidState::default();
    let mut integral = 0.0;
    let mut last = None;
    for k in 0..100 {
        let e = libm::sin(0.3 * f64::from(k));
        integral += e * 1e-3;
        let rate = last.map_or(0.0, |last| (e - last) / 1e-3);
        last = Some(e);
        let expected = 60.0 * (50.0 * integral + 10.0 * e + rate);
        let u = pid.drive(&mut state, Setpoint { x: e, v: 0.0, a: 0.0 }, 0.0);
        pid.learn(&mut state, false);
        assert!((u - expected).abs() < 1e-9 * expected.abs().max(1.0), "{k}: {u} {expected}");
    }
}

/// In saturation the integral stands still; within the rest band it does at rest only.
#[test]
fn the_integral_rests() {
    let gains = tune(BASE[0], BASE[1], 10.0, 1e-3, 1).unwrap();
    let pid = Pid::<f64>::new(&gains, 1e-3, 12.0).unwrap().with_rest_band(1e-3);
    let mut state = PidState::default();
    let rest = Setpoint { x: 0.0, v: 0.0, a: 0.0 };
    pid.drive(&mut state, rest, 1.0);
    pid.learn(&mut state, true);
    assert_eq!(state.integral, 0.0);
    pid.drive(&mut state, rest, 0.9e-3);
    pid.learn(&mut state, false);
    assert_eq!(state.integral, 0.0);
    pid.drive(&mut state, Setpoint { v: 0.1, ..rest }, 0.9e-3);
    pid.learn(&mut state, false);
    assert_eq!(state.integral, -0.9e-3);
}
