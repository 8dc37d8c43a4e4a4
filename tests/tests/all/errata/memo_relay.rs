//! Memo section 3.2, errata 11 to 16: the relay example and its listing.

use std::f64::consts::{PI, TAU};

use breakaway::simulate::limit_cycle::{NoCycle, exact_cycle};
use breakaway_core::estimate::describing_function::{NoCycle as NoPredictedCycle, predict};
use breakaway_tests::papers::{RelayExperiment, memo_listing};

use super::{PLANT, cycle, exact_experiment, experiment, predicted_experiment};

/// The listing's amplitudes, periods and relay levels, with T1 to choose.
const fn listed(t1: f64) -> [RelayExperiment<f64>; 3] {
    [
        experiment(2.0, 1.5, 1.2627, TAU / t1),
        experiment(5.0, 4.0, 6.286, TAU / (6.0 / 5.85)),
        experiment(4.0, 3.5, 5.7935, TAU / (10.0 / 9.0)),
    ]
}

/// c_j of the listing.
fn ratio(first: RelayExperiment<f64>, other: RelayExperiment<f64>) -> f64 {
    (first.h1 * other.a * other.omega.powi(2)) / (other.h1 * first.a * first.omega.powi(2))
}

/// Erratum 11: the text has (h1, h2) = (2, 1.5), (2.5, 2), (1, .5); the code (2, 1.5), (5, 4), (4, 3.5). The
/// listing's amplitudes and periods are those of the code's levels: within 0.5 % and 1.2 %, the accuracy of reading
/// them off the plots. The text's second experiment swings 2.28, not 6.29.
#[test]
fn erratum_11_the_listed_data_belong_to_the_codes_relays() {
    for experiment in listed(4.0 / 5.5) {
        let exact = cycle(experiment.h1, experiment.h2);
        assert!((experiment.a / exact.peak - 1.0).abs() < 0.005, "{experiment:?} against {exact:?}");
        assert!((experiment.omega / exact.omega_rad_s - 1.0).abs() < 0.012, "{experiment:?} against {exact:?}");
    }
    let text = cycle(2.5, 2.0);
    assert!(listed(4.0 / 5.5)[1].a > 2.7 * text.peak, "{text:?}");
}

/// Erratum 12: `T1 = 4/5.5` = .72727. By the listing's own last line, Tp/Kp = 4h11/(πa1ω1²), the printed Kp 9.1536
/// and Tp .2446 need T1 = .72326, ±.00008 for the last printed digits. The exact period .72319(5) fits, 4/5.5 does
/// not, by 50 times the tolerance. With the listed periods the listing gives f1 .53874, f2 .04735, Kp 9.37103, Tp
/// .2532 (row 7), and with T1 = .72319 f2 is still .0498, not the printed .01879: the printed run had other T2 and
/// T3, too.
#[test]
fn erratum_12_the_printed_result_needs_another_period() {
    let period = |tp: f64, kp: f64| TAU * (PI * 1.2627 * tp / kp / (4.0 * 2.0)).sqrt();
    let (low, high) = (period(0.24455, 9.15365), period(0.24465, 9.15355));
    println!("printed Tp/Kp: T1 = {low:.5} .. {high:.5}");
    let exact = cycle(2.0, 1.5).period_s;
    assert!((low..high).contains(&0.72319) && (low..high).contains(&exact), "{low} {high} {exact}");
    assert!(4.0 / 5.5 - high > 25.0 * (high - low));
    let found = memo_listing(listed(4.0 / 5.5));
    assert!((found.f1 - 0.53874).abs() < 1e-5 && (found.kp - 9.37103).abs() < 1e-5, "{found:?}");
    assert!((found.kp - 9.1536).abs() > 0.2 && (found.f2 - 0.01879).abs() > 0.028, "{found:?}");
    assert!((memo_listing(listed(0.72319)).f2 - 0.04982).abs() < 1e-5);
}

