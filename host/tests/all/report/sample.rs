//! Discoveries made by hand: one explained by two effects, one unknown.

use breakaway::discover::outcome::{
    CandidateRow, Discovery, NamedEffect, NextExperiment, Overlay, ParameterValue, Provenance, Rival, Rung, Verdict,
    WhereRow,
};
use breakaway::fit::Candidate;
use breakaway::recording::Units;
use breakaway::simulate::experiment::{Excitation, Experiment, Sensor};
use breakaway_core::plant::{Base, Kind};

const HASH: &str = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08";

fn parameter(symbol: &'static str, unit: &str, meaning: &'static str, value: f64, se: f64) -> ParameterValue {
    ParameterValue { symbol, unit: unit.into(), meaning, value, se }
}

fn rung(effects: &[Kind], errors: [f64; 3]) -> Rung {
    let [fit_rmse, holdout_rmse, holdout_open_loop_rmse] = errors;
    let base = Base { b: 0.026_85, c: 0.1102, f1: 0.4987 };
    Rung {
        effects: effects.to_vec(),
        base,
        fit_rmse,
        holdout_rmse,
        holdout_open_loop_rmse,
        force_residual: Some([0.05, 0.051]),
        drive_free_rmse: Some(0.08),
    }
}

fn candidate(kind: Kind, numbers: [f64; 3], fate: &str) -> CandidateRow {
    let [delta, z, lambda] = numbers;
    CandidateRow { kind, delta, z, lambda, fate: fate.into() }
}

/// 31 bins over −3..3; algebraic, so that every machine gives the same digits.
fn curve(shape: impl Fn(f64) -> f64) -> Vec<[f64; 3]> {
    (0..31).map(|i| f64::from(i) / 5.0 - 3.0).map(|v| [v, shape(v), 0.006 + 0.004 * v.abs() / 3.0]).collect()
}

fn row(coordinate: &'static str, unit: &str, shares: [f64; 2], shape: impl Fn(f64) -> f64) -> WhereRow {
    let small = curve(|v| 0.004 * (v * 7.0).fract());
    let unit = unit.into();
    WhereRow { coordinate, unit, r2: shares[0], r2_after: shares[1], curve: curve(shape), curve_after: small }
}

