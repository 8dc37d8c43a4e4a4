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
        if saturated {
            pid.cut(&mut state, u.max(-pid.limit()).min(pid.limit()) - u);
        } else {
            pid.update(&mut state);
        }
        let applied = pending;
        pending = u.to_f64().clamp(-12.0, 12.0);
        v += (applied - c * v) / b * 1e-3;
        x += v * 1e-3;
        last = [x, pending];
    }
    last
}

/// The same loop in f64, f32 and Q32 gives positions within a few encoder steps. A rounding at a step's edge may fall
/// either way, and differs by a step's worth of derivative from there on. That is 20 times below the loop's error.
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
    let gains = Gains { b: 2.0, kv: 30.0, lambda1: 50.0, lambda2: 10.0, filter_s: 0.0, observer_rad_s: 0.0 };
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
        pid.update(&mut state);
        assert!((u - expected).abs() < 1e-9 * expected.abs().max(1.0), "{k}: {u} {expected}");
    }
}

/// In saturation the integral goes back by what was cut off, and does not go on; within the rest band it does at rest only.
#[test]
fn the_integral_rests() {
    let gains = tune(BASE[0], BASE[1], 10.0, 1e-3, 1).unwrap();
    let pid = Pid::<f64>::new(&gains, 1e-3, 12.0).unwrap().with_rest_band(1e-3);
    let mut state = PidState::default();
    let rest = Setpoint { x: 0.0, v: 0.0, a: 0.0 };
    pid.drive(&mut state, rest, 1.0);
    pid.cut(&mut state, 0.0);
    assert_eq!(state.integral, 0.0);
    // 3 V that were cut off are 3/(b·Kv·Λ1) X·s, a tick's share of 1/√Λ1.
    let mut back = state;
    pid.cut(&mut back, 3.0);
    let wanted = 3.0 / (gains.b * gains.kv * libm::sqrt(gains.lambda1));
    assert!((back.integral / wanted - 1.0).abs() < 1e-12, "{}", back.integral);
    pid.drive(&mut state, rest, 0.9e-3);
    pid.update(&mut state);
    assert_eq!(state.integral, 0.0);
    pid.drive(&mut state, Setpoint { v: 0.1, ..rest }, 0.9e-3);
    pid.update(&mut state);
    assert_eq!(state.integral, -0.9e-3);
}

/// A drive's limit is positive; one tick of delay allows Kv + Λ2 = 400 1/s at 1 ms, two 267 1/s.
#[test]
fn a_limit_that_is_none_and_a_rate_past_the_delay_are_refused() {
    let gains = Gains { b: 2.0, kv: 300.0, lambda1: 50.0, lambda2: 100.0, filter_s: 0.0, observer_rad_s: 0.0 };
    for limit in [0.0, -1.0, f64::NAN] {
        assert_eq!(Pid::<f64>::new(&gains, 1e-3, limit).err(), Some(TuningError::Limit));
    }
    assert_eq!(Pid::<f64>::new(&gains, 1e-3, 3.0).unwrap().limit(), 3.0);
    let Err(TuningError::Rate { largest_per_s }) = Pid::<f64>::with_delay(&gains, 1e-3, 2, 3.0) else { panic!() };
    assert!((largest_per_s - 800.0 / 3.0).abs() < 1e-9, "{largest_per_s}");
}

/// After a step of e the filtered difference decays by τ/(τ + Ts) per tick; it alone makes the drive's third term.
#[test]
fn the_difference_is_filtered_by_its_time_constant() {
    let gains = Gains { b: 2.0, kv: 30.0, lambda1: 0.0, lambda2: 10.0, filter_s: 3e-3, observer_rad_s: 0.0 };
    let pid = Pid::<f64>::new(&gains, 1e-3, 1e9).unwrap();
    let mut state = PidState::default();
    let at = |x: f64| Setpoint { x, v: 0.0, a: 0.0 };
    assert_eq!(pid.drive(&mut state, at(0.0), 0.0), 0.0);
    for n in 0..20 {
        let rate = 0.25 * libm::pow(0.75, f64::from(n)) / 1e-3;
        let u = pid.drive(&mut state, at(0.5), 0.0);
        assert!((u - 60.0 * (10.0 * 0.5 + 0.5 * rate)).abs() < 1e-9, "{n}: {u}");
    }
}

/// The band counts where the reference neither moves nor is about to, its edge included; beyond it the integral goes on.
#[test]
fn the_rest_band_is_of_a_reference_at_rest() {
    let gains = Gains { b: 2.0, kv: 30.0, lambda1: 50.0, lambda2: 10.0, filter_s: 0.0, observer_rad_s: 0.0 };
    let pid = Pid::<f64>::new(&gains, 1e-3, 12.0).unwrap();
    let integral = |pid: &Pid<f64>, v: f64, a: f64, e: f64| {
        let mut state = PidState::default();
        pid.drive(&mut state, Setpoint { x: e, v, a }, 0.0);
        pid.update(&mut state);
        state.integral
    };
    let banded = pid.with_rest_band(0.25);
    for e in [0.25, -0.25] {
        assert_eq!(integral(&banded, 0.0, 0.0, e), 0.0);
        assert_eq!(integral(&banded, 0.0, 1.0, e), e);
        assert_eq!(integral(&banded, 1.0, 0.0, e), e);
        assert_eq!(integral(&banded, 0.0, 0.0, 2.0 * e), 2.0 * e);
        // No band, and one that is none, is the point itself.
        assert_eq!(integral(&pid, 0.0, 0.0, e), e);
        assert_eq!(integral(&pid.with_rest_band(-1.0), 0.0, 0.0, e), e);
    }
    assert_eq!(integral(&pid.with_rest_band(-1.0), 0.0, 0.0, 0.0), 0.0);
}
