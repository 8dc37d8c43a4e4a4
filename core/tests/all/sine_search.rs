//! Where the sine fit looks, what it refuses and with which numbers.

use breakaway_core::estimate::sine::{
    BlockSums, FrequencySearch, MIN_CYCLES_FIXED, MIN_CYCLES_FREE, SineError, SineFit, SineModel, StreamingSine,
    cramer_rao, even, fit_fixed, fit_free,
};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use std::f64::consts::{PI, TAU};

const TS: f64 = 0.01;
const PLAIN: SineModel = SineModel { offset: true, drift: false, third: false, fifth: false };

fn sine(n: usize, omega: f64, phase: f64) -> Vec<f64> {
    (0..n).map(|i| (omega * i as f64 * TS + phase).sin() + 0.4).collect()
}

fn between(y: &[f64], low: f64, high: f64) -> Result<SineFit, SineError> {
    fit_free(even(y, 0.0, TS), FrequencySearch::between(low, high), PLAIN)
}
/// A fit ends within 1e-5 standard errors of the minimum, wherever the search begins.
#[test]
fn where_the_search_begins_does_not_matter() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for run in 0..40 {
        let y: Vec<f64> = (0..400)
            .map(|i| {
                let normal: f64 = StandardNormal.sample(&mut rng);
                (9.3 * f64::from(i) * TS + f64::from(run)).sin() + 0.3 * normal
            })
            .collect();

        let one = between(&y, 7.0, 12.0).unwrap();
        for (low, high) in [(6.1, 13.3), (8.2, 10.7), (5.0, 19.0)] {
            let other = between(&y, low, high).unwrap();
            let apart = (other.omega_rad_s - one.omega_rad_s) / one.se.omega_rad_s;
            assert!(apart.abs() < 2e-5, "{run}: {apart} standard errors");
        }
    }
}

/// A clean sine of one cycle and more is found at any phase, wherever in the range it lies.
#[test]
fn a_clean_sine_is_found_at_any_phase() {
    for tenths in 10..30 {
        let omega = f64::from(tenths) * 0.1 * TAU / 1.2;
        for phase in 0..12 {
            let y = sine(120, omega, f64::from(phase) * PI / 6.0);
            for (low, high) in [(0.8, 1.9), (0.55, 1.1), (0.95, 3.0)] {
                let found = between(&y, low * omega, high * omega).map(|fit| fit.omega_rad_s / omega - 1.0);
                assert!(found.is_ok_and(|off| off.abs() < 1e-8), "{tenths} {phase} {low}: {found:?}");
            }
        }
    }
}

/// The best frequency beyond the range is refused with the edge, on either side; so is a range that is none.
#[test]
fn what_lies_beyond_the_range_is_an_edge() {
    let y = sine(500, 20.0, 0.3);
    for (low, high, edge) in [(21.0, 30.0, 21.0), (10.0, 19.0, 19.0)] {
        let Err(SineError::SearchEdge { omega_rad_s }) = between(&y, low, high) else { panic!("{low}") };
        assert!((omega_rad_s / edge - 1.0).abs() < 0.05, "{omega_rad_s}");
    }
    assert_eq!(between(&y, 20.0, 20.0), Err(SineError::SearchRange));
    assert!(matches!(between(&y, 0.0, 30.0), Err(SineError::Frequency { .. })));
    assert_eq!(between(&y, 10.0, f64::NAN), Err(SineError::SearchRange));
    assert!(matches!(between(&y, f64::NAN, 30.0), Err(SineError::Frequency { .. })));
    // Around an estimate: half of it to twice.
    let around = |estimate: f64| fit_free(even(&y, 0.0, TS), FrequencySearch::around(estimate), PLAIN);
    assert!(around(10.3).is_ok() && around(39.0).is_ok() && around(9.7).is_err() && around(41.5).is_err());
}

