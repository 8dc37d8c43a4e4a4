//! Derivatives against central differences, of the elementary functions and of a simulated motion.

use breakaway_core::plant::{Base, Drive, Effect, Kind, Plant, State};

use super::*;

const STEP: f64 = 1e-6;

/// Every operation at a generic point. Central differences of step h are good to h² = 1e-12 of the third derivative,
/// and to rounding, 1e-16/h = 1e-10. A gradient is in single precision, good to a few of its steps of 6e-8.
#[test]
fn elementary_functions() {
    type Function<R> = fn(R, R) -> R;
    fn list<R: Real>() -> Vec<(&'static str, Function<R>)> {
        vec![
            ("add", |a, b| a + b),
            ("sub", |a, b| a - b),
            ("mul", |a, b| a * b),
            ("div", |a, b| a / b),
            ("neg", |a, _| -a),
            ("abs", |a, b| a.abs() + b.abs()),
            ("sqrt", |a, b| (a * a + b * b).sqrt()),
            ("sin", |a, b| (a * b).sin()),
            ("cos", |a, b| (a * b).cos()),
            ("exp", |a, b| (a * b).exp()),
            ("ln", |a, b| (a * a + b).ln()),
            ("atan2", |a, b| a.atan2(b)),
            ("sgn", |a, b| a.sgn() * b),
            ("max", |a, b| a.max(b)),
        ]
    }
    for (a, b) in [(-1.3, 0.7), (0.4, 2.1)] {
        for ((name, dual), (_, plain)) in list::<Dual<2>>().into_iter().zip(list::<f64>()) {
            let found = dual(Dual::parameter(a, 0), Dual::parameter(b, 1));
            assert!((found.value - plain(a, b)).abs() < 1e-14, "{name}");
            let expected = [
                (plain(a + STEP, b) - plain(a - STEP, b)) / (2.0 * STEP),
                (plain(a, b + STEP) - plain(a, b - STEP)) / (2.0 * STEP),
            ];
            for (g, e) in found.gradient.iter().zip(expected) {
                assert!((f64::from(*g) - e).abs() < 4e-7 * (1.0 + e.abs()), "{name} at {a}, {b}: {g} against {e}");
            }
        }
    }
}

#[test]
fn no_derivative_is_infinite_where_a_function_ends() {
    let zero = Dual::<1>::parameter(0.0, 0);
    for value in [zero.sqrt(), zero.ln(), zero.atan2(Dual::constant(0.0))] {
        assert!(value.value.is_finite() && value.gradient[0].is_finite(), "{value:?}");
    }
    assert_eq!(Dual::<2>::parameter(3.0, 2).gradient, [0.0; 2]);
}

/// Forward, reversal, rest under a drive below f1, and backward.
fn drive(k: usize) -> f64 {
    [2.0, -1.5, 0.2, -2.5, 1.0, 0.0][k / 60 % 6]
}

/// Positions of 360 samples of 1 ms. The parameters are b, c, f1, x0, v0, and the Stribeck friction's s and vs.
fn motion<R: Real>(p: [R; 7]) -> Vec<R> {
    let effects = [Effect { kind: Kind::Stribeck, p: Effect::new(Kind::Stribeck, &[0.2, 0.5]).p.map(R::from_f64) }];
    let mut effects = effects;
    effects[0].p[0] = p[5];
    effects[0].p[1] = p[6];
    let plant = Plant { base: Base { b: p[0], c: p[1], f1: p[2] }, effects: &effects };
    let mut state = State { v: p[4], ..plant.at_rest(p[3]) };
    let u: Vec<f64> = (0..360).map(drive).collect();
    (0..360)
        .map(|k| {
            let x = state.x;
            plant.advance(&mut state, Drive { u: &u[..=k], ts: 1e-3, t: k as f64 * 1e-3 }, 2);
            x
        })
        .collect()
}

