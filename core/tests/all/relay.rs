//! The dual relay and the limit-cycle detector around the exactly simulated reference plant.

use crate::support::{Plant, REFERENCE, Run, Sensor, relay_run};
use breakaway_core::estimate::limit_cycle::{
    DetectorSettings, Limit, LimitCycleDetector, NoLimitCycleReason, RelayOutcome,
};
use breakaway_core::excite::relay::{DualRelay, DualRelayState};
use proptest::prelude::*;

const IDEAL: Sensor = Sensor { q: 1e-6, sigma: 0.0 };

fn settings(run: Run, sensor: Sensor) -> DetectorSettings<f64> {
    DetectorSettings {
        ts: run.ts,
        h1: run.h1,
        h2: run.h2,
        hysteresis: (f64::from(run.hysteresis) + 0.5) * sensor.q,
        f1: None,
        tolerance: 0.005,
        timeout_s: run.ts * run.ticks as f64,
        max_error: 20.0,
    }
}

fn outcome(plant: Plant, run: Run, sensor: Sensor, change: impl Fn(&mut DetectorSettings<f64>)) -> RelayOutcome<f64> {
    let record = relay_run(plant, run, sensor, 7);
    let mut settings = settings(run, sensor);
    change(&mut settings);
    let detector = LimitCycleDetector::new(settings).unwrap();
    let mut state = detector.start();
    let mut last = None;
    for (&counts, &u) in record.error_counts.iter().zip(&record.u) {
        last = detector.push(&mut state, f64::from(counts) * sensor.q, u);
    }
    last.expect("the time out ends every run")
}

const fn run(h1: f64, h2: f64, ts: f64, seconds: f64) -> Run {
    Run { h1, h2, ts, ticks: (seconds / ts) as usize + 2, hysteresis: 0 }
}

/// Periods and fundamental amplitudes of docs/theory.md, section 2. The relay is sampled at 20 µs: half a sample of
/// lag is ω·Ts/2 ≤ 2e-4 rad. That moves the balance h2 − f1 by at most h1·2e-4/(h2−f1) = 0.1 %. √2·rms exceeds the
/// fundamental by (X3/X1)²/2 ≤ 0.11 %; the settling tolerance is set to 0.1 % of change still to come.
#[test]
fn settled_cycles_agree_with_the_exact_ones() {
    for (h1, h2, period, amplitude) in
        [(2.0, 1.5, 0.723195, 1.27742), (1.0, 0.7, 0.288730, 0.10192), (2.5, 2.0, 0.871073, 2.30762)]
    {
        let run = run(h1, h2, 2e-5, 40.0 * period);
        let end = outcome(REFERENCE, run, IDEAL, |settings| settings.tolerance = 1e-3);
        let RelayOutcome::Settled(cycle) = end else { panic!("{end:?}") };
        assert!((cycle.period_s / period - 1.0).abs() < 3e-3, "{h1} {cycle:?}");
        assert!((cycle.amplitude / amplitude - 1.0).abs() < 5e-3, "{h1} {cycle:?}");
        assert!((cycle.omega * cycle.period_s - core::f64::consts::TAU).abs() < 1e-12);
        assert!(cycle.bias.abs() < 0.01 * amplitude, "{cycle:?}");
    }
}

/// A known f1 gives the contraction of a cycle, ρ = e^(−2(h2−f1)/h1) (docs/theory.md, section 2).
#[test]
fn the_contraction_is_that_of_the_known_friction() {
    for (h1, h2) in [(2.5, 2.0), (2.0, 1.5)] {
        let end = outcome(REFERENCE, run(h1, h2, 1e-4, 20.0), IDEAL, |settings| settings.f1 = Some(0.5));
        let RelayOutcome::Settled(cycle) = end else { panic!("{end:?}") };
        let expected = (-2.0 * (h2 - 0.5) / h1).exp();
        assert!((cycle.contraction - expected).abs() < 1e-12, "{h1}: {} {expected}", cycle.contraction);
    }
}

/// Without f1 it is the ratio of two changes, but no faster than a frictionless axis (f1 = 0) and no slower than 0.95.
#[test]
fn the_observed_contraction_has_its_bounds() {
    let end = outcome(REFERENCE, run(2.0, 1.5, 1e-4, 20.0), IDEAL, |_| ());
    let RelayOutcome::Settled(cycle) = end else { panic!("{end:?}") };
    assert!(cycle.contraction >= (-1.5_f64).exp() - 1e-12 && cycle.contraction <= 0.95, "{cycle:?}");
}

