//! Our estimators and the papers' formulas on relay experiments of the hidden plant. `friction FOLDER FIRST LAST`
//! writes the recordings of drive and position (`friction.csv`, `friction.bin`), which `bench/peers/friction.py` reads.
//! It also writes the estimates of both (`friction_ours.csv`).

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, anyhow};
use breakaway::identify::estimate::identify;
use breakaway::recording::Recording;
use breakaway_bench::{timed, write_numbers};
use breakaway_core::estimate::sine::{FrequencySearch, SineModel, even, fit_free};
use breakaway_hidden::{Case, Experiment, Record};
use breakaway_tests::blind::recording;
use breakaway_tests::papers::{PaperEstimate, RelayExperiment, equation_17, memo_listing};

/// The relay's amplitudes and the settled cycle's fundamental, as the papers' formulas want them.
fn experiment(record: &Record) -> Result<RelayExperiment<f64>> {
    let levels = record.u.iter().map(|u| u.abs());
    let (high, low) = levels.fold((0.0_f64, f64::INFINITY), |(high, low), u| (high.max(u), low.min(u)));
    // The relay on the error is the larger one.
    let (h1, h2) = (0.5 * (high + low), 0.5 * (high - low));
    let from = record.u.len() / 2;
    let ts = (record.t[record.t.len() - 1] - record.t[0]) / (record.t.len() - 1) as f64;
    let (u, x) = (&record.u[from..], &record.x[from..]);
    let edges: Vec<usize> = (1..u.len()).filter(|&k| u[k - 1] < 0.0 && u[k] > 0.0).collect();
    let (first, last) = (edges.first().context("no cycle")?, edges.last().context("no cycle")?);
    let omega = TAU * (edges.len() - 1) as f64 / ((last - first) as f64 * ts);
    let model = SineModel { third: true, ..SineModel::default() };
    let fit = fit_free(even(x, 0.0, ts), FrequencySearch::between(0.9 * omega, 1.1 * omega), model)
        .map_err(|error| anyhow!("{}: {error:?}", record.name))?;
    Ok(RelayExperiment { h1, h2, a: fit.amplitude, omega: fit.omega_rad_s })
}

/// (b, c, f1) of the papers' Kp, Tp, f1.
fn of_paper(estimate: PaperEstimate<f64>) -> [f64; 3] {
    [estimate.tp / estimate.kp, 1.0 / estimate.kp, estimate.f1]
}

/// The describing function's three equations, corrected (docs/theory.md, section 4): two experiments, solved by hand.
fn corrected(e: [RelayExperiment<f64>; 2]) -> [f64; 3] {
    let b = e.map(|e| 4.0 * e.h1 / (PI * e.a * e.omega * e.omega)).iter().sum::<f64>() / 2.0;
    let s = e.map(|e| PI * e.a * e.omega / 4.0);
    let c = (e[0].h2 - e[1].h2) / (s[0] - s[1]);
    [b, c, e[0].h2 - s[0] * c]
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, first, last] = arguments.as_slice() else { anyhow::bail!("friction FOLDER FIRST LAST") };
    let folder = PathBuf::from(folder);
    let mut numbers = Vec::new();
    let mut list = String::from("seed,samples_1,samples_2,encoder_step,noise,b,c,f1\n");
    let mut rows = String::from("seed,estimator,b,c,f1,seconds\n");
    for seed in first.parse::<u64>()?..=last.parse()? {
        let case = Case::new(seed, &[], 10.0, Experiment::Relay)?;
        let (session, truth) = case.generate_with_truth();
        let named = |name: &str| session.records.iter().find(|r| r.name == name).with_context(|| name.to_owned());
        let records = [named("relay_high")?, named("relay_low")?, named("relay_mid")?];
        let base = truth.base;
        let [n1, n2] = [records[0].t.len(), records[1].t.len()];
        let (step, noise) = (session.encoder_step, session.noise_sigma);
        writeln!(list, "{seed},{n1},{n2},{step},{noise},{},{},{}", base.b, base.c, base.f1)?;
        for record in &records[..2] {
            numbers.extend_from_slice(&record.u);
            numbers.extend_from_slice(&record.x);
        }
        let mut put = |estimator: &str, [b, c, f1]: [f64; 3], seconds: f64| {
            writeln!(rows, "{seed},{estimator},{b:e},{c:e},{f1:e},{seconds:e}")
        };
        let two: Vec<Recording> = records[..2].iter().map(|record| recording(&session, record)).collect();
        let (found, seconds) = timed(1, || identify(&two));
        match found {
            Ok(found) => {
                for e in &found.estimates {
                    put(e.estimator, [e.b.value, e.c.value, e.f1.value], seconds)?;
                }
                let best = &found.best;
                put("best", [best.b.value, best.c.value, best.f1.value], seconds)?;
            }
            Err(error) => eprintln!("seed {seed}: {error}"),
        }
        let cycles = records.map(experiment);
        if let [Ok(high), Ok(low), Ok(mid)] = cycles {
            put("equation 17", of_paper(equation_17(high, low)), 0.0)?;
            put("memo listing", of_paper(memo_listing([high, mid, low])), 0.0)?;
            put("corrected formulas", corrected([high, low]), 0.0)?;
        } else {
            eprintln!("seed {seed}: no limit cycle to read the formulas' numbers from");
        }
    }
    write_numbers(&folder.join("friction.bin"), &numbers)?;
    fs::write(folder.join("friction.csv"), list)?;
    fs::write(folder.join("friction_ours.csv"), rows)?;
    Ok(())
}
