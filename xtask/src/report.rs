//! Steps with their times, and the closing line.

use std::ops::AddAssign;
use std::time::{Duration, Instant};

use anyhow::Result;

/// How many tests and other checks passed and failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub passed: u64,
    pub failed: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
    }
}

impl Counts {
    /// What a closing line of libtest (`test result: …`) or of nextest (`Summary […] … run: …`) says; zero for
    /// any other line. Whatever ended neither passed nor skipped (timed out, could not start) counts as failed.
    pub fn in_line(line: &str) -> Self {
        let line = line.trim();
        let list = if let Some((_, list)) = line.strip_prefix("test result: ").and_then(|rest| rest.split_once(". ")) {
            list.split("; finished").next().unwrap_or(list)
        } else if let Some((_, list)) = line.strip_prefix("Summary [").and_then(|rest| rest.split_once(" run: ")) {
            list
        } else {
            return Self::default();
        };
        let mut counts = Self::default();
        for item in list.split([';', ',']) {
            let Some((number, what)) = item.trim().split_once(' ') else {
                continue;
            };
            let Ok(number) = number.parse::<u64>() else {
                continue;
            };
            match what.split(' ').next() {
                Some("passed") => counts.passed += number,
                Some("skipped" | "ignored" | "measured" | "filtered") => {}
                _ => counts.failed += number,
            }
        }
        counts
    }
}

/// The steps of a run so far.
#[derive(Default)]
pub struct Report {
    counts: Counts,
    times: Vec<(&'static str, Duration)>,
}

impl Report {
    /// A step that is one check: it passes or fails as a whole.
    pub fn check(&mut self, title: &'static str, step: impl FnOnce() -> Result<()>) -> Result<()> {
        self.tests(title, || match step() {
            Ok(()) => (Counts { passed: 1, failed: 0 }, Ok(())),
            Err(error) => (Counts::default(), Err(error)),
        })
    }

    /// A step that runs tests and counts them. Failing without a failed test (it did not compile) is one failure.
    pub fn tests(&mut self, title: &'static str, step: impl FnOnce() -> (Counts, Result<()>)) -> Result<()> {
        println!("\n==> {title}");
        let start = Instant::now();
        let (mut counts, result) = step();
        if result.is_err() {
            counts.failed = counts.failed.max(1);
        }
        self.counts += counts;
        let time = start.elapsed();
        self.times.push((title, time));
        println!("    {title}: {:.1} s", time.as_secs_f64());
        result
    }

    /// The time of each step, and last of all `N passed, N failed`.
    pub fn close(&self) {
        println!();
        for (title, time) in &self.times {
            println!("{:8.1} s  {title}", time.as_secs_f64());
        }
        println!("{} passed, {} failed", self.counts.passed, self.counts.failed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_lines_of_both_runners_are_counted() {
        let lines = [
            ("test result: ok. 12 passed; 0 failed; 3 ignored; 0 measured; 5 filtered out; finished in 1.20s", (12, 0)),
            (
                "test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n",
                (2, 1),
            ),
            ("     Summary [   0.005s] 5 tests run: 5 passed, 0 skipped", (5, 0)),
            ("     Summary [   1.005s] 1 test run: 1 passed (1 slow), 2 skipped", (1, 0)),
            (
                "     Summary [  90.005s] 7/9 tests run: 3 passed, 2 failed, 1 timed out, 1 exec failed, 0 skipped",
                (3, 4),
            ),
            ("test relay::summary ... ok", (0, 0)),
            ("12 passed, 3 failed", (0, 0)),
        ];
        for (line, (passed, failed)) in lines {
            assert_eq!(Counts::in_line(line), Counts { passed, failed }, "{line}");
        }
    }

    #[test]
    fn a_step_that_fails_without_a_failed_test_is_one_failure() {
        let mut report = Report::default();
        assert!(report.check("fine", || Ok(())).is_ok());
        assert!(report.check("broken", || anyhow::bail!("no")).is_err());
        let counted = Counts { passed: 4, failed: 2 };
        assert!(report.tests("tests", || (counted, Err(anyhow::anyhow!("no")))).is_err());
        assert_eq!(report.counts, Counts { passed: 5, failed: 3 });
    }
}
