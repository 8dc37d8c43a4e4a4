//! `cargo xtask soak`: the virtual board under noise on its link, and the table of docs/robustness.md.

use std::process::ExitCode;
use std::time::Duration;

use breakaway_tests::soak::soak;

/// `soak MINUTES PPM`.
fn main() -> ExitCode {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
    let [minutes, ppm] = numbers[..] else {
        eprintln!("soak MINUTES PPM");
        return ExitCode::FAILURE;
    };
    match soak(Duration::from_secs_f64(60.0 * minutes), ppm as u32, 1) {
        Ok(outcome) => {
            print!("{}", outcome.table());
            let failures = outcome.failures();
            for failure in &failures {
                eprintln!("wrong: {failure}");
            }
            if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
