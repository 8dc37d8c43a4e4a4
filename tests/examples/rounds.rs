//! What the judge weighed, round by round: `cargo run -p breakaway-tests --example rounds -- --machines cicese --splits all`,
//! or with `--files` and the files of a session.
//!
//! Each line is a term or a pair. It has the gains on side U and side A, over all rows and where the term acts. Then come
//! z, the disagreement of the sides, ρ², the parameters, and why it is no name.

use std::path::PathBuf;
use std::slice;

use breakaway::discover::judge::dataset::Dataset;
use breakaway::discover::judge::regression::rms;
use breakaway::discover::judge::ruling::Ruling;
use breakaway::discover::judge::search::judge;
use breakaway::discover::judge::settings::Settings;
use breakaway::discover::judge::tried::Tried;
use breakaway::discover::judge::weak_form::WeakForm;
use breakaway::discover::request::Request;
use breakaway::discover::ruled::{radians, ruled};
use breakaway::recording::{ReadOptions, Recording};
use breakaway_hidden::Role;
use breakaway_tests::blind::recordings;
use breakaway_tests::machines::catalogue::MACHINES;
use breakaway_tests::machines::reading;
use breakaway_tests::machines::splits::{harder, splits, taken};
use breakaway_tests::measured_data;
use breakaway_tests::requests::{Sessions, request};
use clap::Parser;

#[derive(Parser)]
struct Asked {
    /// Machines, by how their names begin
    #[arg(long, value_delimiter = ',')]
    machines: Vec<String>,
    /// Splits, by their names; `all` where none is given
    #[arg(long, value_delimiter = ',', default_value = "all")]
    splits: Vec<String>,
    /// Recordings of a session, in the order in which they were made
    #[arg(long, num_args = 1..)]
    files: Vec<PathBuf>,
    /// Each recording of the splits alone
    #[arg(long)]
    each: bool,
    /// Half-widths of the windows, s; that of the ruling where none is given
    #[arg(long, value_delimiter = ',')]
    half_widths_s: Vec<f64>,
    #[command(flatten)]
    sessions: Sessions,
    /// Lines of a round; with 0 the ruling alone
    #[arg(long, default_value_t = 16)]
    lines: usize,
}

fn line(tried: &Tried) -> String {
    let each = tried.terms.iter().zip(&tried.evidence).map(|(term, e)| {
        let parameters: Vec<String> = term.parameters.iter().map(|(i, value)| format!("{i}:{value:.3e}")).collect();
        format!(
            "{}{} ({}) U {:.3}/{:.3} z {:.1}, A {:.3}/{:.3} z {:.1}, disagree {:.2}, rho2 {:.2}, {:?}",
            term.name.text(),
            if term.own_zeros { "*" } else { "" },
            parameters.join(" "),
            e.u.flat,
            e.u.local,
            e.u.z,
            e.a.flat,
            e.a.local,
            e.a.z,
            e.disagreement,
            e.coherence,
            e.rejection
        )
    });
    format!("{:7.4}  {}", tried.gain, each.collect::<Vec<_>>().join("\n         + "))
}

/// The names with what is tied with them, and what is seen beside them with its share of the energy of the gap.
fn in_words(ruling: &Ruling) -> String {
    let named = ruling.findings.iter().map(|finding| {
        let count = finding.effect.kind.definition().parameters.len();
        let parameters: Vec<String> = finding.effect.p[..count].iter().map(|p| format!("{p:.3e}")).collect();
        let tied = finding.tied.iter().map(|(kind, _)| kind.name());
        let names: Vec<&str> = std::iter::once(finding.effect.kind.name()).chain(tied).collect();
        format!("{} ({})", names.join(" = "), parameters.join(" "))
    });
    let seen =
        ruling.seen.iter().map(|own| format!("seen: {} {:.3}", own.effect.kind.name(), own.small_share.unwrap_or(0.0)));
    named.chain(seen).collect::<Vec<_>>().join(", ")
}

/// Requests by their names: of files, of real machines, and of sessions of the unkind world.
fn requests(asked: &Asked) -> Vec<(String, Request)> {
    let mut all = Vec::new();
    if !asked.files.is_empty() {
        let read = |path: &PathBuf| Recording::read(path, &ReadOptions::default());
        let recordings: Result<Vec<_>, _> = asked.files.iter().map(read).collect();
        all.push(("files".to_owned(), request(&recordings.unwrap_or_else(|error| panic!("{error}")))));
    }
    let machines = MACHINES.into_iter().filter(|own| asked.machines.iter().any(|name| own.name.starts_with(name)));
    for machine in machines {
        let Some(sources) = measured_data().and_then(|data| reading::read(machine, &data).ok()) else { continue };
        for split in
            splits(machine).into_iter().chain(harder(machine)).filter(|split| asked.splits.contains(&split.to_string()))
        {
            let fit = taken(machine, split, &sources).fit;
            if asked.each {
                all.extend(
                    fit.iter().map(|own| (format!("{} {}", machine.name, own.name), request(slice::from_ref(own)))),
                );
            } else {
                all.push((format!("{} {split}", machine.name), request(&fit)));
            }
        }
    }
    let cases = asked.sessions.cases().unwrap_or_else(|error| panic!("{error}"));
    all.extend(cases.iter().map(|case| {
        let (session, truth) = case.generate_with_truth();
        let hidden: Vec<String> =
            truth.effects.iter().map(|own| format!("{} {:?}", own.hidden.name(), own.parameters)).collect();
        let base = truth.base;
        (
            format!(
                "{} {} %: {}; b {:.4} c {:.4} f1 {:.3}, gap {:.1} of {:.1} %",
                case.seed,
                truth.size_percent,
                hidden.join(" + "),
                base.b,
                base.c,
                base.f1,
                truth.gap_rms_refit_percent,
                truth.gap_rms_percent
            ),
            request(&recordings(&session, Role::Fit)),
        )
    }));
    all
}

fn main() {
    let asked = Asked::parse();
    let settings = Settings::default();
    for (name, request) in requests(&asked) {
        let Some(units) = request.recordings.first().map(|recording| recording.units.clone()) else { continue };
        let own = ruled(&request, &units, &settings);
        let Some(ruling) = own.ruling else {
            println!("## {name}: no ruling");
            continue;
        };
        println!("## {name}\n   says {}", in_words(&ruling));
        println!("   base {:?}, rho2 {:.3}", ruling.base, ruling.coherence);
        println!("   age {:?} s, remainder {:?}", own.age_s, ruling.remainder);
        if asked.lines == 0 {
            continue;
        }
        let dataset = Dataset::new(&own.request.recordings, &settings);
        let widths =
            if asked.half_widths_s.is_empty() { vec![ruling.half_width_s] } else { asked.half_widths_s.clone() };
        for width in widths {
            let Some(mut form) = WeakForm::new(&dataset, width, &settings) else { continue };
            form.radians = radians(&units);
            let Some(judged) = judge(&form, &settings) else { continue };
            println!(
                "# {width} s: {} rows, {} blocks, v95 {:.3e}, noise share {:.3}, drive rms {:.3}",
                form.rows.len(),
                form.blocks,
                form.v95,
                form.noise_share(),
                rms(&form.row_u)
            );
            println!("  residual U, A: {:?}", judged.residual);
            for round in &judged.rounds {
                println!("  {:?}", round.outcome);
                round.tried.iter().take(asked.lines).for_each(|tried| println!("  {}", line(tried)));
            }
        }
    }
}