/// Three columns need four samples at a known frequency and five at a free one; every further column one more.
#[test]
fn a_sample_more_than_parameters_is_needed() {
    let y: Vec<f64> =
        sine(12, 2.0 / TS, 0.3).iter().zip([0.01, -0.02, 0.015].iter().cycle()).map(|(y, n)| y + n).collect();
    for bits in 0..16 {
        let [offset, drift, third, fifth] = [1, 2, 4, 8].map(|bit| bits & bit != 0);
        let model = SineModel { offset, drift, third, fifth };
        let columns = 2 + usize::from(offset) + usize::from(drift) + 2 * (usize::from(third) + usize::from(fifth));
        let omega = 0.55 / TS;
        let fixed = |n: usize| fit_fixed(even(&y[..n], 0.0, TS), omega, model);
        let free = |n: usize| fit_free(even(&y[..n], 0.0, TS), FrequencySearch::around(omega), model);
        let few = |samples, needed| Err(SineError::TooFewSamples { samples, needed });
        assert_eq!(fixed(columns), few(columns, columns + 1));
        assert!(!matches!(fixed(columns + 1), Err(SineError::TooFewSamples { .. })));
        assert_eq!(free(columns + 1), few(columns + 1, columns + 2));
        assert!(!matches!(free(columns + 2), Err(SineError::TooFewSamples { .. })));
    }
    // With a degree of freedom to spare the residual is that of one.
    let four = fit_fixed(even(&y[..4], 0.0, TS), 2.0 / TS, PLAIN).unwrap();
    assert!(four.rms > 0.0 && four.samples == 4);
}

/// Nyquist's frequency, over the highest harmonic asked for, is the lowest that is too high; the error says it.
#[test]
fn the_limit_is_nyquists_over_the_highest_harmonic() {
    let y = sine(100, 40.0, 0.3);
    let asked = |third, fifth| SineModel { third, fifth, ..PLAIN };
    for (model, harmonic) in
        [(PLAIN, 1.0), (asked(true, false), 3.0), (asked(false, true), 5.0), (asked(true, true), 5.0)]
    {
        let limit = PI / TS / harmonic;
        let fixed = |omega| fit_fixed(even(&y, 3.0, TS), omega, model);
        assert!(fixed(0.98 * limit).is_ok());
        for omega in [1.0001 * limit, 0.0, -3.0] {
            let Err(SineError::Frequency { limit_rad_s }) = fixed(omega) else { panic!("{omega}") };
            assert!((limit_rad_s / limit - 1.0).abs() < 1e-9, "{limit_rad_s}");
        }
    }
    // A range that reaches beyond it is cut: the sine is found below.
    let high = sine(100, 0.9 * PI / TS, 0.3);
    let found = fit_free(even(&high, 0.0, TS), FrequencySearch::between(0.8 * PI / TS, 9.0 * PI / TS), PLAIN).unwrap();
    assert!((found.omega_rad_s * TS / PI - 0.9).abs() < 1e-9);
    let higher = sine(100, 0.99 * PI / TS, 0.3);
    let found =
        fit_free(even(&higher, 0.0, TS), FrequencySearch::between(0.8 * PI / TS, 9.0 * PI / TS), PLAIN).unwrap();
    assert!((found.omega_rad_s * TS / PI - 0.99).abs() < 1e-9);
    // With a third harmonic it is cut at a third of Nyquist's: what is found of a sine beyond it is none of it.
    let third = FrequencySearch::between(0.2 * PI / TS, 0.9 * PI / TS);
    let beyond = fit_free(even(&sine(100, 0.45 * PI / TS, 0.3), 0.0, TS), third, asked(true, false));
    assert!(!beyond.is_ok_and(|fit| fit.omega_rad_s > PI / TS / 3.0 || fit.amplitude > 0.2));
}

