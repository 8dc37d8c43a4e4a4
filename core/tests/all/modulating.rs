//! The modulating-function estimator on exactly simulated relay experiments.

use crate::support::{Cycle, Plant, REFERENCE, Record, Sensor, experiment};
use breakaway_core::estimate::modulating::{
    BaseEstimate, Block, Modulating, ModulatingError, ModulatingState, Parameter, Refusal, estimate,
};
use breakaway_core::scalar::SolverReal;
use proptest::prelude::*;

const FIRST: Cycle = Cycle { h1: 2.0, h2: 1.5, period: 0.723195 };
const SECOND: Cycle = Cycle { h1: 1.0, h2: 0.7, period: 0.288730 };
const FINE: Sensor = Sensor { q: 1e-3, sigma: 1e-3 };
const PERFECT: Sensor = Sensor { q: 0.0, sigma: 0.0 };
/// Half-width of the sign's central difference over the period: the larger of the recommended range, for noise.
const WIDTH: f64 = 0.02;

fn feed<R: SolverReal>(record: &Record, period: f64, width: f64) -> ModulatingState<R> {
    let window = (2.0 * period / 1e-3).round() as u32;
    let half_width = ((width * period / 1e-3).round() as usize).max(2);
    let estimator = Modulating::<R>::new(R::from_f64(1e-3), window, half_width, [2], R::ZERO).unwrap();
    let mut state = estimator.start();
    for (&x, &u) in record.x.iter().zip(&record.u) {
        estimator.push(&mut state, R::from_f64(x), R::from_f64(u));
    }
    state
}

fn pair<R: SolverReal>(records: &[Record; 2], width: f64) -> Result<BaseEstimate<R>, Refusal> {
    let a = feed::<R>(&records[0], FIRST.period, width);
    let b = feed::<R>(&records[1], SECOND.period, width);
    estimate(&[a.blocks(), b.blocks()])
}

fn records(cycles: f64, sensor: Sensor, seed: u64) -> [Record; 2] {
    [experiment(REFERENCE, FIRST, cycles, sensor, seed), experiment(REFERENCE, SECOND, cycles, sensor, seed + 1000)]
}

fn relative<R: SolverReal>(estimate: &BaseEstimate<R>) -> [f64; 3] {
    [estimate.b.to_f64() / 0.02685 - 1.0, estimate.c.to_f64() / 0.11 - 1.0, estimate.f1.to_f64() / 0.5 - 1.0]
}

fn assert_within<R: SolverReal>(estimate: &BaseEstimate<R>, limits: [f64; 3]) {
    for (error, limit) in relative(estimate).iter().zip(limits) {
        assert!(error.abs() < limit, "{estimate:?}");
    }
}

/// Without noise what remains is the sign's edges: a few 1e-4 (see the module's table of what sampling costs).
#[test]
fn exact_records_give_the_plant() {
    assert_within(&pair::<f64>(&records(20.0, PERFECT, 1), 0.01).unwrap(), [3e-4; 3]);
}

/// Row 10: q = σ = 1e-3, 20 cycles: b 1 %, c 0.5 %, f1 1 %; f32 on the same.
#[test]
fn row_10_modulating_with_noise() {
    for seed in 0..10 {
        let records = records(20.0, FINE, seed);
        assert_within(&pair::<f64>(&records, WIDTH).unwrap(), [0.01, 0.005, 0.01]);
        assert_within(&pair::<f32>(&records, WIDTH).unwrap(), [0.01, 0.005, 0.01]);
    }
}

/// Row 11: three cycles from standstill, 1 %. The windows are 4 % shorter than two periods (any length is exact). So
/// two of them fit although the sign needs d samples beyond the last.
#[test]
fn row_11_three_cycles_from_standstill() {
    for (sensor, seeds, width) in [(PERFECT, 1, 0.01), (Sensor { q: 1e-4, sigma: 1e-4 }, 10, WIDTH)] {
        for seed in 0..seeds {
            let records = records(3.0, sensor, seed);
            let a = feed::<f64>(&records[0], 0.96 * FIRST.period, width);
            let b = feed::<f64>(&records[1], 0.96 * SECOND.period, width);
            let fit = estimate(&[a.blocks(), b.blocks()]).unwrap();
            assert_eq!(fit.windows, 4);
            assert_within(&fit, [0.01; 3]);
        }
    }
}

