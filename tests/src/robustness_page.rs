//! `docs/robustness.md`, written by the example `robustness`.

use std::fmt::Write as _;

use crate::drift::Trial;
use crate::robustness::{COUNTS, Outcome, Random, Verdict, plants, try_plant};

/// Plants in the table.
const PLANTS: usize = 200;
/// Hours of running without a change, each with a noise of its own.
const HOURS: u64 = 10;
/// Trials of a rise of friction.
const RISES: u64 = 200;

/// A number of an outcome.
type Column = fn(&Outcome) -> f64;

/// The page; some seconds of work in an optimised build.
pub fn page() -> String {
    let outcomes: Vec<(Random, Outcome)> = plants(PLANTS).into_iter().map(|plant| (plant, try_plant(&plant))).collect();
    let mut out = String::from(
        "# Robustness

Written by `cargo run --release -p breakaway-tests --example robustness -- docs/robustness.md`. Nothing here is a bound that was proved: it is what came out of simulation.

## Two hundred random plants

",
    );
    // Here and below, writing to a String cannot fail.
    let _ = writeln!(
        out,
        "b in 0.002–0.2 V·s²/rad, c in 0.01–1 V·s/rad, f1 in 0.02–2 V (log-uniform), 500–20 000 counts per turn with noise of 0.2 counts, 0–2 ticks of 1 ms of delay, and in six of eight plants one effect at 5–30 % of f1
(cogging, Stribeck, position friction, constant load, gravity, spring). The controller is tuned for b, c and f1 that are each off by up to 10 %, at the default bandwidth (a quarter of the largest that tick and
delay allow), runs in f32, and has the compensator **on**, drive limited to 1.5 times what a sine of 1 rad at 0.5 Hz needs. Three trials each:

1. *stable*: 8 s of the sine; the error does not grow;
2. *still*: an S-curve, then 4 s of rest; in the last 2 s the true position moves by at most {COUNTS} counts, peak to peak;
3. *saturation*: a move that asks for ten times the drive, then 15 s; the error is back within {COUNTS} counts.
"
    );
    let count = |verdict: Verdict| outcomes.iter().filter(|(_, outcome)| outcome.verdict == verdict).count();
    out.push_str("| | plants |\n|---|---|\n");
    for (name, verdict) in [
        ("passed all three", Verdict::Passed),
        ("not stable", Verdict::Unstable),
        ("not still at rest", Verdict::LimitCycle),
        ("not back after saturation", Verdict::Saturation),
    ] {
        let _ = writeln!(out, "| {name} | {} |", count(verdict));
    }
    out.push_str("\n| | median | 90 % | worst |\n|---|---|---|---|\n");
    let columns: [(&str, Column); 4] = [
        ("tracking error, counts rms", |o| o.rms_counts),
        ("movement at rest, counts", |o| o.rest_counts),
        ("error after saturation, counts", |o| o.left_counts),
        ("ticks saturated in trial 3, %", |o| 100.0 * o.saturated),
    ];
    for (name, value) in columns {
        let mut values: Vec<f64> = outcomes.iter().map(|(_, o)| value(o)).filter(|v| v.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
        let _ = writeln!(out, "| {name} | {:.2} | {:.2} | {:.2} |", at(0.5), at(0.9), at(1.0));
    }
    failures(&mut out, &outcomes);
    drift(&mut out);
    out
}

fn failures(out: &mut String, outcomes: &[(Random, Outcome)]) {
    let failed: Vec<_> = outcomes.iter().filter(|(_, outcome)| outcome.verdict != Verdict::Passed).collect();
    if failed.is_empty() {
        out.push_str("\nNo plant failed.\n");
        return;
    }
    out.push_str(
        "
The failures:

| plant | b | c | f1 | effect | counts per turn | delay | what | at rest, counts | after saturation, counts |
|---|---|---|---|---|---|---|---|---|---|
",
    );
    for (plant, outcome) in failed {
        let effect = plant.effect.map_or("none", |effect| effect.kind.name());
        let _ = writeln!(
            out,
            "| {} | {:.4} | {:.4} | {:.4} | {effect} | {} | {} | {:?} | {:.2} | {:.2} |",
            plant.number,
            plant.base.b,
            plant.base.c,
            plant.base.f1,
            plant.counts,
            plant.delay_ticks,
            outcome.verdict,
            outcome.rest_counts,
            outcome.left_counts
        );
    }
    out.push_str(
        "
What \"not back\" is, where the count is a few: the axis stands within friction, and the integral needs b·Kv·Λ1·∫e = f1 to break it away. Where f1 is large for b (the bandwidth is bounded by the tick, so the stiffness
b·Kv·Λ2 is bounded by b) that takes longer than the 15 s. A saturating move on an axis with little damping comes back in swings that decay slowly: give references that the drive can follow.
",
    );
}

fn drift(out: &mut String) {
    let mut alarms = 0;
    for seed in 0..HOURS {
        alarms += Trial::papers(3600.0, seed).alarms().len();
    }
    let mut delays: Vec<f64> = (0..RISES)
        .map(|seed| {
            // Changes at every phase of the sine's 2 s.
            let change_s = 40.0 + 2.0 * seed as f64 / RISES as f64;
            let trial = Trial { factor: 1.3, change_s, seconds: 50.0, ..Trial::papers(0.0, 1000 + seed) };
            trial.alarms().first().map_or(f64::INFINITY, |(t, _)| t - change_s)
        })
        .collect();
    delays.sort_by(f64::total_cmp);
    let _ = write!(
        out,
        "
## The drift watch

The papers' plant (b .02685, c .11, f1 .5), a PID following 1 rad at 0.5 Hz, 8000 counts per turn with noise of a third of a count, a tick of 1 ms, the usual settings at 60 rad/s.

| | |
|---|---|
| false alarms in {HOURS} h without a change | {alarms} |
| f1 up by 30 %, at {RISES} phases of the sine: found within, median | {:.2} s |
| … 95 % | {:.2} s |
| … worst | {:.2} s |

On other plants, the same settings and a rise of 30 % at 40 s (one trial each, {} plants of the table above; \"not found\" within 10 s where 30 % of f1 is below what encoder and inertia show):

| | plants |
|---|---|
",
        delays[delays.len() / 2],
        delays[delays.len() * 95 / 100],
        delays[delays.len() - 1],
        PLANTS / 4
    );
    let (mut soon, mut late, mut never, mut falsely) = (0, 0, 0, 0);
    for plant in plants(PLANTS).iter().step_by(4) {
        let trial =
            Trial { base: plant.base, counts: plant.counts, factor: 1.3, change_s: 40.0, ..Trial::papers(50.0, 7) };
        match trial.alarms().first() {
            Some((t, _)) if *t < 40.0 => falsely += 1,
            Some((t, _)) if *t < 42.0 => soon += 1,
            Some(_) => late += 1,
            None => never += 1,
        }
    }
    for (name, number) in
        [("found within 2 s", soon), ("found later", late), ("not found", never), ("false alarm before", falsely)]
    {
        let _ = writeln!(out, "| {name} | {number} |");
    }
}
