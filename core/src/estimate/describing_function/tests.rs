use super::*;

const PLANT: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };

fn fit(h1: f64, h2: f64) -> CycleFit<f64> {
    let cycle = predict(&PLANT, h1, h2).unwrap();
    CycleFit { h1, h2, a: cycle.a, omega: cycle.omega, a_error: 0.0, omega_error: 0.0 }
}

/// Row 9: data made by the describing function come back to rounding.
#[test]
fn row_9_exact_on_describing_function_data() {
    let pair = [fit(2.0, 1.5), fit(1.0, 0.7)];
    let four = [fit(2.0, 1.5), fit(1.0, 0.7), fit(2.5, 2.0), fit(4.0, 3.5)];
    for experiments in [&pair[..], &four[..]] {
        let found = describing_function(experiments).unwrap().parameters;
        for (value, truth) in found.iter().zip([0.02685, 0.11, 0.5]) {
            assert!((value / truth - 1.0).abs() < 1e-12, "{found:?}");
        }
    }
}

/// The exact cycles of docs/theory.md, section 2, six digits: by hand, b = (0.026414 + 0.026382)/2,
/// c = 0.8/(8.71674 − 1.74196), f1 = 1.5 − 8.71674c. The neglected harmonics cost b 1.7 % and c 4.3 %.
#[test]
fn real_cycles_show_the_neglected_harmonics() {
    let real = |h1, h2, a, omega| CycleFit { a, omega, ..fit(h1, h2) };
    let pair = [real(2.0, 1.5, 1.27742, 8.68809), real(1.0, 0.7, 0.10192, 21.76145)];
    let [b, c, f1] = describing_function(&pair).unwrap().parameters;
    assert!((b / 0.02685 - 1.0 + 0.017).abs() < 1e-3, "{b}");
    assert!((c / 0.11 - 1.0 - 0.0427).abs() < 1e-3, "{c}");
    assert!((f1 / 0.5 - 1.0).abs() < 1e-3, "{f1}");
}

/// First-order propagation against finite differences of the estimate itself.
#[test]
fn covariance_is_the_propagated_one() {
    let mut pair = [fit(2.0, 1.5), fit(1.0, 0.7)];
    pair[0].a_error = 1e-3;
    pair[1].omega_error = 2e-3;
    let found = describing_function(&pair).unwrap();
    let step = 1e-6;
    let mut moved_a = pair;
    moved_a[0].a += step;
    let mut moved_omega = pair;
    moved_omega[1].omega += step;
    let slope = |moved: &[CycleFit<f64>; 2], k: usize| {
        (describing_function(moved).unwrap().parameters[k] - found.parameters[k]) / step
    };
    for i in 0..3 {
        for j in 0..3 {
            let expected =
                slope(&moved_a, i) * slope(&moved_a, j) * 1e-6 + slope(&moved_omega, i) * slope(&moved_omega, j) * 4e-6;
            // Second-order terms of the finite difference.
            let scale = (found.covariance[i][i] * found.covariance[j][j]).sqrt();
            assert!((found.covariance[i][j] - expected).abs() < 1e-4 * scale);
        }
    }
}

#[test]
fn refusals_name_the_reason() {
    use DescribingError::{BadExperiment, SameH2, SameSpeed, TooFewExperiments};
    assert_eq!(describing_function(&[fit(2.0, 1.5)]), Err(TooFewExperiments));
    assert_eq!(describing_function(&[fit(2.0, 1.5), fit(1.0, 1.5)]), Err(SameH2));
    let twin = CycleFit { h2: 1.4, ..fit(2.0, 1.5) };
    assert_eq!(describing_function(&[fit(2.0, 1.5), twin]), Err(SameSpeed));
    let bad = CycleFit { a: f64::NAN, ..fit(2.0, 1.5) };
    assert_eq!(describing_function(&[fit(1.0, 0.7), bad]), Err(BadExperiment { index: 1 }));
    assert!(SameH2.advice().contains("repeat with a different h2"));
}

#[test]
fn no_cycle_has_its_reason() {
    assert_eq!(predict(&PLANT, 1.0, 0.49), Err(NoCycle::H2NotAboveFriction));
    assert_eq!(predict(&PLANT, 1.0, 0.5), Err(NoCycle::H2NotAboveFriction));
    assert_eq!(predict(&PLANT, 0.2, 0.2), Err(NoCycle::BelowBreakaway));
    assert_eq!(predict(&PLANT, 0.0, 2.0), Err(NoCycle::H1));
    assert_eq!(predict(&Base { c: 0.0, ..PLANT }, 1.0, 2.0), Err(NoCycle::NoDamping));
}

