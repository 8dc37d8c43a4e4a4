//! `docs/robustness.md`, written by the example `robustness`.

use std::fmt::Write as _;

use crate::drift::Trial;
use crate::markdown::wrapped;
use crate::robustness::{COUNTS, Outcome, Random, TrialResult, plants, try_plant};

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

Written by `cargo run --release -p breakaway-tests --example robustness -- docs/robustness.md`. Nothing here is a proved bound: all numbers are results of simulation.

## Two hundred random plants

",
    );
    // Here and below, writing to a String cannot fail.
    let _ = writeln!(
        out,
        "The plants have b in 0.002–0.2 V·s²/rad, c in 0.01–1 V·s/rad and f1 in 0.02–2 V (log-uniform). The encoders have 500–20 000 counts per turn with noise of 0.2 counts; the delay is 0–2 ticks of 1 ms. Six of eight plants have one effect at 5–30 % of f1: cogging, Stribeck, position friction, constant load, gravity or a spring. The controller is tuned for b, c and f1 that are each off by up to 10 %. Its bandwidth is the default one, a quarter of the largest that tick and delay allow. It runs in f32, with the compensator **on**. The drive is limited to 1.5 times what a sine of 1 rad at 0.5 Hz needs. Each plant has three trials:

1. *stable*: 8 s of the sine; the error does not grow;
2. *still*: an S-curve, then 4 s of rest; in the last 2 s the true position moves by at most {COUNTS} counts, peak to peak;
3. *saturation*: a move that asks for ten times the drive, then 15 s; the error is back within {COUNTS} counts.
"
    );
    let count = |verdict: TrialResult| outcomes.iter().filter(|(_, outcome)| outcome.verdict == verdict).count();
    out.push_str("| | plants |\n|---|---|\n");
    for (name, verdict) in [
        ("passed all three", TrialResult::Passed),
        ("not stable", TrialResult::Unstable),
        ("not still at rest", TrialResult::LimitCycle),
        ("not back after saturation", TrialResult::Saturation),
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
    wrapped(&out)
}

fn failures(out: &mut String, outcomes: &[(Random, Outcome)]) {
    let failed: Vec<_> = outcomes.iter().filter(|(_, outcome)| outcome.verdict != TrialResult::Passed).collect();
    if failed.is_empty() {
        out.push_str("\nNo plant failed.\n");
        return;
    }
    out.push_str(
        "
The failures:

| plant | b | c | f1 | effect | counts per turn | delay | what | at rest, counts | after saturation, counts | ∫e needs for f1, s |
|---|---|---|---|---|---|---|---|---|---|---|
",
    );
    for (plant, outcome) in failed {
        let effect = plant.effect.map_or("none", |effect| effect.kind.name());
        let _ = writeln!(
            out,
            "| {} | {:.4} | {:.4} | {:.4} | {effect} | {} | {} | {:?} | {:.2} | {:.2} | {:.0} |",
            plant.number,
            plant.base.b,
            plant.base.c,
            plant.base.f1,
            plant.counts,
            plant.delay_ticks,
            outcome.verdict,
            outcome.rest_counts,
            outcome.left_counts,
            outcome.break_away_s
        );
    }
    out.push_str(
        "
A plant that is \"not back\" by a few counts stands within friction. The integral needs b·Kv·Λ1·∫e = f1 to break it away. The tick bounds the bandwidth, so b bounds the stiffness b·Kv·Λ2.
Where f1 is large for b, breaking away therefore takes longer than the 15 s. The last column has that time for the error at the end. It is up to twice as long where the move has left the integral on the other side.
Compensation does not help there, because at rest it must not move the axis. A saturating move on an axis with little damping comes back in swings that decay slowly. Give references that the drive can follow.
",
    );
}

/// When a rise of f1 by 30 % after `change_s` was found, s. It is infinite where it was not found, and negative for
/// an alarm before it.
fn found(trial: &Trial) -> f64 {
    trial.run().alarms.first().map_or(f64::INFINITY, |(t, _)| t - trial.change_s)
}

/// Of sorted numbers.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share) as usize]
}

