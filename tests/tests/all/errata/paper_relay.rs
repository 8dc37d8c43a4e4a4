//! Paper sections 2 to 4, errata 17 to 22: transfer function, describing functions, eq. 17.

use std::f64::consts::{PI, TAU};

use breakaway::recording::Units;
use breakaway::simulate::axis::Axis;
use breakaway::simulate::exact::Exact;
use breakaway::simulate::experiment::{Excitation, Experiment, Reference, Sensor};
use breakaway_core::estimate::describing_function::{CycleFit, DescribingError, describing_function};
use breakaway_tests::papers::{RelayExperiment, equation_17};
use nalgebra::{Matrix4, RowVector4};
use proptest::prelude::*;

use super::{PLANT, cycle, exact_experiment, experiment, predicted_experiment};

const fn fit(e: RelayExperiment<f64>) -> CycleFit<f64> {
    CycleFit { h1: e.h1, h2: e.h2, a: e.a, omega: e.omega, a_error: 0.0, omega_error: 0.0 }
}

/// Erratum 17: Kp = 1/a, Tp = b/a with a = −Ke (eq. 5) are both negative; right are Kp = 1/c, Tp = b/c. A drive of 1
/// moves the documents' plant forwards at (1 − f1)/c = 4.545 per second (after 40 time constants: to rounding), and 63.2 %
/// of it are reached after b/c.
#[test]
fn erratum_17_gain_and_time_constant_are_positive() {
    let mut axis = Exact::at_rest(PLANT, 0.0, 0.0);
    axis.advance(1.0, PLANT.b / PLANT.c);
    let early = axis.v;
    axis.advance(1.0, 40.0 * PLANT.b / PLANT.c);
    let gain = axis.v / (1.0 - PLANT.f1);
    assert!((gain - 1.0 / PLANT.c).abs() < 1e-12, "{gain}");
    assert!((early / axis.v - (1.0 - (-1.0_f64).exp())).abs() < 1e-12, "{early}");
    // As printed, with a = −c:
    assert!(1.0 / -PLANT.c < 0.0 && gain > 0.0);
}

/// Erratum 18: N_SR = j(4f1/(πa) + f2) lacks the ω of f2. The fundamental of the friction force f1·sgn v + f2·v along
/// x = a·sin ωt, by quadrature, over a: j(4f1/(πa) + f2·ω). Midpoint rule with 20 000 points: 1e-8 at the jumps.
#[test]
fn erratum_18_the_describing_function_needs_omega() {
    let (f1, f2) = (0.5, 0.11);
    let at = exact_experiment(2.0, 1.5);
    let points = 20_000;
    let cosine: f64 = (0..points)
        .map(|i| {
            let (_, cos) = (TAU * (f64::from(i) + 0.5) / f64::from(points)).sin_cos();
            let v = at.a * at.omega * cos;
            (f1 * v.signum() + f2 * v) * cos * 2.0 / f64::from(points)
        })
        .sum();
    let found = cosine / at.a;
    let with_omega = 4.0 * f1 / (PI * at.a) + f2 * at.omega;
    let printed = 4.0 * f1 / (PI * at.a) + f2;
    println!("quadrature {found:.6}, with ω {with_omega:.6}, printed {printed:.6}");
    assert!((found / with_omega - 1.0).abs() < 1e-7, "{found} {with_omega}");
    assert!(printed < 0.5 * found, "{printed} {found}");
}

proptest! {
    /// Erratum 19: eq. 16's Tp = h11/(h21·ω1) put into eq. 17 makes f2 = −4f1/(πa1) for all data: the second equation
    /// of experiment 1 is used twice. Relative to the terms that cancel, 1e-9.
    #[test]
    fn erratum_19_f2_is_forced(
        h11 in 0.5..5.0, h21 in 0.5..5.0, a1 in 0.1..10.0_f64, omega1 in 1.0..50.0,
        h12 in 0.5..5.0, h22 in 0.5..5.0, a2 in 0.1..10.0_f64, omega2 in 1.0..50.0,
    ) {
        prop_assume!((a2 - a1).abs() > 0.01);
        let found = equation_17(experiment(h11, h21, a1, omega1), experiment(h12, h22, a2, omega2));
        let forced = -4.0 * found.f1 / (PI * a1);
        let scale = 4.0 / (PI * a1) * (h21 + found.f1.abs());
        prop_assert!((found.f2 - forced).abs() < 1e-9 * scale, "{} {}", found.f2, forced);
    }
}