const LOADED: [Cycle; 2] = [Cycle { h1: 4.0, h2: 1.5, period: 0.33 }, Cycle { h1: 3.0, h2: 0.8, period: 0.12 }];

/// Row 12: a constant load of 0.3 does not disturb (1 %); the window of multiple 0 measures it.
#[test]
fn row_12_modulating_with_a_load() {
    let plant = Plant { load: 0.3, ..REFERENCE };
    let blocks = LOADED.map(|cycle| {
        let record = experiment(plant, cycle, 40.0, Sensor { q: 1e-4, sigma: 1e-4 }, 5);
        let window = (2.0 * cycle.period / 1e-3) as u32;
        let estimator = Modulating::<f64, 2>::new(1e-3, window, 4, [2, 0], 0.0).unwrap();
        let mut state = estimator.start();
        for (&x, &u) in record.x.iter().zip(&record.u) {
            estimator.push(&mut state, x, u);
        }
        *state.blocks()
    });
    let without = estimate(&[&blocks[0][..1], &blocks[1][..1]]).unwrap();
    assert_within(&without, [0.01; 3]);
    assert_eq!(without.load, None);
    let with = estimate(&[&blocks[0], &blocks[1]]).unwrap();
    assert_within(&with, [0.01; 3]);
    let load = with.load.unwrap();
    assert!((load / 0.3 - 1.0).abs() < 0.01, "{with:?}");
    assert!(load > 10.0 * with.standard_errors[3], "{with:?}");
}

/// The reported standard errors against the scatter of 200 records: within a factor 1.5. The scatter of 200 runs is
/// itself known to 5 %, the systematic part is taken out with the mean.
#[test]
fn standard_errors_are_those_of_the_scatter() {
    const RUNS: u64 = 200;
    let fits: Vec<_> = (0..RUNS).map(|seed| pair::<f64>(&records(20.0, FINE, seed), WIDTH).unwrap()).collect();
    for k in 0..3 {
        let value = |fit: &BaseEstimate| [fit.b, fit.c, fit.f1][k];
        let mean = fits.iter().map(value).sum::<f64>() / RUNS as f64;
        let scatter = (fits.iter().map(|fit| (value(fit) - mean).powi(2)).sum::<f64>() / (RUNS - 1) as f64).sqrt();
        let reported = fits.iter().map(|fit| fit.standard_errors[k]).sum::<f64>() / RUNS as f64;
        println!("parameter {k}: scatter {scatter:.3e} reported {reported:.3e}");
        assert!(reported < 1.5 * scatter && scatter < 1.5 * reported, "{k}: {reported} {scatter}");
    }
}

#[test]
fn one_experiment_cannot_separate_c_and_f1() {
    let mut steady = experiment(REFERENCE, SECOND, 30.0, Sensor { q: 1e-4, sigma: 1e-4 }, 1);
    steady.x.drain(..3000);
    steady.u.drain(..3000);
    let state = feed::<f64>(&steady, SECOND.period, WIDTH);
    let refusal = estimate(&[state.blocks()]).unwrap_err();
    assert_eq!(refusal, Refusal::SingleSpeed);
    assert!(refusal.advice().contains("different h2"));
}

fn single(samples: impl Iterator<Item = (f64, f64)>) -> Result<BaseEstimate, Refusal> {
    let estimator = Modulating::<f64>::new(1e-3, 500, 5, [2], 1e-9).unwrap();
    let mut state = estimator.start();
    for (x, u) in samples {
        estimator.push(&mut state, x, u);
    }
    estimate(&[state.blocks()])
}