/// With noise and a coarse encoder at 1 kHz, as row 10's record: still settled.
#[test]
fn noise_does_not_hide_the_cycle() {
    for (q, sigma, hysteresis) in [(1e-4, 1e-4, 4), (1e-3, 1e-3, 4)] {
        for (h1, h2) in [(2.0, 1.5), (1.0, 0.7)] {
            let run = Run { hysteresis, ..run(h1, h2, 1e-3, 20.0) };
            // Noise of σ on a zero crossing of slope aω jitters a period by √2σ/(aω)/T: 0.2 % at (1, 0.7).
            let end = outcome(REFERENCE, run, Sensor { q, sigma }, |settings| {
                settings.tolerance = 0.02;
            });
            assert!(matches!(end, RelayOutcome::Settled(_)), "{q} {h1} {end:?}");
        }
    }
}

/// Row 14: h2 = 0.49 < f1 = 0.5 has no limit cycle, and the reason is said; f1 known or not.
#[test]
fn row_14_no_limit_cycle() {
    use NoLimitCycleReason::{H2NotAboveFriction, MotionDied, SustainedByLag};
    for (ts, q, sigma, hysteresis) in
        [(1e-3, 1e-6, 0.0, 0), (1e-3, 1e-4, 1e-4, 4), (1e-4, 1e-4, 0.0, 1), (1e-3, 1e-3, 1e-3, 4)]
    {
        let run = Run { hysteresis, ..run(1.0, 0.49, ts, 20.0) };
        let end = outcome(REFERENCE, run, Sensor { q, sigma }, |settings| {
            settings.tolerance = 0.02;
        });
        let RelayOutcome::NoLimitCycle { reason } = end else { panic!("{ts} {q} {end:?}") };
        assert!(matches!(reason, SustainedByLag | MotionDied), "{reason:?}");
        assert!(reason.advice().contains("h2 ≤ f1"));
        let known = outcome(REFERENCE, run, Sensor { q, sigma }, |settings| {
            settings.f1 = Some(0.5);
        });
        assert_eq!(known, RelayOutcome::NoLimitCycle { reason: H2NotAboveFriction });
    }
}

/// h2 far below f1, set in motion from outside: the motion dies, and the relay's chatter is not taken for a cycle.
#[test]
fn kicked_motion_dies() {
    let kicked = Plant { v: 20.0, ..REFERENCE };
    let end = outcome(kicked, run(1.0, 0.3, 1e-3, 20.0), IDEAL, |_| ());
    assert!(
        matches!(
            end,
            RelayOutcome::NoLimitCycle { reason: NoLimitCycleReason::MotionDied | NoLimitCycleReason::SustainedByLag }
        ),
        "{end:?}"
    );
}

#[test]
fn drive_below_breakaway() {
    let end = outcome(REFERENCE, run(0.2, 0.2, 1e-3, 5.0), IDEAL, |_| ());
    let reason = NoLimitCycleReason::DriveBelowBreakaway;
    assert_eq!(end, RelayOutcome::NoLimitCycle { reason });
}

/// Section 2: with a constant load FR2 drives the mean of e to 0. The load shows as the mean drive, which over a
/// whole cycle is load + f1·(mean sign of the velocity). The velocity is symmetric within 1 % here: f1/100 is
/// allowed.
#[test]
fn a_load_is_reported_as_asymmetry_and_does_not_drift() {
    let loaded = Plant { load: 0.3, ..REFERENCE };
    let end = outcome(loaded, run(4.0, 1.5, 1e-4, 20.0), IDEAL, |_| ());
    let RelayOutcome::Asymmetric { cycle, asymmetry } = end else { panic!("{end:?}") };
    assert!(asymmetry.abs() < 0.05, "{asymmetry}");
    assert!(cycle.bias.abs() < 0.02 * cycle.amplitude, "{cycle:?}");
    assert!((cycle.mean_drive - 0.3).abs() < 0.005, "{cycle:?}");
}

/// The mean of e over 40 s of whole record tends to zero, loaded or not: Σe stays bounded by one cycle's worth.
#[test]
fn the_error_has_no_drift() {
    for load in [0.0, 0.3] {
        let record = relay_run(Plant { load, ..REFERENCE }, run(4.0, 1.5, 1e-3, 40.0), IDEAL, 1);
        let late = &record.error_counts[20_000..];
        let mean = late.iter().map(|&e| f64::from(e)).sum::<f64>() / late.len() as f64;
        let rms = (late.iter().map(|&e| f64::from(e).powi(2)).sum::<f64>() / late.len() as f64).sqrt();
        // Whole cycles cancel; the rest of one of ≈ 50 cycles is at most 2/π·½/50 of the amplitude.
        assert!(mean.abs() < 0.01 * rms, "{load} {mean} {rms}");
    }
}