/// h2 = c·z + f1 over the experiments, z = π·a·ω/4, by ordinary least squares.
fn line(experiments: &[CycleFit<f64>]) -> crate::estimate::linear::Solution<f64, 2> {
    let mut sums = crate::estimate::linear::NormalEquations::<f64, 2>::default();
    for fit in experiments {
        sums.add(&[FRAC_PI_4 * fit.a * fit.omega, 1.0], fit.h2);
    }
    sums.solve(1e12).unwrap()
}

/// The condition is that of the line's scaled normal matrix, from its eigenvalues.
#[test]
fn the_condition_is_that_of_the_line() {
    for experiments in [[fit(2.0, 1.5), fit(1.0, 0.7)], [fit(2.0, 1.5), fit(1.9, 1.45)]] {
        let found = describing_function(&experiments).unwrap().condition;
        assert!((found / line(&experiments).condition - 1.0).abs() < 1e-9, "{found}");
    }
}

/// Speeds that differ by a part in a thousand have a condition of 1.6e7: past the bound, whatever h2 says.
#[test]
fn speeds_that_are_nearly_the_same_are_refused() {
    let nearly = |by: f64| {
        let first = fit(2.0, 1.5);
        describing_function(&[first, CycleFit { a: first.a * (1.0 + by), h2: 1.4, ..first }])
    };
    assert_eq!(nearly(1e-3), Err(DescribingError::SameSpeed));
    // Condition 4·(2/δ)²: 1e6 at δ = 4e-3.
    assert_eq!(nearly(3.9e-3), Err(DescribingError::SameSpeed));
    assert!(nearly(4.1e-3).is_ok());
}

/// Experiments that disagree widen the errors, also where each is exact in itself. Those of c and f1 are the line's,
/// and that of b is the error of a mean.
#[test]
fn disagreement_is_an_error_too() {
    let mut four = [fit(2.0, 1.5), fit(1.0, 0.7), fit(2.5, 2.0), fit(4.0, 3.5)];
    for (fit, by) in four.iter_mut().zip([0.02, -0.01, -0.03, 0.01]) {
        fit.h2 += by;
        fit.h1 *= 1.0 + by;
    }
    let found = describing_function(&four).unwrap();
    let textbook = line(&four);
    for (i, j) in [(0, 0), (0, 1), (1, 1)] {
        let (found, expected) = (found.covariance[i + 1][j + 1], textbook.covariance[i][j]);
        assert!((found / expected - 1.0).abs() < 1e-9, "{i} {j}: {found} {expected}");
    }
    let inertias = four.map(|fit| fit.h1 / (FRAC_PI_4 * fit.a * fit.omega * fit.omega));
    let mean = inertias.iter().sum::<f64>() / 4.0;
    let expected = inertias.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / (3.0 * 4.0);
    assert!((found.covariance[0][0] / expected - 1.0).abs() < 1e-9);
}

/// Disagreement that the experiments' own errors explain is not counted a second time.
#[test]
fn disagreement_within_the_errors_is_none() {
    let exact = [fit(2.0, 1.5), fit(1.0, 0.7), fit(2.5, 2.0), fit(4.0, 3.5)].map(|fit| {
        // Each amplitude's error moves the line by 0.02.
        CycleFit { a_error: 0.02 / (PLANT.c * FRAC_PI_4 * fit.omega), ..fit }
    });
    let mut scattered = exact;
    for (fit, by) in scattered.iter_mut().zip([0.012, -0.012, -0.012, 0.012]) {
        fit.h2 += by;
    }
    let [own, with] = [exact, scattered].map(|four| describing_function(&four).unwrap().covariance[1][1]);
    assert!((with / own - 1.0).abs() < 0.15, "{own} {with}");
}

/// Each number of an experiment is looked at by itself, and what it comes to.
#[test]
fn every_number_of_an_experiment_is_checked() {
    let good = fit(1.0, 0.7);
    for bad in [
        CycleFit { h1: 0.0, ..good },
        CycleFit { h2: f64::INFINITY, ..good },
        CycleFit { a: -1.0, ..good },
        CycleFit { omega: 0.0, ..good },
        CycleFit { a_error: -1e-9, ..good },
        CycleFit { omega_error: f64::NAN, ..good },
        // An inertia and a speed past the largest number.
        CycleFit { a: 1e-300, omega: 1e-10, ..good },
        CycleFit { a: 1e200, omega: 1e-30, ..good },
    ] {
        let found = describing_function(&[fit(2.0, 1.5), bad]);
        assert_eq!(found, Err(DescribingError::BadExperiment { index: 1 }), "{bad:?}");
    }
}