/// A relay's cycles at 1 kHz whose models drift away and stay close.
fn overlay(title: &str, after: bool) -> Overlay {
    let t: Vec<f64> = (0..4000).map(|i| 36.0 + f64::from(i) * 1e-3).collect();
    let mut noise = 12_345_u64;
    let mut random = || {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (noise >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    let cycle = |t: f64| (8.7 * t).sin() + 0.04 * (26.1 * t).sin();
    let within = |t: f64| (t - 36.0).fract();
    Overlay {
        title: title.into(),
        measured: t.iter().map(|t| cycle(*t) + 0.002 * random()).collect(),
        before: t.iter().map(|t| cycle(t - 0.05 * within(*t)) + 0.11 * within(*t).powi(2)).collect(),
        after: if after { t.iter().map(|t| cycle(*t) + 0.012 * within(*t).powi(2)).collect() } else { Vec::new() },
        u: t.iter().map(|t| 2.0 * (8.7 * t).sin().signum() + 1.5 * (8.7 * t).cos().signum()).collect(),
        t,
    }
}

/// Two effects named, one of them tied with another, down to the noise.
pub fn explained() -> Discovery {
    Discovery {
        verdict: Verdict::Explained,
        force: None,
        effects: vec![
            NamedEffect {
                kind: Kind::Stribeck,
                parameters: vec![
                    parameter("s", "V", "rise of friction towards rest", 0.2031, 0.0042),
                    parameter("vs", "rad/s", "Stribeck velocity", 0.487, 0.021),
                    parameter("p", "1", "exponent", 2.0, f64::NAN),
                ],
                rivals: vec![
                    Rival { kind: Kind::Stiction, delta: 0.012, z: 0.9, tied: true },
                    Rival { kind: Kind::LuGre, delta: 0.21, z: 5.4, tied: false },
                    Rival { kind: Kind::QuadraticDrag, delta: 1.37, z: 14.2, tied: false },
                ],
            },
            NamedEffect {
                kind: Kind::Cogging,
                parameters: vec![
                    parameter("A", "V", "amplitude", 0.0512, 0.0011),
                    parameter("n", "cycles/rad", "wave number", 7.0002, 0.0004),
                    parameter("phi", "rad", "phase", -1.31, 0.02),
                ],
                rivals: Vec::new(),
            },
        ],
        ladder: vec![
            rung(&[], [0.0093, 0.0101, 0.0442]),
            rung(&[Kind::Stribeck], [0.0021, 0.0024, 0.0079]),
            rung(&[Kind::Stribeck, Kind::Cogging], [5.4e-4, 5.6e-4, 0.0023]),
        ],
        model: Candidate { base: Base { b: 0.02685, c: 0.11, f1: 0.5 }, effects: Vec::new() },
        model_se: Vec::new(),
        base_se: [2.1e-5, 3.4e-4, 0.0018],
        noise_floor: 5.2e-4,
        where_map: vec![
            row("velocity", "rad/s", [0.71, 0.02], |v| -0.2 * v / (0.1 + v * v * v * v) * 0.4),
            row("position × direction", "rad", [0.24, 0.01], |v| 0.05 * (v - v.round())),
            row("time since reversal", "s", [0.22, -0.01], |v| 0.03 * v),
            row("position", "rad", [0.11, 0.0], |v| 0.01 * v),
            row("drive level", "V", [0.03, 0.01], |_| 0.0),
        ],
        candidates: vec![
            candidate(Kind::Stribeck, [1.92, 18.3, 214.0], "named"),
            candidate(Kind::Stiction, [1.908, 18.1, 211.0], "tied with Stribeck friction"),
            candidate(Kind::LuGre, [1.71, 15.0, 180.0], "lost: more parameters and a worse simulation"),
            candidate(Kind::QuadraticDrag, [0.55, 7.1, 61.0], "lost: does not reach the gap below 0.5 rad/s"),
            candidate(Kind::Backlash, [f64::NAN, f64::NAN, f64::NAN], "could not be fitted: no gap above the noise"),
        ],
        overlays: vec![overlay("relay_mid, 36 s to 40 s", true), overlay("multisine_2, 42 s to 46 s", true)],
        next_experiment: Some(NextExperiment {
            experiment: Experiment {
                name: "next".into(),
                tick_s: 1e-3,
                duration_s: 20.0,
                seed: 7,
                drive_limit: f64::INFINITY,
                travel_limit: 5.0,
                excitation: Excitation::Sine { amplitude: 0.62, frequency_hz: 0.1, centring: 0.0 },
                sensor: Sensor::default(),
            },
            separates: vec![Kind::Stribeck, Kind::Stiction],
            difference_over_noise: 23.4,
        }),
        nearest: None,
        remarks: vec![
            "c is Ke + f2: back-EMF and viscous friction act alike and position data cannot split them".into(),
        ],
        units: Units { u: "V".into(), x: "rad".into() },
        segments: (100, 100),
        seconds: 2.4,
        provenance: Provenance {
            inputs: vec![("fit/relay_high.csv".into(), HASH.into()), ("score/relay_mid.csv".into(), HASH.into())],
            version: "0.1.0".into(),
            command: "breakaway discover --model base.toml fit/*.csv --holdout score/*.csv -o improved.toml".into(),
        },
    }
}

/// A gap that nothing in the catalogue explains; a file name that must be escaped.
pub fn unknown() -> Discovery {
    Discovery {
        verdict: Verdict::Unknown,
        force: None,
        effects: Vec::new(),
        ladder: vec![rung(&[], [0.0093, 0.0101, 0.0442])],
        where_map: vec![
            row("position", "rad", [0.63, 0.63], |v| 0.2 / (1.0 + 40.0 * (v - 1.2) * (v - 1.2))),
            row("velocity", "rad/s", [-0.02, -0.02], |v| 0.01 * v),
        ],
        candidates: vec![candidate(Kind::GravityLoad, [0.03, 1.1, 4.0], "lost: below the threshold")],
        overlays: vec![overlay("relay_mid, 36 s to 40 s", false)],
        next_experiment: None,
        nearest: None,
        remarks: Vec::new(),
        provenance: Provenance {
            inputs: vec![("a <b> & \"c\".csv".into(), HASH.into())],
            version: "0.1.0".into(),
            command: String::new(),
        },
        ..explained()
    }
}
