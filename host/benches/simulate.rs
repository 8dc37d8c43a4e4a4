//! Prints how long a limit cycle and an identification take.
//!
//! The event-exact simulator against scipy's `solve_ivp` with events on the same limit cycle (asked: at least 50
//! times faster; needs `python3` with scipy). Also `identify` on the EMPS recording (asked: under 0.5 s; needs the
//! recordings).

use std::hint::black_box;
use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use breakaway::identify::estimate::identify;
use breakaway::recording::{ReadOptions, Recording};
use breakaway::simulate::limit_cycle::exact_cycle;
use breakaway_core::plant::Base;

/// The papers' plant (docs/theory.md, section 1).
const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
const RELAY: (f64, f64) = (2.0, 1.5);

fn main() {
    limit_cycle();
    emps();
}

/// The fastest of `repeats` runs, s.
fn best(repeats: usize, mut run: impl FnMut()) -> f64 {
    (0..repeats)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

fn limit_cycle() {
    let (h1, h2) = RELAY;
    let cycle = match exact_cycle(BASE, 0.0, h1, h2) {
        Ok(cycle) => cycle,
        Err(reason) => return println!("{reason}"),
    };
    let exact_s = best(200, || {
        let _ = black_box(exact_cycle(black_box(BASE), 0.0, h1, h2));
    });
    println!(
        "limit cycle ({h1}, {h2}), {} cycles, event-exact: {:.1} µs; T = {:.7} s, peak {:.7}",
        cycle.cycles,
        1e6 * exact_s,
        cycle.period_s,
        cycle.peak
    );
    match scipy(cycle.cycles) {
        Ok([scipy_s, period, peak]) => {
            println!(
                "scipy solve_ivp, rtol 1e-8, as many cycles: {:.1} ms; T off by {:.1e}, peak by {:.1e} (relative)",
                1e3 * scipy_s,
                period / cycle.period_s - 1.0,
                peak / cycle.peak - 1.0
            );
            println!("ratio: {:.0} times faster (asked: 50)", scipy_s / exact_s);
        }
        Err(reason) => println!("NOT COMPARED with scipy: {reason}"),
    }
}

/// Seconds, period and peak by the script beside this file.
fn scipy(cycles: usize) -> Result<[f64; 3], String> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/limit_cycle.py");
    let output = Command::new("python3")
        .args([script, &RELAY.0.to_string(), &RELAY.1.to_string(), &cycles.to_string(), "5"])
        .output()
        .map_err(|error| format!("python3: {error}"))?;
    if !output.status.success() {
        let error = String::from_utf8_lossy(&output.stderr);
        return Err(error.lines().last().unwrap_or("it failed").to_owned());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    numbers.try_into().map_err(|_| format!("it printed {text}"))
}

fn emps() {
    let folder = std::env::var_os("BREAKAWAY_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")), PathBuf::from);
    let path = folder.join("emps/emps_train.csv");
    let options = ReadOptions {
        time: Some("t_s".into()),
        input: Some("u_V".into()),
        position: Some("x_m".into()),
        ..ReadOptions::default()
    };
    if let Err(error) = Recording::read(&path, &options) {
        println!("identify on EMPS NOT RUN: {error}");
        return;
    }
    let read_s = best(5, || {
        let _ = black_box(Recording::read(&path, &options));
    });
    let both_s = best(5, || {
        let recording = Recording::read(&path, &options);
        let _ = black_box(recording.map(|recording| identify(&[recording])));
    });
    println!("identify on EMPS (24 841 rows): {both_s:.3} s, of which reading {read_s:.3} s (asked: 0.5)");
}
