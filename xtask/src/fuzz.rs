//! `cargo xtask fuzz`: the bounded fuzz tests of the suite, run for as long as asked.
//!
//! Each is an ordinary integration test that takes the number of its iterations from `BREAKAWAY_FUZZ_ITERATIONS`.

use std::process::Command;
use std::time::Instant;

use anyhow::Result;

use crate::run::{cargo, run};

/// Package and integration test of each.
const FUZZ_TESTS: [(&str, &str); 2] = [("breakaway", "reader_fuzz"), ("breakaway", "model_fuzz")];

/// Iterations of the run that measures how fast the test is.
const PILOT: u64 = 10_000;

/// Runs each fuzz test for about `seconds`.
pub fn all(seconds: u64) -> Result<()> {
    for (package, test) in FUZZ_TESTS {
        println!("\n==> fuzz {package}::{test}");
        run(command(package, test).arg("--no-run"))?;
        let start = Instant::now();
        run(command(package, test).env("BREAKAWAY_FUZZ_ITERATIONS", PILOT.to_string()))?;
        let pilot = start.elapsed().as_secs_f64();
        let iterations = iterations(seconds as f64 - pilot, pilot);
        if iterations > 0 {
            run(command(package, test).env("BREAKAWAY_FUZZ_ITERATIONS", iterations.to_string()))?;
        }
        println!("{package}::{test}: {:.1} s", start.elapsed().as_secs_f64());
    }
    Ok(())
}

fn command(package: &str, test: &str) -> Command {
    cargo(["test", "--release", "--package", package, "--test", test])
}

/// How many iterations fill the remaining time, given how long [`PILOT`] of them took; both in seconds.
fn iterations(remaining_s: f64, pilot_s: f64) -> u64 {
    (PILOT as f64 * remaining_s / pilot_s.max(1e-3)).max(0.0) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn iterations_fill_the_time_that_is_left() {
        assert_eq!(iterations(59.0, 1.0), 59 * PILOT);
        assert_eq!(iterations(-2.0, 3.0), 0);
    }
}