/// Singular values, over the largest, of the derivative of the four equations of two experiments by (b, Ke, f1, f2),
/// each column scaled by its parameter.
fn singular_values(with_omega: bool) -> [f64; 4] {
    let (b, ke, f1, f2) = (PLANT.b, 0.1, PLANT.f1, 0.01);
    let mut rows = Vec::new();
    for e in [exact_experiment(2.0, 1.5), exact_experiment(1.0, 0.7)] {
        let viscous = if with_omega { e.a * e.omega } else { e.a };
        // Real: b·a·ω² = 4h1/π. Imaginary: Ke·a·ω + 4f1/π + f2·a(·ω) = 4h2/π.
        rows.push(RowVector4::new(b * e.a * e.omega.powi(2), 0.0, 0.0, 0.0));
        rows.push(RowVector4::new(0.0, ke * e.a * e.omega, 4.0 * f1 / PI, f2 * viscous));
    }
    let mut values: Vec<f64> = Matrix4::from_rows(&rows).singular_values().iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    [1.0, values[1] / values[0], values[2] / values[0], values[3] / values[0]]
}

/// Erratum 20: two experiments give four equations, and the paper solves them for four unknowns. Two of them determine
/// the inertia, twice; the other two hold Ke, f1 and f2. The rank is 3, with ω in f2's term and (as printed) without: the fourth
/// singular value is rounding, the third is not.
#[test]
fn erratum_20_four_equations_of_rank_three() {
    for with_omega in [true, false] {
        let values = singular_values(with_omega);
        println!("with ω {with_omega}: {values:?}");
        assert!(values[3] < 1e-15, "{values:?}");
        assert!(values[2] > 0.02, "{values:?}");
    }
}

/// Erratum 21: "by varying h1 and/or h2", and a denominator a2 − a1. With the same h2 the speed amplitude a·ω is the
/// same whatever h1 is, and (c, f1) cannot be separated, though a differs: eq. 17 gives numbers, `describing_function` refuses.
/// With the same a and different h2 they can: eq. 17 divides by zero, `describing_function` is exact (1e-10: two
/// amplitudes equal to rounding do not matter to it).
#[test]
fn erratum_21_h2_must_vary_and_speed_decides() {
    let (one, two) = (predicted_experiment(2.0, 1.5), predicted_experiment(1.0, 1.5));
    assert!((two.a / one.a - 2.0).abs() < 1e-12 && (one.a * one.omega - two.a * two.omega).abs() < 1e-12);
    assert_eq!(describing_function(&[fit(one), fit(two)]), Err(DescribingError::SameH2));
    let wrong = equation_17(one, two);
    println!("same h2: {wrong:?}");
    // Whatever the plant's f1 is: here 0.5.
    assert!(wrong.f1.abs() < 1e-12 && wrong.f2.abs() < 1e-12, "{wrong:?}");
    // The same on exact limit cycles: halving h1 changes the speed amplitude by 0.5 %, halving h2 by 70 %.
    let speed = |h1, h2| exact_experiment(h1, h2).a * exact_experiment(h1, h2).omega;
    println!("a·ω: (2,1.5) {}, (1,1.5) {}, (2,.8) {}", speed(2.0, 1.5), speed(1.0, 1.5), speed(2.0, 0.8));
    assert!((speed(1.0, 1.5) / speed(2.0, 1.5) - 1.0).abs() < 0.006);
    assert!((speed(2.0, 0.8) / speed(2.0, 1.5) - 0.30).abs() < 0.005);

    // a = 4b(h2−f1)²/(πc²h1): h1 in proportion to (h2 − f1)² keeps it.
    let (one, two) = (predicted_experiment(2.0, 1.5), predicted_experiment(2.0 * 0.36, 1.1));
    assert!((one.a / two.a - 1.0).abs() < 1e-12);
    let right = describing_function(&[fit(one), fit(two)]).unwrap();
    for (found, truth) in right.parameters.into_iter().zip([PLANT.b, PLANT.c, PLANT.f1]) {
        assert!((found / truth - 1.0).abs() < 1e-10, "{right:?}");
    }
    let divided = equation_17(one, two).f1;
    assert!(!divided.is_finite() || divided.abs() > 1e9, "{divided}");
}