/// The derivatives of a motion with respect to parameter `i` are the central differences of step `h`, to `tolerance` of the
/// largest. `moved` simulates with that parameter changed.
fn agree<const N: usize>(dual: &[Dual<N>], i: usize, h: f64, moved: &dyn Fn(f64) -> Vec<f64>, tolerance: f64) {
    let (above, below) = (moved(h), moved(-h));
    let largest = dual.iter().map(|d| f64::from(d.gradient[i]).abs()).fold(0.0, f64::max);
    assert!(largest > 0.0);
    for (k, d) in dual.iter().enumerate() {
        let difference = (above[k] - below[k]) / (2.0 * h);
        let found = f64::from(d.gradient[i]);
        assert!((found - difference).abs() < tolerance * largest, "{i} at {k}: {found} {difference}");
    }
}

/// One simulation with dual numbers gives the same as fourteen by differences, through reversals and a rest. They
/// differ by the rounding of single precision. That is 6e-8 in each of some hundred dependent operations: 1e-5 of the
/// largest derivative.
#[test]
fn sensitivities_of_a_motion_with_reversals_and_stick() {
    let p = [0.02685, 0.11, 0.5, 0.3, -0.4, 0.2, 0.5];
    let dual = motion::<Dual<7>>(std::array::from_fn(|i| Dual::parameter(p[i], i)));
    let rests = dual.windows(2).filter(|w| w[0].value == w[1].value).count();
    let turns = dual.windows(3).filter(|w| (w[1].value - w[0].value) * (w[2].value - w[1].value) < 0.0).count();
    assert!(rests > 10 && turns >= 2, "{rests} samples at rest, {turns} reversals without rest");
    for i in 0..7 {
        let h = 1e-6 * p[i].abs();
        let moved = |by: f64| {
            let mut q = p;
            q[i] += by;
            motion::<f64>(q)
        };
        agree(&dual, i, h, &moved, 1e-5);
    }
}

/// Positions of the base plant after a delay of `tau` and a lag of `lag`, s, under a drive under which it never rests.
fn delayed<R: Real>([tau, lag]: [R; 2]) -> Vec<R> {
    let zero = R::from_f64(0.0);
    let mut effects = [Kind::Delay, Kind::ElectricalLag].map(|kind| Effect::new(kind, &[zero]));
    (effects[0].p[0], effects[1].p[0]) = (tau, lag);
    let [b, c, f1] = [0.02685, 0.11, 0.5].map(R::from_f64);
    let plant = Plant { base: Base { b, c, f1 }, effects: &effects };
    let mut state = State { v: R::from_f64(-0.4), ..plant.at_rest(zero) };
    let u: Vec<f64> = (0..360).map(|k| [2.0, -1.5, 1.2, -2.5, 1.0, -2.0][k / 60]).collect();
    let sample = |k: usize| {
        let x = state.x;
        plant.advance(&mut state, Drive { u: &u[..=k], ts: 1e-3, t: k as f64 * 1e-3 }, 1);
        x
    };
    (0..360).map(sample).collect()
}

/// A sub-step ends where the delayed drive switches, and the derivative with respect to the delay moves that instant. It
/// is spread over the two sub-steps beside it. So a position is off by a quarter of their difference, .25 ms at most, of
/// the 60 ms over which the largest derivative grows: .4 %. The lag adds no error of its own.
#[test]
fn sensitivities_of_a_delay_and_a_lag() {
    for p in [[2.3e-3, 0.7e-3], [0.4e-3, 3.0e-3], [2.9e-3, 1.0e-3]] {
        let dual = delayed::<Dual<2>>(std::array::from_fn(|i| Dual::parameter(p[i], i)));
        for i in 0..2 {
            let h = 1e-4 * p[i];
            let moved = |by: f64| delayed::<f64>(std::array::from_fn(|j| if j == i { p[j] + by } else { p[j] }));
            agree(&dual, i, h, &moved, 0.01);
        }
    }
}