#[test]
fn refusals_name_what_is_missing() {
    let time = || (0..5000).map(|k| f64::from(k) * 1e-3);
    assert_eq!(single(time().take(400).map(|t| (t, t))), Err(Refusal::TooShort));
    assert_eq!(single(time().map(|t| (1.0, (20.0 * t).sin()))), Err(Refusal::NoMotion));
    assert_eq!(single(time().map(|t| (f64::NAN, t))), Err(Refusal::NotFinite));
    assert_eq!(estimate::<f64>(&[]), Err(Refusal::TooShort));
    // Forward only, with a swinging speed.
    let forward = single(time().map(|t| (3.0 * t + 0.1 * (25.0 * t).sin() + 0.05 * (7.0 * t).cos(), (25.0 * t).cos())));
    assert_eq!(forward, Err(Refusal::OneDirection));
    let all = [
        Refusal::TooShort,
        Refusal::NoMotion,
        Refusal::OneDirection,
        Refusal::Undetermined(Parameter::Inertia),
        Refusal::Undetermined(Parameter::Load),
    ];
    assert!(all.iter().all(|refusal| refusal.advice().len() > 20));
}

#[test]
fn configuration_errors_name_the_parameter() {
    use ModulatingError as E;
    let new = |ts, window, half_width, multiple, band| {
        Modulating::<f64>::new(ts, window, half_width, [multiple], band).map(|_| ()).unwrap_err()
    };
    assert_eq!(new(0.0, 500, 5, 2, 0.0), E::SamplePeriod);
    assert_eq!(new(1e-3, 15, 2, 2, 0.0), E::Window);
    assert_eq!(new(1e-3, 500, 1, 2, 0.0), E::HalfWidth);
    assert_eq!(new(1e-3, 500, 32, 2, 0.0), E::HalfWidth);
    assert_eq!(new(1e-3, 500, 5, 1, 0.0), E::Multiple);
    assert_eq!(new(1e-3, 500, 5, 63, 0.0), E::Multiple);
    assert_eq!(new(1e-3, 500, 5, 2, f64::NAN), E::RestBand);
}

