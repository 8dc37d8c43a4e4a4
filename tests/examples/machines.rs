//! Discovers the real machines and scores the names: `cargo xtask machines --machines emps,xl330 --splits all,halves`.
//!
//! `--splits` takes `all`, `groups`, `without`, `halves`, `thirds`, `full` (all of them) and `quick` (one split of six
//! machines). Beside these it takes `alone` (files alone), and `altered`, `further` and `fresh` (all files, made worse). With `--csv FILE` rows that the file holds already are not made again, unless `--anew` is given; a row is
//! written as it ends. `--table` only draws the tables of the file, and `--page FILE --date DATE --command LINE` writes
//! them as docs/machines.md. `--export FOLDER` writes the recordings as plain tables, and `--compare NAME=FILE` draws the
//! rows of several programs side by side.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use breakaway::discover::progress::Progress;
use breakaway_tests::machines::catalogue::MACHINES;
use breakaway_tests::machines::compare::{self, Program};
use breakaway_tests::machines::reading::{self, ReadingError};
use breakaway_tests::machines::rows::{self, Row};
use breakaway_tests::machines::splits::{Split, harder, splits, taken};
use breakaway_tests::machines::{Machine, discovery, drive_free, export, page, quick};
use breakaway_tests::markdown::wrapped;
use breakaway_tests::measured_data;
use clap::Parser;

#[derive(Parser)]
struct Asked {
    /// Machines [default: all]; `laas` stands for all whose name begins so
    #[arg(long, value_delimiter = ',')]
    machines: Vec<String>,
    /// Kinds of splits: all, groups, without, halves, thirds, full, quick, alone, altered, further, fresh; or names of splits
    #[arg(long, value_delimiter = ',', default_value = "all")]
    splits: Vec<String>,
    /// File of the rows
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Make the asked rows again, whether the file holds them or not
    #[arg(long)]
    anew: bool,
    /// Only draw the tables of the file
    #[arg(long)]
    table: bool,
    /// Only write the page of the file
    #[arg(long)]
    page: Option<PathBuf>,
    /// Only write the asked machines' recordings as plain tables into this folder
    #[arg(long)]
    export: Option<PathBuf>,
    /// Only draw the rows of these programs side by side: `NAME=FILE`, repeated
    #[arg(long, value_name = "NAME=FILE")]
    compare: Vec<String>,
    /// Commit that is run, for the rows
    #[arg(long, default_value = "")]
    commit: String,
    /// Date of the page
    #[arg(long, default_value = "")]
    date: String,
    /// Command that made the rows, for the page
    #[arg(long, default_value = "")]
    command: String,
    /// What else is to be said of the rows, for the page
    #[arg(long, default_value = "")]
    remark: String,
}

impl Asked {
    fn pairs(&self) -> Result<Vec<(&'static Machine, Split)>, String> {
        let quick_asked = self.splits.iter().any(|kind| kind == "quick");
        let asked = |kind: &str| self.splits.iter().any(|asked| asked == kind);
        let machine = |machine: &Machine| {
            self.machines.is_empty() || self.machines.iter().any(|name| machine.name.starts_with(name.as_str()))
        };
        let kinds =
            ["all", "groups", "without", "halves", "thirds", "full", "quick", "alone", "altered", "further", "fresh"];
        let all = || MACHINES.iter().flat_map(|machine| splits(machine).into_iter().chain(harder(machine)));
        let known = |asked: &str| kinds.contains(&asked) || all().any(|split| split.to_string() == asked);
        if let Some(unknown) = self.splits.iter().find(|asked| !known(asked)) {
            return Err(format!("--splits {unknown}: one of {}, or the name of a split", kinds.join(", ")));
        }
        let unknown = self.machines.iter().find(|name| !MACHINES.iter().any(|m| m.name.starts_with(name.as_str())));
        if let Some(unknown) = unknown {
            let names: Vec<&str> = MACHINES.iter().map(|machine| machine.name).collect();
            return Err(format!("--machines {unknown}: one of {}", names.join(", ")));
        }
        let of_machine = |machine: &Machine| -> Vec<Split> {
            let is_asked = |split: &Split| asked(split.kind()) || asked(&split.to_string());
            let full = splits(machine).into_iter().filter(|split| asked("full") || is_asked(split));
            full.chain(harder(machine).into_iter().filter(is_asked)).collect()
        };
        let every = MACHINES.into_iter().filter(|of| machine(of));
        let mut pairs: Vec<(&Machine, Split)> =
            every.flat_map(|machine| of_machine(machine).into_iter().map(move |split| (machine, split))).collect();
        if quick_asked {
            let more = quick().into_iter().filter(|(of, _)| machine(of));
            let more: Vec<_> =
                more.filter(|(of, split)| !pairs.iter().any(|(m, s)| m.name == of.name && s == split)).collect();
            pairs.extend(more);
        }
        Ok(pairs)
    }
}