/// Erratum 22: section 4 prints Kp 10, Tp .265, f1 .5104, f2 .0065 as identified. Eq. 17 on the exact limit cycles gives
/// 5.811, .1535, .4353, −.434 (1e-3), and by erratum 19 f1 and f2 of eq. 17 have opposite signs always.
#[test]
fn erratum_22_section_4_does_not_follow_from_equation_17() {
    let found = equation_17(exact_experiment(2.0, 1.5), exact_experiment(1.0, 0.7));
    println!("{found:?}");
    for (value, here, printed) in
        [(found.kp, 5.811, 10.0), (found.tp, 0.1535, 0.265), (found.f1, 0.4353, 0.5104), (found.f2, -0.434, 0.0065)]
    {
        assert!((value - here).abs() < 1e-3, "{found:?}");
        assert!((value / printed - 1.0).abs() > 0.14, "{found:?}");
    }
    assert!(found.f1 * found.f2 < 0.0 && 0.5104 * 0.0065 > 0.0);
    // What the corrected closed form makes of the same cycles (docs/theory.md, section 4: up to 20 % harmonic error).
    let right = describing_function(&[fit(exact_experiment(2.0, 1.5)), fit(exact_experiment(1.0, 0.7))]).unwrap();
    println!("corrected: {:?}", right.parameters);
    for (found, truth) in right.parameters.into_iter().zip([PLANT.b, PLANT.c, PLANT.f1]) {
        assert!((found / truth - 1.0).abs() < 0.06, "{right:?}");
    }
}

/// docs/theory.md section 2: the describing function predicts ω 4 to 6 % too low, and a 9 to 11 % too high, against
/// exact limit cycles. These are bounds and no tolerances: the neglected harmonics make the error.
#[test]
fn theory_prediction_against_exact_cycles() {
    for (h1, h2) in [(2.0, 1.5), (1.0, 0.7), (2.5, 2.0), (5.0, 4.0), (4.0, 3.5)] {
        let (predicted, exact) = (predicted_experiment(h1, h2), exact_experiment(h1, h2));
        let (omega, a) = (predicted.omega / exact.omega - 1.0, predicted.a / exact.a - 1.0);
        println!("({h1}, {h2}): ω {:+.1} %, a {:+.1} %", 100.0 * omega, 100.0 * a);
        assert!((-0.06..-0.04).contains(&omega) && (0.09..0.11).contains(&a), "{omega} {a}");
    }
}

/// docs/theory.md section 2: a deviation shrinks per cycle by about ρ = e^(−2(h2−f1)/h1). Against the event-exact
/// plant under a relay sampled at 20 µs, the median ratio of successive deviations of the peak between 10 % and 1 %
/// is .43, .70, .32. The formula is too optimistic by 16, 5 and 44 %. The bound of the test is that it errs to that
/// side, by less than half.
#[test]
fn theory_settling() {
    for (h1, h2) in [(2.0, 1.5), (1.0, 0.7), (4.0, 3.5)] {
        let experiment = Experiment {
            name: "settling".into(),
            tick_s: 2e-5,
            duration_s: 20.0,
            seed: 1,
            drive_limit: f64::INFINITY,
            travel_limit: f64::INFINITY,
            excitation: Excitation::Relay { h1, h2, hysteresis: Some(0.0), reference: Reference::Start },
            sensor: Sensor { encoder_step: 1e-8, noise: 0.0, delay_ticks: 0 },
        };
        let x = Axis::new(PLANT, &[], Units::default()).run(&experiment).unwrap().true_x;
        let (mut peaks, mut peak) = (Vec::new(), 0.0_f64);
        for w in x.windows(2) {
            peak = peak.max(w[1]);
            if w[0] < 0.0 && w[1] >= 0.0 {
                peaks.push(std::mem::take(&mut peak));
            }
        }
        let settled = peaks[peaks.len() - 1];
        assert!((settled / cycle(h1, h2).peak - 1.0).abs() < 0.01, "{settled}");
        let mut ratios: Vec<f64> = peaks
            .windows(2)
            .filter(|w| (0.01..0.1).contains(&(w[0] / settled - 1.0).abs()))
            .map(|w| (w[1] - settled) / (w[0] - settled))
            .collect();
        ratios.sort_by(f64::total_cmp);
        let median = ratios[ratios.len() / 2];
        let formula = (-2.0 * (h2 - PLANT.f1) / h1).exp();
        println!("({h1}, {h2}): ρ {median:.3}, formula {formula:.3}");
        assert!((1.0..1.5).contains(&(median / formula)), "{median} {formula}");
    }
}
