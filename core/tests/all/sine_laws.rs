//! Laws of the sine fit: scaling, sign, time shift, agreement of the number types, and no panic on any input.

use breakaway_core::estimate::sine::{
    BlockSums, FrequencySearch, SineError, SineFit, SineModel, StreamingSine, even, fit_fixed, fit_free,
};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use std::f64::consts::{PI, TAU};

const TS: f64 = 0.01;

fn angle_between(a: f64, b: f64) -> f64 {
    ((a - b + PI).rem_euclid(TAU) - PI).abs()
}

/// A sine with a deterministic disturbance of a hundredth, so that there is a residual.
fn record(n: usize, omega: f64, phase: f64, dc: f64) -> Vec<f64> {
    (0..n)
        .map(|i| {
            let t = i as f64 * TS;
            (omega * t + phase).sin() + dc + 0.01 * (i as f64 * i as f64 * 0.7).sin()
        })
        .collect()
}

fn batch(y: &[f64], start_s: f64, omega: f64) -> Result<SineFit, SineError> {
    let search = FrequencySearch::around(omega);
    fit_free(even(y, start_s, TS), search, SineModel::default())
}

fn streaming<S: breakaway_core::estimate::sine::Sample>(y: &[S], omega: f64) -> Result<SineFit, SineError> {
    let config = StreamingSine::new(omega, TS)?;
    let mut sums: BlockSums<S> = BlockSums::new();
    config.push_slice(&mut sums, y);
    config.fit(&sums)
}

/// A sine in counts: its period in samples and its error of that, its length, phase, offset and third harmonic. It
/// has one count of noise beside the harmonic, and 50 dB without.
struct Counts {
    period: u32,
    off: f64,
    cycles: f64,
    phase: f64,
    offset: i32,
    harmonics: f64,
}

fn in_f64_and_f32(record: &Counts, seed: u64) -> (SineFit<f64>, SineFit<f32>) {
    let period = f64::from(record.period);
    let wide = StreamingSine::new(TAU / (period * TS), TS).unwrap();
    let narrow = StreamingSine::<f32>::of_period(record.period, TS as f32).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut a, mut b) = (BlockSums::<i32>::new(), BlockSums::<i32>::new());
    let (amplitude, noise) = (20_000.0, if record.harmonics > 0.0 { 1.0 } else { 63.2 });
    for k in 0..(record.cycles * period) as u32 {
        let angle = TAU * f64::from(k) / period * (1.0 + record.off) + record.phase;
        let normal: f64 = StandardNormal.sample(&mut rng);
        let y = amplitude * (angle.sin() + record.harmonics * (3.0 * angle).sin()) + noise * normal;
        wide.push(&mut a, y.round() as i32 + record.offset);
        narrow.push(&mut b, y.round() as i32 + record.offset);
    }
    (wide.fit(&a).unwrap(), narrow.fit(&b).unwrap())
}

/// The standard errors of limit cycles with 4 % of a third harmonic, solved in f32, are those of f64 to a thousandth
/// in 99 of a hundred. In the others the harmonic leaves next to nothing between the blocks, and the two sources of
/// the noise disagree. Then the rounding of the part of the sine that the blocks do not see decides the weight of
/// each. In 6 000 others 32 were off by more, 5 by more than 1 %, 1 by more than 5 %: by 30 %, where 66 counts of 20
/// 000 were left.
#[test]
fn standard_errors_in_f32_are_those_of_f64() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let mut draw = |low: f64, high: f64| rand_distr::Uniform::new(low, high).unwrap().sample(&mut rng);
    let mut off: Vec<f64> = (0..300)
        .map(|seed| {
            let record = Counts {
                period: draw(60.0, 400.0) as u32,
                off: draw(-0.01, 0.01),
                cycles: draw(8.0, 60.0),
                phase: draw(-3.0, 3.0),
                offset: draw(-500.0, 500.0) as i32,
                harmonics: 0.04,
            };
            let (truth, fit) = in_f64_and_f32(&record, seed);
            (f64::from(fit.se.amplitude) / truth.se.amplitude - 1.0).abs()
        })
        .collect();
    off.sort_by(f64::total_cmp);
    println!("the worst: {:?}", &off[290..]);
    assert!(off[293] < 1e-3 && off[299] < 0.05, "{:?}", &off[290..]);
}

