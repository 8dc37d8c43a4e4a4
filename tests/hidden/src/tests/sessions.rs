//! Cases, sessions and files.

use super::close;
use crate::{Case, Experiment, Hidden, Role, TruthRecord, law::ForceLaw, plant::TS};

/// Shaft position at which the encoder reads y (fixed point of a contraction, A ≤ 0.5).
pub fn shaft(law: &ForceLaw, y: f64) -> f64 {
    let mut x = y;
    for _ in 0..100 {
        x -= law.encoder(x) - y;
    }
    x
}

#[test]
fn same_case_same_bytes() {
    let case = Case::suite(3, &["cogging", "delay"], 10.0).unwrap();
    let text = |case: &Case| {
        let (session, truth) = case.generate_with_truth();
        let records: String = session.records.iter().map(|r| session.csv(r)).collect();
        let traces: String = truth.records.iter().map(TruthRecord::csv).collect();
        (records, truth.to_text() + &traces)
    };
    assert_eq!(text(&case), text(&case));
    let other = Case { seed: 4, ..case.clone() };
    assert_ne!(text(&case), text(&other));
}

#[test]
fn one_seed_is_one_machine() {
    let clean = Case::suite(8, &["none"], 10.0).unwrap().generate_with_truth();
    let stuck = Case::suite(8, &["stiction"], 10.0).unwrap().generate_with_truth();
    assert_eq!(clean.1.base, stuck.1.base);
    assert_eq!(clean.0.encoder_step, stuck.0.encoder_step);
    assert_ne!(clean.0.records, stuck.0.records);
}

#[test]
fn clean_case_has_no_gap() {
    for seed in 20..24 {
        let (session, truth) = Case::suite(seed, &[], 10.0).unwrap().generate_with_truth();
        // Only the pilots' coarser sub-steps separate the two: far below the noise.
        assert!(truth.effects.is_empty() && truth.visibility < 0.05, "{}", truth.visibility);
        assert!(truth.gap_peak_percent < 0.02, "{}", truth.gap_peak_percent);
        let measured = truth.own_error(&session, Role::Score);
        // 20000 samples of one noise: 0.5 % standard error of its RMS.
        close(measured / truth.noise_floor, 1.0, 0.03);
    }
}

#[test]
fn suite_is_the_specified_one() {
    let (session, truth) = Case::suite(1, &["gravity_load"], 3.0).unwrap().generate_with_truth();
    let seconds = |role: Role| -> f64 {
        let lengths = session.records.iter().filter(|r| r.role == role).map(|r| r.t.len());
        lengths.sum::<usize>() as f64 * TS
    };
    close(seconds(Role::Fit), 40.0, 1e-9);
    close(seconds(Role::Score), 20.0, 1e-9);
    let mut last = -1.0;
    for (record, exact) in session.records.iter().zip(&truth.records) {
        assert_eq!(record.name, exact.name);
        for (t, x) in record.t.iter().zip(&record.x) {
            assert!(*t > last);
            last = *t;
            let counts = x / session.encoder_step;
            close(counts, counts.round(), 1e-6);
        }
        assert!(record.u.iter().all(|u| u.abs() <= session.drive_limit));
    }
}

#[test]
fn single_experiments_move() {
    for which in [Experiment::Relay, Experiment::Multisine, Experiment::Track, Experiment::SlowSine] {
        for name in ["none", "stiction", "delay", "backlash"] {
            let case = Case::new(11, &[name], 10.0, which).unwrap();
            let (session, truth) = case.generate_with_truth();
            for (record, exact) in session.records.iter().zip(&truth.records) {
                let speed = exact.v.iter().map(|v| v.abs()).sum::<f64>() / exact.v.len() as f64;
                assert!(speed > 0.1, "{which:?} {name} {}: {speed}", record.name);
                assert!(exact.x.iter().all(|x| x.abs() < 100.0), "{which:?} {name}");
            }
        }
    }
}

#[test]
fn relay_cycles_survive_a_large_load() {
    // The relays are sized from the break-away force found on the plant with its effect: in the last
    // two seconds they still switch.
    for name in ["constant_load", "stribeck", "dead_zone", "cogging"] {
        let session = Case::suite(6, &[name], 30.0).unwrap().generate();
        for record in session.records.iter().filter(|r| r.name.starts_with("relay")) {
            let tail = &record.u[record.u.len() - 2000..];
            let edges = tail.windows(2).filter(|w| w[0] != w[1]).count();
            assert!(edges >= 2, "{name} {}: {edges}", record.name);
        }
    }
}

#[test]
fn names() {
    assert_eq!(Hidden::named("none"), Ok(Hidden::None));
    assert_eq!(Hidden::named("dahl"), Ok(Hidden::Catalogue("dahl")));
    assert_eq!(Hidden::named("force_well"), Ok(Hidden::Outside("force_well")));
    assert!(Case::suite(0, &["dhal"], 3.0).is_err());
}