/// Erratum 13: the text's third experiment (1, .5) has h2 = f1, where no limit cycle exists.
#[test]
fn erratum_13_the_third_experiment_is_impossible() {
    let refusal = exact_cycle(PLANT, 0.0, 1.0, 0.5).unwrap_err();
    assert_eq!(refusal, NoCycle::BelowFriction { h2: 0.5, f1: 0.5, load: 0.0 });
    assert_eq!(predict(&PLANT, 1.0, 0.5), Err(NoPredictedCycle::H2NotAboveFriction));
    // The condition is sharp: just above it there is a cycle, and it is small.
    let above = exact_cycle(PLANT, 0.0, 1.0, 0.55).unwrap();
    assert!(above.peak < 0.01, "{above:?}");
}

/// Erratum 14: the listing's f2 lacks ω. A viscous friction, in drive units per speed, must become 1000 times larger
/// when time is counted in ms. The listing's f2 stays as it is (to rounding), while its 1/Kp does scale.
#[test]
fn erratum_14_f2_does_not_scale_with_time() {
    let slow = memo_listing(listed(0.72319));
    let fast = memo_listing(listed(0.72319).map(|e| RelayExperiment { omega: e.omega / 1000.0, ..e }));
    assert!((slow.kp / fast.kp - 1000.0).abs() < 1e-6, "{} {}", slow.kp, fast.kp);
    assert!((slow.f2 / fast.f2 - 1.0).abs() < 1e-9, "{} {}", slow.f2, fast.f2);
}

/// Erratum 15: "Kp and Tp are correctly identified" as 9.1536 and .2446, where the text's plant has 10 and .2685. They
/// are the effective 1/c = 9.0909 and b/c = .24409, which include the viscous friction. On data of the describing
/// function the listing gives exactly those, and f2 = 0 whatever f2 is (1e-9: its equations are solved by differences).
#[test]
fn erratum_15_the_identified_gain_is_the_effective_one() {
    let found = memo_listing([(2.0, 1.5), (5.0, 4.0), (4.0, 3.5)].map(|(h1, h2)| predicted_experiment(h1, h2)));
    assert!((found.kp - 9.0909).abs() < 1e-4, "{found:?}");
    assert!((found.tp - 0.24409).abs() < 1e-5, "{found:?}");
    assert!(found.f2.abs() < 1e-9, "{found:?}");
    assert!((found.f1 - 0.5).abs() < 1e-9, "{found:?}");
    // The memo's result lies within 0.7 % of the effective values; the claimed 10 and .2685 are 9 % from it.
    assert!((9.1536 * PLANT.c - 1.0).abs() < 0.007 && (0.2446 * PLANT.c / PLANT.b - 1.0).abs() < 0.007);
}

/// Erratum 16: c_{1,j} is the ratio b_1/b_j of the inertias that two experiments give (b = 4h1/(πaω²)), 1 for one
/// plant: a consistency check, and nothing uses it. The listing's data give 1.0012 and .9829 (5e-5), not the printed 1.0127
/// and .9268 (the same other periods as in erratum 12); exact limit cycles give 1 within 2 %, what the harmonics cost.
#[test]
fn erratum_16_c_is_an_inertia_ratio() {
    let [first, second, third] = listed(4.0 / 5.5);
    let inertia = |e: RelayExperiment<f64>| 4.0 * e.h1 / (PI * e.a * e.omega.powi(2));
    for (other, here, printed) in [(second, 1.0012, 1.0127), (third, 0.9829, 0.9268)] {
        assert!((ratio(first, other) - inertia(first) / inertia(other)).abs() < 1e-12);
        assert!((ratio(first, other) - here).abs() < 5e-5, "{}", ratio(first, other));
        assert!((ratio(first, other) - printed).abs() > 0.01);
    }
    let first = exact_experiment(2.0, 1.5);
    for (h1, h2) in [(5.0, 4.0), (4.0, 3.5), (1.0, 0.7)] {
        let found = ratio(first, exact_experiment(h1, h2));
        println!("exact ({h1}, {h2}): {found:.4}");
        assert!((found - 1.0).abs() < 0.02, "{found}");
    }
}