fn drift(out: &mut String) {
    let alarms: usize = (0..HOURS).map(|seed| Trial::papers(3600.0, seed).run().alarms.len()).sum();
    let mut delays: Vec<f64> = (0..RISES)
        .map(|seed| {
            // Changes at every phase of the sine's 2 s.
            let change_s = 40.0 + 2.0 * seed as f64 / RISES as f64;
            found(&Trial { factor: 1.3, change_s, ..Trial::papers(50.0, 1000 + seed) })
        })
        .collect();
    delays.sort_by(f64::total_cmp);
    let _ = write!(
        out,
        "
## The drift watch

The watch has the settings that the firmware computes from motion and encoder (`DriftSettings::along`). The papers' plant (b .02685, c .11, f1 .5) follows 1 rad at 0.5 Hz under a PID. The encoder has 8000 counts per turn with noise of a third of a count; the tick is 1 ms.

| | |
|---|---|
| false alarms in {HOURS} h without a change | {alarms} |
| f1 up by 30 %, at {RISES} phases of the sine: found within, median | {:.2} s |
| … 95 % | {:.2} s |
| … worst | {:.2} s |
",
        quantile(&delays, 0.5),
        quantile(&delays, 0.95),
        quantile(&delays, 1.0),
    );
    let random: Vec<Random> = plants(PLANTS).into_iter().step_by(4).collect();
    let _ = write!(
        out,
        "
Other plants are every fourth of the table above. f1 rises by 30 % after 40 s, at four phases of the sine. They share {HOURS} h without a change among them. In one column the model is the plant.
In the other it is the model of the controller above: every parameter is off by up to 10 %, and the plant's effect is missing.
The error of such a model widens the scale. It is larger than the rise where f1 is small beside b·ẍ, c·ẋ or the effect.

| | the model fits | it is off |
|---|---|---|
"
    );
    let columns = [false, true].map(|off| {
        let trial = |plant: &Random, seconds: f64, seed: u64| {
            let trial = Trial::of(plant.base, plant.counts, seconds, seed);
            if off { Trial { effect: plant.effect, known: plant.known, ..trial } } else { trial }
        };
        let share_s = 3600.0 * HOURS as f64 / random.len() as f64;
        let quiet: Vec<_> = random.iter().map(|plant| trial(plant, share_s, plant.number as u64).run()).collect();
        let mut ready: Vec<f64> = quiet.iter().map(|run| run.ready_s).collect();
        ready.sort_by(f64::total_cmp);
        let alarms: usize = quiet.iter().map(|run| run.alarms.len()).sum();
        let rises = random.iter().flat_map(|plant| {
            (0..4_u32).map(move |phase| {
                let change_s = 40.13 + 0.5 * f64::from(phase);
                Trial { factor: 1.3, change_s, ..trial(plant, 53.0, 7 + u64::from(phase)) }
            })
        });
        let mut delays: Vec<f64> = rises.map(|trial| found(&trial)).collect();
        delays.sort_by(f64::total_cmp);
        let within = |most: f64| delays.iter().filter(|delay| (0.0..most).contains(*delay)).count();
        let of = delays.len();
        let seconds = |value: f64| if value.is_finite() { format!("{value:.2} s") } else { "–".into() };
        [
            format!("{} of {of}", within(2.0)),
            format!("{}", within(f64::INFINITY) - within(2.0)),
            format!("{}", delays.iter().filter(|delay| delay.is_infinite()).count()),
            seconds(quantile(&delays, 0.5)),
            seconds(quantile(&delays, 1.0)),
            format!("{alarms}"),
            format!("{:.1} s, {:.1} s", quantile(&ready, 0.5), quantile(&ready, 1.0)),
        ]
    });
    let names = [
        "found within 2 s",
        "found later, within 10 s",
        "not found",
        "found within, median",
        "… worst",
        "false alarms",
        "ready to watch after, median and longest",
    ];
    for ((name, fits), off) in names.iter().zip(&columns[0]).zip(&columns[1]) {
        let _ = writeln!(out, "| {name} | {fits} | {off} |");
    }
}