fn any_value() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1e3..1e3_f64,
        1 => any::<f64>(),
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(f64::MAX),
        1 => Just(f64::MIN_POSITIVE),
        1 => Just(0.0),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// y → k·y scales A, d, rms and their errors; 1e-9 is the iteration's stop (1e-7 standard errors) and rounding.
    #[test]
    fn amplitude_scales(k in 1e-6..1e6_f64, phase in -PI..PI, cycles in 2.0..9.0_f64) {
        let y = record(400, cycles * TAU / 4.0, phase, 0.4);
        let scaled: Vec<f64> = y.iter().map(|v| k * v).collect();
        let estimate = 1.03 * cycles * TAU / 4.0;
        for (a, b) in [
            (batch(&y, 0.0, estimate).unwrap(), batch(&scaled, 0.0, estimate).unwrap()),
            (streaming(&y, estimate).unwrap(), streaming(&scaled, estimate).unwrap()),
        ] {
            prop_assert!((b.amplitude / (k * a.amplitude) - 1.0).abs() < 1e-9);
            prop_assert!((b.omega_rad_s / a.omega_rad_s - 1.0).abs() < 1e-9);
            prop_assert!((b.offset / (k * a.offset) - 1.0).abs() < 1e-8);
            prop_assert!((b.rms / (k * a.rms) - 1.0).abs() < 1e-6);
            prop_assert!((b.se.amplitude / (k * a.se.amplitude) - 1.0).abs() < 1e-6);
            prop_assert!((b.se.omega_rad_s / a.se.omega_rad_s - 1.0).abs() < 1e-6);
        }
    }

    /// y → −y turns the phase by π and changes nothing else.
    #[test]
    fn sign_turns_the_phase(phase in -PI..PI, cycles in 2.0..9.0_f64) {
        let y = record(400, cycles * TAU / 4.0, phase, 0.4);
        let negated: Vec<f64> = y.iter().map(|v| -v).collect();
        let estimate = 0.97 * cycles * TAU / 4.0;
        for (a, b) in [
            (batch(&y, 0.0, estimate).unwrap(), batch(&negated, 0.0, estimate).unwrap()),
            (streaming(&y, estimate).unwrap(), streaming(&negated, estimate).unwrap()),
        ] {
            prop_assert!(angle_between(b.phase_centre_rad, a.phase_centre_rad + PI) < 1e-9);
            prop_assert!((b.amplitude / a.amplitude - 1.0).abs() < 1e-9);
            prop_assert!((b.offset + a.offset).abs() < 1e-9);
        }
    }

    /// A later clock changes nothing; a later start turns the first sample's phase by ω·shift.
    #[test]
    fn time_shift_turns_the_phase(shift in 0..60_usize, clock in -1e3..1e3_f64, phase in -PI..PI) {
        let omega = 9.3;
        let clean: Vec<f64> = (0..500).map(|i| (omega * f64::from(i) * TS + phase).sin() + 1.0).collect();
        let a = batch(&clean[..400], 0.0, 9.0).unwrap();
        // Times near 1e3 s are rounded to 1e-13 s, 1e-12 rad.
        let moved = batch(&clean[..400], clock, 9.0).unwrap();
        prop_assert!(angle_between(moved.phase_start_rad, a.phase_start_rad) < 1e-9);
        prop_assert!((moved.omega_rad_s - a.omega_rad_s).abs() < 1e-9);
        let later = &clean[shift..shift + 400];
        for b in [batch(later, 0.0, 9.0).unwrap(), streaming(later, 9.0).unwrap()] {
            let expected = a.phase_start_rad + omega * shift as f64 * TS;
            // The oscillator's table errs by 2.6e-9.
            prop_assert!(angle_between(b.phase_start_rad, expected) < 1e-8);
            prop_assert!((b.amplitude - a.amplitude).abs() < 1e-8);
        }
    }

    /// Counts of a limit cycle, as a board sums them: solved in f32 they give what f64 gives, to the digits of f32.
    /// With 50 dB of noise instead of harmonics the noise's power is 1e-5 of the signal's. Of that the sums' rounding
    /// (2^-24 each of 32 blocks' three, relative) takes up to 2e-7: 2 % of it, 1 % of the standard errors. Those of
    /// the limit cycle: `standard_errors_in_f32_are_those_of_f64`.
    #[test]
    fn solved_in_f32_as_in_f64(
        period in 60_u32..1_500,
        off in -0.01..0.01_f64,
        cycles in 8.0..60.0_f64,
        phase in -3.0..3.0_f64,
        offset in -500_i32..500,
        harmonics in prop_oneof![Just(0.04_f64), Just(0.0)],
        seed in any::<u64>(),
    ) {
        let (truth, fit) = in_f64_and_f32(&Counts { period, off, cycles, phase, offset, harmonics }, seed);
        for (name, got, se_got, value, se) in [
            ("amplitude", fit.amplitude, fit.se.amplitude, truth.amplitude, truth.se.amplitude),
            ("omega", fit.omega_rad_s, fit.se.omega_rad_s, truth.omega_rad_s, truth.se.omega_rad_s),
            ("offset", fit.offset, fit.se.offset, truth.offset, truth.se.offset),
        ] {
            let apart = (f64::from(got) - value).abs();
            let scale = if name == "offset" { truth.amplitude } else { value };
            prop_assert!(apart <= 0.05 * se + 1e-6 * scale, "{name}: {got} and {value} ± {se}");
            let errors = (f64::from(se_got) / se - 1.0).abs();
            prop_assert!(harmonics > 0.0 || errors < 0.02, "{name}: standard error {se_got} and {se}");
        }
        prop_assert!((f64::from(fit.phase_centre_rad) - truth.phase_centre_rad).abs() < 2e-6, "{:?} {:?}", fit, truth);
    }

    /// f32, f64 and counts give the same sine, and that of the batch fit to a fraction of the standard error.
    #[test]
    fn number_types_agree(phase in -PI..PI, cycles in 1.5..30.0_f64, error in -0.04..0.04_f64) {
        let omega = cycles * TAU / 12.0;
        let y = record(1200, omega, phase, 3.0);
        let ω0 = omega * (1.0 + error);
        let scale = 1e6;
        let counts: Vec<i32> = y.iter().map(|v| (v * scale).round() as i32).collect();
        let singles: Vec<f32> = y.iter().map(|v| *v as f32).collect();
        let double = streaming(&y, ω0).unwrap();
        let single = streaming(&singles, ω0).unwrap();
        let count = streaming(&counts, ω0).unwrap();
        // One step of the number type, which bounds what rounding does: 2.4e-7 at y = 4 in f32, and 1e-6 in counts. The
        // rounding of a smooth sine is correlated, and does not average out as noise does.
        for (fit, unit, tolerance) in [(single, 1.0, 2.4e-7), (count, scale, 1e-6)] {
            prop_assert!((fit.amplitude / unit - double.amplitude).abs() < tolerance);
            prop_assert!((fit.omega_rad_s / double.omega_rad_s - 1.0).abs() < tolerance);
            prop_assert!(angle_between(fit.phase_centre_rad, double.phase_centre_rad) < tolerance);
            prop_assert!((fit.offset / unit - double.offset).abs() < tolerance);
        }
        // What the blocks lose against all samples is noise, a fraction of one standard error.
        let whole = batch(&y, 0.0, ω0).unwrap();
        prop_assert!((whole.amplitude - double.amplitude).abs() < whole.se.amplitude);
        prop_assert!((whole.omega_rad_s - double.omega_rad_s).abs() < whole.se.omega_rad_s);
        // At worst the noise is known from the sums of 16 blocks alone, 44 degrees of freedom: 10.7 %, thrice.
        prop_assert!((double.rms / whole.rms - 1.0).abs() < 0.32);
    }

    /// One by one or in slices of any size: the same sums.
    #[test]
    fn slices_do_not_matter(cuts in prop::collection::vec(1..700_usize, 1..12)) {
        let y: Vec<i32> = (0..3000).map(|i| (1e4 * (0.02 * f64::from(i)).sin()) as i32).collect();
        let config = StreamingSine::new(2.0, TS).unwrap();
        let mut whole: BlockSums<i32> = BlockSums::new();
        config.push_slice(&mut whole, &y);
        let mut parts: BlockSums<i32> = BlockSums::new();
        let mut rest = y.as_slice();
        for cut in cuts.iter().cycle() {
            let (now, later) = rest.split_at((*cut).min(rest.len()));
            config.push_slice(&mut parts, now);
            rest = later;
            if rest.is_empty() {
                break;
            }
        }
        prop_assert_eq!(config.fit(&whole), config.fit(&parts));
    }

    /// Any values, times, frequencies and models end in a finite fit or an error.
    #[test]
    fn nothing_panics(
        values in prop::collection::vec((any_value(), any_value()), 0..40),
        omega in any_value(),
        other in any_value(),
        ts in any_value(),
        columns in any::<[bool; 4]>(),
        sorted in any::<bool>(),
    ) {
        let [offset, drift, third, fifth] = columns;
        let model = SineModel { offset, drift, third, fifth };
        let mut values = values;
        if sorted {
            values.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let y: Vec<f64> = values.iter().map(|v| v.1).collect();
        let singles: Vec<f32> = y.iter().map(|v| *v as f32).collect();
        let counts: Vec<i32> = y.iter().map(|v| *v as i32).collect();
        let mut fits = vec![
            fit_free(values.iter().copied(), FrequencySearch::around(omega), model),
            fit_free(values.iter().copied(), FrequencySearch::between(omega, other), model),
            fit_free(even(&y, other, ts), FrequencySearch::around(omega), model),
            fit_fixed(values.iter().copied(), omega, model),
            fit_fixed(even(&y, 0.0, 0.01), omega.abs().clamp(30.0, 300.0), model),
            fit_free(even(&y, 0.0, 0.01), FrequencySearch::around(60.0), model),
        ];
        for (omega, ts) in [(omega, ts), (60.0, 0.01)] {
            if let Ok(config) = StreamingSine::new(omega, ts) {
                let mut a: BlockSums<f64> = BlockSums::new();
                let mut b: BlockSums<f32, 8> = BlockSums::new();
                let mut c: BlockSums<i32, 8> = BlockSums::new();
                config.push_slice(&mut a, &y);
                config.push_slice(&mut b, &singles);
                config.push_slice(&mut c, &counts);
                fits.extend([config.fit(&a), config.fit(&b), config.fit(&c)]);
            }
        }
        for fit in fits.into_iter().flatten() {
            prop_assert!(fit.amplitude > 0.0 && fit.amplitude.is_finite());
            prop_assert!(fit.omega_rad_s > 0.0 && fit.omega_rad_s.is_finite());
            prop_assert!(fit.rms >= 0.0 && fit.offset.is_finite() && fit.cycles > 0.0);
        }
    }
}