/// Reads a machine, discovers a split of it; prints what is being done.
fn row(machine: &Machine, split: Split, data: &Path, commit: &str) -> Result<Option<Row>, ReadingError> {
    let sources = match reading::read(machine, data) {
        Err(ReadingError::NoDrive) if split == Split::All => return Ok(Some(Row::no_drive(machine, commit))),
        Err(ReadingError::NoDrive) => return Ok(None),
        sources => sources?,
    };
    let taken = taken(machine, split, &sources);
    let curve = drive_free::error(&taken);
    let unit = taken.fit.first().map(|recording| recording.units.x.clone()).unwrap_or_default();
    let concerned = sources.iter().filter(|source| taken.concerns(source));
    let remarks: Vec<&str> = concerned.filter_map(|source| source.remark.as_deref()).collect();
    let began = Instant::now();
    let progress = |what: Progress<'_>| {
        if let Progress::Step(what) = what {
            eprintln!("  {:6.1} s  {what}", began.elapsed().as_secs_f64());
        }
    };
    let said = discovery::run(taken, &progress);
    Ok(Some(Row::new(machine, split, commit, said).with(curve, &unit, &remarks)))
}

fn run(asked: &Asked, csv: Option<&Path>, mut known: Vec<Row>) -> Result<Vec<Row>, Box<dyn std::error::Error>> {
    let pairs = asked.pairs()?;
    let Some(data) = measured_data() else { return Ok(known) };
    if asked.anew {
        known.retain(|row| !pairs.iter().any(|(machine, split)| row.is_of(machine, *split)));
        csv.map_or(Ok(()), |path| rows::write(path, &known))?;
    }
    for (k, &(machine, split)) in pairs.iter().enumerate() {
        if known.iter().any(|row| row.is_of(machine, split)) {
            continue;
        }
        eprintln!("{} of {}: {}, {split}", k + 1, pairs.len(), machine.name);
        let Some(row) = row(machine, split, &data, &asked.commit)? else { continue };
        let seconds = row.seconds.unwrap_or_default();
        let score = row.score(machine)?.words();
        println!(
            "{score:13} {:10} {:16} {:17} {} {seconds:.1} s {}",
            row.machine, row.split, row.verdict, row.named, row.note
        );
        csv.map_or(Ok(()), |path| rows::append(path, &row))?;
        known.push(row);
    }
    Ok(known)
}

fn export(asked: &Asked, folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let Some(data) = measured_data() else { return Ok(()) };
    let mut read = Vec::new();
    for (machine, _) in asked.pairs()?.into_iter().filter(|(_, split)| *split == Split::All) {
        match reading::read(machine, &data) {
            Err(ReadingError::NoDrive) => (),
            sources => read.push((machine, sources?)),
        }
    }
    Ok(export::write(folder, &read)?)
}

fn compare(programs: &[String]) -> Result<String, Box<dyn std::error::Error>> {
    let mut read = Vec::new();
    for program in programs {
        let (name, file) = program.split_once('=').ok_or_else(|| format!("--compare {program}: expected NAME=FILE"))?;
        read.push(Program { name: name.to_owned(), rows: rows::read(Path::new(file))? });
    }
    Ok(compare::table(&read)?)
}

fn done(asked: &Asked) -> Result<(), Box<dyn std::error::Error>> {
    if let Some(folder) = &asked.export {
        return export(asked, folder);
    }
    if !asked.compare.is_empty() {
        print!("{}", compare(&asked.compare)?);
        return Ok(());
    }
    let csv = asked.csv.as_deref();
    let known = csv.map_or(Ok(Vec::new()), rows::read)?;
    if let Some(path) = &asked.page {
        std::fs::write(path, wrapped(&page::page(&known, &asked.date, &asked.command, &asked.remark)?))?;
        return Ok(());
    }
    let rows = if asked.table { known } else { run(asked, csv, known)? };
    println!("{}", page::tables(&rows)?);
    Ok(())
}

fn main() -> ExitCode {
    match done(&Asked::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
