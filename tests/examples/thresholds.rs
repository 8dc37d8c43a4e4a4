//! How far the judge's answers depend on its thresholds: `cargo run --release -p breakaway-tests --example thresholds`.
//!
//! Each threshold is halved and made larger by half, one at a time; a share stays below 1. The judge then rules on all
//! recordings of each machine, and on sessions of the unkind world. `--seeds 3501..3513` are sessions with one to three
//! effects of 10 %, `--clean 3601..3605` sessions without. Names are those of the measured forces alone. The table is
//! that of docs/discovery.md.

use breakaway::discover::judge::finding::Finding;
use breakaway::discover::judge::ruling::Ruling;
use breakaway::discover::judge::settings::Settings;
use breakaway::discover::request::Request;
use breakaway::discover::ruled::ruled;
use breakaway_core::plant::Kind;
use breakaway_hidden::{Case, Setting};
use breakaway_tests::blind::rows::Row;
use breakaway_tests::blind::rules::lead;
use breakaway_tests::machines::catalogue::MACHINES;
use breakaway_tests::machines::score::{Named, Score, score};
use breakaway_tests::machines::splits::{Split, taken};
use breakaway_tests::machines::truth::Truth;
use breakaway_tests::machines::{Machine, reading};
use breakaway_tests::measured_data;
use breakaway_tests::requests::{Sessions, of_case, request};
use clap::Parser;

#[derive(Parser)]
struct Options {
    /// Sessions of the unkind world with one to three effects of 10 %
    #[arg(long, default_value = "3501..3513")]
    seeds: String,
    /// Sessions of the unkind world with no effect
    #[arg(long, default_value = "3601..3605")]
    clean: String,
    /// Factors of each threshold
    #[arg(long, value_delimiter = ',', default_values_t = [0.5, 1.5])]
    factors: Vec<f64>,
}

/// A threshold: its name, and how a factor changes it.
type Threshold = (&'static str, fn(&mut Settings, f64));

/// Shares are held below 1.
fn share(value: &mut f64, factor: f64) {
    *value = (*value * factor).min(0.99);
}

const THRESHOLDS: [Threshold; 12] = [
    ("noise_share", |s, k| share(&mut s.noise_share, k)),
    ("slow_share", |s, k| share(&mut s.slow_share, k)),
    ("block_s, block_half_widths", |s, k| {
        s.block_s *= k;
        s.block_half_widths *= k;
    }),
    ("local_gain", |s, k| s.local_gain = s.local_gain.map(|gain| gain * k)),
    ("gain", |s, k| s.gain = s.gain.map(|gain| gain * k)),
    ("over_decoys", |s, k| s.over_decoys *= k),
    ("z", |s, k| s.z *= k),
    ("coherence", |s, k| share(&mut s.coherence, k)),
    ("disagreement", |s, k| share(&mut s.disagreement, k)),
    ("rival", |s, k| share(&mut s.rival, k)),
    ("decoy", |s, k| share(&mut s.decoy, k)),
    ("predictable", |s, k| share(&mut s.predictable, k)),
];

/// The judge's findings on a request, as names with what is tied.
fn names(ruling: &Ruling) -> Vec<Named> {
    let named = |finding: &Finding| Named {
        kind: finding.effect.kind,
        tied: finding.tied.iter().map(|(kind, _)| *kind).collect(),
    };
    ruling.findings.iter().map(named).collect()
}

fn judged(request: &Request, settings: &Settings) -> Option<Ruling> {
    let units = request.recordings.first()?.units.clone();
    ruled(request, &units, settings).ruling
}

fn machines() -> Vec<(&'static Machine, Request)> {
    let Some(data) = measured_data() else { return Vec::new() };
    let each = MACHINES.into_iter().filter(|machine| machine.truth != Truth::NoDrive).filter_map(|machine| {
        let sources = reading::read(machine, &data).ok()?;
        Some((machine, request(&taken(machine, Split::All, &sources).fit)))
    });
    each.collect()
}

fn sessions(seeds: &str, clean: bool) -> Vec<(Case, Request)> {
    let asked = Sessions { effects: clean.then(|| "none".to_owned()), ..Sessions::unkind(seeds) };
    let cases = asked.cases().unwrap_or_else(|error| panic!("{error}"));
    let requests: Vec<Request> = cases.iter().map(of_case).collect();
    cases.into_iter().zip(requests).collect()
}

/// A session's names as a row of the blind matrix, which knows what the world excuses.
fn row(case: &Case, ruling: Option<&Ruling>) -> Row {
    let all = ruling.map_or_else(Vec::new, names);
    let words = |kinds: &[Kind]| kinds.iter().map(|kind| kind.name().to_owned()).collect::<Vec<_>>();
    let kinds: Vec<Kind> = all.iter().map(|own| own.kind).collect();
    let row = Row { named: words(&kinds), ..Row::error(case, &Setting::Kind) };
    let lead_tied = lead(&row).map_or_else(Vec::new, |lead| words(&all[lead].tied));
    Row { lead_tied, ..row }
}

fn main() {
    let options = Options::parse();
    let (machines, hidden) = (machines(), sessions(&options.seeds, false));
    let clean = sessions(&options.clean, true);
    println!("| threshold | factor | machines right | a wrong name | sessions right | a wrong name | clean, a name |");
    println!("|---|---|---|---|---|---|---|");
    let line = |name: &str, factor: f64, settings: &Settings| {
        let scores: Vec<Score> = machines
            .iter()
            .map(|(machine, request)| {
                let all = judged(request, settings).as_ref().map_or_else(Vec::new, names);
                score(&machine.truth, "", &all)
            })
            .collect();
        let of = |sought: Score| scores.iter().filter(|own| **own == sought).count();
        let rows = |of: &[(Case, Request)]| -> Vec<Row> {
            of.iter().map(|(case, request)| row(case, judged(request, settings).as_ref())).collect()
        };
        let (rows, clean) = (rows(&hidden), rows(&clean));
        println!(
            "| {name} | {factor} | {} of {} | {} | {} of {} | {} | {} of {} |",
            of(Score::Right),
            scores.len(),
            of(Score::Wrong),
            rows.iter().filter(|row| row.lead_right()).count(),
            rows.len(),
            rows.iter().filter(|row| row.wrong()).count(),
            clean.iter().filter(|row| row.wrong()).count(),
            clean.len()
        );
    };
    line("none", 1.0, &Settings::default());
    for (name, change) in THRESHOLDS {
        for factor in &options.factors {
            let mut settings = Settings::default();
            change(&mut settings, *factor);
            line(name, *factor, &settings);
        }
    }
}
