use super::*;
use crate::control::margins;
use proptest::prelude::*;
extern crate std;

/// The gains put the crossover where it was asked for, with the phase of the continuous loop less that of the delays.
#[test]
fn crossover_and_phase_are_those_of_the_design() {
    for (b, c) in [(0.02685, 0.11), (0.02685, 0.0), (1e-3, 0.5)] {
        for d in [0, 1, 2] {
            let gains = tune(b, c, 5.0, 1e-3, d).unwrap();
            let found = margins(&gains, b, c, 1e-3, d).unwrap();
            let w = core::f64::consts::TAU * 5.0;
            std::println!("{b} {c} {d}: {found:?}");
            // The filter is on ė alone, which turns it against the rest: |L| at ωc changes by 5 %.
            assert!((found.crossover_rad_s / w - 1.0).abs() < 0.07, "{found:?}");
            // Continuous: 2·atan 4 − 90° with c = 0, more with it. The filter takes 7°. Half a tick of hold, half of
            // difference and the delay take ωc·(1 + d)·Ts.
            let lost = 7.2 + (w * (1.0 + f64::from(d)) * 1e-3).to_degrees();
            assert!(found.phase_deg > 61.9 - lost - 1.0 && found.gain > 2.0, "{found:?} {lost}");
            assert!((found.delay_s - found.phase_deg.to_radians() / found.crossover_rad_s).abs() < 1e-9);
        }
    }
}

/// Refusals name the largest allowed value, and that value is allowed.
#[test]
fn refusals_carry_what_would_do() {
    for d in [0, 1, 2, 5] {
        let Err(TuningError::Bandwidth { largest_hz }) = tune(0.02685, 0.11, 400.0, 1e-3, d) else { panic!("{d}") };
        std::println!("delay {d}: largest bandwidth {largest_hz:.1} Hz");
        assert!(tune(0.02685, 0.11, largest_hz, 1e-3, d).is_ok());
        assert!(tune(0.02685, 0.11, 1.01 * largest_hz, 1e-3, d).is_err());
    }
    // The limit of docs/control.md, section "The PID", at one tick of delay: 400 1/s at 1 ms.
    assert_eq!(largest_rate(1e-3, 1), 400.0);
    let gains = Gains { b: 1.0, kv: 300.0, lambda1: 100.0, lambda2: 101.0, filter_s: 0.0, observer_rad_s: 0.0 };
    let Err(TuningError::Rate { largest_per_s }) = gains.check(1e-3, 1) else { panic!() };
    assert_eq!(largest_per_s, 400.0);
    assert!(Gains { lambda2: 100.0, ..gains }.check(1e-3, 1).is_ok());
}

#[test]
fn wrong_parameters_are_named() {
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert_eq!(tune(bad, 0.1, 5.0, 1e-3, 1), Err(TuningError::B));
        assert_eq!(tune(0.1, bad, 5.0, 1e-3, 1), Err(TuningError::C));
        assert_eq!(tune(0.1, 0.1, 5.0, bad, 1), Err(TuningError::Tick));
        assert!(matches!(tune(0.1, 0.1, bad, 1e-3, 1), Err(TuningError::Bandwidth { .. })));
    }
}

/// One zero at ωc/4, the other on the plant's pole within ωc/4..4ωc, |L(jωc)| = 1, the filter an eighth of 1/ωc.
/// Cases are no damping, the pole at ωc, and a hundred times that.
#[test]
fn gains_are_those_of_the_design() {
    let w = core::f64::consts::TAU;
    let seventeen = libm::sqrt(17.0);
    for (pole, kv, lambda1, lambda2) in [
        (0.0, 16.0 / 17.0, 1.0 / 16.0, 0.5),
        (1.0, 4.0 / seventeen, 0.25, 1.25),
        (100.0, 4.0 * libm::sqrt(10_001.0) / 17.0, 1.0, 4.25),
    ] {
        let gains = tune(2.0, 2.0 * pole * w, 1.0, 1e-3, 1).unwrap();
        assert_eq!(gains.b, 2.0);
        let found = [gains.kv / w, gains.lambda1 / (w * w), gains.lambda2 / w, gains.filter_s * w];
        for (found, wanted) in found.into_iter().zip([kv, lambda1, lambda2, 0.125]) {
            assert!((found / wanted - 1.0).abs() < 1e-12, "{pole}: {found} {wanted}");
        }
    }
}