/// The search ends a hundredth of π radians of half the record before Nyquist's frequency, where sine and cosine are
/// one column. A sine twice as far from it is found; one half as far has its best beyond the edge.
#[test]
fn the_search_ends_a_hundredth_before_nyquist() {
    let half_s = 0.5 * 99.0 * TS;
    let at = |hundredths: f64| {
        let omega = PI / TS - hundredths * 0.01 * PI / half_s;
        (omega, between(&sine(100, omega, 0.9), 0.97 * PI / TS, 2.0 * PI / TS))
    };
    let (omega, found) = at(2.0);
    assert!((found.unwrap().omega_rad_s / omega - 1.0).abs() < 1e-9);
    let (_, refused) = at(0.5);
    let Err(SineError::SearchEdge { omega_rad_s }) = refused else { panic!("{refused:?}") };
    assert!(((PI / TS - omega_rad_s) * half_s / (0.01 * PI) - 1.0).abs() < 1e-6);
}

/// The numbers' size does not matter: what is squared is of the order of one.
#[test]
fn signals_of_any_size_are_fitted() {
    for size in [1e-200, 1e-20, 1.0, 1e20, 1e200] {
        let y: Vec<f64> = sine(200, 20.0, 0.3).iter().map(|y| size * y).collect();
        for model in [PLAIN, SineModel { offset: false, ..PLAIN }] {
            let fit = fit_fixed(even(&y, 0.0, TS), 20.0, model).unwrap();
            assert!((fit.amplitude / size - 1.0).abs() < if model.offset { 1e-9 } else { 0.1 }, "{size}: {fit:?}");
        }
        let free = between(&y, 15.0, 30.0).unwrap();
        assert!((free.amplitude / size - 1.0).abs() < 1e-9 && (free.offset / size - 0.4).abs() < 1e-9);
    }
}

/// Half a cycle at a known frequency and three quarters at a free one are enough; the error says how many there were.
#[test]
fn the_fewest_cycles_are_enough() {
    let n = 100;
    let omega = |cycles: f64| cycles * TAU / (n as f64 * TS);
    let y = sine(n, omega(0.8), 0.3);
    let fixed = |cycles| fit_fixed(even(&y, 0.0, TS), omega(cycles), PLAIN);
    assert!(fixed(MIN_CYCLES_FIXED).is_ok());
    let Err(SineError::TooFewCycles { cycles, needed }) = fixed(0.99 * MIN_CYCLES_FIXED) else { panic!() };
    assert!((cycles / (0.99 * MIN_CYCLES_FIXED) - 1.0).abs() < 1e-9 && needed == MIN_CYCLES_FIXED);
    // Free: the upper end of the range must reach them, and what is found have them.
    assert!(between(&y, omega(0.6), omega(1.2)).is_ok());
    let Err(SineError::TooFewCycles { cycles, needed }) = between(&y, omega(0.5), omega(0.74)) else { panic!() };
    assert!((cycles / 0.74 - 1.0).abs() < 1e-9 && needed == MIN_CYCLES_FREE);
    let short = sine(n, omega(0.7), 0.3);
    let Err(SineError::TooFewCycles { cycles, .. }) = between(&short, omega(0.5), omega(1.2)) else { panic!() };
    assert!((cycles / 0.7 - 1.0).abs() < 1e-9);
}

/// Without an offset in the model nothing is subtracted, and a constant signal is one of no sine.
#[test]
fn without_an_offset_nothing_is_subtracted() {
    let model = SineModel { offset: false, ..PLAIN };
    let y: Vec<f64> = (0..200).map(|i| 3.0 * (9.0 * f64::from(i) * TS + 0.2).sin()).collect();
    for samples in [&y[..], &y[20..90]] {
        let fit = fit_fixed(even(samples, 0.0, TS), 9.0, model).unwrap();
        assert!((fit.amplitude - 3.0).abs() < 1e-12 && fit.offset == 0.0 && fit.se.offset == 0.0 && fit.rms < 1e-12);
    }
    for model in [PLAIN, model] {
        assert_eq!(fit_fixed(even(&[2.0; 50], 0.0, TS), 30.0, model), Err(SineError::ZeroSignal));
    }
    // Times that are the same to the last digit are no clock.
    let times = (0..8).map(|i| (f64::from(i) * f64::MIN_POSITIVE * f64::EPSILON, f64::from(i % 3)));
    assert!(fit_fixed(times, 1.0, PLAIN).is_err());
}

