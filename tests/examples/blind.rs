//! The blind matrix, a line per case and the tables: `cargo xtask blind --sizes 3,10 --seeds 1..5 --effects a,b+c,none`.
//!
//! `--world unkind` makes it in the unkind world, `--world unkind:jitter,torque` with these items alone.
//! With `--csv FILE` cases that the file holds already are not run again; `--table` only draws the tables of the file.
//! `--pairs N` hides N random pairs instead, `--drawn N` one, two or three random effects in N cases of each seed.
//! `--jobs N` works on N cases at once, each on one core: the seconds are then those of one core. `--limit N`, with one
//! job, gives a case up after N s of the processor. Its row is written, and the program ends with code 3. Begun again,
//! the program goes on with the next case.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use breakaway::discover::progress::Progress;
use breakaway_hidden::{Case, Setting};
use breakaway_tests::blind::asked::Asked;
use breakaway_tests::blind::limit::{Clock, Watch};
use breakaway_tests::blind::rows::{HEADER, Row, UNKIND_HEADER};
use breakaway_tests::blind::{in_words, run_watched, table};

/// The value of an option, given without its dashes.
fn option(name: &str) -> Option<String> {
    let all: Vec<String> = std::env::args().collect();
    all.iter().position(|a| a.strip_prefix("--") == Some(name)).and_then(|i| all.get(i + 1).cloned())
}

fn flag(name: &str) -> bool {
    std::env::args().any(|a| a == name)
}

fn one(case: &Case, setting: &Setting, verbose: bool, alone: bool) -> Row {
    let clock = Clock::start();
    let steps = |what: Progress<'_>| match what {
        Progress::Step(what) if verbose => println!("       {:6.1} s  {what}", clock.processor_s().unwrap_or(f64::NAN)),
        _ => (),
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
fn give_up(row: &Row, file: Option<&str>) {
    println!("long  {}", row.line());
    if let Some(mut file) = file.and_then(|f| OpenOptions::new().append(true).open(f).ok()) {
        let _ = writeln!(file, "{}", row.line());
    }
    std::process::exit(3);
}

fn main() {
    let file = option("csv");
    let text = file.as_ref().and_then(|f| std::fs::read_to_string(f).ok()).unwrap_or_default();
    let mut known: Vec<Row> = text.lines().filter_map(Row::parse).collect();
    if flag("--table") {
        return println!("{}", table::markdown(&known));
    }
    let asked = Asked::from_options(option).unwrap_or_else(|error| panic!("{error}"));
    let setting = &asked.setting;
    let mut todo = asked.cases().unwrap_or_else(|error| panic!("{error}"));
    todo.retain(|case| !known.iter().any(|row| row.is_of(case, setting)));
    let path = file.clone();
    let mut output = file.map(|f| {
        let mut open =
            OpenOptions::new().create(true).append(true).open(f).expect("the file of rows cannot be written");
        if text.is_empty() {
            let more = if *setting == Setting::Kind { "" } else { UNKIND_HEADER };
            let _ = writeln!(open, "{HEADER}{more}");
        }
        open
    });
    let jobs: usize = option("jobs").and_then(|n| n.parse().ok()).unwrap_or(1);
    let limit: Option<f64> = option("limit").and_then(|n| n.parse().ok()).filter(|_| jobs == 1);
    let next = AtomicUsize::new(0);
    let rows: Mutex<Vec<Row>> = Mutex::new(Vec::new());
    let sink = Mutex::new(&mut output);
    let work = &|| {
        while let Some(case) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
            let clock = Clock::start();
            let watch = limit.map(|limit| {
                let (row, file) = (Row::given_up(case, setting, limit), path.clone());
                Watch::start(clock, limit, move || give_up(&row, file.as_deref()))
            });
            let row = one(case, setting, flag("--verbose"), jobs == 1);
            drop(watch);
            if let Some(file) = sink.lock().expect("no other writer ended badly").as_mut() {
                let _ = writeln!(file, "{}", row.line());
            }
            rows.lock().expect("no other worker ended badly").push(row);
        }
    };
    if jobs > 1 {
        std::thread::scope(|scope| {
            for _ in 0..jobs {
                scope.spawn(|| match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
                    Ok(pool) => pool.install(work),
                    Err(error) => eprintln!("no thread: {error}"),
                });
            }
        });
    } else {
        work();
    }
    known.extend(rows.into_inner().unwrap_or_default());
    println!("{}", table::markdown(&known));
}
