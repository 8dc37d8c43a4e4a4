//! Steps with their times, the slowest tests, what was not run, and the closing line.

mod lines;

use std::time::{Duration, Instant};

use anyhow::Result;

pub use lines::{Counts, Tests, Timed};

use crate::processor;

/// Tests that are named for their time.
const SLOWEST: usize = 10;

/// What a step took.
struct Step {
    title: &'static str,
    time: Duration,
    /// Processor time of its commands, s; known on Linux.
    processor_s: Option<f64>,
}

/// The steps of a run so far.
#[derive(Default)]
pub struct Report {
    tests: Tests,
    steps: Vec<Step>,
    not_run: Vec<String>,
}

impl Report {
    /// A step that is one check: it passes or fails as a whole.
    pub fn check(&mut self, title: &'static str, step: impl FnOnce() -> Result<()>) -> Result<()> {
        self.tests(title, || {
            let result = step();
            let counts = Counts { passed: u64::from(result.is_ok()), failed: 0 };
            (Tests { counts, times: Vec::new() }, result)
        })
    }

    /// A step that runs tests and counts them. Failing without a failed test (it did not compile) is one failure.
    pub fn tests(&mut self, title: &'static str, step: impl FnOnce() -> (Tests, Result<()>)) -> Result<()> {
        println!("\n==> {title}");
        let (start, before) = (Instant::now(), processor::time_s());
        let (mut tests, result) = step();
        if result.is_err() {
            tests.counts.failed = tests.counts.failed.max(1);
        }
        self.tests += tests;
        let processor_s = before.and_then(|before| Ok(processor::time_s()? - before)).ok();
        let step = Step { title, time: start.elapsed(), processor_s };
        println!("    {title}: {:.1} s", step.time.as_secs_f64());
        self.steps.push(step);
        result
    }

    /// Work that went on beside the steps before, and is checked by those after.
    pub fn beside(&mut self, title: &'static str, time: Duration, processor_s: Option<f64>) {
        self.steps.push(Step { title, time, processor_s });
    }

    /// Something that could not be run here, and why.
    pub fn not_run(&mut self, what: String) {
        println!("\nNOT RUN: {what}");
        self.not_run.push(what);
    }

    /// The slowest tests, the time of each step, what was not run, and last of all `N passed, N failed`.
    pub fn close(&self) {
        println!("\n{}", self.slowest());
        println!("\n{:>10} {:>10}", "clock", "processor");
        for Step { title, time, processor_s } in &self.steps {
            let processor = processor_s.map_or(String::from("?"), |time| format!("{time:.1} s"));
            println!("{:8.1} s {processor:>10}  {title}", time.as_secs_f64());
        }
        if !self.not_run.is_empty() {
            println!("\nNOT RUN: {}", self.not_run.join("\nNOT RUN: "));
        }
        println!("{} passed, {} failed", self.tests.counts.passed, self.tests.counts.failed);
    }

    /// The slowest tests, one per line.
    fn slowest(&self) -> String {
        let mut times: Vec<&Timed> = self.tests.times.iter().collect();
        if times.is_empty() {
            return "The times of the tests are not known: cargo-nextest, which measures them, has run none."
                .to_owned();
        }
        // The one that failed is said twice: when it ends, and again at the end.
        times.sort_by(|a, b| b.time_s.total_cmp(&a.time_s).then_with(|| a.name.cmp(&b.name)));
        times.dedup_by(|a, b| a.name == b.name);
        let lines = times.iter().take(SLOWEST).map(|test| format!("\n{:8.1} s  {}", test.time_s, test.name));
        format!("The slowest tests, by the clock:{}", lines.collect::<String>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_that_fails_without_a_failed_test_is_one_failure() {
        let mut report = Report::default();
        assert!(report.check("fine", || Ok(())).is_ok());
        assert!(report.check("broken", || anyhow::bail!("no")).is_err());
        let counted = Tests { counts: Counts { passed: 4, failed: 2 }, times: Vec::new() };
        assert!(report.tests("tests", || (counted, Err(anyhow::anyhow!("no")))).is_err());
        assert_eq!(report.tests.counts, Counts { passed: 5, failed: 3 });
    }

    #[test]
    fn the_ten_slowest_tests_are_named_once_each() {
        let mut report = Report::default();
        assert!(report.slowest().contains("not known"));
        let test = |n: u32| Timed { name: format!("test {n}"), time_s: f64::from(n), passed: n != 7 };
        report.tests.times = (1..=12).chain([7]).map(test).collect();
        let lines: Vec<String> = report.slowest().lines().skip(1).map(|line| line.trim().to_owned()).collect();
        let wanted: Vec<String> = (3..=12).rev().map(|n| format!("{n}.0 s  test {n}")).collect();
        assert_eq!(lines, wanted);
    }
}
