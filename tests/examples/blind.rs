//! The blind matrix, a line per case and the tables: `cargo xtask blind --sizes 3,10 --seeds 1..5 --effects a,b+c,none`.
//!
//! `--help` says what each option does. The table alone is drawn by `--csv FILE --table`.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use breakaway::discover::progress::Progress;
use breakaway_hidden::{Case, Setting};
use breakaway_tests::blind::asked::Asked;
use breakaway_tests::blind::limit::{Clock, Watch};
use breakaway_tests::blind::rows::{HEADER, Row, UNKIND_HEADER};
use breakaway_tests::blind::{in_words, run_watched, table};
use clap::Parser;

/// Discover blind cases: the hidden plant, scored against its sealed truth. It prints a line per case, and the tables
#[derive(Parser)]
#[command(name = "blind")]
struct Options {
    #[command(flatten)]
    asked: Asked,
    /// File of the rows; cases that it holds already are not run again
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Only draw the tables of the file
    #[arg(long, requires = "csv")]
    table: bool,
    /// Work on this many cases at once, each on one core: the seconds are then those of one core
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: u16,
    /// Give a case up after this processor time, s. Its row is written, and the program ends with code 3; begun again, it
    /// goes on with the next case. With one job alone
    #[arg(long, value_name = "SECONDS")]
    limit: Option<f64>,
    /// Each step of a discovery, and what it found
    #[arg(long)]
    verbose: bool,
}

fn one(case: &Case, setting: &Setting, verbose: bool, alone: bool) -> Row {
    let clock = Clock::start();
    let steps = |what: Progress<'_>| {
        let what = match what {
            Progress::Step(what) if verbose => what.to_owned(),
            Progress::Round { effect, candidates } if verbose => format!("effect {effect}: {candidates} candidates"),
            _ => return,
        };
        println!("       {:6.1} s  {what}", clock.processor_s().unwrap_or(f64::NAN));
    };
    let row = match run_watched(case, &steps) {
        Ok((scored, found)) => {
            if verbose {
                println!("       {}", in_words(&found).join("\n       "));
            }
            Row::new(case, setting, &scored)
        }
        Err(error) => {
            let row = Row::error(case, setting);
            println!("error {} {} % {}: {error}", row.hidden.join("+"), row.size_percent, row.seed);
            row
        }
    };
    // With others beside it the process's time is not the case's.
    let processor_s = clock.processor_s().filter(|_| alone).unwrap_or(f64::NAN);
    let row = Row { processor_s, ..row };
    let mark = match (row.right(), row.wrong()) {
        (true, _) => "ok",
        (_, true) => "WRONG",
        _ => "miss",
    };
    println!("{mark:5} {}", row.line());
    row
}

/// Writes the row of a case that took too long, and ends.
fn give_up(row: &Row, file: Option<&Path>) {
    println!("long  {}", row.line());
    if let Some(mut file) = file.and_then(|f| OpenOptions::new().append(true).open(f).ok()) {
        let _ = writeln!(file, "{}", row.line());
    }
    std::process::exit(3);
}

fn run(options: &Options) -> Result<(), String> {
    let unwritten = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    let text = match &options.csv {
        Some(path) if path.exists() => std::fs::read_to_string(path).map_err(|error| unwritten(path, error))?,
        _ => String::new(),
    };
    let mut known: Vec<Row> = text.lines().filter_map(Row::parse).collect();
    if options.table {
        println!("{}", table::markdown(&known));
        return Ok(());
    }
    let alone = options.jobs == 1;
    if options.limit.is_some() && !alone {
        return Err("--limit is the time of one case, and needs --jobs 1".to_owned());
    }
    let setting = &options.asked.world;
    let mut todo = options.asked.cases()?;
    todo.retain(|case| !known.iter().any(|row| row.is_of(case, setting)));
    let mut output = match &options.csv {
        Some(path) => {
            let open = OpenOptions::new().create(true).append(true).open(path);
            let mut open = open.map_err(|error| unwritten(path, error))?;
            if text.is_empty() {
                let more = if *setting == Setting::Kind { "" } else { UNKIND_HEADER };
                writeln!(open, "{HEADER}{more}").map_err(|error| unwritten(path, error))?;
            }
            Some(open)
        }
        None => None,
    };
    let next = AtomicUsize::new(0);
    let rows: Mutex<Vec<Row>> = Mutex::new(Vec::new());
    let sink = Mutex::new(&mut output);
    let work = &|| {
        while let Some(case) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
            let clock = Clock::start();
            let watch = options.limit.map(|limit| {
                let (row, file) = (Row::given_up(case, setting, limit), options.csv.clone());
                Watch::start(clock, limit, move || give_up(&row, file.as_deref()))
            });
            let row = one(case, setting, options.verbose, alone);
            drop(watch);
            if let Some(file) = sink.lock().expect("no other writer ended badly").as_mut() {
                let _ = writeln!(file, "{}", row.line());
            }
            rows.lock().expect("no other worker ended badly").push(row);
        }
    };
    if alone {
        work();
    } else {
        std::thread::scope(|scope| {
            for _ in 0..options.jobs {
                scope.spawn(|| match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
                    Ok(pool) => pool.install(work),
                    Err(error) => eprintln!("no thread: {error}"),
                });
            }
        });
    }
    known.extend(rows.into_inner().unwrap_or_default());
    println!("{}", table::markdown(&known));
    Ok(())
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
