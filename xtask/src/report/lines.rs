//! What the runners of tests print: libtest (`cargo test`) and nextest.

use std::ops::AddAssign;

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
    /// What a closing line of libtest (`test result: …`), of nextest (`Summary […] … run: …`) or of pytest
    /// (`=== … in 1.20s ===`) says; zero for any other line. Whatever ended neither passed nor skipped (timed out, could not start) counts as failed.
    ///
    /// nextest shows what a failed test has printed, further in. There libtest's line is of that one test, which the summary
    /// counts too.
    pub fn in_line(line: &str) -> Self {
        let whole = line.trim_end();
        let line = whole.trim_start();
        let list = if let Some((_, list)) = whole.strip_prefix("test result: ").and_then(|rest| rest.split_once(". ")) {
            list.split("; finished").next().unwrap_or(list)
        } else if let Some((_, list)) = line.strip_prefix("Summary [").and_then(|rest| rest.split_once(" run: ")) {
            list
        } else if let Some((list, _)) = line.strip_prefix("==").and_then(|rest| rest.rsplit_once(" in ")) {
            list.trim_start_matches('=')
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
                Some("skipped" | "ignored" | "measured" | "filtered" | "deselected" | "warning" | "warnings") => {}
                _ => counts.failed += number,
            }
        }
        counts
    }
}

/// A test that has ended, and how long it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Timed {
    /// Program and path of the test.
    pub name: String,
    /// By the clock, s.
    pub time_s: f64,
    /// Whether it passed.
    pub passed: bool,
}

impl Timed {
    /// What nextest says of a test that has ended: `PASS [   0.013s] (1/2) breakaway::all model::read`. libtest gives no
    /// times.
    pub fn in_line(line: &str) -> Option<Self> {
        let (status, rest) = line.trim().split_once(" [")?;
        if status.is_empty() || !status.chars().all(|c| c.is_ascii_uppercase()) {
            return None;
        }
        // A test that is still running has `[> 60.000s]`.
        let (time, name) = rest.split_once("s] ")?;
        let time_s = time.trim().parse().ok()?;
        let name = name.trim();
        // Its number among all; the width of the numbers is padded by blanks.
        let name = name.strip_prefix('(').and_then(|name| name.split_once(')')).map_or(name, |(_, name)| name.trim());
        Some(Self { name: name.to_owned(), time_s, passed: status == "PASS" })
    }
}

/// What the runners have said so far.
#[derive(Clone, Debug, Default)]
pub struct Tests {
    /// Of their closing lines.
    pub counts: Counts,
    /// Of each test, as it ended.
    pub times: Vec<Timed>,
}

impl Tests {
    /// Takes a line of theirs; whether it is worth showing.
    pub fn take(&mut self, line: &str) -> bool {
        self.counts += Counts::in_line(line);
        let Some(timed) = Timed::in_line(line) else { return true };
        let show = !timed.passed;
        self.times.push(timed);
        show
    }
}

impl AddAssign for Tests {
    fn add_assign(&mut self, other: Self) {
        self.counts += other.counts;
        self.times.extend(other.times);
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
            ("=================== 12 passed, 1 skipped, 2 warnings in 3.45s ===================", (12, 0)),
            ("============= 1 failed, 3 passed, 1 error in 61.20s (0:01:01) ==============", (3, 2)),
            ("======================= test session starts =======================", (0, 0)),
            ("test relay::summary ... ok", (0, 0)),
            ("    test result: FAILED. 0 passed; 1 failed; 0 ignored; 0 measured; 29 filtered out", (0, 0)),
            ("12 passed, 3 failed", (0, 0)),
        ];
        for (line, (passed, failed)) in lines {
            assert_eq!(Counts::in_line(line), Counts { passed, failed }, "{line}");
        }
    }

    #[test]
    fn the_time_of_a_test_is_read() {
        let timed = |name: &str, time_s, passed| Some(Timed { name: name.to_owned(), time_s, passed });
        let lines = [
            ("        PASS [   0.013s] (1/1) nx tests::it_works\n", timed("nx tests::it_works", 0.013, true)),
            (
                "        PASS [  12.500s] (  7/900) breakaway::all walk::all",
                timed("breakaway::all walk::all", 12.5, true),
            ),
            ("        FAIL [   1.000s] breakaway::all walk::all", timed("breakaway::all walk::all", 1.0, false)),
            ("        SLOW [> 60.000s] ( ---- ) breakaway::all walk::all", None),
            ("     Summary [   0.014s] 1 test run: 1 passed, 0 skipped", None),
            ("test result: ok. 12 passed; 0 failed", None),
        ];
        for (line, wanted) in lines {
            assert_eq!(Timed::in_line(line), wanted, "{line}");
        }
    }
}
