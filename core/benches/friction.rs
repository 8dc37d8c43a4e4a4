//! Prints the table of docs/theory.md, section 4 (RMS error of each estimator by encoder step and noise) and the
//! throughput of the streaming estimator.

#[path = "../../tests/src/papers.rs"]
mod papers;
#[path = "../tests/all/support/mod.rs"]
mod support;

use breakaway_core::estimate::describing_function::{CycleFit, describing_function};
use breakaway_core::estimate::modulating::{Modulating, estimate};
use breakaway_core::scalar::SolverReal;
use papers::{RelayExperiment, equation_17, memo_listing};
use std::f64::consts::TAU;
use std::time::Instant;
use support::{Cycle, REFERENCE, Record, Sensor, experiment};

const TS: f64 = 1e-3;
const CYCLES: [Cycle; 3] = [
    Cycle { h1: 2.0, h2: 1.5, period: 0.723195 },
    Cycle { h1: 1.0, h2: 0.7, period: 0.288730 },
    Cycle { h1: 2.5, h2: 2.0, period: 0.871073 },
];
const RUNS: u64 = 40;

fn main() {
    println!("RMS error in % of (b / c / f1), (2, 1.5) and (1, 0.7), Ts = 1 ms, 20 cycles, {RUNS} runs");
    println!("(memo_listing takes (2.5, 2) as its third experiment; c is 1/Kp and b is Tp/Kp)");
    for (q, sigma) in [(1e-4, 1e-4), (1e-3, 1e-3), (5e-3, 2e-3)] {
        table(Sensor { q, sigma });
    }
    throughput::<f32>("f32");
    throughput::<f64>("f64");
}

fn table(sensor: Sensor) {
    println!("\nq = {}, σ = {}", sensor.q, sensor.sigma);
    let mut names: Vec<String> = Vec::new();
    let mut squares: Vec<[f64; 3]> = Vec::new();
    for seed in 0..RUNS {
        let records: Vec<Record> = CYCLES
            .iter()
            .enumerate()
            .map(|(k, &cycle)| experiment(REFERENCE, cycle, 20.0, sensor, seed + 1000 * k as u64))
            .collect();
        for (row, (name, found)) in estimators(&records).into_iter().enumerate() {
            if row == names.len() {
                names.push(name);
                squares.push([0.0; 3]);
            }
            for ((square, value), truth) in squares[row].iter_mut().zip(found).zip([0.02685, 0.11, 0.5]) {
                *square += (value / truth - 1.0).powi(2) / RUNS as f64;
            }
        }
    }
    for (name, square) in names.iter().zip(&squares) {
        let [b, c, f1] = square.map(|value| 100.0 * value.sqrt());
        println!("{name:24} {b:8.3} / {c:7.3} / {f1:7.3}");
    }
}

fn estimators(records: &[Record]) -> Vec<(String, [f64; 3])> {
    let fits: Vec<CycleFit<f64>> =
        records.iter().zip(CYCLES).map(|(record, cycle)| fundamental(record, cycle)).collect();
    let paper = |k: usize| RelayExperiment { h1: fits[k].h1, h2: fits[k].h2, a: fits[k].a, omega: fits[k].omega };
    let of_paper = |kp: f64, tp: f64, f1: f64| [tp / kp, 1.0 / kp, f1];
    let eq17 = equation_17(paper(0), paper(1));
    let memo = memo_listing([paper(0), paper(2), paper(1)]);
    let mut rows = vec![
        ("equation_17".into(), of_paper(eq17.kp, eq17.tp, eq17.f1)),
        ("memo_listing".into(), of_paper(memo.kp, memo.tp, memo.f1)),
        ("describing_function".into(), describing_function(&fits[..2]).unwrap().parameters),
    ];
    for width in [0.01, 0.02, 0.03] {
        let states = [0, 1].map(|k| {
            let estimator = configuration::<f64>(CYCLES[k].period, width);
            let mut state = estimator.start();
            for (&x, &u) in records[k].x.iter().zip(&records[k].u) {
                estimator.push(&mut state, x, u);
            }
            state
        });
        let fit = estimate(&[states[0].blocks(), states[1].blocks()]).unwrap();
        rows.push((format!("modulating, d = {width} T"), [fit.b, fit.c, fit.f1]));
    }
    rows
}

fn configuration<R: SolverReal>(period: f64, width: f64) -> Modulating<R> {
    let window = (2.0 * period / TS).round() as u32;
    let half_width = (width * period / TS).round() as usize;
    Modulating::new(R::from_f64(TS), window, half_width, [2], R::ZERO).unwrap()
}

/// Frequency and amplitude of the second half's fundamental: phase advance of a Hann-weighted demodulation, then
/// demodulation at the frequency found.
fn fundamental(record: &Record, cycle: Cycle) -> CycleFit<f64> {
    let x = &record.x[record.x.len() / 2..];
    let half = x.len() / 2;
    let mut omega = TAU / cycle.period;
    let demodulate = |omega: f64, start: usize| {
        let (mut re, mut im, mut norm) = (0.0, 0.0, 0.0);
        for k in 0..half {
            let weight = 0.5 - 0.5 * (TAU * k as f64 / half as f64).cos();
            let phase = omega * TS * (start + k) as f64;
            re += weight * x[start + k] * phase.cos();
            im -= weight * x[start + k] * phase.sin();
            norm += weight;
        }
        (2.0 * re / norm, 2.0 * im / norm)
    };
    // The hysteresis lengthens the period: find the peak first, in steps of a quarter of the resolution.
    let step = TAU / (4.0 * half as f64 * TS);
    let mut peak = 0.0;
    for k in 0..200 {
        let candidate = 0.6 * TAU / cycle.period + step * f64::from(k);
        let (re, im) = demodulate(candidate, 0);
        if candidate < 1.2 * TAU / cycle.period && re.hypot(im) > peak {
            (peak, omega) = (re.hypot(im), candidate);
        }
    }
    for _ in 0..5 {
        let (first, second) = (demodulate(omega, 0), demodulate(omega, half));
        let turn = (second.1 * first.0 - second.0 * first.1).atan2(second.0 * first.0 + second.1 * first.1);
        omega += turn / (half as f64 * TS);
    }
    let (re, im) = demodulate(omega, half / 2);
    CycleFit { h1: cycle.h1, h2: cycle.h2, a: re.hypot(im), omega, a_error: 0.0, omega_error: 0.0 }
}

fn throughput<R: SolverReal>(name: &str) {
    let record = experiment(REFERENCE, CYCLES[0], 20.0, Sensor { q: 1e-3, sigma: 1e-3 }, 1);
    let samples: Vec<(R, R)> =
        record.x.iter().zip(&record.u).map(|(&x, &u)| (R::from_f64(x), R::from_f64(u))).collect();
    let estimator = configuration::<R>(CYCLES[0].period, 0.01);
    let mut state = estimator.start();
    // The best of many short rounds: the machine may be shared.
    let mut best = f64::INFINITY;
    for _ in 0..400 {
        let start = Instant::now();
        for &(x, u) in &samples {
            estimator.push(&mut state, x, u);
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    let windows = std::hint::black_box(&state).blocks()[0].windows();
    let rate = samples.len() as f64 * 1e-6 / best;
    println!("\nmodulating push, {name}: {rate:.1} M samples/s ({windows} windows)");
}