#[test]
fn limits_and_time_out() {
    let end = outcome(REFERENCE, run(2.0, 1.5, 1e-3, 5.0), IDEAL, |settings| {
        settings.max_error = 0.5;
    });
    let RelayOutcome::LimitTripped { which: Limit::Error, value } = end else { panic!("{end:?}") };
    assert!(value.abs() > 0.5);
    let end = outcome(REFERENCE, run(2.0, 1.5, 1e-3, 5.0), IDEAL, |settings| {
        settings.timeout_s = 1.0;
    });
    assert!(matches!(end, RelayOutcome::Timeout { cycles: 2.., last_change } if last_change < 1.0), "{end:?}");
    // The first cycle from standstill has none before it: its change is not known, and counts as whole.
    let end = outcome(REFERENCE, run(2.0, 1.5, 1e-3, 5.0), IDEAL, |settings| settings.timeout_s = 0.03);
    assert!(matches!(end, RelayOutcome::Timeout { cycles: 0..=1, last_change: 1.0 }), "{end:?}");
    // At 1 ms a crossing is known within a tick of the 723: nothing settles to the least tolerance, and the cycles'
    // changes stay within two ticks.
    let end = outcome(REFERENCE, run(2.0, 1.5, 1e-3, 20.0), IDEAL, |settings| settings.tolerance = 1e-5);
    let RelayOutcome::Timeout { cycles: 20.., last_change } = end else { panic!("{end:?}") };
    assert!(last_change < 2.0 / 723.0, "{last_change}");
    let detector = LimitCycleDetector::new(settings(run(2.0, 1.5, 1e-3, 5.0), IDEAL)).unwrap();
    let mut state = detector.start();
    assert_eq!(detector.push(&mut state, 0.0, 3.5), None);
    let end = detector.push(&mut state, f64::NAN, 0.0);
    assert!(matches!(end, Some(RelayOutcome::LimitTripped { which: Limit::NotFinite, .. })));
}

#[test]
fn settings_errors_name_the_parameter() {
    use breakaway_core::estimate::limit_cycle::DetectorError as E;
    let good = settings(run(2.0, 1.5, 1e-3, 5.0), IDEAL);
    for (bad, error) in [
        (DetectorSettings { ts: 0.0, ..good }, E::SamplePeriod),
        (DetectorSettings { h1: -1.0, ..good }, E::H1),
        (DetectorSettings { h2: f64::NAN, ..good }, E::H2),
        (DetectorSettings { hysteresis: -1.0, ..good }, E::Hysteresis),
        (DetectorSettings { f1: Some(-0.5), ..good }, E::F1),
        (DetectorSettings { tolerance: 0.0, ..good }, E::Tolerance),
        (DetectorSettings { timeout_s: 0.001, ..good }, E::Timeout),
        (DetectorSettings { max_error: 0.0, ..good }, E::MaxError),
    ] {
        assert_eq!(LimitCycleDetector::new(bad), Err(error));
    }
}

proptest! {
    /// Whatever is fed, nothing panics, an ending stays, and a settled cycle has finite numbers.
    #[test]
    fn any_input(samples in prop::collection::vec((any::<f64>(), any::<f64>()), 0..300), hysteresis in 0.0_f64..10.0) {
        let base = settings(run(2.0, 1.5, 1e-3, 0.2), IDEAL);
        let detector = LimitCycleDetector::new(DetectorSettings { hysteresis, max_error: f64::INFINITY, ..base }).unwrap();
        let mut state = detector.start();
        let mut ended = None;
        for (error, drive) in samples {
            let outcome = detector.push(&mut state, error, drive);
            // NaN is not equal to itself, so the endings are compared as text.
            let same = format!("{ended:?}") == format!("{outcome:?}");
            prop_assert!(ended.is_none() || same);
            ended = outcome;
            if let Some(RelayOutcome::Settled(cycle)) = outcome {
                prop_assert!(cycle.period_s.is_finite() && cycle.amplitude.is_finite());
            }
        }
    }

    /// Mirrored errors give the mirrored drive, once both relays have left their common start.
    #[test]
    fn relay_is_odd(errors in prop::collection::vec(-1000_i32..1000, 1..200), hysteresis in 0_u32..20) {
        let relay = DualRelay::new(200, 150, hysteresis).unwrap();
        let (mut one, mut other) = (DualRelayState::new(), DualRelayState::new());
        // Forth and back beyond every band, so that both relays switch in both states.
        relay.tick(&mut one, -100);
        relay.tick(&mut other, 100);
        relay.tick(&mut other, 0);
        relay.tick(&mut one, 0);
        for error in errors {
            prop_assert_eq!(relay.tick(&mut one, error), -relay.tick(&mut other, -error));
        }
    }
}
