//! The blind matrix, a line per case and a summary: `cargo xtask blind --sizes 3,10 --seeds 1..5 --effects a,b+c,none`.

use std::collections::BTreeMap;

use breakaway_hidden::{CATALOGUE, Case, Experiment};
use breakaway_tests::blind::{Scored, run};

fn argument(name: &str) -> Option<String> {
    let all: Vec<String> = std::env::args().collect();
    all.iter().position(|a| a == name).and_then(|i| all.get(i + 1).cloned())
}

fn main() {
    let sizes: Vec<f64> =
        argument("--sizes").unwrap_or("10".into()).split(',').filter_map(|s| s.parse().ok()).collect();
    let seeds = argument("--seeds").unwrap_or("1..3".into());
    let (from, to) = seeds.split_once("..").unwrap_or((&seeds, &seeds));
    let seeds: std::ops::Range<u64> = from.parse().unwrap_or(1)..to.parse().unwrap_or(2);
    let effects = argument("--effects").unwrap_or_else(|| CATALOGUE.join(","));
    let experiment = argument("--experiment").and_then(|e| Experiment::named(&e)).unwrap_or(Experiment::Suite);
    let verbose = std::env::args().any(|a| a == "--verbose");
    let mut table: BTreeMap<String, Vec<Scored>> = BTreeMap::new();
    for size in &sizes {
        for name in effects.split(',') {
            for seed in seeds.clone() {
                let hidden: Vec<&str> = if name == "none" { Vec::new() } else { name.split('+').collect() };
                let Ok(case) = Case::new(seed, &hidden, *size, experiment) else {
                    eprintln!("no effect is called {name}");
                    std::process::exit(2);
                };
                match run(&case) {
                    Err(error) => println!("ERR  {name:22} {size:>4} {seed:>4} {error}"),
                    Ok((scored, found)) => {
                        let mark = if scored.right() {
                            "ok"
                        } else if scored.wrong() {
                            "WRONG"
                        } else {
                            "miss"
                        };
                        println!(
                            "{mark:5}{name:22} {size:>4} {seed:>4} vis {:>7.2} {:18} named {:?} tied {:?} par {} shrink {:.3} noise ×{:.2} {:.2} s",
                            scored.visibility,
                            scored.verdict.name(),
                            scored.named,
                            scored.tied,
                            scored.parameter_error.map_or("-".into(), |e| format!("{:.2} %", 100.0 * e)),
                            scored.shrink,
                            scored.over_noise,
                            scored.seconds
                        );
                        if verbose {
                            for c in &found.candidates {
                                println!(
                                    "       {:22} Δ {:.4} z {:.1} λ {:.0} {}",
                                    c.kind.name(),
                                    c.delta,
                                    c.z,
                                    c.lambda,
                                    c.fate
                                );
                            }
                        }
                        table.entry(format!("{name} {size}")).or_default().push(scored);
                    }
                }
            }
        }
    }
    let all: Vec<&Scored> = table.values().flatten().collect();
    let count = |f: &dyn Fn(&Scored) -> bool| all.iter().filter(|s| f(s)).count();
    println!(
        "{} cases: right {}, wrong {}, explained {}; mean {:.2} s, longest {:.2} s",
        all.len(),
        count(&Scored::right),
        count(&Scored::wrong),
        count(&|s| s.verdict.name() == "explained"),
        all.iter().map(|s| s.seconds).sum::<f64>() / all.len().max(1) as f64,
        all.iter().map(|s| s.seconds).fold(0.0, f64::max)
    );
}
