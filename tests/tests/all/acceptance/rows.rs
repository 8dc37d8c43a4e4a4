//! Rows 10 to 13 on sampled relay experiments of the simulated axis (event-exact between samples).

use breakaway::identify::estimate::identify;
use breakaway::recording::Recording;
use breakaway::simulate::experiment::Sensor;
use breakaway_core::estimate::modulating::{BaseEstimate, Modulating, ModulatingState, estimate};

use super::{PAIR, assert_within, relay_record, sensor};

/// Runs a recording through the streaming estimator, with windows of `periods` periods and the sign taken over
/// ±0.02 periods.
fn stream<const F: usize>(
    record: &Recording,
    period: f64,
    periods: f64,
    multiples: [u32; F],
) -> ModulatingState<f64, F> {
    let window = (periods * period / 1e-3).round() as u32;
    let half_width = ((0.02 * period / 1e-3).round() as usize).max(2);
    let estimator = Modulating::<f64, F>::new(1e-3, window, half_width, multiples, 0.0).unwrap();
    let mut state = estimator.start();
    for (&x, &u) in record.x.iter().zip(&record.u) {
        estimator.push(&mut state, x, u);
    }
    state
}

fn pair(cycles: f64, periods: f64, q: f64, seed: u64) -> BaseEstimate {
    let [first, second] = PAIR.map(|(h1, h2, period)| {
        let record = relay_record(0.0, (h1, h2), cycles * period, sensor(q), seed);
        stream(&record, period, periods, [2])
    });
    estimate(&[first.blocks(), second.blocks()]).unwrap()
}

/// Row 10: q = σ = 1e-3, 20 cycles: b 1 %, c 0.5 %, f1 1 %.
#[test]
fn row_10_modulating_with_noise() {
    for seed in 0..5 {
        let fit = pair(20.0, 2.0, 1e-3, seed);
        assert_within("row 10", [fit.b, fit.c, fit.f1], [0.01, 0.005, 0.01]);
    }
}

/// Row 11: three cycles from standstill: 1 %. Windows of 1.92 periods, so that two fit with the sign's margin.
#[test]
fn row_11_modulating_from_standstill() {
    for seed in 0..5 {
        let fit = pair(3.0, 1.92, 1e-4, seed);
        assert_within("row 11", [fit.b, fit.c, fit.f1], [0.01; 3]);
    }
}

/// Row 12: load 0.3, (4, 1.5) and (3, 0.8): 1 %, without and with the load estimated; the load itself 1 %.
#[test]
fn row_12_modulating_with_a_load() {
    let states = [(4.0, 1.5, 0.33), (3.0, 0.8, 0.12)].map(|(h1, h2, period)| {
        let record = relay_record(0.3, (h1, h2), 40.0 * period, sensor(1e-4), 5);
        stream(&record, period, 2.0, [2, 0])
    });
    let without = estimate(&[&states[0].blocks()[..1], &states[1].blocks()[..1]]).unwrap();
    assert_within("row 12, load ignored", [without.b, without.c, without.f1], [0.01; 3]);
    let with = estimate(&[states[0].blocks(), states[1].blocks()]).unwrap();
    assert_within("row 12, load estimated", [with.b, with.c, with.f1], [0.01; 3]);
    assert!((with.load.unwrap() / 0.3 - 1.0).abs() < 0.01, "{with:?}");
}

/// Row 13: output error without noise: 0.01 %. What is left is the stepped plant's error at one step per sample.
#[test]
fn row_13_output_error_without_noise() {
    let records = PAIR.map(|(h1, h2, period)| relay_record(0.0, (h1, h2), 20.0 * period, Sensor::default(), 1));
    let found = identify(&records).unwrap();
    let simulated = found.estimates.iter().find(|e| e.estimator == "output_error").unwrap();
    assert_within("row 13", [simulated.b.value, simulated.c.value, simulated.f1.value], [1e-4; 3]);
}
