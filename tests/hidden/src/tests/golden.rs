//! The kind world's bytes, which nothing may change: docs/blind.md's rows are of these recordings.

use crate::{Case, Experiment};

/// FNV-1a, 64 bits.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, byte| (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Seed, effects, experiment, and the hash of the session's files: taken at commit 7fa3483, before there was any other world.
const CASES: [(u64, &[&str], Experiment, u64); 10] = [
    (3, &["cogging", "delay"], Experiment::Suite, 0x93b7_315d_7dd9_b752),
    (4, &["backlash"], Experiment::Suite, 0xfadd_6e0a_9b05_cf36),
    (5, &["inertia_step", "lugre"], Experiment::Suite, 0xc396_bf00_0b70_a003),
    (6, &["dahl", "encoder_eccentricity"], Experiment::Suite, 0xfc2f_04c6_3118_df0e),
    (7, &["electrical_lag", "quadratic_drag", "gain_drift"], Experiment::Suite, 0x7030_db32_af61_b8dd),
    (8, &["delay", "torque_bursts"], Experiment::Track, 0x3010_5c81_cd7d_46a0),
    (9, &["flexible_coupling", "spring"], Experiment::Relay, 0xffa7_23b3_2487_7212),
    (10, &["stiction", "pwm_dead_time", "delay"], Experiment::Multisine, 0x4315_8666_901c_90a6),
    (11, &[], Experiment::Suite, 0x91c7_9f0e_3914_8dd0),
    (12, &["asymmetric_viscous", "delay"], Experiment::SlowSine, 0xd16f_a38c_9241_672a),
];

#[test]
fn the_kind_world_keeps_its_bytes() {
    for (seed, effects, experiment, expected) in CASES {
        let session = Case::new(seed, effects, 10.0, experiment).unwrap().generate();
        let files: String = session.records.iter().map(|r| session.csv(r)).collect();
        assert_eq!(hash(&files), expected, "{seed} {effects:?} {experiment:?}");
    }
}