/// At the largest bandwidth one of the three limits is reached and none is passed.
#[test]
fn the_largest_bandwidth_is_where_a_limit_is_reached() {
    for (b, c, d) in [(1.0, 0.0, 0), (1.0, 0.0, 1), (1.0, 0.0, 3), (1.0, 200.0, 0), (1.0, 200.0, 1)] {
        let hz = largest_bandwidth_hz(b, c, 1e-3, d);
        let gains = tune(b, c, hz, 1e-3, d).unwrap();
        let found = margins(&gains, b, c, 1e-3, d).unwrap();
        let rate = (gains.kv + gains.lambda2) / largest_rate(1e-3, d);
        let in_hand = [1.0 - rate, found.phase_deg / 30.0 - 1.0, found.gain / 2.0 - 1.0];
        std::println!("{b} {c} {d}: {hz} Hz, {in_hand:?}");
        assert!(in_hand.iter().all(|part| *part > -2e-6), "{in_hand:?}");
        assert!(in_hand.iter().any(|part| *part < 1e-4), "{in_hand:?}");
    }
    // A pole at 20 times the tick's rate: Kv is past the limit at any bandwidth.
    assert_eq!(largest_bandwidth_hz(1.0, 2e4, 1e-3, 0), 0.0);
    assert_eq!(tune(1.0, 2e4, 1e-3, 1e-3, 0), Err(TuningError::Bandwidth { largest_hz: 0.0 }));
}

/// (Kv + Λ2)·Ts ≤ 0.8/(1 + d): inversely as the tick, and as the ticks from reading to drive.
#[test]
fn the_largest_rate_is_that_of_tick_and_delay() {
    for (tick_s, d, wanted) in [(1e-3, 0, 800.0), (1e-3, 1, 400.0), (1e-3, 3, 200.0), (2e-3, 1, 200.0)] {
        assert!((largest_rate(tick_s, d) - wanted).abs() < 1e-9);
        let gains = Gains {
            b: 1.0,
            kv: 0.75 * wanted,
            lambda1: 0.0,
            lambda2: 0.25 * wanted,
            filter_s: 0.0,
            observer_rad_s: 0.0,
        };
        assert_eq!(gains.check(tick_s, d), Ok(()));
        let Err(TuningError::Rate { largest_per_s }) = Gains { kv: 0.76 * wanted, ..gains }.check(tick_s, d) else {
            panic!()
        };
        assert!((largest_per_s - wanted).abs() < 1e-9);
    }
}

/// Every gain by itself. What is not finite or negative, and a Kv or a Λ2 of 0, are refused. A Λ1 or a filter of 0 is
/// not.
#[test]
fn every_gain_is_checked() {
    let good = Gains { b: 1.0, kv: 10.0, lambda1: 0.0, lambda2: 10.0, filter_s: 0.0, observer_rad_s: 0.0 };
    assert_eq!(good.check(1e-3, 1), Ok(()));
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        for gains in [
            Gains { kv: bad, ..good },
            Gains { lambda1: bad, ..good },
            Gains { lambda2: bad, ..good },
            Gains { filter_s: bad, ..good },
            Gains { observer_rad_s: bad, ..good },
        ] {
            assert_eq!(gains.check(1e-3, 1), Err(TuningError::Gain), "{gains:?}");
        }
        assert_eq!(Gains { b: bad, ..good }.check(1e-3, 1), Err(TuningError::B));
        assert_eq!(good.check(bad, 1), Err(TuningError::Tick));
    }
    assert_eq!(Gains { kv: 0.0, ..good }.check(1e-3, 1), Err(TuningError::Gain));
    assert_eq!(Gains { lambda2: 0.0, ..good }.check(1e-3, 1), Err(TuningError::Gain));
    assert_eq!(Gains { b: 0.0, ..good }.check(1e-3, 1), Err(TuningError::B));
    assert_eq!(good.check(0.0, 1), Err(TuningError::Tick));
}

