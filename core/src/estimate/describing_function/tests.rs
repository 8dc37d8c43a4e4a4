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

/// The exact cycles of identification.md section 1, six digits: by hand, b = (0.026414 + 0.026382)/2,
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
