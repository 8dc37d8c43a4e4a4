//! The blind matrix, a line per case and the tables: `cargo xtask blind --sizes 3,10 --seeds 1..5 --effects a,b+c,none`.
//!
//! `--world unkind` makes it in the unkind world, `--world unkind:jitter,torque` with these items alone.
//! With `--csv FILE` cases that the file holds already are not run again; `--table` only draws the tables of the file.
//! `--pairs N` hides N random pairs instead, `--drawn N` one, two or three random effects in N cases of each seed. `--jobs N`
//! works on N cases at once, each on one core: the seconds are then those of one core. `--minutes N` begins no case later.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use breakaway_hidden::{Case, Setting};
use breakaway_tests::blind::asked::Asked;
use breakaway_tests::blind::rows::{HEADER, Row, UNKIND_HEADER};
use breakaway_tests::blind::{run, table, told};

/// The value of an option, given without its dashes.
fn option(name: &str) -> Option<String> {
    let all: Vec<String> = std::env::args().collect();
    all.iter().position(|a| a.strip_prefix("--") == Some(name)).and_then(|i| all.get(i + 1).cloned())
}

fn flag(name: &str) -> bool {
    std::env::args().any(|a| a == name)
}

fn one(case: &Case, setting: &Setting, verbose: bool) -> Row {
    let started = Instant::now();
    let row = match run(case) {
        Ok((scored, found)) => {
            if verbose {
                told(&found).iter().for_each(|line| println!("       {line}"));
            }
            Row::new(case, setting, &scored)
        }
        Err(error) => {
            let row = Row::error(case, setting, started.elapsed().as_secs_f64());
            println!("error {} {} % {}: {error}", row.hidden.join("+"), row.size_percent, row.seed);
            row
        }
    };
    let mark = match (row.right(), row.wrong()) {
        (true, _) => "ok",
        (_, true) => "WRONG",
        _ => "miss",
    };
    println!("{mark:5} {}", row.line());
    row
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
    let minutes: f64 = option("minutes").and_then(|n| n.parse().ok()).unwrap_or(f64::INFINITY);
    let (started, next) = (Instant::now(), AtomicUsize::new(0));
    let rows: Mutex<Vec<Row>> = Mutex::new(Vec::new());
    let sink = Mutex::new(&mut output);
    let work = &|| {
        while let Some(case) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
            if started.elapsed().as_secs_f64() > 60.0 * minutes {
                return;
            }
            let row = one(case, setting, flag("--verbose"));
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