fn scaled(records: &[Record; 2], x: f64, u: f64) -> [Record; 2] {
    [0, 1].map(|k| Record {
        x: records[k].x.iter().map(|value| value * x).collect(),
        u: records[k].u.iter().map(|value| value * u).collect(),
        error_counts: Vec::new(),
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// x → kx, u → lu: b and c scale with l/k, f1 with l. A sign change of both is the case k = l = −1.
    #[test]
    fn units_scale(k in prop_oneof![1e-4_f64..1e4, Just(-1.0)], l in 1e-3_f64..1e3, seed in 0_u64..50) {
        let l = if k < 0.0 { -l } else { l };
        let records = records(6.0, FINE, seed);
        let one = pair::<f64>(&records, WIDTH).unwrap();
        let other = pair::<f64>(&scaled(&records, k, l), WIDTH).unwrap();
        prop_assert!((other.b / one.b * k / l - 1.0).abs() < 1e-8);
        prop_assert!((other.c / one.c * k / l - 1.0).abs() < 1e-8);
        prop_assert!((other.f1 / one.f1 / l.abs() - 1.0).abs() < 1e-8);
    }

    /// A constant added to the position changes nothing (f64 rounding of x aside).
    #[test]
    fn the_origin_does_not_matter(origin in -1e3..1e3, seed in 0_u64..50) {
        let records = records(6.0, FINE, seed);
        let one = pair::<f64>(&records, WIDTH).unwrap();
        let mut moved = scaled(&records, 1.0, 1.0);
        for record in &mut moved {
            record.x.iter_mut().for_each(|x| *x += origin);
        }
        let other = pair::<f64>(&moved, WIDTH).unwrap();
        for (a, b) in relative(&one).iter().zip(relative(&other)) {
            // A difference that was exactly 0 may become ±1e-13 and take a sign.
            prop_assert!((a - b).abs() < 2e-3, "{a} {b}");
        }
    }

    /// A later start gives the same parameters within a few standard errors of each.
    #[test]
    fn time_shift(shift in 0_usize..700, seed in 0_u64..50) {
        let mut records = records(20.0, FINE, seed);
        let one = pair::<f64>(&records, WIDTH).unwrap();
        for record in &mut records {
            record.x.drain(..shift);
            record.u.drain(..shift);
        }
        let other = pair::<f64>(&records, WIDTH).unwrap();
        for (k, (a, b)) in [(one.b, other.b), (one.c, other.c), (one.f1, other.f1)].into_iter().enumerate() {
            prop_assert!((a - b).abs() < 5.0 * one.standard_errors[k].hypot(other.standard_errors[k]));
        }
    }

    /// f32 agrees with f64 far inside the noise: 2⁻²³·√1500 samples, divided by the weakest eigenvalue 0.03, is 1.5e-4.
    #[test]
    fn single_precision_agrees(seed in 0_u64..50) {
        let records = records(20.0, FINE, seed);
        let one = relative(&pair::<f64>(&records, WIDTH).unwrap());
        let other = relative(&pair::<f32>(&records, WIDTH).unwrap());
        for (a, b) in one.iter().zip(other) {
            prop_assert!((a - b).abs() < 2e-4, "{a} {b}");
        }
    }

    /// Solved in f32, sums in f32 lose nothing that solving them in f64 would keep: parameters to 1e-6, errors to 1e-3.
    #[test]
    fn single_precision_solves_its_sums_to_its_last_digits(seed in 0_u64..50) {
        let records = records(20.0, FINE, seed);
        let states = [feed::<f32>(&records[0], FIRST.period, WIDTH), feed::<f32>(&records[1], SECOND.period, WIDTH)];
        let single = estimate(&[states[0].blocks(), states[1].blocks()]).unwrap();
        let wide = states.each_ref().map(|state| state.blocks().map(Block::<f64>::from));
        let double = estimate(&[&wide[0], &wide[1]]).unwrap();
        for (a, b) in [(single.b, double.b), (single.c, double.c), (single.f1, double.f1)] {
            prop_assert!((f64::from(a) / b - 1.0).abs() < 1e-6, "{a} {b}");
        }
        for (a, b) in single.standard_errors.iter().zip(double.standard_errors).take(3) {
            prop_assert!((f64::from(*a) / b - 1.0).abs() < 1e-3, "{a} {b}");
        }
        prop_assert!((f64::from(single.residual) / double.residual - 1.0).abs() < 1e-3);
        prop_assert!((f64::from(single.condition) / double.condition - 1.0).abs() < 1e-3);
    }

    /// Whatever is fed: no panic, and a result is finite.
    #[test]
    fn any_input(samples in prop::collection::vec((any::<f64>(), any::<f64>()), 0..400), window in 0_u32..70, half_width in 0_usize..6, multiple in 0_u32..9) {
        if let Ok(estimator) = Modulating::<f64, 2, 11>::new(1e-3, window, half_width, [multiple, 0], 0.0) {
            let mut state = estimator.start();
            for (x, u) in samples {
                estimator.push(&mut state, x, u);
            }
            if let Ok(fit) = estimate(&[state.blocks()]) {
                prop_assert!(fit.b.is_finite() && fit.c.is_finite() && fit.f1.is_finite());
            }
        }
    }

    /// The same in f32, whose sums overflow first.
    #[test]
    fn any_input_in_single_precision(samples in prop::collection::vec((any::<f32>(), any::<f32>()), 0..400), window in 16_u32..70) {
        if let Ok(estimator) = Modulating::<f32, 1, 11>::new(1e-3, window, 2, [2], 0.0) {
            let mut state = estimator.start();
            for (x, u) in samples {
                estimator.push(&mut state, x, u);
            }
            if let Ok(fit) = estimate(&[state.blocks()]) {
                prop_assert!(fit.b.is_finite() && fit.c.is_finite() && fit.f1.is_finite());
            }
        }
    }
}