/// A record of whole cycles with nothing at the frequency asked for is one of no sine; a part in 1e12 of it is one.
#[test]
fn nothing_at_the_frequency_is_no_sine() {
    let n = 120;
    let angle = |cycles: f64, i: i32| cycles * TAU * f64::from(i) / f64::from(n);
    let fit = |part: f64, model| {
        let y: Vec<f64> = (0..n).map(|i| (angle(5.0, i) + 0.3).sin() + part * (angle(3.0, i) + 0.7).sin()).collect();
        fit_fixed(even(&y, 0.0, TS), 3.0 * TAU / (f64::from(n) * TS), model)
    };
    for model in [PLAIN, SineModel { offset: false, ..PLAIN }] {
        assert_eq!(fit(0.0, model), Err(SineError::ZeroSignal));
        let found = fit(1e-12, model).unwrap().amplitude;
        assert!((found / 1e-12 - 1.0).abs() < 0.01, "{found}");
    }
}

/// A square wave of the largest numbers has a sine 4/π as large, which is none.
#[test]
fn a_result_beyond_the_numbers_is_refused() {
    let square = |size: f64| -> Vec<f64> { (0..200).map(|i| if i % 40 < 20 { size } else { -size }).collect() };
    let fit = |size: f64| fit_fixed(even(&square(size), 0.0, TS), TAU / (40.0 * TS), PLAIN);
    assert!((fit(1e308).unwrap().amplitude / 1e308 * PI / 4.0 - 1.0).abs() < 0.01);
    assert_eq!(fit(1.7e308), Err(SineError::NotFinite));
}

/// var A = 2σ²/N, var ω = 24σ²/(A²Ts²N(N²−1)), var θ = 2σ²/(A²N), var d = σ²/N: 100 samples, σ/A = 1/20.
#[test]
fn the_closed_form_of_the_bound() {
    let bound = cramer_rao(2.0, 0.1, 100, TS);
    let omega = (24.0 * 0.0025 / (TS * TS * 100.0 * 9999.0_f64)).sqrt();
    for (found, wanted) in [
        (bound.amplitude, 0.1 * 0.02_f64.sqrt()),
        (bound.omega_rad_s, omega),
        (bound.phase_centre_rad, 0.05 * 0.02_f64.sqrt()),
        (bound.phase_start_rad, (0.0025 * 0.02 + (omega * 99.0 * TS / 2.0).powi(2)).sqrt()),
        (bound.offset, 0.01),
    ] {
        assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
    }
}

/// Two blocks of four samples are the fewest; a period of four samples the shortest.
#[test]
fn the_shortest_streams() {
    assert!(StreamingSine::<f64>::of_period(3, TS).is_none() && StreamingSine::<f64>::of_period(4, TS).is_some());
    let config = StreamingSine::<f64>::of_period(8, TS).unwrap();
    assert!((config.omega_rad_s() * 8.0 * TS / TAU - 1.0).abs() < 1e-9);
    let fit = |n: usize| {
        let mut sums: BlockSums<f64> = BlockSums::new();
        config.push_slice(&mut sums, &sine(n, TAU / (8.0 * TS), 0.3));
        config.fit(&sums)
    };
    assert_eq!(fit(7), Err(SineError::TooFewSamples { samples: 7, needed: 8 }));
    for n in 8..80 {
        let fit = fit(n).unwrap();
        assert_eq!(fit.samples, n);
        assert!((fit.amplitude - 1.0).abs() < 1e-7 && (fit.offset - 0.4).abs() < 1e-7, "{n}: {fit:?}");
        assert!((fit.omega_rad_s * 8.0 * TS / TAU - 1.0).abs() < 1e-6 && (fit.cycles - n as f64 / 8.0).abs() < 1e-5);
    }
    // A quarter of the sampling rate is the limit, and said.
    assert!(StreamingSine::new(0.4999 * PI / TS, TS).is_ok());
    let Err(SineError::Frequency { limit_rad_s }) = StreamingSine::new(0.5001 * PI / TS, TS) else { panic!() };
    assert!((limit_rad_s * TS - PI / 2.0).abs() < 1e-9);
}
