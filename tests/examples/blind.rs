//! The blind matrix, a line per case and the tables: `cargo xtask blind --sizes 3,10 --seeds 1..5 --effects a,b+c,none`.
//!
//! With `--csv FILE` cases that the file holds already are not run again; `--table` only draws the tables of the file.
//! `--pairs N` hides N random pairs instead. `--jobs N` works on N cases at once, each on one core: the seconds are then
//! those of one core.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use breakaway_hidden::{CATALOGUE, Case, Experiment};
use breakaway_tests::blind::rows::{HEADER, Row};
use breakaway_tests::blind::{run, table};

fn argument(name: &str) -> Option<String> {
    let all: Vec<String> = std::env::args().collect();
    all.iter().position(|a| a == name).and_then(|i| all.get(i + 1).cloned())
}

fn flag(name: &str) -> bool {
    std::env::args().any(|a| a == name)
}

/// One case to run.
struct Asked {
    experiment: Experiment,
    hidden: Vec<String>,
    size: f64,
    seed: u64,
}

/// The seeds of `7`, or of `7..9`, its end left out.
fn range(seeds: &str) -> Option<std::ops::Range<u64>> {
    let Some((from, to)) = seeds.split_once("..") else {
        let one = seeds.parse().ok()?;
        return Some(one..one + 1);
    };
    Some(from.parse().ok()?..to.parse().ok()?).filter(|range| !range.is_empty())
}

fn asked() -> Vec<Asked> {
    let sizes = argument("--sizes").unwrap_or("10".into());
    let seeds = argument("--seeds").unwrap_or("1..3".into());
    let seeds =
        range(&seeds).unwrap_or_else(|| panic!("--seeds {seeds}: a seed, or a range like 1..3, its end left out"));
    let effects = argument("--effects").unwrap_or_else(|| CATALOGUE.join(","));
    let experiments = argument("--experiment").unwrap_or("suite".into());
    let pairs: usize = argument("--pairs").and_then(|n| n.parse().ok()).unwrap_or(0);
    let mut all = Vec::new();
    for experiment in experiments.split(',').filter_map(Experiment::named) {
        for size in sizes.split(',').filter_map(|s| s.parse::<f64>().ok()) {
            for seed in seeds.clone() {
                let drawn: Vec<String> = (0..pairs).map(|i| pair(seed, i)).collect();
                let named = effects.split(',').map(str::to_owned).filter(|_| pairs == 0);
                for name in named.chain(drawn) {
                    let hidden = if name == "none" { Vec::new() } else { name.split('+').map(str::to_owned).collect() };
                    all.push(Asked { experiment, hidden, size, seed });
                }
            }
        }
    }
    all
}

/// The `index`-th pair of a seed: a walk through all ordered pairs in steps that have no divisor in common with their number.
fn pair(seed: u64, index: usize) -> String {
    let n = CATALOGUE.len();
    let at = (seed as usize * 101 + index * 29) % (n * n);
    let (a, b) = (at / n, at % n);
    let b = if a == b { (b + 7) % n } else { b };
    format!("{}+{}", CATALOGUE[a.min(b)], CATALOGUE[a.max(b)])
}

fn one(asked: &Asked, verbose: bool) -> Result<Row, String> {
    let hidden: Vec<&str> = asked.hidden.iter().map(String::as_str).collect();
    let case = Case::new(asked.seed, &hidden, asked.size, asked.experiment).map_err(|e| format!("{e:?}"))?;
    let row = match run(&case) {
        Ok((scored, found)) => {
            if verbose {
                for c in &found.candidates {
                    println!("       {:22} Δ {:.4} z {:.1} λ {:.0} {}", c.kind.name(), c.delta, c.z, c.lambda, c.fate);
                }
                found.remarks.iter().for_each(|r| println!("       {r}"));
            }
            Row::new(asked.experiment, asked.size, &scored)
        }
        Err(error) => {
            println!("error {} {} % {}: {error}", asked.hidden.join("+"), asked.size, asked.seed);
            let hidden: Vec<&'static str> =
                CATALOGUE.iter().copied().filter(|name| asked.hidden.iter().any(|h| h == name)).collect();
            Row::error(asked.experiment, &hidden, asked.size, asked.seed)
        }
    };
    let mark = match (row.right(), row.wrong()) {
        (true, _) => "ok",
        (_, true) => "WRONG",
        _ => "miss",
    };
    println!("{mark:5} {}", row.line());
    Ok(row)
}

fn main() {
    let file = argument("--csv");
    let text = file.as_ref().and_then(|f| std::fs::read_to_string(f).ok()).unwrap_or_default();
    let mut known: Vec<Row> = text.lines().filter_map(Row::parse).collect();
    if flag("--table") {
        return println!("{}", table::markdown(&known));
    }
    let mut output = file.map(|f| {
        let mut open =
            OpenOptions::new().create(true).append(true).open(f).expect("the file of rows cannot be written");
        if text.is_empty() {
            let _ = writeln!(open, "{HEADER}");
        }
        open
    });
    let jobs: usize = argument("--jobs").and_then(|n| n.parse().ok()).unwrap_or(1);
    let mut todo = asked();
    todo.retain(|a| {
        !known.iter().any(|row| {
            row.seed == a.seed
                && row.hidden.join("+") == a.hidden.join("+")
                && row.experiment == a.experiment.name()
                && row.size_percent.to_bits() == a.size.to_bits()
        })
    });
    let next = AtomicUsize::new(0);
    let rows: Mutex<Vec<Row>> = Mutex::new(Vec::new());
    let sink = Mutex::new(&mut output);
    let work = &|| {
        while let Some(asked) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
            match one(asked, flag("--verbose")) {
                Ok(row) => {
                    if let Some(file) = sink.lock().expect("no other writer ended badly").as_mut() {
                        let _ = writeln!(file, "{}", row.line());
                    }
                    rows.lock().expect("no other worker ended badly").push(row);
                }
                Err(error) => eprintln!("{}: {error}", asked.hidden.join("+")),
            }
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
