use super::*;
use crate::scalar::Q32;
use proptest::prelude::*;
extern crate std;
use std::vec::Vec;

const TICK: f64 = 1e-4;

fn gains(observer_rad_s: f64, filter_s: f64) -> Gains {
    Gains { b: 2.0, kv: 30.0, lambda1: 0.0, lambda2: 10.0, filter_s, observer_rad_s }
}

fn rates<R: Real>(gains: &Gains, errors: &[f64]) -> Vec<f64> {
    let differentiator = Differentiator::<R>::new(gains, TICK);
    let mut state = RateState::default();
    errors.iter().map(|e| differentiator.tick(&mut state, R::from_f64(*e)).to_f64()).collect()
}

/// Two filters of 1/ωo one behind the other, written out anew.
#[test]
fn the_observer_is_two_filters() {
    let errors: Vec<f64> = (0..500).map(|k| libm::sin(0.02 * f64::from(k)) + f64::from(k % 3)).collect();
    let found = rates::<f64>(&gains(700.0, 0.0), &errors);
    let share = 700.0 * TICK / (1.0 + 700.0 * TICK);
    let (mut first, mut second) = (0.0, 0.0);
    for (k, found) in found.iter().enumerate() {
        let difference = if k == 0 { 0.0 } else { errors[k] - errors[k - 1] };
        first += share * (difference - first);
        second += share * (first - second);
        assert!((found - second).abs() < 1e-13, "{k}: {found} {second}");
    }
}

/// Without an observer it is the plain difference.
#[test]
fn no_observer_is_the_difference() {
    let errors: Vec<f64> = (0..100).map(|k| libm::sin(0.3 * f64::from(k))).collect();
    let found = rates::<f64>(&gains(0.0, 0.0), &errors);
    assert_eq!(found[0], 0.0);
    for (pair, found) in errors.windows(2).zip(&found[1..]) {
        assert!((pair[1] - pair[0] - found).abs() < 1e-15);
    }
}

/// A ramp is followed to its slope, without error.
#[test]
fn a_ramp_has_its_slope() {
    let errors: Vec<f64> = (0..2000).map(|k| 3e-4 * f64::from(k)).collect();
    let last = rates::<f64>(&gains(500.0, 2e-3), &errors).pop().unwrap();
    // 0.2 s are 100 time constants of the observer.
    assert!((last / 3e-4 - 1.0).abs() < 1e-9, "{last}");
}

/// One count: ωo/e per second in the observer (with 1/ωo of many ticks), 1/(τ + Ts) in the filter; in both less than in each.
#[test]
fn the_rate_of_a_count() {
    let observer = gains(100.0, 0.0).rate_of_step(TICK);
    // (1 + ωo·Ts) and its like are 1 % off the continuous one.
    assert!((observer * core::f64::consts::E / 100.0 - 1.0).abs() < 0.01, "{observer}");
    let filter = gains(0.0, 2e-3).rate_of_step(TICK);
    assert!((filter * (2e-3 + TICK) - 1.0).abs() < 1e-12, "{filter}");
    assert!((gains(0.0, 0.0).rate_of_step(TICK) * TICK - 1.0).abs() < 1e-12);
    assert!(gains(100.0, 2e-3).rate_of_step(TICK) < observer.min(filter));
    let drive = gains(100.0, 0.0).drive_of_count(1e-3, TICK);
    assert!((drive - 60.0 * (10.0 + observer) * 1e-3).abs() < 1e-12, "{drive}");
}

proptest! {
    /// Whatever the signal, the rate is within the largest difference. f32 and Q32 agree with f64 to the rounding of e
    /// over the observer's gain, which is at most 1. That is 6e-8 of 1 rad, a few times over.
    #[test]
    fn it_is_bounded_and_scalars_agree(
        errors in prop::collection::vec(-1.0..1.0_f64, 2..200), observer in 10.0..1e5_f64, filter in 0.0..1e-2_f64,
    ) {
        let gains = gains(observer, filter);
        let largest = errors.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let exact = rates::<f64>(&gains, &errors);
        prop_assert!(exact.iter().all(|rate| rate.abs() <= largest * (1.0 + 1e-9)));
        for found in [rates::<f32>(&gains, &errors), rates::<Q32>(&gains, &errors)] {
            for (found, exact) in found.iter().zip(&exact) {
                prop_assert!((found - exact).abs() < 2e-6, "{} {}", found, exact);
            }
        }
    }

    #[test]
    fn nothing_panics(e in any::<f32>(), observer in any::<f32>(), filter in any::<f32>()) {
        let gains = Gains { b: 1.0_f32, kv: 1.0, lambda1: 0.0, lambda2: 1.0, filter_s: filter, observer_rad_s: observer };
        let differentiator = Differentiator::<f32>::new(&gains, 1e-4);
        let mut state = RateState::default();
        for _ in 0..3 {
            let _ = differentiator.tick(&mut state, e);
        }
    }
}
