//! Discovers machines of MuJoCo and scores the names: `cargo xtask mujoco --seeds 201..205 --scenarios Gravity,Drag`.
//!
//! A row is written as it ends; rows that the file holds already are not made again, unless `--anew` is given. `--table` only
//! draws the table of the file, and `--page FILE --date DATE --command LINE` writes it as docs/mujoco.md.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use breakaway_tests::blind::asked::range;
use breakaway_tests::machines::rows;
use breakaway_tests::markdown::wrapped;
use breakaway_tests::mujoco::row::Row;
use breakaway_tests::mujoco::{discovered, page, sessions, undiscovered};
use clap::Parser;

#[derive(Parser)]
struct Asked {
    /// Folder of the sessions
    #[arg(long)]
    sessions: Option<PathBuf>,
    /// Only these seeds, such as 201..205, whose end is left out
    #[arg(long, value_parser = range)]
    seeds: Option<Range<u64>>,
    /// Only these scenarios [default: all]
    #[arg(long, value_delimiter = ',')]
    scenarios: Vec<String>,
    /// File of the rows
    #[arg(long)]
    csv: PathBuf,
    /// Make the rows of these sessions again, whether the file holds them or not
    #[arg(long)]
    anew: bool,
    /// Work on this many sessions at once, each on one core
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: u16,
    /// Commit that is run, for the rows
    #[arg(long, default_value = "")]
    commit: String,
    /// Only draw the table of the file
    #[arg(long)]
    table: bool,
    /// Only write the page of the file
    #[arg(long)]
    page: Option<PathBuf>,
    /// Date of the page
    #[arg(long, default_value = "")]
    date: String,
    /// Command that made the rows, for the page
    #[arg(long, default_value = "")]
    command: String,
}

type AnyError = Box<dyn std::error::Error + Send + Sync>;

impl Asked {
    /// The asked sessions.
    fn asked(&self, folder: &Path) -> Result<Vec<(PathBuf, Row)>, AnyError> {
        let is_asked = |row: &Row| {
            let seed = self.seeds.as_ref().is_none_or(|seeds| seeds.contains(&row.seed));
            seed && (self.scenarios.is_empty() || self.scenarios.contains(&row.scenario))
        };
        let mut asked = Vec::new();
        for session in sessions(folder)? {
            let drawn = undiscovered(&session)?;
            if is_asked(&drawn) {
                asked.push((session, drawn));
            }
        }
        Ok(asked)
    }
}

/// Discovers a session, prints what was said, and adds its row to the file.
fn one(session: &Path, drawn: &Row, asked: &Asked, file: &Mutex<()>) -> Result<(), AnyError> {
    let row = drawn.clone().discovered(&asked.commit, discovered(session)?);
    let _writing = file.lock();
    println!(
        "{:13} {:18} {} {} {} {:.1} s",
        row.score()?.words(),
        row.scenario,
        row.seed,
        row.verdict,
        row.named,
        row.seconds
    );
    Ok(rows::append(&asked.csv, &row)?)
}

fn run(asked: &Asked, folder: &Path) -> Result<(), AnyError> {
    let mut todo = asked.asked(folder)?;
    let mut known: Vec<Row> = rows::read(&asked.csv)?;
    if asked.anew {
        known.retain(|row| !todo.iter().any(|(_, drawn)| row.is_of(drawn)));
        rows::write(&asked.csv, &known)?;
    }
    todo.retain(|(_, drawn)| !known.iter().any(|row| row.is_of(drawn)));
    let (next, file) = (AtomicUsize::new(0), Mutex::new(()));
    let work = || {
        while let Some((session, drawn)) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
            one(session, drawn, asked, &file)?;
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let start = |_| {
            scope.spawn(|| -> Result<(), AnyError> {
                rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(work)
            })
        };
        let workers: Vec<_> = (0..asked.jobs).map(start).collect();
        workers.into_iter().try_for_each(|worker| worker.join().map_err(|_| "a worker has panicked")?)
    })
}

fn done(asked: &Asked) -> Result<(), AnyError> {
    if let Some(folder) = asked.sessions.as_deref().filter(|_| !asked.table && asked.page.is_none()) {
        run(asked, folder)?;
    }
    let mut known: Vec<Row> = rows::read(&asked.csv)?;
    known.sort_by(|a, b| (&a.scenario, a.seed).cmp(&(&b.scenario, b.seed)));
    match &asked.page {
        Some(path) => std::fs::write(path, wrapped(&page::page(&known, &asked.date, &asked.command)?))?,
        None => println!("{}", page::tables(&known)?),
    }
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