/// Zero is no inertia, no tick and no bandwidth, but a damping; what is none has no largest bandwidth.
#[test]
fn zero_is_no_inertia_no_tick_and_no_bandwidth() {
    assert_eq!(tune(0.0, 0.1, 5.0, 1e-3, 1), Err(TuningError::B));
    assert_eq!(tune(0.1, 0.1, 5.0, 0.0, 1), Err(TuningError::Tick));
    assert!(matches!(tune(0.1, 0.1, 0.0, 1e-3, 1), Err(TuningError::Bandwidth { .. })));
    assert!(tune(0.1, 0.0, 5.0, 1e-3, 1).is_ok());
    assert!(largest_bandwidth_hz(0.1, 0.0, 1e-3, 1) > 5.0);
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        for found in [
            largest_bandwidth_hz(bad, 0.1, 1e-3, 1),
            largest_bandwidth_hz(0.1, bad, 1e-3, 1),
            largest_bandwidth_hz(0.1, 0.1, bad, 1),
        ] {
            assert_eq!(found, 0.0);
        }
    }
    assert_eq!(largest_bandwidth_hz(0.0, 0.1, 1e-3, 1), 0.0);
    assert_eq!(largest_bandwidth_hz(0.1, 0.1, 0.0, 1), 0.0);
}

proptest! {
    /// Every accepted design has a margin of 30° and of a factor of two. The check is independent: the sampled loop,
    /// simulated with twice the gain, decays from a unit error.
    #[test]
    fn accepted_gains_are_stable_with_twice_the_gain(b in 1e-4..10.0_f64, ratio in 0.0..200.0_f64, hz in 0.1..80.0_f64, d in 0..4_u32) {
        let c = b * ratio;
        let Ok(gains) = tune(b, c, hz, 1e-3, d) else { return Ok(()) };
        let found = margins(&gains, b, c, 1e-3, d).unwrap();
        prop_assert!(found.gain_reduction < 0.6, "{:?}", found);
        for factor in [1.0, 1.98] {
            let (mut x, mut v, mut integral, mut last, mut rate) = (1.0, 0.0, 0.0, -1.0, 0.0);
            let mut queue = [0.0; 4];
            let (k, ts) = (b * gains.kv * factor, 1e-3);
            let alpha = ts / (gains.filter_s + ts);
            let decay = libm::exp(-ratio * ts);
            let (phi1, phi2) = if ratio > 0.0 {
                let phi1 = (1.0 - decay) / (ratio * ts);
                (phi1, (1.0 - phi1) / (ratio * ts))
            } else {
                (1.0, 0.5)
            };
            let ticks = (400.0 / (hz * ts)) as usize;
            let mut tail = 0.0_f64;
            for i in 0..ticks {
                let e: f64 = -x;
                rate += alpha * ((e - last) - rate);
                last = e;
                integral += e;
                let u = k * (gains.lambda2 * e + gains.lambda1 * ts * integral + rate / ts);
                queue.rotate_right(1);
                queue[0] = u;
                let u = queue[d as usize];
                x += ts * phi1 * v + ts * ts * phi2 * u / b;
                v = decay * v + ts * phi1 * u / b;
                if i > ticks * 9 / 10 {
                    tail = tail.max(x.abs());
                }
            }
            prop_assert!(tail < 0.05, "{} {} {:?} {:?}", factor, tail, gains, found);
        }
    }
}
